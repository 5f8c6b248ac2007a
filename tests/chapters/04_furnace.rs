//! Chapter 4: its claims hold, and each of them fails with a mistake that it is about.

use crate::each_claim_fails_alone;
use crate::furnace::{FURNACES, Measured, balance, claims, compare, furnaces, glass, measure, sphere};
use fredholm::estimator::Technique;
use fredholm::report::book::Folder;
use fredholm::zoo::{Mistake, Right, Stage, find};

/// Paths end after K reflections, and the result is taken for the whole light.
struct Cut;
impl Mistake for Cut {
    fn slot(&self, k: usize, max_bounces: usize) -> Option<usize> {
        (k <= max_bounces).then_some(k)
    }
}

fn member(name: &str) -> &'static dyn Mistake {
    find(name).unwrap().mistake
}

/// Measures one part again with a mistake.
type Again = fn(&Folder<'_>, &mut Measured);

/// Words of a claim, and a mistake that refutes this claim alone.
const MISTAKES: [(&str, Again); 9] = [
    ("L = 1/(1 − ρ)", |f, m| m.furnaces = furnaces(f, &Cut).unwrap()),
    ("TᵏE = ρᵏ", |f, m| m.furnaces = furnaces(f, member("off-by-one")).unwrap()),
    ("glass ball", |f, m| m.glass = glass(f, member("glass-without-choice")).unwrap()),
    ("integrating sphere", |f, m| m.sphere = sphere(f, member("missing-pi-connection")).unwrap()),
    // a mistake that the furnace does see, in place of the one that it does not see
    ("passes the furnace", |f, m| m.compared[0].wrong[0] = furnace(f, member("cosine-as-uniform"))),
    ("fails in the Cornell box", |f, m| {
        let right = compare(f, Stage::CORNELL, Technique::Connect, [&Right, &Right]).unwrap();
        m.compared[1].wrong[0] = right.wrong[0].clone();
    }),
    ("fails in the furnace", |f, m| m.compared[0].wrong[1] = furnace(f, &Right)),
    // a step that weighs too much, and an equation that was not made wrong
    ("L = E + T L", |f, m| m.balance[0] = balance(f, 1.03).unwrap()),
    ("L = E + T L", |f, m| m.balance[1] = balance(f, 1.0).unwrap()),
];

fn furnace(f: &Folder<'_>, step: &dyn Mistake) -> (Vec<fredholm::zoo::signature::Ratio>, Vec<[f32; 3]>) {
    let [first, _] = compare(f, FURNACES[0].1, Technique::Scatter, [step, &Right]).unwrap().wrong;
    first
}

#[test]
fn every_claim_holds_and_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder).unwrap();
    let mutants = MISTAKES.map(|(words, again)| {
        let mut wrong = right.clone();
        again(&folder, &mut wrong);
        (words, wrong)
    });
    each_claim_fails_alone(&right, claims, mutants);
}
