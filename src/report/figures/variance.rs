//! Variance of a pixel's mean against samples per pixel, on logarithmic axes.
//!
//! ```text
//! Var(mean of n samples) = σ²/n      slope −1
//! ```
//!
//! Independent samples give slope −1 for every scene, as long as σ² is finite. A flatter slope indicates correlated samples
//! or infinite variance. A steeper slope comes from stratified or quasi-random points.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | samples per pixel | `Point::x` |
//! | slope | slope of log variance against log n, fitted by the caller | [`Falling::slope`] |

use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Panel, Sample, Stroke, Words, figure},
    text::number::plus_minus,
};

/// One curve and its fitted slope.
#[derive(Clone, Debug, PartialEq)]
pub struct Falling {
    /// Variance against samples per pixel.
    pub curve: Curve,
    /// The slope and its standard error; none if it was not fitted.
    pub slope: Option<(f64, f64)>,
}

/// Contents of the figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variance {
    /// Title of the figure.
    pub title: String,
    /// The curves.
    pub curves: Vec<Falling>,
}

/// Draws the figure.
///
/// # Errors
/// If the plot crate fails, which is a defect of the program.
pub fn draw(variance: &Variance, caption: &Caption) -> Result<Figure, ReportError> {
    figure("variance", 960, 490, caption, |page| panel(page, variance))
}

fn panel(page: &Canvas, variance: &Variance) -> Drawn {
    page.text(&variance.title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    let points = || variance.curves.iter().flat_map(|c| &c.curve.points);
    let x = Axis::powers_of_two("samples per pixel n", points().map(|p| p.x), 9);
    let y = Axis::log("variance   (W² sr⁻² m⁻⁴)", points().flat_map(|p| [p.value, p.value + p.half_width()]));
    let panel = Panel::draw(page, "Variance of the mean of n samples", [84.0, 72.0, 540.0, 350.0], x, y)?;

    // Draw the guide line slightly above the first point, so that it hides no curve.
    let guide = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
    let first = points().filter(|p| p.value > 0.0).max_by(|a, b| (a.value * a.x).total_cmp(&(b.value * b.x)));
    if let Some(top) = first {
        let level = 1.6 * top.value * top.x;
        let far = points().map(|p| p.x).fold(1.0, f64::max) * 2.0;
        panel.line((0.5, level / 0.5), (far, level / far), guide)?;
    }
    for falling in &variance.curves {
        panel.curve(&falling.curve, 0.0, true)?;
    }

    let mut entries = vec![Entry::new(Sample::Heading, "Estimators, 95 % intervals")];
    entries.extend(variance.curves.iter().map(|f| {
        let label = match f.slope {
            Some((slope, error)) => {
                format!("{}: slope\u{a0}{}", f.curve.label, plus_minus(slope, error, 2).replace(' ', "\u{a0}"))
            }
            None => f.curve.label.clone(),
        };
        Entry::new(Sample::Mark(f.curve.look), label)
    }));
    entries.push(Entry::new(Sample::Line(guide), "slope −1: independent samples"));
    if points().any(|p| panel.is_limit(p)) {
        entries.push(Entry::new(Sample::Limit(GREY), "upper limit: the interval reaches zero"));
    }
    page.legend((646.0, 68.0), 300.0, &entries)?;
    Ok(())
}
