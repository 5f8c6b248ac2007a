//! A figure of one image at growing numbers of paths per pixel.

use super::args::Figure;
use crate::cli::base::{Ending, Failure, names};
use crate::cli::options::Changes;
use crate::cli::preflight;
use crate::cli::session::Session;
use fredholm::engine::Settings;
use fredholm::report::figures::stages as report;
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::study::stages::{Grown, Recipe, Stage, reference_seed, render_stages};

/// Makes a figure of one image at growing numbers of paths per pixel.
pub fn run(args: &Figure, recipe: &Recipe, mut session: Session) -> Result<Ending, Failure> {
    let as_it_is = Changes { set: vec![], emit: vec![], lambertian: false };
    let opened = session.open(
        recipe.scene,
        &as_it_is,
        Some(args.size.unwrap_or(if args.quick { [24, 24] } else { recipe.size })),
    )?;
    let settings = Settings { spp: recipe.reference_spp, seed: args.seed, ..Settings::default() };
    preflight::fits_in_memory(&settings, opened.description.camera.size)?;
    session.make_folder(recipe.id)?;
    let Some(grown) = render_stages(&opened.scene, recipe, &settings, session.progress()) else {
        return Ok(session.nothing_to_save(""));
    };
    let (png, csv) = (format!("{}.png", recipe.id), format!("{}.csv", recipe.id));
    let record = Summary {
        spp: grown.stages.last().map_or(0, |s| s.paths).into(),
        max_bounces: settings.max_bounces,
        path: grown.stages.last().map(|s| s.mean),
        files: names([&csv, &png, "summary.json"]),
        ..session.record()
    };
    let size = [record.width, record.height];
    report::sheet(recipe.title, size, &grown, &session.caption())?.write(&session.folder.join(&png))?;
    write_atomically(&session.folder.join(&csv), report::csv(&grown).as_bytes())?;
    session.sign(&record)?;
    session.show(&record, || people(&session, recipe, &grown, &record))?;
    Ok(session.ending(false))
}

/// The text: how far the error falls, and a row per stage.
fn people(session: &Session, recipe: &Recipe, grown: &Grown, record: &Summary) -> String {
    let Summary { scene, seed, width, height, .. } = record;
    let error = |s: &Stage| report::rmse(s.scatter.squared_error().unwrap_or(f64::NAN));
    let answer = match (grown.stages.first(), grown.stages.last()) {
        (Some(few), Some(many)) => format!(
            "With {} paths per pixel the root-mean-square error of a pixel of {scene} is {}; with {} it is {}.",
            few.paths,
            error(few),
            many.paths,
            error(many)
        ),
        _ => "No stage was rendered.".into(),
    };
    let above = format!(
        "{}, by the path tracer: the mean of the samples, the mean shown, with everything above white cut off as on a \
         screen, the light lost by that, the share of clipped pixels, and the error from the reference ({}, {} spp, seed {}; \
         its variance is subtracted). Seed {seed}, {width}×{height} pixels.",
        recipe.title,
        grown.reference.label,
        recipe.reference_spp,
        reference_seed(*seed)
    );
    let below =
        "The reference loses lamps and bright light on a screen, too; what an image loses beyond that is noise.";
    let table = format!("{}\n{}{}", wrapped(&above), report::table(grown).trim_start(), wrapped(below));
    session.text(&wrapped(&answer), &[table], &[], &record.files)
}
