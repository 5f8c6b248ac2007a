//! The observed order of convergence, and the limit of what is known on a few meshes.
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
//! The logarithm is taken to first order, so only errors above [`CLEAR`] standard errors count. Errors that share their noise (one
//! reference for all meshes) move together; that is left out, and makes the error of p a little too large where the noise is that of
//! the reference. A sign that changes between meshes has no order.

//!
//! Reference: Richardson and Gaunt, *The deferred approach to the limit* (1927); Roache, *Perspective: a method for uniform
//! reporting of grid refinement studies* (1994).

use super::hypothesis::ROUNDING;
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

/// The orders that a limit allows for: 1 + 2β of an edge with exponent β ≥ 0.1, and 2 of smooth light. The order that three meshes show
/// is not used: it is off by up to a half, mostly too high, and intervals that trusted it were up to nine times too short. With these
/// 126 of 132 limits were covered (DESIGN.md).
pub const ORDERS: [f64; 2] = [1.2, 2.0];

/// A value for h → 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The middle of what the orders give.
    pub value: f64,
    /// Half of the span of what they give, two standard errors of the noise, and rounding: an estimate, no bound.
    pub half_width: f64,
    /// The least and the largest order allowed for.
    pub orders: [f64; 2],
}

/// Meshes are at least this much narrower than the one before; half as wide is usual.
const FINER: f64 = 0.75;

/// The limit of a value of which `points` = (h, v, s) are known, coarsest first; the last two are used. All of [`ORDERS`] is allowed
/// for. None with fewer than two, or where one is hardly finer than the one before.
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
    // where the step is rounding it says nothing of the error
    let half_width = 0.5 * (most - least) * step.abs() + 2.0 * noise + ROUNDING * value.abs();
    Some(Limit { value: value + middle * step, half_width, orders: ORDERS })
}
