//! Polygons as triangles.
//!
//! ```text
//! N = Σ (pᵢ − p₀) × (pᵢ₊₁ − p₀)        twice the area of the polygon, along its normal
//! ```
//!
//! A convex polygon p₀ … pₙ is the fan of triangles (p₀, pᵢ, pᵢ₊₁): all of them face along N. Any other polygon is projected along N
//! and cut by the ear-clipping method of the crate `earcut`. The triangles then have the area of the polygon, unless its
//! outline crosses itself.
//!
//! Reference: M. Newell, in Sutherland, Sproull and Schumacker (1974), for N.

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// Relative difference of areas that rounding explains.
const ROUNDING: f64 = 1e-6;

/// The triangles of a polygon, as indices of its corners.
pub(super) struct Cut {
    pub(super) triangles: Vec<[usize; 3]>,
    /// True if the outline crosses itself, so that no triangles represent it.
    pub(super) crossed: bool,
}

/// Cuts a polygon into triangles whose winding is that of the polygon.
pub(super) fn cut(corners: &[DVec3]) -> Cut {
    let fan: Vec<[usize; 3]> = (1..corners.len().saturating_sub(1)).map(|i| [0, i, i + 1]).collect();
    let twice = |[a, b, c]: [usize; 3]| (corners[b] - corners[a]).cross(corners[c] - corners[a]);
    let normal: DVec3 = fan.iter().map(|&t| twice(t)).sum();
    let convex = fan.iter().all(|&t| twice(t).dot(normal) >= 0.0);
    let Some(axis) = normal.try_normalize().filter(|_| !convex) else { return Cut { triangles: fan, crossed: false } };
    let (right, up) = axis.any_orthonormal_pair();
    let flat: Vec<DVec2> =
        corners.iter().map(|p| *p - corners[0]).map(|p| DVec2::new(p.dot(right), p.dot(up))).collect();
    let mut found: Vec<usize> = vec![];
    Earcut::new().earcut(flat.iter().map(|p| p.to_array()), &[], &mut found);
    let area = |[a, b, c]: [usize; 3]| (flat[b] - flat[a]).perp_dot(flat[c] - flat[a]);
    let facing = |t: [usize; 3]| if area(t) < 0.0 { [t[0], t[2], t[1]] } else { t };
    let triangles: Vec<[usize; 3]> = found.as_chunks().0.iter().map(|&t| facing(t)).collect();
    let (whole, sum) = (normal.length(), triangles.iter().map(|&t| area(t)).sum::<f64>());
    Cut { triangles, crossed: (sum - whole).abs() > ROUNDING * whole }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(corners: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let twice = |t: &[usize; 3]| (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]).length();
        triangles.iter().map(twice).sum::<f64>() / 2.0
    }

    #[test]
    fn an_l_has_its_area_and_its_normal() {
        let l = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
        for start in 0..6 {
            let corners: Vec<DVec3> = (0..6).map(|i| l[(start + i) % 6]).map(|(x, y)| DVec3::new(x, 0.3, -y)).collect();
            let cut = cut(&corners);
            assert!(!cut.crossed && cut.triangles.len() == 4);
            assert!((area(&corners, &cut.triangles) - 3.0).abs() < 1e-12);
            for [a, b, c] in cut.triangles {
                assert!((corners[b] - corners[a]).cross(corners[c] - corners[a]).y > 0.0);
            }
        }
    }

    #[test]
    fn an_outline_that_crosses_itself_is_named() {
        let bow = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        assert!(cut(&bow).crossed);
    }

    proptest! {
        /// Stars around a point are simple polygons; any plane, any start, both windings.
        #[test]
        fn stars_have_their_area(
            radii in proptest::collection::vec(0.2..2.0f64, 4..12),
            turn in proptest::array::uniform3(-3.0..3.0f64),
            back: bool,
        ) {
            let n = radii.len();
            let rotation = glam::DQuat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]);
            let corner = |i: usize| {
                let (s, c) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
                rotation * DVec3::new(radii[i] * c, radii[i] * s, 0.0)
            };
            let corners: Vec<DVec3> = (0..n).map(|i| corner(if back { n - 1 - i } else { i })).collect();
            let angle = (std::f64::consts::TAU / n as f64).sin();
            let truth: f64 = (0..n).map(|i| radii[i] * radii[(i + 1) % n] * angle / 2.0).sum();
            let found = cut(&corners);
            prop_assert!(!found.crossed);
            prop_assert!((area(&corners, &found.triangles) / truth - 1.0).abs() < 1e-9);
            let normal = rotation * if back { -DVec3::Z } else { DVec3::Z };
            for [a, b, c] in found.triangles {
                prop_assert!((corners[b] - corners[a]).cross(corners[c] - corners[a]).dot(normal) > -1e-9);
            }
        }
    }
}
