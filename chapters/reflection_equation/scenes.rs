//! The small scenes of chapter 2, written as the text of scene files.
//!
//! ```text
//! E = ∫ L_i cos θ_i dω_i      of a patch at the origin that faces upwards
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | E | irradiance of the patch | [`PATCH`] |
//! | L_i | light that arrives: from a lamp, from a point, or from the sky | [`disc`], [`ball`], [`point`], [`SKY`] |
//!
//! `scenes/README.md` documents every key of a scene file.

use fredholm::scene::{Scene, SceneError, load};
use std::path::Path;

/// A white patch at the origin.
pub(super) const PATCH: &str =
    "{ type = 'quad', origin = [-0.5, 0, 0.5], edge_u = [1, 0, 0], edge_v = [0, 0, -1], material = 'white' }";
/// A camera that sees a few millimetres of the patch.
pub(super) const BESIDE: &str = "origin = [2, 0.4, 0], target = [0, 0, 0], up = [0, 1, 0], fov = 0.05, size = [8, 8]";
/// A camera at the patch that looks upwards.
pub(super) const UPWARDS: &str = "origin = [0, 0.001, 0], target = [0, 1, 0], up = [0, 0, 1], fov = 1, size = [8, 8]";
/// A grey sphere of radius 1, seen from its inside.
pub(super) const HOLLOW: &str = "{ type = 'sphere', center = [0, 0, 0], radius = 1, inward = true, material = 'grey' }";
/// A camera inside this sphere.
pub(super) const INSIDE: &str = "origin = [0.5, 0, 0], target = [0, 0, 0], up = [0, 1, 0], fov = 90, size = [8, 8]";
/// Emission of radiance 1.
pub(super) const ONE: &str = "emission = [1, 1, 1]";
/// A sky of radiance 1.
pub(super) const SKY: &str = "{ type = 'environment', radiance = [1, 1, 1] }";

// ANCHOR: scene
/// A scene from its text: a camera, shapes and lights.
pub(super) fn scene([camera, shapes, lights]: [&str; 3]) -> Result<Scene, SceneError> {
    let text = format!(
        "camera = {{ {camera} }}\n shapes = [{shapes}]\n lights = [{lights}]\n [materials]\n \
         black = {{ type = 'diffuse', reflectance = [0, 0, 0] }}\n \
         grey = {{ type = 'diffuse', reflectance = [0.5, 0.5, 0.5] }}\n \
         white = {{ type = 'diffuse', reflectance = [1, 1, 1] }}\n"
    );
    Ok(Scene::new(&load::toml(&text, Path::new("chapter 2"), &load::Options::default())?.description))
}

/// A disc at height `h` that faces the patch; `shines` is its `emission` or its `power`.
pub(super) fn disc(radius: f64, h: f64, shines: &str) -> String {
    let disc = format!("type = 'disk', center = [0, {h}, 0], normal = [0, -1, 0], radius = {radius}");
    format!("{{ {disc}, material = 'black', {shines} }}")
}

/// A sphere that shines.
pub(super) fn ball(radius: f64, center: [f64; 3], shines: &str) -> String {
    format!("{{ type = 'sphere', center = {center:?}, radius = {radius}, material = 'black', {shines} }}")
}

/// A point light of intensity `i` in every direction.
pub(super) fn point(position: [f64; 3], i: f64) -> String {
    format!("{{ type = 'point', position = {position:?}, intensity = [{i}, {i}, {i}] }}")
}
// ANCHOR_END: scene
