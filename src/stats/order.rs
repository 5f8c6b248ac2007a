//! The observed order of convergence, and the limit of what is known on a few meshes.
//!
//! ```text
//! |e(h)| ≈ c h^p      ln |e| = ln c + p ln h,   Var ln |e| ≈ (s/e)²
//! v ≈ v(h) + (v(h) − v(H)) / ((H/h)^p − 1)       p: (v(H) − v(G))/(v(h) − v(H)) = (G^p − H^p)/(H^p − h^p),  G > H > h
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

/// The orders that a limit allows for: 1 + 2β of an edge with exponent β ≥ 0, and 2 of smooth light.
pub const ORDERS: [f64; 2] = [1.0, 2.0];
/// How far below the one that three meshes show the order may be; above, all of [`ORDERS`] is allowed for.
pub const SLACK: f64 = 0.25;

/// A value for h → 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The middle of what the orders give.
    pub value: f64,
    /// Half of the span of what they give, and two standard errors of the noise: an estimate, no bound.
    pub half_width: f64,
    /// The least and the largest order allowed for.
    pub orders: [f64; 2],
}

/// Meshes are at least this much narrower than the one before; half as wide is usual.
const FINER: f64 = 0.75;

/// The limit of a value of which `points` = (h, v, s) are known, coarsest first; the last three are used.
///
/// Three meshes show an order; the true one is taken to be at most [`SLACK`] below it, and at most 2: on coarse meshes it is
/// still on its way up. Where two are all there is, or three that turn back, all of [`ORDERS`] is allowed for. None with
/// fewer than two, or where one is hardly finer than the one before.
///
/// ```
/// use fredholm::stats::limit;
/// let points = [0.4, 0.2, 0.1].map(|h: f64| (h, 0.7 - h.powf(1.6), 0.0));
/// let found = limit(&points).unwrap();
/// assert!((found.value - 0.7).abs() < found.half_width && found.half_width < 0.4 * 0.1f64.powf(1.6));
/// assert!((found.orders[0] - 1.35).abs() < 1e-9 && found.orders[1] == 2.0);
/// assert_eq!(limit(&points[1..]).unwrap().orders, [1.0, 2.0]);
/// assert!(limit(&[(0.4, 0.6, 0.0), (0.4, 0.6, 0.0)]).is_none());
/// ```
pub fn limit(points: &[(f64, f64, f64)]) -> Option<Limit> {
    let [.., (wide, before, noise), (h, value, own)] = *points else { return None };
    if points.windows(2).any(|w| w[1].0 > FINER * w[0].0) {
        return None;
    }
    let step = value - before;
    let shown = match *points {
        [.., (widest, first, _), _, _] => {
            let ratio = |p: f64| (widest.powf(p) - wide.powf(p)) / (wide.powf(p) - h.powf(p));
            let seen = (before - first) / step;
            (seen > 0.0 && seen.is_finite()).then(|| solve(ratio, seen))
        }
        _ => None,
    };
    let orders = shown.map_or(ORDERS, |p| [(p - SLACK).max(ORDERS[0]), ORDERS[1]]);
    let factor = |p: f64| 1.0 / ((wide / h).powf(p) - 1.0);
    let [most, least] = orders.map(factor);
    let middle = 0.5 * (most + least);
    let noise = ((1.0 + middle) * own).hypot(middle * noise);
    Some(Limit { value: value + middle * step, half_width: 0.5 * (most - least) * step.abs() + 2.0 * noise, orders })
}

/// The p of [`ORDERS`] with `f(p)` nearest to `seen`, f increasing.
fn solve(f: impl Fn(f64) -> f64, seen: f64) -> f64 {
    let [mut low, mut high] = ORDERS;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) < seen { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
