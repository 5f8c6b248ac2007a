//! Skies and spheres as lights: what is drawn has the density that is claimed, and the density belongs to the radiance.
//!
//! Histograms are compared with integrals of the density by χ²; the wrong samplers at the end of each test are the ones
//! people write (no sine in a map by latitude and longitude, a disk instead of a sphere), and they must be seen.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "lights/skies.rs"]
mod skies;
#[path = "lights/spheres.rs"]
mod spheres;

use common::sampling::mean_of;
use common::truth::case;
use common::{Account, Noise, assert_rate, open};
use fredholm::math::distribution::Table;
use fredholm::scene::description::Sky;
use fredholm::scene::emitter::{cone, environment::Environment};
use fredholm::scene::raster::Raster;
use glam::{DQuat, DVec3, Vec3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Two numbers as a path draws them: multiples of 2⁻²⁴ in [0, 1).
fn pair(noise: &mut Noise) -> [f32; 2] {
    let bits = noise.bits();
    [bits >> 40, (bits >> 8) & 0xff_ffff].map(|j| j as f32 / 16_777_216.0)
}

/// Pearson's χ² of counts against probabilities: its p-value. Bins that expect fewer than 40 are one bin, and what is
/// impossible must not happen.
fn chi_squared(hits: &[u64], probabilities: &[f64]) -> f64 {
    let total: f64 = hits.iter().sum::<u64>() as f64;
    let (mut chi, mut bins, mut rest) = (0.0, 0, [0.0; 2]);
    for (&n, &p) in hits.iter().zip(probabilities) {
        assert!(n == 0 || p > 0.0, "{n} draws of probability 0");
        if p * total < 40.0 {
            rest = [rest[0] + n as f64, rest[1] + p * total];
        } else {
            (chi, bins) = (chi + (n as f64 - p * total).powi(2) / (p * total), bins + 1);
        }
    }
    if rest[1] >= 40.0 {
        (chi, bins) = (chi + (rest[0] - rest[1]).powi(2) / rest[1], bins + 1);
    }
    if bins < 2 { 1.0 } else { ChiSquared::new(f64::from(bins - 1)).unwrap().sf(chi) }
}

#[track_caller]
fn assert_fits(account: &mut Account, what: &str, hits: &[u64], probabilities: &[f64]) {
    let (p, level) = (chi_squared(hits, probabilities), account.spend(1));
    assert!(p > level, "{what}: p = {p:e}, level {level:e}, seed {}", account.seed());
}

#[track_caller]
fn assert_misfits(account: &mut Account, what: &str, hits: &[u64], probabilities: &[f64]) {
    let (p, level) = (chi_squared(hits, probabilities), account.spend(1));
    assert!(p < level, "{what} is not seen: p = {p:e}, seed {}", account.seed());
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((sin, cos), (x, minus_z)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(sin * x, cos, -sin * minus_z)
}
