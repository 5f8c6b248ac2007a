//! Convex polygons in space. The corners are listed counter-clockwise as seen from the front.
//!
//! ```text
//! a = ½ Σᵢ (pᵢ − p₀) × (pᵢ₊₁ − p₀)        area vector: its length is the area, its direction the normal of the front
//! ```

use glam::DVec3;

/// The vector ½ Σ pᵢ × pᵢ₊₁: its length is the area (m²), its direction the normal of the front.
pub fn area_vector(p: &[DVec3]) -> DVec3 {
    let Some(&o) = p.first() else { return DVec3::ZERO };
    0.5 * p.windows(2).map(|w| (w[0] - o).cross(w[1] - o)).sum::<DVec3>()
}

/// Centroid of the polygon (centre of mass at uniform density).
pub fn centroid(p: &[DVec3]) -> DVec3 {
    let n = area_vector(p);
    let o = p[0];
    let moment: DVec3 = p.windows(2).map(|w| (w[0] - o).cross(w[1] - o).dot(n) * ((w[0] - o) + (w[1] - o))).sum();
    o + moment / (6.0 * n.length_squared())
}

/// Largest distance of a corner of `p` from the point `c`.
pub fn radius_about(p: &[DVec3], c: DVec3) -> f64 {
    p.iter().map(|q| q.distance_squared(c)).fold(0.0, f64::max).sqrt()
}

/// Writes the part of `p` with `normal·x ≥ offset` to `out`. A corner within `tolerance` of the plane counts as lying on it.
pub fn clip(p: &[DVec3], normal: DVec3, offset: f64, tolerance: f64, out: &mut Vec<DVec3>) {
    out.clear();
    let height = |x: DVec3| {
        let s = normal.dot(x) - offset;
        if s.abs() <= tolerance { 0.0 } else { s }
    };
    for (i, &a) in p.iter().enumerate() {
        let b = p[(i + 1) % p.len()];
        let (s, t) = (height(a), height(b));
        if s >= 0.0 {
            out.push(a);
        }
        if s * t < 0.0 {
            out.push(a + (b - a) * (s / (s - t)));
        }
    }
}

/// Lowest and highest value of `axis·x` over the corners.
pub fn extent(p: &[DVec3], axis: DVec3) -> [f64; 2] {
    p.iter().map(|q| axis.dot(*q)).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], s| [a.min(s), b.max(s)])
}

/// Maps `[0, 1]²` onto the polygon. Returns the point and the density factor |∂x/∂(u, v)|.
///
/// Quadrilaterals are mapped bilinearly, triangles with a constant factor, and all other polygons as a fan of triangles.
pub fn at(p: &[DVec3], u: f64, v: f64) -> (DVec3, f64) {
    let triangle = |a: DVec3, b: DVec3, c: DVec3, u: f64, v: f64| {
        let r = u.sqrt();
        a + r * ((1.0 - v) * (b - a) + v * (c - a))
    };
    match *p {
        [a, b, c, d] => {
            let (du, dv) = ((b - a) * (1.0 - v) + (c - d) * v, (d - a) * (1.0 - u) + (c - b) * u);
            (a + (d - a) * v + du * u, du.cross(dv).length())
        }
        [a, b, c] => (triangle(a, b, c, u, v), 0.5 * (b - a).cross(c - a).length()),
        _ => {
            let whole = area_vector(p).length();
            let mut rest = u * whole;
            let mut k = 1;
            loop {
                let part = 0.5 * (p[k] - p[0]).cross(p[k + 1] - p[0]).length();
                if rest <= part || k + 2 == p.len() {
                    return (triangle(p[0], p[k], p[k + 1], (rest / part).min(1.0), v), whole);
                }
                rest -= part;
                k += 1;
            }
        }
    }
}

/// Maps `[0, 1]²` onto the polygon with constant density, so that uniform numbers give uniformly distributed points.
pub fn uniform(p: &[DVec3], u: f64, v: f64) -> DVec3 {
    if let [a, b, c, d] = *p {
        if (a - b + c - d).length_squared() <= 1e-20 * (c - a).length_squared() {
            return a + u * (b - a) + v * (d - a);
        }
        // otherwise two triangles
        let first = (b - a).cross(c - a).length();
        let share = first / (first + (c - a).cross(d - a).length());
        return if u < share {
            at(&[a, b, c], u / share, v).0
        } else {
            at(&[a, c, d], (u - share) / (1.0 - share), v).0
        };
    }
    at(p, u, v).0
}

