//! The shipped scenes at small size, two of the test's own, and what is hard in each.

use super::array::Combination;
use super::measure::K;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::Technique;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::builtin;
use fredholm::scene::description::{Description, Geometry, LightDescription};
use fredholm::scene::load::{self, Options};
use glam::DVec3;

/// What a walk must be lucky to find. A sample that never met it shows neither its light nor its noise, so that its mean is
/// too low and its error too small: no t-test is honest there, however many replicates.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hard {
    /// Small lamps behind mirrors or glass. From the eye they are hit by luck, from k = 1 on.
    pub mirrors: bool,
    /// Lobes so narrow, beside lamps or a point, that uniform or cosine directions hardly meet them, nor do connections.
    pub lobes: bool,
    /// Light touches what it lights: connections alone have a 1/r² without a bound.
    pub touching: bool,
    /// With mirrors or lobes: the terms that walks from both ends find without luck. Not those whose paths have a lobe or a
    /// mirror at both ends, E S D S L: they are hit by luck too.
    pub both_ends: &'static [usize],
}

/// A scene of the test.
pub struct Case {
    pub name: &'static str,
    pub description: Description,
    pub hard: Hard,
}

/// All scenes: those of the binary, and two with everything in them that is found without luck, so that every rule can be judged
/// with every estimator.
pub fn all() -> Vec<Case> {
    let shipped = builtin::ALL.iter().map(|b| Case { name: b.name, description: small(b.name), hard: hard(b.name) });
    shipped.chain([lens_room(), point_room()]).collect()
}

fn hard(name: &str) -> Hard {
    let easy = Hard::default();
    match name {
        "furnace" => Hard { touching: true, ..easy },
        "cornell-spheres" | "mirror-corridor" | "veach-ajar" => Hard { mirrors: true, both_ends: &[2], ..easy },
        // the lamp is a speck in the ball, but its light on the floor is all of T³
        "caustic" => Hard { mirrors: true, both_ends: &[3], ..easy },
        "veach-mis" | "env-ggx" => Hard { lobes: true, both_ends: &[1, 2], ..easy },
        _ => easy,
    }
}

/// A scene of the binary in a picture of about 16² pixels with its own aspect.
fn small(name: &str) -> Description {
    let mut d = load::scene(name, &Options::default()).unwrap().description;
    let [w, h] = d.camera.size;
    let wide = 16.0 * (f64::from(w) / f64::from(h)).sqrt();
    d.camera.size = [wide.round() as u32, (256.0 / wide).round() as u32];
    d
}

/// The room of the mirror and the glass sphere under a lamp so wide that every walk finds it.
fn lens_room() -> Case {
    let mut d = small("cornell-spheres");
    let lamp = d.shapes.iter_mut().find(|s| s.emission != DVec3::ZERO).unwrap();
    (lamp.geometry, lamp.emission) = (
        Geometry::Quad { origin: DVec3::new(-0.8, 0.8, -0.8), edge_u: DVec3::X * 1.6, edge_v: DVec3::Z * 1.6 },
        DVec3::new(1.0, 0.9, 0.8),
    );
    Case { name: "(lens room)", description: d, hard: Hard::default() }
}

/// The Cornell box with a wide lamp and a point light.
fn point_room() -> Case {
    let mut d = small("cornell");
    let lamp = d.shapes.iter_mut().find(|s| s.emission != DVec3::ZERO).unwrap();
    (lamp.geometry, lamp.emission) = (
        Geometry::Quad { origin: DVec3::new(-0.8, 0.8, -0.8), edge_u: DVec3::X * 1.6, edge_v: DVec3::Z * 1.6 },
        DVec3::new(1.0, 0.9, 0.8),
    );
    d.lights.push(LightDescription::Point { position: DVec3::new(0.1, 0.3, 0.6), intensity: DVec3::splat(0.3) });
    Case { name: "(point room)", description: d, hard: Hard::default() }
}

impl Case {
    /// Whether a combination finds all of a slot (k, or K + 1 for the tail) without luck. It asks for the combination and the
    /// scene, never for a result. `None` for the whole image.
    pub fn steady(&self, c: &Combination, slot: Option<usize>) -> bool {
        let Some(k) = slot else { return (0..=K + 1).all(|k| self.steady(c, Some(k))) };
        let Hard { mirrors, lobes, touching, both_ends } = self.hard;
        let connects = c.technique == Technique::Connect;
        // the tail of the bidirectional estimator is a walk from the eye
        let from_eye = !matches!(c.estimator, Some(Estimator::Light | Estimator::Bidirectional))
            || c.estimator == Some(Estimator::Bidirectional) && k > K;
        match c.estimator {
            _ if k == 0 => true,
            _ if lobes && c.sampling != Sampling::Bsdf => false,
            _ if from_eye && touching && connects => false,
            // a lobe is met by directions that suit it, and a lamp by connections: only both find it
            _ if from_eye && lobes => k == 1 && matches!(c.technique, Technique::Mis | Technique::Power),
            _ if from_eye => !mirrors,
            Some(Estimator::Light) => !(mirrors || lobes),
            _ => !(mirrors || lobes) || both_ends.contains(&k),
        }
    }
}
