//! Ray tracing in packets: every primitive of a small scene is tested against sixteen rays at once.
//!
//! [`Accel`](super::accel::Accel) traces rays through the tree and gives the same bits (tested). Both use the same formulas of
//! [`shape`](super::shape), and for hits at the same distance both return the lower number. The loops over
//! [lanes](super::sixteen) are plain Rust that the compiler vectorises. `pulp` compiles them for several instruction sets and
//! chooses one at run time.

use super::flat::{Flat, Form};
use super::shape::{Ball, Shape};
use super::sixteen::{LANES, Lane, Lane3, ZERO, get, load_some, load3};
use super::vertex::Rays;
use crate::math::{Points, Streams};
use glam::Vec3;
use pulp::{Arch, Simd};

/// Largest number of primitives for packets; beyond it the tree is faster.
pub(super) const MOST: usize = 64;

/// Returns true if a scene should be traced in packets: it has few primitives.
pub(crate) fn suit(shapes: &[Shape]) -> bool {
    shapes.len() <= MOST
}

/// The first hits of sixteen rays.
pub(super) struct Met {
    pub(super) t: Lane,
    /// `u32::MAX` if a ray meets nothing.
    pub(super) prim: [u32; LANES],
    /// The larger coordinate across a parallelogram, in absolute value.
    pub(super) most: Lane,
}

impl Met {
    const NOTHING: Self = Self { t: [f32::INFINITY; LANES], prim: [u32::MAX; LANES], most: ZERO };

    /// Takes the hits that are nearer. Every lane is written, and none under a condition or alone: that would keep the lanes
    /// in memory instead of registers, and a ray would take half as long again.
    #[inline(always)]
    fn take(&mut self, t: &Lane, most: &Lane, id: u32) {
        let Self { t: old, prim, most: old_most } = *self;
        let (mut nearest, mut of, mut its) = (ZERO, [0; LANES], ZERO);
        for i in 0..LANES {
            let nearer = t[i] < old[i];
            nearest[i] = if nearer { t[i] } else { old[i] };
            of[i] = if nearer { id } else { prim[i] };
            its[i] = if nearer { most[i] } else { old_most[i] };
        }
        *self = Self { t: nearest, prim: of, most: its };
    }
}

/// The distances at which rays meet a shape; ∞ if they do not.
#[inline(always)]
fn distances(meet: impl Fn(Vec3, Vec3) -> (f32, bool), o: &Lane3, d: &Lane3) -> Lane {
    let mut r = ZERO;
    for (i, r) in r.iter_mut().enumerate() {
        let (t, met) = meet(get(o, i), get(d, i));
        *r = if met { t } else { f32::INFINITY };
    }
    r
}

/// [`Flat::look`] in the form of a parallelogram. The form is chosen here and not for each lane.
macro_rules! by_form {
    ($flat:ident, $look:ident => $work:expr) => {
        by_form!($flat, $look => $work, Aligned: look_aligned, Upright: look_upright, 0 1 2)
    };
    ($flat:ident, $look:ident => $work:expr, Aligned: $aligned:ident, Upright: $upright:ident, $x:literal $y:literal $z:literal) => {
        match $flat.form {
            Form::Aligned($x) => by_form!($flat.$aligned::<$x>, $look => $work),
            Form::Aligned($y) => by_form!($flat.$aligned::<$y>, $look => $work),
            Form::Aligned(_) => by_form!($flat.$aligned::<$z>, $look => $work),
            Form::Upright($x) => by_form!($flat.$upright::<$x>, $look => $work),
            Form::Upright($y) => by_form!($flat.$upright::<$y>, $look => $work),
            Form::Upright(_) => by_form!($flat.$upright::<$z>, $look => $work),
            Form::General => {
                let $look = |o, d| $flat.look(o, d);
                $work
            }
        }
    };
    ($flat:ident.$by:ident::<$axis:literal>, $look:ident => $work:expr) => {{
        let $look = |o, d| $flat.$by::<$axis>(o, d);
        $work
    }};
}

/// Takes the hits of a parallelogram. Lanes with a ray close to an edge are rare and are tested one by one.
#[inline(always)]
fn nearest_flat(s: &Flat, look: impl Fn(Vec3, Vec3) -> (f32, f32), id: u32, o: &Lane3, d: &Lane3, met: &mut Met) {
    let (mut any, mut r, mut most) = (0, ZERO, ZERO);
    for i in 0..LANES {
        let (t, m) = look(get(o, i), get(d, i));
        let (near, sure) = (s.near(t, m), m <= 1.0);
        // without a look at `met`: the next primitive need not wait for this one
        r[i] = if near & sure { t } else { f32::INFINITY };
        most[i] = m;
        any |= u32::from(near & !sure & (t < met.t[i]));
    }
    met.take(&r, &most, id);
    if any != 0 {
        met.take(&by_edges(s, o, d), &[f32::INFINITY; LANES], id);
    }
}

/// The distances at which rays close to an edge meet the parallelogram; ∞ for all others.
#[inline(always)]
fn by_edges(s: &Flat, o: &Lane3, d: &Lane3) -> Lane {
    let mut r = [f32::INFINITY; LANES];
    for (i, r) in r.iter_mut().enumerate() {
        let (o, d) = (get(o, i), get(d, i));
        let (t, most) = s.look(o, d);
        if s.near(t, most) && most > 1.0 && s.edges(o, d) {
            *r = t;
        }
    }
    r
}

/// Returns true if some ray may meet the sphere.
#[inline(always)]
fn any_near(s: &Ball, o: &Lane3, d: &Lane3) -> bool {
    let mut near = 0;
    for i in 0..LANES {
        near |= u32::from(!s.passes(get(o, i), get(d, i)));
    }
    near != 0
}

