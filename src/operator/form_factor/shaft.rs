//! Search for the surfaces that may block light between two patches.
//!
//! ```text
//! hull(P ∪ Q) ∩ B = ∅   if for some axis   max axis·B ≤ min axis·(P ∪ Q)   or the other way round
//! ```
//!
//! P and Q are the two patches, B is the surface. A finite set of axes can prove that B blocks nothing, but never that it
//! blocks (after Haines and Wallace 1991, "Shaft culling for efficient ray-cast radiosity").

use crate::operator::patches::{
    Patch,
    polygon::{area_vector, extent},
};
use crate::scene::Primitive;
use glam::DVec3;
use std::cell::OnceCell;

/// The shape of a surface, in the form that the test uses.
#[derive(Clone, Debug)]
enum Solid {
    Flat { corners: Vec<DVec3>, normal: DVec3, edges: Vec<DVec3> },
    Disk { normal: DVec3, radius: f64 },
    Sphere { radius: f64 },
}

/// A primitive that may block light.
#[derive(Clone, Debug)]
pub(super) struct Blocker {
    bounds: [DVec3; 2],
    centre: DVec3,
    solid: Solid,
}

/// One end of a shaft: a polygon of a patch, and bounds that include the distance of the true surface from it.
#[derive(Clone, Copy)]
pub(super) struct End<'a> {
    pub(super) patch: &'a Patch,
    pub(super) polygon: &'a [DVec3],
    pub(super) bounds: [DVec3; 2],
}

impl<'a> End<'a> {
    pub(super) fn new(patch: &'a Patch, polygon: &'a [DVec3]) -> Self {
        let b = DVec3::splat(bulge(patch));
        let fold = |[lo, hi]: [DVec3; 2], p: &DVec3| [lo.min(*p), hi.max(*p)];
        let [lo, hi] = polygon.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], fold);
        Self { patch, polygon, bounds: [lo - b, hi + b] }
    }
}

/// Largest distance of the true surface from the polygon, metres.
fn bulge(patch: &Patch) -> f64 {
    patch.ball.map_or(0.0, |(c, r)| r - patch.normal.dot(patch.centre - c).abs())
}

impl Blocker {
    pub(super) fn new(p: &Primitive) -> Self {
        let bounds = p.bounds();
        let flat = |corners: Vec<DVec3>| {
            let edges = corners.iter().enumerate().map(|(i, &a)| corners[(i + 1) % corners.len()] - a);
            let mut edges: Vec<DVec3> = edges.map(DVec3::normalize).collect();
            if corners.len() == 4 {
                edges.truncate(2);
            }
            Solid::Flat { normal: area_vector(&corners).normalize(), edges, corners }
        };
        let (centre, solid) = match *p {
            Primitive::Triangle(c) => ((c[0] + c[1] + c[2]) / 3.0, flat(c.to_vec())),
            Primitive::Parallelogram { origin: o, edge_u: u, edge_v: v } => {
                (o + 0.5 * (u + v), flat(vec![o, o + u, o + u + v, o + v]))
            }
            Primitive::Disk { center, normal, radius } => (center, Solid::Disk { normal, radius }),
            Primitive::Sphere { center, radius, .. } => (center, Solid::Sphere { radius }),
        };
        Self { bounds, centre, solid }
    }

    /// Lowest and highest value of `axis·x` on the surface, for a unit vector `axis`.
    fn extent(&self, axis: DVec3) -> [f64; 2] {
        let about = |half: f64| {
            let m = axis.dot(self.centre);
            [m - half, m + half]
        };
        match &self.solid {
            Solid::Flat { corners, .. } => extent(corners, axis),
            Solid::Disk { normal, radius } => about(radius * (1.0 - axis.dot(*normal).powi(2)).max(0.0).sqrt()),
            Solid::Sphere { radius } => about(*radius),
        }
    }

