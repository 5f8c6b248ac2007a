//! Rays in a scene: the operator G of T = K G, for single rays, packets and waves. A ray gives the first visible surface; a
//! segment is tested for occlusion.

use super::arrive::Arrivals;
use super::vertex::{ESCAPED, NOWHERE, Rays, Vertex};
use super::{Scene, arrive, packets, rounding::offset_origin, rounding::segment, shape};
use glam::Vec3;

impl Scene {
    /// The first surface hit from `o` in the unit direction `d`; `None` if there is none.
    #[inline(always)]
    pub fn trace(&self, o: Vec3, d: Vec3) -> Option<Vertex> {
        let hit = self.accel.closest(o, d);
        (hit.prim != u32::MAX).then(|| self.arrive(o, d, hit))
    }

    /// The first surface hit from `o` in the unit direction `d`, or the sky if nothing is hit and the scene has one.
    #[inline(always)]
    pub fn look(&self, o: Vec3, d: Vec3) -> Option<Vertex> {
        let seen = self.trace(o, d);
        if seen.is_none() && self.has_environment() { Some(Vertex::escaped(self.beyond(o, d), d)) } else { seen }
    }

    /// Returns true if paths are advanced in waves; false if one after the other.
    pub(crate) fn in_waves(&self) -> bool {
        self.waves
    }

    /// The same scene without waves and packets: the reference with which tests compare them.
    #[doc(hidden)]
    #[must_use]
    pub fn one_by_one(mut self) -> Self {
        (self.waves, self.arrivals) = (false, Arrivals::by_tree(&self.accel.shapes));
        self
    }

    /// The nearest hits of the first `n` rays of a wave, in packets or through the tree: sets `rays.t` and `rays.prim`.
    fn closest_wave(&self, rays: &mut Rays, n: usize) {
        match self.arrivals {
            Arrivals::ByPackets(_) => packets::closest(&self.accel.shapes, rays, n),
            Arrivals::ByTree(_) => self.accel.closest_wave(rays, n),
        }
    }

    /// Traces the first `n` rays of a wave. `at(i, vertex)` is called, in ascending order of i, for every ray that hits a
    /// surface.
    pub(crate) fn trace_wave(&self, rays: &mut Rays, n: usize, mut at: impl FnMut(usize, Vertex)) {
        self.closest_wave(rays, n);
        for i in 0..n {
            if rays.prim[i] != u32::MAX {
                at(i, self.arrive(rays.o.get(i), rays.d.get(i), shape::Hit { t: rays.t[i], prim: rays.prim[i] }));
            }
        }
    }

    /// What the first `n` rays of a wave see: points, normals and sides in `rays.q`, `rays.m` and `rays.side`. A ray that
    /// leaves the scene sees the sky, if there is one, or [`NOWHERE`].
    pub(crate) fn look_wave(&self, rays: &mut Rays, n: usize) {
        let nothing = (if self.has_environment() { ESCAPED } else { NOWHERE }, self.beyond);
        match &self.arrivals {
            Arrivals::ByPackets(table) => arrive::look_in_lanes(table, &self.accel.shapes, rays, n, nothing),
            Arrivals::ByTree(sheets) => {
                self.accel.closest_wave(rays, n);
                arrive::see_by_sheets(sheets, &self.accel.shapes, rays, n, nothing);
            }
        }
    }

    /// Tests the segments of the rays in the first `n` entries of `rays.list`: sets `rays.prim[ray]` to 1 if the segment is
    /// blocked, else to 0.
    pub(crate) fn block_wave(&self, rays: &mut Rays, n: usize) {
        match self.arrivals {
            Arrivals::ByPackets(_) => packets::occluded(&self.accel.shapes, rays, n),
            Arrivals::ByTree(_) => self.accel.occluded_wave(rays, n),
        }
    }

    #[inline(always)]
    fn arrive(&self, o: Vec3, d: Vec3, hit: shape::Hit) -> Vertex {
        arrive::arrive(&self.accel.shapes, o, d, hit)
    }

    /// Start of a ray that leaves `p` on the side of the normal `n`: the point is moved off the surface by the bound on its
    /// error.
    #[inline(always)]
    pub fn offset_origin(p: Vec3, n: Vec3) -> Vec3 {
        offset_origin(p, n)
    }

    /// Returns true if the segment from `p` to `q` is blocked. Both ends are moved off their surfaces along the normals `n`
    /// and `m`.
    #[inline(always)]
    pub fn blocked(&self, p: Vec3, n: Vec3, q: Vec3, m: Vec3) -> bool {
        let (o, d) = segment(p, n, q, m);
        self.accel.occluded(o, d)
    }
}
