//! The prefix estimator with separate slots for each vertex, as the [cross moments](crate::terms::cross_moments) need them.
//!
//! ```text
//! slot 2v        the hit at vertex v,           v = 0..=K        scores term v
//! slot 2v + 1    the connection at vertex v,    v = 0..K         scores term v + 1
//! slot 2K + 1    the tail: the connection at vertex K and all that follows
//! ```
//!
//! So slot a belongs to vertex ⌊a/2⌋ and scores term ⌈a/2⌉. The estimator reads the same random numbers as
//! [`Prefix`](super::Prefix): the hit and the connection of one term add up to that term of `Prefix`, up to rounding.
//!
//! The rays of a slot are those requested once its vertex is reached. The ray that leads to a vertex counts at that vertex,
//! because the path has already survived roulette when this ray is traced.

use super::{Job, Paths, Plan, TermEstimator, TermSink, prefix};
use crate::operator::{Sensor, Transport};

/// The prefix estimator with slots by vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Vertices(pub Plan);

impl Vertices {
    /// Number of slots for terms up to K.
    pub fn slots_for(max_bounces: usize) -> usize {
        2 * max_bounces + 2
    }

    /// The vertex that a path must reach to score a slot.
    pub fn vertex(slot: usize) -> usize {
        slot / 2
    }

    /// The term that a slot scores; K + 1 for the tail.
    pub fn term(slot: usize) -> usize {
        slot.div_ceil(2)
    }
}

impl<T: Transport> TermEstimator<T> for Vertices {
    fn slots(&self) -> usize {
        Self::slots_for(self.0.max_bounces)
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let Plan { max_bounces, ref roulette, .. } = self.0;
        let tail = 2 * max_bounces + 1;
        prefix::start(job, paths, sink);
        for v in 0.. {
            if paths.n == 0 || v >= max_bounces && !roulette.ends() {
                break;
            }
            let slots = [2 * v + 1, 2 * v + 2].map(|slot| slot.min(tail));
            prefix::step(job.t, &self.0, v, slots, paths, sink);
        }
    }
}
