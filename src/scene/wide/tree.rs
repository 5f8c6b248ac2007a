//! The tree of boxes, and how a ray goes through it.
//!
//! | question | order | stops |
//! |---|---|---|
//! | [`Closest`]: the first hit | by the distance of the boxes | when all boxes that are left begin behind the best hit |
//! | [`Occluded`]: any hit with t < 1 | as stored: the largest box first | at the first hit |
//!
//! A search goes through the tree in steps, so that [two rays](super::two) can take turns. Each stack entry of the first
//! question is one number: the distance of the box above the number of the child. Distances are not negative, so the entries
//! sort as integers.

use super::super::shape::{Hit, Shape};
use super::lanes::{Lanes, N};
use super::leaves::Leaves;
use super::node::{FARTHEST, LEAF, Node, SINGLE, Slabs};
use glam::Vec3;

/// A tree of eight-wide nodes over shapes; see [`super`].
pub(crate) struct Wide {
    pub(crate) nodes: Vec<Node>,
    pub(crate) leaves: Leaves,
    /// Largest number of children that wait at one time.
    pub(crate) waiting: usize,
}

/// A ray on its way through the tree.
pub(crate) trait Search {
    /// What is asked for.
    type Answer;
    /// Visits one child and chooses the next. Returns true if the answer is known. `stack` has room for [`Wide::waiting`] entries; it
    /// must be the same for all steps of a search.
    fn step<L: Lanes>(&mut self, l: L, tree: &Wide, shapes: &[Shape], stack: &mut [u64]) -> bool;
    /// The answer.
    fn answer(&self) -> Self::Answer;
}

/// The distance at which a box begins, above the number of the child.
#[inline(always)]
fn entry(t: f32, child: u32) -> u64 {
    u64::from(t.to_bits()) << 32 | u64::from(child)
}

/// The lowest bit of a set, which must not be empty, and the rest.
#[inline(always)]
fn first(set: u32) -> (usize, u32) {
    (set.trailing_zeros() as usize % N, set & (set - 1))
}

/// The highest bit of a set, which must not be empty, and the rest.
#[inline(always)]
fn last(set: u32) -> (usize, u32) {
    let i = 31 - set.leading_zeros();
    (i as usize % N, set ^ (1 << i))
}

/// The nearest hit with t > 0; of two at the same distance the one with the lower number.
pub(crate) struct Closest {
    slabs: Slabs,
    o: Vec3,
    d: Vec3,
    best: Hit,
    /// How far to look.
    most: f32,
    /// Number of children that wait on the stack.
    top: usize,
    /// The child that is visited next.
    current: u32,
}

impl Closest {
    /// Begins at the root. `best` is the nearest hit of shapes outside the tree.
    #[inline(always)]
    pub(crate) fn new(o: Vec3, d: Vec3, best: Hit) -> Self {
        Self { slabs: Slabs::new(o, d), o, d, best, most: behind(best.t), top: 0, current: 0 }
    }
}

/// How far to look after a hit at t: slightly farther, so that a hit at the same t with a lower number is still visited.
#[inline(always)]
pub(crate) fn behind(t: f32) -> f32 {
    (t * (1.0 + 1e-6)).min(FARTHEST)
}

impl Search for Closest {
    type Answer = Hit;

