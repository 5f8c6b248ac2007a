//! The scene as the options change it, and what the loader warns of.

use super::base::{Failure, note};
use super::options::Changes;
use fredholm::engine::known::coplanar;
use fredholm::engine::known::resort::with_last_resort;
use fredholm::scene::load;
use fredholm::scene::{Description, Scene};

/// A scene ready to be worked on.
pub struct Opened {
    pub description: Description,
    pub scene: Scene,
    /// Hash of the scene as loaded.
    pub hash: String,
}

/// The scene of that name, changed by the options; warnings go to stderr.
pub fn scene(name: &str, changes: &Changes, size: Option<[u32; 2]>) -> Result<Opened, Failure> {
    let (description, hash) = description(name, changes, size)?;
    let scene = with_last_resort(Scene::new(&description));
    coplanar(&scene);
    Ok(Opened { description, scene, hash })
}

/// The same as data, with its hash.
pub fn description(name: &str, changes: &Changes, size: Option<[u32; 2]>) -> Result<(Description, String), Failure> {
    let loaded = load::scene(name, &changes.options(size))?;
    loaded.warnings.iter().for_each(|w| note(&format!("warning: {w}")));
    Ok((loaded.description, hash(&loaded.canonical)))
}

/// FNV-1a of a scene as loaded.
pub fn hash(canonical: &str) -> String {
    format!("{:016x}", fredholm::math::fnv1a(canonical.bytes()))
}

/// Surfaces that coincide and are seen, though nothing says which of them: a warning each, up to a few.
pub fn coplanar(scene: &Scene) {
    const SHOWN: usize = 4;
    let seen = coplanar::seen(scene);
    for c in seen.iter().take(SHOWN) {
        note(&format!("warning: {}; nothing says which is seen", coplanar::conflict(c)));
    }
    match seen.len() {
        0 => return,
        n if n > SHOWN => note(&format!("warning: … and {} more pairs that coincide", n - SHOWN)),
        _ => {}
    }
    note("help: move one of them by a thousandth of the scene; until then comparisons have no verdict");
}
