//! What a run is made with.

use super::discretisation::Factors;
use crate::estimator::{Plan, Roulette, Technique};
use crate::guide::ByExpectation;
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
    /// How guided walks of [`Prefix`](crate::guide::Prefix) and of the path tracer end or split, in place of roulette.
    pub by_expectation: Option<ByExpectation>,
    /// About how many patches the matrix has.
    pub patches: usize,
    /// How much narrower its patches get towards edges; 1: not at all ([`Patches::graded`](crate::operator::patches::Patches::graded)).
    pub grading: f64,
    /// How its form factors are held.
    pub factors: Factors,
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
            by_expectation: None,
            patches: 600,
            grading: 1.0,
            factors: Factors::Dense,
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
