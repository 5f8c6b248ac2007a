//! The figures of a run: how the terms decay, and how the noise falls.

use super::files::Files;
use fredholm::engine::by_rays::{Estimator, Sampled};
use fredholm::math::CHANNELS;
use fredholm::report::figures::decay::{self, Decay, RateLine, independent_ratios};
use fredholm::report::figures::variance::{self, Falling, Variance};
use fredholm::report::image::typeset::{Caption, superscript};
use fredholm::report::page::data::Slot;
use fredholm::report::plot::{Curve, Look, Point};
use fredholm::stats::TermMeans;
use fredholm::study::convergence::NoiseCurve;
use fredholm::study::run::Run;
use fredholm::terms::{World, scatter::Scatter, variance::Snapshot};

pub(super) fn write_plots<'a>(run: &'a Run, out: &mut Files<'a>, caption: &'a Caption) {
    if !run.surface.is_empty() || run.radiosity.is_some() {
        out.figure("decay", move || decay::draw(&decay_of(run), caption));
    }
    let (figure, _) = variance_of(run);
    if !figure.curves.is_empty() {
        out.figure("variance", move || variance::draw(&figure, caption));
    }
}

pub(super) fn decay_of(run: &Run) -> Decay {
    // one channel for all of it, so that the measured rate can be compared with the spectral radius
    let c = run.slowest_channel();
    let title = format!("How the terms decay, in the {} channel", CHANNELS[c]);
    let mut figure = Decay { title, ..Decay::default() };
    for (estimator, r) in &run.surface {
        let look = if *estimator == Estimator::Single { Look::SINGLE } else { Look::PREFIX };
        let means = TermMeans::channel(r, c);
        let points = decay::norms(&means);
        let ratios = match estimator {
            Estimator::Single => independent_ratios(&points),
            _ => decay::ratios(&means),
        };
        figure.ratios.push(Curve { label: estimator.to_string(), points: ratios, look });
        figure.surface.push(Curve { label: format!("Monte Carlo, {estimator}"), points, look });
    }
    if let (Some(r), Some(matrix)) = (&run.radiosity, run.norms_of_matrix_in(c)) {
        let points = decay::norms(&TermMeans::exact(&matrix));
        figure.ratios.push(Curve { label: "matrix".into(), points: independent_ratios(&points), look: Look::MATRIX });
        figure.surface.push(Curve {
            label: format!("matrix, {} patches", r.matrix.radiosity.patches().len()),
            points,
            look: Look::MATRIX,
        });
    }
    figure.lines = lines(run, c);
    for s in run.terms.iter() {
        let look = if s.series.label.starts_with("single") { Look::SINGLE } else { Look::PREFIX };
        let point = |(k, n): (usize, &Option<fredholm::terms::norms::SquaredNorm>)| {
            let n = (*n)?;
            // the square is unbiased; the error of its root follows by the delta method; a negative square becomes an upper limit
            let value = n.value.max(0.0).sqrt();
            let std_error = if value > 0.0 { 0.5 * n.std_error / value } else { n.std_error.sqrt() };
            Some(Point { x: k as f64, value, std_error, replicates: 16 })
        };
        let points = s.norms.iter().enumerate().filter_map(point).collect();
        figure.image.push(Curve { label: s.series.label.clone(), points, look });
    }
    figure
}

/// The straight lines of the decay plot: observed rate, guaranteed bound, bound of the tail, spectral radius.
fn lines(run: &Run, c: usize) -> Vec<RateLine> {
    let mut lines = vec![];
    let g = run.guaranteed_rate()[c];
    if let Some(r) = run.norms() {
        let means = TermMeans::channel(r, c);
        lines.extend(run.observed_rate_in(c).and_then(Result::ok).as_ref().map(RateLine::observed));
        lines.push(RateLine::guaranteed(g, means.mean[0]));
        let k = means.mean.len() - 1;
        lines.extend(RateLine::tail_bound(g, k, means.mean[k]));
    }
    if let (Some(r), Some(matrix)) = (&run.radiosity, run.norms_of_matrix_in(c)) {
        let radius = r.matrix.spectral[c].radius;
        lines.extend(RateLine::spectral(radius, &matrix));
    }
    lines
}

/// The figure, and for each of its curves the image that it belongs to.
pub(super) fn variance_of(run: &Run) -> (Variance, Vec<(World, Slot)>) {
    let mut images = vec![];
    let mut figure = Variance { title: "How the noise falls".into(), curves: vec![] };
    // one slot of the snapshots, or with no slot their sum
    let mut curve = |label: String, s: &Sampled, slot: Option<usize>| {
        let at = |snap: &Snapshot| Some((snap.spp, snap.scatter.get(slot.unwrap_or(snap.scatter.len() - 1))?.clone()));
        let variance = if slot.is_none() { s.series.variance } else { Default::default() };
        let part = NoiseCurve { name: label.clone(), points: s.snapshots.iter().filter_map(at).collect(), variance };
        let replicates = s.series.image().total.replicates;
        let point = |(spp, scatter): &(u32, Scatter)| {
            let v = fredholm::terms::variance::Variance::from(scatter);
            Point { x: f64::from(*spp), value: v.value, std_error: v.std_error, replicates }
        };
        let points: Vec<Point> =
            part.points.iter().map(point).filter(|p| p.value > 0.0 && p.value.is_finite()).collect();
        if !points.is_empty() {
            let look = Look::nth(figure.curves.len());
            let slope = part.slope().map(|s| (s.slope, s.std_error));
            images.push((s.series.world, slot.map_or(Slot::Whole, Slot::Term)));
            figure.curves.push(Falling { curve: Curve { label, points, look }, slope });
        }
    };
    if let Some(s) = run.terms.first() {
        curve(format!("Σ, {}", s.series.label), s, None);
        for k in 0..s.terms.len() {
            curve(format!("T{}E", superscript(k)), s, Some(k));
        }
    }
    if let Some(p) = &run.path {
        curve("path tracer".into(), p, None);
    }
    (figure, images)
}
