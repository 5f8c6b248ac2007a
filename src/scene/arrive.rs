//! What the rays of a wave see: the point, the normal and the side where each ray arrives, in SIMD lanes.
//!
//! ```text
//! x = settle(o + t d)        n = ± normal of the primitive, on the side of the ray
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | o, d | the ray | `Rays::o`, `d` |
//! | t, primitive | what it meets first | [`Met`] |
//! | x, n, side | what it sees | `Rays::q`, `m`, `side` |
//!
//! In small scenes, planes of parallelograms and disks, and spheres, are gathered from [`Table`] into lanes. Triangles, and hits
//! near the edge of a parallelogram, follow one by one. In larger scenes, each ray takes the [`Sheet`] of its shape. All call the
//! functions of [`shape`](super::shape) or give the same bits (tested).

use super::packets::{self, MOST, Met};
use super::rounding::onto;
use super::shape::{self, Ball, Hit, Shape};
use super::sheet::Sheet;
use super::sixteen::{LANES, Lane, Lane3, ZERO3, get, load3, put, put_if, store3};
use super::vertex::{Rays, Side, Vertex};
use glam::Vec3;
use pulp::{Arch, Simd};

/// How the rays of a wave are traced, and what finds where they arrive.
#[derive(Debug)]
pub(crate) enum Arrivals {
    /// In packets, in a scene of few shapes.
    ByPackets(Box<Table>),
    /// Through the tree; a sheet for each shape.
    ByTree(Vec<Sheet>),
}

impl Arrivals {
    /// What is faster for these shapes.
    pub(crate) fn new(shapes: &[Shape]) -> Self {
        if packets::suit(shapes) { Self::ByPackets(Box::new(Table::new(shapes))) } else { Self::by_tree(shapes) }
    }

    /// Through the tree, also in a scene of few shapes.
    pub(crate) fn by_tree(shapes: &[Shape]) -> Self {
        Self::ByTree(shapes.iter().map(Sheet::new).collect())
    }
}

/// Kinds of primitives.
const FLAT: u32 = 0;
const BALL: u32 = 1;

/// The primitives of a small scene, one column per number, each with zeros for primitives of other kinds.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Normals and distances of the planes of parallelograms and disks.
    planes: [[f32; MOST]; 4],
    /// Hits with larger coordinates than this are settled one by one: near the edges of parallelograms, and on triangles.
    deep: [f32; MOST],
    balls: [[f64; MOST]; Ball::NUMBERS],
    kind: [u32; MOST],
    balls_too: bool,
}

impl Table {
    /// The table of the first primitives.
    pub(crate) fn new(shapes: &[Shape]) -> Self {
        let mut all = Self {
            planes: [[0.0; MOST]; 4],
            deep: [f32::INFINITY; MOST],
            balls: [[0.0; MOST]; Ball::NUMBERS],
            kind: [FLAT; MOST],
            balls_too: false,
        };
        for (i, shape) in shapes.iter().take(MOST).enumerate() {
            let mut plane = (Vec3::ZERO, 0.0);
            match shape {
                Shape::Flat(s) => (plane, all.deep[i]) = (s.plane(), s.deep()),
                Shape::Disc(s) => plane = s.plane(),
                Shape::Ball(s) => {
                    all.balls.iter_mut().zip(s.numbers()).for_each(|(c, x)| c[i] = x);
                    (all.kind[i], all.balls_too) = (BALL, true);
                }
                Shape::Triangle(_) => all.deep[i] = -1.0,
            }
            let (n, h) = plane;
            all.planes.iter_mut().zip([n.x, n.y, n.z, h]).for_each(|(c, x)| c[i] = x);
        }
        all
    }

