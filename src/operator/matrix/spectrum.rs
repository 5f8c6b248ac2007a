//! The spectral radius of `diag(w) F` by power iteration, with a lower bound at every step.
//!
//! ```text
//! S = √(wᵢAᵢ) Fᵢⱼ √(wⱼ/Aⱼ)         symmetric, same non-zero eigenvalues as diag(w) F
//! r ≥ ‖S v‖ / ‖v‖ ≥ ‖v·S v‖ / ‖v‖²   and the ratio ‖S^{k+1} v‖ / ‖S^k v‖ never falls
//! ```
//!
//! | choice of w | use of the result |
//! |---|---|
//! | w = ρ | T itself: the terms T^k E fall at the rate r |
//! | w = ρ²/s | second moments of random walks with constant survival probability s: the variance is finite iff r < 1 (F > 0 connected) |
//!
//! The ratio of lengths is the square root of the Rayleigh quotient of S². It converges even if both +r and −r are
//! eigenvalues (two plates); the Rayleigh quotient of S itself need not converge then.

use super::product::product;
use crate::operator::form_factor::FormFactors;

/// Result of the power iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectral {
    /// ‖S v‖ for the last unit vector v: a lower bound that increases towards the spectral radius.
    pub radius: f64,
    /// v·S v for the same vector: an estimate of the eigenvalue to which v belongs. It is well below `radius` if both +r and
    /// −r are eigenvalues.
    pub rayleigh: f64,
    /// ‖S v − rayleigh·v‖: some eigenvalue lies within this distance of `rayleigh`.
    pub residual: f64,
    /// Number of steps.
    pub steps: usize,
    /// The mode u with diag(w) F u ≈ radius·u, scaled so that its largest magnitude is 1.
    pub mode: Vec<f64>,
}

/// The spectral radius of `diag(w) F`. The iteration ends when the relative change per step is at most `tolerance`, or after
/// `max_steps` steps.
///
/// ```
/// use fredholm::operator::{form_factor::FormFactors, matrix::spectral_radius};
/// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
/// assert!((spectral_radius(&plates, &[0.9, 0.4], 1e-14, 100).radius - 0.6).abs() < 1e-14);
/// ```
pub fn spectral_radius(factors: &FormFactors, w: &[f64], tolerance: f64, max_steps: usize) -> Spectral {
    let left: Vec<f64> = w.iter().zip(&factors.area).map(|(w, a)| (w * a).sqrt()).collect();
    let right: Vec<f64> = w.iter().zip(&factors.area).map(|(w, a)| (w / a).sqrt()).collect();
    let apply = |v: &[f64], y: &mut [f64]| {
        let scaled: Vec<f64> = v.iter().zip(&right).map(|(v, r)| v * r).collect();
        product(factors, &left, &scaled, y);
    };
    // the start u = w is the first bounce of a uniformly lit scene; it has a positive part along the top mode of every
    // connected component
    let mut v = left.clone();
    let mut y = vec![0.0; factors.n];
    let mut found = Spectral { radius: 0.0, rayleigh: 0.0, residual: 0.0, steps: 0, mode: vec![0.0; factors.n] };
    if !normalise(&mut v) {
        return found;
    }
    for steps in 1..=max_steps {
        apply(&v, &mut y);
        let radius = y.iter().map(|y| y * y).sum::<f64>().sqrt();
        let settled = (radius - found.radius).abs() <= tolerance * radius;
        found.rayleigh = y.iter().zip(&v).map(|(y, v)| y * v).sum();
        found.residual = y.iter().zip(&v).map(|(y, v)| (y - found.rayleigh * v).powi(2)).sum::<f64>().sqrt();
        (found.radius, found.steps) = (radius, steps);
        // if both +r and −r are eigenvalues, the residual stays large; so only the change of the ratio decides
        if settled {
            break;
        }
        std::mem::swap(&mut v, &mut y);
        if !normalise(&mut v) {
            break;
        }
    }
    let mode: Vec<f64> = v.iter().zip(&right).map(|(v, r)| v * r).collect();
    let largest = mode.iter().fold(0.0, |a: f64, u| a.max(u.abs()));
    if largest > 0.0 {
        found.mode = mode.iter().map(|u| u / largest).collect();
    }
    found
}

/// Scales the vector to length 1; returns false for the zero vector.
fn normalise(v: &mut [f64]) -> bool {
    let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    v.iter_mut().for_each(|v| *v /= if length > 0.0 { length } else { 1.0 });
    length > 0.0
}
