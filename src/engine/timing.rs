//! Wall-clock time of a sample, measured by a short pilot.
//!
//! ```text
//! t(n) = a + b n      b = (t(2m) − t(m))/m
//! ```
//!
//! A render of n samples per pixel takes the time t(n). The constant a is the time for the first touch of the memory and the
//! start of the threads; b, the time of a sample, is what remains in a long render. The pilot doubles its samples, and b is read
//! from its last pass. It depends on the machine and on its load.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | samples per pixel | |
//! | b | seconds per sample of every pixel | [`seconds_per_sample`] |
//!
//! Reference: Glynn and Whitt, *Operations Research* 40 (1992), on efficiency per time.

use super::by_rays::film;
use super::passes::Passes;
use super::{Settings, by_rays::Estimator};
use crate::estimator::render::Amount;
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::terms::TermFilm;
use std::time::{Duration, Instant};

/// The last pass of a pilot shall take at least this time, so that the clock measures it well.
const LEAST: Duration = Duration::from_millis(50);
/// Most samples per pixel of a pilot.
const MOST: u32 = 1 << 24;
/// Samples per pixel at which all threads work with full waves of paths.
const FULL: u32 = 32;

/// b, the seconds that one sample of every pixel takes. NaN if the pilot was stopped. The pilot has half of `settings.spp` samples,
/// or `FULL` if these are fewer, and more as long as its last pass is too short for the clock.
pub fn seconds_per_sample(scene: &Scene, estimator: Estimator, settings: &Settings, progress: Progress<'_>) -> f64 {
    let t = SceneTransport { scene, sampling: settings.sampling };
    // with one replicate no variance is computed, so that only the sampling is timed
    let amount = Amount { spp: MOST, replicates: 1, key: settings.key("timing", 1) };
    let enough = FULL.min(settings.spp.div_ceil(2));
    let started = Instant::now();
    let mut stands = vec![(0, Duration::ZERO)];
    let mut look = |film: &TermFilm| {
        let (done, now) = (film.least_samples(), started.elapsed());
        let pass = now - stands[stands.len() - 1].1;
        stands.push((done, now));
        (done >= enough && pass >= LEAST).then_some(done)
    };
    let mut passes = Passes::of(progress.silent()).watched_by(&mut look);
    film(&t, &scene.camera, estimator, settings.plan(), amount, &mut passes);
    match stands[..] {
        [.., (m, before), (n, after)] => (after - before).as_secs_f64() / f64::from(n - m),
        _ => f64::NAN,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::scene::load::{self, Options};

    /// A tree with 4 children has 1 + 4 + 16 + 64 rays per path, a single path 4: a factor of 21 in rays. Seconds differ by
    /// more than 3, whatever the load of the machine.
    #[test]
    fn more_rays_take_more_time() {
        let options = Options { set: vec!["camera.size=[16,16]".into()], ..Options::default() };
        let scene = Scene::new(&load::scene("furnace", &options).unwrap().description);
        let settings = Settings { spp: 64, max_bounces: 3, ..Settings::default() };
        let of = |children| seconds_per_sample(&scene, Estimator::Branching { children }, &settings, Progress::NONE);
        let (one, four) = (of(1), of(4));
        assert!(one > 0.0 && four > 3.0 * one, "{one} s, {four} s");
    }

    /// The pilot of a render of one sample has a time, too; one that is stopped has none.
    #[test]
    fn one_sample_has_a_time() {
        let scene = Scene::new(&load::scene("furnace", &Options::default()).unwrap().description);
        let settings = Settings { spp: 1, max_bounces: 1, ..Settings::default() };
        assert!(seconds_per_sample(&scene, Estimator::Prefix, &settings, Progress::NONE) > 0.0);
        let flag = std::sync::atomic::AtomicBool::new(true);
        let stopped = Progress::NONE.stopped_by(&flag);
        assert!(seconds_per_sample(&scene, Estimator::Prefix, &settings, stopped).is_nan());
    }
}
