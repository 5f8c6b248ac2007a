//! A photograph of a mirror sphere, turned into a sky by latitude and longitude.
//!
//! ```text
//! n = (d + e)/|d + e|      pixel (½ + ½ n_x, ½ − ½ n_y)      d = 2(n·e)n − e
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | e = +z | from the sphere to the camera, which is far away and looks along −z |
//! | n | normal of the sphere where the sky in direction d is seen |
//! | pixel | from the top left corner; the sphere touches the four edges of the image |
//!
//! **Blind spot.** The sky behind the sphere is squeezed into its rim: at distance ε from the rim (in radii), d is
//! 2√(2ε) away from −z. Pixels there cover wide arcs, and those on the rim also show what is beside the sphere.
//! Directions seen within three half-pixels of the rim are therefore given the colour at that distance: with h pixels
//! across, everything within 2√(6/h) of −z, 9° for h = 1000, is a continuation and no measurement.
//!
//! Reference: Paul Debevec, *Rendering synthetic objects into real scenes*, SIGGRAPH 1998.

use crate::math::Rgb;
use crate::scene::raster::Raster;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Directions per texel and axis.
const DIRECTIONS: u32 = 4;

/// The sky of a mirror sphere as an image by latitude and longitude, as high as the photograph and twice as wide; a
/// texel is the mean over a regular set of directions in it, uniform in solid angle.
pub(super) fn lat_long(photo: &Raster) -> Raster {
    let h = photo.size[1];
    let n = h * DIRECTIONS;
    // directions of row i are at equal steps of cos θ between the edges of their texel
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

/// What the photograph shows in direction `d`: bilinear, never from pixels beside the sphere.
fn seen(photo: &Raster, d: DVec3) -> Rgb {
    let half_pixel = 1.0 / f64::from(photo.size[0].min(photo.size[1]));
    let n = (d + DVec3::Z).normalize_or_zero();
    let rim = n.truncate().length();
    let inside = n.truncate() * ((1.0 - 3.0 * half_pixel).max(0.0) / rim).min(1.0);
    photo.bilinear([0.5 + 0.5 * inside.x as f32, 0.5 + 0.5 * inside.y as f32])
}
