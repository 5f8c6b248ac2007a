//! All terms from one path, which ends or splits according to the light still expected of it.
//!
//! ```text
//! X_k = Σ over the walks of the path:  α_{k−1} · w_c · (sample of T E at x_{k−1})  +  α_k · w_s · E(x_k)
//! ```
//!
//! α_k is the throughput at vertex x_k; w_c and w_s are the MIS weights of connection and hit. The steps are those of
//! [`Prefix`](crate::estimator::Prefix), with [`ByExpectation`] between them instead of roulette. If paths of a wave split,
//! their copies are followed to the end first. So the memory needed is one wave for every vertex at which walks split.

use super::expected::{ByExpectation, Expecting};
use super::tracked::{Track, Tracked, TrackedWave};
use crate::estimator::branching::lineage;
use crate::estimator::{Job, Paths, Technique, TermEstimator, TermSink, prefix};
use crate::operator::{Sensor, Wave};

/// The prefix estimator of guided walks.
#[derive(Clone, Debug, PartialEq)]
pub struct Prefix {
    /// K: the terms k = 0..=K are kept.
    pub max_bounces: usize,
    /// Technique by which light is found.
    pub technique: Technique,
    /// Rule by which walks end or split.
    pub end: ByExpectation,
}

impl<'a, T: Expecting> TermEstimator<Tracked<'a, T>> for Prefix {
    fn slots(&self) -> usize {
        self.max_bounces + 2
    }

    fn sample<S: Sensor<Tracked<'a, T>>>(
        &self,
        job: &Job<'_, Tracked<'a, T>, S>,
        paths: &mut Paths<TrackedWave<T::Wave>>,
        sink: &mut impl TermSink,
    ) {
        prefix::start(job, paths, sink);
        self.follow(job.t, 0, paths, sink);
    }
}

impl Prefix {
    /// Follows paths from vertex `first` on, with all copies into which they split. Terms beyond K are added to the slot of
    /// the tail.
    fn follow<T: Expecting>(
        &self,
        t: &Tracked<'_, T>,
        first: usize,
        paths: &mut Paths<TrackedWave<T::Wave>>,
        sink: &mut impl TermSink,
    ) {
        let technique = self.technique;
        for v in first.. {
            if paths.n == 0 {
                break;
            }
            let slot = (v + 1).min(self.max_bounces + 1);
            prefix::connect(t, technique, v, slot, paths, sink);
            let splits = self.split(t, v, paths);
            for copy in 1..ByExpectation::MOST {
                let Some(mut copies) = copies(paths, &splits, v, copy) else { break };
                prefix::scatter(t, technique, v, slot, &mut copies, sink);
                self.follow(t, v + 1, &mut copies, sink);
            }
            prefix::scatter(t, technique, v, slot, paths, sink);
        }
    }

    /// Ends or splits paths at vertex v. Returns the paths that split: the number of each among the survivors, and its
    /// number of copies.
    fn split<T: Expecting>(
        &self,
        t: &Tracked<'_, T>,
        v: usize,
        paths: &mut Paths<TrackedWave<T::Wave>>,
    ) -> Vec<(usize, u32)> {
        let mut splits = vec![];
        if v < self.end.from() {
            return splits;
        }
        let mut survivors = 0;
        paths.survive(v, |wave, i, throughput, u| {
            let (x, siblings) = (wave.states.get(i), &mut wave.siblings[i]);
            let q = self.end.q(t.0, v, throughput, &x, wave.start[i]);
            let (copies, weight) = ByExpectation::copies(q, u, *siblings);
            if copies == 0 {
                return None;
            }
            *siblings *= copies;
            if copies > 1 {
                splits.push((survivors, copies));
            }
            survivors += 1;
            Some(throughput * weight)
        });
        splits
    }
}

/// Copy number `copy` ≥ 1 of every path that has split into more than `copy` copies at vertex v; `None` if there is no such
/// path.
fn copies<X: Copy, W: Wave<X>>(
    paths: &Paths<TrackedWave<W>>,
    splits: &[(usize, u32)],
    v: usize,
    copy: u32,
) -> Option<Paths<TrackedWave<W>>> {
    let of: Vec<usize> = splits.iter().filter(|(_, n)| *n > copy).map(|(i, _)| *i).collect();
    let key = lineage(paths.key().filter(|_| !of.is_empty())?, v, copy, ByExpectation::MOST);
    let mut copies = Paths::default();
    copies.descend_from::<Track<X>>(paths, of.into_iter(), key, 1.0);
    Some(copies)
}
