//! The end of paths that nothing else ends, in a scene whose albedo is 1 somewhere, or is only known to be at most 1.
//!
//! ```text
//! from vertex 4/(1 − r₂) on:   q ≥ (1 − r₂)/4        so that  r₂/(1 − q) < 1  and  r₂/(1 − q)³ < 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r₂ | growth of second moments of walks from the light, four standard errors added: what light never reaches has no part in it | [`growth`] |
//!
//! Light that escapes does so at the rate r₂ at least; what is still under way after so many vertices from the eye is most likely in
//! a part that light never reaches, where the radiance is 0 whatever ends the path: inside of a closed white block, or in the
//! directions that glass reflects for ever. Where r₂ is not known to be below 1, [`Roulette`] ends such paths without it.

use crate::engine::known::growth::{CLEAR, FromLight, growth};
use crate::estimator::Roulette;
use crate::operator::SceneTransport;
use crate::scene::Scene;

/// The scene with its last resort, where it needs one and has one.
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

/// A smaller loss per vertex is not told from none.
const LEAST: f64 = 1e-4;

/// Rounded down to two digits, so that it can be typed.
pub(crate) fn two_digits(q: f64) -> f64 {
    if q <= 0.0 {
        return 0.0;
    }
    let digits = 1 - q.log10().floor() as i32;
    let unit = 10f64.powi(digits);
    // what is 0.3 but for rounding is 0.3
    ((q * unit * (1.0 + 1e-6)).floor() / unit).min(1.0)
}
