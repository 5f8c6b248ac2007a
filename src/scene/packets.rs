//! Ray tracing in packets: every primitive of a small scene is tested against sixteen rays at once.
//!
//! [`Accel`](super::accel::Accel) traces rays through the tree and gives the same bits (tested). Both use the same formulas of
//! [`shape`](super::shape), and for hits at the same distance both return the lower number. The loops over
//! [lanes](super::sixteen) are plain Rust that the compiler vectorises. `pulp` compiles them for several instruction sets and
//! chooses one at run time.

use super::shape::{Ball, Flat, Shape};
use super::sixteen::{LANES, Lane, Lane3, ZERO3, get, load3};
use super::vertex::Rays;
use crate::math::{Points, Streams};
use glam::Vec3;
use pulp::{Arch, Simd};

/// Largest number of primitives for packets; beyond it the tree is faster.
const SMALL: usize = super::arrive::MOST;

/// Returns true if a scene should be traced in packets: it has few primitives.
pub(crate) fn suit(shapes: &[Shape]) -> bool {
    shapes.len() <= SMALL
}

#[inline(always)]
fn nearest(
    meet: impl Fn(Vec3, Vec3) -> (f32, bool),
    id: u32,
    o: &Lane3,
    d: &Lane3,
    t: &mut Lane,
    prim: &mut [u32; LANES],
) {
    for i in 0..LANES {
        let (s, met) = meet(get(o, i), get(d, i));
        let nearer = met & (s < t[i]);
        t[i] = if nearer { s } else { t[i] };
        prim[i] = if nearer { id } else { prim[i] };
    }
}

/// [`Flat::look`], in the form for a parallelogram along the axes if it is one. The form is chosen here and not for each lane.
macro_rules! by_form {
    ($flat:ident, $look:ident => $work:expr) => {
        match $flat.axis {
            0 => {
                let $look = |o, d| $flat.look_along::<0>(o, d);
                $work
            }
            1 => {
                let $look = |o, d| $flat.look_along::<1>(o, d);
                $work
            }
            2 => {
                let $look = |o, d| $flat.look_along::<2>(o, d);
                $work
            }
            _ => {
                let $look = |o, d| $flat.look(o, d);
                $work
            }
        }
    };
}

/// The same for a parallelogram. Lanes with a ray close to an edge are rare and are tested one by one.
#[inline(always)]
fn nearest_flat(
    s: &Flat,
    look: impl Fn(Vec3, Vec3) -> (f32, bool, bool),
    id: u32,
    o: &Lane3,
    d: &Lane3,
    t: &mut Lane,
    prim: &mut [u32; LANES],
) {
    let mut any = 0;
    for i in 0..LANES {
        let (r, near, certain) = look(get(o, i), get(d, i));
        let near = near & (r < t[i]);
        let nearer = near & certain;
        t[i] = if nearer { r } else { t[i] };
        prim[i] = if nearer { id } else { prim[i] };
        any |= u32::from(near != nearer);
    }
    if any != 0 {
        for i in 0..LANES {
            let (o, d) = (get(o, i), get(d, i));
            let (r, near, certain) = s.look(o, d);
            if near && !certain && r < t[i] && s.edges(o, d) {
                (t[i], prim[i]) = (r, id);
            }
        }
    }
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

/// The nearest hits of the first `n` rays; `prim` is `u32::MAX` if there is none. Reads and writes whole packets.
#[pulp::with_simd(closest = Arch::new())]
#[inline(always)]
pub(crate) fn closest_with_simd<'a, S: Simd>(_simd: S, shapes: &'a [Shape], rays: &'a mut Rays, n: usize) {
    for at in (0..n).step_by(LANES) {
        let (o, d) = (load3(&rays.o, at), load3(&rays.d, at));
        let (mut t, mut prim) = ([f32::INFINITY; LANES], [u32::MAX; LANES]);
        for (id, shape) in shapes.iter().enumerate() {
            match shape {
                Shape::Flat(s) => by_form!(s, look => nearest_flat(s, look, id as u32, &o, &d, &mut t, &mut prim)),
                Shape::Triangle(s) => nearest(|o, d| s.meet(o, d), id as u32, &o, &d, &mut t, &mut prim),
                Shape::Ball(s) => {
                    if any_near(s, &o, &d) {
                        nearest(|o, d| s.meet(o, d), id as u32, &o, &d, &mut t, &mut prim);
                    }
                }
                Shape::Disc(s) => nearest(|o, d| s.meet(o, d), id as u32, &o, &d, &mut t, &mut prim),
            }
        }
        rays.t[at..at + LANES].copy_from_slice(&t);
        rays.prim[at..at + LANES].copy_from_slice(&prim);
    }
}

#[inline(always)]
fn block(meet: impl Fn(Vec3, Vec3) -> (f32, bool), o: &Lane3, d: &Lane3, blocked: &mut [u32; LANES]) {
    for (i, blocked) in blocked.iter_mut().enumerate() {
        let (s, met) = meet(get(o, i), get(d, i));
        *blocked |= u32::from(met & (s < 1.0));
    }
}

/// The same for a parallelogram.
#[inline(always)]
fn block_flat(
    s: &Flat,
    look: impl Fn(Vec3, Vec3) -> (f32, bool, bool),
    o: &Lane3,
    d: &Lane3,
    blocked: &mut [u32; LANES],
) {
    let mut any = 0;
    for (i, blocked) in blocked.iter_mut().enumerate() {
        let (t, near, certain) = look(get(o, i), get(d, i));
        let near = near & (t < 1.0);
        *blocked |= u32::from(near & certain);
        any |= u32::from(near & !certain);
    }
    if any != 0 {
        for (i, blocked) in blocked.iter_mut().enumerate() {
            let (o, d) = (get(o, i), get(d, i));
            let (t, near, certain) = s.look(o, d);
            *blocked |= u32::from(near && !certain && t < 1.0 && s.edges(o, d));
        }
    }
}

/// For each ray in the first `n` entries of `rays.list`: sets `rays.prim[ray]` to 1 if a primitive lies on `o + t·d` with 0
/// < t < 1, else to 0.
#[pulp::with_simd(occluded = Arch::new())]
#[inline(always)]
pub(crate) fn occluded_with_simd<'a, S: Simd>(_simd: S, shapes: &'a [Shape], rays: &'a mut Rays, n: usize) {
    for at in (0..n).step_by(LANES) {
        let list = &rays.list[at..n.min(at + LANES)];
        let (mut o, mut d) = (ZERO3, ZERO3);
        for (lanes, c) in [(&mut o, &rays.o), (&mut d, &rays.d)] {
            for (lane, column) in lanes.iter_mut().zip([&c.x, &c.y, &c.z]) {
                for (a, &ray) in lane.iter_mut().zip(list) {
                    *a = column[ray as usize];
                }
            }
        }
        let mut blocked = [0; LANES];
        for shape in shapes {
            match shape {
                Shape::Flat(s) => by_form!(s, look => block_flat(s, look, &o, &d, &mut blocked)),
                Shape::Triangle(s) => block(|o, d| s.meet(o, d), &o, &d, &mut blocked),
                Shape::Ball(s) => {
                    if any_near(s, &o, &d) {
                        block(|o, d| s.meet(o, d), &o, &d, &mut blocked);
                    }
                }
                Shape::Disc(s) => block(|o, d| s.meet(o, d), &o, &d, &mut blocked),
            }
        }
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
