//! The observed order of convergence.
//!
//! ```text
//! |e(h)| ≈ c h^p      ln |e| = ln c + p ln h,   Var ln |e| ≈ (s/e)²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | h | width of the mesh | `points` |
//! | e, s | error at that width, its standard error | `points` |
//! | p | the order | [`Order::order`] |
//!
//! The logarithm is taken to first order, so only errors above [`CLEAR`] standard errors count. Errors that share their noise (one
//! reference for all meshes) move together; that is left out, and makes the error of p a little too large where the noise is that of
//! the reference. A sign that changes between meshes has no order.

use super::line;
use nalgebra::DMatrix;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// How many standard errors an error must have to be counted.
pub const CLEAR: f64 = 3.0;

/// An order with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// p.
    pub order: f64,
    /// Its standard error; 0 if the errors are exact.
    pub std_error: f64,
    /// c.
    pub constant: f64,
    /// How many meshes were clear enough to count.
    pub meshes: usize,
    /// P(misfit at least this large | one power of h); NaN with two meshes.
    pub p: f64,
}

/// Fits the order through `points` = (h, e, s). None with fewer than two clear errors of one sign.
///
/// ```
/// use fredholm::stats::convergence_order;
/// let points = [1.0, 0.5, 0.25].map(|h: f64| (h, -3.0 * h * h, 1e-3 * h * h));
/// let fit = convergence_order(&points).unwrap();
/// assert!((fit.order - 2.0).abs() < 1e-12 && (fit.constant - 3.0).abs() < 1e-12);
/// assert!(convergence_order(&[(1.0, 0.1, 0.05), (0.5, 0.2, 0.01)]).is_none());
/// assert!(convergence_order(&[(1.0, 0.1, 0.0), (0.5, -0.2, 0.0)]).is_none());
/// ```
pub fn convergence_order(points: &[(f64, f64, f64)]) -> Option<Order> {
    let clear: Vec<_> = points.iter().filter(|(_, e, s)| e.abs() > CLEAR * s && e.is_finite()).collect();
    let sign = clear.first()?.1.signum();
    if clear.iter().any(|(_, e, _)| e.signum() != sign) {
        return None;
    }
    let x: Vec<f64> = clear.iter().map(|(h, ..)| h.ln()).collect();
    let y: Vec<f64> = clear.iter().map(|(_, e, _)| e.abs().ln()).collect();
    let exact = clear.iter().all(|(.., s)| *s == 0.0);
    let relative: Vec<f64> = clear.iter().map(|(_, e, s)| if exact { 1.0 } else { (s / e).powi(2) }).collect();
    let line = line::fit(&x, &y, DMatrix::from_diagonal(&relative.into()))?;
    let p = if exact {
        f64::NAN
    } else {
        ChiSquared::new(x.len() as f64 - 2.0).map_or(f64::NAN, |d| d.sf(line.chi_squared))
    };
    Some(Order {
        order: line.slope,
        std_error: if exact { 0.0 } else { line.std_error },
        constant: line.intercept.exp(),
        meshes: x.len(),
        p,
    })
}
