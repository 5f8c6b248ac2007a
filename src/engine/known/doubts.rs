//! What the samples of a result cannot know: light that a way of sampling meets only by chance in a scene, and how often it is to be
//! expected to. A short walk that connects to the lamps tells it without meeting any.
//!
//! ```text
//! a hit where a connection is found:     x_s p_s = x_c p_c      ⟹      E[x_s²] = E[x_c² p_c/p_s]
//! events of N paths:                     n = N (E x_c)² / E[x_c² p_c/p_s]
//! ```
//!
//! | way | meets by chance | events of a path |
//! |---|---|---|
//! | walks from the eye, with connections | lamps that the eye sees in mirrors or glass, k ≥ 1 | P(the eye sees mirror or glass) × that of k = 1 below |
//! | walks from the eye, `scatter` | lamps | as above, term by term |
//! | walks from the eye, with connections | lamps through mirrors or glass (caustics), k ≥ 2 | P(a step meets mirror or glass) × the same of k = 1 |
//! | walks from both ends | the same where the eye sees it in mirrors or glass, k ≥ 3 | × P(the eye sees mirror or glass) |
//! | walks from the light | what the camera sees | area in view over area of the scene |
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_c, p_c | a connection's contribution, and its density | `Pilot` |
//! | x_s, p_s | the same path found by scattering | `Pilot` |
//! | n | [`Doubt::per_path`] × N | [`doubts`] |
//!
//! **What it does not know**: a small bright lamp in view beside a large dim one (k = 0), light behind a keyhole or a door, lobes of rough metal, lamps that no vertex of the short walk sees. It is
//! right to an order of magnitude, which is what is asked of it.

use crate::engine::Settings;
use crate::engine::estimator::{Begins, Estimator};
use crate::estimator::Technique;
use crate::math::{Key, Purpose, Rng};
use crate::operator::{SceneTransport, Sensor, Transport};
use crate::scene::{Scene, SurfaceSensor, Vertex};
use crate::terms::Doubt;

/// Walks of the pilot, and vertices of each from which it connects.
const WALKS: u32 = 1024;
const DEEPEST: usize = 4;
/// What fewer paths meet is met by chance.
const BY_CHANCE: f64 = 0.1;

/// The doubts about an estimator (`None` for the path tracer) in a scene.
pub fn doubts(scene: &Scene, estimator: Option<Estimator>, settings: &Settings) -> Vec<Doubt> {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let doubt = |what: &str, from: usize, per_path: f64| Doubt { what: what.to_owned(), from, per_path };
    let delta = scene.any_delta_surface();
    let mut found = match estimator.map_or(Begins::AtEye, Estimator::begins) {
        Begins::AtLight => vec![doubt("what the camera sees", 1, share_in_view(&t))],
        Begins::AtBoth if delta => {
            let p = Pilot::walk(&t);
            let what = "lamps through mirrors or glass that the eye sees in mirrors or glass";
            vec![doubt(what, 3, p.starts * p.steps * p.hits(1))]
        }
        Begins::AtBoth => vec![],
        _ if settings.technique == Technique::Scatter => {
            let p = Pilot::walk(&t);
            (1..=DEEPEST).filter(|&k| p.sum[k] > 0.0).map(|k| doubt("lamps", k, p.hits(k))).collect::<Vec<_>>()
        }
        _ if delta => {
            let p = Pilot::walk(&t);
            vec![
                doubt("lamps seen in mirrors or glass", 1, p.starts.max(0.5 / f64::from(WALKS)) * p.hits(1)),
                doubt("lamps through mirrors or glass (caustics)", 2, p.steps * p.hits(1)),
            ]
        }
        _ => vec![],
    };
    // what one path in ten meets is met often, and samples show how often
    found.retain(|d| d.per_path < BY_CHANCE);
    found
}

/// The area that the camera sees over that of all surfaces.
fn share_in_view(t: &SceneTransport<'_>) -> f64 {
    let camera = &t.scene.camera;
    let pixels = camera.size[0] * camera.size[1];
    let seen = |i: u32| {
        let at = start(t, i)?;
        Some(1.0 / f64::from(camera.density(t, &at)))
    };
    let area = (0..WALKS).filter_map(seen).sum::<f64>() / f64::from(WALKS) * f64::from(pixels);
    (area / SurfaceSensor::new(t.scene).area).min(1.0)
}

/// Where walk `i` begins: on what a random pixel sees.
fn start(t: &SceneTransport<'_>, i: u32) -> Option<Vertex> {
    let [w, h] = t.scene.camera.size;
    let mut rng = Rng::at(Key::new(0, "doubts"), i, 0, 0, Purpose::Start);
    let pixel = ((f64::from(rng.one()) * f64::from(w * h)) as u32).min(w * h - 1);
    t.scene.camera.start(t, pixel, &mut rng).filter(Vertex::on_surface)
}

/// What a short walk from the eye found.
#[derive(Default)]
struct Pilot {
    /// Σ x_c and Σ x_c² p_c/p_s of connections that complete a path of term k.
    sum: [f64; DEEPEST + 1],
    square: [f64; DEEPEST + 1],
    /// Share of the starts, and of the steps from any other surface, that are on mirror or glass.
    starts: f64,
    steps: f64,
}

impl Pilot {
    fn walk(t: &SceneTransport<'_>) -> Self {
        let mut p = Self::default();
        let (mut from, mut onto) = (0.0, 0.0);
        let stream = |i: u32, k: usize, purpose| Rng::at(Key::new(0, "doubts"), i, 0, k, purpose);
        for i in 0..WALKS {
            let Some(mut at) = start(t, i) else { continue };
            let mut weight = crate::math::Rgb::ONE;
            p.starts += f64::from(u8::from(t.scene.bsdf(&at).has_delta())) / f64::from(WALKS);
            for k in 1..=DEEPEST {
                if let Some(c) = t.connect(&at, &mut stream(i, k, Purpose::Connect)).filter(|c| c.other_pdf > 0.0) {
                    let x = f64::from((weight * c.weight * t.emission(&c.state)).element_sum());
                    p.sum[k] += x;
                    p.square[k] += x * x * f64::from(c.pdf) / f64::from(c.other_pdf);
                }
                let mirror = |v: &Vertex| v.on_surface() && t.scene.bsdf(v).has_delta();
                let plain = !mirror(&at);
                let Some(step) = t.scatter(&at, &mut stream(i, k, Purpose::Scatter)) else { break };
                (at, weight) = (step.state, weight * step.weight);
                from += f64::from(u8::from(plain));
                onto += f64::from(u8::from(plain && mirror(&at)));
                if !at.on_surface() {
                    break;
                }
            }
        }
        // none of so many steps: less than one
        p.steps = if from > 0.0 { f64::max(onto, 0.5) / from } else { 0.0 };
        p
    }

    /// So many events of hitting a lamp a path is worth to term k.
    fn hits(&self, k: usize) -> f64 {
        let (sum, square) = (self.sum[k], self.square[k]);
        if square > 0.0 { (sum * sum / square / f64::from(WALKS)).min(1.0) } else { 1.0 }
    }
}
