//! Sentences that stand beside the tables of a run: its verdict, facts about the matrix and the decay, warnings.

use fredholm::engine::by_matrix::{Discrete, Unlit};
use fredholm::engine::by_rays::Estimator;
use fredholm::engine::discretisation::{Difference, SampledRows};
use fredholm::engine::guided::Prepared;
use fredholm::engine::known::growth;
use fredholm::estimator::Roulette;
use fredholm::guide::warp::CELLS;
use fredholm::report::figures::extrapolation::{self, Measured};
use fredholm::report::figures::refine::limit_words;
use fredholm::report::text::grid::Grid;
use fredholm::report::text::number::{average, plus_minus, significant};
use fredholm::scene::{Description, bsdf};
use fredholm::stats::Evidence;
use fredholm::stats::evidence::{JUDGED, SHOWN};
use fredholm::study::run::Run;
use fredholm::terms::functional::Replicates;
use fredholm::terms::{Estimate, Series};
use glam::DVec3;
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Why there is no verdict, and what to do about it.
pub fn undecided(why: &str) -> String {
    format!(
        "No verdict: {why}, so the image is undefined there.\nMove one of them by a thousandth of the size of the scene, or remove it."
    )
}

/// Facts about the matrix: row sums, reciprocity, residual, spectral radius, mesh error, norms, areas.
pub fn matrix_facts(r: &Discrete) -> String {
    let m = &r.matrix;
    let i = &m.invariants;
    let rho = m.spectral.each_ref().map(|s| format!("{:.5}", s.radius)).join(", ");
    let reciprocity = match &m.sampling {
        None => format!("reciprocity {:.1e}", i.reciprocity),
        Some(s) => {
            let c = &s.checks;
            format!("reciprocity {:.1e} (z = {:.1})", c.reciprocity, c.reciprocity_z)
        }
    };
    let d = (r.fine.series.image().total.mean - r.coarse.series.image().total.mean).abs();
    let mut out = format!(
        "The matrix. Form factors F: row sums {:.6} to {:.6}, entries {:.1e} to {:.4},\n\
         {reciprocity}; residual of the solve {:.1e};\n\
         spectral radius ({rho})\n{}\
         change of the image mean from the coarser mesh, |R_h − R_2h|: {:.1e}",
        i.row_sum_min,
        i.row_sum_max,
        i.smallest,
        i.largest,
        m.solution.residual.max_element(),
        limit_words(&r.radii).map_or(String::new(), |l| l + "\n"),
        d.element_sum() / 3.0
    );
    if let Some(s) = &m.sampling {
        out += &format!("\n{}", sampling(s));
    }
    if let Some(norms) = &m.norms {
        let norms = norms.each_ref().map(|(one, inf)| format!("{one:.4}/{inf:.4}")).join(", ");
        out += &format!("\n‖T_h‖₁/‖T_h‖∞ in red, green, blue: {norms}");
    }
    let p = m.radiosity.patches();
    out += &format!(
        "\nsurface {:.4} m², covered {:.4} m²; {} {}",
        p.surface_area(),
        p.covered_area(),
        if m.sampling.is_some() { "rays" } else { "visibility rays" },
        m.radiosity.rays()
    );
    out += "\nThe matrix enters the picture from k = 2 on: the picture of T¹ E gathers E itself.";
    out
}

/// The line that states the error of the solution when form factors are estimated from stored rays.
fn sampling(s: &SampledRows) -> String {
    let mut out = format!(
        "{} rays per patch: relative L² error of L − E over the patches {:.1e}; {} steps of the solver",
        s.per_row,
        s.noise.element_sum() / 3.0,
        s.steps
    );
    if s.checks.lost > 0.0 {
        out += &format!(
            "\nA fraction {:.1e} of the rays hit a surface where there is no patch; their light is lost.",
            s.checks.lost
        );
    }
    out
}

/// The difference between stored rays and the matrix on the same patches.
pub fn difference(d: &Difference) -> String {
    format!(
        "Stored rays on the same patches: L − E differs from the matrix by {:.1e} (relative L²);\n\
         their spectral radius ({})\n{}",
        d.of_u.element_sum() / 3.0,
        d.spectral.each_ref().map(|s| format!("{:.5}", s.radius)).join(", "),
        sampling(&d.sampling)
    )
}

