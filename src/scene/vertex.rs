//! The vertex: a surface point with a direction, at which radiance is evaluated.

use crate::math::{Columns, pick};
use glam::Vec3;

/// Number of one side of one primitive: `2·primitive`, plus 1 for the back. Numbers from [`LIGHT`] on do not denote a
/// surface.
pub type Side = u32;
/// `LIGHT + i` denotes light i if it is a point or directional light.
pub const LIGHT: Side = 1 << 31;
/// Denotes a ray that has left the scene; its radiance is that of the sky.
pub const ESCAPED: Side = u32::MAX;
/// Denotes a ray that has left a scene without a sky.
pub(crate) const NOWHERE: Side = u32::MAX - 1;

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

/// A sample that is zero.
pub(crate) const NOTHING: u32 = 0;
/// A sample that is not zero.
pub(crate) const SOME: u32 = 1;
/// The same, from a delta part.
pub(crate) const DELTA: u32 = 2;

/// Buffers for the rays of a wave. Columns are by path, or by place in the order in which [`groups`](super::groups) sorts
/// the paths.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rays {
    /// Origins and directions of rays, or of segments.
    pub(crate) o: Columns,
    pub(crate) d: Columns,
    /// Distances, or densities.
    pub(crate) t: Vec<f32>,
    /// Primitives that rays hit.
    pub(crate) prim: Vec<u32>,
    /// Numbers of some rays.
    pub(crate) list: Vec<u32>,
    /// Cosines, or densities of the other technique.
    pub(crate) cosine: Vec<f32>,
    /// Four columns of random numbers, by path.
    pub(crate) u: [Vec<f32>; 4],
    /// The paths in sorted order, the group of each path, and the end of each group in the order.
    pub(crate) order: Vec<u32>,
    pub(crate) group: Vec<u32>,
    /// What was sorted last: the sides, which groups were wanted, and the number of places.
    pub(crate) sorted: Vec<Side>,
    pub(crate) wants: Vec<bool>,
    pub(crate) places: usize,
    /// The place of each path; `u32::MAX` if it has none.
    pub(crate) place: Vec<u32>,
    pub(crate) ends: Vec<u32>,
    /// Reflectances of coloured groups, by place.
    pub(crate) colour: Columns,
    /// Light points by place: unit directions towards them, positions, normals, radiances. Or the points, normals and sides
    /// that rays see.
    pub(crate) to: Columns,
    pub(crate) q: Columns,
    pub(crate) m: Columns,
    pub(crate) radiance: Columns,
    pub(crate) side: Vec<Side>,
    /// Weights, and whether a sample is not zero, by place.
    pub(crate) value: Columns,
    pub(crate) flag: Vec<u32>,
    /// Of a guide, by path: ratio of densities, and share of BSDF sampling.
    pub(crate) ratio: Vec<f32>,
    pub(crate) share: Vec<f32>,
}

impl Rays {
    /// The vertex that ray `i` sees.
    #[inline(always)]
    pub(crate) fn seen(&self, i: usize) -> Vertex {
        Vertex { p: self.q.get(i), n: self.m.get(i), omega: -self.d.get(i), side: self.side[i] }
    }

    /// Number of groups that have a place in the order.
    pub(crate) fn groups(&self) -> usize {
        self.ends.windows(2).filter(|w| w[1] > w[0]).count()
    }

    /// Removes the places without a sample from the first `n`, in the same order. Returns their new number.
    pub(crate) fn keep_samples(&mut self, n: usize) -> usize {
        let Some(first) = self.flag[..n].iter().position(|&f| f == NOTHING) else { return n };
        // the order is not that of all vertices any more
        self.sorted.clear();
        let mut to = first;
        for from in first..n {
            if self.flag[from] != NOTHING {
                self.o.set(to, self.o.get(from));
                self.d.set(to, self.d.get(from));
                self.value.set(to, self.value.get(from));
                (self.t[to], self.flag[to], self.order[to]) = (self.t[from], self.flag[from], self.order[from]);
                to += 1;
            }
        }
        to
    }
}

/// Buffers are longer than a wave by this much, so that a group of lanes may reach beyond the last path.
const MARGIN: usize = 16;

impl Rays {
    fn resize(&mut self, n: usize) {
        let n = n + MARGIN;
        for c in [
            &mut self.o,
            &mut self.d,
            &mut self.colour,
            &mut self.to,
            &mut self.q,
            &mut self.m,
            &mut self.radiance,
            &mut self.value,
        ] {
            *c = Columns::new(n);
        }
        for c in [
            &mut self.prim,
            &mut self.list,
            &mut self.order,
            &mut self.group,
            &mut self.flag,
            &mut self.side,
            &mut self.place,
        ] {
            *c = vec![0; n];
        }
        for c in [&mut self.t, &mut self.cosine, &mut self.ratio, &mut self.share] {
            *c = vec![0.0; n];
        }
        self.u = std::array::from_fn(|_| vec![0.0; n]);
    }
}

impl VertexWave {
    pub(crate) fn resize(&mut self, n: usize) {
        // as long as the buffers, with which they may change places
        for c in [&mut self.p, &mut self.n, &mut self.omega] {
            *c = Columns::new(n + MARGIN);
        }
        self.side = vec![0; n + MARGIN];
        self.rays.resize(n);
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vertex {
        Vertex { p: self.p.get(i), n: self.n.get(i), omega: self.omega.get(i), side: self.side[i] }
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, v: Vertex) {
        // the new vertices may be those of another scene
        self.rays.sorted.clear();
        self.p.set(i, v.p);
        self.n.set(i, v.n);
        self.omega.set(i, v.omega);
        self.side[i] = v.side;
    }

    pub(crate) fn keep(&mut self, indices: &[u32]) {
        self.p.keep(indices);
        self.n.keep(indices);
        self.omega.keep(indices);
        pick::keep(&mut self.side, indices);
    }
}
