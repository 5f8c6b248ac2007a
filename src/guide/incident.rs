//! Incident light at every patch, by direction. One set of stored rays gives both the matrix and the guide.
//!
//! ```text
//! T_ij = ρ_i · (rays of i that hit j)/(rays of i)        u = T E + T u        W_ic = mean of u over the rays of i in cell c
//! ```
//!
//! ρ_i is the reflectance of patch i and E the emission. Each patch sends the same number of rays through each of the M × M
//! cells of the [cosine square](super::warp), so that all rays have the same weight in its row of T. Direct light T E is
//! estimated by connections and kept separate, because rays miss small lamps. u is reflected radiance: where connections
//! find the lamps, rays need to find reflected light only.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | hits | the patch that each ray of a row hits, [`NOTHING`] if none | [`Incident::hits`] |
//! | T E | direct light | [`Incident::direct`] |
//! | u | reflected radiance | [`Incident::radiance`] |
//! | W_ic | weight of cell c at patch i: the reflected radiance that arrives through it | [`Incident::weights`] |

use super::warp::CELLS;
use crate::math::direction::cosine_hemisphere;
use crate::math::{Key, Purpose, Rgb, Rng};
use crate::operator::patches::{Patch, Patches, polygon};
use crate::operator::{SceneTransport, Transport};
use crate::progress::Progress;
use crate::scene::{Side, Vertex, offset_origin};
use glam::Vec3;
use rayon::prelude::*;

/// Marks a ray that hits no patch.
pub const NOTHING: u32 = u32::MAX;

/// The fixed-point iteration stops when a step changes u by no more than this fraction of its mean.
const CHANGE: f32 = 1e-3;
const STEPS: usize = 64;

/// Number of rays and connections per patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fineness {
    /// Rays in each of the M × M cells.
    pub rays: usize,
    /// Connections to lamps per patch, for the direct light.
    pub connections: usize,
}

/// The stored rays of all patches, and the direct light at each patch.
pub struct Incident {
    fineness: Fineness,
    /// Hit patch of every ray, ordered by patch, then by cell.
    pub hits: Vec<u32>,
    /// T E: direct light of each patch.
    pub direct: Vec<Rgb>,
    reflectance: Vec<Rgb>,
}

impl Incident {
    /// Traces the rays. `scene` must be the scene from which `patches` were made. `None` if the run was stopped.
    pub fn new(
        scene: &SceneTransport<'_>,
        patches: &Patches,
        fineness: Fineness,
        key: Key,
        progress: Progress<'_>,
    ) -> Option<Self> {
        let Fineness { rays, .. } = fineness;
        let per_patch = CELLS * CELLS * rays;
        let mut hits = vec![NOTHING; patches.len() * per_patch];
        let row = |(i, row): (usize, &mut [u32])| {
            if progress.stopped() {
                return Rgb::ZERO;
            }
            progress.advance(1);
            for (ray, hit) in row.iter_mut().enumerate() {
                let u = Rng::at(key, i as u32, ray as u32, 0, Purpose::Scatter).four();
                let at = vertex(&patches[i], [u[2], u[3]]);
                let cell = ray / rays;
                let place = |cell: usize, u: f32| (cell as f32 + u).min(((cell + 1) as f32).next_down()) / CELLS as f32;
                let (direction, _) = cosine_hemisphere(at.n, [place(cell % CELLS, u[0]), place(cell / CELLS, u[1])]);
                let seen = scene.scene.trace(offset_origin(at.p, at.n), direction);
                let patch = seen.and_then(|v| locate(patches, v.p, v.side));
                *hit = patch.map_or(NOTHING, |j| j as u32);
            }
            let connection = |c: usize| {
                let u = Rng::at(key, i as u32, c as u32, 0, Purpose::Start).four();
                let at = vertex(&patches[i], [u[2], u[3]]);
                let found = scene.connect(&at, &mut Rng::at(key, i as u32, c as u32, 0, Purpose::Connect));
                found.map_or(Rgb::ZERO, |s| s.weight * scene.emission(&s.state))
            };
            (0..fineness.connections).map(connection).sum::<Rgb>() / fineness.connections.max(1) as f32
        };
        let direct = hits.par_chunks_mut(per_patch).with_max_len(1).enumerate().map(row).collect();
        let reflectance = patches.iter().map(|p| p.reflectance.as_vec3()).collect();
        (!progress.stopped()).then_some(Self { fineness, hits, direct, reflectance })
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.direct.len()
    }

    /// Returns true if there is no patch.
    pub fn is_empty(&self) -> bool {
        self.direct.is_empty()
    }

    fn row(&self, i: usize) -> &[u32] {
        let n = self.hits.len() / self.len();
        &self.hits[i * n..(i + 1) * n]
    }

    /// (T u)_i: reflected radiance of patch i if the patches have the radiances `u`.
    fn gather(&self, i: usize, u: &[Rgb]) -> Rgb {
        let row = self.row(i);
        let sum: Rgb = row.iter().filter(|&&j| j != NOTHING).map(|&j| u[j as usize]).sum();
        self.reflectance[i] * sum / row.len() as f32
    }

    /// Solves u = T E + T u as accurately as a guide needs: until a step changes u by no more than 10⁻³ of its mean, or for
    /// 64 steps.
    pub fn radiance(&self) -> Vec<Rgb> {
        let mut u = self.direct.clone();
        for _ in 0..STEPS {
            let next: Vec<Rgb> = (0..self.len()).into_par_iter().map(|i| self.direct[i] + self.gather(i, &u)).collect();
            let change: f32 = next.iter().zip(&u).map(|(a, b)| (*a - *b).abs().element_sum()).sum();
            let all: f32 = next.iter().map(|a| a.element_sum()).sum();
            u = next;
            if change <= CHANGE * all {
                break;
            }
        }
        u
    }

    /// W_i, one weight per cell: the root mean square of u over the rays of the cell, with the channels averaged. The root
    /// mean square is used because a cell that is partly dark and partly bright needs more samples than its mean suggests.
    pub fn weights(&self, i: usize, u: &[Rgb]) -> Vec<f64> {
        let value = |&j: &u32| if j == NOTHING { 0.0 } else { f64::from(u[j as usize].element_sum()) / 3.0 };
        let cell = |rays: &[u32]| (rays.iter().map(|j| value(j).powi(2)).sum::<f64>() / rays.len() as f64).sqrt();
        self.row(i).chunks(self.fineness.rays).map(cell).collect()
    }
}

/// The number of the patch that contains the point `p` of a surface; `None` if no patch does.
pub(super) fn locate(patches: &Patches, p: Vec3, side: Side) -> Option<usize> {
    patches.locate((side / 2) as usize, side & 1 == 0, p.as_dvec3())
}

/// A point of a patch, chosen by `u`, as a vertex whose direction is the normal.
pub(super) fn vertex(patch: &Patch, u: [f32; 2]) -> Vertex {
    let (p, _) = polygon::at(&patch.polygon, f64::from(u[0]), f64::from(u[1]));
    let point = patch.lift(p);
    let n = point.normal.as_vec3();
    let side = 2 * patch.primitive as u32 + u32::from(!patch.front);
    Vertex { p: point.position.as_vec3(), n, omega: n, side }
}