/// The line that describes the guide: its number of patches and rays, and the seconds of its preparation.
pub fn guide(g: &Prepared) -> String {
    let r = g.recipe;
    format!(
        "guide: radiosity of {} patches with {} rays each, prepared in {:.2} s; {:.0} % of the directions follow the cosine alone",
        g.guide.len(),
        r.fineness.rays * CELLS * CELLS,
        g.time.as_secs_f64(),
        100.0 * r.bsdf
    )
}

/// The observed rate of the surface norm, averaged over the channels, and its guaranteed bound.
pub fn decay_facts(run: &Run) -> Option<String> {
    Some(match run.observed_rate()? {
        Ok(f) => {
            // a line through two terms always fits, so there is no p value
            let p = if f.p.is_finite() { format!("p = {:.2}", f.p) } else { "two terms, so no p".into() };
            let (first, last) = (f.window.start, f.window.end - 1);
            format!(
                "observed rate of the surface norm, mean of the channels: {:.4} ± {:.4} (k = {first} to {last}, {p})\nguaranteed: ‖T‖₁ ≤ {:.4}",
                f.rate,
                f.std_error,
                run.guaranteed_rate().max_element()
            )
        }
        Err(why) => format!("no rate fitted: {}", why.to_string().replace("; ", ";\n")),
    })
}

/// Extrapolation of the whole from the first half of the terms, in the channel in which they fall most slowly.
pub fn extrapolated(run: &Run) -> Option<String> {
    let last = run.settings.max_bounces / 2 + 1;
    // two terms are too few to extrapolate; without a tail, or without its error, there is nothing to compare with
    let doubted = run.terms.iter().any(|t| t.series.variance != fredholm::terms::Variance::Finite);
    if last < 3 || run.surface.is_empty() || doubted || !run.settings.roulette.ends() {
        return None;
    }
    let rests = |r: &Replicates| (1..=last).find_map(|k| Some((k, Evidence::of(&r.estimate(k..k + 1)).no_error?)));
    if let Some((k, why)) = run.surface.iter().find_map(|(_, r)| rests(r)) {
        return Some(format!("The terms are not extrapolated, because the mean of T{k} has no error: {why}."));
    }
    let radii = run.radiosity.as_ref().map(|r| r.matrix.spectral.each_ref().map(|s| s.radius));
    let by = radii.unwrap_or(run.scene.max_albedo().as_dvec3().to_array());
    let slowest = DVec3::from_array(by).max_position();
    let measured = |(estimator, r): &(Estimator, Replicates)| {
        let n = r.mean.len() - 1;
        Measured {
            label: estimator.to_string(),
            mean: r.mean[1..].iter().map(|m| m[slowest]).collect(),
            covariance: DMatrix::from_fn(n, n, |i, j| r.covariance(i + 1, j + 1)[slowest]),
            used: last,
        }
    };
    let measured: Vec<Measured> = run.surface.iter().map(measured).collect();
    let rate = radii.map_or(f64::NAN, |r| r[slowest]);
    let note = if rate.is_nan() { "" } else { "; the known rate is the spectral radius" };
    Some(format!(
        "Extrapolation of L − E from its terms k = 1 to {last} (mean over all surfaces, {}, relative to the measured L − E).\n\
         off: error; noise: standard error; gain: noise relative to the plain sum{note}.\n{}",
        fredholm::math::CHANNELS[slowest],
        extrapolation::table(&measured, rate)
    ))
}

/// The order of convergence of the radiosity, term by term, with the change on the finest mesh.
pub fn orders(run: &Run) -> Option<Grid> {
    let (whole, _) = run.order(None)?;
    let sizes =
        run.meshes.iter().map(|m| m.series.label.split(' ').nth(1).unwrap_or("?")).collect::<Vec<_>>().join(", ");
    let sentence = format!(
        "How fast does the matrix converge? Change of the picture from the second mesh to\n\
         the finest, and the order p in error ~ h^p, from {sizes} patches."
    );
    let mut grid = Grid::new(sentence, ["k", "mean", "change", "order"]);
    let image = run.meshes.last()?.series.image();
    let mut row = |name: String, mean: &Estimate, k: Option<usize>| {
        let change = run.last_change(k).map_or_else(String::new, |c| significant(c, 2));
        let order = run.order(k).filter(|o| o.0.is_finite());
        let order = order.map_or("–".into(), |(order, error)| match error {
            // an order whose error is as large as itself is none
            e if e.is_nan() || e > order.abs() => "not resolved".into(),
            e => plus_minus(order, e, 1),
        });
        grid.push([name, significant(average(mean).0, 4), change, order]);
    };
    for (k, term) in image.terms.iter().enumerate().skip(2) {
        row(k.to_string(), term, Some(k));
    }
    if whole.is_finite() {
        row("all".into(), &image.total, None);
    }
    Some(grid)
}

