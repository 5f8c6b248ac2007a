//! The spectrum of T: all eigenvalues, the leading modes (eigenvectors), and bounds on the spectral radius.
//!
//! ```text
//! S = √(ρᵢAᵢ) Fᵢⱼ √(ρⱼ/Aⱼ)      symmetric, on the patches with ρ > 0:      S s = λ s      uᵢ = sᵢ √(ρᵢ/Aᵢ)      T u = λ u
//! T^k E = Σ_j λ_j^{k−1} ⟨u_j, T E⟩_w u_j                       k ≥ 1,  ⟨u, v⟩_w = Σ Aᵢ uᵢ vᵢ/ρᵢ,  ‖u_j‖_w = 1
//! ⟨v, T v⟩_w/⟨v, v⟩_w ≤ r(T) ≤ maxᵢ (T v)ᵢ/vᵢ                  for any v > 0: Rayleigh, Collatz–Wielandt
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | λ_j, u_j | eigenvalues by decreasing magnitude; modes with ‖u_j‖_w = 1 | [`Modes`] |
//! | ‖T u − λ u‖_w | residual of a mode: some eigenvalue lies within this distance of λ | [`Mode::residual`] |
//! | r(T) | spectral radius: the rate at which T^k E decays for large k | [`radius_bounds`] |
//! | ‖T‖₂ | largest factor by which one bounce can multiply the area norm | [`norm_2`] |
//!
//! Only eigenvalues outside the [essential band](super::edges) are properties of the scene; those inside depend on the mesh.
//!
//! Reference: Parlett, *The Symmetric Eigenvalue Problem* (1980), chapter 4; Varga, *Matrix Iterative Analysis* (1962), 2.2.

use super::algebra::Expression;
use super::matrix::{LinearOperator, PatchOperator, Rows};

/// One eigenvalue with its mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The eigenvalue λ.
    pub value: f64,
    /// The mode u, one value per patch, with ‖u‖_w = 1; the value of largest magnitude is positive.
    pub vector: Vec<f64>,
    /// The residual ‖T u − λ u‖_w.
    pub residual: f64,
}

/// The spectrum of one colour channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// All eigenvalues on the patches with ρ > 0, by decreasing magnitude.
    pub values: Vec<f64>,
    /// The first of these eigenvalues, with their modes.
    pub leading: Vec<Mode>,
}

impl Modes {
    /// All eigenvalues of T and the first `count` modes, by a dense symmetric solver.
    ///
    /// ```
    /// use fredholm::operator::{form_factor::FormFactors, matrix::PatchOperator, modes::Modes};
    /// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
    /// let modes = Modes::of(&PatchOperator::new(&plates, vec![0.9, 0.4]), 1);
    /// assert!((modes.values[0].abs() - 0.6).abs() < 1e-14 && (modes.values[0] + modes.values[1]).abs() < 1e-14);
    /// ```
    pub fn of(t: &PatchOperator<'_>, count: usize) -> Self {
        let on: Vec<usize> = (0..t.len()).filter(|&i| t.rho[i] > 0.0).collect();
        let weight = |i: usize| (t.area()[i] / t.rho[i]).sqrt();
        let s = |a: usize, b: usize| t.entry(on[a], on[b]) * weight(on[a]) / weight(on[b]);
        // each entry is rounded to single precision separately; the mean of the two is symmetric
        let (values, vectors) = symmetric_eigen(on.len(), |a, b| 0.5 * (s(a, b) + s(b, a)));
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[b].abs().total_cmp(&values[a].abs()).then(values[b].total_cmp(&values[a])));
        let mode = |&j: &usize| {
            let mut vector = vec![0.0; t.len()];
            on.iter().enumerate().for_each(|(a, &i)| vector[i] = vectors(a, j) / weight(i));
            let largest = vector.iter().fold(0.0, |m: f64, v| if v.abs() > m.abs() { *v } else { m });
            vector.iter_mut().for_each(|v| *v *= largest.signum());
            let mut image = vec![0.0; t.len()];
            t.apply(&vector, &mut image);
            image.iter_mut().zip(&vector).for_each(|(y, u)| *y -= values[j] * u);
            Mode { value: values[j], residual: t.weighted_norm(&image), vector }
        };
        Self {
            values: order.iter().map(|&j| values[j]).collect(),
            leading: order.iter().take(count).map(mode).collect(),
        }
    }
}

