//! Finds the uncovered (free) part of a surface: for example, the floor under a block neither emits nor reflects.
//!
//! ```text
//! covered(x)  ⇔  every ray from x first hits the black back of a one-sided surface
//!               or x lies on a side with a coincident side in front of it
//! ```
//!
//! [`crate::scene::coplanar`] decides which surfaces coincide, and that emitters lie in front; this holds for rays and
//! patches. If it does not decide between two surfaces, the one with the lower number is in front, provided that it
//! reflects.
//!
//! The rays are a fixed set of 32: 16 cover the hemisphere, and 16 graze the surface (slope 10⁻³). Grazing rays are needed
//! because only they leave the thin gap between a ceiling and a lamp just below it.

use super::brute_force::BruteForce;
use super::near::Near;
use super::patch::{SurfacePoint, sides_of};
use super::polygon::at;
use crate::scene::coplanar::Overlap;
use crate::scene::{Primitive, description::Sides};
use glam::DVec3;
use std::f64::consts::TAU;

/// Result of the test for a region: free, covered, or some of both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cover {
    Free,
    Covered,
    Mixed,
}

/// The test whether a point of a surface is covered.
#[derive(Clone, Debug)]
pub(super) struct CoverTest {
    caster: BruteForce,
    primitives: Vec<(Primitive, Sides)>,
    pub(super) near: Near,
    /// Pairs (side, primitive that coincides with it and lies in front of it), ascending. Side 2i is the front of primitive
    /// i, 2i + 1 its back.
    in_front: Vec<(u32, u32)>,
    /// True if some surface has a black back that rays can hit.
    one_sided: bool,
    directions: Vec<DVec3>,
}

impl CoverTest {
    pub(super) fn new(primitives: Vec<(Primitive, Sides)>, overlaps: &[Overlap]) -> Self {
        let caster = BruteForce::of(primitives.iter().copied());
        let turn = |i: usize, z: f64| {
            // golden-angle spiral
            let phi = TAU * 0.618_033_988_749_894_9 * i as f64;
            let s = (1.0 - z * z).sqrt();
            DVec3::new(s * phi.cos(), s * phi.sin(), z)
        };
        let directions = (0..32).map(|i| turn(i, if i < 16 { (i as f64 + 0.5) / 16.0 } else { 1e-3 })).collect();
        let near = Near::new(primitives.iter().map(|p| &p.0));
        let one_sided = primitives.iter().any(|p| p.1 == Sides::Front);
        let in_front = in_front(&primitives, overlaps);
        Self { caster, primitives, near, in_front, one_sided, directions }
    }

    /// The primitives that coincide with one side of a primitive and lie in front of it.
    fn over(&self, primitive: usize, normal: DVec3, position: DVec3) -> impl Iterator<Item = usize> {
        let front = outward(&self.primitives[primitive].0, position).dot(normal) > 0.0;
        let side = 2 * primitive as u32 + u32::from(!front);
        let first = self.in_front.partition_point(|o| o.0 < side);
        self.in_front[first..].iter().take_while(move |o| o.0 == side).map(|o| o.1 as usize)
    }

    pub(super) fn is_covered(&self, primitive: usize, at: SurfacePoint) -> bool {
        let mut over = self.over(primitive, at.normal, at.position);
        if over.any(|i| holds(&self.primitives[i].0, at.position)) {
            return true;
        }
        if !self.one_sided {
            return false;
        }
        let (u, v) = at.normal.any_orthonormal_pair();
        self.directions
            .iter()
            .map(|d| self.near.first_hit(&self.caster, at, d.x * u + d.y * v + d.z * at.normal))
            .all(|hit| hit.is_some_and(|hit| !hit.reflects))
    }

    /// Returns true if two primitives coincide, with one of them in front of the other.
    pub(super) fn coincide(&self, a: usize, b: usize) -> bool {
        let any = |own: usize, other: usize| {
            [0, 1].iter().any(|s| self.in_front.binary_search(&(2 * own as u32 + s, other as u32)).is_ok())
        };
        any(a, b) || any(b, a)
    }

    /// The free share of a polygon, from an m×m grid of points; `lift` maps them to the true surface.
    pub(super) fn free_share(
        &self,
        primitive: usize,
        polygon: &[DVec3],
        m: usize,
        lift: impl Fn(DVec3) -> SurfacePoint,
    ) -> f64 {
        let h = |i: usize| (i as f64 + 0.5) / m as f64;
        let (mut free, mut all) = (0.0, 0.0);
        for k in 0..m * m {
            let (p, w) = at(polygon, h(k % m), h(k / m));
            all += w;
            if !self.is_covered(primitive, lift(p)) {
                free += w;
            }
        }
        if free == all { 1.0 } else { free / all }
    }

    /// Classifies a polygon as free, covered, or some of both, with a 4×4 grid of points.
    pub(super) fn classify(&self, primitive: usize, polygon: &[DVec3], normal: DVec3) -> Cover {
        match self.free_share(primitive, polygon, 4, |position| SurfacePoint { position, normal }) {
            1.0 => Cover::Free,
            0.0 => Cover::Covered,
            _ => Cover::Mixed,
        }
    }
}

/// For every side, the primitives that lie in front of it.
fn in_front(primitives: &[(Primitive, Sides)], overlaps: &[Overlap]) -> Vec<(u32, u32)> {
    let mut all = vec![];
    for o in overlaps {
        for from_front in [true, false] {
            let sides = o.sides(from_front);
            let lower = || sides_of(primitives[o.pair[0]].1).contains(&sides[0]).then_some(0);
            if let Some(seen) = o.nearer(from_front).or_else(lower) {
                let hidden = 1 - seen;
                all.push((2 * o.pair[hidden] as u32 + sides[hidden] as u32, o.pair[seen] as u32));
            }
        }
    }
    all.sort_unstable();
    all
}

/// Normal of the front at a point of a primitive; its length is arbitrary.
fn outward(primitive: &Primitive, at: DVec3) -> DVec3 {
    match *primitive {
        Primitive::Triangle([a, b, c]) => (b - a).cross(c - a),
        Primitive::Parallelogram { edge_u, edge_v, .. } => edge_u.cross(edge_v),
        Primitive::Disk { normal, .. } => normal,
        Primitive::Sphere { center, inward, .. } => {
            if inward {
                center - at
            } else {
                at - center
            }
        }
    }
}

/// Returns true if a point lies on the primitive; it must lie on a surface that coincides with the primitive.
fn holds(primitive: &Primitive, at: DVec3) -> bool {
    let inside = |origin: DVec3, e: DVec3, f: DVec3, triangle: bool| {
        let n = e.cross(f);
        let p = at - origin;
        let k = 1.0 / n.length_squared();
        let (u, v) = (p.cross(f).dot(n) * k, e.cross(p).dot(n) * k);
        u >= 0.0 && v >= 0.0 && if triangle { u + v <= 1.0 } else { u <= 1.0 && v <= 1.0 }
    };
    match *primitive {
        Primitive::Triangle([a, b, c]) => inside(a, b - a, c - a, true),
        Primitive::Parallelogram { origin, edge_u, edge_v } => inside(origin, edge_u, edge_v, false),
        Primitive::Disk { center, normal, radius } => {
            let p = at - center;
            (p - normal * normal.dot(p)).length() <= radius
        }
        Primitive::Sphere { center, radius, z, .. } => {
            let h = (at - center).z / radius;
            h >= z[0] && h <= z[1]
        }
    }
}
