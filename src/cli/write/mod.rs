//! The files that a run writes: `terms.exr`, pictures, plots, `summary.json`, `index.html`.

mod data;
mod files;
mod mesh;
mod page;
mod pictures;
mod plots;
mod strategies;

use super::base::Failure;
use files::{Files, Pixels};
use fredholm::engine::by_matrix::Discrete;
use fredholm::engine::radius::radius_limit;
use fredholm::report::figures::bounces;
use fredholm::report::image::exposure::Exposure;
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::summary::{self, Summary};
use fredholm::stats::{Limit, Rate};
use fredholm::study::lit::Lit;
use fredholm::study::roulette;
use fredholm::study::run::Run;
use fredholm::terms::{Estimate, TermFilm, image};
use glam::DVec3;
pub use mesh::Export;
use pictures::terms_sheet;
pub use pictures::z_values;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A preview is drawn if the start, or the last one, is at least this long ago. A sheet takes some hundredths of a second to draw,
/// so that previews cost about a percent of the run, and a run that ends soon draws none.
const BETWEEN: Duration = Duration::from_secs(2);

/// Writes a preview after a pass: the contact sheet of the terms so far.
pub fn preview(folder: &Path, caption: Caption, exposure: Exposure) -> impl Fn(&TermFilm) + Sync + Send + use<> {
    let (folder, last) = (folder.to_path_buf(), Mutex::new(Instant::now()));
    move |film: &TermFilm| {
        let slots = film.shape.slots;
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        // a film of the path tracer has one slot and no terms
        if slots > 1 && last.elapsed() >= BETWEEN {
            let images: Vec<Pixels> = image::means(film, 0..slots - 1);
            // an error is ignored here, because writing the final files reports the same error
            let _ = terms_sheet(
                exposure,
                film.shape.size,
                &images.iter().map(Vec::as_slice).collect::<Vec<_>>(),
                None,
                &caption,
                &format!("{} spp so far", film.least_samples()),
            )
            .and_then(|s| s.picture.write(&folder.join("terms.png")).map_err(Failure::from));
            *last = Instant::now();
        }
    }
}

/// Writes all files of a run into a folder and returns the complete record. `record` gives its common part.
pub fn all(
    run: &Run,
    folder: &Path,
    export: Option<Export>,
    exposure: Exposure,
    record: impl Fn() -> Summary,
) -> Result<Summary, Failure> {
    let Summary { command, seed, scene, .. } = record();
    let caption = Caption { command, seed, scene };
    let mut out = Files { folder: folder.to_path_buf(), names: vec![], record: record(), jobs: vec![] };
    let size = run.size();
    let trust = pictures::pixel_errors(run);
    pictures::write_exr(run, &trust, &mut out);
    pictures::write_pictures(run, &mut out, size, exposure, &caption);
    if !run.strategies.is_empty() {
        out.names.extend(strategies::FILES.map(str::to_owned));
        let (attributes, caption) = (out.attributes(run), &caption);
        let write = move || strategies::write(folder, &run.strategies, size.map(|s| s as usize), caption, &attributes);
        out.jobs.push(Box::new(write));
    }
    plots::write_plots(run, &mut out, &caption);
    if let (Some(what), Some(r)) = (export, &run.radiosity) {
        mesh::write_mesh(r, what, &mut out)?;
    }
    out.make()?;
    out.names.push("index.html".into());
    out.names.push("summary.json".into());
    let files = out.names.clone();
    let summary = Summary { pixel_errors: trust, files, ..summarise(run, record()) };
    page::write_page(run, &out, exposure, &summary)?;
    Ok(summary)
}

/// The record of a run.
fn summarise(run: &Run, record: Summary) -> Summary {
    let first = run.terms.first();
    let image = first.map(|t| t.series.image());
    let last = first.and_then(|t| t.snapshots.last());
    let variance: Vec<DVec3> = last.map_or(vec![], |s| s.slots.iter().map(|v| v.channels * f64::from(s.spp)).collect());
    let fit = run.observed_rate().and_then(Result::ok);
    let by_channel = [0, 1, 2].map(|c| run.observed_rate_in(c).and_then(Result::ok));
    let rates = |of: &dyn Fn(&Rate) -> f64| {
        DVec3::from_array(by_channel.each_ref().map(|fit| fit.as_ref().map_or(f64::NAN, of)))
    };
    let albedo = run.guaranteed_rate().max_element();
    let surface = |s: &Lit| summary::Surface { name: s.name.clone(), area: s.area, shares: s.shares() };
    Summary {
        spp: u64::from(run.spp()),
        max_bounces: run.settings.max_bounces,
        terms: image.map_or(vec![], |f| summary::terms(&f.terms, &variance, first.map_or(&[], |t| &t.rays))),
        tail: image.map_or(Estimate::NONE, |f| f.tail),
        sum: image.map_or(Estimate::NONE, |f| f.sum),
        path: run.path.as_ref().map(|p| p.series.image().total),
        radiosity: run.radiosity.as_ref().map(radiosity_summary),
        bounces: run.bounces.as_ref().map_or(vec![], |b| bounces::records(b, albedo, run.bounds_from())),
        surfaces: run.lit.iter().map(surface).collect(),
        cross_moments: run.moments.as_ref().map(|m| summary::cross_moments(m, roulette::beyond(&run.scene))),
        bounds: summary::Bounds {
            max_albedo: run.guaranteed_rate(),
            observed_rate: fit.as_ref().map_or(f64::NAN, |f| f.rate),
            observed_rate_error: fit.as_ref().map_or(f64::NAN, |f| f.std_error),
            observed_rates: rates(&|fit| fit.rate),
            observed_rate_errors: rates(&|fit| fit.std_error),
            tail_bound: run.tail_bound().unwrap_or(DVec3::NAN),
        },
        verdicts: run.verdicts.iter().flat_map(|v| summary::verdicts(v.name, &v.comparison)).collect(),
        series: run.results().chain(run.radiosity.as_ref().map(|r| &r.coarse)).map(|s| s.series.clone()).collect(),
        ..record
    }
}

fn radiosity_summary(r: &Discrete) -> summary::Radiosity {
    let (fine, coarse) = (r.fine.series.image(), r.coarse.series.image());
    let limit = radius_limit(&r.radii);
    let of = |f: &dyn Fn(&Limit) -> f64| limit.map_or(DVec3::NAN, |l| DVec3::from_array(l.each_ref().map(f)));
    summary::Radiosity {
        patches: r.matrix.radiosity.patches().len(),
        terms: fine.terms.iter().map(|t| t.mean).collect(),
        sum: fine.sum.mean,
        full: fine.total.mean,
        spectral_radius: DVec3::from_array([0, 1, 2].map(|c| r.matrix.spectral[c].radius)),
        spectral_radius_limit: of(&|l| l.value),
        spectral_radius_limit_error: of(&|l| l.half_width),
        norms: summary::bounce_norms(r.matrix.radiosity.patches(), &r.matrix.terms),
        unlit_sides: r.matrix.unlit.len(),
        discretisation: (fine.total.mean - coarse.total.mean).abs(),
    }
}
