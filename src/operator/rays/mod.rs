//! The discrete operator over patches in the form of stored rays: the rows are sampled once and applied as often as needed.
//!
//! ```text
//! Fᵢⱼ ≈ #{s : ray s of patch i arrives at j} / N        (F x)ᵢ ≈ (1/N) Σₛ x_{hit(i,s)}
//! ray s of i: origin uniform on the uncovered part of Pᵢ, direction with density cos θ/π
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | N | number of rays of a row; each has the weight 1/N | [`Rays::per_row`] |
//! | hit(i, s) | the patch that ray s of patch i hits, or [`Hit::NOTHING`] | [`Rays::row`] |
//! | T = diag(ρ) F | the operator of one colour channel | [`RayOperator`] |
//! | | rows of one part, traced on one of several machines | [`Rows`] |
//! | D | direct light T E; for distant emitters it is sampled with pairs of points | `direct` |
//!
//! The four numbers that define a ray are a point of a lattice (`lattice`), which has a separate random shift in every row.
//! Rows of a closed scene sum to exactly 1. Single entries are inaccurate, but the errors of a row cancel in T x, whose
//! error falls about like N^−0.7. Averaging Fᵢⱼ and Fⱼᵢ to restore AᵢFᵢⱼ = AⱼFⱼᵢ would destroy this cancellation and is not
//! done. T is therefore self-adjoint only within the sampling error, which [`Light::checks`] reports.
//!
//! The first and the second half of a row are lattices of N/2 rays each. Their difference gives every result an error bar
//! ([`Light::noise`]). Both halves share one shift and complement each other. The error bar is therefore somewhat too long
//! (1.1 to 1.5 times), never too short for this reason.
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
mod rows;
mod solution;
mod spectrum;

pub use checks::RayChecks;
pub use entries::RayColumns;
pub use hit::Hit;
pub use operator::{Coarse, Half, RayOperator};
pub use rows::Rows;
pub use solution::{Light, Record, Solved, record};

use glam::DVec3;

/// The rows of F, stored as rays, which [`Rays::new`] traces.
#[derive(Clone, Debug, PartialEq)]
pub struct Rays {
    /// Number of patches.
    pub n: usize,
    /// N, the number of rays per row; it is even.
    pub per_row: usize,
    /// The areas Aᵢ of the patches, m².
    pub area: Vec<f64>,
    /// The hits of row i begin at `i·N`: those of its first half, ascending, then those of its second half, ascending.
    hits: Vec<Hit>,
    /// Direct light T E per patch, half of the rays, and channel; the reflectance ρ is included.
    direct: Vec<[[f32; 3]; 2]>,
    /// Number of rays that hit a reflecting surface at a point without a patch. They count as rays that hit nothing.
    pub lost: u64,
}

impl Rays {
    /// The hits of the rays of patch `i`, as two halves. Each half is ascending, with [`Hit::NOTHING`] last.
    pub fn row(&self, i: usize) -> [&[Hit]; 2] {
        self.hits[i * self.per_row..(i + 1) * self.per_row].split_at(self.per_row / 2).into()
    }

    /// D, the direct light of patch `i`: light that comes from the emitters and is reflected once, `T E`.
    pub fn direct(&self, i: usize) -> DVec3 {
        0.5 * (self.direct_half(i, 0) + self.direct_half(i, 1))
    }

    fn direct_half(&self, i: usize, half: usize) -> DVec3 {
        DVec3::from(self.direct[i][half].map(f64::from))
    }

    /// The sampled value of Fᵢⱼ, for inspection; a single entry is not accurate.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let count = |half: &[Hit]| half.partition_point(|h| h.patch() <= j) - half.partition_point(|h| h.patch() < j);
        self.row(i).into_iter().map(count).sum::<usize>() as f64 / self.per_row as f64
    }

    /// Memory used by the rows, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.hits) + size_of_val(&*self.direct)
    }
}
