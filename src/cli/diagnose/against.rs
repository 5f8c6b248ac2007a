//! The reference with which a picture is compared: terms rendered here, or those of an existing run.

use super::args::Diagnose;
use super::suspects::size_mismatch;
use crate::cli::base::{Failure, note, usage};
use crate::cli::solve::{Render, Series, Tour};
use crate::cli::{notes, open, preflight};
use clap::{Parser, Subcommand};
use fredholm::diagnosis::candidates::own_seed;
use fredholm::diagnosis::picture::{Code, Layer, Pictures, Slot, shrink_factor};
use fredholm::diagnosis::{Seen, WIDEST, regions};
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::engine::known::resort::with_last_resort;
use fredholm::engine::{MOST_BOUNCES, Settings};
use fredholm::progress::Progress;
use fredholm::report::image::exr;
use fredholm::report::text::summary;
use fredholm::scene::load;
use fredholm::scene::{Description, Scene};
use fredholm::terms::World;
use std::path::Path;

/// The scene or the run that `--against` names.
pub struct Source {
    /// Name of the scene.
    pub name: String,
    /// Hash of the scene.
    pub hash: String,
    description: Option<Description>,
    run: Option<(String, Pictures, f64)>,
}

/// The reference for one size and one K.
pub struct Right {
    /// Its pictures, averaged down.
    pub pictures: Pictures,
    /// Factor by which width and height are averaged down.
    pub factor: usize,
    /// Its samples per pixel of the averaged picture; NaN if not known.
    pub spp: f64,
    /// What the camera sees.
    pub seen: Seen,
    /// The scene at that size, in which mistakes are simulated.
    pub scene: Option<Scene>,
    /// Scene, estimator, K, samples per pixel and size, in words.
    pub label: String,
    /// Light that the reference finds only by rare paths, in words.
    pub rare_paths: Option<String>,
}

/// Loads the scene or the run that `--against` names.
pub fn source(args: &Diagnose, against: &str) -> Result<Source, Failure> {
    let path = Path::new(against);
    if path.is_dir() || path.file_name().is_some_and(|n| n == "summary.json") {
        if let Some(flag) = args.shared.changes.first() {
            let what = format!("{flag} changes a scene, and {against} is a finished run");
            return Err(usage(&what, "give the scene itself to --against"));
        }
        return finished(path);
    }
    let (description, hash) = open::description(against, &args.shared.changes, None)?;
    Ok(Source { name: description.name.clone(), hash, description: Some(description), run: None })
}

/// Reads a run of this program: its terms, and the scene that its command names.
fn finished(path: &Path) -> Result<Source, Failure> {
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new(".")) };
    let record = summary::read(&folder.join("summary.json"))?;
    let image = exr::read(&folder.join("terms.exr"))?;
    let mut layers = vec![];
    let mut add = |slot: Slot, name: &str| {
        let pair = image.layer(name).zip(image.layer(&format!("{name}_se")));
        if let Some((mean, error)) = pair {
            layers.push(Layer { slot, mean: mean.to_vec(), std_error: Some(error.to_vec()) });
        }
    };
    for k in 0..=record.max_bounces.min(usize::from(MOST_BOUNCES)) {
        add(Slot::Term(k), &format!("T{k:02}"));
    }
    add(Slot::Tail, "tail");
    add(Slot::Whole, if image.layer("Tall").is_some() { "Tall" } else { "path" });
    if layers.is_empty() {
        return Err(Failure::Input(format!(
            "error: the run left neither terms nor a path tracer's image\n  --> {}\nhelp: give a run of `fredholm series`",
            folder.join("terms.exr").display()
        )));
    }
    let pictures = Pictures { size: [image.width, image.height], layers, code: Code::Float, step: vec![] };
    let description = scene_of(&record.command);
    if description.is_none() {
        note("note: the scene of that run cannot be loaded again; no candidates are simulated");
    }
    let label = format!("{}: {}, {} spp", path.display(), record.command, record.spp);
    Ok(Source {
        name: record.scene,
        hash: record.scene_hash,
        description,
        run: Some((label, pictures, record.spp as f64)),
    })
}

/// The commands that render a scene.
#[derive(Parser)]
struct Rendered {
    #[command(subcommand)]
    command: Option<Renders>,
    #[command(flatten)]
    tour: Tour,
}

#[derive(Subcommand)]
enum Renders {
    Tour(Tour),
    Series(Series),
    Render(Render),
}

