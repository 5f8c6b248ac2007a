//! The tree of boxes, and how a ray goes through it.
//!
//! | question | order | stops |
//! |---|---|---|
//! | [`Wide::closest`]: the first hit | by the distance of the boxes | when all boxes that are left begin behind the best hit |
//! | [`Wide::occluded`]: any hit with t < 1 | as stored: the largest box first | at the first hit |
//!
//! Each stack entry of the first question is one number: the distance of the box above the number of the child. Distances are
//! not negative, so the entries sort as integers.

use super::super::shape::{Hit, Shape};
use super::block::Block;
use super::lanes::{Lanes, N};
use super::node::{FARTHEST, LEAF, Node, SINGLE, Slabs};
use glam::Vec3;

/// A tree of eight-wide nodes over shapes; see [`super`].
pub(crate) struct Wide {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<Block>,
    /// Largest number of children that wait at one time.
    pub(crate) waiting: usize,
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

impl Wide {
    /// The nearest hit with t > 0; of two at the same distance the one with the lower number. `stack` has room for
    /// [`Wide::waiting`] entries.
    #[inline(always)]
    pub(crate) fn closest<L: Lanes>(&self, l: L, shapes: &[Shape], o: Vec3, d: Vec3, stack: &mut [u64]) -> Hit {
        let slabs = Slabs::new(o, d);
        let (mut best, mut most, mut top, mut current) = (Hit::NONE, FARTHEST, 0, 0);
        loop {
            if current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let (met, t) = node.meet(l, &slabs, most);
                if met != 0 {
                    let (i, mut met) = first(met);
                    let mut nearest = entry(t[i], node.child[i]);
                    let base = top;
                    while met != 0 {
                        let (i, rest) = first(met);
                        met = rest;
                        let new = entry(t[i], node.child[i]);
                        let (near, far) = if nearest < new { (nearest, new) } else { (new, nearest) };
                        nearest = near;
                        // sorted above `base`, the nearest on top: there are rarely more than three
                        let mut at = top;
                        while at > base && stack[at - 1] < far {
                            stack[at] = stack[at - 1];
                            at -= 1;
                        }
                        stack[at] = far;
                        top += 1;
                    }
                    current = nearest as u32;
                    continue;
                }
            } else {
                self.leaf(l, shapes, current, o, d, &mut best);
                // slightly more than t, so that a hit at the same t with a lower number is still visited
                most = (best.t * (1.0 + 1e-6)).min(FARTHEST);
            }
            loop {
                if top == 0 {
                    return best;
                }
                top -= 1;
                if f32::from_bits((stack[top] >> 32) as u32) <= most {
                    current = stack[top] as u32;
                    break;
                }
            }
        }
    }

    #[inline(always)]
    fn leaf<L: Lanes>(&self, l: L, shapes: &[Shape], child: u32, o: Vec3, d: Vec3, best: &mut Hit) {
        if child & SINGLE == 0 {
            self.blocks[(child & !LEAF) as usize].nearest(l, o, d, best);
        } else {
            let prim = child & !(LEAF | SINGLE);
            let (t, met) = shapes[prim as usize].meet(o, d);
            if met {
                best.take(Hit { t, prim });
            }
        }
    }

    /// Returns true if a shape lies at 0 < t < 1. `stack` has room for [`Wide::waiting`] entries.
    #[inline(always)]
    pub(crate) fn occluded<L: Lanes>(&self, l: L, shapes: &[Shape], o: Vec3, d: Vec3, stack: &mut [u64]) -> bool {
        let slabs = Slabs::new(o, d);
        let (mut top, mut current) = (0, 0);
        loop {
            if current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let (met, _) = node.meet(l, &slabs, 1.0);
                if met != 0 {
                    let (i, mut met) = first(met);
                    while met != 0 {
                        let (i, rest) = last(met);
                        met = rest;
                        stack[top] = u64::from(node.child[i]);
                        top += 1;
                    }
                    current = node.child[i];
                    continue;
                }
            } else if current & SINGLE == 0 {
                if self.blocks[(current & !LEAF) as usize].occluded(l, o, d) {
                    return true;
                }
            } else {
                let (t, met) = shapes[(current & !(LEAF | SINGLE)) as usize].meet(o, d);
                if met && t < 1.0 {
                    return true;
                }
            }
            if top == 0 {
                return false;
            }
            top -= 1;
            current = stack[top] as u32;
        }
    }
}
