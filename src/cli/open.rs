//! What every command does first: threads, the scene as the options change it, what the loader warns of.

use super::{Failure, args::Run, output, solve};
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Description, Scene};

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

/// The scene of that name, changed by `--set`, `--emit` and `--size`; warnings go to stderr.
pub fn scene(name: &str, set: &[String], emit: &[String], size: Option<[u32; 2]>) -> Result<Opened, Failure> {
    let mut set = set.to_vec();
    set.extend(size.map(|[w, h]| format!("camera.size=[{w},{h}]")));
    let loaded = load::scene(name, &Options { set, emit: emit.to_vec() })?;
    loaded.warnings.iter().for_each(|w| super::note(&format!("warning: {w}")));
    let scene = Scene::new(&loaded.description);
    let hash = solve::scene_hash(&loaded.canonical);
    Ok(Opened { command: output::canonical_command(), description: loaded.description, scene, hash })
}

/// Threads and scene of a command that renders.
pub fn run(run: &Run) -> Result<Opened, Failure> {
    threads(run.threads)?;
    let opened = scene(&run.scene, &run.set, &run.emit, run.size)?;
    Ok(Opened { scene: opened.scene.select_lights(run.lights), ..opened })
}
