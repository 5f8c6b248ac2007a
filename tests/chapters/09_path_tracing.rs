//! Every claim of chapter 9 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::path_tracing::{BROKEN, LAST, Measured, Rules, claims, difference, measure, mistake, ratios, rays};
use fredholm::report::book::Folder;
use fredholm::zoo::Right;

#[test]
fn every_claim_of_chapter_9_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let rules = [Rules::CONNECT, Rules::MIS];
    let broken = BROKEN.map(|b| mistake(b.name).unwrap());
    let right = measure(&folder, rules, broken, "furnace").unwrap();

    // hits count after every vertex, although the connections have found the same light
    let twice = [Rules { hit: |_| 1.0, ..Rules::CONNECT }, Rules::MIS];
    let twice = Measured { difference: difference(&folder, twice).unwrap(), ..right.clone() };
    // own paths are one reflection too long
    let mut shifted = right.clone();
    shifted.means[1].rotate_left(1);
    // in an open room some paths leave
    let open = Measured { rays: rays(&folder, "cornell").unwrap(), ..right.clone() };
    // one rule is not broken
    let repaired = |i: usize| {
        let mut m = right.clone();
        m.ratios[i] = ratios(&folder, &BROKEN[i], &Right).unwrap();
        m
    };
    // the terms of one path are treated as independent
    let mut independent = right.clone();
    for noise in &mut independent.noise {
        let diagonal = |(j, row): (usize, &mut Vec<f64>)| (0..LAST).filter(|&k| k != j).for_each(|k| row[k] = 0.0);
        noise.covariance.iter_mut().enumerate().for_each(diagonal);
    }
    // a new path is traced for every term, and called one path
    let mut renewed = right.clone();
    renewed.noise.iter_mut().for_each(|noise| noise.path = noise.rays.iter().sum());
    // the rays to the vertices are not counted for one term alone: all of the path is charged to it
    let mut charged = right.clone();
    for noise in &mut charged.noise {
        noise.rays[..4].iter_mut().for_each(|rays| *rays = noise.path);
    }

    let mutants = [
        ("the loop gives every pixel", twice),
        ("the same means", shifted),
        ("in a closed room", open),
        ("counted twice", repaired(0)),
        ("left out at the eye", repaired(1)),
        ("left out after mirrors", repaired(2)),
        ("along a path", independent),
        ("for the sum", renewed),
        ("for one term alone", charged),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
