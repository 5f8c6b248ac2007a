//! Each claim of chapter 3 fails if one ingredient of its measurement is wrong.

use crate::choosing_directions::mistakes::{member, with};
use crate::choosing_directions::{Measured, claims, measure, right, samples, spreads};
use crate::each_claim_fails_alone;
use fredholm::report::book::Folder;
use fredholm::scene::bsdf::Sampling;
use fredholm::zoo::Right;
use std::f32::consts::TAU;

#[test]
fn every_claim_fails_if_its_measurement_is_wrong() {
    let out = tempfile::tempdir().unwrap();
    let folder = Folder::new(out.path(), "test").unwrap().quick(true);
    let correct = measure(&folder, right).unwrap();

    // the density of the whole sphere for directions that are uniform over the hemisphere: the constant 2 is missing
    let half = spreads(&folder, |f, cos, p| f * (cos / if p == 1.0 / TAU { 2.0 * p } else { p })).unwrap();
    let cosine_twice = spreads(&folder, |f, cos, p| f * (cos * cos / p)).unwrap();
    let no_cosine = spreads(&folder, |f, _, p| f * (1.0 / p)).unwrap();
    let (mut twice, mut missing, mut no_lobe, mut uniform) =
        (correct.clone(), correct.clone(), correct.clone(), correct.clone());
    twice.spreads[0][1].variance = cosine_twice[0][1].variance;
    missing.spreads[0][0].variance = no_cosine[0][0].variance;
    // a sampler of the glossy surface that falls back to the cosine, and a cosine sampler that is uniform
    no_lobe.spreads[3][2].variance = correct.spreads[3][1].variance;
    uniform.spreads[1][1].variance = correct.spreads[1][0].variance;
    let mut heavy = correct.clone();
    heavy.weights[0] = samples(&folder, 0, Sampling::Uniform, |f, _, p| f * (1.0 / p)).unwrap();
    let (mut cosine, mut lamp) = (correct.clone(), correct.clone());
    cosine.wrong[0] = with(&folder, &Right, 0).unwrap();
    lamp.wrong[2] = with(&folder, member("malley-without-root").unwrap(), 1).unwrap();

    let wrong: [(&str, Measured); 8] = [
        ("same mean", Measured { spreads: half, ..correct.clone() }),
        ("no variance", twice),
        ("V = 1/3", missing),
        ("half of the weights", heavy),
        ("glossy surface", no_lobe),
        ("small lamp on a matt surface", uniform),
        ("4/3", cosine),
        ("uniform directions weighted as cosine ones", lamp),
    ];
    each_claim_fails_alone(&correct, claims, wrong);
}
