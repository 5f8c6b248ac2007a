//! What a run leaves behind: `terms.exr`, pictures, plots, `summary.json`, `index.html`.

use super::radiosity::Export;
use super::solve::Found;
use super::{Failure, output, strategies};
use fredholm::report::decay::{Decay, Rate, independent_ratios};
use fredholm::report::html::{Page, Plate};
use fredholm::report::plot::{Curve, Look, Point};
use fredholm::report::sheet::{self, Cell, Sheet, direct_and_indirect, single};
use fredholm::report::typeset::{Caption, superscript};
use fredholm::report::variance::{Falling, Variance};
use fredholm::report::{decay, exr, html, patches as mesh, picture, summary, variance, write_atomically, zmap};
use fredholm::scene::Description;
use fredholm::stats::{Limit, TermMeans, observed_rate, variance_slope};
use fredholm::terms::{Estimate, TermFilm, TermImage};
use fredholm::worlds::discrete::Discrete;
use fredholm::worlds::radius::radius_limit;
use fredholm::worlds::roulette;
use fredholm::worlds::sampled::{Estimator, Sampled};
use glam::DVec3;
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

fn terms_sheet(
    [w, h]: [u32; 2],
    images: &[Pixels],
    whole: Option<&Pixels>,
    caption: &Caption,
    note: &str,
) -> Result<Sheet, Failure> {
    let images: Vec<&[[f32; 3]]> = images.iter().map(Vec::as_slice).collect();
    Ok(sheet::terms(w as usize, h as usize, &images, whole.map(Vec::as_slice), note, caption)?)
}

/// Writes everything and returns the summary that was written.
pub fn all(found: &Found, export: Option<Export>) -> Result<summary::Summary, Failure> {
    let mut out = Files { folder: found.folder.clone(), names: vec![] };
    let caption =
        Caption { command: found.command.clone(), seed: found.settings.seed, scene: found.description.name.clone() };
    let size = found.description.camera.size;
    write_exr(found, &mut out, size)?;
    write_pictures(found, &mut out, size, &caption)?;
    if !found.strategies.is_empty() {
        out.names.extend(strategies::FILES.map(str::to_owned));
        strategies::write(&out.folder, &found.strategies, size.map(|s| s as usize), &caption, &attributes(found))?;
    }
    write_plots(found, &mut out, &caption)?;
    if let (Some(what), Some(r)) = (export, &found.radiosity) {
        write_mesh(r, what, &mut out)?;
    }
    out.names.push("index.html".into());
    out.names.push("summary.json".into());
    let summary = summarise(found, &out.names);
    write_page(found, &out, &summary)?;
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

/// What another program needs to check the matrix, or to use it.
fn write_mesh(r: &Discrete, what: Export, out: &mut Files) -> Result<(), Failure> {
    let m = &r.matrix;
    let patches = m.radiosity.patches();
    write_atomically(&out.add("mesh.csv"), mesh::mesh(patches, &m.solution.radiance).as_bytes())?;
    write_atomically(&out.add("mesh-terms.csv"), mesh::terms(&m.terms).as_bytes())?;
    let norms = summary::bounce_norms(patches, &m.terms);
    write_atomically(&out.add("norms.csv"), mesh::norms(&norms).as_bytes())?;
    if let (Export::Matrix, Some(dense)) = (what, m.radiosity.dense()) {
        write_atomically(&out.add("F.npy"), &mesh::npy(&dense.factors))?;
    }
    Ok(())
}

fn write_exr(found: &Found, out: &mut Files, size: [u32; 2]) -> Result<(), Failure> {
    let mut layers: Vec<(String, &Pixels)> = vec![];
    fn push<'a>(layers: &mut Vec<(String, &'a Pixels)>, name: &str, image: &'a TermImage) {
        layers.push((name.to_string(), &image.mean));
        layers.push((format!("{name}_se"), &image.std_error));
    }
    let beauty = found.path.as_ref().or(found.terms.first()).map(|s| &s.total);
    if let Some(image) = beauty.or(found.radiosity.as_ref().map(|r| &r.fine.total)) {
        layers.push((String::new(), &image.mean));
    }
    if let Some(t) = found.terms.first() {
        for (k, image) in t.terms.iter().enumerate() {
            push(&mut layers, &format!("T{k:02}"), image);
        }
        push(&mut layers, "Tsum", &t.sum);
        if !t.series.image().tail.is_none() {
            push(&mut layers, "tail", &t.tail);
            push(&mut layers, "Tall", &t.total);
        }
    }
    if let Some(p) = &found.path {
        push(&mut layers, "path", &p.total);
    }
    if let Some(r) = &found.radiosity {
        for (k, image) in r.fine.terms.iter().enumerate() {
            push(&mut layers, &format!("R{k:02}"), image);
        }
        push(&mut layers, "Rsum", &r.fine.sum);
        push(&mut layers, "Rfull", &r.fine.total);
    }
    if layers.is_empty() {
        return Ok(());
    }
    let layers: Vec<exr::Layer> = layers.iter().map(|(name, pixels)| exr::Layer { name, pixels }).collect();
    exr::write(&out.add("terms.exr"), size[0] as usize, size[1] as usize, &layers, &attributes(found))?;
    Ok(())
}

