//! Coincident surfaces: primitives that lie in one plane and overlap, and the rule that decides which of them is visible.
//!
//! ```text
//! A, B coincide:   parallel,  |h| ≤ γ,  and they overlap by more than 2γ in every direction
//! γ(n) = 64·2⁻²⁴ Σᵢ |nᵢ| Rᵢ                                       four times the error of a ray
//! the rule:        an emitting front is moved by s along its normal, so that h ≥ γ over surfaces that it coincides with
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | R | largest absolute coordinates of the scene, measured from its middle ([`Description::centred`]) | `Scale` |
//! | γ | tolerance: two planes closer than γ count as one plane | `Scale::gap` |
//! | n, h | normal of the plane; lowest and highest height of the first primitive over the second, along the front normal of the first | [`Overlap::height`] |
//! | s | distance by which an emitter is moved | `shifts` |
//!
//! Rays in `f32` cannot distinguish two coincident surfaces: a ray that starts or ends on one of them may or may not hit the
//! other. A lamp in the plane of a ceiling would then be visible to some sampling techniques and hidden from others. The
//! rule gives rays, patches and all sampling techniques the same geometry. If two emitters face the same direction, the one
//! with the lower number lies in front. This choice is arbitrary, so [`relation`] reports the pair if they look different.
//! Surfaces that do not emit are not moved.
//!
//! γ is a bound for the whole plane and not for a single point, so that all triangles of a lamp move by the same distance.
//! All lengths are fractions of the scene's size, so scaling a scene by a power of two changes no bit of the result. A
//! coordinate of R below 1/64 of the largest is replaced by that value, because γ must not vanish for a scene that lies in
//! one plane.

mod find;
pub mod relation;

use super::description::Description;
use super::primitive::Primitive;
use glam::DVec3;

pub use relation::{Kind, Region, Relation};

/// Two primitives that lie in one surface and overlap there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Numbers of the two primitives, ascending.
    pub pair: [usize; 2],
    /// True if their fronts face the same direction.
    pub same_way: bool,
    /// Lowest and highest height (m) of the first over the second in the overlap, along the front normal of the first.
    pub height: [f64; 2],
    /// γ of their plane (m): the tolerance.
    pub gap: f64,
}

impl Overlap {
    /// The primitive (0 or 1) that lies in front, as seen from the front side of the first or from its back side. `None` if
    /// rays cannot distinguish them.
    pub fn nearer(&self, from_front: bool) -> Option<usize> {
        let h = 0.5 * (self.height[0] + self.height[1]);
        (h.abs() > self.gap / 64.0).then_some(usize::from((h > 0.0) != from_front))
    }

    /// For each of the two primitives, the side that faces the front half space of the first, or its back half space: 0 is a
    /// front, 1 a back.
    pub fn sides(&self, from_front: bool) -> [usize; 2] {
        [usize::from(!from_front), usize::from(from_front != self.same_way)]
    }
}

/// The primitives of a description as used by rays and by the mesh, after emitters have been moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// Every primitive with the index of its shape, in the order of [`Description::primitives`]. Emitters lie in front of
    /// surfaces that they coincide with.
    pub list: Vec<(usize, Primitive)>,
    /// All pairs that coincide, in ascending order.
    pub overlaps: Vec<Overlap>,
    /// The largest distance by which a primitive was moved (m); 0 if none was.
    pub moved: f64,
}

/// The size of a scene, from which the tolerance γ follows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// R: largest absolute coordinates.
    reach: DVec3,
}

/// γ as a fraction of R: 64 units in the last place of `f32`.
const UNITS: f64 = 64.0 / 16_777_216.0;

impl Scale {
    pub(crate) fn new(list: &[(usize, Primitive)]) -> Self {
        let bounds = list.iter().map(|(_, p)| p.bounds());
        let [lo, hi] = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or_default();
        let reach = lo.abs().max(hi.abs());
        Self { reach: reach.max(DVec3::splat(reach.max_element() / 64.0)) }
    }

    /// γ of a plane with the unit normal `n`, m.
    pub(crate) fn gap(&self, n: DVec3) -> f64 {
        UNITS * n.abs().dot(self.reach)
    }

    /// Upper bound of γ over all planes, m.
    pub(crate) fn largest_gap(&self) -> f64 {
        UNITS * self.reach.length()
    }
}

impl Description {
    /// The primitives, with every emitter moved in front of surfaces that it coincides with, and all pairs that coincide.
    /// The origin must be the middle of the scene ([`Description::centred`]), because γ is the tolerance of rays in those
    /// coordinates.
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

/// s of every primitive. Emitters are handled in descending order, so that the other surface has its final place when an
/// emitter is moved in front of it.
fn shifts(n: usize, overlaps: &[Overlap], emits: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut shift = vec![0.0f64; n];
    // (emitter, other primitive, lowest height over it, γ, same direction)
    let mut pairs: Vec<(usize, usize, f64, f64, bool)> = vec![];
    for o in overlaps {
        let [i, j] = o.pair;
        let [lo, hi] = o.height;
        pairs.extend(emits(i).then_some((i, j, lo, o.gap, o.same_way)));
        // the height of the second over the first, along the normal of the second
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

/// The primitive moved by the distance `s` along the normal of its front.
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
