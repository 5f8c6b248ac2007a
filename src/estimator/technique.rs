//! Techniques that find light: by hits, by connections, or by both. All emission rules of the estimators are in this file.
//!
//! Each technique that can find a path gets a weight, and the weights of one path sum to 1. p is the density of the
//! technique that found the path, p° that of the other technique, in the same measure. p° = 0 means that the other technique
//! cannot find the path at all: after a delta vertex, or where the light has no area.
//!
//! | emission counts | `Scatter` | `Connect` | `Mis` | `Power` |
//! |---|---|---|---|---|
//! | at vertex 0, what the eye sees | 1 | 1 | 1 | 1 |
//! | on a hit, p° > 0 | 1 | 0 | p/(p + p°) | p²/(p² + p°²) |
//! | on a hit, p° = 0 (after a mirror) | 1 | 1 | 1 | 1 |
//! | through a connection | 0 | 1 | p/(p + p°) | p²/(p² + p°²) |
//! | through a connection, p° = 0 (a point light) | 0 | 1 | 1 | 1 |
//!
//! The fourth column is the balance heuristic, the fifth the power heuristic with exponent 2. Only `Scatter` breaks the rule
//! that weights sum to 1: it misses lights without area. `engine::known::unsampled` reports that, so no light goes missing
//! silently.
//! Reference: Veach and Guibas, *Optimally Combining Sampling Techniques* (1995).

use crate::math::Columns;
use crate::operator::{Samples, Transport};

/// Technique that finds light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// Emission counts only where the walk hits it.
    Scatter,
    /// Emission counts through next-event estimation, and on hits only where next-event estimation cannot find it.
    Connect,
    /// Both, weighted by the balance heuristic.
    Mis,
    /// Both, weighted by the power heuristic.
    Power,
}

impl Technique {
    /// All techniques.
    pub const ALL: [Self; 4] = [Self::Scatter, Self::Connect, Self::Mis, Self::Power];

    /// Returns true if the technique uses next-event estimation.
    pub fn connects(self) -> bool {
        self != Self::Scatter
    }

    /// Returns true if emission can count on hits with this transport: always, unless connections find all of it.
    pub fn hits<T: Transport>(self, t: &T) -> bool {
        self != Self::Connect || !t.connects_to_all()
    }

    /// Weight of emission on a hit that was found with density `p`; a connection would have found it with density `other`.
    #[inline(always)]
    pub fn hit(self, p: f32, other: f32) -> f32 {
        match self {
            Self::Scatter => 1.0,
            Self::Connect => f32::from(u8::from(other == 0.0)),
            Self::Mis => balance(p, other),
            Self::Power => power(p, other),
        }
    }

    /// Weight of a connection that was found with density `p`; scattering would have found it with density `other`.
    #[inline(always)]
    pub fn connection(self, p: f32, other: f32) -> f32 {
        match self {
            Self::Scatter => 0.0,
            Self::Connect => 1.0,
            Self::Mis => balance(p, other),
            Self::Power => power(p, other),
        }
    }

    /// Multiplies the values of the first `n` hits of a wave by their weights and throughputs.
    pub fn score_hits(self, samples: &mut Samples, throughput: &Columns, n: usize) {
        match self {
            Self::Scatter => samples.value.multiply(throughput, n),
            Self::Connect => score(samples, throughput, n, |p, other| Self::Connect.hit(p, other)),
            Self::Mis => score(samples, throughput, n, |p, other| Self::Mis.hit(p, other)),
            Self::Power => score(samples, throughput, n, |p, other| Self::Power.hit(p, other)),
        }
    }

    /// Multiplies the values of the first `n` connections of a wave by their weights and throughputs.
    pub fn score_connections(self, samples: &mut Samples, throughput: &Columns, n: usize) {
        match self {
            Self::Connect => samples.value.multiply(throughput, n),
            Self::Scatter => score(samples, throughput, n, |p, other| Self::Scatter.connection(p, other)),
            Self::Mis => score(samples, throughput, n, |p, other| Self::Mis.connection(p, other)),
            Self::Power => score(samples, throughput, n, |p, other| Self::Power.connection(p, other)),
        }
    }
}

#[inline(always)]
fn balance(p: f32, other: f32) -> f32 {
    p / (p + other)
}

/// The power heuristic, computed from the ratio of densities, whose square overflows only where the weight is 0.
#[inline(always)]
fn power(p: f32, other: f32) -> f32 {
    let ratio = other / p;
    1.0 / (1.0 + ratio * ratio)
}

struct Score<'a, F> {
    samples: &'a mut Samples,
    throughput: &'a Columns,
    n: usize,
    weight: F,
}

fn score(samples: &mut Samples, throughput: &Columns, n: usize, weight: impl Fn(f32, f32) -> f32) {
    pulp::Arch::new().dispatch(Score { samples, throughput, n, weight });
}

impl<F: Fn(f32, f32) -> f32> pulp::WithSimd for Score<'_, F> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { samples, throughput, n, weight } = self;
        let (p, other) = (&samples.pdf[..n], &samples.other_pdf[..n]);
        let (a, b, c) = (&throughput.x[..n], &throughput.y[..n], &throughput.z[..n]);
        let Columns { x, y, z } = &mut samples.value;
        let (x, y, z) = (&mut x[..n], &mut y[..n], &mut z[..n]);
        for i in 0..n {
            let w = weight(p[i], other[i]);
            x[i] = x[i] * w * a[i];
            y[i] = y[i] * w * b[i];
            z[i] = z[i] * w * c[i];
        }
    }
}

impl std::fmt::Display for Technique {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Scatter => "scatter",
            Self::Connect => "connect",
            Self::Mis => "mis",
            Self::Power => "mis-power",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For any densities, the weights of the two techniques that find a path sum to 1, except where `Scatter` finds nothing.
    #[test]
    fn weights_of_one_path_sum_to_one() {
        for technique in Technique::ALL {
            for (hit, connect) in [(1.0, 1.0), (1e-3, 70.0), (3e25, 2e-20), (1e-20, 4e30), (0.25, 0.75)] {
                let sum = technique.hit(hit, connect) + technique.connection(connect, hit);
                assert!((sum - 1.0).abs() < 1e-6, "{technique} {hit} {connect}: {sum}");
            }
            // after a mirror no connection is possible, and a point light is never hit by scattering
            assert_eq!(technique.hit(0.5, 0.0), 1.0);
            assert_eq!(technique.connection(0.5, 0.0), if technique == Technique::Scatter { 0.0 } else { 1.0 });
        }
    }
}