/// The line perpendicular to the longest extent that has the fraction `share` of the area below it. Returned as `(axis,
/// offset)`; the lower part is `axis·x ≤ offset`.
///
/// Extents are measured along the edges. If several are equal the first is taken, so a square is divided along its first
/// edge.
pub fn equal_area_line(p: &[DVec3], share: f64) -> (DVec3, f64) {
    let mut axis = DVec3::ZERO;
    let mut longest = 0.0;
    for (i, &a) in p.iter().enumerate() {
        let d = (p[(i + 1) % p.len()] - a).normalize_or_zero();
        let [lo, hi] = extent(p, d);
        if hi - lo > longest * (1.0 + 1e-9) {
            (axis, longest) = (d, hi - lo);
        }
    }
    // Newton's method with bisection as safeguard for area(below s) = share · area; the slope is the length of the chord at
    // s
    let [mut lo, mut hi] = extent(p, axis);
    let [width, whole] = [hi - lo, area_vector(p).length()];
    let mut s = lo + share * width;
    let mut part = Vec::with_capacity(p.len() + 2);
    for _ in 0..60 {
        clip(p, -axis, -s, 0.0, &mut part);
        let excess = area_vector(&part).length() - share * whole;
        if excess.abs() <= 1e-15 * whole {
            break;
        }
        if excess > 0.0 {
            hi = s
        } else {
            lo = s
        }
        let chord = {
            let on: Vec<DVec3> = part.iter().copied().filter(|q| (axis.dot(*q) - s).abs() <= 1e-12 * width).collect();
            on.first().zip(on.last()).map_or(0.0, |(a, b)| a.distance(*b))
        };
        let newton = s - excess / chord;
        let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
        if next == s {
            break;
        }
        s = next;
    }
    (axis, s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pentagon() -> Vec<DVec3> {
        [(0.0, 0.0), (2.0, 0.1), (2.5, 1.0), (1.0, 2.0), (-0.3, 1.1)].map(|(x, y)| DVec3::new(x, y, 0.3 * x)).to_vec()
    }

    #[test]
    fn clipping_conserves_area_and_first_moment() {
        let p = pentagon();
        let (mut low, mut high) = (vec![], vec![]);
        let n = DVec3::new(0.6, 0.8, 0.0);
        clip(&p, n, 1.1, 0.0, &mut high);
        clip(&p, -n, -1.1, 0.0, &mut low);
        let area = |q: &[DVec3]| area_vector(q).length();
        assert!((area(&low) + area(&high) - area(&p)).abs() < 1e-14);
        let moment = area(&low) * centroid(&low) + area(&high) * centroid(&high);
        assert!((moment - area(&p) * centroid(&p)).length() < 1e-14);
    }

    #[test]
    fn lines_cut_off_the_asked_share() {
        let p = pentagon();
        for share in [0.1, 1.0 / 3.0, 0.5, 0.77] {
            let (axis, s) = equal_area_line(&p, share);
            let mut low = vec![];
            clip(&p, -axis, -s, 0.0, &mut low);
            assert!((area_vector(&low).length() / area_vector(&p).length() - share).abs() < 1e-14, "{share}");
        }
    }

    #[test]
    fn the_unit_square_map_integrates_one_and_x() {
        let quad = vec![DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(1.5, 1.0, 0.0), DVec3::new(0.0, 1.2, 0.0)];
        for p in [pentagon(), quad, pentagon()[..3].to_vec()] {
            let m = 400;
            let (mut one, mut x) = (0.0, DVec3::ZERO);
            for k in 0..m * m {
                let h = |i: usize| (i as f64 + 0.5) / m as f64;
                let (q, w) = at(&p, h(k % m), h(k / m));
                one += w;
                x += w * q;
            }
            let area = area_vector(&p).length();
            assert!((one / (m * m) as f64 / area - 1.0).abs() < 1e-9);
            let uniform: DVec3 = (0..m * m)
                .map(|k| uniform(&p, ((k % m) as f64 + 0.5) / m as f64, ((k / m) as f64 + 0.5) / m as f64))
                .sum();
            assert!((uniform / (m * m) as f64 - centroid(&p)).length() < 2.0 / m as f64);
            // the fan jumps from one triangle to the next, which lowers the order of the midpoint rule by one
            assert!((x / one - centroid(&p)).length() < 2.0 / m as f64);
        }
    }
}
