//! Form factors of polygons with nothing between them.
//!
//! ```text
//! point → polygon    F = (1/2π) |Σᵢ θᵢ n·Γᵢ|                                         (Lambert 1760)
//! polygon → polygon  A₁F₁₂ = ∫∫ cos θ₁ cos θ₂ / πr² dA₁ dA₂ = (1/2π) ∮∮ ln r dx₁·dx₂  (Fock 1924; Sparrow 1963)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | θᵢ, Γᵢ | angle that edge i spans as seen from the point; unit normal of the triangle from the point to the edge | [`lambert`] |
//! | n | normal at the point | |
//! | g(u) | ½ ln(u² + h²): ln r between parallel lines at distance h, with offset u along them | |
//! | g₁, g₂ | first and second antiderivative of g | [`g1`], [`g2`] |
//!
//! Pairs of parallel edges are integrated in closed form, even if they touch, so that boxes are exact up to rounding. For
//! other pairs, Gauss quadrature is used on the first edge and g₁ on the second. The first edge is halved repeatedly towards
//! the point where the edges meet. For distant polygons, Lambert's formula is evaluated on a small Gauss grid on the smaller
//! polygon.

use crate::operator::patches::polygon::{area_vector, centroid, clip, radius_about};
use glam::DVec3;
use std::f64::consts::TAU;

/// The cosine-weighted share of the hemisphere around the unit normal `n` at `p` that a convex polygon covers.
///
/// Either side of the polygon may face `p`. The part below the horizon of `p` is cut off.
///
/// ```
/// use fredholm::operator::form_factor::point_to_polygon;
/// use glam::DVec3;
/// let square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| DVec3::new(x, y, 1.0));
/// assert!((point_to_polygon(DVec3::ZERO, DVec3::Z, &square) - 0.239456470460773539).abs() < 1e-15);
/// ```
pub fn point_to_polygon(p: DVec3, n: DVec3, polygon: &[DVec3]) -> f64 {
    let mut above = Vec::with_capacity(polygon.len() + 1);
    clip(polygon, n, n.dot(p), 0.0, &mut above);
    lambert(p, n, &above).abs()
}

/// The share of the diffuse power leaving the front of `a` that arrives at the front of `b`, with nothing in between.
///
/// ```
/// use fredholm::operator::form_factor::polygon_to_polygon;
/// use glam::DVec3;
/// let floor = [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(|(x, y)| DVec3::new(x, y, 0.0));
/// let wall = [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(|(y, z)| DVec3::new(0.0, y, z));
/// assert!((polygon_to_polygon(&floor, &wall) - 0.20004377607540316).abs() < 1e-14);
/// ```
pub fn polygon_to_polygon(a: &[DVec3], b: &[DVec3]) -> f64 {
    let side = |p: &[DVec3]| {
        let v = area_vector(p);
        let centre = centroid(p);
        Side { normal: v.normalize(), centre, radius: radius_about(p, centre), area: v.length() }
    };
    let (sa, sb) = (side(a), side(b));
    let (mut ca, mut cb) = (Vec::new(), Vec::new());
    match facing(a, &sa, b, &sb, &mut ca, &mut cb) {
        Some((a, b)) => exchange(a, &sa, b, &sb) / sa.area,
        None => 0.0,
    }
}

/// Properties of a polygon that the formulas use besides its corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) normal: DVec3,
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    pub(super) area: f64,
}

/// The parts of two polygons that lie in front of each other; `None` if there are none.
pub(super) fn facing<'a>(
    a: &'a [DVec3],
    sa: &Side,
    b: &'a [DVec3],
    sb: &Side,
    ca: &'a mut Vec<DVec3>,
    cb: &'a mut Vec<DVec3>,
) -> Option<(&'a [DVec3], &'a [DVec3])> {
    let b = in_front(b, sa, sb, cb)?;
    let a = in_front(a, sb, sa, ca)?;
    Some((a, b))
}

fn in_front<'a>(p: &'a [DVec3], of: &Side, own: &Side, out: &'a mut Vec<DVec3>) -> Option<&'a [DVec3]> {
    let tolerance = 1e-11 * (of.radius + own.radius);
    let offset = of.normal.dot(of.centre);
    let middle = of.normal.dot(own.centre) - offset;
    if middle >= own.radius {
        return Some(p);
    }
    if middle <= -own.radius {
        return None;
    }
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for q in p {
        let s = of.normal.dot(*q) - offset;
        (lo, hi) = (lo.min(s), hi.max(s));
    }
    if hi <= tolerance {
        return None;
    }
    if lo >= -tolerance {
        return Some(p);
    }
    clip(p, of.normal, offset, tolerance, out);
    (out.len() > 2).then_some(out)
}

