//! What every command does first: threads, the scene as the options change it, what the loader warns of.

use super::{Failure, args::Run, output, solve};
use clap::Args;
use fredholm::engine::known::coplanar;
use fredholm::engine::known::resort::with_last_resort;
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Description, Scene};
use std::path::PathBuf;

/// What changes a scene.
#[derive(Clone, Debug, Args)]
pub struct Changes {
    /// Override a key of the scene
    ///
    /// For example materials.white.reflectance=[0.6,0.6,0.6]
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Let a material emit: lamp=17,12,4
    #[arg(long, value_name = "MATERIAL=R,G,B")]
    pub emit: Vec<String>,
    /// Take every surface for Lambertian, with its albedo as one colour: what a matrix can hold
    ///
    /// Another scene with another solution, for every world. Glass is black.
    #[arg(long)]
    pub lambertian: bool,
}

impl Changes {
    /// The same, and a size in pixels.
    pub fn options(&self, size: Option<[u32; 2]>) -> Options {
        let size = size.map(|[w, h]| format!("camera.size=[{w},{h}]"));
        Options {
            set: self.set.iter().cloned().chain(size).collect(),
            emit: self.emit.clone(),
            lambertian: self.lambertian,
        }
    }

    /// The first option that is given, if any is.
    pub fn first(&self) -> Option<&'static str> {
        let given =
            [("--set", !self.set.is_empty()), ("--emit", !self.emit.is_empty()), ("--lambertian", self.lambertian)];
        given.iter().find(|f| f.1).map(|f| f.0)
    }
}

/// What every study of a scene takes.
#[derive(Clone, Debug, Args)]
pub struct Shared {
    /// How the scene is changed.
    #[command(flatten)]
    pub changes: Changes,
    /// Output folder [default: one in fredholm-out, named after scene and study]
    ///
    /// The same command replaces its own output. Where another run's stands, the default becomes
    /// NAME-2, and a folder given here is refused without --force.
    #[arg(short, long, value_name = "DIR", verbatim_doc_comment)]
    pub out: Option<PathBuf>,
    /// Replace what another run left in the output folder
    #[arg(long)]
    pub force: bool,
    /// Threads [default: all]; results do not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Print JSON instead of tables
    #[arg(long)]
    pub json: bool,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
}

/// A scene ready to be worked on.
pub struct Opened {
    /// The command that opened it, as anyone would type it again.
    pub command: String,
    pub description: Description,
    pub scene: Scene,
    pub hash: String,
}

/// Sets the number of threads, where one was asked for.
pub fn threads(n: Option<u16>) -> Result<(), Failure> {
    if let Some(n) = n {
        rayon::ThreadPoolBuilder::new().num_threads(n.into()).build_global()?;
    }
    Ok(())
}

/// The scene of that name, changed by the options; warnings go to stderr.
pub fn scene(name: &str, changes: &Changes, size: Option<[u32; 2]>) -> Result<Opened, Failure> {
    let loaded = load::scene(name, &changes.options(size))?;
    loaded.warnings.iter().for_each(|w| super::note(&format!("warning: {w}")));
    let scene = with_last_resort(Scene::new(&loaded.description));
    coplanar(&scene);
    let hash = solve::scene_hash(&loaded.canonical);
    Ok(Opened { command: output::canonical_command(), description: loaded.description, scene, hash })
}

/// Surfaces that coincide and are seen, though nothing says which of them: a warning each, up to a few.
pub fn coplanar(scene: &Scene) {
    const SHOWN: usize = 4;
    let seen = coplanar::seen(scene);
    for c in seen.iter().take(SHOWN) {
        super::note(&format!("warning: {}; nothing says which is seen", coplanar::conflict(c)));
    }
    match seen.len() {
        0 => return,
        n if n > SHOWN => super::note(&format!("warning: … and {} more pairs that coincide", n - SHOWN)),
        _ => {}
    }
    super::note("help: move one of them by a thousandth of the scene; until then comparisons have no verdict");
}

/// Threads and scene of a command that renders.
pub fn run(run: &Run) -> Result<Opened, Failure> {
    threads(run.shared.threads)?;
    let opened = scene(&run.scene, &run.shared.changes, run.size)?;
    Ok(Opened { scene: opened.scene.select_lights(run.lights), ..opened })
}
