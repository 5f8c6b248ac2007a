//! Environment light: radiance from every direction at infinity, sampled in proportion to its brightness.
//!
//! ```text
//! u = ½ + (φ + α)/2π      φ = atan2(x, −z)      v = θ/π      cos θ = y
//! p(ω) = P / Ω      P ∝ Y Ω      Ω = (2π/w)(cos θ_j − cos θ_{j+1}) = (4π/w)(s_{j+1} − s_j)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | θ, φ | angle from +y; azimuth from −z towards +x | – |
//! | α | rotation of the sky about the vertical, counter-clockwise seen from +y | `turn`, in turns |
//! | (i, j) | texel ⌊uw⌋, ⌊vh⌋ of a w × h image; radiance is constant in it | [`Environment::radiance`] |
//! | s = sin²(θ/2) | (1 − cos θ)/2, computed without its loss of digits at the pole | `heights`, at the edges of rows |
//! | Ω | solid angle of a texel, exact | – |
//! | Y | luminance of a texel (Rec. 709) | – |
//! | P, p | probability of a texel; density, sr⁻¹ | [`Environment::pdf`] |
//!
//! Sampling chooses a row, then a column in it, then s and φ uniform in the texel. This is uniform in solid angle up to the
//! poles, so a sky of one texel is sampled uniformly over the sphere. Texels without light are never chosen. P differs from
//! YΩ/ΣYΩ only by the rounding of [`crate::math::distribution`], and p contains the same rounding.
//!
//! **The texel of a sampled direction must be the texel that was chosen**, in [`Environment::radiance`] and in
//! [`Environment::pdf`]. Otherwise a direction sampled in a dark texel could fall on the sun in the next texel. So angles
//! are computed in `f64`, and positions are kept 2⁻²¹ rad inside the edges. This is eight times the error of rounding the
//! direction to `f32`. The angle to the pole is computed as atan2(√(x² + z²), y), which keeps its digits there.
//!
//! References: Paul Debevec, *Rendering synthetic objects into real scenes*, SIGGRAPH 1998; Matt Pharr, Wenzel Jakob and
//! Greg Humphreys, *Physically Based Rendering* (4th ed. 2023), sec. 12.5 (infinite area lights).

use super::mirror_ball::lat_long;
use crate::math::{Rgb, direction::uniform_sphere, distribution::Table, luminance};
use crate::scene::{description::Sky, raster::Raster};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Distance, in rad, that sampled directions keep from the edges of their texel.
const INSIDE: f64 = 1.0 / (1 << 21) as f64;

/// An environment light, prepared for sampling and look-up.
#[derive(Clone, Debug)]
pub struct Environment {
    image: Arc<Raster>,
    scale: f32,
    /// α/2π, in [0, 1): rotation about the vertical.
    turn: f64,
    table: Table,
    /// s at the h + 1 edges of the rows, from 0 to 1.
    heights: Vec<f64>,
    mean: DVec3,
    /// Radiance and density of a sky of one texel, which is the same everywhere.
    constant: Option<(Rgb, f32)>,
}

impl Environment {
    /// An environment light from a description. The sky is rotated by `rotate_degrees` counter-clockwise seen from +y, and
    /// its radiance is multiplied by `scale`. A sky that is black everywhere is sampled uniformly.
    ///
    /// # Panics
    /// If a texel is negative or not finite.
    pub fn new(sky: &Sky, rotate_degrees: f64, scale: f64) -> Self {
        let single = |colour: Rgb| Arc::new(Raster::new([1, 1], vec![colour]));
        let image = match sky {
            Sky::Constant(colour) => single(colour.as_vec3()),
            Sky::LatLong(image) => image.clone(),
            Sky::MirrorBall(photo) => Arc::new(lat_long(photo)),
        };
        let bad = image.texels.iter().find(|t| !t.is_finite() || t.min_element() < 0.0);
        assert!(bad.is_none(), "a sky of radiance {bad:?}");
        let black = image.texels.iter().all(|t| *t == Rgb::ZERO);
        let image = if black { single(Rgb::ZERO) } else { image };
        let [w, h] = image.size;
        let heights: Vec<f64> = (0..=h).map(|j| (0.5 * PI * f64::from(j) / f64::from(h)).sin().powi(2)).collect();
        let share = |row: u32| (heights[row as usize + 1] - heights[row as usize]) / f64::from(w);
        let weight =
            |column, row| if black { 1.0 } else { luminance(image.texel(column, row).as_dvec3()) * share(row) };
        let Some(table) = Table::new([w, h], weight) else { unreachable!("one texel at least is not black") };
        let row_sum = |row| (0..w).map(|column| image.texel(column, row).as_dvec3()).sum::<DVec3>();
        let mean = (0..h).map(|row| share(row) * row_sum(row)).sum::<DVec3>() * f64::from(scale as f32);
        let turn = (rotate_degrees / 360.0).rem_euclid(1.0);
        let mut sky = Self { turn, scale: scale as f32, mean, table, heights, image, constant: None };
        if [w, h] == [1, 1] {
            sky.constant = Some((sky.radiance(Vec3::Y), sky.density([0, 0])));
        }
        sky
    }

