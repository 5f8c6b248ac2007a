//! Extrapolation of the series: estimates the limit of S_n from the first few terms, and the effect on their noise.
//!
//! ```text
//! Aitken      A = S_{n−1} + t_n / (1 − g),  g = t_{n+1}/t_n      exact for one eigenvalue:       t_k = c λ^k
//! Wynn        ε_{2m} from 2m + 1 partial sums                     exact for m eigenvalues;        ε₂ = Aitken
//! known rate  B = S_n + t_n r/(1 − r)                             exact for the dominant mode of rate r alone
//!
//! Var(A) = ∇Aᵀ C ∇A        C: covariance of the terms        gain = √(Var(A)/Var(S_n)): amplification of the noise
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | t_k | a term: ⟨W, T^k E⟩, or one entry of T^k E | argument `terms` |
//! | S_n | partial sum Σ_{k≤n} t_k | |
//! | A | the extrapolated value | [`Accelerated::value`] |
//! | ∇A | the derivatives ∂A/∂t_k | [`Accelerated::gradient`] |
//! | r | a decay rate of the terms that is assumed to be known | [`known_rate`] |
//!
//! In Aitken's A, each term before the last two counts once. The last two have the derivatives ∂A/∂t_n = (1 − 2g)/(1 − g)²
//! and ∂A/∂t_{n+1} = 1/(1 − g)². The latter is 25 at g = 0.8, whereas the last term with a tail of known rate has 1 + r/(1 −
//! r) = 5. This holds to first order: a quotient of noisy terms is also biased. It means little if the noise of t_n is not
//! small compared with t_n − t_{n+1}. None of the methods is exact for a continuous spectrum, and none gives a bound.
//!
//! If every other term vanishes (two plates, one of them emits), t_n = t_{n+1} or t_n = 0, and Aitken has nothing to
//! extrapolate. [`two_step`] applies Aitken to S₀, S₂, S₄, … instead.
//!
//! Reference: Aitken (1926); Wynn, *On a device for computing the e_m(S_n) transformation* (1956); Brezinski and Redivo
//! Zaglia, *Extrapolation Methods* (1991).

use nalgebra::{DMatrix, DVector};

/// An extrapolated limit, with its derivative with respect to every term.
#[derive(Clone, Debug, PartialEq)]
pub struct Accelerated {
    /// The extrapolated Σ t_k.
    pub value: f64,
    /// The derivatives ∂A/∂t_k, one per term given.
    pub gradient: Vec<f64>,
}

impl Accelerated {
    /// Standard error of the limit, to first order, from the covariance C of the terms.
    ///
    /// # Panics
    /// If the size of C is not the length of the gradient.
    pub fn std_error(&self, covariance: &DMatrix<f64>) -> f64 {
        let g = DVector::from_column_slice(&self.gradient);
        (covariance * &g).dot(&g).sqrt()
    }

    /// √(Var(A)/Var(S_n)): the standard error of the limit divided by that of the plain sum of the same terms.
    ///
    /// # Panics
    /// If the size of C is not the length of the gradient.
    pub fn amplification(&self, covariance: &DMatrix<f64>) -> f64 {
        self.std_error(covariance) / covariance.sum().sqrt()
    }
}

/// The names of the values that [`all`] returns, in the same order.
pub const METHODS: [&str; 5] = ["S_n", "Aitken", "two-step", "known rate", "Wynn"];

/// The plain sum and every extrapolation of it; r is the decay rate that is assumed to be known.
pub fn all(terms: &[f64], r: f64) -> [Option<Accelerated>; 5] {
    [Some(plain(terms)), aitken(terms), two_step(terms), known_rate(terms, r), wynn(terms)]
}

/// The plain sum Σ t_k, for comparison.
pub fn plain(terms: &[f64]) -> Accelerated {
    Accelerated { value: terms.iter().sum(), gradient: vec![1.0; terms.len()] }
}

