//! What a run says beside its tables: the judgement, facts about the matrix and the decay, warnings.

use fredholm::engine::by_matrix::{Discrete, Unlit};
use fredholm::engine::by_rays::Estimator;
use fredholm::engine::discretisation::{Difference, SampledRows};
use fredholm::engine::guided::Prepared;
use fredholm::engine::known::growth;
use fredholm::estimator::Roulette;
use fredholm::guide::warp::CELLS;
use fredholm::report::figures::extrapolation::{self, Measured};
use fredholm::report::figures::refine::limit_words;
use fredholm::scene::{Description, bsdf};
use fredholm::stats::evidence::{JUDGED, SHOWN};
use fredholm::stats::{self, Comparison, Evidence};
use fredholm::study::run::Run;
use fredholm::terms::Series;
use fredholm::terms::functional::Replicates;
use glam::DVec3;
use nalgebra::DMatrix;

/// One line: the outcome, and what would decide.
pub fn judgement(c: &Comparison) -> String {
    if let Some(why) = &c.undecided {
        return undecided(why);
    }
    match c.outcome {
        stats::Outcome::Agrees => {
            format!("Agrees: every difference is proved smaller than δ ({} comparisons share α).", c.family)
        }
        stats::Outcome::Differs => format!("Differs: at least one of {} comparisons is rejected.", c.family),
        stats::Outcome::Inconclusive => {
            let reason = c.rows.iter().find_map(|r| r.reason.as_deref());
            let factor = c.rows.iter().filter_map(|r| r.needed_factor).fold(0.0, f64::max);
            match reason {
                Some(reason) => format!("Inconclusive: {reason}."),
                None if factor > 0.0 => format!(
                    "Inconclusive: the noise hides differences of the size of δ; {factor:.1} times the samples will decide."
                ),
                None => "Inconclusive: the results have nothing in common to compare.".into(),
            }
        }
    }
}

/// No verdict, and what to do about it.
pub fn undecided(why: &str) -> String {
    format!(
        "Undecided: {why}.\nNothing says which of them is seen: move one by a thousandth of the scene, or take it away."
    )
}

/// What is printed about the matrix on every run.
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
        "F: row sums {:.6} to {:.6}, entries {:.1e} to {:.4}, {reciprocity}\n\
         residual of the solve {:.1e}; spectral radius ({rho})\n{}\
         |R_h − R_2h| of the image mean {:.1e}",
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
        out += &format!("\n‖T_h‖₁/‖T_h‖∞ per channel {norms}");
    }
    let p = m.radiosity.patches();
    out += &format!(
        "\nsurface {:.4} m², covered {:.4} m²; {} {}",
        p.surface_area(),
        p.covered_area(),
        if m.sampling.is_some() { "rays" } else { "visibility rays" },
        m.radiosity.rays()
    );
    out += "\nT¹ through the camera reads E itself: it tests no matrix";
    out
}

/// What stored rays are worth.
fn sampling(s: &SampledRows) -> String {
    let mut out = format!(
        "{} rays a row: relative L² error bar of L − E over the patches {:.1e}; {} steps",
        s.per_row,
        s.noise.element_sum() / 3.0,
        s.steps
    );
    if s.checks.lost > 0.0 {
        out += &format!("\n{:.1e} of the rays met a surface where no patch is, and count as lost", s.checks.lost);
    }
    out
}

/// How far stored rays are from the matrix.
pub fn difference(d: &Difference) -> String {
    format!(
        "stored rays on the same patches: L − E differs by {:.1e} (relative L²)\n\
         their spectral radius ({})\n{}",
        d.of_u.element_sum() / 3.0,
        d.spectral.each_ref().map(|s| format!("{:.5}", s.radius)).join(", "),
        sampling(&d.sampling)
    )
}

