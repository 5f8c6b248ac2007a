//! Mean and covariance over replicates.
//!
//! ```text
//! x̄ = (1/n) Σ x_r      S_ab = 1/(n−1) Σ (x_ra − x̄_a)(x_rb − x̄_b)      Cov(x̄_a, x̄_b) ≈ S_ab / n
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_r | one replicate: a vector of scalars measured together, such as the terms k = 0..=K of one channel | [`Moments::push`] |
//! | x̄ | mean over replicates | [`Moments::mean`] |
//! | S | sample covariance of one replicate | [`Moments::covariance`] |
//! | S/n | covariance of the mean, from which every standard error comes | [`Moments::covariance_of_mean`] |
//!
//! The sums are updated about the running mean, never as Σx² − nx̄², which loses all digits when the spread is small
//! compared with the mean. Welford, *Technometrics* 4 (1962); merging of parts: Chan, Golub and LeVeque, *The American
//! Statistician* 37 (1983).

use crate::terms::Estimate;
use glam::DVec3;
use nalgebra::{DMatrix, DVector};

/// Running mean and co-moments of vectors of one fixed length. A scalar is a vector of length 1.
///
/// ```
/// use fredholm::stats::Moments;
/// let mut m = Moments::new(1);
/// for x in [1.0, 2.0, 4.0, 5.0] {
///     m.push(&[x]);
/// }
/// assert_eq!(m.mean()[0], 3.0);
/// assert!((m.variance(0) - 10.0 / 3.0).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    count: u64,
    mean: DVector<f64>,
    /// Σ (x_r − x̄)(x_r − x̄)ᵀ
    comoment: DMatrix<f64>,
}

impl Moments {
    /// Moments of vectors of length `len`, without any replicate yet.
    pub fn new(len: usize) -> Self {
        Self { count: 0, mean: DVector::zeros(len), comoment: DMatrix::zeros(len, len) }
    }

    /// Adds one replicate.
    ///
    /// # Panics
    /// If its length is not the one given to [`Moments::new`].
    pub fn push(&mut self, x: &[f64]) {
        self.count += 1;
        let before = DVector::from_column_slice(x) - &self.mean;
        self.mean += &before / self.count as f64;
        let weight = (self.count - 1) as f64 / self.count as f64;
        self.comoment.ger(weight, &before, &before, 1.0);
    }

    /// Adds the replicates of another part. The result does not depend on how the replicates were divided, up to rounding.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let shift = &other.mean - &self.mean;
        self.comoment += &other.comoment;
        self.comoment.ger(n * m / (n + m), &shift, &shift, 1.0);
        self.mean += shift * (m / (n + m));
        self.count += other.count;
    }

    /// Number of replicates so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// x̄; zero before the first replicate.
    pub fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    /// S, the covariance of one replicate. NaN with fewer than two replicates, because the spread is then unknown.
    pub fn covariance(&self) -> DMatrix<f64> {
        if self.count < 2 {
            return DMatrix::from_element(self.mean.len(), self.mean.len(), f64::NAN);
        }
        &self.comoment / (self.count - 1) as f64
    }

    /// S_ii, the variance of component i. NaN with fewer than two replicates.
    pub fn variance(&self, i: usize) -> f64 {
        if self.count < 2 { f64::NAN } else { self.comoment[(i, i)] / (self.count - 1) as f64 }
    }

    /// S/n: the covariance of [`Moments::mean`].
    pub fn covariance_of_mean(&self) -> DMatrix<f64> {
        self.covariance() / self.count as f64
    }

    /// √(S_ii/n): the standard error of the mean of component `i`.
    pub fn std_error(&self, i: usize) -> f64 {
        (self.variance(i) / self.count as f64).sqrt()
    }
}

/// The estimate of one RGB value from independent replicates. One replicate gives no error (NaN), and no replicate gives no
/// mean either.
pub fn estimate(replicates: &[DVec3]) -> Estimate {
    let n = replicates.len() as f64;
    let mean = replicates.iter().sum::<DVec3>() / n;
    let squares: DVec3 = replicates.iter().map(|&x| (x - mean) * (x - mean)).sum();
    let variance = squares / (n - 1.0); // 0/0 = NaN for n = 1
    Estimate { mean, std_error: (variance / n).map(f64::sqrt), replicates: replicates.len() as u64, events: None }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Reference implementation for the test: two passes over all data.
    fn two_pass(rows: &[Vec<f64>]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (n, d) = (rows.len() as f64, rows[0].len());
        let mean: Vec<f64> = (0..d).map(|a| rows.iter().map(|r| r[a]).sum::<f64>() / n).collect();
        let cov = (0..d)
            .map(|a| {
                (0..d)
                    .map(|b| rows.iter().map(|r| (r[a] - mean[a]) * (r[b] - mean[b])).sum::<f64>() / (n - 1.0))
                    .collect()
            })
            .collect();
        (mean, cov)
    }

    /// Irregular numbers whose mean is far larger than their spread.
    fn rows() -> Vec<Vec<f64>> {
        let x = |i: usize| ((i * i * 7 + i * 13) % 101) as f64;
        (0..37).map(|i| vec![1e6 + x(i), 0.5 * x(i) - x(i + 5), x(i + 11)]).collect()
    }

    fn of(rows: &[Vec<f64>]) -> Moments {
        let mut m = Moments::new(3);
        rows.iter().for_each(|r| m.push(r));
        m
    }

    fn assert_close(m: &Moments, rows: &[Vec<f64>]) {
        let (mean, cov) = two_pass(rows);
        for a in 0..3 {
            assert!((m.mean()[a] - mean[a]).abs() < 1e-13 * (1.0 + mean[a].abs()), "mean {a}");
            for (b, expected) in cov[a].iter().enumerate() {
                assert!((m.covariance()[(a, b)] - expected).abs() < 1e-9 * 900.0, "covariance {a} {b}");
            }
        }
    }

    #[test]
    fn running_sums_equal_two_passes() {
        assert_close(&of(&rows()), &rows());
    }

    #[test]
    fn parts_merge_in_any_order() {
        let rows = rows();
        for cuts in [[0, 5, 20], [1, 2, 3], [10, 10, 36]] {
            let mut parts =
                [of(&rows[..cuts[0]]), of(&rows[cuts[0]..cuts[1]]), of(&rows[cuts[1]..cuts[2]]), of(&rows[cuts[2]..])];
            for _ in 0..4 {
                parts.rotate_left(1);
                let mut all = Moments::new(3);
                parts.iter().for_each(|p| all.merge(p));
                assert_eq!(all.count(), 37);
                assert_close(&all, &rows);
            }
        }
    }

    #[test]
    fn a_single_replicate_has_a_mean_but_no_error() {
        let one = estimate(&[DVec3::new(1.0, 2.0, 3.0)]);
        assert_eq!(one.mean, DVec3::new(1.0, 2.0, 3.0));
        assert!(one.std_error.is_nan_mask().all());
        let mut m = Moments::new(1);
        m.push(&[2.0]);
        assert!(m.std_error(0).is_nan() && m.covariance_of_mean()[(0, 0)].is_nan());
    }

    #[test]
    fn an_estimate_is_the_moments_of_its_channels() {
        let rows = rows();
        let e = estimate(&rows.iter().map(|r| DVec3::from_slice(r)).collect::<Vec<_>>());
        let m = of(&rows);
        for c in 0..3 {
            assert!((e.mean[c] - m.mean()[c]).abs() < 1e-13 * (1.0 + m.mean()[c].abs()));
            assert!((e.std_error[c] / m.std_error(c) - 1.0).abs() < 1e-9);
        }
    }
}
