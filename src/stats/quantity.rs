//! The quantities of two results that are compared: every term T^k E, the tail, their sum, and the whole.

use crate::terms::{Doubt, Estimate, Functional};

/// The quantities of a functional that are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::stats) enum Quantity {
    Term(usize),
    Tail,
    Sum,
    Total,
}

impl Quantity {
    pub(in crate::stats) fn of(self, f: &Functional) -> Option<Estimate> {
        match self {
            Self::Term(k) => f.terms.get(k).copied(),
            Self::Tail => Some(f.tail),
            Self::Sum => Some(f.sum),
            Self::Total => Some(f.total),
        }
    }

    /// Returns true if a doubt affects this quantity.
    pub(in crate::stats) fn concerned(self, doubt: &Doubt) -> bool {
        if let Self::Term(k) = self { doubt.from <= k } else { true }
    }

    /// Returns true if this is a sum that contains `part`.
    pub(in crate::stats) fn contains(self, part: Self) -> bool {
        match self {
            Self::Term(_) | Self::Tail => false,
            Self::Sum => matches!(part, Self::Term(_)),
            Self::Total => matches!(part, Self::Term(_) | Self::Tail),
        }
    }

    pub(in crate::stats) fn name(self) -> String {
        match self {
            Self::Term(k) => format!("T{k}"),
            Self::Tail => "tail".into(),
            Self::Sum => "sum".into(),
            Self::Total => "total".into(),
        }
    }
}

pub(super) fn shared_quantities(a: &Functional, b: &Functional) -> Vec<Quantity> {
    let mut all: Vec<_> = (0..a.terms.len().min(b.terms.len())).map(Quantity::Term).collect();
    let cut = [a.tail.is_none(), b.tail.is_none()];
    if !all.is_empty() && a.terms.len() == b.terms.len() {
        all.extend((cut == [false; 2]).then_some(Quantity::Tail));
        all.push(Quantity::Sum);
    }
    all.extend((cut[0] == cut[1]).then_some(Quantity::Total));
    all
}
