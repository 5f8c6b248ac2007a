//! Surfaces that coincide: which primitives lie in one plane, and which of them is seen.
//!
//! ```text
//! A, B coincide:   parallel,  |h| ≤ γ,  and they overlap by more than 2γ in every direction
//! γ(n) = 64·2⁻²⁴ Σᵢ |nᵢ| Rᵢ                                       four times what rays may be off
//! the rule:        an emitting front lies in front of what it touches: it is moved by s along its normal, so that h ≥ γ
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | R | largest coordinates of the scene about its middle ([`Description::centred`]) | `Scale` |
//! | γ | planes nearer to each other than this are one plane | `Scale::gap` |
//! | h | height of the first of a pair over the second, along the front normal of the first: lowest and highest | [`Overlap::height`] |
//! | s | how far an emitter is moved | `shifts` |
//!
//! Rays in `f32` cannot tell two surfaces apart that coincide: a ray that starts on one of them, or ends there, may or
//! may not meet the other. So a lamp in the plane of a ceiling would be seen by some ways of sampling and not by others. The
//! rule makes one geometry of it for rays, patches and every way of sampling. Of two emitters that look the same way, the one
//! with the lower number lies in front; only their owners know whether that is right ([`relation`]). What does not emit
//! stays where it is.
//!
//! γ is a bound for the whole plane and not for one point, so that all triangles of a lamp move alike. All lengths are
//! shares of the scene's size: scaling by a power of two changes no bit. Coordinates below 1/64 of the largest count as that:
//! in a scene that lies in one plane, γ must not vanish.

mod find;
pub mod relation;

use super::description::Description;
use super::primitive::Primitive;
use glam::DVec3;

pub use relation::{Kind, Region, Relation};

/// Two primitives that lie in one surface and overlap there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Their numbers, ascending.
    pub pair: [usize; 2],
    /// Whether their fronts look the same way.
    pub same_way: bool,
    /// Height of the first over the second along the front normal of the first, metres: lowest and highest over the
    /// overlap.
    pub height: [f64; 2],
    /// γ of their plane, metres.
    pub gap: f64,
}

impl Overlap {
    /// The one of the two (0 or 1) that lies in front, seen from the front of the first or from its back; nothing where
    /// rays cannot tell.
    pub fn nearer(&self, from_front: bool) -> Option<usize> {
        let h = 0.5 * (self.height[0] + self.height[1]);
        (h.abs() > self.gap / 64.0).then_some(usize::from((h > 0.0) != from_front))
    }

    /// The sides that both turn to the front of the first, or to its back: 0 is a front, 1 a back.
    pub fn sides(&self, from_front: bool) -> [usize; 2] {
        [usize::from(!from_front), usize::from(from_front != self.same_way)]
    }
}

/// The primitives of a description as everything that solves it meets them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// Every primitive with the index of its shape, emitters in front of what they touch. In the order of
    /// [`Description::primitives`].
    pub list: Vec<(usize, Primitive)>,
    /// What coincides, in ascending order.
    pub overlaps: Vec<Overlap>,
    /// The farthest that any primitive was moved, metres; 0 where nothing was.
    pub moved: f64,
}

/// The size of a scene, as rounding sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// R.
    reach: DVec3,
}

/// γ in units of the last place of the coordinates.
const UNITS: f64 = 64.0 / 16_777_216.0;

impl Scale {
    pub(crate) fn new(list: &[(usize, Primitive)]) -> Self {
        let bounds = list.iter().map(|(_, p)| p.bounds());
        let [lo, hi] = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or_default();
        let reach = lo.abs().max(hi.abs());
        Self { reach: reach.max(DVec3::splat(reach.max_element() / 64.0)) }
    }

    /// γ of a plane with this unit normal.
    pub(crate) fn gap(&self, n: DVec3) -> f64 {
        UNITS * n.abs().dot(self.reach)
    }

    /// The largest γ of any plane.
    pub(crate) fn largest_gap(&self) -> f64 {
        UNITS * self.reach.length()
    }
}

impl Description {
    /// The primitives with every emitting one in front of what it touches, and all that coincides. The scene must be about its
    /// middle ([`Description::centred`]): planes count as one by how rays see them there.
    pub fn surfaces(&self) -> Surfaces {
        let mut list = self.primitives();
        let mut overlaps = find::overlaps(&list, &Scale::new(&list));
        let emits = |i: usize| self.shapes[list[i].0].emission.max_element() > 0.0;
        let shift = shifts(list.len(), &overlaps, emits);
        for o in &mut overlaps {
            let [s, t] = o.pair.map(|i| shift[i]);
            let apart = s - if o.same_way { t } else { -t };
            o.height = o.height.map(|h| h + apart);
        }
        for ((_, p), s) in list.iter_mut().zip(&shift).filter(|(_, s)| **s != 0.0) {
            *p = moved(p, *s);
        }
        Surfaces { list, overlaps, moved: shift.into_iter().fold(0.0, f64::max) }
    }
}

/// s of every primitive. Emitters come in descending order: the one that is to lie in front finds the other in its place.
fn shifts(n: usize, overlaps: &[Overlap], emits: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut shift = vec![0.0f64; n];
    // (emitter, the other, lowest height over it, γ, same way)
    let mut pairs: Vec<(usize, usize, f64, f64, bool)> = vec![];
    for o in overlaps {
        let [i, j] = o.pair;
        let [lo, hi] = o.height;
        pairs.extend(emits(i).then_some((i, j, lo, o.gap, o.same_way)));
        // the height of the second over the first, along its own normal
        let low = if o.same_way { -hi } else { lo };
        pairs.extend(emits(j).then_some((j, i, low, o.gap, o.same_way)));
    }
    pairs.sort_by_key(|p| (std::cmp::Reverse(p.0), p.1));
    for (i, j, low, gap, same_way) in pairs {
        if same_way && emits(j) && j < i {
            continue;
        }
        let below = if same_way { shift[j] } else { 0.0 };
        shift[i] = shift[i].max(gap - low + below);
    }
    shift
}

/// The primitive moved by `s` along the normal of its front.
fn moved(p: &Primitive, s: f64) -> Primitive {
    match *p {
        Primitive::Triangle([a, b, c]) => {
            let d = s * (b - a).cross(c - a).normalize();
            Primitive::Triangle([a + d, b + d, c + d])
        }
        Primitive::Parallelogram { origin, edge_u, edge_v } => {
            Primitive::Parallelogram { origin: origin + s * edge_u.cross(edge_v).normalize(), edge_u, edge_v }
        }
        Primitive::Disk { center, normal, radius } => Primitive::Disk { center: center + s * normal, normal, radius },
        Primitive::Sphere { center, radius, z, inward } => {
            Primitive::Sphere { center, radius: if inward { radius - s } else { radius + s }, z, inward }
        }
    }
}
