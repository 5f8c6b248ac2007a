//! The operator over patches as stored rays: rows sampled once, applied as often as wanted.
//!
//! ```text
//! Fᵢⱼ ≈ #{s : ray s of patch i arrives at j} / N        (F x)ᵢ ≈ (1/N) Σₛ x_{hit(i,s)}
//! ray s of i: origin uniform on the uncovered part of Pᵢ, direction with density cos θ/π
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | N | rays of a row, all of the same weight 1/N | [`Rays::per_row`] |
//! | hit(i, s) | patch met, or [`Hit::NOTHING`] | [`Rays::row`] |
//! | T = diag(ρ) F | the operator of one channel | [`RayOperator`] |
//! | D | T E of the emitters, by pairs of points where they are far | `direct` |
//!
//! The four numbers of a ray are a point of a lattice with a random shift of its own in every row (`lattice`). Rows of a
//! closed scene sum to exactly 1; single entries are poor, but the errors of a row cancel in T x, which converges about
//! like N^−0.7. Restoring AᵢFᵢⱼ = AⱼFⱼᵢ by averaging both would break that cancellation and is not done: T is self-adjoint
//! only within the sampling error, which [`Light::checks`] states.
//!
//! The first and the second half of a row are lattices of N/2 rays each: their difference gives every result an error bar
//! ([`Light::noise`]). Both share one shift and complement each other, so the bar is a little too long (1.1 to 1.5 times)
//! rather than too short.
//!
//! Reference: Pattanaik and Mudur, *Computation of global illumination by Monte Carlo simulation of the particle model of light* (1992).

mod caster;
mod checks;
mod direct;
mod entries;
mod hit;
mod lamps;
mod lattice;
mod operator;
mod origin;
mod solution;
mod spectrum;

pub use checks::RayChecks;
pub use entries::RayColumns;
pub use hit::Hit;
pub use operator::{Coarse, Half, RayOperator};
pub use solution::{Light, Record, Solved, record};

use super::form_factor::Stopped;
use super::patches::Patches;
use crate::math::Key;
use crate::progress::Progress;
use crate::scene::Scene;
use caster::{Caster, Scratch};
use glam::DVec3;
use lamps::Lamps;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Rows of F as rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Rays {
    /// Number of patches.
    pub n: usize,
    /// N, even.
    pub per_row: usize,
    /// Aᵢ, m².
    pub area: Vec<f64>,
    /// Row i at `i·N`: the hits of its first half, ascending, then those of its second.
    hits: Vec<Hit>,
    /// T E per patch and half, with ρ.
    direct: Vec<[[f32; 3]; 2]>,
    /// Rays that met a reflecting surface where no patch is, and count as having met nothing.
    pub lost: u64,
}

/// Rows that are told together: they are short.
const ROWS: u64 = 64;

impl Rays {
    /// Traces `per_row` rays (rounded up to an even number; powers of two are best) from every patch. The result does
    /// not depend on the number of threads.
    ///
    /// # Errors
    /// [`Stopped`] when `progress` says so.
    ///
    /// # Panics
    /// If the mesh has more than [`Hit::MOST`] patches.
    pub fn new(
        patches: &Patches,
        scene: &Scene,
        per_row: usize,
        seed: u64,
        progress: Progress<'_>,
    ) -> Result<Self, Stopped> {
        let (n, per_row) = (patches.len(), per_row.max(2).next_multiple_of(2));
        assert!(n <= Hit::MOST, "patches are numbered in three bytes");
        let caster = Caster { patches, scene, lamps: Lamps::new(patches), key: Key::new(seed, "form factors") };
        let (done, lost) = (AtomicU64::new(0), AtomicU64::new(0));
        let (mut hits, mut direct) = (vec![Hit::NOTHING; n * per_row], vec![[[0.0f32; 3]; 2]; n]);
        hits.par_chunks_mut(per_row).zip(&mut direct).enumerate().with_min_len(16).for_each_init(
            || Scratch::new(per_row),
            |scratch, (i, (row, direct))| {
                if progress.stopped() {
                    return;
                }
                let mut met = std::mem::take(&mut scratch.row);
                lost.fetch_add(caster.row(i, scratch, &mut met), Relaxed);
                *direct = caster.direct(i, &met, scratch);
                met.chunks_mut(per_row / 2).for_each(<[u32]>::sort_unstable);
                row.iter_mut().zip(&met).for_each(|(hit, patch)| *hit = Hit::new(*patch));
                scratch.row = met;
                let done = done.fetch_add(1, Relaxed) + 1;
                if done % ROWS == 0 || done == n as u64 {
                    progress.advance(if done % ROWS == 0 { ROWS } else { done % ROWS });
                }
            },
        );
        if progress.stopped() {
            return Err(Stopped);
        }
        Ok(Self { n, per_row, area: patches.areas(), hits, direct, lost: lost.into_inner() })
    }

    /// What the rays of patch `i` met: the halves, each ascending, with [`Hit::NOTHING`] last.
    pub fn row(&self, i: usize) -> [&[Hit]; 2] {
        self.hits[i * self.per_row..(i + 1) * self.per_row].split_at(self.per_row / 2).into()
    }

    /// D, the light that comes directly from the emitters, reflected once: `T E`.
    pub fn direct(&self, i: usize) -> DVec3 {
        0.5 * (self.direct_half(i, 0) + self.direct_half(i, 1))
    }

    fn direct_half(&self, i: usize, half: usize) -> DVec3 {
        DVec3::from(self.direct[i][half].map(f64::from))
    }

    /// Fᵢⱼ as sampled, for looking at: not accurate one by one.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let count = |half: &[Hit]| half.partition_point(|h| h.patch() <= j) - half.partition_point(|h| h.patch() < j);
        self.row(i).into_iter().map(count).sum::<usize>() as f64 / self.per_row as f64
    }

    /// Bytes the rows take.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.hits) + size_of_val(&*self.direct)
    }
}
