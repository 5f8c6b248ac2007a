//! Formats numbers and verdicts as text.
//!
//! Each term is shown as one number: the mean of its three colour channels. Its error is the mean of the three errors. This
//! bounds the true error for any correlation of the channels (triangle inequality of the L2 norm).
//!
//! A dash means "not known", never zero. If the [evidence](crate::stats::evidence) is too weak for an error, the reason is
//! shown in its place: `3 events`, `no event`, `k̂ 0.9`.

use crate::stats::{Evidence, Outcome, half_width_95};
use crate::terms::Estimate;

/// The word for a verdict.
pub fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Agrees => "agrees",
        Outcome::Differs => "differs",
        Outcome::Inconclusive => "inconclusive",
    }
}

/// The symbol for a verdict.
pub fn mark(outcome: Outcome) -> char {
    match outcome {
        Outcome::Agrees => '✓',
        Outcome::Differs => '✗',
        Outcome::Inconclusive => '?',
    }
}

/// Mean over the channels, and half width of its 95 % interval (NaN if not known).
pub fn average(estimate: &Estimate) -> (f64, f64) {
    let mean = estimate.mean.element_sum() / 3.0;
    let std_error = estimate.std_error.element_sum() / 3.0;
    let known = Evidence::of(estimate).no_error.is_none();
    (mean, if known { half_width_95(std_error, estimate.replicates) } else { f64::NAN })
}

/// Text for the column of errors: the half width of the 95 % interval, or the reason why there is none.
pub fn error(estimate: &Estimate) -> String {
    Evidence::of(estimate).no_error.map_or_else(|| known(average(estimate).1), |why| why.short())
}

/// A number with `digits` significant digits. Outside 10⁻³ … 10⁵ it is written with a power of ten.
///
/// ```
/// use fredholm::report::text::number::significant;
/// assert_eq!(significant(0.123456, 3), "0.123");
/// assert_eq!(significant(99.996, 4), "100.0");
/// assert_eq!(significant(1.234e-5, 3), "1.23e-5");
/// assert_eq!(significant(0.0, 3), "0");
/// assert_eq!(significant(f64::NAN, 3), "–");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if value.is_nan() {
        return dash();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞".into() } else { "−∞".into() };
    }
    // Let the formatter round first, so that 9.9996 becomes 10.00.
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if !(-3..5).contains(&exponent) {
        return scientific;
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// `value ± error`: the error has `digits` significant digits, and the value as many decimals as the error. If the value is
/// exact or its error is not known, only the value is written.
///
/// ```
/// use fredholm::report::text::number::plus_minus;
/// assert_eq!(plus_minus(-1.00316, 0.00124, 2), "−1.0032 ± 0.0012");
/// assert_eq!(plus_minus(12.3456, 2.5, 1), "12 ± 2");
/// assert_eq!(plus_minus(0.5, 0.0, 2), "0.5000");
/// ```
pub fn plus_minus(value: f64, error: f64, digits: i32) -> String {
    let text = if error > 0.0 && error.is_finite() {
        let decimals = (f64::from(digits - 1) - error.log10().floor()).max(0.0) as usize;
        format!("{value:.decimals$} ± {error:.decimals$}")
    } else {
        significant(value, 4)
    };
    text.replace('-', "−").replace("e−", "e-")
}

/// A count in units, thousands (k), millions (M) or billions (G).
///
/// ```
/// assert_eq!(fredholm::report::text::number::count(16_777_216), "16.8 M");
/// assert_eq!(fredholm::report::text::number::count(999), "999");
/// ```
pub fn count(n: u64) -> String {
    let value = n as f64;
    let (scaled, unit) = match n {
        0..1_000 => return n.to_string(),
        1_000..999_950 => (value / 1e3, "k"),
        999_950..999_950_000 => (value / 1e6, "M"),
        _ => (value / 1e9, "G"),
    };
    format!("{scaled:.1} {unit}")
}

/// A fraction of the whole, in percent with one decimal.
pub fn percent(share: f64) -> String {
    let share = 100.0 * share;
    if share.is_finite() { format!("{share:.1} %") } else { dash() }
}

/// A p-value with two digits; small ones with a power of ten.
pub(crate) fn p_value(p: f64) -> String {
    if p.is_nan() { dash() } else { significant(p, 2) }
}

/// A number with three digits and a sign; a dash if it is not known.
pub(crate) fn signed(value: f64) -> String {
    if value.is_nan() {
        return dash();
    }
    let sign = if value > 0.0 { "+" } else { "" };
    if value.is_infinite() {
        return if value > 0.0 { "+∞".into() } else { "−∞".into() };
    }
    format!("{sign}{}", significant(value, 3))
}

/// A number with two digits. A dash if it is not known, ∞ for an error whose variance is infinite.
pub(crate) fn known(value: f64) -> String {
    match value {
        v if v.is_nan() => dash(),
        v if v.is_infinite() => "∞".into(),
        v => significant(v, 2),
    }
}

pub(crate) fn dash() -> String {
    "–".into()
}
