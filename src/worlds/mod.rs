//! One scene, solved three ways: each function takes a scene through one realisation of T, from paths or patches to a
//! [`Series`](crate::terms::Series) with images.
//!
//! | world | what is computed | place |
//! |---|---|---|
//! | terms | every `T^k E` by its own estimator | [`sampled::terms`] |
//! | path | Σ T^k E by the full path tracer | [`sampled::path`] |
//! | guided | both, with the matrix as a guide | [`guided`] |
//! | radiosity | `T_h^k E` and the solve, through the same camera | [`discrete::radiosity`] |
//! | batches | the same, small and one after another, for what is watched while it grows | [`batches::Side`] |
//! | coplanar | where surfaces coincide and differ, and are seen | [`coplanar::seen`] |
//! | equilibrium | both sides of L = E + T L, point by point and through the camera | [`equilibrium`] |
//! | convergence | how variance and squared error fall in one render | [`convergence::Recorder`] |
//! | split | the terms with so many samples each | [`split::measure`] |
//! | stages | one image as it grows | [`stages::render_stages`] |
//! | strategies | every way to find every term from both ends | [`pyramid::strategies`] |
//! | refine | the matrix on finer and finer meshes, against rays | [`refine::refine`] |
//! | walk | the same estimators on the radiosity matrix | [`walk::walk`], [`zero_variance::study`] |
//! | growth | whether the variance of long paths is finite | [`growth::growth`] |
//! | trap, resort | whether light gets out, and how paths end that nothing else ends | [`trap::trapped`], [`resort::with_last_resort`] |
//! | roulette | noise and cost of schedules, the best of them | [`roulette::pilot`], [`roulette::optimal`] |
//! | surface | ‖T^k E‖₁ over the whole scene, camera-free | [`surface::norms`] |

pub mod batches;
pub mod convergence;
pub mod coplanar;
pub mod discrete;
pub mod discretisation;
pub mod doubts;
pub mod equilibrium;
pub mod growth;
pub mod guided;
pub mod length;
pub mod pyramid;
pub mod radius;
pub mod refine;
pub mod resort;
pub mod roulette;
pub mod sampled;
pub mod split;
pub mod stages;
pub mod surface;
pub mod trap;
pub mod unsampled;
pub mod walk;
pub mod zero_variance;

use crate::estimator::{Plan, Roulette, Technique};
use crate::math::{Key, Points};
use crate::scene::bsdf::Sampling;
use std::time::Duration;

/// What a run is made with.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Samples per pixel.
    pub spp: u32,
    /// How long a sampled world may take: passes are added while the next one is expected to end in time, and `spp` is a limit.
    pub time: Option<Duration>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How the samples of a pixel lie to each other.
    pub points: Points,
    /// K.
    pub max_bounces: usize,
    /// How light is found.
    pub technique: Technique,
    /// How directions are drawn.
    pub sampling: Sampling,
    /// How paths of the terms end; with [`Roulette::after`] K, the terms keep all their samples.
    pub roulette: Roulette,
    /// How paths of the path tracer end.
    pub path_roulette: Roulette,
    /// About how many patches the matrix has.
    pub patches: usize,
    /// How much narrower its patches get towards edges; 1: not at all ([`Patches::graded`](crate::operator::patches::Patches::graded)).
    pub grading: f64,
    /// How its form factors are held.
    pub factors: discretisation::Factors,
    /// Read the patch under the pixel instead of gathering.
    pub read_patches: bool,
}

impl Default for Settings {
    /// What the command line does unless told otherwise.
    fn default() -> Self {
        let (max_bounces, end) = (8, Roulette::Albedo { from: 2 });
        Self {
            spp: 256,
            time: None,
            seed: 0,
            points: Points::Independent,
            max_bounces,
            technique: Technique::Mis,
            sampling: Sampling::Bsdf,
            roulette: end.clone().after(max_bounces),
            path_roulette: end,
            patches: 600,
            grading: 1.0,
            factors: discretisation::Factors::Dense,
            read_patches: false,
        }
    }
}

impl Settings {
    /// The stream of that name, dealt to so many replicates.
    pub fn key(&self, stream: &str, replicates: usize) -> Key {
        Key::new(self.seed, stream).with_points(self.points, replicates)
    }

    /// The plan of the term estimators.
    pub fn plan(&self) -> Plan {
        Plan { max_bounces: self.max_bounces, technique: self.technique, roulette: self.roulette.clone() }
    }
}
