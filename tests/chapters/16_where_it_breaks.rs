//! Every claim of chapter 16 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::where_it_breaks::{Ingredients, Measured, claims, measure};
use crate::where_it_breaks::{caustic, corner, dimension, mirrors, own_equation, polarisation, rare};
use fredholm::math::Points;
use fredholm::report::book::Folder;

/// The mean over both polarisations of a reflection, without the difference that makes light polarised.
fn unpolarised(r: [f64; 2]) -> polarisation::Mueller {
    let mut m = polarisation::reflection(r);
    (m[0][1], m[1][0]) = (0.0, 0.0);
    m
}

#[test]
fn every_claim_of_chapter_16_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, &Ingredients::RIGHT).unwrap();

    // all passes repeat the same random numbers, so that more samples bring nothing new
    let mut flat = right.clone();
    for curve in &mut flat.dimension.independent {
        let noise = curve.points.last().unwrap().1.clone();
        curve.points.iter_mut().for_each(|(_, s)| *s = noise.clone());
    }
    // independent numbers under the name of Sobol points
    let points = dimension::noise(&folder, Points::Independent).unwrap();
    let mut same_points = right.clone();
    same_points.dimension.even = points;
    // an interval of one standard error, called 95 %
    let narrow = Measured { rare: rare::runs(&folder, 1.0).unwrap(), ..right.clone() };
    // the expected number of events pN, taken for the probability of at least one
    let mut linear = right.clone();
    linear.rare.iter_mut().for_each(|row| row.predicted = (1.0 - f64::from(row.expected)).max(0.0));
    // the techniques are swapped: connections where MIS is meant, and a tail of MIS
    let swapped = corner::corner(&folder, [corner::both, corner::connect]).unwrap();
    let mut no_mis = right.clone();
    no_mis.corner.places.iter_mut().zip(&swapped.places).for_each(|(place, other)| place.square[1] = other.square[1]);
    let mut bounded = right.clone();
    bounded.corner.tail = swapped.tail;
    // a lamp with an area is found
    let disk = Measured { caustic: caustic::caustic(&folder, caustic::Lamp::Disk).unwrap(), ..right.clone() };
    // real mirrors keep 99 %
    let real = Measured { mirrors: mirrors::mirrors(&folder, 0.99).unwrap(), ..right.clone() };
    // no polarisation
    let theta = polarisation::brewster(1.5);
    let scalar = Measured { brewster: polarisation::twice(1.5, theta, unpolarised), ..right.clone() };
    // the right room
    let no_mistake = Measured { own: own_equation::own_equation(&folder, 1.0).unwrap(), ..right.clone() };

    let mutants = [
        ("with independent samples", flat),
        ("Sobol points", same_points),
        ("samples miss an event", narrow),
        ("samples miss an event", linear),
        ("connections to a lamp", no_mis),
        ("tail index", bounded),
        ("paths from the eye", disk),
        ("between mirrors", real),
        ("two reflections", scalar),
        ("its own equation", no_mistake),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
