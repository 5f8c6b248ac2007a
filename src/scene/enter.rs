//! Which rays of a wave enter the box of the tree, sixteen rays at once. The others end at the large shapes in
//! [front](super::front) of it.
//!
//! ```text
//! near = max(0, max_a min(p_a, q_a))      far = min(t_max, min_a max(p_a, q_a))      p = (low − o)/d,  q = (high − o)/d
//! a ray enters if near ≤ far
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | o, d | origin and direction of a ray | [`Rays`] |
//! | low, high | corners of the box | [`Entrance`] |
//! | t_max | distance of the hit in front, or 1 for a segment | `most` |
//!
//! Of the rays in a room with a mesh in its middle, about half do not enter, and alone each of them would test the eight boxes at the
//! root. The formula is that of a [node](super::wide), and each rounded operation rises or falls with the plane: a ray that meets a
//! box inside also meets this box. So no hit is lost.

use super::front::Front;
use super::sixteen::{LANES, Lane, Lane3, ZERO, load, load_some, load3};
use super::vertex::Rays;
use super::wide::{ROUNDING, Wide, behind, reciprocal};
use crate::math::pick;
use glam::Vec3;
use pulp::{Arch, Simd};

/// The box of the tree.
pub(crate) struct Entrance([Vec3; 2]);

impl Entrance {
    /// The box of everything in the tree.
    pub(crate) fn of(tree: &Wide) -> Self {
        Self(tree.bounds())
    }

    /// Tests the first `n` rays against the shapes in front, and lists those that enter the tree before their hit there.
    pub(crate) fn closest(&self, front: &Front, rays: &mut Rays, n: usize) -> Vec<u32> {
        front.closest_wave(rays, n);
        let mut enters = vec![0; n.next_multiple_of(LANES)];
        before_hits(self.0, rays, &mut enters);
        listed(&enters[..n])
    }

    /// Tests the segments of the rays in the first `n` entries of `rays.list` against the shapes in front, as [`Front::occluded_wave`] does,
    /// and lists those that are still free and enter the tree.
    pub(crate) fn occluded(&self, front: &Front, rays: &mut Rays, n: usize) -> Vec<u32> {
        front.occluded_wave(rays, n);
        let mut enters = vec![0; n.next_multiple_of(LANES)];
        free_segments(self.0, rays, n, &mut enters);
        let mut list = listed(&enters[..n]);
        list.iter_mut().for_each(|j| *j = rays.list[*j as usize]);
        list
    }
}

/// The numbers of the entries that are not 0.
fn listed(enters: &[u32]) -> Vec<u32> {
    let mut list = vec![0; enters.len() + LANES];
    let some = pick::list_other(&mut list, enters, 0);
    list.truncate(some);
    list
}

/// 1 for each of sixteen rays that enters the box before `most`, else 0.
#[inline(always)]
fn enters([low, high]: [Vec3; 2], o: &Lane3, d: &Lane3, most: &Lane) -> [u32; LANES] {
    let (mut near, mut far) = (ZERO, *most);
    for axis in 0..3 {
        let (low, high) = (low[axis], high[axis]);
        for i in 0..LANES {
            let inverse = reciprocal(d[axis][i]);
            let (p, q) = ((low - o[axis][i]) * inverse, (high - o[axis][i]) * inverse);
            let (first, last) = if p < q { (p, q) } else { (q, p) };
            near[i] = if first > near[i] { first } else { near[i] };
            far[i] = if last < far[i] { last } else { far[i] };
        }
    }
    let mut enters = [0; LANES];
    for i in 0..LANES {
        enters[i] = u32::from(near[i] <= far[i] * ROUNDING);
    }
    enters
}

#[pulp::with_simd(before_hits = Arch::new())]
#[inline(always)]
fn before_hits_with_simd<'a, S: Simd>(_simd: S, bounds: [Vec3; 2], rays: &'a Rays, to: &'a mut [u32]) {
    for (k, to) in to.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let at = k * LANES;
        let (t, mut most) = (load(&rays.t, at), ZERO);
        for i in 0..LANES {
            most[i] = behind(t[i]);
        }
        *to = enters(bounds, &load3(&rays.o, at), &load3(&rays.d, at), &most);
    }
}

#[pulp::with_simd(free_segments = Arch::new())]
#[inline(always)]
fn free_segments_with_simd<'a, S: Simd>(_simd: S, bounds: [Vec3; 2], rays: &'a Rays, n: usize, to: &'a mut [u32]) {
    for (to, list) in to.as_chunks_mut::<LANES>().0.iter_mut().zip(rays.list[..n].chunks(LANES)) {
        let mut blocked = [0; LANES];
        blocked.iter_mut().zip(list).for_each(|(b, &ray)| *b = rays.prim[ray as usize]);
        let (o, d) = (load_some(&rays.o, list), load_some(&rays.d, list));
        let enters = enters(bounds, &o, &d, &[1.0; LANES]);
        for i in 0..LANES {
            to[i] = enters[i] & (blocked[i] ^ 1);
        }
    }
}
