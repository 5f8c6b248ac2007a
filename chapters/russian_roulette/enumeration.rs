//! All the ways the roulette can fall, summed over their probabilities, for some paths of the Cornell box.
//!
//! ```text
//! Σ_n P(N = n) = 1          Σ_n P(N = n) S_n = Σ_k X_k, term by term
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | N | the vertex after which the path ends | [`ends`] |
//! | P, S_n | probability of N = n; what the path has then scored | [`End`] |
//! | X_k | what the path scores without roulette | [`follow`] |
//!
//! Reference: `fredholm::study::enumeration`.

use super::load;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::report::book::{self, Folder};
use fredholm::study::enumeration::{End, Errors, ends, follow};
use glam::DVec3;

/// The schedules; q of the last two depends on the path.
const SCHEDULES: [&str; 5] = ["lecture", "constant:0.3@0", "table:0,0.1,0.2,0.3", "albedo@0", "throughput@0"];
/// The terms 0 to K are kept apart.
const K: usize = 6;
/// Paths are cut after this many vertices, with and without roulette.
const LONG: usize = 24;

/// The largest errors over one path of every pixel. `mean` sums over the ways the roulette can fall.
pub fn enumerate(folder: &Folder<'_>, mean: fn(&[End]) -> Vec<DVec3>) -> book::Result<Errors> {
    let (scene, _) = load("cornell", folder.pick(64, 32))?;
    let (t, key, mut errors) = (SceneTransport::new(&scene), Key::new(folder.seed, "enumeration"), Errors::default());
    for pixel in 0..scene.camera.size[0] * scene.camera.size[1] {
        let Some(start) = scene.camera.start(&t, pixel, &mut Rng::at(key, pixel, 0, 0, Purpose::Start)) else {
            continue;
        };
        let path = follow(&t, start, Technique::Mis, (key, pixel, 0), LONG);
        let (without, _) = ends(&path, &Roulette::Never, K);
        let Some(x) = without.last() else { continue };
        for schedule in SCHEDULES {
            let (all, _) = ends(&path, &schedule.parse()?, K);
            let off = |(with, x): (DVec3, &DVec3)| ((with - *x).abs() / x.max(DVec3::splat(1e-30))).max_element();
            errors.ends += all.len() as u64;
            errors.probability = errors.probability.max((all.iter().map(|e| e.probability).sum::<f64>() - 1.0).abs());
            errors.term = mean(&all).into_iter().zip(&x.scored).map(off).fold(errors.term, f64::max);
        }
        errors.paths += 1;
    }
    Ok(errors)
}
