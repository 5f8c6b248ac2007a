//! Ray tracing with a tree of boxes: the first surface on a ray, and a test whether a segment is free.
//!
//! The tree is [`wide`](super::wide). If two primitives are hit at the same distance, the one with the lower number is
//! returned, whatever the order of traversal. A wave of rays shares one choice of the instruction set. Single rays in very small
//! scenes go without the tree: [`few`](super::few). Large shapes are tested before it: [`front`](super::front).

use super::enter::Entrance;
use super::few::Few;
use super::front::Front;
use super::rounding::{EPSILON, WIDER};
use super::shape::{Hit, Shape};
use super::vertex::Rays;
use super::wide::{Closest, InstructionSet, Lanes, Occluded, Task, Wide};
use glam::{DVec3, Vec3};
use std::cell::Cell;

pub(crate) struct Accel {
    pub(crate) shapes: Vec<Shape>,
    wide: Wide,
    few: Option<Few>,
    /// Large shapes, and the box of the tree behind them.
    front: Option<(Front, Entrance)>,
    best: InstructionSet,
}

/// The bounding box of a primitive, enlarged so that the rounding of the box test never loses a hit. The margin is 4 ε times
/// the largest coordinate from which a ray may start, plus the distance by which hits may lie beyond the edges of the
/// primitive. `farthest` is the largest coordinate of the scene, `touch` the distance at which two corners count as one.
pub(crate) fn widened([low, high]: [DVec3; 2], farthest: f64, touch: f64) -> [Vec3; 2] {
    let most = low.abs().max(high.abs());
    // rays start at most three scene sizes away
    let by = 32.0 * EPSILON * most + 16.0 * EPSILON * farthest + touch + 2.0 * WIDER * (high - low);
    [(low - by).as_vec3(), (high + by).as_vec3()]
}

impl Accel {
    /// Builds the tree; `bounds` are the [`widened`] boxes of the shapes.
    pub(crate) fn new(shapes: Vec<Shape>, bounds: Vec<[Vec3; 2]>) -> Self {
        let few = Few::new(&shapes);
        let front = if few.is_none() { Front::of(&shapes, &bounds) } else { None };
        let wide = Wide::new(&shapes, bounds, front.as_ref().map_or(&[], Front::prims));
        let front = front.map(|front| (front, Entrance::of(&wide)));
        Self { shapes, wide, few, front, best: InstructionSet::best() }
    }

    /// The nearest hit with t > 0 on the ray `o + t·d`.
    pub(crate) fn closest(&self, o: Vec3, d: Vec3) -> Hit {
        self.best.run(ClosestOne { accel: self, o, d })
    }

    /// Returns true if a primitive lies on `o + t·d` with 0 < t < 1.
    pub(crate) fn occluded(&self, o: Vec3, d: Vec3) -> bool {
        self.best.run(OccludedOne { accel: self, o, d })
    }

    /// The nearest hits of the first `n` rays: writes `rays.t` and `rays.prim`, which is `u32::MAX` if there is none.
    pub(crate) fn closest_wave(&self, rays: &mut Rays, n: usize) {
        self.closest_wave_by(self.best, rays, n);
    }

    /// The same with the instructions of `set`.
    pub(crate) fn closest_wave_by(&self, set: InstructionSet, rays: &mut Rays, n: usize) {
        set.run(ClosestWave { accel: self, rays, n });
    }

    /// For each ray in the first `n` entries of `rays.list`: sets `rays.prim[ray]` to 1 if a primitive lies on `o + t·d` with
    /// 0 < t < 1, else to 0.
    pub(crate) fn occluded_wave(&self, rays: &mut Rays, n: usize) {
        self.occluded_wave_by(self.best, rays, n);
    }

    /// The same with the instructions of `set`.
    pub(crate) fn occluded_wave_by(&self, set: InstructionSet, rays: &mut Rays, n: usize) {
        set.run(OccludedWave { accel: self, rays, n });
    }
}

struct ClosestOne<'a> {
    accel: &'a Accel,
    o: Vec3,
    d: Vec3,
}

impl Task for ClosestOne<'_> {
    type Output = Hit;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Hit {
        let Self { accel: Accel { shapes, wide, few, front, .. }, o, d } = self;
        if let Some(few) = few {
            return few.closest(shapes, o, d);
        }
        let best = if let Some((front, _)) = front { front.closest(shapes, o, d) } else { Hit::NONE };
        wide.search_one(l, shapes, Closest::new(o, d, best))
    }
}

struct OccludedOne<'a> {
    accel: &'a Accel,
    o: Vec3,
    d: Vec3,
}

impl Task for OccludedOne<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> bool {
        let Self { accel: Accel { shapes, wide, few, front, .. }, o, d } = self;
        if let Some(few) = few {
            return few.occluded(shapes, o, d);
        }
        if let Some((front, _)) = front
            && front.occluded(shapes, o, d)
        {
            return true;
        }
        wide.search_one(l, shapes, Occluded::new(o, d))
    }
}

struct ClosestWave<'a> {
    accel: &'a Accel,
    rays: &'a mut Rays,
    n: usize,
}

impl Task for ClosestWave<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { accel: Accel { shapes, wide, front, .. }, rays, n } = self;
        let list = if let Some((front, entrance)) = front {
            entrance.closest(front, rays, n)
        } else {
            rays.prim[..n].fill(u32::MAX);
            rays.t[..n].fill(f32::INFINITY);
            (0..n as u32).collect()
        };
        let Rays { o, d, t, prim, .. } = rays;
        let (t, prim) =
            (Cell::from_mut(&mut t[..n]).as_slice_of_cells(), Cell::from_mut(&mut prim[..n]).as_slice_of_cells());
        wide.search_all(
            l,
            shapes,
            &list,
            #[inline(always)]
            |i| Closest::new(o.get(i), d.get(i), Hit { t: t[i].get(), prim: prim[i].get() }),
            #[inline(always)]
            |i, hit| {
                t[i].set(hit.t);
                prim[i].set(hit.prim);
            },
        );
    }
}

struct OccludedWave<'a> {
    accel: &'a Accel,
    rays: &'a mut Rays,
    n: usize,
}

impl Task for OccludedWave<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { accel: Accel { shapes, wide, front, .. }, rays, n } = self;
        let list = match front {
            Some((front, entrance)) => entrance.occluded(front, rays, n),
            None => rays.list[..n].to_vec(),
        };
        let Rays { o, d, prim, .. } = rays;
        wide.search_all(
            l,
            shapes,
            &list,
            #[inline(always)]
            |i| Occluded::new(o.get(i), d.get(i)),
            #[inline(always)]
            |i, blocked| prim[i] = u32::from(blocked),
        );
    }
}