/// The scene that a command of this program renders, or `None` if it renders none or the scene cannot be loaded.
fn scene_of(command: &str) -> Option<Description> {
    let Rendered { command, tour } = Rendered::try_parse_from(shlex::split(command)?).ok()?;
    let (frame, shared) = match command {
        None => (tour.frame, tour.shared),
        Some(Renders::Tour(args)) => (args.frame, args.shared),
        Some(Renders::Series(args)) => (args.solving.frame, args.shared),
        Some(Renders::Render(args)) => (args.frame, args.shared),
    };
    Some(load::scene(&frame.scene, &shared.changes.options(None)).ok()?.description)
}

impl Source {
    /// Refuses a picture that has too few pixels, or another size or shape than the reference.
    pub fn suits(&self, name: &str, size: [usize; 2]) -> Result<(), Failure> {
        let fewest = regions::FEWEST;
        if size[0] * size[1] < fewest {
            return Err(Failure::Input(format!(
                "error: {}×{} pixels are too few to tell a bias from noise\n  --> {name}\nhelp: render at least {fewest} pixels",
                size[0], size[1]
            )));
        }
        match &self.run {
            Some((_, pictures, _)) if pictures.size != size => Err(size_mismatch(name, size, pictures.size)),
            // a picture with a caption, a crop: the camera of the scene makes no such picture
            None => match self.description.as_ref().map(|d| d.camera.size.map(|s| s as usize)) {
                Some([w, h]) if size[0] * h != size[1] * w => Err(Failure::Input(format!(
                    "error: the picture has {}×{} pixels and the scene {w}×{h}: their aspect ratios differ\n  --> {name}\n\
                     help: do not crop the picture or add a caption, or set the camera: --set camera.size=[{},{}]",
                    size[0], size[1], size[0], size[1]
                ))),
                _ => Ok(()),
            },
            _ => Ok(()),
        }
    }

    /// The reference at a size, with terms up to K.
    pub fn right(
        &self,
        args: &Diagnose,
        size: [usize; 2],
        max_bounces: usize,
        progress: Progress<'_>,
    ) -> Result<Right, Failure> {
        let factor = shrink_factor(size, WIDEST);
        let small = size.map(|s| (s / factor) as u32);
        let scene = self.description.as_ref().map(|d| {
            let mut d = d.clone();
            d.camera.size = small;
            with_last_resort(Scene::new(&d))
        });
        let seen = scene.as_ref().map_or(Seen { regions: vec![], edges: vec![] }, regions::seen);
        if let Some((label, pictures, samples)) = &self.run {
            let pictures = pictures.shrunk(factor);
            let spp = *samples * (factor * factor) as f64;
            return Ok(Right { pictures, factor, spp, seen, scene, label: label.clone(), rare_paths: None });
        }
        let scene = scene.ok_or_else(|| Failure::Input("error: no scene\nhelp: give one to --against".into()))?;
        let pixels = u64::from(small[0]) * u64::from(small[1]);
        let spp = args.spp.unwrap_or((8_000_000 / pixels).clamp(16, 4096) as u32);
        let usual = Settings::default();
        let roulette = usual.path_roulette.clone().after(max_bounces);
        let settings = Settings { spp, seed: own_seed(args.seed), max_bounces, roulette, ..usual };
        preflight::fits_in_memory(&settings, small)?;
        preflight::light_is_lost(&scene, &settings, &[World::Terms])?;
        let result = by_rays::terms(&scene, Estimator::Prefix, &settings, progress);
        let missing = result.series.unsampled.iter().map(|u| format!("from k = {} on: {}", u.from, u.what));
        for missing in missing {
            note(&format!("note: not supported by the reference, {missing}"));
        }
        let rare_paths = notes::doubts(std::iter::once(&result.series)).into_iter().next();
        let label = format!(
            "{}, {}, k ≤ {max_bounces}, {spp} spp at {}×{}",
            self.name, result.series.label, small[0], small[1]
        );
        let spp = f64::from(result.spp);
        Ok(Right { pictures: Pictures::of(&result, small), factor, spp, seen, scene: Some(scene), label, rare_paths })
    }
}

#[cfg(test)]
mod tests {
    use shlex::split;

    /// What this program writes as its command is read back as the same words.
    #[test]
    fn quoted_words_stay_together() {
        let of = |command, words: &[&str]| {
            assert_eq!(split(command).as_deref(), Some(&words.iter().map(|w| w.to_string()).collect::<Vec<_>>()[..]))
        };
        of("fredholm series a --set 'x=[1, 2]'", &["fredholm", "series", "a", "--set", "x=[1, 2]"]);
        of(r"info 'it'\''s'", &["info", "it's"]);
    }
}
