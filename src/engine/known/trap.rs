//! Detects light that enters a part of the scene and cannot leave it. Then `L = E + T L` has no solution.
//!
//! ```text
//! light starts → … → x_v, albedo 1 in a channel at every vertex so far        never leaves: r(T) = 1 where light is
//! ```
//!
//! Walks start where light starts, at least two from every lamp, because only light that gets into a part must be able to
//! leave it. So a closed white block in a room is no obstacle. Nor are the directions inside glass that are reflected for
//! ever, because no light from outside takes them. The three channels are three problems: a lamp without blue lights nothing
//! in blue.

use crate::math::{Key, Purpose, Rgb, Rng};
use crate::operator::{Adjoint, Role, SceneTransport, Transport};
use crate::scene::Scene;

/// Smallest and largest number of walks; in between there are two for each lamp.
const WALKS: [usize; 2] = [16, 4096];
/// A walk that still has all its light after this number of bounces counts as trapped. With an opening of 10⁻⁵ of the
/// surface, one of 20 000 walks is wrongly counted as trapped. Only scenes that are closed, or nearly so, need so many
/// bounces.
const BOUNCES: usize = 1_000_000;

/// The channels in which some light can never leave; None if there are none.
pub fn trapped(scene: &Scene) -> Option<[bool; 3]> {
    if (scene.max_albedo() * scene.lit()).max_element() < 1.0 {
        return None;
    }
    let walks = (2 * scene.lights.len()).clamp(WALKS[0], WALKS[1]);
    (0..walks).find_map(|i| kept(scene, i, walks))
}

/// The channels in which walk `i` of `walks` still has all its light after many bounces.
fn kept(scene: &Scene, i: usize, walks: usize) -> Option<[bool; 3]> {
    let t = SceneTransport::new(scene);
    let stream = |bounce| Rng::at(Key::new(0, "closed"), i as u32, 0, bounce, Purpose::Scatter);
    let [_, rest @ ..] = stream(0).four();
    // spread evenly over the lamps
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
