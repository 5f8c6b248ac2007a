//! The observed order of convergence, and the limit h → 0 of a value known on a few meshes.
//!
//! ```text
//! |e(h)| ≈ c h^p      ln |e| = ln c + p ln h,   Var ln |e| ≈ (s/e)²
//! v ≈ v(h) + (v(h) − v(H)) / ((H/h)^p − 1)       H > h,  1.2 ≤ p ≤ 2
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | h | width of the mesh | `points` |
//! | e, s | error at that width, its standard error | `points` |
//! | p | the order | [`Order::order`] |
//! | v | limit for h → 0 (Richardson) | [`Limit::value`] |
//!
//! The logarithm is linearised, so only errors above [`CLEAR`] standard errors count. Errors that share their noise (one
//! reference for all meshes) are correlated. That is ignored; where most noise is that of the reference, it makes the
//! standard error of p a little too large. If the error changes its sign between meshes, there is no order.

//!
//! Reference: Richardson and Gaunt, *The deferred approach to the limit* (1927); Roache, *Perspective: a method for uniform
//! reporting of grid refinement studies* (1994).

use super::hypothesis::ROUNDING;
use super::line;
use nalgebra::DMatrix;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Number of standard errors that an error must exceed to be counted.
pub const CLEAR: f64 = 3.0;

/// An order with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// p, the order.
    pub order: f64,
    /// Its standard error; 0 if the errors are exact.
    pub std_error: f64,
    /// c, the factor of the power law.
    pub constant: f64,
    /// Number of meshes whose error was clear enough to count.
    pub meshes: usize,
    /// Probability of a misfit at least this large if the error is one power of h; NaN with two meshes.
    pub p: f64,
}

/// Fits the order through `points` = (h, e, s). None with fewer than two clear errors, or if they differ in sign.
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

/// Smallest and largest order that a limit allows for: 1 + 2β at an edge with exponent β ≥ 0.1, and 2 for smooth light. The
/// order observed on three meshes is not used. It is wrong by up to a half, mostly too high, and intervals that trusted it
/// were up to nine times too short. With the range given here, 126 of 132 limits were covered (DESIGN.md).
pub const ORDERS: [f64; 2] = [1.2, 2.0];

/// A value extrapolated to h → 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Middle of the values that these orders give.
    pub value: f64,
    /// Half the span of these values, plus two standard errors of the noise, plus rounding. It is an estimate, not a bound.
    pub half_width: f64,
    /// The smallest and the largest order that were allowed for.
    pub orders: [f64; 2],
}

/// Each mesh width must be at most this fraction of the one before; half is usual.
const FINER: f64 = 0.75;

/// Extrapolates to h → 0 a value known at `points` = (h, v, s), coarsest first. The last two points are used, with all
/// orders in the range [`ORDERS`]. None with fewer than two points, or if a mesh is hardly finer than the one before.
///
/// ```
/// use fredholm::stats::limit;
/// let points = [0.4, 0.2, 0.1].map(|h: f64| (h, 0.7 - h.powf(1.6), 0.0));
/// let found = limit(&points).unwrap();
/// assert!((found.value - 0.7).abs() < found.half_width && found.half_width < 0.5 * 0.1f64.powf(1.6));
/// assert_eq!(found.orders, [1.2, 2.0]);
/// assert!(limit(&[(0.4, 0.6, 0.0), (0.4, 0.6, 0.0)]).is_none());
/// ```
pub fn limit(points: &[(f64, f64, f64)]) -> Option<Limit> {
    let [.., (wide, before, noise), (h, value, own)] = *points else { return None };
    if points.windows(2).any(|w| w[1].0 > FINER * w[0].0) {
        return None;
    }
    let step = value - before;
    let factor = |p: f64| 1.0 / ((wide / h).powf(p) - 1.0);
    let [most, least] = ORDERS.map(factor);
    let middle = 0.5 * (most + least);
    let noise = ((1.0 + middle) * own).hypot(middle * noise);
    // a step as small as rounding says nothing about the error
    let half_width = 0.5 * (most - least) * step.abs() + 2.0 * noise + ROUNDING * value.abs();
    Some(Limit { value: value + middle * step, half_width, orders: ORDERS })
}
