//! The inner product in which T is self-adjoint.
//!
//! ```text
//! ⟨u, v⟩_w = Σ wᵢ uᵢ vᵢ        w = A/ρ        ⟨u, T v⟩_w = ⟨T u, v⟩_w    because  AᵢFᵢⱼ = AⱼFⱼᵢ
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | w | A/ρ; 0 where ρ = 0, because T u vanishes there | [`Weight::new`] |
//!
//! Sums and powers of T are self-adjoint in the same weight.

/// The weight w: one number per patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Weight(Vec<f64>);

impl Weight {
    /// The weight wᵢ = Aᵢ/ρᵢ, and 0 where ρᵢ = 0.
    ///
    /// ```
    /// use fredholm::operator::matrix::Weight;
    /// let w = Weight::new(&[1.0, 2.0, 1.0], &[0.5, 0.5, 0.0]);
    /// assert_eq!(w.inner(&[1.0, 1.0, 7.0], &[3.0, 1.0, 7.0]), 2.0 * 3.0 + 4.0);
    /// ```
    pub fn new(area: &[f64], rho: &[f64]) -> Self {
        Self(area.iter().zip(rho).map(|(a, r)| if *r > 0.0 { a / r } else { 0.0 }).collect())
    }

    /// The weights wᵢ, one per patch.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// The inner product ⟨u, v⟩_w.
    pub fn inner(&self, u: &[f64], v: &[f64]) -> f64 {
        self.0.iter().zip(u).zip(v).map(|((w, u), v)| w * u * v).sum()
    }

    /// The norm ‖u‖_w = √⟨u, u⟩_w.
    pub fn norm(&self, u: &[f64]) -> f64 {
        self.inner(u, u).sqrt()
    }
}
