//! `--over patches`: the matrix on finer and finer meshes against the truth from rays.

use super::args::Sweep;
use crate::cli::base::{Ending, Failure, names, paragraphs, usage};
use crate::cli::preflight;
use crate::cli::session::Session;
use fredholm::engine::Settings;
use fredholm::engine::discretisation::Factors;
use fredholm::report::figures::drift;
use fredholm::report::figures::refine as report;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::study::refinement::{self, Refinement};
use fredholm::terms::{Channel, World};

/// Meshes of these sizes unless told otherwise: h halves from one to the next.
const USUAL: &str = "38,150,600,2400";

/// Solves on every mesh and holds the terms against rays.
pub fn run(args: &Sweep) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.shared, args.frame.seed)?;
    let sizes = sizes(args)?;
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

/// Numbers of patches, in order.
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

/// The channel whose eigenvalues were found, if any were.
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

fn people(session: &Session, found: &Refinement, record: &Summary) -> String {
    let Summary { command, seed, width, height, spp, max_bounces, .. } = record;
    let head = format!(
        "{command}\nseed {seed}, {width}×{height} pixels, {spp} spp for the truth and for every mesh, k ≤ {max_bounces}"
    );
    let foot = "T0 and T1 are controls: there a mesh reads E itself.\n\
                An order stands where two or more errors exceed 3 standard errors and have one sign."
        .to_string();
    let files: Vec<String> = record.files.chunks(5).map(|line| line.join(", ")).collect();
    let files = format!("written to {}:\n{}", session.folder.display(), files.join(",\n"));
    let mut blocks = vec![head, report::table(found, *max_bounces), foot];
    blocks.extend(channel(found).map(|c| drift::table(found, c)));
    blocks.push(files);
    paragraphs(&blocks)
}
