//! Four situations: a matt or a glossy surface, under a sky or under a disc.
//!
//! ```text
//! L_r = ρ L sin²α      of a matt surface under a disc of half angle α; the sky is α = 90°
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | ρ | albedo of the matt surface | [`RHO`] |
//! | α | half angle that the light fills, seen from the surface | [`SITUATIONS`] |
//! | x | the point at which L_r is estimated, with the direction ω_o to the camera | [`situation`] |

use fredholm::report::book;
use fredholm::scene::{Scene, Vertex, load};
use std::path::Path;

/// A surface, and the half angle that the light on it fills; 90° is a sky.
pub const SITUATIONS: [(&str, f64); 4] = [("matt", 90.0), ("matt", ALPHA), ("glossy", 90.0), ("glossy", 60.0)];
/// Albedo of the matt surface.
pub const RHO: f64 = 0.5;
/// Half angle of the small lamp, in degrees.
pub const ALPHA: f64 = 20.0;

/// The scene of a situation, and the point in the middle of its only pixel.
pub fn situation(i: usize) -> book::Result<(Scene, Vertex)> {
    let (material, angle) = SITUATIONS[i];
    let disc = format!("center = [0, 4, 0], normal = [0, -1, 0], radius = {}", 4.0 * angle.to_radians().tan());
    let (lamp, sky) = match angle {
        90.0 => (String::new(), "{ type = 'environment', radiance = [1, 1, 1] }"),
        _ => (format!(", {{ type = 'disk', {disc}, material = 'black', emission = [1, 1, 1] }}"), ""),
    };
    let text = format!(
        "camera = {{ origin = [1.5, 1.3, 0], target = [0, 0, 0], up = [0, 1, 0], fov = 1, size = [1, 1] }}
        shapes = [{{ type = 'quad', origin = [-1, 0, 1], edge_u = [2, 0, 0], edge_v = [0, 0, -2], material = '{material}' }}{lamp}]
        lights = [{sky}]
        [materials]
        black = {{ type = 'diffuse', reflectance = [0, 0, 0] }}
        matt = {{ type = 'diffuse', reflectance = [{RHO}, {RHO}, {RHO}] }}
        glossy = {{ type = 'phong', reflectance = [0, 0, 0], specular = [0.5, 0.5, 0.5], exponent = 50 }}"
    );
    let scene = Scene::new(&load::toml(&text, Path::new("chapter 3"), &load::Options::default())?.description);
    let (eye, towards) = scene.camera.ray(0, [0.5, 0.5]);
    let x = scene.trace(eye, towards).ok_or("the camera sees no surface")?;
    Ok((scene, x))
}
