//! What a run leaves behind: `terms.exr`, pictures, plots, `summary.json`, `index.html`.

mod mesh;
mod page;
mod pictures;
mod plots;

use super::radiosity::Export;
use super::solve::Solved;
use super::{Failure, output, strategies};
use fredholm::engine::by_matrix::Discrete;
use fredholm::engine::by_rays::Estimator;
use fredholm::engine::radius::radius_limit;
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::summary;
use fredholm::scene::Description;
use fredholm::stats::{Limit, TermMeans, observed_rate};
use fredholm::study::roulette;
use fredholm::terms::{Estimate, TermFilm, TermImage};
use glam::DVec3;
use pictures::terms_sheet;
pub use pictures::z_values;
use std::path::{Path, PathBuf};

type Pixels = Vec<[f32; 3]>;

/// Writes the contact sheet of the terms so far after every pass, so that there is something to look at.
pub fn preview(folder: &Path, d: &Description, command: &str, seed: u64) -> impl Fn(&TermFilm) + Sync + Send + use<> {
    let (folder, caption) = (folder.to_path_buf(), Caption { command: command.into(), seed, scene: d.name.clone() });
    move |film: &TermFilm| {
        let slots = film.shape.slots;
        // only the films of the terms; and only while waiting for the first picture matters
        if slots > 1 && film.least_samples() <= 64 {
            let images: Vec<Pixels> = (0..slots - 1).map(|s| TermImage::of(film, s..s + 1).mean).collect();
            // a preview that cannot be written is no reason to stop; the final files will say what is wrong
            let _ =
                terms_sheet(film.shape.size, &images, None, &caption, &format!("{} spp so far", film.least_samples()))
                    .and_then(|s| s.picture.write(&folder.join("terms.png")).map_err(Failure::from));
        }
    }
}

/// Writes everything and returns the summary that was written.
pub fn all(found: &Solved, export: Option<Export>) -> Result<summary::Summary, Failure> {
    let mut out = Files { folder: found.folder.clone(), names: vec![] };
    let caption =
        Caption { command: found.command.clone(), seed: found.settings.seed, scene: found.description.name.clone() };
    let size = found.description.camera.size;
    let trust = pictures::pixel_errors(found);
    pictures::write_exr(found, &trust, &mut out, size)?;
    pictures::write_pictures(found, &mut out, size, &caption)?;
    if !found.strategies.is_empty() {
        out.names.extend(strategies::FILES.map(str::to_owned));
        strategies::write(&out.folder, &found.strategies, size.map(|s| s as usize), &caption, &attributes(found))?;
    }
    plots::write_plots(found, &mut out, &caption)?;
    if let (Some(what), Some(r)) = (export, &found.radiosity) {
        mesh::write_mesh(r, what, &mut out)?;
    }
    out.names.push("index.html".into());
    out.names.push("summary.json".into());
    let summary = summary::Summary { pixel_errors: trust, ..summarise(found, &out.names) };
    page::write_page(found, &out, &summary)?;
    let old = output::left_by_the_last_run(&found.folder);
    summary::write(&out.path("summary.json"), &summary)?;
    output::remove_stale(&found.folder, &old, &out.names);
    Ok(summary)
}

struct Files {
    folder: PathBuf,
    names: Vec<String>,
}

impl Files {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
    fn add(&mut self, name: &str) -> PathBuf {
        self.names.push(name.to_string());
        self.path(name)
    }
    fn has(&self, name: &str) -> bool {
        self.names.iter().any(|n| n == name)
    }
}

/// What an EXR says of how it was made; nothing that differs between two equal runs.
fn attributes(found: &Solved) -> [(&'static str, String); 5] {
    [
        ("fredholm.command", found.command.clone()),
        ("fredholm.seed", found.settings.seed.to_string()),
        ("fredholm.spp", spp(found).to_string()),
        ("fredholm.scene_hash", found.hash.clone()),
        ("fredholm.version", env!("CARGO_PKG_VERSION").to_string()),
    ]
}

/// Samples per pixel that every world has: fewer than asked for when interrupted.
fn spp(found: &Solved) -> u32 {
    let all = found.terms.iter().chain(&found.path).chain(found.radiosity.as_ref().map(|r| &r.fine));
    all.map(|s| s.spp).min().unwrap_or(0)
}

fn summarise(found: &Solved, files: &[String]) -> summary::Summary {
    let size = found.description.camera.size;
    let first = found.terms.first();
    let image = first.map(|t| t.series.image());
    let last = first.and_then(|t| t.snapshots.last());
    let variance: Vec<DVec3> = last.map_or(vec![], |s| s.slots.iter().map(|v| v.channels * f64::from(s.spp)).collect());
    let g = found.scene.max_albedo().as_dvec3();
    let single = found.surface.iter().find(|s| s.0 == Estimator::Single);
    let fit = single.and_then(|(_, r)| observed_rate(&TermMeans::from(r)).ok());
    let all = found.terms.iter().chain(&found.path).chain(found.radiosity.iter().flat_map(|r| [&r.fine, &r.coarse]));
    summary::Summary {
        command: found.command.clone(),
        scene: found.description.name.clone(),
        scene_hash: found.hash.clone(),
        seed: found.settings.seed,
        spp: u64::from(spp(found)),
        max_bounces: found.settings.max_bounces,
        threads: found.threads,
        seconds: found.started.elapsed().as_secs_f64(),
        width: size[0] as usize,
        height: size[1] as usize,
        terms: image.map_or(vec![], |f| summary::terms(&f.terms, &variance, first.map_or(&[], |t| &t.rays))),
        tail: image.map_or(Estimate::NONE, |f| f.tail),
        sum: image.map_or(Estimate::NONE, |f| f.sum),
        path: found.path.as_ref().map(|p| p.series.image().total),
        radiosity: found.radiosity.as_ref().map(radiosity_summary),
        cross_moments: found.moments.as_ref().map(|m| summary::cross_moments(m, roulette::beyond(&found.scene))),
        bounds: summary::Bounds {
            max_albedo: g,
            observed_rate: fit.as_ref().map_or(f64::NAN, |f| f.rate),
            observed_rate_error: fit.as_ref().map_or(f64::NAN, |f| f.std_error),
            tail_bound: single.map_or(DVec3::NAN, |(_, r)| tail_bound(g, r.mean[r.mean.len() - 2])),
        },
        verdicts: found.verdicts.clone(),
        files: files.to_vec(),
        series: all.map(|s| s.series.clone()).collect(),
        ..summary::Summary::default()
    }
}

fn tail_bound(g: DVec3, last: DVec3) -> DVec3 {
    DVec3::select(g.cmplt(DVec3::ONE), g / (1.0 - g) * last, DVec3::NAN)
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
