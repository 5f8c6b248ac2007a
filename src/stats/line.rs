//! A straight line through points with a known covariance.
//!
//! ```text
//! y = a + b x + e,  Cov(e) = V:      (a, b) = (Xᵀ V⁻¹ X)⁻¹ Xᵀ V⁻¹ y,      χ² = rᵀ V⁻¹ r,  r = y − a − b x
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X | matrix with rows (1, x_i) | [`fit`] |
//! | V = G Gᵀ | covariance of the y; G is its Cholesky factor | [`fit`] |
//! | χ² | misfit; `n − 2` degrees of freedom if V is right | [`Line::chi_squared`] |
//!
//! Aitken, *Proc. Royal Society of Edinburgh* 55 (1935): if V is known, no linear unbiased estimate has a smaller variance.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// The fitted line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// a, the intercept.
    pub(super) intercept: f64,
    /// b, the slope.
    pub(super) slope: f64,
    /// Standard error of b, if V is exact.
    pub(super) std_error: f64,
    /// χ², the misfit.
    pub(super) chi_squared: f64,
}

/// Fits the line. None if there are fewer than two points, if all x are equal, or if V is not positive definite.
pub(super) fn fit(x: &[f64], y: &[f64], covariance: DMatrix<f64>) -> Option<Line> {
    if x.len() < 2 {
        return None;
    }
    let design = DMatrix::from_fn(x.len(), 2, |i, j| if j == 0 { 1.0 } else { x[i] });
    // multiplying by G⁻¹ makes the errors independent with unit variance, which leaves an ordinary least-squares fit
    let factor = covariance.cholesky()?;
    let design = factor.l().solve_lower_triangular(&design)?;
    let y = factor.l().solve_lower_triangular(&DVector::from_column_slice(y))?;
    let (u, v) = (design.column(0), design.column(1));
    let normal = Matrix2::new(u.dot(&u), u.dot(&v), u.dot(&v), v.dot(&v));
    let inverse = normal.try_inverse()?;
    let b = inverse * Vector2::new(u.dot(&y), v.dot(&y));
    let residual = &y - u * b[0] - v * b[1];
    Some(Line { intercept: b[0], slope: b[1], std_error: inverse[(1, 1)].sqrt(), chi_squared: residual.norm_squared() })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn independent_equal_errors_give_the_schoolbook_formula() {
        let (x, y) = ([0.0, 1.0, 2.0, 3.0], [1.0, 2.9, 5.2, 6.9]);
        let line = fit(&x, &y, DMatrix::from_diagonal_element(4, 4, 0.25)).unwrap();
        // b = Σ(x−x̄)y / Σ(x−x̄)² = 10/5, s_b² = 0.25/5
        assert!((line.slope - 2.0).abs() < 1e-13 && (line.intercept - 1.0).abs() < 1e-13);
        assert!((line.std_error - 0.05f64.sqrt()).abs() < 1e-13);
        assert!((line.chi_squared - (0.01 + 0.04 + 0.01) / 0.25).abs() < 1e-12);
    }

    /// The textbook expression with an explicit inverse of V.
    #[test]
    fn whitening_equals_the_normal_equations() {
        let (x, y) = ([1.0, 2.0, 4.0, 8.0, 9.0], [0.3, 0.1, -0.4, -2.0, -2.2]);
        let v = DMatrix::from_fn(5, 5, |i, j| {
            0.01 * (1.0 + i as f64) * 0.7f64.powi((i as i32 - j as i32).abs()) * (1.0 + j as f64)
        });
        let line = fit(&x, &y, v.clone()).unwrap();
        let (w, yv) = (v.try_inverse().unwrap(), DVector::from_column_slice(&y));
        let design = DMatrix::from_fn(5, 2, |i, j| if j == 0 { 1.0 } else { x[i] });
        let cov = (design.transpose() * &w * &design).try_inverse().unwrap();
        let b = &cov * design.transpose() * &w * &yv;
        let r = &yv - &design * &b;
        assert!((line.slope - b[1]).abs() < 1e-11 && (line.intercept - b[0]).abs() < 1e-11);
        assert!((line.std_error / cov[(1, 1)].sqrt() - 1.0).abs() < 1e-11);
        assert!((line.chi_squared / (r.transpose() * w * &r)[(0, 0)] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn what_has_no_line_gives_none() {
        let unit = |n| DMatrix::identity(n, n);
        assert!(fit(&[1.0], &[1.0], unit(1)).is_none());
        assert!(fit(&[1.0, 1.0], &[1.0, 2.0], unit(2)).is_none());
        assert!(fit(&[1.0, 2.0], &[1.0, 2.0], DMatrix::zeros(2, 2)).is_none());
        assert!(fit(&[1.0, 2.0], &[1.0, 2.0], unit(2) * f64::NAN).is_none());
    }
}