    #[inline(always)]
    fn plane(&self, i: u32) -> (Vec3, f32) {
        let [x, y, z, h] = &self.planes;
        let i = i as usize % MOST;
        (Vec3::new(x[i], y[i], z[i]), h[i])
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
#[pulp::with_simd(look_in_lanes = Arch::new())]
#[inline(always)]
pub(crate) fn look_in_lanes_with_simd<'a, S: Simd>(
    _simd: S,
    table: &'a Table,
    shapes: &'a [Shape],
    rays: &'a mut Rays,
    n: usize,
    nothing: (Side, f32),
) {
    for at in (0..n).step_by(LANES) {
        let (o, d) = (load3(&rays.o, at), load3(&rays.d, at));
        let seen = if table.balls_too {
            see(table, shapes, (&o, &d), &packets::meet::<true>(shapes, &o, &d), nothing)
        } else {
            see(table, shapes, (&o, &d), &packets::meet::<false>(shapes, &o, &d), nothing)
        };
        store3(&mut rays.q, at, &seen.q);
        store3(&mut rays.m, at, &seen.m);
        rays.side[at..at + LANES].copy_from_slice(&seen.side);
    }
}

/// What sixteen rays see where they meet the shapes.
#[inline(always)]
fn see(table: &Table, shapes: &[Shape], (o, d): (&Lane3, &Lane3), met: &Met, (nothing, beyond): (Side, f32)) -> Seen {
    let Met { t, prim, most } = met;
    let mut seen = Seen { q: ZERO3, m: ZERO3, side: [nothing; LANES] };
    let mut shallow = 0;
    for i in 0..LANES {
        let (o, d, is) = (get(o, i), get(d, i), prim[i] != u32::MAX);
        let (n, h) = table.plane(prim[i]);
        shallow |= u32::from(is & (most[i] > table.deep[prim[i] as usize % MOST]));
        let p = onto(o + d * t[i], n, h);
        let back = shape::dot(n, d) > 0.0;
        let far = o + d * beyond;
        put(&mut seen.q, i, if is { p } else { far });
        put(&mut seen.m, i, if is & !back { n } else { -if is { n } else { d } });
        seen.side[i] = if is { prim[i].wrapping_mul(2) | u32::from(back) } else { nothing };
    }
    if table.balls_too {
        let mut balls = 0;
        for &prim in prim {
            balls |= u32::from((table.kind[prim as usize % MOST] == BALL) & (prim != u32::MAX));
        }
        if balls != 0 {
            see_balls(table, (o, d, t), prim, &mut seen);
        }
    }
    // hits to be moved inside the edges, and triangles
    for i in 0..if shallow != 0 { LANES } else { 0 } {
        if prim[i] != u32::MAX && table.kind[prim[i] as usize % MOST] == FLAT {
            let v = arrive(shapes, get(o, i), get(d, i), Hit { t: t[i], prim: prim[i] });
            put(&mut seen.q, i, v.p);
            put(&mut seen.m, i, v.n);
            seen.side[i] = v.side;
        }
    }
    seen
}

#[inline(always)]
fn see_balls(table: &Table, (o, d, t): (&Lane3, &Lane3, &Lane), prim: &[u32; LANES], seen: &mut Seen) {
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

/// Rays whose sheets are found together.
const AHEAD: usize = 16;

/// What the first `n` rays see in a scene of any size, from `rays.t` and `rays.prim`; like [`look_in_lanes`]. There is a sheet for each
/// shape.
pub(crate) fn see_by_sheets(
    sheets: &[Sheet],
    shapes: &[Shape],
    rays: &mut Rays,
    n: usize,
    (nothing, beyond): (Side, f32),
) {
    for first in (0..n).step_by(AHEAD) {
        // the memory of sixteen sheets, which is far away, is waited for once
        let normals: [Vec3; AHEAD] =
            std::array::from_fn(|j| sheets.get(rays.prim[first + j] as usize).map_or(Vec3::NAN, Sheet::normal));
        for (i, normal) in (first..n).zip(normals) {
            let (o, d, hit) = (rays.o.get(i), rays.d.get(i), Hit { t: rays.t[i], prim: rays.prim[i] });
            let v = match sheets.get(hit.prim as usize) {
                Some(sheet) => match sheet.settle(o + d * hit.t) {
                    Some(p) => vertex(p, normal, d, hit.prim),
                    None => arrive(shapes, o, d, hit),
                },
                None => Vertex { p: o + d * beyond, n: -d, omega: -d, side: nothing },
            };
            rays.q.set(i, v.p);
            rays.m.set(i, v.n);
            rays.side[i] = v.side;
        }
    }
}

/// The vertex where one ray arrives.
#[inline(always)]
pub(crate) fn arrive(shapes: &[Shape], o: Vec3, d: Vec3, hit: Hit) -> Vertex {
    let shape = &shapes[hit.prim as usize];
    let p = shape.settle(o + d * hit.t);
    vertex(p, shape.normal(p), d, hit.prim)
}

#[inline(always)]
fn vertex(p: Vec3, n: Vec3, d: Vec3, prim: u32) -> Vertex {
    let back = shape::dot(n, d) > 0.0;
    Vertex { p, n: if back { -n } else { n }, omega: -d, side: 2 * prim + u32::from(back) }
}
