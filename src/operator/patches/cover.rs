//! Which part of a surface is free: the floor under a block neither emits nor reflects.
//!
//! ```text
//! covered(x)  ⇔  every ray from x meets first the black back of a one-sided surface
//!               or x lies on a reflecting side that coincides with one of lower number
//! ```
//!
//! The rays are a fixed set of 32: 16 over the hemisphere and 16 that graze the surface (slope 10⁻³), because only
//! these leave the thin gap between a ceiling and a light hung below it.

use super::{BruteForce, Near, SurfacePoint, polygon::at};
use crate::scene::{Primitive, description::Sides};
use glam::DVec3;
use std::f64::consts::TAU;

/// Is a region free?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cover {
    Free,
    Covered,
    Mixed,
}

/// The test for points.
#[derive(Clone, Debug)]
pub(super) struct CoverTest {
    caster: BruteForce,
    primitives: Vec<(Primitive, Sides)>,
    pub(super) near: Near,
    /// Some surface has a black back, so that rays can meet one.
    one_sided: bool,
    directions: Vec<DVec3>,
}

impl CoverTest {
    pub(super) fn new(caster: BruteForce, primitives: Vec<(Primitive, Sides)>) -> Self {
        let turn = |i: usize, z: f64| {
            // golden-angle spiral
            let phi = TAU * 0.618_033_988_749_894_9 * i as f64;
            let s = (1.0 - z * z).sqrt();
            DVec3::new(s * phi.cos(), s * phi.sin(), z)
        };
        let directions = (0..32).map(|i| turn(i, if i < 16 { (i as f64 + 0.5) / 16.0 } else { 1e-3 })).collect();
        let near = Near::new(primitives.iter().map(|p| &p.0));
        let one_sided = primitives.iter().any(|p| p.1 == Sides::Front);
        Self { caster, primitives, near, one_sided, directions }
    }

    pub(super) fn is_covered(&self, primitive: usize, at: SurfacePoint) -> bool {
        let mut doubled = false;
        self.near.within([at.position; 2], |i| {
            doubled = i < primitive && coincides(&self.primitives[i], at);
            !doubled
        });
        if doubled || !self.one_sided {
            return doubled;
        }
        let (u, v) = at.normal.any_orthonormal_pair();
        self.directions
            .iter()
            .map(|d| self.near.first_hit(&self.caster, at, d.x * u + d.y * v + d.z * at.normal))
            .all(|hit| hit.is_some_and(|hit| !hit.reflects))
    }

    /// The share of an m×m grid of points of `polygon` that is free; `lift` maps them to the true surface.
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

    /// Free, covered, or some of both, by a 4×4 grid of points.
    pub(super) fn classify(&self, primitive: usize, polygon: &[DVec3], normal: DVec3) -> Cover {
        match self.free_share(primitive, polygon, 4, |position| SurfacePoint { position, normal }) {
            1.0 => Cover::Free,
            0.0 => Cover::Covered,
            _ => Cover::Mixed,
        }
    }
}

/// The point lies on a reflecting side of a flat primitive that faces the same way.
fn coincides(&(primitive, sides): &(Primitive, Sides), at: SurfacePoint) -> bool {
    let inside = |origin: DVec3, e: DVec3, f: DVec3, triangle: bool| {
        let n = e.cross(f);
        let p = at.position - origin;
        let k = 1.0 / n.length_squared();
        let (u, v) = (p.cross(f).dot(n) * k, e.cross(p).dot(n) * k);
        let size = e.length().max(f.length());
        let flush = n.dot(p).abs() <= 1e-9 * size * n.length();
        let within = u >= 0.0 && v >= 0.0 && if triangle { u + v <= 1.0 } else { u <= 1.0 && v <= 1.0 };
        (n, flush && within)
    };
    let (n, inside) = match primitive {
        Primitive::Triangle([a, b, c]) => inside(a, b - a, c - a, true),
        Primitive::Parallelogram { origin, edge_u, edge_v } => inside(origin, edge_u, edge_v, false),
        Primitive::Disk { center, normal, radius } => {
            let p = at.position - center;
            (normal, normal.dot(p).abs() <= 1e-9 * radius && p.length() <= radius)
        }
        Primitive::Sphere { .. } => return false,
    };
    let cosine = n.dot(at.normal) / n.length();
    inside && (cosine > 1.0 - 1e-9 || (sides == Sides::Both && cosine < -1.0 + 1e-9))
}