/// Aitken's Δ² method on the last three partial sums: it continues the last two terms as a geometric series. `None` if these
/// are equal, or if there are fewer than two terms.
///
/// ```
/// use fredholm::solver::accelerate::aitken;
/// assert_eq!(aitken(&[1.0, 0.5, 0.25]).map(|a| a.value), Some(2.0));
/// assert_eq!(aitken(&[1.0, 1.0]), None);
/// ```
pub fn aitken(terms: &[f64]) -> Option<Accelerated> {
    let [before @ .., t0, t1] = terms else { return None };
    let d = t0 - t1;
    if d == 0.0 {
        return None;
    }
    let mut gradient = vec![1.0; before.len()];
    gradient.extend([(t0 * t0 - 2.0 * t0 * t1) / (d * d), (t0 / d).powi(2)]);
    Some(Accelerated { value: before.iter().sum::<f64>() + t0 * t0 / d, gradient })
}

/// Aitken's Δ² method on every second partial sum, S_{n−4}, S_{n−2}, S_n. Use it for series whose odd and even terms decay
/// separately. `None` with fewer than five terms, or if nothing can be extrapolated.
///
/// ```
/// use fredholm::solver::accelerate::{aitken, two_step};
/// let plate = [1.0, 0.0, 0.36, 0.0, 0.1296]; // two plates, ρ = 0.9 and 0.4, seen on the lit one
/// assert!(two_step(&plate).is_some_and(|a| (a.value - 1.5625).abs() < 1e-15));
/// ```
pub fn two_step(terms: &[f64]) -> Option<Accelerated> {
    let [before @ .., a, b, c, d] = terms else { return None };
    if before.is_empty() {
        return None;
    }
    let pairs = aitken(&[a + b, c + d])?;
    let mut gradient = vec![1.0; before.len()];
    gradient.extend(pairs.gradient.iter().flat_map(|g| [*g; 2]));
    Some(Accelerated { value: before.iter().sum::<f64>() + pairs.value, gradient })
}

/// S_n plus the tail t_n r/(1 − r) of a mode that decays with the known rate r.
///
/// ```
/// let a = fredholm::solver::accelerate::known_rate(&[1.0, 0.5], 0.5);
/// assert!(a.is_some_and(|a| a.value == 2.0 && a.gradient == [1.0, 2.0]));
/// ```
pub fn known_rate(terms: &[f64], r: f64) -> Option<Accelerated> {
    let last = *terms.last()?;
    let mut out = plain(terms);
    out.value += last * r / (1.0 - r);
    *out.gradient.last_mut()? += r / (1.0 - r);
    Some(out)
}

/// Wynn's ε algorithm: the last even column of the table. It is exact for half as many eigenvalues as there are terms after
/// the first. With an even number of terms the first partial sum is left out. `None` without a term, or if the table divides
/// by zero.
///
/// ```
/// use fredholm::solver::accelerate::wynn;
/// let terms: Vec<f64> = (0..5).map(|k| 0.7f64.powi(k) + (-0.3f64).powi(k)).collect();
/// let exact = 1.0 / 0.3 + 1.0 / 1.3;
/// assert!(wynn(&terms).is_some_and(|a| (a.value - exact).abs() < 1e-13));
/// ```
pub fn wynn(terms: &[f64]) -> Option<Accelerated> {
    let n = terms.len();
    let first = 1 - n % 2;
    // ε₀: the partial sums; ∂S_j/∂t_k = 1 for k ≤ j
    let sums = (first..n).map(|j| Accelerated {
        value: terms[..=j].iter().sum(),
        gradient: (0..n).map(|k| f64::from(u8::from(k <= j))).collect(),
    });
    let mut column: Vec<Accelerated> = sums.collect();
    let mut before = vec![Accelerated { value: 0.0, gradient: vec![0.0; n] }; column.len() + 1];
    while column.len() > 1 {
        let next: Option<Vec<_>> = column.windows(2).zip(&before[1..]).map(|(pair, old)| step(pair, old)).collect();
        before = std::mem::replace(&mut column, next?);
    }
    column.pop()
}

/// One entry of the table, ε_{k+1}^{(j)} = ε_{k−1}^{(j+1)} + 1/(ε_k^{(j+1)} − ε_k^{(j)}), and its derivatives.
fn step(pair: &[Accelerated], old: &Accelerated) -> Option<Accelerated> {
    let d = pair[1].value - pair[0].value;
    if d == 0.0 {
        return None;
    }
    let slopes = pair[1].gradient.iter().zip(&pair[0].gradient).zip(&old.gradient);
    Some(Accelerated {
        value: old.value + 1.0 / d,
        gradient: slopes.map(|((b, a), o)| o - (b - a) / (d * d)).collect(),
    })
}
