//! The whole from its first terms as they were measured: what extrapolation gains, and what it does to the noise.
//!
//! ```text
//! A(t₁, …, tₙ) ± √(∇Aᵀ C ∇A)        gain = √(∇Aᵀ C ∇A / 1ᵀ C 1)        off = A − Σ t ± √(dᵀ C d),  d = ∇A − 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | t | what T^k E is for k = 1, 2, …, and last the tail, in one channel, as an estimator found them | [`Measured::mean`] |
//! | C | their covariance from replicates: diagonal for terms of paths of their own, far from it for prefixes of one path | [`Measured::covariance`] |
//! | A | an extrapolation from the first n; see [`accelerate`] | |
//!
//! E is left out: it is no part of the decay. All errors are to first order in the noise. The whole is measured by the same
//! paths, so that the noise of what both share leaves `off`.

use crate::report::text::{
    number::{plus_minus, significant},
    table::{Side, aligned},
};
use crate::solver::accelerate::{self, METHODS};
use nalgebra::{DMatrix, DVector};

/// The terms of one estimator.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Who measured.
    pub label: String,
    /// t.
    pub mean: Vec<f64>,
    /// C.
    pub covariance: DMatrix<f64>,
    /// n.
    pub used: usize,
}

/// What an extrapolation has come to, in units of the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrapolated {
    /// Standard error of A.
    pub noise: f64,
    /// How much noisier than the sum of the same terms.
    pub gain: f64,
    /// A − Σ t, and its standard error.
    pub off: [f64; 2],
}

impl Measured {
    /// The outcome of every method of [`METHODS`]; `rate` is held to be known. None where a method has nothing to work with.
    pub fn outcomes(&self, rate: f64) -> [Option<Extrapolated>; 5] {
        let whole: f64 = self.mean.iter().sum();
        let c = self.covariance.view((0, 0), (self.used, self.used)).into_owned();
        accelerate::all(&self.mean[..self.used], rate).map(|a| {
            let a = a.filter(|a| a.value.is_finite())?;
            let d = |i: usize| a.gradient.get(i).copied().unwrap_or(0.0) - 1.0;
            let d = DVector::from_iterator(self.mean.len(), (0..self.mean.len()).map(d));
            // rounding of a sum that cancels may be below 0
            let error = (&self.covariance * &d).dot(&d).max(0.0).sqrt();
            Some(Extrapolated {
                noise: a.std_error(&c) / whole,
                gain: a.amplification(&c),
                off: [a.value / whole - 1.0, error / whole],
            })
        })
    }
}

/// A row per method, three columns per estimator.
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
