//! Which bounce lights which surface?
//!
//! ```text
//! share of bounce k on the surface S:   ⟨S, T^k E⟩ / Σ_{j≥1} ⟨S, T^j E⟩        ⟨S, L⟩ = ∫_S ∫ L cos θ dω dA / (π |S|)
//! ```
//!
//! | symbol | type | meaning | place |
//! |---|---|---|---|
//! | S | | all shapes of one name | [`Lit::name`] |
//! | \|S\| | `f64` | its area, m² | [`Lit::area`] |
//! | ⟨S, T^k E⟩ | [`Replicates`] | mean radiance that leaves S after exactly k reflections | [`Lit::terms`] |
//!
//! Emission (k = 0) is not counted: the question is where reflected light comes from. A surface that no lamp sees has no share of
//! k = 1; the first bounce with a share is the one that lights it.

use super::strip;
use crate::engine::Settings;
use crate::engine::by_rays::Estimator;
use crate::operator::{SceneTransport, SurfaceStrip};
use crate::progress::Progress;
use crate::scene::{Description, Scene, Side, SurfaceSensor, bsdf::Sampling};
use crate::stats::Evidence;
use crate::terms::functional::Replicates;

/// The last bounce that is told from longer paths.
pub const LAST: usize = 5;
/// Surfaces that are measured separately; smaller ones are measured together.
const MOST: usize = 6;
/// Pixels of the sensor, each of them the whole surface.
const PIXELS: u32 = 64;
/// Paths of each surface at most.
const MOST_PATHS: u32 = 1 << 18;

/// The light that leaves one surface, bounce by bounce.
#[derive(Clone, Debug)]
pub struct Lit {
    /// Name of its shapes, or `the rest` for all small surfaces together.
    pub name: String,
    /// Area of its sides that take part in light transport, m².
    pub area: f64,
    /// Mean radiance of the terms k = 0..=5 and of everything longer.
    pub terms: Replicates,
}

impl Lit {
    /// The shares of k = 1, 2, …, 5 and of longer paths in the reflected light, averaged over the channels; NaN where the
    /// surface is dark. A share that rests on too few paths to have an error is NaN, too.
    pub fn shares(&self) -> Vec<f64> {
        let slots = self.terms.mean.len();
        let mean = |k: usize| self.terms.mean[k].element_sum();
        let reflected: f64 = (1..slots).map(mean).sum();
        let share = |k: usize| {
            let known = mean(k) == 0.0 || Evidence::of(&self.terms.estimate(k..k + 1)).no_error.is_none();
            if known { mean(k) / reflected } else { f64::NAN }
        };
        (1..slots).map(share).collect()
    }
}

/// Measures every surface with about `paths` paths: the largest by name, the small ones together. Empty where the variance of
/// the paths is not known to be finite, or if the work was stopped.
///
/// ```
/// use fredholm::engine::Settings;
/// use fredholm::progress::Progress;
/// use fredholm::scene::{Scene, load};
/// use fredholm::study::lit::lit;
///
/// let room = load::scene("cornell", &load::Options::default())?.description;
/// let scene = Scene::new(&room);
/// let surfaces = lit(&room, &scene, 1 << 12, &Settings::default(), Progress::NONE);
/// let of = |name: &str| surfaces.iter().find(|s| s.name == name).map(|s| s.shares()[0]);
/// // the lamp lights the floor at once; the ceiling, above it, waits for the second bounce
/// assert!(of("floor") > Some(0.5) && of("ceiling") == Some(0.0));
/// # Ok::<(), fredholm::scene::SceneError>(())
/// ```
pub fn lit(
    description: &Description,
    scene: &Scene,
    paths: u32,
    settings: &Settings,
    progress: Progress<'_>,
) -> Vec<Lit> {
    let Some(settings) = strip::settings(scene, LAST, LAST, settings) else { return vec![] };
    let t = SceneTransport { scene, sampling: Sampling::Bsdf };
    let paths = paths.min(MOST_PATHS);
    let surfaces = surfaces(description, scene);
    let samples = u64::from(strip::samples(paths, PIXELS)) * u64::from(PIXELS);
    progress.begin("light by surface", surfaces.len() as u64 * samples);
    let mut found = vec![];
    for (name, sides) in surfaces {
        let strip = SurfaceStrip { sensor: SurfaceSensor::of(scene, sides), pixels: PIXELS };
        let stream = format!("light of {name}");
        let terms = strip::means(&t, &strip, Estimator::Prefix, &stream, paths, &settings, progress);
        if progress.stopped() {
            return vec![];
        }
        found.push(Lit { name, area: strip.sensor.area, terms });
    }
    found
}

/// The sides of every surface that take part in light transport, by the name of their shape, in the order of the scene file;
/// the smallest ones together, last.
fn surfaces(description: &Description, scene: &Scene) -> Vec<(String, Vec<Side>)> {
    let mut all: Vec<(String, Vec<Side>)> = vec![];
    for (i, (shape, _)) in description.primitives().iter().enumerate() {
        let name = &description.shapes[*shape].name;
        let sides = [2 * i as Side, 2 * i as Side + 1].into_iter().filter(|&s| scene.takes_part(s));
        match all.iter_mut().find(|(known, _)| known == name) {
            Some((_, known)) => known.extend(sides),
            None => all.push((name.clone(), sides.collect())),
        }
    }
    all.retain(|(_, sides)| !sides.is_empty());
    if all.len() <= MOST {
        return all;
    }
    let area = |i: usize| all[i].1.iter().map(|&s| scene.area(s)).sum::<f64>();
    let mut largest: Vec<usize> = (0..all.len()).collect();
    largest.sort_by(|&a, &b| area(b).total_cmp(&area(a)));
    largest.truncate(MOST - 1);
    let (mut large, mut rest) = (vec![], vec![]);
    for (i, (name, sides)) in all.into_iter().enumerate() {
        if largest.contains(&i) { large.push((name, sides)) } else { rest.extend(sides) }
    }
    large.push(("the rest".into(), rest));
    large
}
