//! What a run prints: the answer, small tables, what to try next; with `--verbose` every number behind them.

use crate::cli::notes;
use crate::cli::session::Session;
use fredholm::engine::by_rays::Sampled;
use fredholm::math::{CHANNELS, Points};
use fredholm::report::figures::{bounces, lit, pyramid};
use fredholm::report::text::grid::Grid;
use fredholm::report::text::number::{average, error, percent, plus_minus, significant};
use fredholm::report::text::sentence::{bound, sentence};
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::{pixel_errors, table};
use fredholm::stats::Outcome;
use fredholm::study::run::Run;
use fredholm::terms::Functional;

/// Terms in the short table at most; longer series are cut there, and `--verbose` prints all.
const SHORT: usize = 13;

/// The text of a run. `next` are suggestions that stand at the end.
pub fn people(run: &Run, summary: &Summary, session: &Session, next: &str) -> String {
    let mut tables = vec![];
    tables.extend(terms(run).map(|grid| grid.to_string() + &decay(run)));
    if !run.strategies.is_empty() {
        tables.push(pyramid::table(&run.strategies));
    }
    tables.extend((!run.lit.is_empty()).then(|| lit::grid(&run.lit).to_string()));
    let counted = run.bounces.as_ref();
    tables
        .extend(counted.map(|b| bounces::grid(b, run.guaranteed_rate().max_element(), run.bounds_from()).to_string()));
    tables.extend(notes::orders(run));
    tables.push(notes::warnings(run).iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n"));
    tables.push(next.to_owned());
    let page = session.folder.join("index.html");
    let files = format!("{} files after {:.0} s; open {}", summary.files.len(), summary.seconds, page.display());
    session.text_ending(&answer(run), &tables, &details(run, summary), &files)
}

/// The answer: do the ways agree, and to which accuracy; or what was found, where there is one way only.
fn answer(run: &Run) -> String {
    let name = &run.description.name;
    if run.verdicts.is_empty() {
        return run.results().next().map_or(String::new(), |only| alone(name, only, run));
    }
    let all = |o: Outcome| run.verdicts.iter().all(|v| v.comparison.outcome == o);
    let any = |o: Outcome| run.verdicts.iter().any(|v| v.comparison.outcome == o);
    let ways = run.results().count();
    let head = if any(Outcome::Differs) {
        format!("{name}, solved in {ways} ways: they do not agree.")
    } else if all(Outcome::Agrees) {
        let largest = run.verdicts.iter().filter_map(|v| bound(&v.comparison)).fold(0.0, f64::max);
        format!(
            "{name}, solved in {ways} ways: all agree, the whole picture to ± {} %.",
            significant(100.0 * largest, 2)
        )
    } else {
        format!("{name}, solved in {ways} ways: no difference found, but not everything is decided.")
    };
    let lines = run.verdicts.iter().map(|v| format!("  {}", sentence(v.sides, &v.comparison)));
    std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n")
}

/// One result and nothing to compare it with.
fn alone(name: &str, only: &Sampled, run: &Run) -> String {
    let image = only.series.image();
    let (mean, half) = average(&image.total);
    let mut out =
        format!("{name}, by {}: the picture has the mean radiance {}", only.series.label, plus_minus(mean, half, 2));
    out += if half > 0.0 { " (95 %).".into() } else { ".".to_owned() }.as_str();
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
fn terms(run: &Run) -> Option<Grid> {
    let first = run.results().find(|s| !s.series.image().terms.is_empty())?;
    let image: &Functional = first.series.image();
    let c = run.slowest_channel();
    let colour = CHANNELS[c];
    let norms = run.radiosity.as_ref().map(|r| summary::bounce_norms(r.matrix.radiosity.patches(), &r.matrix.terms));
    let mut head = vec!["k".to_owned(), "mean".into(), "± 95 %".into(), "share".into(), "ratio: picture".into()];
    head.extend(norms.is_some().then(|| "norm of the matrix".into()));
    let sentence = format!("The terms T^k E: light reflected k times. Ratio: to the term before, in {colour}.");
    let mut grid = Grid::new(sentence, head);
    let whole = average(&image.total).0;
    let ratio = |of: &dyn Fn(usize) -> f64, k: usize| match k {
        0 => "–".to_owned(),
        k => significant(of(k) / of(k - 1), 3),
    };
    let mut row = |name: String, e: &fredholm::terms::Estimate, k: Option<usize>| {
        let mean = average(e).0;
        let mut cells = vec![name, significant(mean, 4), error(e), percent(mean / whole)];
        let blank = String::new;
        cells.push(k.map_or_else(blank, |k| ratio(&|k| image.terms[k].mean[c], k)));
        if let Some(norms) = &norms {
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
        row("all".into(), &image.total, None);
    }
    Some(grid)
}

/// The observed rate beside the spectral radius of the same channel.
fn decay(run: &Run) -> String {
    let c = run.slowest_channel();
    let colour = CHANNELS[c];
    let mut out = String::new();
    if let Some(Ok(fit)) = run.observed_rate_in(c) {
        let (first, last) = (fit.window.start, fit.window.end - 1);
        out += &format!(
            "Measured over all surfaces, {colour} falls by {} per bounce (k = {first} to {last}).\n",
            plus_minus(fit.rate, fit.std_error, 2)
        );
    }
    let Some(r) = &run.radiosity else { return out };
    let radius = r.matrix.spectral[c].radius;
    let bound = run.guaranteed_rate()[c];
    out += &format!(
        "Its spectral radius is {radius:.4}, on this mesh; the albedo guarantees ≤ {bound:.3}. The ratios of the\n\
         norm rise to it, because T is self-adjoint in that norm; ratios of the picture\n\
         wander, because each bounce lights other surfaces and the camera sees only some.\n"
    );
    out
}

/// Every number behind the answer.
fn details(run: &Run, summary: &Summary) -> Vec<String> {
    let mut blocks = vec![settings(run, summary)];
    let world = |s: &Sampled, rays: &[u64]| table::series(&s.series.label, s.series.image(), rays);
    blocks.extend(run.terms.iter().map(|t| world(t, &t.rays)));
    blocks.extend(run.path.iter().map(|p| world(p, &[])));
    blocks.extend(run.radiosity.iter().map(|r| world(&r.fine, &[])));
    let mut lines: Vec<String> = run.radiosity.iter().map(notes::matrix_facts).collect();
    lines.extend(run.radiosity.as_ref().and_then(|r| notes::unlit(&r.matrix.unlit, &run.description)));
    lines.extend(run.against_rays.iter().map(notes::difference));
    lines.extend(notes::decay_facts(run));
    blocks.push(lines.join("\n"));
    blocks.extend(notes::extrapolated(run));
    blocks.push(pixel_errors::words(&summary.pixel_errors));
    if !summary.verdicts.is_empty() {
        let sentence = "Every part that was compared, in the channel and region that decides it.";
        blocks.push(format!("{sentence}\n{}", table::verdicts(&summary.verdicts)));
    }
    blocks
}

/// How the run was made.
fn settings(run: &Run, summary: &Summary) -> String {
    let s = &run.settings;
    let spp = if s.time.is_none() && summary.spp < s.spp.into() {
        format!("{} of {}", summary.spp, s.spp)
    } else {
        summary.spp.to_string()
    };
    let mut head =
        format!("{}\nseed {}, {spp} spp, {}×{} pixels", summary.command, s.seed, summary.width, summary.height);
    if !run.terms.is_empty() || run.path.is_some() {
        head += &format!("; technique {}", s.technique);
        head += if s.points == Points::Sobol { "; Sobol points" } else { "" };
    }
    let used = [(!run.terms.is_empty(), "terms", &s.roulette), (run.path.is_some(), "path tracer", &s.path_roulette)];
    let roulette: Vec<_> = used.iter().filter(|r| r.0).map(|(_, who, r)| format!("{who} {r}")).collect();
    if !roulette.is_empty() {
        head += &format!("\nroulette: {} (q ends a path, survivors weigh 1/(1−q))", roulette.join(", "));
    }
    if let Some(guide) = &run.guide {
        head += "\n";
        head += &notes::guide(guide);
    }
    head
}
