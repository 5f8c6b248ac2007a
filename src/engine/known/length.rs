//! Length of paths, measured on a few of them, from which the cost of a run is predicted.
//!
//! With survival probability ρ and no opening, a path has 1/(1 − ρ) vertices on average: 1000 for ρ = 0.999.

use crate::engine::Settings;
use crate::estimator::{PathTracer, Plan, Roulette};
use crate::math::{Key, Purpose, Rng};
use crate::operator::{SceneTransport, Sensor};
use crate::scene::Scene;
use rayon::prelude::*;
use std::time::Instant;

/// Number of paths that are tried.
const TRIED: u32 = 64;

/// Mean number of rays of a path, and the time that they take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// Rays per path.
    pub rays: f64,
    /// Seconds per path on one thread.
    pub seconds: f64,
}

/// Traces a few paths with a roulette schedule.
pub fn length(scene: &Scene, roulette: &Roulette, settings: &Settings) -> Length {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let tracer = PathTracer(Plan { roulette: roulette.clone(), ..settings.plan() });
    let [w, h] = scene.camera.size.map(u64::from);
    let key = Key::new(settings.seed, "length of paths");
    let started = Instant::now();
    let one = |i: u32| {
        let pixel = (u64::from(i) * w * h / u64::from(TRIED)) as u32;
        let start = scene.camera.start(&t, pixel, &mut Rng::at(key, pixel, i, 0, Purpose::Start))?;
        Some(tracer.radiance(&t, start, key, pixel, i).1)
    };
    let rays: u64 = (0..TRIED).into_par_iter().filter_map(one).sum();
    let threads = rayon::current_num_threads().min(TRIED as usize) as f64;
    let paths = f64::from(TRIED);
    Length { rays: rays as f64 / paths, seconds: started.elapsed().as_secs_f64() * threads / paths }
}
