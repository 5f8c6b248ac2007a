//! Rays in a room that follow a map: the Cornell box with its lamp turned to the ceiling.
//!
//! ```text
//! p(ω) = cos θ/π · (β + (1 − β) v(ω)/mean v)        weight of a step  ρ (cos θ/π)/p(ω)        v: a radiosity solution
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | v | light that arrives at a patch, by direction, from a coarse radiosity solution | `Guide` |
//! | β | part of the directions that ignore the map, 0.2 | `Recipe` |
//! | T²E | light after two reflections; connections to the lamp find the last step of it | [`Seen`] |
//!
//! The map chooses directions, and the density p of a direction is known exactly. So the mean does not depend on v.
//!
//! Reference: Vorba and others, *On-line learning of parametric mixture models for light transport simulation* (2014).

use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator, Sampled};
use fredholm::engine::guided::Prepared;
use fredholm::engine::passes::Watch;
use fredholm::estimator::Roulette;
use fredholm::guide::{Guide, Recipe, incident::Fineness};
use fredholm::math::Key;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Description, Scene, load};
use std::time::Duration;

/// The term that is looked at: light after two reflections.
pub const TERM: usize = 2;
/// The last term of the picture.
const LAST: usize = 3;
/// The names of the maps, in the order of all lists.
pub const MAPS: [&str; 3] = ["no map", "map of this room", "map of another room"];

/// The term and the picture, seen with one map.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Mean of T²E over the picture, in red.
    pub mean: Number,
    /// Variance of T²E: mean over the pixels and channels.
    pub variance: Number,
    /// Variance of the whole picture, k ≤ 3.
    pub whole: Number,
    /// T²E by pixel.
    pub picture: Vec<[f32; 3]>,
}

/// A square lamp with sides of 0.2 m: its corner and its edges. It faces the direction of u × v.
type Lamp = [&'static str; 3];
/// Below the ceiling, facing up.
const UP: Lamp = ["[-0.1, 0.7, -0.1]", "[0, 0, 0.2]", "[0.2, 0, 0]"];
/// In front of the right wall, facing it.
const ASIDE: Lamp = ["[0.8, -0.6, 0.5]", "[0, 0.2, 0]", "[0, 0, 0.2]"];

/// The Cornell box with another lamp.
fn room([corner, u, v]: Lamp, pixels: usize) -> book::Result<Description> {
    let key = |name: &str, value: &str| format!("shapes.5.{name}={value}");
    let size = format!("camera.size=[{pixels}, {pixels}]");
    let set = vec![key("origin", corner), key("edge_u", u), key("edge_v", v), size];
    Ok(load::scene("cornell", &load::Options { set, ..Default::default() })?.description)
}

/// Number of pixels of a side of the pictures.
pub fn pixels(folder: &Folder<'_>) -> usize {
    folder.pick(96, 32)
}

// ANCHOR: seen
/// The room with the lamp turned up: without a map, with its own map, and with the map of the room whose lamp is aside.
pub(super) fn seen(folder: &Folder<'_>) -> book::Result<[Seen; 3]> {
    let (up, aside) = (room(UP, pixels(folder))?, room(ASIDE, pixels(folder))?);
    let settings = Settings {
        seed: folder.seed,
        spp: folder.pick(512, 1536),
        max_bounces: LAST,
        roulette: Roulette::Never,
        ..Settings::default()
    };
    let scene = Scene::new(&up);
    let plain = by_rays::terms(&scene, Estimator::Prefix, &settings, folder.progress);
    let follow = |other: &Description| -> book::Result<Sampled> {
        let guided = map(folder, other)?.terms(&scene, Estimator::Prefix, &settings, folder.progress, Watch::NONE);
        Ok(guided.ok_or("this estimator follows no map")?)
    };
    Ok([plain, follow(&up)?, follow(&aside)?].map(|sampled| Seen::of(&sampled)))
}
// ANCHOR_END: seen

/// A map of a room: a radiosity solution with few patches.
fn map(folder: &Folder<'_>, room: &Description) -> book::Result<Prepared> {
    let fineness = Fineness { rays: folder.pick(8, 4), connections: 32 };
    let recipe = Recipe { patches: folder.pick(300, 150), fineness, ..Recipe::default() };
    let guide = Guide::new(room, recipe, Key::new(folder.seed, "guide"), folder.progress)?;
    Ok(Prepared { guide: guide.ok_or("the program was stopped")?, recipe, time: Duration::ZERO })
}

impl Seen {
    fn of(sampled: &Sampled) -> Self {
        let last = sampled.snapshots.last();
        let variance = |v: Option<(f64, f64)>| {
            let (value, std_error) = v.unwrap_or((f64::NAN, f64::NAN));
            Number { value, std_error }
        };
        Self {
            mean: Number::from(&sampled.series.image().terms[TERM]),
            variance: variance(last.map(|s| (s.slots[TERM].value, s.slots[TERM].std_error))),
            whole: variance(last.map(|s| (s.total.value, s.total.std_error))),
            picture: sampled.terms[TERM].mean.clone(),
        }
    }
}
