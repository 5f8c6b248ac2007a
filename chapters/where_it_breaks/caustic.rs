//! The caustic of a glass ball under a light without area: paths from the eye cannot find it, paths from the light can.
//!
//! ```text
//! T³E at the floor:  eye ← floor ← glass ← glass ← light      the caustic; P(a path from the eye takes it) = 0
//!                    eye ← floor ← glass ← floor ← light      the floor, reflected by the ball; found from both ends
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T³E | mean over a picture that shows only the floor below the ball | [`Caustic`] |
//! | eye, light | where the paths start | [`caustic`] |
//!
//! The ball refracts every direction into one direction (or reflects it into one). Among the directions at the floor that enter
//! the ball, finitely many leave it exactly towards a light without area.
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), chapter 8.

use fredholm::engine::{Settings, by_rays, by_rays::Estimator};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, builtin, load};
use fredholm::terms::Series;
use std::path::Path;

/// The caustic, from both ends.
#[derive(Clone)]
pub struct Caustic {
    /// T³E by paths from the eye, and by paths from the light.
    pub t3: [Number; 2],
    /// All light by paths from the light.
    pub all: Number,
    /// The light that the library says paths from the eye cannot find.
    pub note: Option<String>,
}

/// What lights the ball.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Lamp {
    /// A point with the radiant intensity 5 W/sr.
    Point,
    /// The disk of the scene `caustic`.
    Disk,
}

// ANCHOR: caustic
/// T³E on the floor below the ball, by paths from the eye and by paths from the light.
pub fn caustic(folder: &Folder<'_>, lamp: Lamp) -> book::Result<Caustic> {
    let scene = scene(lamp)?;
    let settings = Settings { spp: folder.pick(256, 64), max_bounces: 4, seed: folder.seed, ..Settings::default() };
    let [eye, light] =
        [Estimator::Prefix, Estimator::Light].map(|e| by_rays::terms(&scene, e, &settings, folder.progress));
    let t3 = |s: &Series| Number::from(&s.image().terms[3]);
    let note = eye.series.unsampled.first().map(|paths| paths.what.clone());
    Ok(Caustic { t3: [t3(&eye.series), t3(&light.series)], all: (&light.series.image().total).into(), note })
}
// ANCHOR_END: caustic

/// The scene `caustic`, seen from below the ball, so that the ball itself is outside the picture.
fn scene(lamp: Lamp) -> book::Result<Scene> {
    let source = builtin::find("caustic").ok_or("there is no scene `caustic`")?.source;
    let set = ["camera.origin=[0.85, 0.3, 0.6]", "camera.target=[0.34, 0, 0.17]", "camera.size=[32, 32]"];
    let options = load::Options { set: set.map(String::from).to_vec(), ..Default::default() };
    let point = "\n[[lights]]\ntype = \"point\"\nposition = [-0.8, 3, -0.4]\nintensity = [5, 5, 5]\n";
    let text = if lamp == Lamp::Point { source.to_owned() + point } else { source.to_owned() };
    let mut room = load::toml(&text, Path::new("caustic"), &options)?.description;
    if lamp == Lamp::Point {
        room.shapes.retain(|shape| shape.name != "lamp");
    }
    Ok(Scene::new(&room))
}
