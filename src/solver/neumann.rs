//! The Neumann series, term by term.
//!
//! ```text
//! x₀ = E,  x_{k+1} = T x_k        S_n = Σ_{k≤n} x_k        E − (I − T) S_n = x_{n+1}
//! ```

use crate::operator::matrix::LinearOperator;

/// An iterator over E, T E, T² E, …; it never ends.
///
/// ```
/// use fredholm::operator::{form_factor::FormFactors, matrix::PatchOperator};
/// use fredholm::solver::Neumann;
/// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
/// let t = PatchOperator::new(&plates, vec![0.5, 0.5]);
/// let total: f64 = Neumann::new(&t, vec![1.0, 0.0]).take(60).map(|x| x[0]).sum();
/// assert!((total - 4.0 / 3.0).abs() < 1e-15);
/// ```
#[derive(Clone, Debug)]
pub struct Neumann<'a, T: ?Sized> {
    operator: &'a T,
    next: Vec<f64>,
}

impl<'a, T: LinearOperator + ?Sized> Neumann<'a, T> {
    /// The first term is `emission`.
    pub fn new(operator: &'a T, emission: Vec<f64>) -> Self {
        Self { operator, next: emission }
    }

    /// The partial sums S₀, S₁, ….
    pub fn partial_sums(self) -> impl Iterator<Item = Vec<f64>> {
        self.scan(Vec::new(), |sum: &mut Vec<f64>, term| {
            sum.resize(term.len(), 0.0);
            sum.iter_mut().zip(&term).for_each(|(s, x)| *s += x);
            Some(sum.clone())
        })
    }
}

impl<T: LinearOperator + ?Sized> Iterator for Neumann<'_, T> {
    type Item = Vec<f64>;

    fn next(&mut self) -> Option<Vec<f64>> {
        let mut image = vec![0.0; self.next.len()];
        self.operator.apply(&self.next, &mut image);
        Some(std::mem::replace(&mut self.next, image))
    }
}
