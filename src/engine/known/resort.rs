//! The last resort: roulette for paths that nothing else ends, in a scene whose albedo is 1 somewhere, or is only known to
//! be at most 1.
//!
//! ```text
//! from vertex 4/(1 − r₂) on:   q ≥ (1 − r₂)/4        so that  r₂/(1 − q) < 1  and  r₂/(1 − q)³ < 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r₂ | growth of second moments of walks from the light, plus four standard errors; parts of the scene that light never reaches do not count | [`growth`] |
//!
//! Light that escapes decays at least as fast as r₂ per vertex. So a path from the eye that is still under way after
//! 4/(1 − r₂) vertices is most likely in a part that light never reaches: inside a closed white block, or in directions that
//! glass reflects for ever. The radiance there is 0, whatever ends the path. If r₂ is not known to be below 1, the rules of
//! [`Roulette`] end such paths.

use crate::engine::known::growth::{CLEAR, FromLight, growth};
use crate::estimator::Roulette;
use crate::operator::SceneTransport;
use crate::scene::Scene;

/// The scene with its last resort, if it needs one and one is known.
#[must_use]
pub fn with_last_resort(scene: Scene) -> Scene {
    if (scene.max_albedo() * scene.lit()).max_element() < 1.0 {
        return scene;
    }
    let t = SceneTransport::new(&scene);
    let found = growth(&FromLight { t: &t, roulette: &Roulette::Never }, 0, 2, 0);
    let loss = 1.0 - found.rate - CLEAR * found.std_error;
    if loss <= LEAST {
        return scene;
    }
    scene.ending_at((4.0 / loss).ceil() as usize, two_digits(0.25 * loss) as f32)
}

/// A smaller loss per vertex cannot be distinguished from none.
const LEAST: f64 = 1e-4;

/// Rounds down to two digits, so that a user can type the value.
pub(crate) fn two_digits(q: f64) -> f64 {
    if q <= 0.0 {
        return 0.0;
    }
    let digits = 1 - q.log10().floor() as i32;
    let unit = 10f64.powi(digits);
    // a value that is 0.3 up to rounding stays 0.3
    ((q * unit * (1.0 + 1e-6)).floor() / unit).min(1.0)
}
