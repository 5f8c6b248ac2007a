//! Conversion of a photograph of a mirror sphere into a sky by latitude and longitude.
//!
//! ```text
//! n = (d + e)/|d + e|      pixel (½ + ½ n_x, ½ − ½ n_y)      d = 2(n·e)n − e
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | d | direction of the sky |
//! | e = +z | direction from the sphere to the camera, which is far away and looks along −z |
//! | n | normal at the point of the sphere that reflects the sky in direction d |
//! | pixel | position from the top left corner, as a fraction of the image; the sphere touches the four edges of the image |
//!
//! **Blind spot.** The sky behind the sphere is compressed into its rim. At distance ε from the rim (in radii), d is 2√(2ε)
//! rad away from −z. Pixels there cover wide arcs, and pixels on the rim also show the background beside the sphere.
//! Directions seen within three half-pixels of the rim therefore get the colour at that distance. With h pixels across,
//! everything within 2√(6/h) rad of −z (9° for h = 1000) is extrapolated and not measured.
//!
//! Reference: Paul Debevec, *Rendering synthetic objects into real scenes*, SIGGRAPH 1998.

use crate::math::Rgb;
use crate::scene::raster::Raster;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Number of directions per texel along each axis.
const DIRECTIONS: u32 = 4;

/// Converts the photograph to an image by latitude and longitude, as high as the photograph and twice as wide. A texel is
/// the mean over a regular grid of directions in it, uniform in solid angle.
pub(super) fn lat_long(photo: &Raster) -> Raster {
    let h = photo.size[1];
    let n = h * DIRECTIONS;
    // the directions of row i have equal steps of cos θ between the edges of their texel
    let cosine = |i: u32| {
        let edge = |row: u32| (PI * f64::from(row) / f64::from(h)).cos();
        let t = (f64::from(i % DIRECTIONS) + 0.5) / f64::from(DIRECTIONS);
        edge(i / DIRECTIONS) * (1.0 - t) + edge(i / DIRECTIONS + 1) * t
    };
    let turns: Vec<[f64; 2]> = (0..2 * n)
        .map(|i| ((f64::from(i) + 0.5) / f64::from(2 * n) - 0.5) * TAU)
        .map(|phi| phi.sin_cos().into())
        .collect();
    let cosines: Vec<f64> = (0..n).map(cosine).collect();
    let mut texels = Vec::with_capacity(2 * h as usize * h as usize);
    for (rows, turns) in cosines
        .chunks(DIRECTIONS as usize)
        .flat_map(|rows| turns.chunks(DIRECTIONS as usize).map(move |turns| (rows, turns)))
    {
        let directions = rows.iter().flat_map(|&y| {
            let r = ((1.0 - y) * (1.0 + y)).sqrt();
            turns.iter().map(move |[sin, cos]| DVec3::new(r * sin, y, -r * cos))
        });
        let sum: DVec3 = directions.map(|d| seen(photo, d).as_dvec3()).sum();
        texels.push((sum / f64::from(DIRECTIONS * DIRECTIONS)).as_vec3());
    }
    Raster::new([2 * h, h], texels)
}

/// Colour of the photograph in direction `d`: bilinear, but never from pixels outside the sphere.
fn seen(photo: &Raster, d: DVec3) -> Rgb {
    let half_pixel = 1.0 / f64::from(photo.size[0].min(photo.size[1]));
    let n = (d + DVec3::Z).normalize_or_zero();
    let rim = n.truncate().length();
    let inside = n.truncate() * ((1.0 - 3.0 * half_pixel).max(0.0) / rim).min(1.0);
    photo.bilinear([0.5 + 0.5 * inside.x as f32, 0.5 + 0.5 * inside.y as f32])
}
