//! Naive branching: every vertex has N children, so the number of rays grows exponentially with the path length.
//!
//! ```text
//! (T L)(x_v) ≈ 1/N Σ_{c<N} weight_c · L(x_{v+1,c})         N^k paths of length k for one value of the pixel
//! ```
//!
//! Each child draws its own random numbers for its connection, its roulette and its direction. So one vertex makes N
//! connections and scatters N rays, each of weight 1/N. The mean over the children is the mean of N independent samples of
//! the step that [`Prefix`](super::Prefix) takes once. One part of the variance falls as 1/N^k, while the cost of term k
//! grows as N^k. The part that the first ray decides (the point that the pixel sees) does not fall at all. With N = 1 this
//! **is** the prefix estimator, bit for bit.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | N | children of a vertex | [`Branching::children`] |
//! | c₀ c₁ … | a lineage: the child that was followed at each vertex | the key of a wave |
//! | K | branching stops at vertex K: from there each path follows one child, because otherwise the tail would never end | [`Plan::max_bounces`] |
//!
//! A wave holds one lineage of every path of the batch. The tree is walked depth first, with one wave in memory per depth.
//! Memory is therefore `K + 1` waves, however large N^K is. Reference: Whitted, *An Improved Illumination Model for Shaded
//! Display* (1980), for the tree; Cook, Porter, Carpenter, *Distributed Ray Tracing* (1984); Kajiya, *The Rendering
//! Equation* (1986), for why one child is enough.

use super::{Job, Paths, Plan, TermEstimator, TermSink, prefix};
use crate::math::Key;
use crate::operator::{Sensor, Transport};

/// The branching estimator.
#[derive(Clone, Debug, PartialEq)]
pub struct Branching {
    /// Number of terms, technique and roulette.
    pub plan: Plan,
    /// N: the number of children of each vertex, at least 1.
    pub children: u32,
}

impl<T: Transport> TermEstimator<T> for Branching {
    fn slots(&self) -> usize {
        self.plan.max_bounces + 2
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        prefix::start(job, paths, sink);
        let mut below: Vec<Paths<T::Wave>> = (0..self.plan.max_bounces).map(|_| Paths::default()).collect();
        self.descend(job.t, 0, job.batch.key, paths, &mut below, sink);
    }
}

impl Branching {
    /// Follows every child of the paths at vertex v, and all their descendants. `below` has one wave per depth.
    fn descend<T: Transport>(
        &self,
        t: &T,
        v: usize,
        key: Key,
        parents: &mut Paths<T::Wave>,
        below: &mut [Paths<T::Wave>],
        sink: &mut impl TermSink,
    ) {
        // at vertex K all terms are scored, and the tail follows a single path
        let Some((child, below)) = below.split_first_mut() else {
            return prefix::follow(t, &self.plan, v, parents, sink);
        };
        if parents.n == 0 {
            return;
        }
        for c in 0..self.children {
            let key = lineage(key, v, c, self.children);
            child.descend_from(parents, 0..parents.n, key, 1.0 / self.children as f32);
            prefix::step(t, &self.plan, v, [v + 1; 2], child, sink);
            self.descend(t, v + 1, key, child, below, sink);
        }
    }
}

/// The random stream of child c of vertex v. The first child inherits its parent's stream; every other child has a new one.
pub(crate) fn lineage(key: Key, v: usize, c: u32, children: u32) -> Key {
    if c == 0 { key } else { key.branch((v as u32).wrapping_mul(children).wrapping_add(c)) }
}