/// A₁F₁₂ of two polygons that lie in front of each other.
pub(super) fn exchange(a: &[DVec3], sa: &Side, b: &[DVec3], sb: &Side) -> f64 {
    // Gauss points lie on the smaller polygon, because the error depends on the distance to the other polygon in radii of
    // this one
    let ((small, ss), (large, sl)) = if sa.radius <= sb.radius { ((a, sa), (b, sb)) } else { ((b, sb), (a, sa)) };
    let distance = (ss.centre - sl.centre).length() - sl.radius;
    if distance < 5.0 * ss.radius {
        let value = contour(a, b, sa.centre.distance_squared(sb.centre));
        // parts that touch in a sliver exchange less than the rounding error of the sum; a larger negative value is an error
        // and is returned
        let rounding = 1e-13 * ss.radius * sl.radius;
        return if value < 0.0 && value > -rounding { 0.0 } else { value };
    }
    let rule: &[(f64, f64)] = if distance < 24.0 * ss.radius { &GAUSS3 } else { &GAUSS2 };
    let at = |x: DVec3| -lambert(x, ss.normal, large);
    match *small {
        [p, q, r] => integrate([p, q, r, r], rule, at),
        [p, q, r, s] => integrate([p, q, r, s], rule, at),
        // a fan of quadrilaterals, plus one triangle if the number of corners is odd
        _ => (1..small.len() - 1)
            .step_by(2)
            .map(|i| integrate([small[0], small[i], small[i + 1], small[(i + 2).min(small.len() - 1)]], rule, at))
            .sum(),
    }
}

/// Σ θᵢ n·Γᵢ / 2π: positive if the polygon is clockwise as seen from `x`. The polygon must lie above the horizon.
#[inline]
fn lambert(x: DVec3, n: DVec3, polygon: &[DVec3]) -> f64 {
    let Some(&last) = polygon.last() else { return 0.0 };
    let mut sum = 0.0;
    let mut a = last - x;
    for &q in polygon {
        let b = q - x;
        let c = a.cross(b);
        let sine = c.length();
        // an edge whose line passes through x spans no angle
        if sine > 0.0 {
            sum += sine.atan2(a.dot(b)) * n.dot(c) / sine;
        }
        a = b;
    }
    sum / TAU
}

