//! One scalar that is watched, and the events that carry it.

use crate::stats::sequential::MeanSequence;
use crate::stats::verdict::{EVENTS, Quantity};
use crate::terms::Functional;

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
    /// Σ m and Σ m²/events, from which the events behind the mean follow; of this functional, and of the image.
    pub(super) events: [[Events; 2]; 2],
    /// Error of a finished second side.
    pub(super) allowance: f64,
    /// Largest ln E_n so far where there were events enough.
    pub(super) evidence: f64,
}

/// `(Σ x)²/Σ x²` over all batches, from that of each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Events {
    known: bool,
    sum: f64,
    square: f64,
}

impl Events {
    fn push(&mut self, quantity: Quantity, f: &Functional) {
        let (Some(events), Some(e)) = (quantity.events(f), quantity.of(f)) else { return };
        let sum = e.mean.element_sum();
        self.known = true;
        self.sum += sum;
        self.square += if events > 0.0 { sum * sum / events } else { 0.0 };
    }

    fn count(&self) -> f64 {
        if self.square > 0.0 { self.sum * self.sum / self.square } else { 0.0 }
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
                self.events[s][0].push(self.quantity, &sides[s][self.at[s]]);
                self.events[s][1].push(self.quantity, &sides[s][0]);
            }
        }
    }

    /// Whether too few events carry one of the sides. What is dark everywhere is no rare event, and is judged.
    pub(super) fn few(&self) -> bool {
        let few = |[own, image]: &[Events; 2]| own.known && image.count() > 0.0 && own.count() < EVENTS;
        self.difference.std_error() > 0.0 && self.events.iter().any(few)
    }

    pub(super) fn is_image(&self) -> bool {
        self.at == [0, 0]
    }
}
