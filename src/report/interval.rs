//! Half width of a 95 % interval: `t_{0.975}(R − 1) · std_error` for R replicates (Student 1908).

use crate::stats::critical;

/// Half width of the two-sided 95 % interval of a mean over `replicates` values with the given standard error.
///
/// Exact values (`replicates` = 0) have no width. One replicate says nothing about its error: the result is NaN, and
/// tables show a dash.
///
/// ```
/// use fredholm::report::half_width_95;
/// assert_eq!(half_width_95(0.0, 0), 0.0);
/// assert!(half_width_95(1.0, 1).is_nan());
/// assert!((half_width_95(1.0, 16) - 2.131_449_5).abs() < 1e-6);    // 15 degrees of freedom
/// ```
pub fn half_width_95(std_error: f64, replicates: u64) -> f64 {
    match replicates {
        0 => 0.0,
        1 => f64::NAN,
        r => critical(0.05, (r - 1) as f64) * std_error,
    }
}
