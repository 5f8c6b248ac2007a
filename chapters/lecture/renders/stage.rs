//! Scenes of the rendered figures: three spheres on the ground, under a sky, a lamp or a point light.
//!
//! ```text
//! L_sky(ω) = blue(ω_y) + 0.43 (1, 0.87, 0.67)/σ² · exp(−(angle to the sun)²/2σ²)        d(φ, θ) = (sin θ sin φ, cos θ, −sin θ cos φ)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_sky | radiance of the sky, constant in each texel of a map by latitude and longitude | [`sky`] |
//! | σ | angular width of the bright spot around the sun, rad | [`SUN`], [`HAZE`] |
//! | θ, φ | angle from the vertical, azimuth | [`direction`] |
//!
//! Reference: Debevec, *Rendering Synthetic Objects into Real Scenes* (SIGGRAPH 1998), for light given as a map of directions.

use fredholm::math::Rgb;
use fredholm::report::book::Result;
use fredholm::scene::Description;
use fredholm::scene::description::{LightDescription, Sky};
use fredholm::scene::raster::Raster;
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use super::measure::from_text;

/// A ground and three spheres side by side. Materials `left`, `middle`, `right` are added by the figure.
const SPHERES: &str = r#"
name = "three-spheres"

[camera]
origin = [0, 2.0, 8]
target = [0, 0.45, 0]
up = [0, 1, 0]
fov = 34
size = [64, 64]

[materials.ground]
type = "diffuse"
reflectance = [0.5, 0.5, 0.5]

[materials.lamp]
type = "diffuse"
reflectance = [0, 0, 0]

[[shapes]]
type = "disk"
center = [0, 0, 0]
normal = [0, 1, 0]
radius = 12
material = "ground"

[[shapes]]
name = "left"
type = "sphere"
center = [-1.5, 0.601, 0]
radius = 0.6
material = "left"

[[shapes]]
name = "middle"
type = "sphere"
center = [0, 0.601, 0]
radius = 0.6
material = "middle"

[[shapes]]
name = "right"
type = "sphere"
center = [1.5, 0.601, 0]
radius = 0.6
material = "right"
"#;

/// A matt, a glossy and a mirror-like material.
pub(crate) const MATT_GLOSSY_MIRROR: &str = r#"
[materials.left]
type = "diffuse"
reflectance = [0.7, 0.4, 0.25]

[materials.middle]
type = "conductor"
reflectance = [0.9, 0.9, 0.9]
alpha = 0.2

[materials.right]
type = "mirror"
reflectance = [0.9, 0.9, 0.9]
"#;

/// A sky of radiance 1, to be replaced by [`under_sky`].
pub(crate) const SKY: &str = "\n[[lights]]\ntype = \"environment\"\nradiance = [1, 1, 1]\n";

/// A square lamp above the spheres, on the left and in front of them.
pub(crate) const LAMP: &str = r#"
[[shapes]]
name = "lamp"
type = "quad"
origin = [-2.6, 4, 1.2]
edge_u = [1.6, 0, 0]
edge_v = [0, 0, 1.6]
material = "lamp"
emission = [12, 11, 9]
"#;

/// A point light in the middle of that lamp.
pub(crate) const POINT: &str = r#"
[[lights]]
type = "point"
position = [-1.8, 4, 2]
intensity = [30, 27, 23]
"#;

/// Angular width σ of a small bright spot around the sun, rad.
pub(crate) const SUN: f32 = 0.12;
/// Angular width σ of a wide bright spot, as in haze, rad.
pub(crate) const HAZE: f32 = 0.4;
/// Direction of the sun.
const TO_SUN: Vec3 = Vec3::new(-0.48, 0.62, 0.62);

/// The three spheres with the given materials and lights.
pub(crate) fn spheres(materials_and_lights: &str, size: [u32; 2]) -> Result<Description> {
    from_text(&format!("{SPHERES}{materials_and_lights}"), size)
}

/// The same scene under a sky whose bright spot has this width, without its other lights.
pub(crate) fn under_sky(scene: Description, width: f32) -> Description {
    let sky = Sky::LatLong(Arc::new(sky([128, 64], width)));
    Description { lights: vec![LightDescription::Environment { sky, rotate: 0.0, scale: 1.0 }], ..scene }
}

/// The direction of a point of a map by latitude and longitude, as fractions of its width and height.
pub(crate) fn direction(u: f32, v: f32) -> Vec3 {
    let ((sin_phi, cos_phi), (sin_theta, cos_theta)) = ((TAU * (u - 0.5)).sin_cos(), (PI * v).sin_cos());
    Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
}

/// A sky by latitude and longitude: blue, brighter towards the horizon, with a bright spot around the sun.
fn sky([w, h]: [u32; 2], width: f32) -> Raster {
    let sun = TO_SUN.normalize();
    let texel = |i: u32| {
        let d = direction(((i % w) as f32 + 0.5) / w as f32, ((i / w) as f32 + 0.5) / h as f32);
        let up = d.y.max(0.0);
        let blue = Rgb::new(0.75, 0.85, 0.95).lerp(Rgb::new(0.12, 0.25, 0.6), up.sqrt());
        let from_sun = d.dot(sun).clamp(-1.0, 1.0).acos() / width;
        blue * 0.5 + Rgb::new(1.0, 0.87, 0.67) * (0.43 / (width * width)) * (-0.5 * from_sun * from_sun).exp()
    };
    Raster::new([w, h], (0..w * h).map(texel).collect())
}

/// The radiance of a map by latitude and longitude, row by row, `h` rows of `2h` pixels.
pub(crate) fn lat_long(h: u32, radiance: impl Fn(Vec3) -> Rgb) -> Vec<[f32; 3]> {
    let pixel = |i: u32| {
        let (column, row) = ((i % (2 * h)) as f32 + 0.5, (i / (2 * h)) as f32 + 0.5);
        radiance(direction(column / (2 * h) as f32, row / h as f32)).to_array()
    };
    (0..2 * h * h).map(pixel).collect()
}
