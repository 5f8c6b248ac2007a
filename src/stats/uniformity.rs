//! A test whether p-values are uniform, as they are if there is nothing to find.
//!
//! ```text
//! D = sup_u | #{p_i ≤ u}/n − u |        P(D ≥ d) ≤ 2 exp(−2 n d²)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | D | Kolmogorov's distance from the uniform law | [`Uniformity::distance`] |
//! | p | upper bound of the probability of such a distance: valid for every n, and close to the exact value where it is small | [`Uniformity::p`] |
//! | band | distance within which p-values stay with probability 1 − α | [`band`] |
//!
//! Dvoretzky, Kiefer and Wolfowitz (1956), with the constant of Massart, *Annals of Probability* 18 (1990).

/// Distance of a set of p-values from the uniform distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniformity {
    /// Number of p-values.
    pub count: usize,
    /// D; NaN if a p-value is NaN or if there is none.
    pub distance: f64,
    /// Upper bound of the probability of a distance this large if the p-values are uniform.
    pub p: f64,
}

/// Computes the distance of independent p-values from the uniform distribution.
///
/// ```
/// use fredholm::stats::uniformity;
/// let even: Vec<f64> = (0..100).map(|i| (f64::from(i) + 0.5) / 100.0).collect();
/// assert!((uniformity(&even).distance - 0.005).abs() < 1e-12);
/// let small: Vec<f64> = even.iter().map(|p| p * p).collect();
/// assert!(uniformity(&small).p < 1e-3);
/// ```
pub fn uniformity(p: &[f64]) -> Uniformity {
    let mut sorted = p.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = p.len() as f64;
    let gap = |(i, &p): (usize, &f64)| ((i as f64 + 1.0) / n - p).max(p - i as f64 / n);
    let distance = if p.is_empty() || p.iter().any(|p| p.is_nan()) {
        f64::NAN
    } else {
        sorted.iter().enumerate().map(gap).fold(0.0, f64::max)
    };
    Uniformity { count: p.len(), distance, p: if distance.is_nan() { f64::NAN } else { tail(n, distance) } }
}

fn tail(n: f64, distance: f64) -> f64 {
    (2.0 * (-2.0 * n * distance * distance).exp()).min(1.0)
}

/// The distance within which `n` uniform numbers stay with probability 1 − `alpha`.
pub fn band(n: usize, alpha: f64) -> f64 {
    ((2.0 / alpha).ln() / (2.0 * n as f64)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        assert_eq!(uniformity(&[0.5]).distance, 0.5);
        assert!((uniformity(&[0.9, 0.1, 0.2]).distance - (2.0 / 3.0 - 0.2)).abs() < 1e-15);
        assert_eq!(uniformity(&[0.0, 0.0]).distance, 1.0);
        assert!(uniformity(&[]).p.is_nan() && uniformity(&[0.3, f64::NAN]).p.is_nan());
    }

    #[test]
    fn the_band_is_the_inverse_of_the_tail() {
        for (n, alpha) in [(10, 0.05), (1000, 1e-9)] {
            assert!((tail(n as f64, band(n, alpha)) / alpha - 1.0).abs() < 1e-9);
        }
    }
}
