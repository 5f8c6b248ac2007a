//! Where the rays of a wave arrive: the point, the normal and the side that each ray sees, in SIMD lanes.
//!
//! ```text
//! x = settle(o + t d)        n = ± normal of the primitive, on the side of the ray
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | o, d, t, primitive | the ray and what it hit | `Rays::o`, `d`, `t`, `prim` |
//! | x, n, side | what it sees | `Rays::q`, `m`, `side` |
//!
//! Parallelograms, of which small scenes consist, are gathered from [`Flats`] into lanes. Other kinds follow one by one. Both
//! call the functions of [`shape`](super::shape), so that the bits are those of single rays.

use super::shape::{self, Flat, Hit, Shape};
use super::vertex::{NOWHERE, Rays, Vertex};
use glam::Vec3;
use pulp::{Arch, Simd};

/// Vertices that are computed at once.
const LANES: usize = 16;
/// Number of primitives in the table: as many as a scene in packets may have.
pub(crate) const MOST: usize = 64;

/// The parallelograms of a small scene, one column per number. Entries of other kinds are zero.
#[derive(Clone, Debug)]
pub(crate) struct Flats {
    columns: [[f32; MOST]; Flat::NUMBERS],
    /// True for primitives of other kinds.
    other: [bool; MOST],
    /// True if there are other kinds.
    mixed: bool,
}

impl Flats {
    /// The table of the first primitives.
    pub(crate) fn new(shapes: &[Shape]) -> Self {
        let mut all = Self { columns: [[0.0; MOST]; Flat::NUMBERS], other: [false; MOST], mixed: false };
        for (i, shape) in shapes.iter().take(MOST).enumerate() {
            match shape {
                Shape::Flat(s) => all.columns.iter_mut().zip(s.numbers()).for_each(|(c, x)| c[i] = x),
                _ => (all.other[i], all.mixed) = (true, true),
            }
        }
        all
    }

    #[inline(always)]
    fn get(&self, i: usize) -> Flat {
        Flat::on_plane(std::array::from_fn(
            #[inline(always)]
            |k| self.columns[k][i % MOST],
        ))
    }
}

/// What the first `n` rays see. Rays that hit nothing get arbitrary points and the side [`NOWHERE`].
#[pulp::with_simd(arrive_in_lanes = Arch::new())]
#[inline(always)]
pub(crate) fn arrive_in_lanes_with_simd<'a, S: Simd>(
    _simd: S,
    flats: &'a Flats,
    shapes: &'a [Shape],
    rays: &'a mut Rays,
    n: usize,
) {
    for at in (0..n).step_by(LANES) {
        let lane = at..at + LANES;
        let mut o = [[0.0; LANES]; 3];
        let (mut d, mut t, mut prim) = (o, [0.0; LANES], [0; LANES]);
        for (to, from) in o.iter_mut().zip([&rays.o.x, &rays.o.y, &rays.o.z]) {
            to.copy_from_slice(&from[lane.clone()]);
        }
        for (to, from) in d.iter_mut().zip([&rays.d.x, &rays.d.y, &rays.d.z]) {
            to.copy_from_slice(&from[lane.clone()]);
        }
        t.copy_from_slice(&rays.t[lane.clone()]);
        prim.copy_from_slice(&rays.prim[lane.clone()]);
        let (mut q, mut m, mut side) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3], [0; LANES]);
        for i in 0..LANES {
            let flat = flats.get(prim[i] as usize);
            let (o, d) = (Vec3::new(o[0][i], o[1][i], o[2][i]), Vec3::new(d[0][i], d[1][i], d[2][i]));
            let (p, n) = (flat.settle(o + d * t[i]), flat.normal());
            let back = shape::dot(n, d) > 0.0;
            let n = if back { -n } else { n };
            (q[0][i], q[1][i], q[2][i]) = (p.x, p.y, p.z);
            (m[0][i], m[1][i], m[2][i]) = (n.x, n.y, n.z);
            side[i] = if prim[i] == u32::MAX { NOWHERE } else { prim[i].wrapping_mul(2) | u32::from(back) };
        }
        for i in 0..if flats.mixed { LANES } else { 0 } {
            if flats.other[prim[i] as usize % MOST] && prim[i] != u32::MAX {
                let (o, d) = (Vec3::new(o[0][i], o[1][i], o[2][i]), Vec3::new(d[0][i], d[1][i], d[2][i]));
                let v = arrive(shapes, o, d, Hit { t: t[i], prim: prim[i] });
                (q[0][i], q[1][i], q[2][i]) = (v.p.x, v.p.y, v.p.z);
                (m[0][i], m[1][i], m[2][i]) = (v.n.x, v.n.y, v.n.z);
                side[i] = v.side;
            }
        }
        for (c, from) in [(&mut rays.q, &q), (&mut rays.m, &m)] {
            c.x[lane.clone()].copy_from_slice(&from[0]);
            c.y[lane.clone()].copy_from_slice(&from[1]);
            c.z[lane.clone()].copy_from_slice(&from[2]);
        }
        rays.side[lane].copy_from_slice(&side);
    }
}

/// The vertex where one ray arrives.
#[inline(always)]
pub(crate) fn arrive(shapes: &[Shape], o: Vec3, d: Vec3, hit: Hit) -> Vertex {
    let shape = &shapes[hit.prim as usize];
    let p = shape.settle(o + d * hit.t);
    let n = shape.normal(p);
    let back = shape::dot(n, d) > 0.0;
    Vertex { p, n: if back { -n } else { n }, omega: -d, side: 2 * hit.prim + u32::from(back) }
}
