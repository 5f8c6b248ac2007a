//! The figures of a run: how the terms decay, and how the noise falls.

use super::Files;
use crate::cli::{Failure, solve::Found};
use fredholm::report::decay::{self, Decay, Rate, independent_ratios};
use fredholm::report::plot::{Curve, Look, Point};
use fredholm::report::typeset::{Caption, superscript};
use fredholm::report::variance::{self, Falling, Variance};
use fredholm::stats::{TermMeans, observed_rate, variance_slope};
use fredholm::worlds::discrete::Discrete;
use fredholm::worlds::sampled::{Estimator, Sampled};
use std::path::Path;

pub(super) fn write_plots(found: &Found, out: &mut Files, caption: &Caption) -> Result<(), Failure> {
    if found.surface.is_empty() && found.radiosity.is_none() {
        return write_variance(found, out, caption);
    }
    let mut figure = Decay { title: "How the terms decay".into(), ..Decay::default() };
    for (estimator, r) in &found.surface {
        let look = if *estimator == Estimator::Single { Look::SINGLE } else { Look::PREFIX };
        let means = TermMeans::from(r);
        let points = decay::norms(&means);
        let ratios = match estimator {
            Estimator::Single => independent_ratios(&points),
            _ => decay::ratios(&means),
        };
        figure.ratios.push(Curve { label: estimator.to_string(), points: ratios, look });
        figure.surface.push(Curve { label: format!("Monte Carlo, {estimator}"), points, look });
    }
    if let Some(r) = &found.radiosity {
        let points = decay::norms(&TermMeans::exact(&matrix_norms(r)));
        figure.ratios.push(Curve { label: "matrix".into(), points: independent_ratios(&points), look: Look::MATRIX });
        figure.surface.push(Curve {
            label: format!("matrix, {} patches", r.matrix.radiosity.patches().len()),
            points,
            look: Look::MATRIX,
        });
    }
    figure.lines = lines(found);
    for s in found.terms.iter() {
        let look = if s.series.label.starts_with("single") { Look::SINGLE } else { Look::PREFIX };
        let point = |(k, n): (usize, &Option<fredholm::terms::norms::SquaredNorm>)| {
            let n = (*n)?;
            // √ of an unbiased square, its error by the delta method; a negative square is drawn as an upper limit
            let value = n.value.max(0.0).sqrt();
            let std_error = if value > 0.0 { 0.5 * n.std_error / value } else { n.std_error.sqrt() };
            Some(Point { x: k as f64, value, std_error, replicates: 16 })
        };
        let points = s.norms.iter().enumerate().filter_map(point).collect();
        figure.image.push(Curve { label: s.series.label.clone(), points, look });
    }
    for path in decay::draw(&figure, caption)?.write(&out.folder, "decay")? {
        out.names.push(name_of(&path));
    }
    write_variance(found, out, caption)
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Observed rate, guarantee, tail bound and spectral radius.
fn lines(found: &Found) -> Vec<Rate> {
    let mut lines = vec![];
    let g = f64::from(found.scene.max_albedo().max_element());
    if let Some((_, r)) = found.surface.iter().find(|s| s.0 == Estimator::Single) {
        let means = TermMeans::from(r);
        lines.extend(observed_rate(&means).ok().as_ref().map(Rate::observed));
        lines.push(Rate::guaranteed(g, means.mean[0]));
        let k = means.mean.len() - 1;
        lines.extend(Rate::tail_bound(g, k, means.mean[k]));
    }
    if let Some(r) = &found.radiosity {
        let radius = r.matrix.spectral.iter().map(|s| s.radius).fold(0.0, f64::max);
        lines.extend(Rate::spectral(radius, &matrix_norms(r)));
    }
    lines
}

/// The mean over channels of `‖T_h^k E‖₁`.
fn matrix_norms(r: &Discrete) -> Vec<f64> {
    r.matrix.surface.iter().map(|v| v.element_sum() / 3.0).collect()
}

fn write_variance(found: &Found, out: &mut Files, caption: &Caption) -> Result<(), Failure> {
    let mut figure = Variance { title: "How the noise falls".into(), curves: vec![] };
    let mut curve =
        |label: String,
         s: &Sampled,
         of: &dyn Fn(&fredholm::terms::variance::Snapshot) -> fredholm::terms::variance::Variance| {
            let point = |snap: &fredholm::terms::variance::Snapshot| {
                let v = of(snap);
                let replicates = s.series.image().total.replicates;
                Point { x: f64::from(snap.spp), value: v.value, std_error: v.std_error, replicates }
            };
            let points: Vec<Point> =
                s.snapshots.iter().map(point).filter(|p| p.value > 0.0 && p.value.is_finite()).collect();
            // the variance of many pixels is known better than from R − 1 degrees of freedom: those that give its error
            let dof = points.last().map_or(15.0, |p| 2.0 * (p.value / p.std_error).powi(2));
            let slope = variance_slope(&points.iter().map(|p| (p.x, p.value)).collect::<Vec<_>>(), dof)
                .map(|s| (s.slope, s.std_error));
            if !points.is_empty() {
                let look = Look::nth(figure.curves.len());
                figure.curves.push(Falling { curve: Curve { label, points, look }, slope });
            }
        };
    if let Some(s) = found.terms.first() {
        curve(format!("Σ, {}", s.series.label), s, &|snap| snap.total);
        for k in 0..s.terms.len() {
            curve(format!("T{}E", superscript(k)), s, &|snap| snap.slots[k]);
        }
    }
    if let Some(p) = &found.path {
        curve("path tracer".into(), p, &|snap| snap.total);
    }
    if !figure.curves.is_empty() {
        for path in variance::draw(&figure, caption)?.write(&out.folder, "variance")? {
            out.names.push(name_of(&path));
        }
    }
    Ok(())
}
