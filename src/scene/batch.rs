//! Rays without vertices: what a ray `o + t·d` meets, found in every way that exists. Benchmarks measure these ways, and
//! tests compare them, because all must give the same bits.

use super::shape::{Hit, Shape};
use super::vertex::{Rays, VertexWave};
use super::wide::InstructionSet;
use super::{Scene, packets};
use glam::Vec3;

/// A way to find what rays meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// The tree, all rays of a batch at once. Large shapes go in packets before the tree, here and in the other ways through it.
    Tree,
    /// One ray at a time: through the tree, or in lanes in a very small scene.
    Single,
    /// The tree, all rays at once, without instructions that only some machines have.
    Plain,
    /// The tree, all rays at once, by AVX2 even if the machine has AVX-512.
    Avx2,
    /// Packets: every shape against sixteen rays at once.
    Packets,
    /// Every shape against one ray at a time.
    EveryShape,
}

/// A batch of rays, and what they meet.
pub struct RayBatch {
    rays: Rays,
    n: usize,
}

impl RayBatch {
    /// The rays with these origins and directions.
    pub fn new(list: &[(Vec3, Vec3)]) -> Self {
        let mut wave = VertexWave::default();
        // packets read and write whole packets
        wave.resize(list.len().next_multiple_of(64));
        let mut rays = wave.rays;
        for (i, (o, d)) in list.iter().enumerate() {
            rays.o.set(i, *o);
            rays.d.set(i, *d);
            rays.list[i] = i as u32;
        }
        Self { rays, n: list.len() }
    }

    /// Finds the first hit of every ray.
    pub fn closest(&mut self, scene: &Scene, way: Way) {
        let (rays, accel) = (&mut self.rays, &scene.accel);
        match way {
            Way::Tree => accel.closest_wave(rays, self.n),
            Way::Plain => accel.closest_wave_by(InstructionSet::Plain, rays, self.n),
            Way::Avx2 => accel.closest_wave_by(InstructionSet::avx2(), rays, self.n),
            Way::Packets => packets::closest(&accel.shapes, rays, self.n),
            Way::Single | Way::EveryShape => {
                for i in 0..self.n {
                    let (o, d) = (rays.o.get(i), rays.d.get(i));
                    let hit = if way == Way::Single { accel.closest(o, d) } else { first(&accel.shapes, o, d) };
                    (rays.t[i], rays.prim[i]) = (hit.t, hit.prim);
                }
            }
        }
    }

    /// Finds, for every ray, whether anything lies at 0 < t < 1.
    pub fn occluded(&mut self, scene: &Scene, way: Way) {
        let (rays, accel) = (&mut self.rays, &scene.accel);
        match way {
            Way::Tree => accel.occluded_wave(rays, self.n),
            Way::Plain => accel.occluded_wave_by(InstructionSet::Plain, rays, self.n),
            Way::Avx2 => accel.occluded_wave_by(InstructionSet::avx2(), rays, self.n),
            Way::Packets => packets::occluded(&accel.shapes, rays, self.n),
            Way::Single | Way::EveryShape => {
                for i in 0..self.n {
                    let (o, d) = (rays.o.get(i), rays.d.get(i));
                    let single = way == Way::Single;
                    let hit = if single { accel.occluded(o, d) } else { any(&accel.shapes, o, d) };
                    rays.prim[i] = u32::from(hit);
                }
            }
        }
    }

    /// Distance and primitive of the first hit of ray `i`, after [`RayBatch::closest`].
    pub fn hit(&self, i: usize) -> Option<(f32, u32)> {
        (self.rays.prim[i] != u32::MAX).then(|| (self.rays.t[i], self.rays.prim[i]))
    }

    /// Whether anything lies on ray `i`, after [`RayBatch::occluded`].
    pub fn blocked(&self, i: usize) -> bool {
        self.rays.prim[i] != 0
    }
}

fn first(shapes: &[Shape], o: Vec3, d: Vec3) -> Hit {
    let mut best = Hit::NONE;
    for (prim, shape) in shapes.iter().enumerate() {
        let (t, met) = shape.meet(o, d);
        if met {
            best.take(Hit { t, prim: prim as u32 });
        }
    }
    best
}

fn any(shapes: &[Shape], o: Vec3, d: Vec3) -> bool {
    shapes.iter().map(|s| s.meet(o, d)).any(|(t, met)| met && t < 1.0)
}

/// The corners of all shapes, which must be triangles, as rays see them.
pub fn triangles(scene: &Scene) -> Vec<[Vec3; 3]> {
    let corners = |s: &Shape| if let Shape::Triangle(t) = s { t.p } else { [Vec3::NAN; 3] };
    scene.accel.shapes.iter().map(corners).collect()
}
