//! All members, each in the scene that shows its mistake, and the right estimator in every one of these scenes.

use super::args::Zoo;
use super::folder::{self, MARK, mark, write};
use super::words::{brief, whole};
use crate::cli::base::{Ending, Failure, print};
use fredholm::engine::Settings;
use fredholm::engine::by_rays;
use fredholm::report::text::csv::Csv;
use fredholm::report::text::prose::wrapped;
use fredholm::report::write_atomically;
use fredholm::report::{ReportError, half_width_95};
use fredholm::scene::Scene;
use fredholm::terms::Functional;
use fredholm::zoo::signature::measured;
use fredholm::zoo::{self, Bug, Stage};
use std::path::{Path, PathBuf};

/// Renders all members and the right estimator, and prints the ratios r_k.
pub fn run(args: &Zoo) -> Result<Ending, Failure> {
    let session = folder::session(args, "zoo-out")?;
    let (folder, settings, progress) = (&session.folder, args.settings(16), session.progress());
    let mut rights: Vec<(Stage, Scene, Functional)> = vec![];
    let mut csv = Csv::new("member,scene,k,ratio,std_error,predicted");
    // written first, so that the folder is marked as this command's even if the run is interrupted
    write_atomically(&folder.join(MARK), mark().as_bytes())?;
    let head = format!("{:24} {:17} {:9} {:9} {:9} whole", "member", "scene", "r₀", "r₁", "r₂");
    let mut table = vec![head.trim_end().to_owned(), "─".repeat(80)];
    let mut changed = 0;
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
        let whole = whole(image, right);
        changed += usize::from((whole.value - 1.0).abs() > half_width_95(whole.std_error, whole.replicates));
        let cells: Vec<String> = ratios[..3].iter().chain([&whole]).map(|r| format!("{:9}", brief(r))).collect();
        table.push(format!("{:24} {:17} {}", bug.name, stage.label, cells.join(" ").trim_end()));
    }
    session.clear();
    write_atomically(&folder.join(MARK), (mark() + &csv.text()).as_bytes())?;
    let rendered = table.len() - 2;
    let answer = format!(
        "Of {rendered} estimators with one mistake each, {changed} change the mean of the whole image by more than its 95 % \
         interval.\nThe others need more samples or single terms, which `fredholm diagnose` looks at."
    );
    let above = "rₖ = mean of the wrong term Tₖ/mean of the right one, in the scene that shows the mistake; in brackets the 95 % \
                 interval of the last digits, where it is known. All rₖ are in ratios.csv.";
    let files = [
        "NAME.exr (seen in cornell)".to_owned(),
        "SCENE/NAME.exr (seen in another scene)".into(),
        "correct.exr".into(),
        MARK.into(),
    ];
    let table = format!("{}\n{}", wrapped(above), table.join("\n"));
    print(&session.text(&wrapped(&answer), &[table], &[], &files))?;
    Ok(session.ending(false))
}

/// Settings with enough samples for a member: a generator that repeats is seen only with more samples than it has different
/// ones, here four times as many.
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