    /// Returns true if this surface may cut a segment between the two ends. `false` is a proof that it cuts none.
    pub(super) fn may_block(&self, shaft: &Shaft<'_>) -> bool {
        let &Shaft { a, b, low, high, tolerance, between, .. } = shaft;
        let slack = DVec3::splat(tolerance);
        if (self.bounds[0] + slack).cmpge(high).any() || (self.bounds[1] - slack).cmple(low).any() {
            return false;
        }
        let separates = |axis: DVec3| shaft.beside(shaft.extent(axis), self.extent(axis));
        let across = |d: DVec3| {
            let axis = between.cross(d);
            let length = axis.length();
            length > 1e-9 * between.length() && separates(axis / length)
        };
        match &self.solid {
            Solid::Flat { normal, edges, .. } => {
                if separates(*normal) || edges.iter().any(|e| across(*e)) {
                    return false;
                }
            }
            Solid::Disk { normal, .. } => {
                if separates(*normal) {
                    return false;
                }
            }
            Solid::Sphere { radius } => {
                if own_ball(a, b, self.centre, *radius) || own_ball(b, a, self.centre, *radius) {
                    return false;
                }
            }
        }
        let [of_a, of_b] = *shaft.along.get_or_init(|| [a, b].map(|end| shaft.extent(end.patch.normal)));
        if shaft.beside(of_a, self.extent(a.patch.normal)) || shaft.beside(of_b, self.extent(b.patch.normal)) {
            return false;
        }
        // the axis from the line between the two centres towards the middle of the blocker
        let out = (self.centre - a.patch.centre).reject_from(between).normalize_or_zero();
        out == DVec3::ZERO || !separates(out)
    }
}

/// Two ends and what every blocker between them is compared with.
pub(super) struct Shaft<'a> {
    a: &'a End<'a>,
    b: &'a End<'a>,
    low: DVec3,
    high: DVec3,
    tolerance: f64,
    margin: f64,
    between: DVec3,
    /// Extents along the normals of both patches, once a blocker needs them.
    along: OnceCell<[[f64; 2]; 2]>,
}

impl<'a> Shaft<'a> {
    pub(super) fn new(a: &'a End<'a>, b: &'a End<'a>) -> Self {
        let (low, high) = (a.bounds[0].min(b.bounds[0]), a.bounds[1].max(b.bounds[1]));
        Self {
            tolerance: 1e-9 * (high - low).max_element(),
            margin: bulge(a.patch).max(bulge(b.patch)),
            between: b.patch.centre - a.patch.centre,
            along: OnceCell::new(),
            low,
            high,
            a,
            b,
        }
    }

    /// Lowest and highest value of `axis·x` at both ends.
    fn extent(&self, axis: DVec3) -> [f64; 2] {
        let ([s0, t0], [s1, t1]) = (extent(self.a.polygon, axis), extent(self.b.polygon, axis));
        [s0.min(s1), t0.max(t1)]
    }

    /// Returns true if a blocker with the extent [s, t] along an axis is beside the ends with the extent [low, high].
    fn beside(&self, [low, high]: [f64; 2], [s, t]: [f64; 2]) -> bool {
        s >= high + self.margin - self.tolerance || t <= low - self.margin + self.tolerance
    }
}

/// Returns true if `end` lies on this sphere and the sphere blocks no segment from `end` to the polygon of `other`.
fn own_ball(end: &End<'_>, other: &End<'_>, centre: DVec3, radius: f64) -> bool {
    if end.patch.ball != Some((centre, radius)) {
        return false;
    }
    let corners = || other.polygon.iter().map(|q| *q - centre);
    if end.patch.is_concave() {
        // a ball is convex: every chord stays inside
        let margin = if other.patch.ball == Some((centre, radius)) { 0.0 } else { bulge(other.patch) };
        return corners().all(|v| v.length() + margin <= radius * (1.0 + 1e-9));
    }
    // `other` lies above the tangent planes at all points of the patch, taken as a cone of directions
    let middle = (end.patch.centre - centre).normalize();
    let half = end.patch.polygon.iter().map(|p| (*p - centre).angle_between(middle)).fold(0.0, f64::max);
    let margin = bulge(other.patch);
    corners().all(|v| {
        let angle = v.angle_between(middle) + half;
        angle < std::f64::consts::FRAC_PI_2 && v.length() * angle.cos() >= radius + margin
    })
}
