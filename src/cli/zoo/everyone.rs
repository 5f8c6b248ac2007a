//! Every member on the scene that shows it, and the control.

use super::args::Zoo;
use super::folder::{self, MARK, mark, write};
use super::words::{brief, whole};
use crate::cli::base::{Ending, Failure, paragraphs, print};
use fredholm::engine::Settings;
use fredholm::engine::by_rays;
use fredholm::report::ReportError;
use fredholm::report::text::csv::Csv;
use fredholm::report::write_atomically;
use fredholm::scene::Scene;
use fredholm::terms::Functional;
use fredholm::zoo::signature::measured;
use fredholm::zoo::{self, Bug, Stage};
use std::path::{Path, PathBuf};

/// Every member on the scene that shows it, and the control.
pub fn run(args: &Zoo) -> Result<Ending, Failure> {
    let session = folder::session(args, "zoo-out")?;
    let (folder, settings, progress) = (&session.folder, args.settings(16), session.progress());
    let mut rights: Vec<(Stage, Scene, Functional)> = vec![];
    let mut csv = Csv::new("member,scene,k,ratio,std_error,predicted");
    // first, so that the folder is known as this command's even if the rest never comes
    write_atomically(&folder.join(MARK), mark().as_bytes())?;
    let mut table = vec![format!("{:24} {:18} r₀         r₁         r₂         r₃         whole", "member", "scene")];
    for bug in zoo::all() {
        let stage = bug.exposed_by;
        if !rights.iter().any(|r| r.0 == stage) {
            let scene = Scene::new(&stage.load(args.size)?);
            let few = Settings { spp: 4 * settings.spp, ..settings.clone() };
            let right = by_rays::terms(&scene, by_rays::Estimator::Prefix, &few, progress);
            write(&place(folder, stage, "correct")?, args.size, &right)?;
            rights.push((stage, scene, right.series.image().clone()));
        }
        let Some((_, scene, right)) = rights.iter().find(|r| r.0 == stage) else { continue };
        let settings = enough(bug, &settings);
        let wrong = zoo::render(bug, scene, &settings, progress);
        if session.stopped() {
            break;
        }
        write(&place(folder, stage, bug.name)?, args.size, &wrong)?;
        let image = wrong.series.image();
        let ratios = measured(image, right);
        for (k, r) in ratios.iter().enumerate() {
            csv.put(bug.name).put(stage.label).put(k).put(r.value).put(r.std_error);
            csv.numbers([(bug.ratio)(k).unwrap_or(f64::NAN)]).end();
        }
        let cells: Vec<String> = ratios[..4].iter().chain([&whole(image, right)]).map(brief).collect();
        let cells: Vec<String> = cells.iter().map(|c| format!("{c:10}")).collect();
        table.push(format!("{:24} {:18} {}", bug.name, stage.label, cells.join(" ").trim_end()));
    }
    session.clear();
    write_atomically(&folder.join(MARK), (mark() + &csv.text()).as_bytes())?;
    let note =
        "rₖ = Tₖ wrong / Tₖ right, mean of the image and the channels; the last digits' 95 % interval in brackets";
    let left =
        format!("{}: NAME.exr seen in cornell, SCENE/NAME.exr seen elsewhere, correct.exr, {MARK}", folder.display());
    print(&paragraphs(&[table.join("\n"), note.into(), left]))?;
    Ok(session.ending(false))
}

/// A generator that starts again shows only where more samples are drawn than it has: four times as many.
fn enough(bug: &Bug, settings: &Settings) -> Settings {
    let least = if bug.name == "same-numbers" { 4 * zoo::bookkeeping::DIFFERENT } else { 1 };
    Settings { spp: settings.spp.max(least), ..settings.clone() }
}

/// `DIR/NAME.exr` on cornell, `DIR/SCENE/NAME.exr` elsewhere.
fn place(folder: &Path, stage: Stage, name: &str) -> Result<PathBuf, Failure> {
    let folder = if stage == Stage::CORNELL { folder.to_path_buf() } else { folder.join(stage.label) };
    std::fs::create_dir_all(&folder).map_err(|e| ReportError::new(&folder, e, "choose another folder with -o"))?;
    Ok(folder.join(format!("{name}.exr")))
}
