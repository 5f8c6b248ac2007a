//! Collects what the page draws from a run.

use super::files::Files;
use super::pictures::{Layer, layers};
use super::plots::{decay_of, variance_of};
use fredholm::engine::by_rays::Sampled;
use fredholm::report::half_width_95;
use fredholm::report::image::exposure::Exposure;
use fredholm::report::page::data::{Bounds, Curve, Data, Image, Line, Plot, Slot};
use fredholm::report::plot;
use fredholm::report::text::sentence::sentence;
use fredholm::report::text::summary::Summary;
use fredholm::study::run::Run;
use fredholm::terms::{TermImage, Variance, World};

/// The images and numbers of a run.
pub(super) fn data<'a>(run: &'a Run, out: &Files, exposure: Exposure, summary: &Summary) -> Data {
    let mut data = Data::new(run.size().map(|s| s as usize));
    data.scene = run.description.name.clone();
    data.command = out.record.command.clone();
    data.gain = if exposure == Exposure::Auto { "each" } else { "one" };
    (data.seed, data.spp, data.max_bounces) = (run.settings.seed, summary.spp, run.settings.max_bounces);
    let mut images = vec![];
    for Layer { name, image, errors, of, slot } in layers(run) {
        let Some(slot) = slot else { continue };
        let world = of.series.world;
        let mut add = |id: &str, slot: Slot, image: &'a TermImage, mean: bool| {
            let mean = mean.then_some(image.mean.as_slice());
            let (id, trust, std_error) = (id.to_owned(), errors.clone(), image.std_error.as_slice());
            images.push(Image { id, world, slot, spp: of.spp, mean, std_error, trust, apart: apart(of, run) });
        };
        // the whole follows from its terms, but its error does not
        add(&name, slot, image, slot != Slot::Whole || world == World::Path);
        // the matrix knows what lies beyond K as well
        if world == World::Radiosity && slot == Slot::Whole {
            add("Rrest", Slot::Rest, &of.tail, true);
        }
    }
    data.push(&images);
    let before_the_end = run.early().iter().filter(|e| u64::from(e.spp) < summary.spp);
    let early = before_the_end.flat_map(|e| {
        let terms = e.terms.iter().enumerate().map(|(i, term)| (Slot::Term(i + 1), e.spp, term.as_slice()));
        terms.chain([(Slot::Whole, e.spp, e.whole.as_slice())])
    });
    data.push_early(&early.collect::<Vec<_>>());
    answers(run, &mut data);
    data.bounds = bounds(run, summary);
    data.decay = (!run.surface.is_empty() || run.radiosity.is_some()).then(|| decay(run));
    data.variance = variance(run);
    data.verdicts = run.verdicts.iter().map(|v| sentence(v.sides, &v.comparison)).collect();
    data
}

/// True if no two pixels share paths or points, so that the errors of pixels may be added.
fn apart(s: &Sampled, run: &Run) -> bool {
    s.tiles.apart && run.settings.points == fredholm::math::Points::default()
}

fn answers(run: &Run, data: &mut Data) {
    let shown = run.terms.first().into_iter().chain(&run.path).chain(run.radiosity.as_ref().map(|r| &r.fine));
    for s in shown {
        let world = s.series.world;
        let coarse = run.radiosity.as_ref().filter(|_| world == World::Radiosity);
        let mesh = coarse.map_or([0.0; 3], |r| {
            (r.fine.series.image().total.mean - r.coarse.series.image().total.mean).abs().to_array()
        });
        let variance = if world == World::Radiosity { Variance::Finite } else { s.series.variance };
        data.answer((world, s.series.label.as_str()), &s.replicates, &s.tiles, variance, mesh);
    }
}

/// The rate of the terms: of the matrix if there is one, else as observed.
fn bounds(run: &Run, summary: &Summary) -> Bounds {
    let known = |v: [f64; 3]| v.map(|r| (r.is_finite() && r > 0.0).then_some(r));
    let matrix = summary.radiosity.as_ref().map(|r| known(r.spectral_radius.to_array()));
    let (rate, rate_is) = match matrix {
        Some(rate) => (rate, "spectral radius of the matrix"),
        None => (known(summary.bounds.observed_rates.to_array()), "observed rate of the terms"),
    };
    Bounds { max_albedo: run.guaranteed_rate().to_array(), rate, rate_is: rate_is.into() }
}

fn curve(c: &plot::Curve, of: Option<(World, Slot)>) -> Curve {
    let half = |p: &plot::Point| Some(half_width_95(p.std_error, p.replicates)).filter(|h| h.is_finite());
    let points = c.points.iter().map(|p| [p.x, p.value, half(p).unwrap_or(0.0)]).collect();
    Curve { label: c.label.clone(), of, points }
}

fn decay(run: &Run) -> Plot {
    let figure = decay_of(run);
    let line = |l: &fredholm::report::figures::decay::RateLine| Line {
        label: l.label.clone(),
        x0: l.k0,
        value: l.value,
        ratio: l.ratio,
    };
    Plot {
        title: figure.title.clone(),
        curves: figure.surface.iter().map(|c| curve(c, None)).collect(),
        lines: figure.lines.iter().map(line).collect(),
    }
}

fn variance(run: &Run) -> Option<Plot> {
    let (figure, of) = variance_of(run);
    let curves: Vec<Curve> = figure.curves.iter().zip(of).map(|(f, of)| curve(&f.curve, Some(of))).collect();
    (!curves.is_empty()).then(|| Plot { title: figure.title, curves, lines: vec![] })
}