/// Nodes and weights of Gauss quadrature on [0, 1].
const GAUSS2: [(f64, f64); 2] = [(0.211_324_865_405_187_13, 0.5), (0.788_675_134_594_812_9, 0.5)];
const GAUSS3: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 0.277_777_777_777_777_8),
    (0.5, 0.444_444_444_444_444_4),
    (0.887_298_334_620_741_7, 0.277_777_777_777_777_8),
];
const GAUSS6: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_75, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_55, 0.233_956_967_286_345_5),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_5),
    (0.830_604_693_233_132_2, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// A product quadrature rule on the bilinear image of the unit square; two equal corners make it a triangle.
fn integrate([p, q, r, s]: [DVec3; 4], rule: &[(f64, f64)], f: impl Fn(DVec3) -> f64) -> f64 {
    let (eu, ev, twist) = (q - p, s - p, p - q + r - s);
    let mut sum = 0.0;
    for &(u, wu) in rule {
        for &(v, wv) in rule {
            let (du, dv) = (eu + v * twist, ev + u * twist);
            sum += wu * wv * du.cross(dv).length() * f(p + u * eu + v * dv);
        }
    }
    sum
}

/// (1/2π) ∮∮ ln r dx₁·dx₂. Lengths r are measured in units of √`unit`, which only affects rounding.
fn contour(a: &[DVec3], b: &[DVec3], unit: f64) -> f64 {
    let scale = if unit > 0.0 { 1.0 / unit } else { 1.0 };
    let mut sum = 0.0;
    for (i, &p) in a.iter().enumerate() {
        let q = a[(i + 1) % a.len()];
        let along = q - p;
        let length = along.length();
        let d = along / length;
        for (j, &c) in b.iter().enumerate() {
            let e = b[(j + 1) % b.len()];
            let other = e - c;
            let cosine = d.dot(other) / other.length();
            if cosine.abs() < 1e-12 {
                continue;
            }
            if d.cross(other).length_squared() < 1e-20 * other.length_squared() {
                // parallel: ∫∫ g(t − s) dt ds over s ∈ [0, length], t ∈ [t₀, t₁]
                let (t0, t1) = (d.dot(c - p), d.dot(e - p));
                let h2 = ((c - p) - t0 * d).length_squared();
                let h2 = if h2 < 1e-24 * length * length { 0.0 } else { h2 };
                let h = h2.sqrt();
                let g = |u: f64| g2(u, h, h2, scale);
                sum += g(t1) - g(t0) - g(t1 - length) + g(t0 - length);
            } else {
                sum += cosine * edge_pair(p, along, c, other, scale, 0);
            }
        }
    }
    sum / TAU
}

/// ∫∫ ln r ds dt of two skew edges, by Gauss quadrature on the first edge. This edge is halved until it is no longer than
/// its distance to the second.
fn edge_pair(p: DVec3, along: DVec3, c: DVec3, other: DVec3, scale: f64, depth: u32) -> f64 {
    let length = along.length();
    let middle = p + 0.5 * along;
    let t = ((middle - c).dot(other) / other.length_squared()).clamp(0.0, 1.0);
    if depth < 20 && middle.distance_squared(c + t * other) < length * length {
        let half = 0.5 * along;
        return edge_pair(p, half, c, other, scale, depth + 1) + edge_pair(p + half, half, c, other, scale, depth + 1);
    }
    let reach = other.length();
    let d = other / reach;
    let inner = |x: DVec3| {
        let t0 = d.dot(c - x);
        let h2 = ((c - x) - t0 * d).length_squared();
        let h = h2.sqrt();
        g1(t0 + reach, h, h2, scale) - g1(t0, h, h2, scale)
    };
    length * GAUSS6.iter().map(|&(u, w)| w * inner(p + u * along)).sum::<f64>()
}

/// ∫ ½ ln((u² + h²)·scale) du.
#[inline]
fn g1(u: f64, h: f64, h2: f64, scale: f64) -> f64 {
    let r2 = u * u + h2;
    if r2 == 0.0 {
        return 0.0;
    }
    0.5 * u * (r2 * scale).ln() - u + h * u.atan2(h)
}

/// ∫∫ ½ ln((u² + h²)·scale) du du.
#[inline]
fn g2(u: f64, h: f64, h2: f64, scale: f64) -> f64 {
    let r2 = u * u + h2;
    if r2 == 0.0 {
        return 0.0;
    }
    0.25 * (u * u - h2) * (r2 * scale).ln() - 0.75 * u * u + h * u * u.atan2(h)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: the double area integral by the midpoint rule.
    fn midpoint(a: &[DVec3; 4], b: &[DVec3; 4], m: usize) -> f64 {
        use crate::operator::patches::polygon::at;
        let points = |p: &[DVec3; 4]| -> Vec<(DVec3, f64)> {
            let h = |i: usize| (i as f64 + 0.5) / m as f64;
            (0..m * m).map(|k| at(p, h(k % m), h(k / m))).collect()
        };
        let (na, nb) = (area_vector(a).normalize(), area_vector(b).normalize());
        let mut sum = 0.0;
        for (x, v) in points(a) {
            for (y, w) in points(b) {
                let r = y - x;
                sum += v * w * na.dot(r).max(0.0) * (-nb.dot(r)).max(0.0) / r.length_squared().powi(2);
            }
        }
        sum / (m as f64).powi(4) / std::f64::consts::PI / area_vector(a).length()
    }

    fn quad(o: [f64; 3], u: [f64; 3], v: [f64; 3]) -> [DVec3; 4] {
        let [o, u, v] = [o, u, v].map(DVec3::from);
        [o, o + u, o + u + v, o + v]
    }

    #[test]
    fn skew_quads_agree_with_the_double_area_integral() {
        let a = quad([0., 0., 0.], [1., 0., 0.], [0., 1., 0.]);
        for b in [
            quad([0.2, 0.1, 0.8], [0.1, 0.9, 0.2], [0.8, 0.1, 0.3]),
            quad([2.0, 0.3, -0.4], [0.1, 0.3, 0.9], [-0.3, 0.9, 0.1]), // straddles the plane of a
            quad([5.0, 0.3, 1.0], [0.1, 0.3, 0.9], [-0.3, 0.9, 0.1]),
        ] {
            let plain = midpoint(&a, &b, 40);
            assert!((polygon_to_polygon(&a, &b) / plain - 1.0).abs() < 2e-3, "{plain}");
            assert!(
                (polygon_to_polygon(&a, &b) * area_vector(&a).length()
                    / (polygon_to_polygon(&b, &a) * area_vector(&b).length())
                    - 1.0)
                    .abs()
                    < 1e-6
            );
        }
    }

    #[test]
    fn the_far_rule_and_the_contour_agree() {
        let a = quad([0., 0., 0.], [1., 0., 0.], [0.2, 1., 0.]);
        let side = |p: &[DVec3]| {
            let v = area_vector(p);
            let c = centroid(p);
            Side { normal: v.normalize(), centre: c, radius: radius_about(p, c), area: v.length() }
        };
        for d in [4.5, 6.0, 9.0, 13.0, 20.0] {
            let b = quad([0.7 * d, 0.0, 0.7 * d], [0.0, 0.9, 0.1], [0.6, 0.1, -0.8]);
            let (far, near) = (exchange(&a, &side(&a), &b, &side(&b)), contour(&a, &b, d * d));
            assert!((far / near - 1.0).abs() < 2e-6, "{d}: {far} {near} {:e}", far / near - 1.0);
        }
    }

    #[test]
    fn edges_that_touch_at_an_angle_converge() {
        // a triangular prism is closed: the rows of its skew, touching faces sum to 1
        let [a, b, c] = [[0., 0., 0.], [1., 0., 0.], [0.3, 0.8, 0.]].map(DVec3::from);
        let up = DVec3::new(0.0, 0.0, 0.7);
        let faces: Vec<Vec<DVec3>> = vec![
            vec![a, b, c],
            vec![c + up, b + up, a + up],
            vec![a, a + up, b + up, b],
            vec![b, b + up, c + up, c],
            vec![c, c + up, a + up, a],
        ];
        for f in &faces {
            let sum: f64 = faces.iter().map(|g| polygon_to_polygon(f, g)).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{:e}", sum - 1.0);
        }
    }
}
