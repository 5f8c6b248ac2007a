//! What must hold for every matrix of form factors.
//!
//! ```text
//! Σⱼ Fᵢⱼ = 1 (closed), ≤ 1 (open)        Aᵢ Fᵢⱼ = Aⱼ Fⱼᵢ        0 ≤ Fᵢⱼ ≤ 1
//! ```

use super::FormFactors;

/// The invariants of a matrix as measured; printed with every run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invariants {
    /// max |1 − Σⱼ Fᵢⱼ|: small in a closed scene.
    pub closure: f64,
    /// Smallest row sum.
    pub row_sum_min: f64,
    /// Largest row sum: above 1 by errors of F only.
    pub row_sum_max: f64,
    /// Largest |AᵢFᵢⱼ − AⱼFⱼᵢ| relative to the larger of the two.
    pub reciprocity: f64,
    /// Smallest entry.
    pub smallest: f64,
    /// Largest entry.
    pub largest: f64,
}

impl Invariants {
    pub(super) fn of(factors: &FormFactors) -> Self {
        let n = factors.n;
        let mut out = Self {
            closure: 0.0,
            row_sum_min: f64::INFINITY,
            row_sum_max: f64::NEG_INFINITY,
            reciprocity: 0.0,
            smallest: f64::INFINITY,
            largest: f64::NEG_INFINITY,
        };
        for i in 0..n {
            let mut sum = 0.0;
            for (j, &f) in factors.row(i).iter().enumerate() {
                let f = f64::from(f);
                sum += f;
                out.smallest = out.smallest.min(f);
                out.largest = out.largest.max(f);
                let (there, back) = (factors.area[i] * f, factors.area[j] * f64::from(factors.f[j * n + i]));
                let scale = there.abs().max(back.abs());
                if i < j && scale > 0.0 {
                    out.reciprocity = out.reciprocity.max((there - back).abs() / scale);
                }
            }
            out.closure = out.closure.max((1.0 - sum).abs());
            out.row_sum_min = out.row_sum_min.min(sum);
            out.row_sum_max = out.row_sum_max.max(sum);
        }
        out
    }
}