/// What is printed about a guide.
pub fn guide(g: &Prepared) -> String {
    let r = g.recipe;
    format!(
        "guide: radiosity of {} patches, {} rays each, in {:.2} s; {:.0} % of the directions by the cosine",
        g.guide.len(),
        r.fineness.rays * CELLS * CELLS,
        g.time.as_secs_f64(),
        100.0 * r.bsdf
    )
}

/// What is printed about the decay.
pub fn decay_facts(run: &Run) -> Option<String> {
    Some(match run.observed_rate()? {
        Ok(f) => {
            // two terms fit any line: there is nothing to test
            let p = if f.p.is_finite() { format!("p = {:.2}", f.p) } else { "two terms: no p".into() };
            let (first, last) = (f.window.start, f.window.end - 1);
            format!(
                "observed rate of the surface norm {:.4} ± {:.4} (k = {first} to {last}, {p})\nguaranteed: ‖T‖₁ ≤ {:.4}",
                f.rate,
                f.std_error,
                run.guaranteed_rate().max_element()
            )
        }
        Err(why) => format!("no rate fitted: {}", why.to_string().replace("; ", ";\n")),
    })
}

/// What the first half of the terms says about the whole, in the slowest channel.
pub fn extrapolated(run: &Run) -> Option<String> {
    let last = run.settings.max_bounces / 2 + 1;
    // two terms are too few for what is shown, and without a tail there is no whole
    // and where the tail has no error bar, nothing is known of how far off anything is
    let doubted = run.terms.iter().any(|t| t.series.variance != fredholm::terms::Variance::Finite);
    if last < 3 || run.surface.is_empty() || doubted || !run.settings.roulette.ends() {
        return None;
    }
    let rests = |r: &Replicates| (1..=last).find_map(|k| Some((k, Evidence::of(&r.estimate(k..k + 1)).no_error?)));
    if let Some((k, why)) = run.surface.iter().find_map(|(_, r)| rests(r)) {
        return Some(format!("no extrapolation from the surface means of the terms: of k = {k}, {why}"));
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
    let note = if rate.is_nan() { "" } else { "; the known rate is r(T)" };
    Some(format!(
        "L − E from its terms k = 1 to {last}: mean over all surfaces, {}, in units of L − E as measured;\n\
         noise: standard error; gain: how much noisier than the sum of these terms{note}\n{}",
        fredholm::math::CHANNELS[slowest],
        extrapolation::table(&measured, rate)
    ))
}

/// The fitted order of convergence of the radiosity, from three meshes.
pub fn orders(run: &Run) -> Option<String> {
    let whole = run.order(None)?;
    let order = |order: f64| if order.is_finite() { format!("{order:.1}") } else { "–".into() };
    let terms = run.meshes.last()?.image().terms.len();
    let per_term = (2..terms).filter_map(|k| Some(format!("T{k} {}", order(run.order(Some(k))?))));
    Some(format!(
        "order of convergence in h, from {}: whole image {}\n{}",
        run.meshes.iter().map(|m| m.label.split(' ').nth(1).unwrap_or("?")).collect::<Vec<_>>().join(", "),
        order(whole),
        per_term.collect::<Vec<_>>().join(", ")
    ))
}

/// What the samples of some results cannot know, where too few events are to be expected for a verdict.
pub fn doubts<'a>(results: impl Iterator<Item = &'a Series>) -> Vec<String> {
    let of = |s: &'a Series| {
        let thin = s.doubts.iter().filter(|d| s.expected(d) < JUDGED).map(|d| (d, s.expected(d)));
        let worst = thin.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let (what, from) = (&worst.0.what, worst.0.from);
        Some(format!(
            "{}: met only by chance: {what};\n\
             {:.1} such events are to be expected: no verdict below {JUDGED}, no ± below {SHOWN}, from k = {from} on",
            s.label, worst.1
        ))
    };
    results.filter_map(of).collect()
}

