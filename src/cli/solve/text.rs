//! What a run prints: the answer, small tables, what to try next; with `--verbose` every number behind them.

use crate::cli::answer;
use crate::cli::notes;
use crate::cli::session::Session;
use fredholm::engine::by_rays::Sampled;
use fredholm::report::figures::pyramid;
use fredholm::report::text::grid::Grid;
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;
use fredholm::report::text::{pixel_errors, table};
use fredholm::study::run::Run;

/// The text of a run, with the suggestions `next` at its end.
pub fn people(run: &Run, summary: &Summary, session: &Session, next: &str) -> String {
    let mut tables = vec![];
    tables.extend(answer::terms(run, summary).map(|grid| grid.to_string() + &answer::decay(run)));
    if !run.strategies.is_empty() {
        tables.push(pyramid::table(&run.strategies));
    }
    tables.extend(answer::grids(run).iter().map(Grid::to_string));
    tables.extend(notes::orders(run).map(|grid| grid.to_string()));
    tables.push(notes::warnings(run).iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n"));
    let page = session.folder.join("index.html");
    let files = format!("{} files in {:.0} s; open {}", summary.files.len(), summary.seconds, page.display());
    let last = if next.is_empty() { files } else { format!("{next}\n{files}") };
    let stopped = stopped_early(run, summary).map_or(String::new(), |at| format!("\nStopped early, at {at} spp."));
    let crop = run.settings.crop.map_or(String::new(), |c| {
        let ([x, y], [w, h], [of_w, of_h]) = (c.from, c.size, run.scene.camera.size);
        format!("\nA crop of {w}×{h} pixels at ({x}, {y}) of {of_w}×{of_h}: means of pictures are over it.")
    });
    let answer = format!("{}{stopped}{crop}\n{}", wrapped(&answer::head(run)), answer::comparisons(run));
    session.text_ending(&answer, &tables, &details(run, summary), &last)
}

/// `48 of 256`, if the run has fewer samples per pixel than asked for.
fn stopped_early(run: &Run, summary: &Summary) -> Option<String> {
    let asked = u64::from(run.settings.spp);
    (run.settings.time.is_none() && summary.spp < asked).then(|| format!("{} of {asked}", summary.spp))
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
    let spp = stopped_early(run, summary).unwrap_or(summary.spp.to_string());
    let mut head =
        format!("{}\nseed {}, {spp} spp, {}×{} pixels", summary.command, s.seed, summary.width, summary.height);
    if !run.terms.is_empty() || run.path.is_some() {
        head += &format!("; technique {}", s.technique);
        head.extend(s.spread().iter().map(|words| format!("; {words}")));
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
