//! Chapter 10: its claims hold, and each of them fails if one ingredient is made wrong. Its exercises are judged rightly.

use crate::each_claim_fails_alone;
use crate::russian_roulette::{IN_FURNACE, Measured, claims, enumerate, in_furnace, measure, moments, weights};
use fredholm::report::book::Folder;
use fredholm::study::enumeration::End;
use glam::DVec3;

/// Σ P S of paths whose survivors are not divided by 1 − q: what is scored at vertex v then has the weight Q_v.
fn forgotten_division(ends: &[End]) -> Vec<DVec3> {
    let mut sum = vec![DVec3::ZERO; ends[0].scored.len()];
    for (n, end) in ends.iter().enumerate() {
        let reached: f64 = ends[n..].iter().map(|e| e.probability).sum();
        for (k, sum) in sum.iter_mut().enumerate() {
            let before = if n == 0 { DVec3::ZERO } else { ends[n - 1].scored[k] };
            *sum += (end.scored[k] - before) * reached * reached;
        }
    }
    sum
}

#[test]
fn every_claim_of_chapter_10_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder).unwrap();

    let unweighted = Measured { enumerated: enumerate(&folder, forgotten_division).unwrap(), ..right.clone() };
    // q is taken for the probability of survival
    let survival = IN_FURNACE.map(|q| in_furnace(&folder, 1.0 - q).unwrap()).to_vec();
    let survival = Measured { furnace: survival, ..right.clone() };
    let found = moments(&folder, |q| 1.0 - q).unwrap();
    let other_q = Measured { prices: found, ..right.clone() };
    // the weight in place of its square
    let not_squared = Measured { weights: weights(&folder, 1).unwrap(), ..right.clone() };
    // the exponent of a schedule with finite variance
    let mut light_tail = right.clone();
    light_tail.seen[2].exponent = right.seen[0].exponent;
    // an unbiased estimate is believed to be right in a typical image
    let mut typical = right.clone();
    typical.seen[2].medians.fill(right.seen[0].mean);
    // one schedule is believed to be best for everything
    let mut one_for_all = right.clone();
    one_for_all.prices.crossed.iter_mut().for_each(|x| x.value = 1.0);
    // term k is believed to have passed k tests
    let mut one_more = right.clone();
    one_more.wrong.iter_mut().for_each(|w| w.expected.rotate_left(1));

    let mutants = [
        ("no term of a path changes", unweighted),
        ("in the furnace", survival),
        ("moments without roulette", other_q),
        ("squared weight grows", not_squared),
        ("tail with exponent", light_tail),
        ("too dark", typical),
        ("best schedule", one_for_all),
        ("four wrong weights", one_more),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
