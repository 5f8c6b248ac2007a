//! Every claim of chapter 12 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::mirrors_and_glass::{
    Light, Measured, angles, caustic, choice, claims, critical, found, fresnel, furnace, measure, plate,
};
use fredholm::report::book::Folder;
use fredholm::zoo::{Mistake, find};

fn member(name: &str) -> &'static dyn Mistake {
    find(name).unwrap().mistake
}

/// Schlick's approximation from the angle in the first medium. It is close for a ray in air, and wrong inside glass.
fn schlick(n: f64, beyond: f64, theta: f64) -> f64 {
    let f = ((n - beyond) / (n + beyond)).powi(2);
    f + (1.0 - f) * (1.0 - theta.cos()).powi(5)
}

/// Measures one part again with a mistake.
type Again = fn(&Folder<'_>, &mut Measured);

/// Words of a claim, and a mistake that refutes this claim alone.
const MISTAKES: [(&str, Again); 10] = [
    ("F(θ)", |f, m| m.angles = angles(f, schlick).unwrap()),
    // the indices of the two sides have changed places
    ("critical angle", |_, m| m.critical = critical(true).unwrap()),
    // (1 − F)²: no reflection inside
    ("plate", |f, m| m.plate = plate(f, 2).unwrap()),
    ("white sky", |f, m| m.furnace[0] = furnace(f, member("eta-squared-once")).unwrap()[0]),
    ("white sky", |f, m| m.furnace[1] = furnace(f, member("total-reflection-dropped")).unwrap()[1]),
    // the probability of the choice is left out
    ("p = 1/2", |f, m| m.choice[1] = choice(f, "0.5", member("glass-without-choice")).unwrap()),
    // both with p = F
    ("p = 1/2", |_, m| m.choice[1] = m.choice[0]),
    ("large lamp", |f, m| m.caustic = caustic(f, member("no-emission-after-mirror")).unwrap()),
    // a light with area, which walks from the eye hit
    ("point light", |f, m| m.found[1] = found(f, Light::Disk(0.4)).unwrap()),
    // an estimator that also walks from the eye
    ("walks from the light", |_, m| m.found.iter_mut().for_each(|[_, light, both]| light.ball = both.ball.clone())),
];

#[test]
fn every_claim_of_chapter_12_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, fresnel).unwrap();
    let mutants = MISTAKES.map(|(words, again)| {
        let mut wrong = right.clone();
        again(&folder, &mut wrong);
        (words, wrong)
    });
    each_claim_fails_alone(&right, claims, mutants);
}
