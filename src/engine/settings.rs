//! Settings of a run.

use super::discretisation::Factors;
use crate::estimator::render::Amount;
use crate::estimator::{Plan, Roulette, Technique};
use crate::guide::ByExpectation;
use crate::math::{Key, Points};
use crate::scene::Crop;
use crate::scene::bsdf::Sampling;
use std::time::Duration;

/// The largest K of a command, and the last term that a file may hold.
pub const MOST_BOUNCES: u16 = 1000;

/// Settings of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Samples per pixel.
    pub spp: u32,
    /// Time limit of a sampled world. Passes are added as long as the next one is expected to end in time; `spp` remains an
    /// upper limit.
    pub time: Option<Duration>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Point set of the samples of a pixel: independent, or a Sobol sequence.
    pub points: Points,
    /// R, the most replicates into which the samples of a pixel are divided: one for each sample if there are fewer.
    pub replicates: u32,
    /// K: the terms k = 0..=K are estimated separately.
    pub max_bounces: usize,
    /// Technique that finds light.
    pub technique: Technique,
    /// How directions are sampled: uniformly, by the cosine, or by the BSDF.
    pub sampling: Sampling,
    /// Roulette of the paths of the terms. With [`Roulette::after`] K, the terms keep all their samples.
    pub roulette: Roulette,
    /// Roulette of the paths of the path tracer.
    pub path_roulette: Roulette,
    /// If present, guided walks of [`Prefix`](crate::guide::Prefix) and of the path tracer end or split by the expected
    /// light, in place of roulette.
    pub by_expectation: Option<ByExpectation>,
    /// Approximate number of patches of the matrix.
    pub patches: usize,
    /// Factor by which patches get narrower towards edges; 1 means not at all
    /// ([`Patches::graded`](crate::operator::patches::Patches::graded)).
    pub grading: f64,
    /// Form in which the form factors are stored.
    pub factors: Factors,
    /// If true, a pixel shows the patch under it, without gathering.
    pub read_patches: bool,
    /// If present, only these pixels of the picture are rendered.
    pub crop: Option<Crop>,
}

impl Default for Settings {
    /// The defaults of the command line.
    fn default() -> Self {
        let (max_bounces, end) = (8, Roulette::Albedo { from: 2 });
        Self {
            spp: 256,
            time: None,
            seed: 0,
            points: Points::Independent,
            replicates: Amount::REPLICATES,
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
            crop: None,
        }
    }
}

impl Settings {
    /// Key of the random stream of that name, divided among `replicates` replicates.
    pub fn key(&self, stream: &str, replicates: usize) -> Key {
        Key::new(self.seed, stream).with_points(self.points, replicates)
    }

    /// Number of replicates of `spp` samples of a pixel.
    pub fn replicates_of(&self, spp: u32) -> u32 {
        spp.min(self.replicates).max(1)
    }

    /// Points and replicates in words, where they are not the usual ones.
    pub fn spread(&self) -> Vec<String> {
        let points = (self.points == Points::Sobol).then(|| "Sobol points".into());
        let replicates = (self.replicates != Amount::REPLICATES).then(|| format!("{} replicates", self.replicates));
        points.into_iter().chain(replicates).collect()
    }

    /// The plan of the term estimators.
    pub fn plan(&self) -> Plan {
        Plan { max_bounces: self.max_bounces, technique: self.technique, roulette: self.roulette.clone() }
    }
}