/// For each result whose estimator finds some light only by chance: what that light is, and how often it is expected.
pub fn doubts<'a>(results: impl Iterator<Item = &'a Series>) -> Vec<String> {
    let of = |s: &'a Series| {
        let thin = s.doubts.iter().filter(|d| s.expected(d) < JUDGED).map(|d| (d, s.expected(d)));
        let worst = thin.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let (what, from) = (&worst.0.what, worst.0.from);
        Some(format!(
            "{}: some light is found only by chance ({what}).\n\
             {:.1} such hits are expected from k = {from} on; a ± needs {SHOWN}, a verdict {JUDGED}",
            s.label, worst.1
        ))
    };
    results.filter_map(of).collect()
}

/// If the whole picture is black: how many paths found no light, and what the camera sees.
pub fn black(run: &Run) -> Option<String> {
    run.results().next()?;
    if !run.results().all(|s| s.series.image().total.mean == DVec3::ZERO) {
        return None;
    }
    let paths: u64 = run.sampled().map(|s| s.series.cost.paths).sum();
    Some(format!("every pixel is black: none of {paths} paths found any light.\n{}", seen_by_the_camera(run)))
}

/// The surfaces that the camera sees, by name and side, with their distances: the three that fill most of the picture.
fn seen_by_the_camera(run: &Run) -> String {
    const NAMED: usize = 3;
    let camera = &run.scene.camera;
    let pixels = camera.size[0] * camera.size[1];
    let primitives = run.description.primitives();
    let mut seen: BTreeMap<(usize, bool), (u32, f64, f64)> = BTreeMap::new();
    for p in 0..pixels {
        let (start, direction) = camera.ray(p, [0.5; 2]);
        let Some(v) = run.scene.look(start, direction).filter(|v| v.on_surface()) else { continue };
        let Some((shape, _)) = primitives.get((v.side / 2) as usize) else { continue };
        let distance = v.p.as_dvec3().distance(camera.origin);
        let (count, near, far) = seen.entry((*shape, v.side % 2 == 1)).or_insert((0, f64::INFINITY, 0.0));
        (*count, *near, *far) = (*count + 1, near.min(distance), far.max(distance));
    }
    let mut all: Vec<_> = seen.into_iter().collect();
    all.sort_by_key(|(_, (count, ..))| std::cmp::Reverse(*count));
    let words = |((shape, back), (count, near, far)): &((usize, bool), (u32, f64, f64))| {
        let side = if *back { "back" } else { "front" };
        let name = &run.description.shapes[*shape].name;
        format!("the {side} of {name} ({count} of {pixels} pixels, {near:.3} to {far:.3} m away)")
    };
    if all.is_empty() {
        return "The camera sees no surface: all its rays leave the scene. Does it look the wrong way?".into();
    }
    let names: Vec<String> = all.iter().take(NAMED).map(words).collect();
    let more = if all.len() > NAMED { ", and others" } else { "" };
    format!("The camera sees only surfaces without light: {}{more}", names.join(", "))
}

/// A warning for each result with samples that are not finite.
pub fn not_finite(all: &[Series]) -> String {
    let broken = all.iter().filter(|s| s.cost.non_finite > 0);
    let lines = broken.map(|s| format!("warning: {}: {} samples were not finite", s.label, s.cost.non_finite));
    lines.collect::<Vec<_>>().join("\n")
}

