//! The L2 norm of an image, without the bias of its noise.
//!
//! `E[m̂²] = m² + Var m̂`, so the norm of a noisy image is too large. Products of different replicates r ≠ s have no such
//! term:
//!
//! `‖X‖² ≈ mean over pixels of  Σ_{r≠s} m_r m_s / (R(R−1))`,
//!
//! Here m_r is the mean of replicate r at a pixel. The estimate is unbiased. It may be negative; then only an upper limit of
//! the norm is known. The standard error comes from the jackknife over replicates (Efron and Stein, 1981).

use super::film::TermFilm;

/// A squared norm, averaged over pixels and channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquaredNorm {
    /// Unbiased estimate of the mean of X² over pixels and channels.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// Squared L2 norm of the image of a slot. Needs three replicates with equal numbers of samples; None if there are fewer.
pub fn squared_norm(film: &TermFilm, slot: usize) -> Option<SquaredNorm> {
    let r = film.shape.replicates;
    if r < 3 {
        return None;
    }
    // over pixels and channels: C = Σ S², A_r = Σ S m_r, B_r = Σ m_r², with S = Σ_r m_r
    let (mut c, mut a, mut b) = (0.0, vec![0.0; r], vec![0.0; r]);
    for p in 0..film.shape.pixels() {
        let m: Vec<_> = (0..r).map(|i| film.sum(p, i, slot) / film.count(p, i)).collect();
        let s: glam::DVec3 = m.iter().sum();
        c += s.length_squared();
        for i in 0..r {
            a[i] += s.dot(m[i]);
            b[i] += m[i].length_squared();
        }
    }
    let (all, n) = (b.iter().sum::<f64>(), r as f64);
    let scale = 1.0 / (3.0 * film.shape.pixels() as f64);
    let value = scale * (c - all) / (n * (n - 1.0));
    let without = |i: usize| scale * ((c - 2.0 * a[i] + b[i]) - (all - b[i])) / ((n - 1.0) * (n - 2.0));
    let center = (0..r).map(without).sum::<f64>() / n;
    let spread: f64 = (0..r).map(|i| (without(i) - center).powi(2)).sum();
    Some(SquaredNorm { value, std_error: (spread * (n - 1.0) / n).sqrt() })
}
