//! Loads a scene with the changes of the command line, and prints the loader's warnings.

use super::base::{Failure, note};
use super::options::Changes;
use fredholm::engine::known::coplanar;
use fredholm::engine::known::resort::with_last_resort;
use fredholm::scene::load;
use fredholm::scene::{Description, Scene};

/// A loaded scene: as data, ready for rays, and its hash.
pub struct Opened {
    pub description: Description,
    pub scene: Scene,
    /// Hash of the scene as loaded.
    pub hash: String,
}

/// Loads a scene, with changes and an image size. Warnings go to stderr.
pub fn scene(name: &str, changes: &Changes, size: Option<[u32; 2]>) -> Result<Opened, Failure> {
    let (description, hash) = description(name, changes, size)?;
    let scene = with_last_resort(Scene::new(&description));
    coplanar(&scene);
    Ok(Opened { description, scene, hash })
}

/// Loads a scene as data, with its hash.
pub fn description(name: &str, changes: &Changes, size: Option<[u32; 2]>) -> Result<(Description, String), Failure> {
    let loaded = load::scene(name, &changes.options(size))?;
    loaded.warnings.iter().for_each(|w| note(&format!("warning: {w}")));
    Ok((loaded.description, hash(&loaded.canonical)))
}

/// FNV-1a hash of a scene as loaded.
pub fn hash(canonical: &str) -> String {
    format!("{:016x}", fredholm::math::fnv1a(canonical.bytes()))
}

/// Prints up to four warnings for pairs of visible surfaces that coincide, because the renderer cannot decide which one is visible.
pub fn coplanar(scene: &Scene) {
    const SHOWN: usize = 4;
    let seen = coplanar::seen(scene);
    for c in seen.iter().take(SHOWN) {
        note(&format!("warning: {}; the renderer cannot decide which one is visible", coplanar::conflict(c)));
    }
    match seen.len() {
        0 => return,
        n if n > SHOWN => note(&format!("warning: {} more pairs of surfaces coincide", n - SHOWN)),
        _ => {}
    }
    note("help: move one of them by a thousandth of the scene's size; until then comparisons have no verdict");
}