/// What an EXR says of how it was made; nothing that differs between two equal runs.
fn attributes(found: &Found) -> [(&'static str, String); 5] {
    [
        ("fredholm.command", found.command.clone()),
        ("fredholm.seed", found.settings.seed.to_string()),
        ("fredholm.spp", spp(found).to_string()),
        ("fredholm.scene_hash", found.hash.clone()),
        ("fredholm.version", env!("CARGO_PKG_VERSION").to_string()),
    ]
}

/// Samples per pixel that every world has: fewer than asked for when interrupted.
fn spp(found: &Found) -> u32 {
    let all = found.terms.iter().chain(&found.path).chain(found.radiosity.as_ref().map(|r| &r.fine));
    all.map(|s| s.spp).min().unwrap_or(0)
}

fn write_pictures(found: &Found, out: &mut Files, size: [u32; 2], caption: &Caption) -> Result<(), Failure> {
    let [w, h] = size.map(|s| s as usize);
    let shown = found.terms.first().or(found.radiosity.as_ref().map(|r| &r.fine));
    if let Some(s) = shown {
        for (k, image) in s.terms.iter().enumerate() {
            let (picture, _) = single(&format!("T{}E", superscript(k)), w, h, &image.mean, None)?;
            picture.picture.write(&out.add(&format!("T{k:02}.png")))?;
        }
        let means: Vec<Pixels> = s.terms.iter().map(|t| t.mean.clone()).collect();
        let note = format!("{}, {} spp", s.series.label, s.spp);
        terms_sheet(size, &means, Some(&s.total.mean), caption, &note)?.picture.write(&out.add("terms.png"))?;
        // partial sums at the exposure of the whole
        let gain = Some(whole_gain(&s.total.mean, s.terms.first()));
        let mut partial: Pixels = vec![[0.0; 3]; w * h];
        for (k, image) in s.terms.iter().enumerate() {
            add(&mut partial, &image.mean);
            if k == 1 {
                direct_and_indirect(w, h, &s.terms[0].mean, &partial, &s.total.mean, caption)?
                    .picture
                    .write(&out.add("direct.png"))?;
            }
            let (picture, _) = single(&format!("S{}", subscript(k)), w, h, &partial, gain)?;
            picture.picture.write(&out.add(&format!("partial_{k:02}.png")))?;
        }
    }
    if let Some(p) = &found.path {
        let gain = whole_gain(&p.total.mean, shown.and_then(|s| s.terms.first()));
        let (picture, _) = single("path tracer", w, h, &p.total.mean, Some(gain))?;
        picture.picture.write(&out.add("path.png"))?;
    }
    if let (Some(t), Some(p)) = (found.terms.first(), &found.path) {
        let z = z_values((&t.total.mean, &t.total.std_error), (&p.total.mean, &p.total.std_error));
        zmap::draw("z of the whole image: terms − path tracer", w, h, &z, caption)?.picture.write(&out.add("z.png"))?;
    }
    if let Some(r) = &found.radiosity {
        let gain = whole_gain(&r.fine.total.mean, r.fine.terms.first());
        let (picture, _) = single("radiosity", w, h, &r.fine.total.mean, Some(gain))?;
        picture.picture.write(&out.add("radiosity.png"))?;
    }
    if let (Some(t), Some(p), Some(r)) = (found.terms.first(), &found.path, &found.radiosity) {
        let gain = Some(whole_gain(&p.total.mean, t.terms.first()));
        let answers = [("the series: Σ TᵏE", t), ("the path tracer", p), ("the matrix: (I − T)⁻¹E", &r.fine)];
        let cells = answers.map(|(label, s)| Cell { label: label.into(), pixels: &s.total.mean, gain });
        sheet::grid("One scene, three answers", w, h, &cells, caption)?.picture.write(&out.add("three.png"))?;
    }
    Ok(())
}

/// The exposure of a whole image: without the lamps in view, where it is known where they are.
fn whole_gain(pixels: &Pixels, emission: Option<&TermImage>) -> f64 {
    emission.map_or_else(|| picture::auto_gain(pixels), |e| picture::auto_gain_beside_lamps(pixels, &e.mean))
}

fn subscript(k: usize) -> String {
    const DIGITS: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];
    k.to_string().bytes().map(|b| DIGITS[usize::from(b - b'0')]).collect()
}

