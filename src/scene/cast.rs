//! Rays in a scene: G of T = K G. One ray, a packet, or a wave of them; what is seen, and whether anything stands between.

use super::vertex::{Rays, Vertex};
use super::{Scene, packets, rounding::offset_origin, rounding::segment, shape};
use glam::Vec3;

impl Scene {
    /// The first surface seen from `o` in unit direction `d`, or nothing.
    #[inline(always)]
    pub fn trace(&self, o: Vec3, d: Vec3) -> Option<Vertex> {
        let hit = self.accel.closest(o, d);
        (hit.prim != u32::MAX).then(|| self.arrive(o, d, hit))
    }

    /// The first surface seen from `o` in unit direction `d`, or the sky if there is one.
    #[inline(always)]
    pub fn look(&self, o: Vec3, d: Vec3) -> Option<Vertex> {
        let seen = self.trace(o, d);
        if seen.is_none() && self.has_environment() { Some(Vertex::escaped(self.beyond(o, d), d)) } else { seen }
    }

    /// Whether waves are traced in packets.
    pub(crate) fn in_packets(&self) -> bool {
        self.packets
    }

    /// This scene without packets, for tests: the plain twin.
    #[doc(hidden)]
    #[must_use]
    pub fn one_by_one(mut self) -> Self {
        self.packets = false;
        self
    }

    /// The first surfaces seen along the first `n` rays of a wave; `at(i, vertex)` is called in order for rays that see one.
    #[inline(always)]
    pub(crate) fn trace_packets(&self, rays: &mut Rays, n: usize, mut at: impl FnMut(usize, Vertex)) {
        packets::closest(&self.accel.shapes, rays, n);
        for i in 0..n {
            if rays.prim[i] != u32::MAX {
                at(i, self.arrive(rays.o.get(i), rays.d.get(i), shape::Hit { t: rays.t[i], prim: rays.prim[i] }));
            }
        }
    }

    /// For each ray named by the first `n` of `rays.list`: `rays.prim[ray] = 1` if its segment is blocked, else 0.
    #[inline(always)]
    pub(crate) fn block_packets(&self, rays: &mut Rays, n: usize) {
        packets::occluded(&self.accel.shapes, rays, n);
    }

    /// [`Scene::trace_packets`], or one by one where packets do not suit the scene.
    pub(crate) fn trace_wave(&self, rays: &mut Rays, n: usize, mut at: impl FnMut(usize, Vertex)) {
        if self.packets {
            return self.trace_packets(rays, n, at);
        }
        for i in 0..n {
            if let Some(v) = self.trace(rays.o.get(i), rays.d.get(i)) {
                at(i, v);
            }
        }
    }

    /// [`Scene::block_packets`], or one by one where packets do not suit the scene.
    pub(crate) fn block_wave(&self, rays: &mut Rays, n: usize) {
        if self.packets {
            return self.block_packets(rays, n);
        }
        for &ray in &rays.list[..n] {
            let ray = ray as usize;
            rays.prim[ray] = u32::from(self.accel.occluded(rays.o.get(ray), rays.d.get(ray)));
        }
    }

    #[inline(always)]
    fn arrive(&self, o: Vec3, d: Vec3, hit: shape::Hit) -> Vertex {
        let shape = &self.accel.shapes[hit.prim as usize];
        let p = shape.settle(o + d * hit.t);
        let n = shape.normal(p);
        let back = shape::dot(n, d) > 0.0;
        Vertex { p, n: if back { -n } else { n }, omega: -d, side: 2 * hit.prim + u32::from(back) }
    }

    /// Where a ray that leaves `p` on the side of `n` starts: off the surface by the bound on its error.
    #[inline(always)]
    pub fn offset_origin(p: Vec3, n: Vec3) -> Vec3 {
        offset_origin(p, n)
    }

    /// Whether the segment from `p` to `q` is blocked; both ends are lifted off their surfaces.
    #[inline(always)]
    pub fn blocked(&self, p: Vec3, n: Vec3, q: Vec3, m: Vec3) -> bool {
        let (o, d) = segment(p, n, q, m);
        self.accel.occluded(o, d)
    }
}
