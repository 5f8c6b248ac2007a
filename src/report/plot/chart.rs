//! The figure with one panel: curves and lines in it, their legend on its right.

use super::{Axis, Curve, Entry, Figure, Panel, Sample, Stroke, Words, figure};
use crate::report::ReportError;
use crate::report::image::typeset::Caption;

/// A line without marks: its label, its points, how it is drawn.
pub type Line = (String, Vec<(f64, f64)>, Stroke);

/// Draws the figure, 960 × 480 pixels. The curves are joined where `joined` is true: the x axis must then be ordered. Curves with
/// the same label and look that follow each other share one entry of the legend.
///
/// # Errors
/// If it cannot be drawn.
pub fn chart(
    [name, title]: [&str; 2],
    [x, y]: [Axis; 2],
    (curves, joined): (&[Curve], bool),
    lines: &[Line],
    caption: &Caption,
) -> Result<Figure, ReportError> {
    figure(name, 960, 480, caption, |page| {
        page.text(title, (24.0, 26.0), Words { size: 18.0, ..Words::default() })?;
        let panel = Panel::draw(page, "", [92.0, 56.0, 560.0, 370.0], x, y)?;
        for (_, path, stroke) in lines {
            path.windows(2).try_for_each(|ends| panel.line(ends[0], ends[1], *stroke))?;
        }
        curves.iter().try_for_each(|c| panel.curve(c, 0.0, joined))?;
        let mut marks: Vec<&Curve> = curves.iter().collect();
        marks.dedup_by_key(|c| &c.label);
        let paths = lines.iter().map(|(label, _, stroke)| Entry::new(Sample::Line(*stroke), label));
        let marks = marks.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label));
        page.legend((672.0, 66.0), 276.0, &paths.chain(marks).collect::<Vec<_>>()).map(|_| ())
    })
}
