//! One scalar that is watched, and what it rests on.

use crate::stats::evidence::{Evidence, Reason};
use crate::stats::sequential::MeanSequence;
use crate::stats::verdict::Quantity;
use crate::terms::{Events, Functional};

/// One scalar that is watched.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) quantity: Quantity,
    /// Which functional of both lists.
    pub(super) at: [usize; 2],
    pub(super) name: String,
    pub(super) channel: usize,
    /// α_φ, what is left of it for the batches.
    pub(super) level: f64,
    pub(super) difference: MeanSequence,
    /// The value on both sides.
    pub(super) values: [MeanSequence; 2],
    /// What both sides rest on.
    pub(super) events: [Counted; 2],
    /// Error of a finished second side.
    pub(super) allowance: f64,
    /// Largest ln E_n so far where the evidence carries a verdict.
    pub(super) evidence: f64,
}

/// The events of all batches, from those of each: Σ x, Σ x² and Σ x⁴ add up.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counted {
    known: bool,
    sum: f64,
    square: f64,
    fourth: f64,
    /// k̂ of one batch is noisy, its mean over batches is not.
    tail: MeanSequence,
}

impl Counted {
    fn push(&mut self, quantity: Quantity, f: &Functional) {
        let Some((e, Some(events))) = quantity.of(f).map(|e| (e, e.events)) else { return };
        let sum = e.mean.element_sum();
        self.known = true;
        self.sum += sum;
        let per = |a: f64, n: f64| if n > 0.0 { a * a / n } else { 0.0 };
        let square = per(sum, events.mean);
        self.square += square;
        self.fourth += per(square, events.variance);
        self.tail.push(events.tail);
    }

    fn events(&self) -> Option<Events> {
        let ratio = |a: f64, b: f64| if b > 0.0 { a * a / b } else { 0.0 };
        let found = Events {
            mean: ratio(self.sum, self.square),
            variance: ratio(self.square, self.fourth),
            tail: self.tail.mean(),
        };
        self.known.then_some(found)
    }
}

impl Track {
    pub(super) fn push(&mut self, sides: [&[Functional]; 2], finished: bool) {
        let value = |s: usize| self.quantity.of(&sides[s][self.at[s]]).map_or(f64::NAN, |e| e.mean[self.channel]);
        let values = [value(0), value(1)];
        self.difference.push(values[0] - values[1]);
        for s in 0..2 {
            self.values[s].push(values[s]);
            // of a finished result the events have been counted once and for all
            if s == 0 || !finished || self.difference.count() == 1 {
                self.events[s].push(self.quantity, &sides[s][self.at[s]]);
            }
        }
    }

    /// Why nothing may be rejected.
    pub(super) fn weak(&self) -> Option<Reason> {
        self.events.iter().filter_map(Counted::events).find_map(|e| Evidence::of_events(e).no_verdict)
    }

    pub(super) fn is_image(&self) -> bool {
        self.at == [0, 0]
    }
}
