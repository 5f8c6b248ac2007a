//! `sweep --over patches`: radiosity on finer and finer meshes, compared with rays, which need no mesh.

use super::args::Sweep;
use crate::cli::base::{Ending, Failure, names, usage};
use crate::cli::preflight;
use crate::cli::session::Session;
use fredholm::engine::Settings;
use fredholm::engine::discretisation::Factors;
use fredholm::engine::radius::radius_limit;
use fredholm::report::figures::drift;
use fredholm::report::figures::refine as report;
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::study::refinement::{self, Quantity, Refinement};
use fredholm::terms::{Channel, World};

/// The default numbers of patches: h halves from one mesh to the next.
const USUAL: &str = "38,150,600,2400";

/// Solves on every mesh and compares the terms with those by rays.
pub fn run(args: &Sweep) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.shared, args.frame.seed)?;
    let sizes = sizes(args)?;
    if args.budget().is_some() {
        let what = "--equal-rays and --equal-time are for values with samples of their own";
        return Err(usage(what, "leave it out: all meshes are seen along the same rays"));
    }
    let opened = session.open(&args.frame.scene, &args.shared.changes, args.frame.size)?;
    let (description, scene) = (opened.description, opened.scene.select_lights(args.lights));
    preflight::has_a_matrix(&description, &scene, Factors::Dense)?;
    let (grading, read_patches) = (args.grading, args.read_patches);
    let settings = Settings { grading, read_patches, ..args.settings(256) };
    preflight::fits_in_memory(&settings, description.camera.size)?;
    preflight::light_is_lost(&scene, &settings, &[World::Terms])?;
    session.make_folder(&format!("{}-sweep-patches", description.name))?;
    let eigenvalues = args.eigenvalues.unwrap_or(0).into();
    let found = refinement::refine(&description, &scene, &sizes, eigenvalues, &settings, session.progress())?;
    session.clear();
    if found.meshes.is_empty() {
        return Ok(session.nothing_to_save(""));
    }
    let series = std::iter::once(&found.truth).chain(found.meshes.iter().map(|m| &m.picture));
    let record = Summary {
        spp: settings.spp.into(),
        max_bounces: settings.max_bounces,
        series: series.map(|s| s.series.clone()).collect(),
        files: write(&session, &found, settings.max_bounces)?,
        ..session.record()
    };
    session.sign(&record)?;
    session.show(&record, || people(&session, &found, &record))?;
    Ok(session.ending(false))
}

/// Numbers of patches in ascending order, without repetition.
fn sizes(args: &Sweep) -> Result<Vec<usize>, Failure> {
    let number = |v: &str| {
        v.trim().parse().ok().filter(|n| (1..=20_000).contains(n)).ok_or_else(|| {
            let what = format!("`{v}` is not a number of patches from 1 to 20000");
            usage(&what, &format!("values of --over patches are such as --values {USUAL}"))
        })
    };
    let all = args.values.as_deref().unwrap_or(USUAL).split(',').map(number);
    let mut sizes: Vec<usize> = all.collect::<Result<_, Failure>>()?;
    sizes.sort_unstable();
    sizes.dedup();
    Ok(sizes)
}

/// The channel whose eigenvalues were computed, or `None`.
fn channel(found: &Refinement) -> Option<&'static str> {
    found.meshes.last().and_then(|m| m.spectrum.as_ref()).map(|e| Channel::ALL[e.channel].name())
}

fn write(session: &Session, found: &Refinement, max_bounces: usize) -> Result<Vec<String>, Failure> {
    let (folder, caption, record) = (&session.folder, &session.caption(), session.record());
    write_atomically(&folder.join("patches.csv"), report::csv(found, max_bounces).as_bytes())?;
    report::draw(found, max_bounces, caption)?.write(folder, "patches")?;
    report::places(found, [record.width, record.height], 0.1, caption)?.picture.write(&folder.join("places.png"))?;
    let mut files = names(["summary.json", "patches.csv", "patches.png", "patches.svg", "places.png"]);
    if let Some(channel) = channel(found) {
        let title = format!("Eigenvalues and the mesh: {}, {channel}", record.scene);
        write_atomically(&folder.join("eigenvalues.csv"), drift::csv(found).as_bytes())?;
        drift::draw(found, &title, caption)?.write(folder, "eigenvalues")?;
        files.extend(names(["eigenvalues.csv", "eigenvalues.png", "eigenvalues.svg"]));
    }
    Ok(files)
}

