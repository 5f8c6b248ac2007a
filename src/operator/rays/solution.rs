//! The light on the patches, computed with stored rays, in three colour channels at once.
//!
//! ```text
//! T^0 E = E     T^1 E = D     T^{k+1} E = T (T^k E)          L = E + u,   u = D + T u = Σ_{k≥0} T^k D
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | D | T E, where direct light from distant emitters is sampled with pairs of points | [`Rays::direct`] |
//! | u | reflected light, L − E | [`Solved`] |
//! | δ | (I − T)⁻¹ [D₁ − D₂ + (T₁ − T₂) u]: to first order the difference between the solutions of the two halves of the rays | [`Light::noise`] |
//!
//! Gathering reads one 16-byte record per ray for all three channels, because the channels differ only in ρ. Terms are
//! stored as records in single precision; this changes u by a relative 10⁻⁷.

use super::{Half, Hit, Rays};
use crate::operator::matrix::reached;
use crate::operator::patches::Patches;
use glam::DVec3;
use rayon::prelude::*;

/// Maximum number of terms of the Neumann series that carries the noise of the rows to the noise of the solution.
const NOISE_STEPS: usize = 100;

/// The three channels of a patch, in the form that gathering reads; the fourth number is 0.
pub type Record = [f32; 4];

/// Rounds three channels to a record.
#[inline(always)]
pub fn record(x: DVec3) -> Record {
    [x.x as f32, x.y as f32, x.z as f32, 0.0]
}

/// The three channels of a record.
#[inline(always)]
pub(super) fn channels([x, y, z, _]: Record) -> DVec3 {
    DVec3::new(x.into(), y.into(), z.into())
}

/// A scene on its patches, with stored rays as the operator.
#[derive(Clone, Copy, Debug)]
pub struct Light<'a> {
    /// The mesh.
    pub patches: &'a Patches,
    /// The stored rays from its patches.
    pub rays: &'a Rays,
}

/// The solution L, computed by the Neumann series.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// The radiance L per patch.
    pub radiance: Vec<DVec3>,
    /// The residual max |D − (I − T) u| per channel.
    pub residual: DVec3,
    /// Number of applications of T.
    pub steps: usize,
    /// The last term of the series; it is close to the dominant mode in every channel.
    pub last: Vec<Record>,
}

impl<'a> Light<'a> {
    /// The emission E per patch.
    pub fn emission(&self) -> Vec<DVec3> {
        self.patches.iter().map(|p| p.emission).collect()
    }

    /// The direct light D per patch.
    pub fn direct(&self) -> Vec<DVec3> {
        (0..self.rays.n).map(|i| self.rays.direct(i)).collect()
    }

    /// For each patch and channel, whether light reaches it along the stored rays.
    pub fn reached(&self) -> Vec<[bool; 3]> {
        let channel = |c: usize| {
            let starts = |i: usize| self.patches[i].emission[c] > 0.0 || self.rays.direct(i)[c] > 0.0;
            let sees = |i: usize, sends: &[bool]| {
                self.rays
                    .row(i)
                    .iter()
                    .any(|run| run.iter().take_while(|h| **h != Hit::NOTHING).any(|h| sends[h.patch()]))
            };
            reached(self.rays.n, starts, |i| self.patches[i].reflectance[c] > 0.0, sees)
        };
        let [r, g, b] = [0, 1, 2].map(channel);
        r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
    }

    /// T x, computed with the part `half` of the rays.
    pub fn bounce(&self, x: &[DVec3], half: Half) -> Vec<DVec3> {
        self.gathered(x, half, |i| self.patches[i].reflectance)
    }

    /// diag(ρ) F x for the reflectance `rho`.
    pub(super) fn gathered(&self, x: &[DVec3], half: Half, rho: impl Fn(usize) -> DVec3 + Sync + Send) -> Vec<DVec3> {
        let x: Vec<Record> = x.iter().map(|x| record(*x)).collect();
        self.each(|i| rho(i) * self.mean(&x, half, i))
    }

    /// diag(ρ) F x, with records as input and output.
    pub(super) fn mapped(&self, x: &[Record], rho: impl Fn(usize) -> DVec3 + Sync + Send) -> Vec<Record> {
        self.each(|i| record(rho(i) * self.mean(x, Half::Both, i)))
    }

    fn each<R: Send>(&self, of: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
        (0..self.rays.n).into_par_iter().with_min_len(64).map(of).collect()
    }

    /// The mean of x over the hits of row i, (F x)ᵢ.
    fn mean(&self, x: &[Record], half: Half, i: usize) -> DVec3 {
        let [a, b] = self.rays.row(i);
        match half {
            Half::Both => (gather(x, a) + gather(x, b)) / self.rays.per_row as f64,
            Half::First => gather(x, a) / a.len() as f64,
            Half::Second => gather(x, b) / b.len() as f64,
        }
    }

