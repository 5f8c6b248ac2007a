//! The answer of a run, and the small tables behind it: for the terminal and for the page.

use fredholm::engine::by_rays::Sampled;
use fredholm::engine::radius::radius_limit;
use fredholm::math::CHANNELS;
use fredholm::report::figures::{bounces, lit};
use fredholm::report::text::grid::Grid;
use fredholm::report::text::number::{average, error, percent, plus_minus, significant};
use fredholm::report::text::prose::{wrapped, wrapped_after};
use fredholm::report::text::sentence::{bound, sentence};
use fredholm::report::text::summary::Summary;
use fredholm::stats::Outcome;
use fredholm::study::run::Run;
use fredholm::terms::{Estimate, Functional};

/// Terms in the short table at most; longer series are cut there, and `--verbose` prints all.
const SHORT: usize = 13;

/// The answer in one sentence: whether the results agree and how closely, or, with one result only, what it is.
pub fn head(run: &Run) -> String {
    let name = &run.description.name;
    let ways = run.results().count();
    match run.outcome() {
        None => run.results().next().map_or(String::new(), |only| alone(name, only, run)),
        Some(Outcome::Agrees) if run.results().all(|r| average(&r.series.image().total).0 == 0.0) => {
            format!("{name}, solved in {ways} ways: every pixel is black, and below stands what the camera sees.")
        }
        Some(Outcome::Differs) => format!("{name}, solved in {ways} ways: they do not agree."),
        Some(Outcome::Agrees) => {
            let largest = run.verdicts.iter().filter_map(|v| bound(&v.comparison)).fold(0.0, f64::max);
            let mean = run.results().next().map_or(f64::NAN, |r| average(&r.series.image().total).0);
            format!(
                "{name}, solved in {ways} ways: all agree to ± {} %; the mean radiance is {}.",
                significant(100.0 * largest, 2),
                significant(mean, 4)
            )
        }
        Some(Outcome::Inconclusive) => {
            format!("{name}, solved in {ways} ways: no difference found, but not everything is decided.")
        }
    }
}

/// A sentence for each comparison.
pub fn comparisons(run: &Run) -> String {
    let lines = run.verdicts.iter().map(|v| format!("  {}", wrapped_after(&sentence(v.sides, &v.comparison), "    ")));
    lines.collect::<Vec<_>>().join("\n")
}

/// The answer for a single result: its mean, its shares, and for a matrix its spectral radius.
fn alone(name: &str, only: &Sampled, run: &Run) -> String {
    let image = only.series.image();
    let (mean, half) = average(&image.total);
    let mut out =
        format!("{name}, by {}: the picture has the mean radiance {}", only.series.label, plus_minus(mean, half, 2));
    out += if half > 0.0 { " (95 %)." } else { "." };
    if image.terms.len() > 1 {
        let share = |k: usize| percent(average(&image.terms[k]).0 / mean);
        out += &format!("\n{} of it is seen directly, {} after one reflection.", share(0), share(1));
    }
    if let Some(r) = &run.radiosity {
        let rho = r.matrix.spectral.each_ref().map(|s| format!("{:.4}", s.radius)).join(", ");
        out += &format!("\nThe spectral radius of the matrix is ({rho}) in red, green and blue.");
    }
    out
}

/// The terms: means, shares, and the ratios of successive terms in the picture and in the norm of the matrix.
pub fn terms(run: &Run, summary: &Summary) -> Option<Grid> {
    let first = run.results().find(|s| !s.series.image().terms.is_empty())?;
    let image: &Functional = first.series.image();
    let c = run.slowest_channel();
    let colour = CHANNELS[c];
    let norms = summary.radiosity.as_ref().map(|r| &r.norms);
    let mut head = vec!["k".to_owned(), "mean".into(), "± 95 %".into(), "share".into(), "ratio: picture".into()];
    head.extend(norms.is_some().then(|| "norm of the matrix".into()));
    let sentence = format!("The terms T^k E: light reflected k times. Ratio: to the term before, in {colour}.");
    let mut grid = Grid::new(sentence, head);
    let whole = average(&image.total).0;
    let ratio = |of: &dyn Fn(usize) -> f64, k: usize| match k {
        0 => "–".to_owned(),
        k => significant(of(k) / of(k - 1), 3),
    };
    let mut row = |name: String, e: &Estimate, k: Option<usize>| {
        let mean = average(e).0;
        let mut cells = vec![name, significant(mean, 4), error(e), percent(mean / whole)];
        let blank = String::new;
        cells.push(k.map_or_else(blank, |k| ratio(&|k| image.terms[k].mean[c], k)));
        if let Some(norms) = norms {
            cells.push(k.map_or_else(blank, |k| ratio(&|k| norms[k].norm_w[c], k)));
        }
        grid.push(cells);
    };
    let shown = image.terms.len().min(SHORT);
    for (k, term) in image.terms.iter().take(shown).enumerate() {
        row(k.to_string(), term, Some(k));
    }
    if shown < image.terms.len() {
        row("…".into(), &image.terms[image.terms.len() - 1], None);
    }
    if !image.tail.is_none() {
        row(format!("k > {}", image.terms.len() - 1), &image.tail, None);
        // where all results agree, the answer states the mean of the whole
        if run.outcome() != Some(Outcome::Agrees) {
            row("all".into(), &image.total, None);
        }
    } else {
        // cut at K: longer paths are not estimated
        let blank = vec!["–".to_owned(); grid.head.len() - 1];
        grid.push(std::iter::once(format!("k > {}", image.terms.len() - 1)).chain(blank));
    }
    Some(grid)
}

/// The observed rate beside the spectral radius of the same channel, and why the two columns of ratios differ.
pub fn decay(run: &Run) -> String {
    let c = run.slowest_channel();
    let colour = CHANNELS[c];
    let mut sentences = vec![];
    if let Some(Ok(fit)) = run.observed_rate_in(c) {
        let (first, last) = (fit.window.start, fit.window.end - 1);
        let rate = plus_minus(fit.rate, fit.std_error, 2);
        sentences.push(format!("Over all surfaces {colour} falls ×{rate} per bounce (k = {first} to {last})."));
    }
    if let Some(r) = &run.radiosity {
        let (radius, bound) = (r.matrix.spectral[c].radius, run.guaranteed_rate()[c]);
        let limit = radius_limit(&r.radii).map(|l| l[c]);
        let radius = match limit {
            Some(l) => format!("{} (h → 0; on this mesh {radius:.4})", plus_minus(l.value, l.half_width, 1)),
            None => format!("{radius:.4} on this mesh"),
        };
        sentences.push(format!(
            "The spectral radius of T is {radius}, at most {bound:.3}. Ratios of the norm rise to it, because T \
             is self-adjoint in that norm; ratios of the picture wander, because each bounce lights other surfaces."
        ));
    }
    if sentences.is_empty() { String::new() } else { wrapped(&sentences.join(" ")) + "\n" }
}

/// Which bounce lights what, and how many bounces are enough.
pub fn grids(run: &Run) -> Vec<Grid> {
    let lit = (!run.lit.is_empty()).then(|| lit::grid(&run.lit));
    let albedo = run.guaranteed_rate().max_element();
    let enough = run.bounces.as_ref().map(|found| bounces::grid(found, albedo, run.bounds_from()));
    lit.into_iter().chain(enough).collect()
}