/// Terms and meshes in the table that is printed without `--verbose`, and rows for eigenvalues.
const TERMS: usize = 6;
const MESHES: usize = 3;
const EIGENVALUES: usize = 6;

/// The text: the order of convergence, the errors of the finest meshes, and with `--verbose` everything.
fn people(session: &Session, found: &Refinement, record: &Summary) -> String {
    let Summary { command, seed, width, height, spp, max_bounces, .. } = record;
    let mut answer = vec![order(found), finest(found), radius(found)];
    let mut tables = vec![errors(found, *max_bounces, *spp)];
    let head = format!(
        "{command}\nseed {seed}, {width}×{height} pixels, {spp} spp for the rays and for every mesh, k ≤ {max_bounces}"
    );
    let foot = "T0 and T1 are controls: there a mesh reads E itself.\n\
                An order is given where two or more errors exceed 3 standard errors and have one sign.";
    let mut details = vec![head, report::full_table(found, *max_bounces) + foot];
    if let Some(channel) = channel(found) {
        let (outside, all, band) = drift::outside(found);
        answer.push(format!(
            "On the finest mesh {outside} of the {all} leading eigenvalues of the {channel} channel lie outside the band of the \
             edges, ±{band:.4}; only these can belong to the scene."
        ));
        let above = wrapped(
            "The leading eigenvalues by number of patches. Where h halves, a step ratio below 0.5 shows a limit, which belongs \
             to the scene. In the band, and just outside it because corners widen it, eigenvalues drift: they belong to the \
             mesh.",
        );
        let with = |rows: usize| format!("{above}\n{}", drift::table(found, rows));
        tables.push(with(EIGENVALUES));
        details.push(with(usize::MAX));
    }
    answer.retain(|sentence| !sentence.is_empty());
    session.text(&wrapped(&answer.join("\n")), &tables, &details, &record.files)
}

/// The first sentence of the answer: the order of convergence of indirect light, or why none is known.
fn order(found: &Refinement) -> String {
    match report::order(found, Quantity::Indirect) {
        Some(o) => format!(
            "Radiosity converges to the rays with order {:.2} ± {:.2} (standard error): halving the patch width h divides the \
             error of indirect light by {:.1}.",
            o.order,
            o.std_error,
            2f64.powf(o.order)
        ),
        None => {
            "No order of convergence can be given: fewer than two meshes differ from the rays by more than 3 standard \
                 errors; more --spp or coarser --values would show one."
                .into()
        }
    }
}

/// The error of indirect light on the finest mesh.
fn finest(found: &Refinement) -> String {
    let Some(mesh) = found.meshes.last() else { return String::new() };
    let truth = Quantity::Indirect.mean(&found.truth).mean.element_sum() / 3.0;
    let (e, s) = found.mean_error(mesh, Quantity::Indirect);
    let off = match s.is_finite() {
        true => report::percent(e / truth, s / truth),
        false => format!("{:+.2} %, with an error that is not known", 100.0 * e / truth),
    };
    format!("With {} patches the mean of indirect light (k ≥ 2) is off by {off}.", mesh.patches)
}

/// The limit of the spectral radius, where the meshes give one.
fn radius(found: &Refinement) -> String {
    let meshes: Vec<_> = found.meshes.iter().map(|m| m.radius).collect();
    let Some(limit) = radius_limit(&meshes) else { return String::new() };
    let [value, half] = [
        limit.each_ref().map(|l| format!("{:.4}", l.value)).join(", "),
        limit.each_ref().map(|l| format!("{:.0e}", l.half_width)).join(", "),
    ];
    format!("For h → 0 the spectral radius tends to ({value}) ± ({half}), an estimate and no bound.")
}

/// The errors of the terms from k = 2 on, with a sentence above the table.
fn errors(found: &Refinement, max_bounces: usize, spp: u64) -> String {
    // fewer terms where a table of eigenvalues follows
    let most = if channel(found).is_some() { TERMS / 3 } else { TERMS };
    let terms = (2..=max_bounces).take(most).map(Quantity::Term);
    let quantities: Vec<Quantity> = terms.chain([Quantity::Indirect]).collect();
    let above = format!(
        "Image means by rays ({spp} spp), and how far radiosity is off, in percent of them (± standard error), for meshes of \
         growing numbers of patches."
    );
    format!("{}\n{}", wrapped(&above), report::table(found, &quantities, MESHES))
}