    #[inline(always)]
    fn step<L: Lanes>(&mut self, l: L, tree: &Wide, shapes: &[Shape], stack: &mut [u64]) -> bool {
        let Self { slabs, o, d, best, most, top, current } = self;
        if *current & LEAF == 0 {
            let node = &tree.nodes[*current as usize];
            let (met, t) = node.meet(l, slabs, *most);
            if met != 0 {
                let (i, mut met) = first(met);
                let mut nearest = entry(t[i], node.child[i]);
                let base = *top;
                while met != 0 {
                    let (i, rest) = first(met);
                    met = rest;
                    let new = entry(t[i], node.child[i]);
                    let (near, far) = if nearest < new { (nearest, new) } else { (new, nearest) };
                    nearest = near;
                    // sorted above `base`, the nearest on top: there are rarely more than three
                    let mut at = *top;
                    while at > base && stack[at - 1] < far {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = far;
                    *top += 1;
                }
                *current = nearest as u32;
                return false;
            }
        } else {
            if *current & SINGLE == 0 {
                tree.leaves.nearest(l, *current & !LEAF, *o, *d, best);
            } else {
                let prim = *current & !(LEAF | SINGLE);
                let (t, met) = shapes[prim as usize].meet(*o, *d);
                if met {
                    best.take(Hit { t, prim });
                }
            }
            *most = behind(best.t);
        }
        loop {
            if *top == 0 {
                return true;
            }
            *top -= 1;
            if f32::from_bits((stack[*top] >> 32) as u32) <= *most {
                *current = stack[*top] as u32;
                return false;
            }
        }
    }

    #[inline(always)]
    fn answer(&self) -> Hit {
        self.best
    }
}

/// Whether a shape lies at 0 < t < 1.
pub(crate) struct Occluded {
    slabs: Slabs,
    o: Vec3,
    d: Vec3,
    blocked: bool,
    /// Number of children that wait on the stack.
    top: usize,
    /// The child that is visited next.
    current: u32,
}

impl Occluded {
    /// Begins at the root.
    #[inline(always)]
    pub(crate) fn new(o: Vec3, d: Vec3) -> Self {
        Self { slabs: Slabs::new(o, d), o, d, blocked: false, top: 0, current: 0 }
    }
}

impl Search for Occluded {
    type Answer = bool;

    #[inline(always)]
    fn step<L: Lanes>(&mut self, l: L, tree: &Wide, shapes: &[Shape], stack: &mut [u64]) -> bool {
        let Self { slabs, o, d, blocked, top, current } = self;
        if *current & LEAF == 0 {
            let node = &tree.nodes[*current as usize];
            let (met, _) = node.meet(l, slabs, 1.0);
            if met != 0 {
                let (i, mut met) = first(met);
                while met != 0 {
                    let (i, rest) = last(met);
                    met = rest;
                    stack[*top] = u64::from(node.child[i]);
                    *top += 1;
                }
                *current = node.child[i];
                return false;
            }
        } else if *current & SINGLE == 0 {
            *blocked = tree.leaves.occluded(l, *current & !LEAF, *o, *d);
        } else {
            let (t, met) = shapes[(*current & !(LEAF | SINGLE)) as usize].meet(*o, *d);
            *blocked = met && t < 1.0;
        }
        if *blocked || *top == 0 {
            return true;
        }
        *top -= 1;
        *current = stack[*top] as u32;
        false
    }

    #[inline(always)]
    fn answer(&self) -> bool {
        self.blocked
    }
}

/// Room for the stack of a single ray on the stack of the program: enough for trees of millions of primitives, and enough for
/// those of small scenes, for which clearing more would take as long as a part of the ray.
const ROOM: usize = 96;
const SMALL_ROOM: usize = 32;

impl Wide {
    /// The box of everything in the tree.
    pub(crate) fn bounds(&self) -> [Vec3; 2] {
        let all = |a: usize, side: usize| self.nodes[0].planes[a][side].into_iter();
        let low = |a| all(a, 0).fold(f32::INFINITY, f32::min);
        let high = |a| all(a, 1).fold(f32::NEG_INFINITY, f32::max);
        [Vec3::new(low(0), low(1), low(2)), Vec3::new(high(0), high(1), high(2))]
    }

    /// The answer for a single ray.
    #[inline(always)]
    pub(crate) fn search_one<S: Search>(&self, l: impl Lanes, shapes: &[Shape], search: S) -> S::Answer {
        if self.waiting <= SMALL_ROOM {
            return self.search(l, shapes, search, &mut [0; SMALL_ROOM]);
        }
        if self.waiting <= ROOM {
            return self.search(l, shapes, search, &mut [0; ROOM]);
        }
        self.search(l, shapes, search, &mut vec![0; self.waiting])
    }

    /// The answer of one search. `stack` has room for [`Wide::waiting`] entries.
    #[inline(always)]
    pub(super) fn search<S: Search>(
        &self,
        l: impl Lanes,
        shapes: &[Shape],
        mut search: S,
        stack: &mut [u64],
    ) -> S::Answer {
        while !search.step(l, self, shapes, stack) {}
        search.answer()
    }
}