/// Where a whole picture is black: that nothing was found, and what there is to be seen.
pub fn black(run: &Run) -> Option<String> {
    let mut all = run.sampled().peekable();
    all.peek()?;
    let paths: u64 = run.sampled().map(|s| s.series.cost.paths).sum();
    if !all.all(|s| s.series.image().total.mean == DVec3::ZERO) {
        return None;
    }
    let camera = &run.scene.camera;
    let pixels = camera.size[0] * camera.size[1];
    let look = |p: u32| {
        let (start, direction) = camera.ray(p, [0.5; 2]);
        run.scene.look(start, direction).filter(|v| v.on_surface())
    };
    let far: Vec<f64> = (0..pixels).filter_map(look).map(|v| v.p.as_dvec3().distance(camera.origin)).collect();
    let (near, far_off) = far.iter().fold((f64::INFINITY, 0.0f64), |a, &d| (a.0.min(d), a.1.max(d)));
    let seen = match far.len() {
        0 => "nothing: its rays leave the scene".to_owned(),
        n => format!("surfaces that send no light, {near:.3} to {far_off:.3} m away, in {n} of {pixels} pixels"),
    };
    Some(format!("every pixel is black: none of {paths} paths found any light. The camera sees\n{seen}"))
}

/// A warning for each result with samples that are not finite.
pub fn not_finite(all: &[Series]) -> String {
    let broken = all.iter().filter(|s| s.cost.non_finite > 0);
    let lines = broken.map(|s| format!("warning: {}: {} samples were not finite", s.label, s.cost.non_finite));
    lines.collect::<Vec<_>>().join("\n")
}

/// What the reader must know before trusting an error bar.
pub fn warnings(run: &Run) -> Vec<String> {
    let mut out = vec![];
    out.extend(black(run));
    out.extend(doubts(run.sampled().map(|s| &s.series)));
    for s in run.results().filter(|s| s.series.cost.non_finite > 0) {
        out.push(format!(
            "{}: {} samples were not finite; they are left in the sums",
            s.series.label, s.series.cost.non_finite
        ));
    }
    if let Some(r) = run.radiosity.as_ref().filter(|r| r.matrix.invariants.row_sum_max > 1.01) {
        out.push(format!(
            "the mesh is too coarse: a row of F sums to {:.3}, and no more than 1 can leave a patch;\nraise --patches",
            r.matrix.invariants.row_sum_max
        ));
    }
    out.extend(variances(run));
    out
}

/// What has no error bar because its variance is infinite or not known, and what would have one.
fn variances(run: &Run) -> Vec<String> {
    let s = &run.settings;
    let safe = if run.guide.is_some() {
        "leave --guide out"
    } else if growth::proved(&run.scene, s.sampling, &Roulette::Albedo { from: 0 }) {
        "--roulette albedo is safe"
    } else if s.sampling == bsdf::Sampling::Uniform {
        "leave --sampling uniform out"
    } else {
        "try --roulette albedo"
    };
    let terms = run.terms.iter().map(|t| ("the tail of the terms", &s.roulette, t));
    let path = run.path.iter().map(|p| ("the path tracer", &s.path_roulette, p));
    let mut out: Vec<String> = vec![];
    for (who, roulette, result) in terms.chain(path) {
        if let Some(what) = result.doubt.and_then(|d| d.doubt()) {
            let words = format!("{who} under roulette {roulette} {what},\nand no ± stands beside it; {safe}");
            out.extend((!out.contains(&words)).then_some(words));
        }
    }
    // the matrix, or a bound, speaks where nothing was measured: of what it proves, and of the error of an error bar
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

/// Sides that light never reaches, in words, by shape; nothing if there are none.
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
    let (s, are) = if sides == 1 { ("", "is") } else { ("s", "are") };
    (sides > 0)
        .then(|| format!("{sides} side{s} {are} never reached by light and left out of T: {}{more}", list.join(", ")))
}

/// Shapes that are listed by name.
const SHAPES: usize = 6;
