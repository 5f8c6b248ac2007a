//! The modes of T, and the terms that they predict.
//!
//! ```text
//! ⟨u, v⟩_w = Σ A_i u_i v_i/ρ_i        ⟨u_i, u_j⟩_w = δ_ij        c_j = ⟨u_j, E⟩_w        T^k E = Σ_j λ_j^k c_j u_j
//! rest_k = T^k E − ⟨u_1, T^k E⟩_w u_1        ‖T^{k+1} E‖_w/‖T^k E‖_w → λ_1        ‖rest_{k+1}‖_w/‖rest_k‖_w → |λ_2|
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | λ_j, u_j | eigenvalues by decreasing size, modes with ‖u_j‖_w = 1 | `Modes` |
//! | c_j | the part of mode j in E | [`Spectrum::measure`] |
//! | Σ_j λ_j^k c_j u_j | the term k, predicted by the first modes | [`predicted`] |
//!
//! Reference: Parlett, *The Symmetric Eigenvalue Problem* (1980), chapters 1 and 4.

use super::Ingredients;
use fredholm::operator::matrix::{PatchOperator, Weight};
use fredholm::operator::modes::{Mode, Modes};
use fredholm::solver::Neumann;

/// Number of modes that the program uses.
pub const SHOWN: usize = 12;
/// Number of modes that predict the terms.
pub const FEW: usize = 6;
/// Number of terms.
pub const TERMS: usize = 32;

/// Makes the weight of the inner product.
pub type Weigh = fn(&PatchOperator<'_>) -> Weight;

/// The spectrum of one matrix, and its terms.
#[derive(Clone)]
pub struct Spectrum {
    /// The leading eigenvalues.
    pub values: Vec<f64>,
    /// The largest |⟨u_i, u_j⟩_w − δ_ij| of the leading modes.
    pub not_orthogonal: f64,
    /// ‖T^k E‖_w/‖E‖_w for k = 0, 1, ….
    pub size: Vec<f64>,
    /// Relative error of the prediction of T^k E by one mode, and by a few.
    pub error: Vec<[f64; 2]>,
    /// ‖T^{k+1} E‖_w/‖T^k E‖_w, and the same ratio of what is left beside the first mode.
    pub ratios: Vec<[f64; 2]>,
}

/// The smallest and the largest eigenvalue.
pub fn ends(values: &[f64]) -> [f64; 2] {
    [values.iter().copied().fold(f64::INFINITY, f64::min), values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

// ANCHOR: predicted
/// Σ_j λ_j^k c_j u_j over some modes.
fn predicted(modes: &[Mode], c: &[f64], k: usize, power: fn(f64, usize) -> f64) -> Vec<f64> {
    let mut term = vec![0.0; modes[0].vector.len()];
    for (mode, c) in modes.iter().zip(c) {
        let factor = power(mode.value, k) * c;
        term.iter_mut().zip(&mode.vector).for_each(|(x, u)| *x += factor * u);
    }
    term
}

/// x − ⟨u, x⟩_w u: what is left beside the mode u.
fn beside(w: &Weight, u: &[f64], x: &[f64]) -> Vec<f64> {
    let part = w.inner(u, x);
    x.iter().zip(u).map(|(x, u)| x - part * u).collect()
}
// ANCHOR_END: predicted

impl Spectrum {
    /// Compares the modes with the terms.
    pub(super) fn measure(t: &PatchOperator<'_>, e: &[f64], modes: &Modes, with: &Ingredients) -> Self {
        let (w, leading) = ((with.weight)(t), &modes.leading[..]);
        // ANCHOR: orthogonal
        let delta = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let off = |i: usize, j: usize| (w.inner(&leading[i].vector, &leading[j].vector) - delta(i, j)).abs();
        let pairs = (0..SHOWN).flat_map(|i| (0..SHOWN).map(move |j| (i, j)));
        let not_orthogonal = pairs.map(|(i, j)| off(i, j)).fold(0.0, f64::max);
        let c: Vec<f64> = leading.iter().map(|mode| w.inner(&mode.vector, e)).collect();
        // ANCHOR_END: orthogonal

        let terms: Vec<Vec<f64>> = Neumann::new(t, e.to_vec()).take(TERMS + 1).collect();
        let error = |k: usize, few: usize| {
            let guess = predicted(&leading[..few], &c, k, with.power);
            let off: Vec<f64> = terms[k].iter().zip(guess).map(|(x, y)| x - y).collect();
            w.norm(&off) / w.norm(&terms[k])
        };
        let rest: Vec<Vec<f64>> = terms.iter().map(|x| beside(&w, &leading[0].vector, x)).collect();
        let ratio = |x: &[Vec<f64>], k: usize| w.norm(&x[k + 1]) / w.norm(&x[k]);
        Self {
            values: leading.iter().map(|mode| mode.value).collect(),
            not_orthogonal,
            size: terms.iter().map(|x| w.norm(x) / w.norm(&terms[0])).collect(),
            error: (0..=TERMS).map(|k| [1, FEW].map(|few| error(k, few))).collect(),
            ratios: (0..TERMS).map(|k| [ratio(&terms, k), ratio(&rest, k)]).collect(),
        }
    }
}