/// The eigenvalues, and a function (a, j) ↦ entry a of eigenvector j.
type Eigen = (Vec<f64>, Box<dyn Fn(usize, usize) -> f64>);

/// Eigenvalues and eigenvectors of a symmetric matrix.
#[cfg(feature = "faer")]
fn symmetric_eigen(n: usize, entry: impl Fn(usize, usize) -> f64) -> Eigen {
    use faer::{Mat, Side};
    let matrix = Mat::from_fn(n, n, &entry);
    match matrix.self_adjoint_eigen(Side::Lower) {
        Ok(eigen) => {
            let values = (0..n).map(|j| eigen.S()[j]).collect();
            (values, Box::new(move |a, j| eigen.U()[(a, j)]))
        }
        Err(_) => by_nalgebra(n, entry),
    }
}

#[cfg(not(feature = "faer"))]
fn symmetric_eigen(n: usize, entry: impl Fn(usize, usize) -> f64) -> Eigen {
    by_nalgebra(n, entry)
}

fn by_nalgebra(n: usize, entry: impl Fn(usize, usize) -> f64) -> Eigen {
    let eigen = nalgebra::SymmetricEigen::new(nalgebra::DMatrix::from_fn(n, n, entry));
    (eigen.eigenvalues.iter().copied().collect(), Box::new(move |a, j| eigen.eigenvectors[(a, j)]))
}

/// Lower and upper bound of the spectral radius r(T), from v = T^(steps + 1) 1: the Rayleigh quotient of v, and maxᵢ (T
/// v)ᵢ/vᵢ.
///
/// The upper bound holds for the stored matrix, whatever T is. The lower bound holds as far as the stored A F is symmetric:
/// to about 1e-7, because entries are in single precision.
///
/// ```
/// use fredholm::operator::{form_factor::FormFactors, matrix::PatchOperator, modes::radius_bounds};
/// let f = FormFactors { n: 2, f: vec![0.5, 0.5, 0.5, 0.5], area: vec![1.0, 1.0], rays: 0 };
/// let [low, high] = radius_bounds(&PatchOperator::new(&f, vec![0.9, 0.3]), 8);
/// assert!((low - 0.6).abs() < 1e-7 && (high - 0.6).abs() < 1e-14); // (ρ₁ + ρ₂)/2
/// ```
pub fn radius_bounds(t: &PatchOperator<'_>, steps: usize) -> [f64; 2] {
    let (mut v, mut y) = (vec![1.0; t.len()], vec![0.0; t.len()]);
    for _ in 0..=steps {
        t.apply(&v, &mut y);
        std::mem::swap(&mut v, &mut y);
        let largest = v.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return [0.0; 2]; // no light returns: all eigenvalues are 0
        }
        v.iter_mut().for_each(|v| *v /= largest);
    }
    t.apply(&v, &mut y);
    let gain = y.iter().zip(&v).filter(|(_, v)| **v > 0.0).map(|(y, v)| y / v).fold(0.0, f64::max);
    [t.weighted_inner(&v, &y) / t.weighted_inner(&v, &v), gain]
}

/// ‖T‖₂ = √r(T*T) in the area inner product, by power iteration. The result is a lower bound that increases towards ‖T‖₂.
/// The iteration ends when the relative change per step is at most `tolerance`, or after `max_steps` steps.
pub fn norm_2(t: &impl LinearOperator, tolerance: f64, max_steps: usize) -> f64 {
    let t = Expression::from(t);
    let back = t.adjoint();
    let (mut v, mut gain) = (vec![1.0; t.len()], 0.0);
    for _ in 0..max_steps {
        let length = t.norm(&v);
        v.iter_mut().for_each(|v| *v /= length);
        let (mut image, mut y) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        t.apply(&v, &mut image);
        back.apply(&image, &mut y);
        let next = t.norm(&image);
        let settled = (next - gain).abs() <= tolerance * next;
        gain = next;
        if settled {
            break;
        }
        v = y;
    }
    gain
}