/// What sixteen rays meet first. `BALLS` is false if there are no spheres: what they prepare for each packet is then left out.
#[inline(always)]
pub(super) fn meet<const BALLS: bool>(shapes: &[Shape], o: &Lane3, d: &Lane3) -> Met {
    let mut met = Met::NOTHING;
    for (id, shape) in shapes.iter().enumerate() {
        let id = id as u32;
        match shape {
            Shape::Flat(s) => by_form!(s, look => nearest_flat(s, look, id, o, d, &mut met)),
            Shape::Triangle(s) => met.take(&distances(|o, d| s.meet(o, d), o, d), &ZERO, id),
            Shape::Ball(s) => {
                if BALLS && any_near(s, o, d) {
                    met.take(&distances(|o, d| s.meet(o, d), o, d), &ZERO, id);
                }
            }
            Shape::Disc(s) => met.take(&distances(|o, d| s.meet(o, d), o, d), &ZERO, id),
        }
    }
    met
}

fn balls(shapes: &[Shape]) -> bool {
    shapes.iter().any(|s| matches!(s, Shape::Ball(_)))
}

/// The nearest hits of the first `n` rays; `prim` is `u32::MAX` if there is none. Reads and writes whole packets.
#[pulp::with_simd(closest = Arch::new())]
#[inline(always)]
pub(crate) fn closest_with_simd<'a, S: Simd>(_simd: S, shapes: &'a [Shape], rays: &'a mut Rays, n: usize) {
    for at in (0..n).step_by(LANES) {
        let (o, d) = (load3(&rays.o, at), load3(&rays.d, at));
        let met = meet::<true>(shapes, &o, &d);
        rays.t[at..at + LANES].copy_from_slice(&met.t);
        rays.prim[at..at + LANES].copy_from_slice(&met.prim);
    }
}

/// Blocks the lanes in which `r` is below 1; like [`take`], for all lanes at once.
#[inline(always)]
fn block(r: &Lane, blocked: &mut [u32; LANES]) {
    let mut all = [0; LANES];
    for i in 0..LANES {
        all[i] = if r[i] < 1.0 { 1 } else { blocked[i] };
    }
    *blocked = all;
}

/// The same for a parallelogram.
#[inline(always)]
fn block_flat(s: &Flat, look: impl Fn(Vec3, Vec3) -> (f32, f32), o: &Lane3, d: &Lane3, blocked: &mut [u32; LANES]) {
    let (mut any, mut r) = (0, ZERO);
    for (i, r) in r.iter_mut().enumerate() {
        let (t, most) = look(get(o, i), get(d, i));
        let (near, sure) = (s.near(t, most), most <= 1.0);
        *r = if near & sure { t } else { f32::INFINITY };
        any |= u32::from(near & !sure & (t < 1.0));
    }
    block(&r, blocked);
    if any != 0 {
        block(&by_edges(s, o, d), blocked);
    }
}

/// Which of sixteen segments are blocked: 1 if a primitive lies on `o + t·d` with 0 < t < 1, else 0.
#[inline(always)]
fn any<const BALLS: bool>(shapes: &[Shape], o: &Lane3, d: &Lane3) -> [u32; LANES] {
    let mut blocked = [0; LANES];
    for shape in shapes {
        match shape {
            Shape::Flat(s) => by_form!(s, look => block_flat(s, look, o, d, &mut blocked)),
            Shape::Triangle(s) => block(&distances(|o, d| s.meet(o, d), o, d), &mut blocked),
            Shape::Ball(s) => {
                if BALLS && any_near(s, o, d) {
                    block(&distances(|o, d| s.meet(o, d), o, d), &mut blocked);
                }
            }
            Shape::Disc(s) => block(&distances(|o, d| s.meet(o, d), o, d), &mut blocked),
        }
    }
    blocked
}

/// For each ray in the first `n` entries of `rays.list`: sets `rays.prim[ray]` to 1 if a primitive lies on `o + t·d` with 0
/// < t < 1, else to 0.
#[pulp::with_simd(occluded = Arch::new())]
#[inline(always)]
pub(crate) fn occluded_with_simd<'a, S: Simd>(_simd: S, shapes: &'a [Shape], rays: &'a mut Rays, n: usize) {
    let balls = balls(shapes);
    for at in (0..n).step_by(LANES) {
        let list = &rays.list[at..n.min(at + LANES)];
        let (o, d) = (load_some(&rays.o, list), load_some(&rays.d, list));
        let blocked = if balls { any::<true>(shapes, &o, &d) } else { any::<false>(shapes, &o, &d) };
        for (&ray, &b) in list.iter().zip(&blocked) {
            rays.prim[ray as usize] = b;
        }
    }
}

/// The four numbers of the first draw of every random stream, as columns.
#[pulp::with_simd(numbers = Arch::new())]
#[inline(always)]
pub(crate) fn numbers_with_simd<'a, S: Simd>(_simd: S, streams: Streams<'a>, u: &'a mut [Vec<f32>; 4]) {
    let n = streams.len();
    let (pixel, sample) = (&streams.pixel[..n], &streams.sample[..n]);
    let [a, b, c, d] = u.each_mut().map(|u| &mut u[..n]);
    let streams = Streams { pixel, sample, ..streams };
    if streams.key.points() == Points::Sobol {
        return streams.sobol_draws([a, b, c, d]);
    }
    for i in 0..n {
        [a[i], b[i], c[i], d[i]] = streams.first_draw(i);
    }
}
