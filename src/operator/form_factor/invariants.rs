//! Properties that every matrix of form factors must have.
//!
//! ```text
//! Σⱼ Fᵢⱼ = 1 (closed), ≤ 1 (open)        Aᵢ Fᵢⱼ = Aⱼ Fⱼᵢ        0 ≤ Fᵢⱼ ≤ 1
//! ```

use super::FormFactors;

/// The measured properties of a matrix of form factors; every run prints them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invariants {
    /// Largest error of a row sum, max |1 − Σⱼ Fᵢⱼ|; it is small in a closed scene.
    pub closure: f64,
    /// Smallest row sum.
    pub row_sum_min: f64,
    /// Largest row sum; a value above 1 shows an error of F.
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
                out.largest = worst(out.largest, f);
                let (there, back) = (factors.area[i] * f, factors.area[j] * f64::from(factors.f[j * n + i]));
                let scale = there.abs().max(back.abs());
                if i < j && scale > 0.0 {
                    out.reciprocity = worst(out.reciprocity, (there - back).abs() / scale);
                }
            }
            out.closure = worst(out.closure, (1.0 - sum).abs());
            out.row_sum_min = out.row_sum_min.min(sum);
            out.row_sum_max = worst(out.row_sum_max, sum);
        }
        out
    }
}

/// The larger of two numbers; NaN if one is NaN, which `f64::max` would hide.
fn worst(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_matrices_show() {
        let of = |f: [f32; 4]| FormFactors { n: 2, f: f.to_vec(), area: vec![1.0, 2.0], rays: 0 }.invariants();
        assert!(of([f32::NAN, 0.5, 0.25, 0.75]).closure.is_nan());
        let good = of([0.5, 0.5, 0.25, 0.75]);
        assert_eq!((good.closure, good.reciprocity, good.smallest, good.largest), (0.0, 0.0, 0.25, 0.75));
        assert_eq!(of([0.5, 0.5, 0.5, 0.5]).reciprocity, 0.5);
        assert_eq!(of([0.5, 0.75, 0.375, 0.75]).row_sum_max, 1.25);
    }
}
