//! Paths that a sampling method cannot find in a scene. They are reported in words, so that no light is missing silently.
//!
//! Two kinds of things have no area in the space of rays: lights that are a point or a direction, and reflections by mirrors
//! and glass. A path can be found from the eye (E … ), from the light (… L), or by a link between two walks. A link needs a
//! vertex on each side that is not a delta vertex, and a hit needs a light with area. With S for a delta vertex and D for
//! any other vertex:
//!
//! | sampling method | cannot find | from k = |
//! |---|---|---|
//! | walks from the eye, `scatter` | paths to point or directional lights | 1 |
//! | walks from the eye, with connections | such paths whose last vertex before the light is S | 2 |
//! | walks from the light | paths whose first vertex after the eye is S | 1 |
//! | walks from both ends | paths to point or directional lights without two neighbouring vertices that can be linked | 3 |
//!
//! No method finds the reflection of a point light in a mirror, E S L. A coat of smooth plastic counts as S, too.

use crate::engine::estimator::{Begins, Estimator};
use crate::estimator::Technique;
use crate::scene::Scene;
use crate::terms::UnsampledPaths;

/// The kinds of paths that an estimator (`None` for the path tracer) cannot find in a scene; empty if it finds all.
pub fn unsampled(scene: &Scene, estimator: Option<Estimator>, technique: Technique) -> Vec<UnsampledPaths> {
    let (no_area, delta) = (scene.lights.any_delta(), scene.any_delta_surface());
    let missing = match estimator.map_or(Begins::AtEye, Estimator::begins) {
        Begins::AtLight => delta.then_some((1, "what the eye sees in mirrors or glass")),
        Begins::AtBoth => {
            (delta && no_area).then_some((3, "point or directional lights on paths with mirrors or glass at both ends"))
        }
        Begins::AtEye if technique == Technique::Scatter => no_area.then_some((1, "point or directional lights")),
        Begins::AtEye => (delta && no_area).then_some((2, "point or directional lights through mirrors or glass")),
    };
    missing.map(|(from, what)| UnsampledPaths { what: what.to_owned(), from }).into_iter().collect()
}
