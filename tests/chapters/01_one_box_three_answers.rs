//! Every claim of chapter 1 holds, and each of them fails if one result is made wrong.

use crate::one_box_three_answers::{Measured, claims, measure};
use fredholm::report::book::Folder;
use fredholm::terms::Estimate;
use std::f64::consts::PI;

/// Words of a claim, and a change of the results that refutes it and no other claim.
type Mutation = (&'static str, fn(&mut Measured));

const MUTATIONS: [Mutation; 8] = [
    // an eighth more light in the path tracer: the size of a forgotten shadow test
    ("path tracer's image", |m| {
        let path = m.run.path.as_mut().unwrap();
        path.series.functionals.iter_mut().for_each(|f| scale(&mut f.total, 1.12));
    }),
    // twenty times the error, the size of 400 times fewer samples: nothing is proved
    ("the term k = 2 agrees", |m| {
        let matrix = &mut m.run.radiosity.as_mut().unwrap().fine;
        matrix.series.functionals.iter_mut().for_each(|f| f.terms[2].std_error *= 20.0);
    }),
    ("the whole image agrees", |m| {
        let matrix = &mut m.run.radiosity.as_mut().unwrap().fine;
        matrix.series.functionals.iter_mut().for_each(|f| f.total.std_error *= 20.0);
    }),
    // T³E of the matrix with form factors a tenth too large, on both meshes
    ("differs significantly", |m| {
        let matrix = m.run.radiosity.as_mut().unwrap();
        for mesh in [&mut matrix.fine, &mut matrix.coarse] {
            mesh.series.functionals.iter_mut().for_each(|f| scale(&mut f.terms[3], 1.1f64.powi(3)));
        }
    }),
    // 1/π is forgotten in the BSDF: every reflection is π times too strong
    ("no term exceeds", |m| {
        let norms = &mut m.run.surface[0].1;
        let last = norms.mean.len() - 2;
        (1..=last).for_each(|k| norms.mean[k] *= PI.powi(k as i32));
    }),
    // the survivors of roulette are weighted too strongly
    ("the tail does not exceed", |m| {
        let norms = &mut m.run.surface[0].1;
        let tail = norms.mean.len() - 1;
        norms.mean[tail] *= 4.0;
    }),
    // k is too small by one
    ("lights the ceiling", |m| {
        m.run.terms[0].terms.remove(0);
    }),
    // the tail of a darker room, ten times smaller in every answer
    ("a hundredth", |m| {
        let matrix = m.run.radiosity.as_mut().unwrap();
        for answer in [&mut m.run.terms[0], &mut matrix.fine, &mut matrix.coarse] {
            answer.series.functionals.iter_mut().for_each(|f| scale(&mut f.tail, 0.1));
        }
    }),
];

fn scale(estimate: &mut Estimate, factor: f64) {
    estimate.mean *= factor;
    estimate.std_error *= factor;
}

#[test]
fn every_claim_of_chapter_1_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let mut m = measure(&folder).unwrap();
    let right = claims(&m).unwrap();
    right.iter().for_each(|c| assert!(c.holds, "{}: {}", c.says, c.found));
    for c in &right {
        assert_eq!(MUTATIONS.iter().filter(|(words, _)| c.says.contains(words)).count(), 1, "{}", c.says);
    }
    for (words, make_wrong) in MUTATIONS {
        let (terms, path, norms) = (m.run.terms.clone(), m.run.path.clone(), m.run.surface.clone());
        let meshes = m.run.radiosity.as_ref().map(|matrix| (matrix.fine.clone(), matrix.coarse.clone())).unwrap();
        make_wrong(&mut m);
        for c in claims(&m).unwrap() {
            assert_eq!(c.holds, !c.says.contains(words), "`{words}` made wrong: {}: {}", c.says, c.found);
        }
        (m.run.terms, m.run.path, m.run.surface) = (terms, path, norms);
        let matrix = m.run.radiosity.as_mut().unwrap();
        (matrix.fine, matrix.coarse) = meshes;
    }
}
