//! Doubts: light that a sampling method finds only by chance in a scene, and how often it is expected to find it. The
//! samples of a result cannot show this. A short pilot walk that connects to the lamps estimates it, without hitting any
//! lamp.
//!
//! ```text
//! a hit where a connection is found:     x_s p_s = x_c p_c      ⟹      E[x_s²] = E[x_c² p_c/p_s]
//! events of N paths:                     n = N (E x_c)² / E[x_c² p_c/p_s]
//! ```
//!
//! | sampling method | finds by chance | expected events per path |
//! |---|---|---|
//! | walks from the eye, with connections | lamps that the eye sees in mirrors or glass, k ≥ 1 | P(the eye sees mirror or glass) × n/N for k = 1 |
//! | walks from the eye, `scatter` | lamps | n/N, term by term |
//! | walks from the eye, with connections | lamps through mirrors or glass (caustics), k ≥ 2 | P(a step hits mirror or glass) × n/N for k = 1 |
//! | walks from both ends | such caustics, if the eye sees them in mirrors or glass, k ≥ 3 | the same × P(the eye sees mirror or glass) |
//! | walks from the light | surfaces in view of the camera | area in view divided by the area of the scene |
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_c, p_c | contribution of a connection, and its density | `Pilot` |
//! | x_s, p_s | contribution of the same path if scattering finds it, and its density | `Pilot` |
//! | N, n | number of paths, and expected number of events: n = N · [`Doubt::per_path`] | [`doubts`] |
//!
//! **Not detected**: a small bright lamp in view next to a large dim one (k = 0), light behind a keyhole or a door, lobes of
//! rough metal, lamps that no vertex of the pilot walk sees. The estimate is right to an order of magnitude, which is enough
//! for its purpose.

use crate::engine::Settings;
use crate::engine::estimator::{Begins, Estimator};
use crate::estimator::Technique;
use crate::math::{Key, Purpose, Rng};
use crate::operator::{SceneTransport, Sensor, Transport};
use crate::scene::{Scene, SurfaceSensor, Vertex};
use crate::terms::Doubt;

/// Number of pilot walks, and number of vertices of each from which it connects.
const WALKS: u32 = 1024;
const DEEPEST: usize = 4;
/// Light that fewer than this fraction of the paths find counts as found by chance.
const BY_CHANCE: f64 = 0.1;

/// The doubts about an estimator (`None` for the path tracer) in a scene.
pub fn doubts(scene: &Scene, estimator: Option<Estimator>, settings: &Settings) -> Vec<Doubt> {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let doubt = |what: &str, from: usize, per_path: f64| Doubt { what: what.to_owned(), from, per_path };
    let delta = scene.any_delta_surface();
    let mut found = match estimator.map_or(Begins::AtEye, Estimator::begins) {
        Begins::AtLight => vec![doubt("the surfaces in view of the camera", 1, share_in_view(&t))],
        Begins::AtBoth if delta => {
            let p = Pilot::walk(&t);
            let what = "caustics that the eye sees in mirrors or glass";
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
                doubt("caustics (lamps through mirrors or glass)", 2, p.steps * p.hits(1)),
            ]
        }
        _ => vec![],
    };
    // light that one path in ten finds is found often, and the samples show how often
    found.retain(|d| d.per_path < BY_CHANCE);
    found
}

/// Area that the camera sees, divided by the area of all surfaces.
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

/// Start of walk `i`: a point on what a random pixel sees.
fn start(t: &SceneTransport<'_>, i: u32) -> Option<Vertex> {
    let [w, h] = t.scene.camera.size;
    let mut rng = Rng::at(Key::new(0, "doubts"), i, 0, 0, Purpose::Start);
    let pixel = ((f64::from(rng.one()) * f64::from(w * h)) as u32).min(w * h - 1);
    t.scene.camera.start(t, pixel, &mut rng).filter(Vertex::on_surface)
}

/// Results of the pilot walks from the eye.
#[derive(Default)]
struct Pilot {
    /// Σ x_c and Σ x_c² p_c/p_s of connections that complete a path of term k.
    sum: [f64; DEEPEST + 1],
    square: [f64; DEEPEST + 1],
    /// Fraction of the starts, and of the steps from any other surface, that land on mirror or glass.
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
        // if no step landed there, count half a step, because the fraction is below one step
        p.steps = if from > 0.0 { f64::max(onto, 0.5) / from } else { 0.0 };
        p
    }

    /// Expected number of lamp hits per path in term k.
    fn hits(&self, k: usize) -> f64 {
        let (sum, square) = (self.sum[k], self.square[k]);
        if square > 0.0 { (sum * sum / square / f64::from(WALKS)).min(1.0) } else { 1.0 }
    }
}
