//! A point of ray space: where radiance is asked for.

use crate::math::{Columns, columns};
use glam::Vec3;

/// One side of one primitive: `2·primitive`, plus 1 for the back. From [`LIGHT`] on there is no surface.
pub type Side = u32;
/// `LIGHT + i` is light i, where it is a point or a direction.
pub const LIGHT: Side = 1 << 31;
/// The ray has left the scene: what comes from there is the sky's.
pub const ESCAPED: Side = u32::MAX;

/// A surface point with the direction radiance leaves in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vertex {
    /// Position, on the surface.
    pub p: Vec3,
    /// Unit normal of the side that is seen, `n·ω > 0`.
    pub n: Vec3,
    /// Unit direction ω away from the surface, towards whoever asks.
    pub omega: Vec3,
    /// Which side of which primitive, or which light without a surface, or [`ESCAPED`].
    pub side: Side,
}

impl Vertex {
    /// Where a ray in unit direction `d` leaves the scene.
    pub(crate) fn escaped(p: Vec3, d: Vec3) -> Self {
        Self { p, n: -d, omega: -d, side: ESCAPED }
    }

    /// Whether it lies on a surface.
    #[inline(always)]
    pub fn on_surface(&self) -> bool {
        self.side < LIGHT
    }
}

/// A wave of vertices as columns, with room for the rays between them.
#[derive(Clone, Debug, Default)]
pub struct VertexWave {
    pub(crate) p: Columns,
    pub(crate) n: Columns,
    pub(crate) omega: Columns,
    pub(crate) side: Vec<Side>,
    /// Scratch of the batched methods: origins, directions, distances, primitives, list of indices.
    pub(crate) rays: Rays,
}

/// Rays of a wave.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rays {
    pub(crate) o: Columns,
    pub(crate) d: Columns,
    pub(crate) t: Vec<f32>,
    pub(crate) prim: Vec<u32>,
    pub(crate) list: Vec<u32>,
    pub(crate) cosine: Vec<f32>,
    /// Four random numbers each.
    pub(crate) u: [Vec<f32>; 4],
}

impl VertexWave {
    pub(crate) fn resize(&mut self, n: usize) {
        for c in [&mut self.p, &mut self.n, &mut self.omega, &mut self.rays.o, &mut self.rays.d] {
            *c = Columns::new(n);
        }
        for c in [&mut self.side, &mut self.rays.prim, &mut self.rays.list] {
            *c = vec![0; n];
        }
        self.rays.t = vec![0.0; n];
        self.rays.cosine = vec![0.0; n];
        self.rays.u = std::array::from_fn(|_| vec![0.0; n]);
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vertex {
        Vertex { p: self.p.get(i), n: self.n.get(i), omega: self.omega.get(i), side: self.side[i] }
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, v: Vertex) {
        self.p.set(i, v.p);
        self.n.set(i, v.n);
        self.omega.set(i, v.omega);
        self.side[i] = v.side;
    }

    pub(crate) fn keep(&mut self, indices: &[u32]) {
        self.p.keep(indices);
        self.n.keep(indices);
        self.omega.keep(indices);
        columns::keep(&mut self.side, indices);
    }
}
