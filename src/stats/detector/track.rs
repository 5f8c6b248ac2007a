//! One scalar that is compared batch by batch, and the events behind it.

use crate::stats::evidence::{Evidence, Reason};
use crate::stats::quantity::Quantity;
use crate::stats::sequential::MeanSequence;
use crate::terms::{Events, Functional};

/// One scalar (quantity, functional, channel) that is compared batch by batch.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) quantity: Quantity,
    /// Index of the functional in the list of each side.
    pub(super) at: [usize; 2],
    pub(super) name: String,
    pub(super) channel: usize,
    /// The part of α_φ that is left for the batches.
    pub(super) level: f64,
    pub(super) difference: MeanSequence,
    /// The value on each side.
    pub(super) values: [MeanSequence; 2],
    /// The events behind each side.
    pub(super) events: [Counted; 2],
    /// Error of a finished second side.
    pub(super) allowance: f64,
    /// Largest ln E_n so far, over the batches at which the evidence allowed a verdict.
    pub(super) evidence: f64,
}

/// The events of all batches together, from those of each batch: Σ x, Σ x² and Σ x⁴ are added.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counted {
    known: bool,
    sum: f64,
    square: f64,
    fourth: f64,
    /// k̂ of one batch is noisy; its mean over batches is not.
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
            // the events of a finished result are counted only once
            if s == 0 || !finished || self.difference.count() == 1 {
                self.events[s].push(self.quantity, &sides[s][self.at[s]]);
            }
        }
    }

    /// Reason why nothing may be rejected.
    pub(super) fn weak(&self) -> Option<Reason> {
        self.events.iter().filter_map(Counted::events).find_map(|e| Evidence::of_events(e).no_verdict)
    }

    pub(super) fn is_image(&self) -> bool {
        self.at == [0, 0]
    }
}
