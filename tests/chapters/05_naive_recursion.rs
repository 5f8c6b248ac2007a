//! Chapter 5: its claims hold, and each of them fails if the result is wrong in the way that it is about.

use crate::each_claim_fails_alone;
use crate::naive_recursion::{CHILDREN, K, Measured, claims, measure, recursion};
use fredholm::report::book::Folder;

/// A change to the result, with words of the one claim that it must refute.
type Mistake = (&'static str, fn(&mut Measured));

fn right() -> Measured {
    let place = tempfile::tempdir().unwrap();
    measure(&Folder::new(place.path(), "test").unwrap().quick(true), |n| 1.0 / n as f32).unwrap()
}

const MISTAKES: [Mistake; 7] = [
    // the camera ray is counted as depth 1
    ("exactly Nᵏ rays", |m| m.counted.iter_mut().for_each(|rays| rays.rotate_right(1))),
    // the sum of the N rays is not divided by N
    ("right mean", |m| {
        let wrong = |n: u32| recursion("sphere", 16_384 / (n * n), 0, n, 1.0).unwrap().1;
        m.sphere = CHILDREN.map(wrong).to_vec();
    }),
    // the reflectance is left out of the bounces, so that no term is darker than direct light
    ("most rays go to k = 4", |m| m.trees.iter_mut().for_each(|t| t.mean[K] = t.mean[1])),
    // all N^K rays of a tree are taken for independent samples of the sum
    ("all terms in one tree", |m| {
        let one = m.trees[0].variance[K + 1];
        m.trees.iter_mut().zip(CHILDREN).for_each(|(t, n)| t.variance[K + 1] = one.map(|v| v / f64::from(n).powi(4)));
    }),
    // the same for each term: its N^k rays are taken for independent samples
    ("k = 2, 3, 4 alone", |m| {
        let one = m.trees[0].variance.clone();
        let wrong = |k: usize, n: u32| one[k].map(|v| v / f64::from(n).powi(k as i32));
        m.trees.iter_mut().zip(CHILDREN).for_each(|(t, n)| (2..=K).for_each(|k| t.variance[k] = wrong(k, n)));
    }),
    // all rays of a hit use the same random numbers, so that more of them do not help
    ("small pixels", |m| {
        let one = m.direct[0][0].variance.clone();
        m.direct[0].iter_mut().for_each(|t| t.variance.clone_from(&one));
    }),
    // every ray of a hit starts at a new point of the pixel, so that all of the variance falls as 1/N
    ("large pixels", |m| {
        let one = m.direct[1][0].variance[1];
        m.direct[1].iter_mut().zip(CHILDREN).for_each(|(t, n)| t.variance[1] = one.map(|v| v / f64::from(n)));
    }),
];

#[test]
fn every_claim_holds_and_can_fail() {
    let right = right();
    let mutants = MISTAKES.map(|(words, mistake)| {
        let mut wrong = right.clone();
        mistake(&mut wrong);
        (words, wrong)
    });
    each_claim_fails_alone(&right, claims, mutants);
}
