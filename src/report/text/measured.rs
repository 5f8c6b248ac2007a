//! A measured number with its standard error.
//!
//! ```text
//! x ± s      s(x/y) = |x/y| √((s_x/x)² + (s_y/y)²)      x is c to ± δ:  |x − c| + 5 s ≤ δ
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x, s | value and standard error | [`Number`] |
//! | c, δ | the value of the statement, and its margin | [`Number::is`] |

use super::number::plus_minus;
use crate::terms::Estimate;
use std::fmt;

/// A measured value with its standard error.
///
/// ```
/// use fredholm::report::book::Number;
/// let (a, b) = (Number { value: 2.0, error: 0.02 }, Number { value: 4.0, error: 0.03 });
/// assert_eq!(a.over(b).to_string(), "0.5000 ± 0.0063");
/// // 5 standard errors must fit into the margin
/// assert!(a.is(2.0, 0.11) && !a.is(2.0, 0.09) && !a.is(2.1, 0.11));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Number {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl Number {
    /// Returns true if the interval of ± 5 standard errors lies within `margin` of `exact`.
    pub fn is(self, exact: f64, margin: f64) -> bool {
        (self.value - exact).abs() + 5.0 * self.error <= margin
    }

    /// The ratio of two independent numbers.
    pub fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, error: value.abs() * (self.error / self.value).hypot(other.error / other.value) }
    }

    /// The difference of two independent numbers.
    pub fn minus(self, other: Self) -> Self {
        Self { value: self.value - other.value, error: self.error.hypot(other.error) }
    }

    /// The number times an exact one.
    pub fn times(self, x: f64) -> Self {
        Self { value: self.value * x, error: self.error * x.abs() }
    }
}

impl From<&Estimate> for Number {
    /// The first channel: the scenes with numbers are grey.
    fn from(e: &Estimate) -> Self {
        Self { value: e.mean.x, error: e.std_error.x }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // an error that would not show in five digits is left out
        let error = if self.error < 1e-5 * self.value.abs() { 0.0 } else { self.error };
        f.write_str(&plus_minus(self.value, error, 2))
    }
}
