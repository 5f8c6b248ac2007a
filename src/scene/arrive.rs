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
use super::sixteen::{LANES, ZERO3, get, load, load3, put, store3};
use super::vertex::{NOWHERE, Rays, Vertex};
use glam::Vec3;
use pulp::{Arch, Simd};

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
        let (o, d, t) = (load3(&rays.o, at), load3(&rays.d, at), load(&rays.t, at));
        let mut prim = [0; LANES];
        prim.copy_from_slice(&rays.prim[at..at + LANES]);
        let (mut q, mut m, mut side) = (ZERO3, ZERO3, [NOWHERE; LANES]);
        for i in 0..LANES {
            let flat = flats.get(prim[i] as usize);
            let (p, n) = (flat.settle(get(&o, i) + get(&d, i) * t[i]), flat.normal());
            let back = shape::dot(n, get(&d, i)) > 0.0;
            put(&mut q, i, p);
            put(&mut m, i, if back { -n } else { n });
            side[i] = if prim[i] == u32::MAX { NOWHERE } else { prim[i].wrapping_mul(2) | u32::from(back) };
        }
        for i in 0..if flats.mixed { LANES } else { 0 } {
            if flats.other[prim[i] as usize % MOST] && prim[i] != u32::MAX {
                let v = arrive(shapes, get(&o, i), get(&d, i), Hit { t: t[i], prim: prim[i] });
                put(&mut q, i, v.p);
                put(&mut m, i, v.n);
                side[i] = v.side;
            }
        }
        store3(&mut rays.q, at, &q);
        store3(&mut rays.m, at, &m);
        rays.side[at..at + LANES].copy_from_slice(&side);
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
