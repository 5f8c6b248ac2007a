//! A figure of the signature of a mistake: the ratio r_k against k, measured and predicted.
//!
//! ```text
//! r_k = T_k^suspect / T_k^right
//! r_k is constant: the mistake is in the connection      r_k is geometric in k: the mistake is in the bounce
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r_k | ratio of the image means | [`Signature::measured`] |
//! | – | r_k by theory, where it does not depend on the scene | [`Signature::predicted`] |

use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure},
};

/// The data of the figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signature {
    /// Title of the figure.
    pub title: String,
    /// Measured r_k with standard errors.
    pub measured: Vec<Point>,
    /// r_k by theory; empty where it depends on the scene.
    pub predicted: Vec<Point>,
}

/// Draws the figure.
///
/// # Errors
/// If the plot crate fails, which is a defect of the program.
pub fn draw(signature: &Signature, caption: &Caption) -> Result<Figure, ReportError> {
    figure("signature", 960, 490, caption, |page| panel(page, signature))
}

fn panel(page: &Canvas, signature: &Signature) -> Drawn {
    page.text(&signature.title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    let all = || signature.measured.iter().chain(&signature.predicted).filter(|p| p.value.is_finite());
    let last = all().map(|p| p.x).fold(1.0, f64::max) as usize;
    let highest = all().map(|p| p.value).fold(1.0, f64::max);
    let words = "rₖ = Tₖ suspect / Tₖ correct";
    let y = if highest > 6.0 {
        Axis::log(words, all().map(|p| p.value).chain([1.0]))
    } else {
        Axis::linear(words, 0.0, 1.15 * highest, 8)
    };
    let panel = Panel::draw(
        page,
        "Ratio of the image means",
        [84.0, 72.0, 540.0, 350.0],
        Axis::counts("bounce k", last, 16),
        y,
    )?;
    let one = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
    panel.line((-0.5, 1.0), (last as f64 + 0.5, 1.0), one)?;
    let curve = |label: &str, points: &[Point], look| Curve { label: label.into(), points: points.to_vec(), look };
    let (theory, found) = (Look::MATRIX, Look::SINGLE);
    panel.curve(&curve("predicted", &signature.predicted, theory), -5.0, false)?;
    panel.curve(&curve("measured", &signature.measured, found), 5.0, false)?;
    let mut entries = vec![Entry::new(Sample::Mark(found), "measured, 95 % intervals")];
    if !signature.predicted.is_empty() {
        entries.push(Entry::new(Sample::Mark(theory), "predicted"));
    }
    entries.push(Entry::new(Sample::Line(one), "1: correct"));
    page.legend((646.0, 68.0), 300.0, &entries)?;
    Ok(())
}
