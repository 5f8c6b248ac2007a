//! What a way of sampling cannot find in a scene: said in words, never silently dark.
//!
//! Two kinds of things have no area in ray space: lights that are a point or a direction, and the reflections of mirrors and
//! glass. A path can be found from the eye (E … ), from the light (… L), or by linking two walks; a link needs
//! a vertex on each side that is no delta vertex, a hit needs a light that has area. With S a delta vertex and D any other:
//!
//! | way | does not see | from k = |
//! |---|---|---|
//! | walks from the eye, `scatter` | paths to a point or a direction | 1 |
//! | walks from the eye, with connections | such paths whose last vertex is S | 2 |
//! | walks from the light | paths whose first vertex is S | 1 |
//! | walks from both ends | paths to a point or a direction without two neighbours that can be linked | 3 |
//!
//! The reflection of a point in a mirror, E S L, is seen by nobody. A coat of smooth plastic is S, too.

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
            (delta && no_area).then_some((3, "light of a point or a direction between mirrors or glass at both ends"))
        }
        Begins::AtEye if technique == Technique::Scatter => no_area.then_some((1, "light of a point or a direction")),
        Begins::AtEye => (delta && no_area).then_some((2, "light of a point or a direction through mirrors or glass")),
    };
    missing.map(|(from, what)| UnsampledPaths { what: what.to_owned(), from }).into_iter().collect()
}
