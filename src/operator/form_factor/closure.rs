//! Correction of the form factors of closed rooms, so that no light is lost.
//!
//! ```text
//! F'ᵢⱼ = dᵢ Fᵢⱼ dⱼ        Σⱼ F'ᵢⱼ = 1        Aᵢ F'ᵢⱼ = Aⱼ F'ⱼᵢ as before
//! ```
//!
//! In a closed room no light can leave, so every row of F must sum to 1. If a row sum is wrong by ε, the light at albedo ρ
//! is wrong by about ε/(1 − ρ): at albedo 0.99, an error of 1 % becomes an error of about 100 %. The scaling factors dᵢ are
//! found by the iteration dᵢ ← √(dᵢ/Σⱼ Fᵢⱼ dⱼ).
//!
//! Reference: Sinkhorn and Knopp, *Concerning nonnegative matrices and doubly stochastic matrices* (1967); van Leersum, *A method
//! for determining a consistent set of radiation view factors* (1989).

use super::FormFactors;
use rayon::prelude::*;

/// A row sum this far from 1 is not caused by rounding or by a fine mesh.
const WRONG: f64 = 0.1;
/// Row sums this close to 1 need no correction.
const RIGHT: f64 = 1e-6;
/// Maximum number of iterations. An error that remains is visible in the row sums.
const ROUNDS: usize = 500;

impl FormFactors {
    /// Scales the rows of the patches that are `inside` the closed room until they sum to 1. Returns true if it did. It does
    /// nothing if the sums are already right, or if they are so wrong that scaling would hide an error.
    ///
    /// ```
    /// use fredholm::operator::form_factor::FormFactors;
    /// let mut plates = FormFactors { n: 2, f: vec![0.0, 1.02, 1.02, 0.0], area: vec![1.0, 1.0], rays: 0 };
    /// assert!(plates.close(&[true; 2]));
    /// assert!((plates.row(0)[1] - 1.0).abs() < 1e-6);
    /// ```
    pub fn close(&mut self, inside: &[bool]) -> bool {
        let n = self.n;
        let mut d: Vec<f64> = inside.iter().map(|i| f64::from(u8::from(*i))).collect();
        let sums = |d: &[f64]| -> Vec<f64> {
            let row = |i: usize| self.row(i).iter().zip(d).map(|(f, d)| f64::from(*f) * d).sum::<f64>();
            (0..n).into_par_iter().map(|i| if inside[i] { row(i) } else { 1.0 }).collect()
        };
        let off = |d: &[f64], s: &[f64]| {
            let each = (0..n).filter(|&i| inside[i]).map(|i| (d[i] * s[i] - 1.0).abs());
            each.fold(0.0, f64::max)
        };
        let mut s = sums(&d);
        let first = off(&d, &s);
        if !(RIGHT..WRONG).contains(&first) {
            return false;
        }
        for _ in 0..ROUNDS {
            (0..n).filter(|&i| inside[i]).for_each(|i| d[i] = (d[i] / s[i]).sqrt());
            s = sums(&d);
            if off(&d, &s) < 0.01 * RIGHT {
                break;
            }
        }
        self.f.par_chunks_mut(n).enumerate().filter(|(i, _)| inside[*i]).for_each(|(i, row)| {
            row.iter_mut().zip(&d).filter(|(_, d)| **d > 0.0).for_each(|(f, dj)| {
                *f = (f64::from(*f) * d[i] * dj) as f32;
            });
        });
        true
    }
}