fn add(sum: &mut Pixels, image: &Pixels) {
    for (s, v) in sum.iter_mut().zip(image) {
        (0..3).for_each(|c| s[c] += v[c]);
    }
}

/// z per pixel of the mean over channels of a − b; its error takes the channels as fully correlated, which they nearly are.
pub fn z_values(a: (&Pixels, &Pixels), b: (&Pixels, &Pixels)) -> Vec<f64> {
    let sum = |v: &[f32; 3]| v.iter().map(|&x| f64::from(x)).sum::<f64>();
    let z = |i: usize| {
        let errors = (sum(&a.1[i]), sum(&b.1[i]));
        let error = errors.0.hypot(errors.1);
        let difference = sum(&a.0[i]) - sum(&b.0[i]);
        // an error of 0 is that of a pixel that nothing has hit yet: not known
        if errors.0 > 0.0 && errors.1 > 0.0 { difference / error } else { f64::NAN }
    };
    (0..a.0.len()).map(z).collect()
}

fn write_plots(found: &Found, out: &mut Files, caption: &Caption) -> Result<(), Failure> {
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

fn summarise(found: &Found, files: &[String]) -> summary::Summary {
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
        discretisation: (fine.total.mean - coarse.total.mean).abs(),
    }
}

fn write_page(found: &Found, out: &Files, summary: &summary::Summary) -> Result<(), Failure> {
    let path = |name: &str| out.path(name);
    let [sheet, direct, decay, variance, z] =
        ["terms.png", "direct.png", "decay.svg", "variance.svg", "z.png"].map(path);
    let mut plates = vec![];
    let three = out.path("three.png");
    let candidates = [
        (
            "three.png",
            Plate {
                heading: "Three answers",
                text: "The same picture by three programs: the sum of the terms, the full path tracer, and the solution of a linear \
                       system over patches. One exposure for all.",
                alt: "The scene by the series, by the path tracer and by radiosity",
                path: &three,
            },
        ),
        ("terms.png", Plate::terms(&sheet)),
        ("direct.png", Plate::direct_and_indirect(&direct)),
        ("decay.svg", Plate::decay(&decay)),
        ("variance.svg", Plate::variance(&variance)),
        (
            "z.png",
            Plate {
                heading: "Where terms and path tracer differ",
                text: "The difference of the two images in units of its standard error, pixel by pixel. Noise has no pattern here; \
                       a bias would.",
                alt: "Map of the standardised difference between the sum of the terms and the path tracer",
                path: &z,
            },
        ),
    ];
    plates.extend(candidates.into_iter().filter(|(name, _)| out.has(name)).map(|(_, plate)| plate));
    let s = &found.settings;
    let facts = [
        ("seed", s.seed.to_string()),
        ("samples per pixel", summary.spp.to_string()),
        ("size", format!("{}×{}", summary.width, summary.height)),
        ("technique", s.technique.to_string()),
        ("roulette of the terms (q = termination)", s.roulette.to_string()),
        ("roulette of the path tracer", s.path_roulette.to_string()),
        ("scene hash", found.hash.clone()),
        ("seconds", format!("{:.1} on {} threads", summary.seconds, summary.threads)),
    ];
    let worlds = found.terms.iter().chain(&found.path).chain(found.radiosity.as_ref().map(|r| &r.fine));
    let page = Page {
        title: found.description.name.clone(),
        command: found.command.clone(),
        facts: facts.map(|(k, v)| (k.to_string(), v)).to_vec(),
        verdicts: &found.verdicts,
        plates,
        series: worlds.map(|s| (s.series.label.clone(), s.series.image())).collect(),
        files: out.names.iter().map(|n| (n.clone(), meaning(n).to_string())).collect(),
    };
    html::write(&out.path("index.html"), &page)?;
    Ok(())
}

fn meaning(name: &str) -> &'static str {
    match name {
        "terms.exr" => "every image with its standard error, float32, one layer each",
        "summary.json" => "every number of this page, for programs",
        "terms.png" => "contact sheet of the terms",
        "direct.png" => "direct light beside the whole",
        "path.png" => "the path tracer's image",
        "three.png" => "the three answers at one exposure",
        "radiosity.png" => "the matrix solution through the camera",
        "z.png" => "standardised difference, terms − path tracer",
        "index.html" => "this page",
        "mesh.csv" => "patches: centre, area, normal, albedo, E, L, corners",
        "mesh-terms.csv" => "T^k E of every patch",
        "norms.csv" => "norms of T^k E over the patches",
        "F.npy" => "form factors, n × n float32",
        n if n.starts_with("decay") => "decay of the terms",
        n if n.starts_with("variance") => "variance against samples per pixel",
        n if n.starts_with("partial") => "partial sum at the exposure of the whole",
        _ => "one term, auto-exposed",
    }
}
