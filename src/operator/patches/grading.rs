//! Optional grading of cells: they get narrower towards the edges where faces meet.
//!
//! ```text
//! x(S(s), S(t)),  x: [0, 1]² → quadrilateral bilinear,      S(s) = s^q towards a side at an edge, mirrored for two,  else s
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | q | grading, q ≥ 1; q = 1 divides evenly | [`Chart::power`] |
//! | S | position of the line with the parameter s | [`warped`] |
//! | edge | a side of the quadrilateral at which another face rises, with a reflecting side turned towards the quadrilateral | [`rises`] |
//!
//! Consider an edge between albedos with √(ρ₁ρ₂) = ρ. Near it, a mode of eigenvalue λ behaves like c₀ + c₁ d^β at the
//! distance d. The exponent β solves κ(β) = λ/ρ with κ(β) = ¼ B(1 + β/2, ½ − β/2). On even cells of size h the error of the
//! eigenvalue is then of order h^{1+2β} (β < ½) instead of h². Cells with a width ∝ d^{1−1/q} across the edge, and an
//! unchanged length along it, restore h² if q > 2/(1 + 2β).
//!
//! Quadrilaterals are graded: whole faces, and pieces of faces cut by others. Triangles, pieces with more corners, spheres
//! and disks keep cells of equal area. The number of cells of a piece is the same as without grading.
//!
//! Reference: Atkinson, *The Numerical Solution of Integral Equations of the Second Kind* (1997), 4.2.5 and chapter 8.

use super::patch::sides_of;
use super::polygon::{area_vector, extent};
use crate::scene::{Primitive, description::Sides};
use glam::DVec3;

/// Lengths below this share of a face's size count as zero.
const TINY: f64 = 1e-7;

/// A quadrilateral piece of a face, with the information which of its sides lie at an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    corners: [DVec3; 4],
    /// True for the sides that lie at an edge: those at s = 0, s = 1; t = 0, t = 1.
    edges: [[bool; 2]; 2],
    power: f64,
}

/// A rectangle of parameters (s, t): the range of s, then the range of t.
pub(super) type Part = [[f64; 2]; 2];

impl Chart {
    /// The chart of a piece of the face `own`; `None` if the piece does not have four corners.
    pub(super) fn new(power: f64, piece: &[DVec3], all: &[(Primitive, Sides)], own: usize) -> Option<Self> {
        let corners: [DVec3; 4] = piece.try_into().ok()?;
        let [p, q, r, s] = corners;
        let normal = area_vector(piece).normalize();
        let middle = 0.25 * (p + q + r + s);
        let at_edge = |a: DVec3, b: DVec3| {
            let points = [0.25, 0.5, 0.75].map(|t| a.lerp(b, t));
            let mut others = all.iter().enumerate().filter(|(i, _)| *i != own);
            others.any(|(_, o)| points.iter().any(|x| rises(o, *x, middle, normal, all[own].1)))
        };
        let edges = [[at_edge(p, s), at_edge(q, r)], [at_edge(p, q), at_edge(s, r)]];
        Some(Self { corners, edges, power })
    }

    /// Cuts `part` across its longer extent at the share `share` of the parameter range, measured before warping. Returns
    /// both parts and the line `(axis, offset)`; the first part is the one with `axis·x ≤ offset`.
    pub(super) fn cut(&self, part: Part, share: f64) -> ([Part; 2], (DVec3, f64)) {
        let [p, q, r, s] = self.corners;
        let length =
            |k: usize| if k == 0 { p.distance(q).max(s.distance(r)) } else { p.distance(s).max(q.distance(r)) };
        let extent = |k: usize| length(k) * (part[k][1] - part[k][0]);
        let k = usize::from(extent(1) > extent(0) * (1.0 + 1e-9));
        let [from, to] = part[k];
        let at = from + share * (to - from);
        let mut parts = [part; 2];
        (parts[0][k][1], parts[1][k][0]) = (at, at);
        let w = warped(self.power, self.edges[k], at);
        let (a, b) = if k == 0 { (p.lerp(q, w), s.lerp(r, w)) } else { (p.lerp(s, w), q.lerp(r, w)) };
        let normal = area_vector(&self.corners).normalize();
        // seen along t, increasing s is to the right; seen along s, increasing t is to the left: hence the sign
        let axis = (b - a).cross(normal).normalize() * if k == 0 { 1.0 } else { -1.0 };
        (parts, (axis, axis.dot(a)))
    }
}

