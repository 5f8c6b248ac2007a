//! Collects the content of `index.html` from a run.

use super::data::data;
use super::files::Files;
use crate::cli::answer;
use crate::cli::base::Failure;
use fredholm::report::image::exposure::Exposure;
use fredholm::report::page::html::{self, Page, Plate};
use fredholm::report::text::sentence::sentence;
use fredholm::report::text::summary;
use fredholm::report::text::summary::VerdictRecord;
use fredholm::study::run::{Run, RunVerdict};

pub(super) fn write_page(
    run: &Run,
    out: &Files,
    exposure: Exposure,
    summary: &summary::Summary,
) -> Result<(), Failure> {
    let each = exposure == Exposure::Auto;
    let [decay, variance] = ["decay.svg", "variance.svg"].map(|name| out.path(name));
    let candidates = [("decay.svg", Plate::decay(&decay)), ("variance.svg", Plate::variance(&variance))];
    let plates = candidates.into_iter().filter(|(name, _)| out.has(name)).map(|(_, plate)| plate).collect();
    let data = data(run, out, exposure, summary);
    let s = &run.settings;
    let facts = [
        ("seed", s.seed.to_string()),
        ("samples per pixel", summary.spp.to_string()),
        ("size", format!("{}×{}", summary.width, summary.height)),
        ("technique", s.technique.to_string()),
        ("roulette of the terms (q = termination)", s.roulette.to_string()),
        ("roulette of the path tracer", s.path_roulette.to_string()),
        ("scene hash", summary.scene_hash.clone()),
        ("seconds", format!("{:.1} on {} threads", summary.seconds, summary.threads)),
    ];
    let errors = fredholm::report::text::pixel_errors::words(&summary.pixel_errors);
    let facts = facts.map(|(k, v)| (k.to_string(), v)).into_iter();
    let facts = facts.chain((!errors.is_empty()).then(|| ("errors of pixels".to_string(), errors)));
    let page = Page {
        title: run.description.name.clone(),
        answer: answer::head(run),
        data: (!data.layers.is_empty()).then_some(&data),
        plates,
        comparisons: run.verdicts.iter().map(comparison).collect(),
        grids: answer::grids(run),
        series: run.results().map(|s| (s.series.label.clone(), s.series.image())).collect(),
        command: summary.command.clone(),
        facts: facts.collect(),
        files: out.names.iter().map(|n| (n.clone(), meaning(n, each).to_string())).collect(),
    };
    html::write(&out.path("index.html"), &page)?;
    Ok(())
}

/// The sentence of a comparison and the numbers behind it.
fn comparison(verdict: &RunVerdict) -> (String, Vec<VerdictRecord>) {
    (sentence(verdict.sides, &verdict.comparison), summary::verdicts(verdict.name, &verdict.comparison))
}

/// What a file holds. `each`: every term has its own exposure.
fn meaning(name: &str, each: bool) -> &'static str {
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
        _ if each => "one term at its own exposure",
        _ => "one term at the exposure of all terms",
    }
}
