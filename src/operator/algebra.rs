//! Operators as values that can be added, multiplied and inverted. Nothing is computed before the result is applied to a
//! vector.
//!
//! ```text
//! (S + T) x = S x + T x      (S T) x = S (T x)      T^k x = T (T^{k−1} x)      (I − T)⁻¹ x = Σ_{k≥0} T^k x
//! (S + T)* = S* + T*         (S T)* = T* S*         (T^k)* = (T*)^k            ((I − T)⁻¹)* = (I − T*)⁻¹
//! ```
//!
//! `T*` is the adjoint in ⟨u, v⟩ = Σᵢ Aᵢ uᵢ vᵢ, so that ⟨W, T x⟩ = ⟨T* W, x⟩: light tracing and path tracing compute the
//! same number. `T = diag(ρ) F` has ρ on the left, and F is self-adjoint here, so that `T* = F diag(ρ)`.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | I, diag(ρ) | identity, multiplication by one number per patch | [`Expression::identity`], [`Expression::diagonal`] |
//! | S + T, c T, S T, T^k | combinations | [`Expression::plus`], [`Expression::scaled`], [`Expression::times`], [`Expression::power`] |
//! | (I − T)⁻¹ | the sum over all numbers of bounces | [`Expression::resolvent`] |
//! | T* | adjoint: transport seen from the lights | [`Expression::adjoint`] |
//! | ½ (T + w⁻¹A T* A⁻¹w) | the part of T that is self-adjoint in the weight w | [`Expression::symmetric_part`] |
//!
//! Operators can be combined if they act on the same space: the same number of patches with the same areas. Otherwise the
//! result is an error that states the difference.
//!
//! Reference: Arvo, *Analytic Methods for Simulated Light Transport* (1995), chapter 6.

use super::matrix::{LinearOperator, Weight};
use std::borrow::Cow;

/// The reason why two operators cannot be combined or applied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AlgebraError {
    /// The two operands have different numbers of patches.
    #[error("one side has {left} patches, the other {right}: they act on different meshes")]
    Sizes {
        /// Number of patches of the left operand.
        left: usize,
        /// Number of patches of the right operand.
        right: usize,
    },
    /// The two operands have equally many patches with different areas. The adjoint of one is then not the adjoint of the
    /// other.
    #[error("patch {patch} has area {left} on one side and {right} on the other: they act on different meshes")]
    Areas {
        /// The first patch whose areas differ.
        patch: usize,
        /// Its area in the left operand, m².
        left: f64,
        /// Its area in the right operand, m².
        right: f64,
    },
    /// The Neumann series Σ T^k 1 does not converge.
    #[error("Σ T^k 1 has not converged after {steps} terms, so the Neumann series cannot compute (I − T)⁻¹")]
    Diverges {
        /// Number of terms computed.
        steps: usize,
    },
}

/// After this number of terms the Neumann series counts as divergent.
const MOST_TERMS: usize = 100_000;
/// A term below this share of the sum is below rounding. The margin allows for the tail of a slowly converging series.
const NEGLIGIBLE: f64 = 1.0 / (1u64 << 60) as f64;

/// An operator built from other operators. It borrows them and computes nothing before it is applied.
///
/// ```
/// use fredholm::operator::{algebra::Expression, form_factor::FormFactors, matrix::PatchOperator};
/// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
/// let t = PatchOperator::new(&plates, vec![0.9, 0.4]);
/// let t = Expression::from(&t);
/// let light = t.resolvent()?.of(&[1.0, 0.0])?;           // L = (I − T)⁻¹ E
/// let two_step = t.power(2).of(&light)?;                 // T² L
/// assert!((light[0] - 1.5625).abs() < 1e-14 && (two_step[0] - 0.5625).abs() < 1e-14);
/// # Ok::<(), fredholm::operator::algebra::AlgebraError>(())
/// ```
#[derive(Clone)]
pub struct Expression<'a> {
    area: Cow<'a, [f64]>,
    node: Node<'a>,
}

