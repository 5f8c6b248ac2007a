//! Every choice that leaves `T^k E` alone, and an array of combinations that covers all pairs of choices.
//!
//! | factor | values |
//! |---|---|
//! | estimator | single, prefix, branching, light, bidirectional, path tracer |
//! | technique | scatter, connect, mis, mis-power |
//! | light selection | uniform, power |
//! | directions | uniform, cosine, bsdf |
//! | points | independent, Sobol |
//!
//! An error of one choice, or of two that do not go together, shows in some row of the array; only errors that need three
//! particular choices may hide from it, and those are for the full product. Greedy construction: each row is, of all
//! combinations, the one with the most pairs that no row has yet (Cohen, Dalal, Fredman, Patton, *The AETG System*, 1997).

use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::Technique;
use fredholm::math::Points;
use fredholm::scene::{Selection, bsdf::Sampling};
use std::{collections::BTreeSet, fmt};

/// `None` is the path tracer.
pub const ESTIMATORS: [Option<Estimator>; 6] = [
    Some(Estimator::Single),
    Some(Estimator::Prefix),
    Some(Estimator::Branching { children: 2 }),
    Some(Estimator::Light),
    Some(Estimator::Bidirectional),
    None,
];
const SELECTIONS: [Selection; 2] = [Selection::Uniform, Selection::Power];
const SAMPLINGS: [Sampling; 3] = [Sampling::Uniform, Sampling::Cosine, Sampling::Bsdf];
const POINTS: [Points; 2] = [Points::Independent, Points::Sobol];

const FACTORS: usize = 5;
const VALUES: [usize; FACTORS] =
    [ESTIMATORS.len(), Technique::ALL.len(), SELECTIONS.len(), SAMPLINGS.len(), POINTS.len()];

/// One way to estimate the terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combination {
    pub estimator: Option<Estimator>,
    pub technique: Technique,
    pub selection: Selection,
    pub sampling: Sampling,
    pub points: Points,
}

impl fmt::Display for Combination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let estimator = self.estimator.map_or("path".into(), |e| e.to_string());
        let sampling = format!("{:?}", self.sampling).to_lowercase();
        write!(f, "{estimator}, {}, lights {}, {sampling}, {}", self.technique, self.selection, self.points)
    }
}

type Row = [usize; FACTORS];

fn combination(row: Row) -> Combination {
    Combination {
        estimator: ESTIMATORS[row[0]],
        technique: Technique::ALL[row[1]],
        selection: SELECTIONS[row[2]],
        sampling: SAMPLINGS[row[3]],
        points: POINTS[row[4]],
    }
}

fn rows() -> Vec<Row> {
    let mut all = vec![[0; FACTORS]];
    for (factor, &values) in VALUES.iter().enumerate() {
        let spread = |row: &Row| {
            let row = *row;
            (0..values).map(move |value| {
                let mut next = row;
                next[factor] = value;
                next
            })
        };
        all = all.iter().flat_map(spread).collect();
    }
    all
}

/// ((factor, value), (factor, value)).
type Pair = ((usize, usize), (usize, usize));

fn pairs(row: &Row) -> impl Iterator<Item = Pair> + '_ {
    (0..FACTORS).flat_map(move |a| (a + 1..FACTORS).map(move |b| ((a, row[a]), (b, row[b]))))
}

/// The full product.
pub fn product() -> Vec<Combination> {
    rows().into_iter().map(combination).collect()
}

/// Few combinations with every pair of choices among them.
pub fn covering() -> Vec<Combination> {
    let all = rows();
    let mut missing: BTreeSet<Pair> = all.iter().flat_map(pairs).collect();
    let mut chosen = vec![];
    while !missing.is_empty() {
        let gain = |row: &Row| pairs(row).filter(|p| missing.contains(p)).count();
        // the first of the best, so that the array never changes
        let best = all.iter().rev().max_by_key(|row| gain(row)).copied().unwrap();
        missing.retain(|p| !pairs(&best).any(|q| q == *p));
        chosen.push(best);
    }
    assert_covers(&chosen);
    chosen.into_iter().map(combination).collect()
}

/// Counted anew, pair by pair.
fn assert_covers(chosen: &[Row]) {
    for a in 0..FACTORS {
        for b in a + 1..FACTORS {
            for (x, y) in (0..VALUES[a]).flat_map(|x| (0..VALUES[b]).map(move |y| (x, y))) {
                assert!(chosen.iter().any(|r| r[a] == x && r[b] == y), "no row has {x}, {y} of factors {a}, {b}");
            }
        }
    }
}