    /// The texel `[column, row]` seen in direction `d`.
    fn texel(&self, d: Vec3) -> [u32; 2] {
        let [w, h] = self.image.size;
        if [w, h] == [1, 1] {
            return [0, 0];
        }
        let d = d.as_dvec3();
        let u = 0.5 + self.turn + d.x.atan2(-d.z) / TAU;
        let v = (d.x * d.x + d.z * d.z).sqrt().atan2(d.y) / PI;
        let cell = |x: f64, n: u32| ((x * f64::from(n)) as u32).min(n - 1);
        [cell(u - u.floor(), w), cell(v, h)]
    }

    /// Radiance that arrives from the unit direction `d`, W·sr⁻¹·m⁻².
    #[inline]
    pub fn radiance(&self, d: Vec3) -> Rgb {
        if let Some((radiance, _)) = self.constant {
            return radiance;
        }
        let [column, row] = self.texel(d);
        self.image.texel(column, row) * self.scale
    }

    /// A sampled unit direction towards the sky, and its density in sr⁻¹ (never 0).
    pub fn sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        if let Some((_, density)) = self.constant {
            // one texel has no edges to keep away from
            return (uniform(u), density);
        }
        let [w, h] = self.image.size;
        let ([column, row], rest) = self.table.sample(u);
        // the centre of the interval of length 2⁻²⁴ that the number represents
        let [across, down] = rest.map(|t| f64::from(t) + 0.5 / f64::from(1 << 24));
        let inside = |x: f64, cell: u32, step: f64| {
            x.max(f64::from(cell) * step + INSIDE).min(f64::from(cell + 1) * step - INSIDE)
        };
        let (low, high) = (self.heights[row as usize], self.heights[row as usize + 1]);
        let theta = inside(2.0 * (low + (high - low) * down).sqrt().asin(), row, PI / f64::from(h));
        let step = TAU / f64::from(w);
        let phi = inside((f64::from(column) + across) * step, column, step) - TAU * (0.5 + self.turn);
        let ((sin, cos), (x, minus_z)) = (theta.sin_cos(), phi.sin_cos());
        (DVec3::new(sin * x, cos, -sin * minus_z).as_vec3(), self.density([column, row]))
    }

    /// Radiance and density of a sky that is the same everywhere; [`uniform`] samples it.
    #[inline]
    pub(crate) fn constant(&self) -> Option<(Rgb, f32)> {
        self.constant
    }

    /// Density of the direction `d` under [`Self::sample`], sr⁻¹.
    #[inline]
    pub fn pdf(&self, d: Vec3) -> f32 {
        self.constant.map_or_else(|| self.density(self.texel(d)), |(_, density)| density)
    }

    fn density(&self, [column, row]: [u32; 2]) -> f32 {
        let height = self.heights[row as usize + 1] - self.heights[row as usize];
        let solid_angle = 2.0 * TAU * height / f64::from(self.image.size[0]);
        (f64::from(self.table.probability([column, row])) / solid_angle) as f32
    }

    /// Mean radiance over the sphere, (1/4π) ∫ L dω: exact, as a sum over texels.
    pub fn mean(&self) -> DVec3 {
        self.mean
    }
}

/// A uniformly distributed unit direction, as a constant sky is sampled.
#[inline(always)]
pub(crate) fn uniform(u: [f32; 2]) -> Vec3 {
    uniform_sphere(u).normalize()
}
