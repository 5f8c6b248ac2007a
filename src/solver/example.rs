//! The worked example of `CONTRIBUTING.md`: Richardson's iteration. It is compiled and tested, but the program does not
//! offer it.
//!
//! ```text
//! x ← x + ω (E − (I − T) x)        converges if |1 − ω (1 − λ)| < 1 for every eigenvalue λ of T;  ω = 1 is the Neumann series
//! ```

use super::{Iteration, residual};
use crate::operator::matrix::LinearOperator;

struct Richardson<'a, T: ?Sized> {
    operator: &'a T,
    emission: &'a [f64],
    omega: f64,
    x: Vec<f64>,
    products: f64,
}

impl<T: LinearOperator + ?Sized> Iteration for Richardson<'_, T> {
    fn advance(&mut self) -> bool {
        let r = residual(self.operator, self.emission, &self.x);
        self.products += 1.0;
        self.x.iter_mut().zip(&r).for_each(|(x, r)| *x += self.omega * r);
        r.iter().any(|r| *r != 0.0)
    }
    fn iterate(&self) -> &[f64] {
        &self.x
    }
    fn applications(&self) -> f64 {
        self.products
    }
}

/// Two plates with ρ = 1/2 that see only each other. The solution is L = 4/3, 2/3. The eigenvalues of T are ±1/2, so the
/// error falls by the factor max |1 − ω (1 ∓ 1/2)| per step: 0.6 for ω = 0.8.
#[test]
fn it_converges_as_fast_as_its_formula_says() {
    use super::Watched;
    use crate::operator::{form_factor::FormFactors, matrix::PatchOperator};
    let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
    let (t, light) = (PatchOperator::new(&plates, vec![0.5, 0.5]), [1.0, 0.0]);
    let start = || Richardson { operator: &t, emission: &light, omega: 0.8, x: light.to_vec(), products: 0.0 };
    let mut watched = Watched::new(&t, &light, start);
    let steps: Vec<f64> = watched.by_ref().take(20).map(|s| s.residual).collect();
    // after 19 steps, a factor 0.6^19 remains of an error below 1
    assert!((watched.iteration().iterate()[0] - 4.0 / 3.0).abs() < 0.6f64.powi(19));
    // the start contains both modes; the faster one, with the factor 1 − 0.8 · 3/2, has vanished after a while
    let rate = steps[19] / steps[18];
    assert!((rate - 0.6).abs() < 1e-6, "{rate}");
}