#[derive(Clone)]
enum Node<'a> {
    Leaf(&'a dyn LinearOperator),
    Identity,
    Diagonal(Vec<f64>),
    Sum(Box<Node<'a>>, Box<Node<'a>>),
    Scaled(f64, Box<Node<'a>>),
    Product(Box<Node<'a>>, Box<Node<'a>>),
    Power(Box<Node<'a>>, usize),
    Resolvent(Box<Node<'a>>),
    Adjoint(Box<Node<'a>>),
}

impl<'a, T: LinearOperator> From<&'a T> for Expression<'a> {
    fn from(operator: &'a T) -> Self {
        Self { area: Cow::Borrowed(operator.area()), node: Node::Leaf(operator) }
    }
}

impl<'a> Expression<'a> {
    /// The identity I on patches with these areas.
    pub fn identity(area: &'a [f64]) -> Self {
        Self { area: Cow::Borrowed(area), node: Node::Identity }
    }

    /// Multiplication by one number per patch; this operator is self-adjoint.
    ///
    /// # Errors
    /// [`AlgebraError::Sizes`] if the numbers of values and areas differ.
    pub fn diagonal(area: &'a [f64], values: Vec<f64>) -> Result<Self, AlgebraError> {
        match (values.len(), area.len()) {
            (left, right) if left != right => Err(AlgebraError::Sizes { left, right }),
            _ => Ok(Self { area: Cow::Borrowed(area), node: Node::Diagonal(values) }),
        }
    }

    /// The sum S + T, where S is `self` and T is `other`.
    ///
    /// # Errors
    /// [`AlgebraError`] if they act on different spaces.
    pub fn plus(&self, other: &Self) -> Result<Self, AlgebraError> {
        self.join(other, Node::Sum)
    }

    /// The difference S − T, where S is `self` and T is `other`.
    ///
    /// # Errors
    /// [`AlgebraError`] if they act on different spaces.
    pub fn minus(&self, other: &Self) -> Result<Self, AlgebraError> {
        self.plus(&other.scaled(-1.0))
    }

    /// S T: applies first `other`, then `self`.
    ///
    /// # Errors
    /// [`AlgebraError`] if they act on different spaces.
    pub fn times(&self, other: &Self) -> Result<Self, AlgebraError> {
        self.join(other, Node::Product)
    }

    /// The multiple c T.
    pub fn scaled(&self, c: f64) -> Self {
        self.with(Node::Scaled(c, self.boxed()))
    }

    /// The power T^k; T⁰ = I.
    pub fn power(&self, k: usize) -> Self {
        self.with(Node::Power(self.boxed(), k))
    }

    /// T*, the adjoint in the area inner product.
    pub fn adjoint(&self) -> Self {
        self.with(Node::Adjoint(self.boxed()))
    }

    /// ½ (T + T^w), where T^w is the adjoint of T in ⟨u, v⟩_w = Σ wᵢ uᵢ vᵢ. It equals T if T is self-adjoint in w. The real
    /// parts of all eigenvalues of T lie between its smallest and its largest eigenvalue, because these are the ends of the
    /// numerical range of T.
    ///
    /// # Panics
    /// If the number of weights is not the number of patches.
    pub fn symmetric_part(&self, weight: &Weight) -> Self {
        let w = weight.values();
        assert_eq!(w.len(), self.area.len(), "one weight per patch");
        let diagonal = |d: Vec<f64>| Box::new(Node::Diagonal(d));
        let into = w.iter().zip(&*self.area).map(|(w, a)| w / a).collect();
        let back = w.iter().zip(&*self.area).map(|(w, a)| if *w > 0.0 { a / w } else { 0.0 }).collect();
        let adjoint = Node::Product(Box::new(Node::Adjoint(self.boxed())), diagonal(into));
        let adjoint = Node::Product(diagonal(back), Box::new(adjoint));
        self.with(Node::Scaled(0.5, Box::new(Node::Sum(self.boxed(), Box::new(adjoint)))))
    }

    /// (I − T)⁻¹ as the Neumann series, summed until its terms are below rounding.
    ///
    /// Convergence is tested on x = 1 first. For T ≥ 0 this proves convergence for every x, because |T^k x| ≤ max|x| T^k 1.
    /// For other T, a series that does not converge gives NaN, never a wrong number.
    ///
    /// # Errors
    /// [`AlgebraError::Diverges`] if Σ T^k 1 does not converge.
    pub fn resolvent(&self) -> Result<Self, AlgebraError> {
        let out = self.with(Node::Resolvent(self.boxed()));
        let probe = out.of(&vec![1.0; self.area.len()])?;
        if probe.iter().all(|x| x.is_finite()) { Ok(out) } else { Err(AlgebraError::Diverges { steps: MOST_TERMS }) }
    }

    /// Computes T x as a new vector.
    ///
    /// # Errors
    /// [`AlgebraError::Sizes`] if x does not have one value per patch.
    pub fn of(&self, x: &[f64]) -> Result<Vec<f64>, AlgebraError> {
        if x.len() != self.area.len() {
            return Err(AlgebraError::Sizes { left: self.area.len(), right: x.len() });
        }
        Ok(self.node.image(x, false))
    }

    fn boxed(&self) -> Box<Node<'a>> {
        Box::new(self.node.clone())
    }

    fn with(&self, node: Node<'a>) -> Self {
        Self { area: self.area.clone(), node }
    }

    fn join(
        &self,
        other: &Self,
        combine: impl Fn(Box<Node<'a>>, Box<Node<'a>>) -> Node<'a>,
    ) -> Result<Self, AlgebraError> {
        same_space(&self.area, &other.area)?;
        Ok(self.with(combine(self.boxed(), other.boxed())))
    }
}

/// Checks that two lists of areas describe the same space.
fn same_space(left: &[f64], right: &[f64]) -> Result<(), AlgebraError> {
    if left.len() != right.len() {
        return Err(AlgebraError::Sizes { left: left.len(), right: right.len() });
    }
    match left.iter().zip(right).position(|(a, b)| a != b) {
        Some(patch) => Err(AlgebraError::Areas { patch, left: left[patch], right: right[patch] }),
        None => Ok(()),
    }
}

impl Node<'_> {
    /// T x, or T* x if `adjoint` is true.
    fn image(&self, x: &[f64], adjoint: bool) -> Vec<f64> {
        match self {
            Node::Leaf(t) => {
                let mut y = vec![0.0; x.len()];
                if adjoint {
                    t.apply_adjoint(x, &mut y)
                } else {
                    t.apply(x, &mut y)
                }
                y
            }
            Node::Identity => x.to_vec(),
            Node::Diagonal(d) => x.iter().zip(d).map(|(x, d)| d * x).collect(),
            Node::Sum(s, t) => {
                let mut y = s.image(x, adjoint);
                y.iter_mut().zip(t.image(x, adjoint)).for_each(|(y, t)| *y += t);
                y
            }
            Node::Scaled(c, t) => t.image(x, adjoint).into_iter().map(|y| c * y).collect(),
            Node::Product(s, t) => {
                let (first, second) = if adjoint { (s, t) } else { (t, s) };
                second.image(&first.image(x, adjoint), adjoint)
            }
            Node::Power(t, k) => (0..*k).fold(x.to_vec(), |x, _| t.image(&x, adjoint)),
            Node::Resolvent(t) => neumann(|x| t.image(x, adjoint), x),
            Node::Adjoint(t) => t.image(x, !adjoint),
        }
    }
}

/// Σ T^k x; NaN in every entry if the series does not converge.
fn neumann(apply: impl Fn(&[f64]) -> Vec<f64>, x: &[f64]) -> Vec<f64> {
    let largest = |v: &[f64]| v.iter().fold(0.0, |a: f64, v| if v.abs() > a || v.is_nan() { v.abs() } else { a });
    let (mut term, mut sum) = (x.to_vec(), x.to_vec());
    for _ in 0..MOST_TERMS {
        term = apply(&term);
        sum.iter_mut().zip(&term).for_each(|(s, t)| *s += t);
        let (t, s) = (largest(&term), largest(&sum));
        if t <= NEGLIGIBLE * s {
            return sum;
        }
        if !s.is_finite() {
            break;
        }
    }
    vec![f64::NAN; x.len()]
}

impl LinearOperator for Expression<'_> {
    fn area(&self) -> &[f64] {
        &self.area
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(&self.node.image(x, false));
    }

    fn apply_adjoint(&self, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(&self.node.image(x, true));
    }
}
