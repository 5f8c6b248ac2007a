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
//! Parallelograms, disks and spheres are gathered from [`Table`] into lanes; triangles of small scenes follow one by one. All
//! call the functions of [`shape`](super::shape), so that the bits are those of single rays.

use super::shape::{self, Ball, Flat, Hit, Shape};
use super::sixteen::{LANES, Lane, Lane3, ZERO3, get, load, load3, put, put_if, store3};
use super::vertex::{Rays, Side, Vertex};
use glam::Vec3;
use pulp::{Arch, Simd};

/// Number of primitives in the table: as many as a scene in packets may have.
pub(crate) const MOST: usize = 64;

/// Kinds of primitives.
const FLAT: u32 = 0;
const BALL: u32 = 1;

/// The primitives of a small scene, one column per number, each with zeros for primitives of other kinds.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Parallelograms, and the planes of disks. Nothing is inside the edges of a triangle, so that its hits are found one by one.
    flats: [[f32; MOST]; Flat::NUMBERS],
    balls: [[f64; MOST]; Ball::NUMBERS],
    kind: [u32; MOST],
    balls_too: bool,
}

impl Table {
    /// The table of the first primitives.
    pub(crate) fn new(shapes: &[Shape]) -> Self {
        let mut all = Self {
            flats: [[0.0; MOST]; Flat::NUMBERS],
            balls: [[0.0; MOST]; Ball::NUMBERS],
            kind: [FLAT; MOST],
            balls_too: false,
        };
        for (i, shape) in shapes.iter().take(MOST).enumerate() {
            let mut flat = [0.0; Flat::NUMBERS];
            match shape {
                Shape::Flat(s) => flat = s.numbers(),
                Shape::Disc(s) => flat = s.numbers(),
                Shape::Ball(s) => {
                    all.balls.iter_mut().zip(s.numbers()).for_each(|(c, x)| c[i] = x);
                    (all.kind[i], all.balls_too) = (BALL, true);
                }
                Shape::Triangle(_) => flat[Flat::NUMBERS - 2..].fill(-1.0),
            }
            all.flats.iter_mut().zip(flat).for_each(|(c, x)| c[i] = x);
        }
        all
    }

    #[inline(always)]
    fn flat(&self, i: u32) -> Flat {
        Flat::on_plane(std::array::from_fn(
            #[inline(always)]
            |k| self.flats[k][i as usize % MOST],
        ))
    }

    #[inline(always)]
    fn ball(&self, i: u32) -> Ball {
        Ball::around(std::array::from_fn(
            #[inline(always)]
            |k| self.balls[k][i as usize % MOST],
        ))
    }
}

/// Sixteen vertices in the making: points, normals on the side of the rays, sides.
struct Seen {
    q: Lane3,
    m: Lane3,
    side: [Side; LANES],
}

/// What the first `n` rays see. Rays that hit nothing see `nothing`, at the distance `beyond`.
#[pulp::with_simd(arrive_in_lanes = Arch::new())]
#[inline(always)]
pub(crate) fn arrive_in_lanes_with_simd<'a, S: Simd>(
    _simd: S,
    table: &'a Table,
    shapes: &'a [Shape],
    rays: &'a mut Rays,
    n: usize,
    (nothing, beyond): (Side, f32),
) {
    for at in (0..n).step_by(LANES) {
        let (o, d, t) = (load3(&rays.o, at), load3(&rays.d, at), load(&rays.t, at));
        let mut prim = [0; LANES];
        prim.copy_from_slice(&rays.prim[at..at + LANES]);
        let mut seen = Seen { q: ZERO3, m: ZERO3, side: [nothing; LANES] };
        let mut outside = 0;
        for i in 0..LANES {
            let (o, d, is) = (get(&o, i), get(&d, i), prim[i] != u32::MAX);
            let flat = table.flat(prim[i]);
            let ((p, _, inside), n) = (flat.settle_inside(o + d * t[i]), flat.normal());
            outside |= u32::from(is & !inside);
            let back = shape::dot(n, d) > 0.0;
            let far = o + d * beyond;
            put(&mut seen.q, i, if is { p } else { far });
            put(&mut seen.m, i, if is & !back { n } else { -if is { n } else { d } });
            seen.side[i] = if is { prim[i].wrapping_mul(2) | u32::from(back) } else { nothing };
        }
        if table.balls_too {
            let mut balls = 0;
            for prim in prim {
                balls |= u32::from((table.kind[prim as usize % MOST] == BALL) & (prim != u32::MAX));
            }
            if balls != 0 {
                arrive_on_balls(table, (&o, &d, &t), &prim, &mut seen);
            }
        }
        // hits to be moved inside the edges, and triangles
        for i in 0..if outside != 0 { LANES } else { 0 } {
            if prim[i] != u32::MAX && table.kind[prim[i] as usize % MOST] == FLAT {
                let v = arrive(shapes, get(&o, i), get(&d, i), Hit { t: t[i], prim: prim[i] });
                put(&mut seen.q, i, v.p);
                put(&mut seen.m, i, v.n);
                seen.side[i] = v.side;
            }
        }
        store3(&mut rays.q, at, &seen.q);
        store3(&mut rays.m, at, &seen.m);
        rays.side[at..at + LANES].copy_from_slice(&seen.side);
    }
}

#[inline(always)]
fn arrive_on_balls(table: &Table, (o, d, t): (&Lane3, &Lane3, &Lane), prim: &[u32; LANES], seen: &mut Seen) {
    for i in 0..LANES {
        let ball = table.ball(prim[i]);
        let p = ball.settle(get(o, i) + get(d, i) * t[i]);
        let n = ball.normal(p);
        let back = shape::dot(n, get(d, i)) > 0.0;
        let is = (table.kind[prim[i] as usize % MOST] == BALL) & (prim[i] != u32::MAX);
        put_if(&mut seen.q, i, is, p);
        put_if(&mut seen.m, i, is, if back { -n } else { n });
        seen.side[i] = if is { prim[i].wrapping_mul(2) | u32::from(back) } else { seen.side[i] };
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
