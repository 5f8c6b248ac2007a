//! The decay of the series: how fast `T^k E` decreases, in the surface norm, where a bound holds, and in the image norm.
//!
//! ```text
//! ‖T^k E‖₁ ≤ ‖T‖₁^k ‖E‖₁,   ‖T‖₁ ≤ max albedo          (guaranteed, surface norm)
//! ‖L − S_n‖₁ ≤ g/(1−g) ‖T^n E‖₁,  g = max albedo < 1     (a posteriori: needs the last term)
//! ‖T^{k+1} E‖₁ / ‖T^k E‖₁ → r(T)                         (observed; only asymptotic)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | ‖·‖₁ | mean over the surface sensor: points uniform in area, cosine-distributed directions | [`Decay::surface`], large panel |
//! | ‖·‖₂ | root mean square over the image, from products of replicates | [`Decay::image`], no bound is claimed |
//! | ratio | ‖T^k E‖₁ / ‖T^{k−1} E‖₁ | [`Decay::ratios`] |
//!
//! Reference: Arvo, Torrance, Smits (1994), for the bound.

use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{Axis, BLACK, Canvas, Curve, Drawn, Entry, Figure, Panel, Point, Sample, Words, figure},
};
use crate::stats::{self, TermMeans};

pub use super::rate::{RateKind, RateLine};

/// Contents of the figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decay {
    /// Title of the figure.
    pub title: String,
    /// Surface norms ‖T^k E‖₁ against k.
    pub surface: Vec<Curve>,
    /// Geometric lines in the surface panel. Lines that are rates of the terms are also drawn in the panel of ratios.
    pub lines: Vec<RateLine>,
    /// Image norms ‖T^k E‖₂ against k. If empty, this panel is left out.
    pub image: Vec<Curve>,
    /// Ratios at k = 1, 2, …; if empty, this panel is left out. See [`independent_ratios`].
    pub ratios: Vec<Curve>,
}

/// The norms of the terms as points of a curve.
///
/// ```
/// use fredholm::{report::{figures::decay::norms, plot::Point}, stats::TermMeans};
/// assert_eq!(norms(&TermMeans::exact(&[4.0, 2.0])), [Point::exact(0.0, 4.0), Point::exact(1.0, 2.0)]);
/// ```
pub fn norms(terms: &TermMeans) -> Vec<Point> {
    let point = |(k, &value): (usize, &f64)| {
        let std_error = if terms.has_error(k) { terms.covariance[(k, k)].sqrt() } else { f64::NAN };
        Point { x: k as f64, value, std_error, replicates: terms.replicates }
    };
    terms.mean.iter().enumerate().map(point).collect()
}

/// Ratios of terms that were measured together; the errors use their covariance. The ratio of term k to term k − 1 is drawn
/// at k, as in the tables.
pub fn ratios(terms: &TermMeans) -> Vec<Point> {
    let point = |k: usize| {
        let (value, std_error) = stats::ratio(terms, k - 1)?;
        let std_error = if terms.has_error(k - 1) && terms.has_error(k) { std_error } else { f64::NAN };
        Some(Point { x: k as f64, value, std_error, replicates: terms.replicates })
    };
    (1..terms.mean.len()).filter_map(point).collect()
}

/// Ratios of consecutive points whose errors are independent (one estimator per term, or exact values): `r = b/a`,
/// `(se_r/r)² = (se_a/a)² + (se_b/b)²`, the delta method. Terms of one path are correlated, so that their ratios need the
/// covariance: use [`ratios`].
///
/// ```
/// use fredholm::report::{figures::decay::independent_ratios, plot::Point};
/// let r = independent_ratios(&[Point::exact(0.0, 4.0), Point::exact(1.0, 2.0), Point::exact(2.0, 0.5)]);
/// assert_eq!(r, [Point::exact(1.0, 0.5), Point::exact(2.0, 0.25)]);
/// ```
pub fn independent_ratios(points: &[Point]) -> Vec<Point> {
    let ratio = |pair: &[Point]| {
        let (a, b) = (pair[0], pair[1]);
        let value = b.value / a.value;
        let std_error = ((b.std_error / a.value).powi(2) + (value * a.std_error / a.value).powi(2)).sqrt();
        // The error is known only as well as the point with fewer replicates.
        let known = [a, b].map(|p| p.replicates).into_iter().filter(|&n| n > 0).min().unwrap_or(0);
        Point { x: b.x, value, std_error, replicates: known }
    };
    points.windows(2).map(ratio).collect()
}

const WIDTH: u32 = 960;

/// Draws the figure.
///
/// # Errors
/// If the plot crate fails, which is a defect of the program.
pub fn draw(decay: &Decay, caption: &Caption) -> Result<Figure, ReportError> {
    let below = !(decay.image.is_empty() && decay.ratios.is_empty());
    figure("decay", WIDTH, if below { 780 } else { 490 }, caption, |page| panels(page, decay))
}

