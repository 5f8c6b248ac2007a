//! The vertex: a surface point with a direction, at which radiance is evaluated.

use crate::math::{Columns, columns};
use glam::Vec3;

/// Number of one side of one primitive: `2·primitive`, plus 1 for the back. Numbers from [`LIGHT`] on do not denote a
/// surface.
pub type Side = u32;
/// `LIGHT + i` denotes light i if it is a point or directional light.
pub const LIGHT: Side = 1 << 31;
/// Denotes a ray that has left the scene; its radiance is that of the sky.
pub const ESCAPED: Side = u32::MAX;

/// A surface point x with the direction ω in which radiance leaves it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vertex {
    /// Position on the surface.
    pub p: Vec3,
    /// Unit normal of the visible side, `n·ω > 0`.
    pub n: Vec3,
    /// Unit direction ω away from the surface, back along the path.
    pub omega: Vec3,
    /// Side of a primitive, or a light without a surface, or [`ESCAPED`].
    pub side: Side,
}

impl Vertex {
    /// The vertex of a ray in the unit direction `d` that leaves the scene at `p`.
    pub(crate) fn escaped(p: Vec3, d: Vec3) -> Self {
        Self { p, n: -d, omega: -d, side: ESCAPED }
    }

    /// Returns true if the vertex lies on a surface.
    #[inline(always)]
    pub fn on_surface(&self) -> bool {
        self.side < LIGHT
    }
}

/// A wave of vertices stored as columns, with buffers for the rays between them.
#[derive(Clone, Debug, Default)]
pub struct VertexWave {
    pub(crate) p: Columns,
    pub(crate) n: Columns,
    pub(crate) omega: Columns,
    pub(crate) side: Vec<Side>,
    /// Buffers of the batched methods.
    pub(crate) rays: Rays,
}

/// Buffers for the rays of a wave: origins `o`, directions `d`, distances `t`, primitives, a list of ray indices, and
/// cosines.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rays {
    pub(crate) o: Columns,
    pub(crate) d: Columns,
    pub(crate) t: Vec<f32>,
    pub(crate) prim: Vec<u32>,
    pub(crate) list: Vec<u32>,
    pub(crate) cosine: Vec<f32>,
    /// Four columns of random numbers.
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
