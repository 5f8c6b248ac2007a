//! What a run prints.

use crate::cli::base::paragraphs;
use crate::cli::notes;
use fredholm::engine::by_rays::Sampled;
use fredholm::math::Points;
use fredholm::report::figures::pyramid;
use fredholm::report::text::pixel_errors;
use fredholm::report::text::summary;
use fredholm::report::text::table;
use fredholm::study::run::Run;
use std::path::Path;

/// The settings, a table per world, what is known about the decay, the verdicts, the folder.
pub fn people(run: &Run, summary: &summary::Summary, folder: &Path, verbose: bool) -> String {
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
    let mut blocks = vec![head];
    let world = |s: &Sampled, rays: &[u64]| table::series(&s.series.label, s.series.image(), rays);
    blocks.extend(run.terms.iter().map(|t| world(t, &t.rays)));
    if !run.strategies.is_empty() {
        blocks.push(pyramid::table(&run.strategies));
    }
    blocks.extend(run.path.iter().map(|p| world(p, &[])));
    blocks.extend(run.radiosity.iter().map(|r| world(&r.fine, &[])));
    let mut lines: Vec<String> = run.radiosity.iter().map(|r| notes::matrix_facts(r, verbose)).collect();
    lines.extend(run.radiosity.as_ref().and_then(|r| notes::unlit(&r.matrix.unlit, &run.description)));
    lines.extend(run.against_rays.iter().map(notes::difference));
    lines.extend(notes::decay_facts(run));
    lines.extend(notes::orders(run));
    blocks.push(lines.join("\n"));
    blocks.extend(notes::extrapolated(run));
    blocks.push(pixel_errors::words(&summary.pixel_errors));
    if !summary.verdicts.is_empty() {
        blocks.push(table::verdicts(&summary.verdicts));
        let why = run.terms.first().and_then(|t| t.series.undecided.as_deref());
        blocks.extend(why.map(notes::undecided));
    }
    blocks.push(notes::warnings(run).iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n"));
    blocks.push(format!(
        "{} files after {:.1} s; open {}",
        summary.files.len(),
        summary.seconds,
        folder.join("index.html").display()
    ));
    paragraphs(&blocks)
}
