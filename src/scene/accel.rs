//! Ray tracing with a tree of boxes: the first surface on a ray, and a test whether a segment is free.
//!
//! The tree is [`wide`](super::wide). If two primitives are hit at the same distance, the one with the lower number is
//! returned, whatever the order of traversal. A wave of rays shares one choice of the instruction set and one stack. Single
//! rays in very small scenes go without the tree: [`few`](super::few).

use super::few::Few;
use super::rounding::{EPSILON, WIDER};
use super::shape::{Hit, Shape};
use super::vertex::Rays;
use super::wide::{InstructionSet, Lanes, Task, Wide};
use glam::{DVec3, Vec3};

pub(crate) struct Accel {
    pub(crate) shapes: Vec<Shape>,
    wide: Wide,
    few: Option<Few>,
    best: InstructionSet,
}

/// Room for the stack of a single ray on the stack of the program: enough for trees of millions of primitives, and enough for
/// those of small scenes, for which clearing more would take as long as a part of the ray.
const ROOM: usize = 96;
const SMALL_ROOM: usize = 32;

/// The bounding box of a primitive, enlarged so that the rounding of the box test never loses a hit. The margin is 4 ε times
/// the largest coordinate from which a ray may start, plus the distance by which hits may lie beyond the edges of the
/// primitive. `farthest` is the largest coordinate of the scene, `touch` the distance at which two corners count as one.
pub(crate) fn widened([low, high]: [DVec3; 2], farthest: f64, touch: f64) -> [Vec3; 2] {
    let most = low.abs().max(high.abs());
    // rays start at most three scene sizes away
    let by = 32.0 * EPSILON * most + 16.0 * EPSILON * farthest + touch + 2.0 * WIDER * (high - low);
    [(low - by).as_vec3(), (high + by).as_vec3()]
}

impl Accel {
    /// Builds the tree; `bounds` are the [`widened`] boxes of the shapes.
    pub(crate) fn new(shapes: Vec<Shape>, bounds: Vec<[Vec3; 2]>) -> Self {
        let (wide, few) = (Wide::new(&shapes, bounds), Few::new(&shapes));
        Self { shapes, wide, few, best: InstructionSet::best() }
    }

    /// The nearest hit with t > 0 on the ray `o + t·d`.
    pub(crate) fn closest(&self, o: Vec3, d: Vec3) -> Hit {
        self.best.run(Closest { accel: self, o, d })
    }

    /// Returns true if a primitive lies on `o + t·d` with 0 < t < 1.
    pub(crate) fn occluded(&self, o: Vec3, d: Vec3) -> bool {
        self.best.run(Occluded { accel: self, o, d })
    }

    /// The nearest hits of the first `n` rays: writes `rays.t` and `rays.prim`, which is `u32::MAX` if there is none.
    pub(crate) fn closest_wave(&self, rays: &mut Rays, n: usize) {
        self.closest_wave_by(self.best, rays, n);
    }

    /// The same with the instructions of `set`.
    pub(crate) fn closest_wave_by(&self, set: InstructionSet, rays: &mut Rays, n: usize) {
        set.run(ClosestWave { accel: self, rays, n });
    }

    /// For each ray in the first `n` entries of `rays.list`: sets `rays.prim[ray]` to 1 if a primitive lies on `o + t·d` with
    /// 0 < t < 1, else to 0.
    pub(crate) fn occluded_wave(&self, rays: &mut Rays, n: usize) {
        self.occluded_wave_by(self.best, rays, n);
    }

    /// The same with the instructions of `set`.
    pub(crate) fn occluded_wave_by(&self, set: InstructionSet, rays: &mut Rays, n: usize) {
        set.run(OccludedWave { accel: self, rays, n });
    }
}

struct Closest<'a> {
    accel: &'a Accel,
    o: Vec3,
    d: Vec3,
}

impl Task for Closest<'_> {
    type Output = Hit;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Hit {
        let Self { accel: Accel { shapes, wide, few, .. }, o, d } = self;
        if let Some(few) = few {
            return few.closest(shapes, o, d);
        }
        if wide.waiting <= SMALL_ROOM {
            return wide.closest(l, shapes, o, d, &mut [0; SMALL_ROOM]);
        }
        if wide.waiting <= ROOM {
            return wide.closest(l, shapes, o, d, &mut [0; ROOM]);
        }
        wide.closest(l, shapes, o, d, &mut vec![0; wide.waiting])
    }
}

struct Occluded<'a> {
    accel: &'a Accel,
    o: Vec3,
    d: Vec3,
}

impl Task for Occluded<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> bool {
        let Self { accel: Accel { shapes, wide, few, .. }, o, d } = self;
        if let Some(few) = few {
            return few.occluded(shapes, o, d);
        }
        if wide.waiting <= SMALL_ROOM {
            return wide.occluded(l, shapes, o, d, &mut [0; SMALL_ROOM]);
        }
        if wide.waiting <= ROOM {
            return wide.occluded(l, shapes, o, d, &mut [0; ROOM]);
        }
        wide.occluded(l, shapes, o, d, &mut vec![0; wide.waiting])
    }
}

struct ClosestWave<'a> {
    accel: &'a Accel,
    rays: &'a mut Rays,
    n: usize,
}

impl Task for ClosestWave<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { accel: Accel { shapes, wide, .. }, rays, n } = self;
        let mut stack = vec![0; wide.waiting];
        for i in 0..n {
            let hit = wide.closest(l, shapes, rays.o.get(i), rays.d.get(i), &mut stack);
            (rays.t[i], rays.prim[i]) = (hit.t, hit.prim);
        }
    }
}

struct OccludedWave<'a> {
    accel: &'a Accel,
    rays: &'a mut Rays,
    n: usize,
}

impl Task for OccludedWave<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { accel: Accel { shapes, wide, .. }, rays, n } = self;
        let mut stack = vec![0; wide.waiting];
        for &ray in &rays.list[..n] {
            let ray = ray as usize;
            rays.prim[ray] = u32::from(wide.occluded(l, shapes, rays.o.get(ray), rays.d.get(ray), &mut stack));
        }
    }
}
