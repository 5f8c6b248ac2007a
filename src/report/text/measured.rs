//! Arithmetic and text of a measured number with its standard error.
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

/// A value with its standard error, under the name that the chapters use.
///
/// ```
/// use fredholm::report::book::Number;
/// let (a, b) = (Number { value: 2.0, std_error: 0.02 }, Number { value: 4.0, std_error: 0.03 });
/// assert_eq!(a.over(b).to_string(), "0.5000 ± 0.0063");
/// // 5 standard errors must fit into the margin
/// assert!(a.is(2.0, 0.11) && !a.is(2.0, 0.09) && !a.is(2.1, 0.11));
/// ```
pub use crate::terms::cross_moments::Value as Number;

impl Number {
    /// Returns true if the interval of ± 5 standard errors lies within `margin` of `exact`.
    pub fn is(self, exact: f64, margin: f64) -> bool {
        (self.value - exact).abs() + 5.0 * self.std_error <= margin
    }

    /// The ratio of two independent numbers.
    pub fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, std_error: value.abs() * (self.std_error / self.value).hypot(other.std_error / other.value) }
    }

    /// The difference of two independent numbers.
    pub fn minus(self, other: Self) -> Self {
        Self { value: self.value - other.value, std_error: self.std_error.hypot(other.std_error) }
    }

    /// The number times an exact one.
    pub fn times(self, x: f64) -> Self {
        Self { value: self.value * x, std_error: self.std_error * x.abs() }
    }
}

impl From<&Estimate> for Number {
    /// The first channel: the scenes with numbers are grey.
    fn from(e: &Estimate) -> Self {
        Self { value: e.mean.x, std_error: e.std_error.x }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // an error that would not show in five digits is left out
        let error = if self.std_error < 1e-5 * self.value.abs() { 0.0 } else { self.std_error };
        f.write_str(&plus_minus(self.value, error, 2))
    }
}