/// The warped parameter S(s).
fn warped(power: f64, edges: [bool; 2], s: f64) -> f64 {
    match edges {
        [true, true] if s > 0.5 => 1.0 - 0.5 * (2.0 - 2.0 * s).powf(power),
        [true, true] => 0.5 * (2.0 * s).powf(power),
        [true, false] => s.powf(power),
        [false, true] => 1.0 - (1.0 - s).powf(power),
        [false, false] => s,
    }
}

/// Returns true if this face passes through x, rises there over a reflecting side of the plane, and turns a reflecting side
/// towards `middle`.
fn rises((primitive, sides): &(Primitive, Sides), x: DVec3, middle: DVec3, normal: DVec3, own: Sides) -> bool {
    let Some(polygon) = outline(primitive) else { return false };
    let tiny = TINY * polygon[0].distance(polygon[2]);
    let face = area_vector(&polygon).normalize();
    let on = face.dot(x - polygon[0]).abs() <= tiny
        && polygon.iter().zip(polygon.iter().cycle().skip(1)).all(|(a, b)| {
            let along = (*b - *a).normalize();
            face.cross(along).dot(x - *a) >= -tiny
        });
    let [low, high] = extent(&polygon, normal).map(|h| h - normal.dot(x));
    let over = sides_of(own).any(|side| if side == 0 { high > tiny } else { low < -tiny });
    on && over && (*sides == Sides::Both || face.dot(middle - x) > tiny)
}

/// The outline of a flat primitive with straight edges; `None` for others.
pub(super) fn outline(p: &Primitive) -> Option<Vec<DVec3>> {
    match *p {
        Primitive::Triangle(p) => Some(p.to_vec()),
        Primitive::Parallelogram { origin: o, edge_u: u, edge_v: v } => Some(vec![o, o + u, o + u + v, o + v]),
        Primitive::Sphere { .. } | Primitive::Disk { .. } => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::operator::patches::polygon::clip;

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn lines_gather_at_the_sides_where_a_face_rises() {
        let face = |o: DVec3, u: DVec3, v: DVec3| Primitive::Parallelogram { origin: o, edge_u: u, edge_v: v };
        let floor = (face(DVec3::ZERO, DVec3::X, DVec3::Y), Sides::Front);
        let wall = (face(DVec3::ZERO, DVec3::Y, DVec3::Z), Sides::Front); // along x = 0, turned to x > 0
        let black = (face(DVec3::X, DVec3::Y, DVec3::Z), Sides::Front); // along x = 1, turned away
        let below = (face(DVec3::ZERO, DVec3::X, -DVec3::Z), Sides::Both); // along y = 0, under the floor
        let piece = outline(&floor.0).unwrap();
        let chart = Chart::new(2.0, &piece, &[floor, wall, black, below], 0).unwrap();
        assert_eq!(chart.edges, [[true, false], [false, false]]);
        let (parts, (axis, offset)) = chart.cut([[0.0, 1.0]; 2], 0.5);
        assert!((axis - DVec3::X).length() < 1e-15 && (offset - 0.25).abs() < 1e-15, "{axis} {offset}");
        assert_eq!(parts, [[[0.0, 0.5], [0.0, 1.0]], [[0.5, 1.0], [0.0, 1.0]]]);
        // the halves are longer in t, where nothing rises
        let (_, (axis, offset)) = chart.cut(parts[1], 0.25);
        assert!((axis - DVec3::Y).length() < 1e-15 && (offset - 0.25).abs() < 1e-15, "{axis} {offset}");
        assert!(Chart::new(2.0, &piece[..3], &[floor, wall], 0).is_none());
    }

    #[test]
    fn parts_of_a_skew_piece_lie_on_their_sides_of_the_line() {
        let corners = [v(0.0, 0.0, 1.0), v(2.0, 0.1, 1.0), v(1.7, 1.3, 1.0), v(0.2, 1.0, 1.0)];
        let chart = Chart { corners, edges: [[true, true], [false, true]], power: 1.7 };
        for (part, share) in [([[0.0, 1.0]; 2], 0.3), ([[0.4, 0.6], [0.1, 0.9]], 0.6)] {
            let (parts, (axis, offset)) = chart.cut(part, share);
            let middle = |p: Part| {
                let [s, t] = [0, 1].map(|k| warped(chart.power, chart.edges[k], 0.5 * (p[k][0] + p[k][1])));
                let [p, q, r, o] = corners;
                p.lerp(q, s).lerp(o.lerp(r, s), t)
            };
            assert!(axis.dot(middle(parts[0])) < offset && axis.dot(middle(parts[1])) > offset);
            let (mut low, mut high) = (vec![], vec![]);
            clip(&corners, -axis, -offset, 0.0, &mut low);
            clip(&corners, axis, offset, 0.0, &mut high);
            assert!(low.len() > 2 && high.len() > 2);
        }
    }
}
