//! The worked example of `CONTRIBUTING.md`: draws the terms against k. It is compiled and tested, but no command uses it.

use crate::report::ReportError;
use crate::report::image::typeset::Caption;
use crate::report::plot::{Axis, BLUE, Canvas, Curve, Drawn, Figure, Look, Panel, Point, Stroke, Words, figure};

/// Draws a curve of terms with its bound γ^k.
fn draw(terms: &Curve, gamma: f64, caption: &Caption) -> Result<Figure, ReportError> {
    figure("terms", 640, 460, caption, |page| panel(page, terms, gamma))
}

fn panel(page: &Canvas, terms: &Curve, gamma: f64) -> Drawn {
    page.text("Terms and their bound", (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    let last = terms.points.iter().map(|p| p.x).fold(1.0, f64::max);
    let x = Axis::counts("k", last as usize, 6);
    let y = Axis::log("‖TᵏE‖", terms.points.iter().flat_map(|p| [p.value, gamma.powf(p.x)]));
    let panel = Panel::draw(page, "", [84.0, 60.0, 520.0, 340.0], x, y)?;
    panel.line((0.0, 1.0), (last, gamma.powf(last)), Stroke::solid(BLUE, 1.6))?;
    panel.curve(terms, 0.0, true)
}

#[test]
fn it_is_drawn_with_its_command_below() -> Result<(), ReportError> {
    let point = |k: i32| Point { x: f64::from(k), value: 0.6f64.powi(k), std_error: 0.01, replicates: 16 };
    let terms = Curve { label: "prefix".into(), points: (0..6).map(point).collect(), look: Look::nth(0) };
    let caption = Caption { command: "fredholm series".into(), seed: 0, scene: "cornell".into() };
    let figure = draw(&terms, 0.7, &caption)?;
    assert!(figure.svg.contains("fredholm series") && figure.svg.contains("Terms and their bound"));
    Ok(())
}