    /// The terms T^k E for k = 0 ..= `k_max`, one vector over the patches per k.
    pub fn terms(&self, k_max: usize) -> Vec<Vec<DVec3>> {
        let mut terms = vec![self.emission()];
        for k in 1..=k_max {
            terms.push(if k == 1 { self.direct() } else { self.bounce(&terms[k - 1], Half::Both) });
        }
        terms
    }

    /// Computes L as a sum. The summation ends when the estimated rest of the series is below `tolerance` times the sum
    /// (area-weighted norms over the patches), or after `most` applications of T.
    pub fn solve(&self, tolerance: f64, most: usize) -> Solved {
        let (mut radiance, last, steps) = self.sum(self.direct(), tolerance, most);
        let residual = last.iter().fold(DVec3::ZERO, |a, x| worst(a, channels(*x).abs()));
        radiance.iter_mut().zip(self.patches.iter()).for_each(|(u, p)| *u += p.emission);
        Solved { radiance, residual, steps, last }
    }

    /// Returns Σ T^k x without the last term computed, that last term, and the number of applications. Terms are records in
    /// single precision; the sum is in double precision.
    fn sum(&self, x: Vec<DVec3>, tolerance: f64, most: usize) -> (Vec<DVec3>, Vec<Record>, usize) {
        let mut term: Vec<Record> = x.iter().map(|x| record(*x)).collect();
        let mut sum = x;
        let mut before = self.length(&sum, |x| *x);
        for step in 1..=most {
            term = self.mapped(&term, |i| self.patches[i].reflectance);
            let now = self.length(&term, |x| channels(*x));
            let rate = now / before;
            // estimate of the rest: a geometric series with the last ratio, or the last term itself if the ratio is not
            // below 1
            let left = DVec3::select(rate.cmplt(DVec3::ONE), now * rate / (1.0 - rate), now);
            if now == DVec3::ZERO || left.cmple(tolerance * self.norm(&sum)).all() {
                return (sum, term, step);
            }
            sum.iter_mut().zip(&term).for_each(|(s, t)| *s += channels(*t));
            before = now;
        }
        (sum, term, most)
    }

    /// Half of δ, per patch. Its size is that of the standard error of a solution that contains u = L − E.
    ///
    /// If an output is linear in L, applying it to this vector gives an error bar of that output with one degree of freedom.
    /// The norm over many patches is a reliable error bar.
    pub fn noise(&self, radiance: &[DVec3]) -> Vec<DVec3> {
        let u: Vec<Record> = radiance.iter().zip(self.patches.iter()).map(|(l, p)| record(*l - p.emission)).collect();
        let difference = self.each(|i| {
            let direct = self.rays.direct_half(i, 0) - self.rays.direct_half(i, 1);
            let apart = self.mean(&u, Half::First, i) - self.mean(&u, Half::Second, i);
            0.5 * (direct + self.patches[i].reflectance * apart)
        });
        drop(u);
        // the noise of neighbouring patches cancels in T, so few terms suffice; after them the rest is the dominant mode, a
        // geometric series
        let (mut sum, last, steps) = self.sum(difference, 1e-2, NOISE_STEPS);
        if steps == NOISE_STEPS {
            let next = self.mapped(&last, |i| self.patches[i].reflectance);
            let rate = self.length(&next, |x| channels(*x)) / self.length(&last, |x| channels(*x));
            let rest = DVec3::select(rate.cmplt(DVec3::ONE), rate / (1.0 - rate), DVec3::ZERO);
            sum.iter_mut().zip(&last).for_each(|(s, t)| *s += rest * channels(*t));
        }
        sum
    }

    /// √(Σ Aᵢ xᵢ²) per channel.
    pub fn norm(&self, x: &[DVec3]) -> DVec3 {
        self.length(x, |x| *x)
    }

    fn length<X>(&self, x: &[X], value: impl Fn(&X) -> DVec3) -> DVec3 {
        let square: DVec3 = x.iter().zip(&self.rays.area).map(|(x, a)| *a * value(x) * value(x)).sum();
        square.powf(0.5)
    }
}

fn gather(records: &[Record], hits: &[Hit]) -> DVec3 {
    // rays that hit nothing sort last
    let hits = &hits[..hits.partition_point(|h| *h != Hit::NOTHING)];
    let mut sum = [0.0f64; 4];
    for h in hits {
        let record = &records[h.patch()];
        for c in 0..4 {
            sum[c] += f64::from(record[c]);
        }
    }
    DVec3::new(sum[0], sum[1], sum[2])
}

/// The larger of two numbers per channel; NaN if one is NaN.
fn worst(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::select(b.cmple(a), a, b)
}
