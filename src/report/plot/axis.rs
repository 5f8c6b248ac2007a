//! An axis: maps values to [0, 1], and chooses its ticks.
//!
//! The plot crate's logarithmic axes have no labels if the range is less than a decade, and draw values outside the range on
//! the frame. Ranges, ticks and clipping are therefore handled here.

/// One axis of a panel.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Its title.
    pub title: String,
    lo: f64,
    hi: f64,
    log: bool,
    /// Labelled ticks.
    pub ticks: Vec<(f64, String)>,
    /// Ticks without label.
    pub minor: Vec<f64>,
}

impl Axis {
    /// Linear axis from `lo` to `hi`, with at most `ticks` ticks at multiples of 1, 2 or 5 · 10ⁿ.
    pub fn linear(title: &str, lo: f64, hi: f64, ticks: usize) -> Self {
        let step = nice_step((hi - lo) / ticks as f64);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let first = (lo / step).ceil() as i64;
        let last = (hi / step + 1e-9).floor() as i64;
        let ticks = (first..=last).map(|i| (i as f64 * step, format!("{:.decimals$}", i as f64 * step))).collect();
        Self { title: title.into(), lo, hi, log: false, ticks, minor: Vec::new() }
    }

    /// Axis over the whole numbers `0..=last`, extended by one half at both ends.
    pub fn counts(title: &str, last: usize, ticks: usize) -> Self {
        let step = nice_step(last as f64 / ticks as f64).max(1.0) as usize;
        let ticks = (0..=last).step_by(step).map(|k| (k as f64, k.to_string())).collect();
        Self { title: title.into(), lo: -0.5, hi: last as f64 + 0.5, log: false, ticks, minor: Vec::new() }
    }

    /// Logarithmic axis that contains all positive `values`. Ticks are at the decades, or in steps 1-2-5 if the axis spans
    /// less than two and a half decades.
    pub fn log(title: &str, values: impl Iterator<Item = f64>) -> Self {
        let (mut lo, mut hi) = (f64::INFINITY, 0.0f64);
        for v in values.filter(|v| v.is_finite() && *v > 0.0) {
            (lo, hi) = (lo.min(v), hi.max(v));
        }
        if lo > hi {
            (lo, hi) = (0.1, 1.0);
        }
        // Leave space at both ends, so that no mark touches the frame; a longer axis gets more.
        let air = (hi / lo).powf(0.06).max(1.25);
        (lo, hi) = (lo / air, hi * air);
        let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
        let (ticks, minor);
        let inside = |v: &f64| (lo..=hi).contains(v);
        if (hi / lo).log10() >= 2.5 {
            let every = ((last - first) as usize).div_ceil(9);
            ticks = (first..=last)
                .step_by(every)
                .map(|e| (10f64.powi(e), power_of_ten(e)))
                .filter(|(v, _)| inside(v))
                .collect();
            minor = if last - first <= 7 {
                (first..last).flat_map(|e| (2..10).map(move |m| f64::from(m) * 10f64.powi(e))).collect()
            } else {
                (first..=last).map(|e| 10f64.powi(e)).collect()
            };
        } else {
            let steps = |multiples: &[f64]| -> Vec<f64> {
                let all = (first - 1..=last).flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e)));
                all.filter(inside).collect()
            };
            let mut labelled = steps(&[1.0, 2.0, 5.0]);
            if labelled.len() < 3 {
                labelled = steps(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
            }
            minor = steps(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
            if labelled.len() < 2 {
                labelled = Self::linear("", lo, hi, 5).ticks.into_iter().map(|(v, _)| v).collect();
            }
            ticks = labelled.into_iter().map(|v| (v, log_label(v))).collect();
        }
        Self { title: title.into(), lo, hi, log: true, ticks, minor }
    }

    /// Logarithmic axis for numbers of samples. Ticks are at powers of two, with at most `labels` labels.
    pub fn powers_of_two(title: &str, values: impl Iterator<Item = f64>, labels: usize) -> Self {
        let (mut lo, mut hi) = (f64::INFINITY, 0.0f64);
        for v in values.filter(|v| v.is_finite() && *v > 0.0) {
            (lo, hi) = (lo.min(v), hi.max(v));
        }
        if lo > hi {
            (lo, hi) = (1.0, 2.0);
        }
        let (first, last) = (lo.log2().floor() as i32, hi.log2().ceil() as i32);
        let every = ((last - first) as usize + 1).div_ceil(labels).max(1);
        let ticks = (first..=last).step_by(every).map(|e| (2f64.powi(e), 2f64.powi(e).to_string())).collect();
        let minor = (first..=last).map(|e| 2f64.powi(e)).collect();
        Self { title: title.into(), lo: lo / 1.4, hi: hi * 1.4, log: true, ticks, minor }
    }

    /// Position of a value: 0 at the lower end, 1 at the upper end, and outside [0, 1] beyond them. NaN if the value has no
    /// position.
    pub fn position(&self, value: f64) -> f64 {
        let scale = |v: f64| if self.log { v.ln() } else { v };
        (scale(value) - scale(self.lo)) / (scale(self.hi) - scale(self.lo))
    }

    /// Returns true for a logarithmic axis.
    pub fn is_log(&self) -> bool {
        self.log
    }
}

/// The smallest number of the form 1, 2 or 5 · 10ⁿ that is not below `least`.
fn nice_step(least: f64) -> f64 {
    let power = 10f64.powf(least.max(f64::MIN_POSITIVE).log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|&s| s >= least * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

/// A power of ten in superscript notation: `10⁻³`.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    let raised = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' | '4'..='9' => char::from_u32('⁰' as u32 + (c as u32 - '0' as u32)).unwrap_or(c),
        other => other,
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

/// Label of a value on a logarithmic axis with a short range.
fn log_label(value: f64) -> String {
    if (1e-3..1e4).contains(&value) {
        return ((value * 1e6).round() / 1e6).to_string();
    }
    let exponent = value.log10().floor() as i32;
    let mantissa = (value / 10f64.powi(exponent) * 100.0).round() / 100.0;
    format!("{mantissa}·{}", power_of_ten(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn log_axes_are_labelled_whatever_they_span() {
        assert_eq!(labels(&Axis::log("", [3e-3, 2.0].into_iter())), ["10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(labels(&Axis::log("", [0.1, 1.0].into_iter())), ["0.1", "0.2", "0.5", "1"]);
        for (lo, hi) in [(0.8, 0.9), (1e-9, 1.02e-9), (1e-30, 1.0), (5.0, 5.0)] {
            let axis = Axis::log("", [lo, hi].into_iter());
            assert!((2..=12).contains(&axis.ticks.len()), "{lo}..{hi}: {:?}", labels(&axis));
            assert!([lo, hi].iter().all(|&v| axis.position(v) > 0.0 && axis.position(v) < 1.0));
        }
        assert!(!Axis::log("", std::iter::empty()).ticks.is_empty());
    }

    #[test]
    fn raised_digits() {
        assert_eq!(power_of_ten(-1_234_567_890), "10⁻¹²³⁴⁵⁶⁷⁸⁹⁰");
    }

    #[test]
    fn linear_ticks_are_round_and_inside() {
        assert_eq!(labels(&Axis::linear("", 0.0, 1.0, 6)), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&Axis::counts("", 8, 16)), ["0", "1", "2", "3", "4", "5", "6", "7", "8"]);
        assert_eq!(labels(&Axis::counts("", 40, 12)), ["0", "5", "10", "15", "20", "25", "30", "35", "40"]);
    }
}