fn panels(page: &Canvas, decay: &Decay) -> Drawn {
    let last = [&decay.surface, &decay.image].into_iter().flatten().flat_map(|c| &c.points).map(|p| p.x);
    let last = last.filter(|x| x.is_finite()).fold(1.0, f64::max) as usize;
    page.text(&decay.title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;

    // The surface panel: data, and the lines that hold for this norm.
    let starts = decay.lines.iter().map(|l| l.value);
    let y = Axis::log("‖TᵏE‖₁   (mean radiance, W sr⁻¹ m⁻²)", extent(&decay.surface).chain(starts));
    let frame = [84.0, 72.0, 540.0, 350.0];
    let panel = Panel::draw(page, "Surface norm ‖TᵏE‖₁", frame, Axis::counts("bounce k", last, 16), y)?;
    let end = last as f64 + 0.5;
    for line in &decay.lines {
        let to = line.value * line.ratio.powf(end - line.k0);
        panel.line((line.k0, line.value), (end, to), line.kind.stroke())?;
    }
    curves(&panel, &decay.surface)?;

    // The legend is next to the panel, so that it covers no data.
    let mut entries = vec![Entry::new(Sample::Heading, "Surface norm, 95 % intervals")];
    entries.extend(decay.surface.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)));
    if !decay.lines.is_empty() {
        entries.push(Entry::new(Sample::Heading, "Rates and bounds"));
        entries.extend(decay.lines.iter().map(|l| Entry::new(Sample::Line(l.kind.stroke()), &l.label)));
    }
    let only_below: Vec<_> = (decay.image.iter().chain(&decay.ratios))
        .filter(|c| !c.label.is_empty() && decay.surface.iter().all(|s| s.look != c.look))
        .collect();
    if !only_below.is_empty() {
        entries.push(Entry::new(Sample::Heading, "Below"));
        entries.extend(only_below.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)));
    }
    let limits = |c: &Curve| c.points.iter().any(|p| panel.is_limit(p));
    if decay.surface.iter().chain(&decay.image).any(limits) {
        entries.push(Entry::new(Sample::Limit(BLACK), "upper limit: the interval reaches zero"));
    }
    page.legend((646.0, 68.0), 300.0, &entries)?;

    // Lower panels: the image norm, and the ratios.
    let mut left = 84.0;
    if !decay.image.is_empty() {
        let y = Axis::log("‖TᵏE‖₂   (rms radiance)", extent(&decay.image));
        let x = Axis::counts("bounce k", last, 10);
        let panel = Panel::draw(page, "Image norm ‖TᵏE‖₂: no bound claimed", [left, 504.0, 372.0, 220.0], x, y)?;
        curves(&panel, &decay.image)?;
        left = 552.0;
    }
    if !decay.ratios.is_empty() {
        let rates = decay.lines.iter().filter(|l| l.kind != RateKind::TailBound);
        let y = ratio_axis(decay.ratios.iter().flat_map(|c| &c.points), rates.clone().map(|l| l.ratio));
        let x = Axis::counts("bounce k", last, 10);
        let title = "Ratio ‖TᵏE‖₁ / ‖Tᵏ⁻¹E‖₁";
        let panel = Panel::draw(page, title, [left, 504.0, 372.0, 220.0], x, y)?;
        for line in rates {
            panel.line((line.k0.max(0.5), line.ratio), (end, line.ratio), line.kind.stroke())?;
        }
        curves(&panel, &decay.ratios)?;
    }
    Ok(())
}

/// Draws several curves, shifted horizontally by a few pixels so that they do not hide each other.
fn curves(panel: &Panel, curves: &[Curve]) -> Drawn {
    // Exact values first, so that estimates are drawn on top of them.
    let dodge = |i: usize| 6.0 * (i as f64 - (curves.len() as f64 - 1.0) / 2.0);
    let noisy = |c: &Curve| c.points.iter().any(|p| p.half_width() > 0.0);
    for wanted in [false, true] {
        for (i, curve) in curves.iter().enumerate().filter(|(_, c)| noisy(c) == wanted) {
            panel.curve(curve, dodge(i), false)?;
        }
    }
    Ok(())
}

/// Values that a logarithmic axis must contain: the points, and the upper ends of their intervals.
fn extent(curves: &[Curve]) -> impl Iterator<Item = f64> {
    curves.iter().flat_map(|c| &c.points).flat_map(|p| [p.value, p.value + p.half_width()])
}

/// An axis from just below the smallest to just above the largest ratio. Very long error bars are ignored.
fn ratio_axis<'a>(points: impl Iterator<Item = &'a Point> + Clone, rates: impl Iterator<Item = f64>) -> Axis {
    let certain = points.clone().filter(|p| p.half_width() < 0.5 * p.value.abs());
    let values =
        points.map(|p| p.value).chain(certain.flat_map(|p| [p.value - p.half_width(), p.value + p.half_width()]));
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for v in values.chain(rates).filter(|v| v.is_finite() && (0.0..=1.5).contains(v)) {
        (lo, hi) = (lo.min(v), hi.max(v));
    }
    if lo > hi {
        (lo, hi) = (0.0, 1.0);
    }
    let air = (0.12 * (hi - lo)).max(0.02);
    Axis::linear("ratio", (lo - air).max(0.0), hi + air, 6)
}
