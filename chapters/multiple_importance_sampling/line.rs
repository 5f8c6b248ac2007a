//! An integral over a line, two strategies, and weights of the form pᵢ^β/Σ pⱼ^β.
//!
//! ```text
//! μ = ∫₀¹ f du        X = Σᵢ wᵢ f/pᵢ (one sample of each)        Y = 2 wᵢ f/pᵢ (one sample, i = 0 or 1 with probability ½)
//! Var X = Σᵢ (∫ (wᵢ f)²/pᵢ − (∫ wᵢ f)²)        Var Y = 2 Σᵢ ∫ (wᵢ f)²/pᵢ − μ²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | f, pᵢ | constant on each half of the line | [`F`], [`P`] |
//! | β | 0: wᵢ = ½; 1: balance; 2: power; ∞: the larger density has the weight 1 | [`BETA`] |
//! | X, Y | multi-sample and one-sample estimator | [`variances`] |

use fredholm::math::{Key, Purpose, Rng};
use fredholm::report::book::{Folder, Number};
use fredholm::stats::Moments;
use rayon::prelude::*;

/// f on the left and on the right half.
pub const F: [f64; 2] = [3.0, 1.0];
/// Densities of both strategies on the left and on the right half.
pub const P: [[f64; 2]; 2] = [[1.0, 1.0], [1.8, 0.2]];
/// Exponents.
pub const BETA: [f64; 4] = [0.0, 1.0, 2.0, f64::INFINITY];
/// μ = ∫ f du.
pub const MEAN: f64 = 0.5 * (F[0] + F[1]);

/// Variances of X (row 0) and Y (row 1) for each exponent, and their closed forms.
#[derive(Clone, Debug)]
pub struct Variances {
    /// Measured.
    pub measured: [[Number; 4]; 2],
    /// Closed form.
    pub exact: [[f64; 4]; 2],
}

/// wᵢ on one half, for an exponent.
pub type LineWeight = fn(f64, usize, usize) -> f64;

// ANCHOR: line
/// wᵢ = pᵢ^β/(p₀^β + p₁^β) on the left (half = 0) or right half.
pub fn weight(beta: f64, i: usize, half: usize) -> f64 {
    1.0 / (1.0 + (P[1 - i][half] / P[i][half]).powf(beta))
}

/// Var X and Var Y in closed form.
pub fn exact(beta: f64, weight: LineWeight) -> [f64; 2] {
    let g = |i: usize, half: usize| weight(beta, i, half) * F[half];
    let square = |i: usize| (0..2).map(|half| 0.5 * g(i, half).powi(2) / P[i][half]).sum::<f64>();
    let mean = |i: usize| (0..2).map(|half| 0.5 * g(i, half)).sum::<f64>();
    let squares = square(0) + square(1);
    [squares - mean(0).powi(2) - mean(1).powi(2), 2.0 * squares - MEAN.powi(2)]
}
// ANCHOR_END: line

/// A sample of strategy i: which half its point lies in.
fn half(i: usize, u: f32) -> usize {
    usize::from(f64::from(u) >= 0.5 * P[i][0])
}

/// Measures the variances: the mean of (X − μ)² and of (Y − μ)².
pub fn variances(folder: &Folder<'_>, weight: LineWeight) -> Variances {
    let key = Key::new(folder.seed, "line");
    let each = folder.pick(1 << 14, 1 << 11);
    let batch = |b: u32| {
        let mut sums = [0.0; 8];
        for n in 0..each {
            let u = Rng::at(key, b, n, 0, Purpose::Start).four();
            for (k, beta) in BETA.into_iter().enumerate() {
                let part = |i: usize, half: usize| weight(beta, i, half) * F[half] / P[i][half];
                let x = part(0, half(0, u[0])) + part(1, half(1, u[1]));
                let i = usize::from(u[2] >= 0.5);
                let y = 2.0 * part(i, half(i, u[3]));
                sums[k] += (x - MEAN).powi(2);
                sums[4 + k] += (y - MEAN).powi(2);
            }
        }
        sums.map(|s| s / f64::from(each))
    };
    let mut m = Moments::new(8);
    (0..64u32).into_par_iter().map(batch).collect::<Vec<_>>().iter().for_each(|b| m.push(b));
    let number = |c: usize| Number { value: m.mean()[c], std_error: m.std_error(c) };
    let exact = BETA.map(|beta| exact(beta, self::weight));
    Variances {
        measured: [0, 1].map(|row| [0, 1, 2, 3].map(|k| number(4 * row + k))),
        exact: [0, 1].map(|row| exact.map(|v| v[row])),
    }
}
