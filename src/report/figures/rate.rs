//! Geometric lines in the plot of the terms: the observed rate, the spectral radius, and the guaranteed bounds.
//!
//! ```text
//! value · ratio^(k − k0),   k ≥ k0
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | γ | rate fitted to the terms; valid only for the fitted terms | [`RateLine::observed`] |
//! | r(T_h) | spectral radius of the matrix: the asymptotic rate | [`RateLine::spectral`] |
//! | g | bound of ‖T‖₁: max albedo | [`RateLine::guaranteed`], [`RateLine::tail_bound`] |

use crate::report::{
    plot::{GREEN, ORANGE, PURPLE, SKY, Stroke},
    text::number::significant,
};
use crate::stats;

/// The line `value · ratio^(k − k0)` for k ≥ k0.
#[derive(Clone, Debug, PartialEq)]
pub struct RateLine {
    /// Text in the legend.
    pub label: String,
    /// Value of k at which the line starts.
    pub k0: f64,
    /// Value at `k0`.
    pub value: f64,
    /// Factor per bounce.
    pub ratio: f64,
    /// Meaning of the line.
    pub kind: RateKind,
}

/// Meaning of a geometric line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateKind {
    /// Fitted to the data; no statement about other terms.
    Observed,
    /// The spectral radius of the matrix: the asymptotic rate of its terms.
    Spectral,
    /// From ‖T‖₁ ≤ max albedo: no term lies above this line.
    Guaranteed,
    /// Bound of the sum of all terms after k bounces, not of single terms.
    TailBound,
}

impl RateKind {
    pub(super) fn stroke(self) -> Stroke {
        match self {
            Self::Observed => Stroke::solid(ORANGE, 2.0),
            Self::Spectral => Stroke { color: SKY, width: 2.0, dash: Some((9.0, 4.0)) },
            Self::Guaranteed => Stroke::solid(GREEN, 2.0),
            Self::TailBound => Stroke { color: PURPLE, width: 1.8, dash: Some((3.0, 3.0)) },
        }
    }
}

impl RateLine {
    /// The line of a fitted rate, starting at the first term of the fit.
    pub fn observed(fit: &stats::Rate) -> Self {
        let start = fit.window.start;
        Self {
            label: format!("observed rate {:.4} ± {:.4}", fit.rate, fit.std_error),
            k0: start as f64,
            value: fit.amplitude * fit.rate.powi(start as i32),
            ratio: fit.rate,
            kind: RateKind::Observed,
        }
    }

    /// The spectral radius of the matrix, as a line through the last of the norms `‖T_h^k E‖₁`, k = 0, 1, …
    pub fn spectral(radius: f64, norms: &[f64]) -> Option<Self> {
        let last = norms.len().checked_sub(1)?;
        Some(Self {
            label: format!("spectral radius of the matrix {radius:.4}"),
            k0: 1.0,
            value: norms[last] / radius.powi(last as i32 - 1),
            ratio: radius,
            kind: RateKind::Spectral,
        })
    }

    /// The bound of every term: `‖T^k E‖₁ ≤ g^k ‖E‖₁`.
    pub fn guaranteed(g: f64, emission: f64) -> Self {
        let label = format!("guaranteed: ‖T‖₁ ≤ max albedo = {g:.3}");
        Self { label, k0: 0.0, value: emission, ratio: g, kind: RateKind::Guaranteed }
    }

    /// The bound of the tail: `‖Σ_{n>k} T^n E‖₁ ≤ g/(1−g) ‖T^k E‖₁`. None if g ≥ 1 or the norm of term k is zero.
    pub fn tail_bound(g: f64, k: usize, norm: f64) -> Option<Self> {
        let bound = g / (1.0 - g) * norm;
        (g < 1.0 && norm > 0.0).then(|| Self {
            label: format!("‖Σ k>{k}‖₁ ≤ {}", significant(bound, 3)),
            k0: k as f64,
            value: bound,
            ratio: g,
            kind: RateKind::TailBound,
        })
    }
}
