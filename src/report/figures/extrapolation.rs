//! Extrapolation of the whole from its first terms as they were measured: its accuracy, and its effect on the noise.
//!
//! ```text
//! A(t₁, …, tₙ) ± √(∇Aᵀ C ∇A)        gain = √(∇Aᵀ C ∇A / 1ᵀ C 1)        off = A − Σ t ± √(dᵀ C d),  d = ∇A − 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | t | estimates of T^k E for k = 1, 2, …, and last of the tail, in one channel | [`Measured::mean`] |
//! | C | their covariance from replicates. It is diagonal if each term has its own paths, but not for prefixes of one path | [`Measured::covariance`] |
//! | A | an extrapolation from the first n terms; see [`accelerate`] | |
//!
//! E is left out because it does not take part in the decay. All errors are to first order in the noise. The whole Σ t is
//! measured by the same paths, so that noise that A and Σ t share cancels in `off`.

use crate::report::text::{
    number::{plus_minus, significant},
    table::{Side, aligned},
};
use crate::solver::accelerate::{self, METHODS};
use nalgebra::{DMatrix, DVector};

/// The terms of one estimator.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Name of the estimator.
    pub label: String,
    /// The terms t.
    pub mean: Vec<f64>,
    /// Their covariance C.
    pub covariance: DMatrix<f64>,
    /// Number n of terms that the extrapolation uses.
    pub used: usize,
}

/// Result of an extrapolation, relative to the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrapolated {
    /// Standard error of A.
    pub noise: f64,
    /// Standard error of A divided by that of the sum of the same terms.
    pub gain: f64,
    /// A − Σ t, and its standard error.
    pub off: [f64; 2],
}

impl Measured {
    /// The result of every method of [`METHODS`]. `rate` is treated as known exactly. None if a method cannot be applied.
    pub fn outcomes(&self, rate: f64) -> [Option<Extrapolated>; 5] {
        let whole: f64 = self.mean.iter().sum();
        let c = self.covariance.view((0, 0), (self.used, self.used)).into_owned();
        accelerate::all(&self.mean[..self.used], rate).map(|a| {
            let a = a.filter(|a| a.value.is_finite())?;
            let d = |i: usize| a.gradient.get(i).copied().unwrap_or(0.0) - 1.0;
            let d = DVector::from_iterator(self.mean.len(), (0..self.mean.len()).map(d));
            // rounding in a sum that cancels may make it negative
            let error = (&self.covariance * &d).dot(&d).max(0.0).sqrt();
            Some(Extrapolated {
                noise: a.std_error(&c) / whole,
                gain: a.amplification(&c),
                off: [a.value / whole - 1.0, error / whole],
            })
        })
    }
}

/// A table with one row per method and three columns per estimator.
///
/// ```
/// use fredholm::report::figures::extrapolation::{Measured, table};
/// use nalgebra::DMatrix;
/// let covariance = DMatrix::from_diagonal_element(4, 4, 0.01);
/// let one = Measured { label: "by hand".into(), mean: vec![8.0, 4.0, 2.0, 2.0], covariance, used: 3 };
/// let table = table(&[one], 0.5);
/// assert!(table.lines().any(|l| l.split_whitespace().eq(["S_n", "−12.50", "±", "0.62", "%", "1.1", "%", "×1.0"])));
/// ```
pub fn table(measured: &[Measured], rate: f64) -> String {
    let outcomes: Vec<_> = measured.iter().map(|m| m.outcomes(rate)).collect();
    let mut header = vec![String::new()];
    header.extend(measured.iter().flat_map(|m| [format!("{}: off", m.label), "noise".into(), "gain".into()]));
    let mut rows = vec![header];
    for (m, name) in METHODS.into_iter().enumerate() {
        let cells = outcomes.iter().flat_map(|o| match o[m] {
            Some(Extrapolated { noise, gain, off: [off, error] }) => [
                format!("{} %", plus_minus(100.0 * off, 100.0 * error, 2)),
                format!("{} %", significant(100.0 * noise, 2)),
                format!("×{}", significant(gain, 2)),
            ],
            None => ["–", "–", "–"].map(String::from),
        });
        rows.push(std::iter::once(name.to_string()).chain(cells).collect());
    }
    let sides: Vec<Side> = (0..=3 * measured.len()).map(|i| if i == 0 { Side::Left } else { Side::Right }).collect();
    aligned(&rows, &sides)
}