/// Everything that a reader must know before trusting an error bar.
pub fn warnings(run: &Run) -> Vec<String> {
    let mut out = vec![];
    out.extend(black(run));
    out.extend(doubts(run.sampled().map(|s| &s.series)));
    for s in run.results().filter(|s| s.series.cost.non_finite > 0) {
        out.push(format!(
            "{}: {} samples were infinite or not a number; the sums contain them",
            s.series.label, s.series.cost.non_finite
        ));
    }
    if let Some(r) = run.radiosity.as_ref().filter(|r| r.matrix.invariants.row_sum_max > 1.01) {
        out.push(format!(
            "the mesh is too coarse: the form factors of one patch add up to {:.3} instead of at most 1;\nraise --patches",
            r.matrix.invariants.row_sum_max
        ));
    }
    out.extend(preparation(run));
    out.extend(variances(run));
    out
}

/// With `--guide` and `--time`: says so if preparing the guide took most of the time.
fn preparation(run: &Run) -> Option<String> {
    let (guide, time) = (run.guide.as_ref()?, run.settings.time?);
    let (spent, given) = (guide.time.as_secs_f64(), time.as_secs_f64());
    if spent < 0.5 * given {
        return None;
    }
    let part = if spent >= given { "all".into() } else { format!("{:.0} %", 100.0 * spent / given) };
    Some(format!(
        "preparing the guide took {spent:.1} s, {part} of the {given:.1} s for the samples, so only {} samples per pixel were\n\
         rendered; give more --time, or a smaller guide with --patches",
        run.spp()
    ))
}

/// The results without an error bar, because their variance is infinite or not known, and a setting that gives one.
fn variances(run: &Run) -> Vec<String> {
    let s = &run.settings;
    let safe = if run.guide.is_some() {
        "render without --guide"
    } else if growth::proved(&run.scene, s.sampling, &Roulette::Albedo { from: 0 }) {
        "use --roulette albedo, whose variance is finite here"
    } else if s.sampling == bsdf::Sampling::Uniform {
        "render without --sampling uniform"
    } else {
        "try --roulette albedo"
    };
    let terms = run.terms.iter().map(|t| ("the tail of the terms", &s.roulette, t));
    let path = run.path.iter().map(|p| ("the path tracer", &s.path_roulette, p));
    let mut out: Vec<String> = vec![];
    for (who, roulette, result) in terms.chain(path) {
        if let Some(what) = result.doubt.and_then(|d| d.doubt()) {
            let words = format!("{who} under roulette {roulette} {what},\nso it has no ±; {safe}");
            out.extend((!out.contains(&words)).then_some(words));
        }
    }
    // where nothing was measured, the matrix or a bound tells whether the variance of the path tracer, and of its error, is finite
    if let (Some(r), true) = (run.radii, run.path.as_ref().is_some_and(|p| p.doubt.is_none())) {
        let proved = !r.bounds || r.second < 1.0;
        out.extend(
            r.warning()
                .filter(|_| proved)
                .map(|what| format!("the path tracer under roulette {} {what};\n{safe}", s.path_roulette)),
        );
    }
    out
}

/// The sides of surfaces that light never reaches, by shape; nothing if there are none.
pub fn unlit(found: &[Unlit], description: &Description) -> Option<String> {
    let owner: Vec<usize> = description.primitives().iter().map(|(shape, _)| *shape).collect();
    let mut shapes: Vec<(String, [bool; 3], usize)> = vec![];
    for side in found {
        let name = &description.shapes[owner[side.primitive]].name;
        match shapes.iter_mut().find(|(n, c, _)| n == name && *c == side.channels) {
            Some(known) => known.2 += 1,
            None => shapes.push((name.clone(), side.channels, 1)),
        }
    }
    let words = |(name, channels, n): &(String, [bool; 3], usize)| {
        let colours: Vec<&str> = (0..3).filter(|&c| channels[c]).map(|c| fredholm::math::CHANNELS[c]).collect();
        let of = if colours.len() == 3 { String::new() } else { format!(" (no {})", colours.join(", ")) };
        format!("{name}: {n}{of}")
    };
    let sides = found.len();
    let list: Vec<String> = shapes.iter().take(SHAPES).map(words).collect();
    let more = if shapes.len() > SHAPES { format!(", … {} shapes in all", shapes.len()) } else { String::new() };
    let (s, them) = if sides == 1 { ("", "it") } else { ("s", "them") };
    (sides > 0).then(|| {
        format!(
            "Light never reaches {sides} side{s} of the surfaces, so T leaves {them} out: {}{more}",
            list.join(", ")
        )
    })
}

/// Shapes that are listed by name at most.
const SHAPES: usize = 6;
