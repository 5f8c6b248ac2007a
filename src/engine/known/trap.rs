//! Whether light gets into something that it cannot get out of: there `L = E + T L` has no solution.
//!
//! ```text
//! light starts → … → x_v, albedo 1 in a channel at every vertex so far        never out: r(T) = 1 where light is
//! ```
//!
//! Walks start where light does, two at least from every lamp: what light never gets into need not let it out. A closed white block
//! in a room is no obstacle, nor are the directions inside of glass that are reflected for ever and that no light from outside takes.
//! The three channels are three problems: a lamp without blue lights nothing in blue.

use crate::math::{Key, Purpose, Rgb, Rng};
use crate::operator::{Adjoint, Role, SceneTransport, Transport};
use crate::scene::Scene;

/// Walks: at least, and at most; two for each lamp between.
const WALKS: [usize; 2] = [16, 4096];
/// Bounces of a walk that is still inside with all its light: an opening of 10⁻⁵ of the surface lets one of 20 000 walks pass for
/// closed. Only what is closed, or nearly so, costs so much.
const BOUNCES: usize = 1_000_000;

/// The channels in which some light never gets out, if there are any.
pub fn trapped(scene: &Scene) -> Option<[bool; 3]> {
    if (scene.max_albedo() * scene.lit()).max_element() < 1.0 {
        return None;
    }
    let walks = (2 * scene.lights.len()).clamp(WALKS[0], WALKS[1]);
    (0..walks).find_map(|i| kept(scene, i, walks))
}

/// The channels in which walk `i` of so many still has all its light after many bounces.
fn kept(scene: &Scene, i: usize, walks: usize) -> Option<[bool; 3]> {
    let t = SceneTransport::new(scene);
    let stream = |bounce| Rng::at(Key::new(0, "closed"), i as u32, 0, bounce, Purpose::Scatter);
    let [_, rest @ ..] = stream(0).four();
    // evenly over the lamps
    let which = (i as f32 + 0.5) / walks as f32;
    let (lamp, _) = scene.emit([which, rest[0], rest[1], rest[2]])?;
    let mut keeps = t.emission(&lamp).cmpgt(Rgb::ZERO);
    let mut at = t.walk(&lamp, Role::Emission, &mut stream(1))?.state;
    for bounce in 2..BOUNCES {
        keeps &= t.albedo(&at).cmpge(Rgb::ONE);
        if !keeps.any() {
            return None;
        }
        at = t.walk(&at, Role::Flux, &mut stream(bounce))?.state;
    }
    Some([keeps.x, keeps.y, keeps.z])
}
