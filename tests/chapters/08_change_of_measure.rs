//! Every claim of chapter 8 holds, and each of them fails if one ingredient is made wrong.

use crate::change_of_measure::{Measured, claims, direct, measure, scene, solid_angle_per_area, wall::wall};
use crate::each_claim_fails_alone;
use fredholm::engine::by_rays::Sampled;
use fredholm::estimator::Technique;
use fredholm::report::book::Folder;
use fredholm::zoo::{self, Mistake};

fn mistake(name: &str) -> &'static dyn Mistake {
    zoo::find(name).unwrap().mistake
}

#[test]
fn every_claim_of_chapter_8_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, solid_angle_per_area, mistake("area-density")).unwrap();
    let pixels = |image: &Sampled| f64::from(image.terms[1].mean.len() as u32).sqrt() as u32;
    let connected = |name: &str, like: &Sampled, scale: f64, wrong: &str| {
        let scene = scene(name, pixels(like), scale).unwrap();
        direct(&folder, &scene, Technique::Connect, mistake(wrong), like.spp)
    };
    let at_scales = |wrong: &str, column: usize| {
        let replaced = right.scales.iter().zip([0.1, 1.0, 10.0]).map(|(right, s)| {
            let mut pair = right.clone();
            pair[column] = connected("cornell", &right[column], s, wrong);
            pair
        });
        replaced.collect()
    };
    // next to the lamp, a forgotten cosine also makes the mean square wrong, so that the right place is kept there
    let mut without_cosine = wall(&folder, |_, d2| 1.0 / d2).unwrap();
    without_cosine.pop();
    without_cosine.extend(right.wall.last().cloned());
    let mut only_directions = right.wall.clone();
    only_directions.iter_mut().for_each(|p| p.by[0] = p.by[1].clone());
    let [scattered, connected_right, blind] = right.room.clone();
    let [uniform, power] = right.lamps.clone();

    let mutants: Vec<(&str, Measured)> = vec![
        // the cosine at the lamp is forgotten
        ("closed form", Measured { wall: without_cosine, ..right.clone() }),
        // directions are sampled where points on the lamp should be
        ("mean square", Measured { wall: only_directions, ..right.clone() }),
        // the shadow test is forgotten
        ("directions and connections", Measured { room: [scattered, blind.clone(), blind.clone()], ..right.clone() }),
        // both images are made by connections
        ("500 times", Measured { room: [connected_right.clone(), connected_right, blind], ..right.clone() }),
        ("radiance is the same", Measured { scales: at_scales("no-inverse-square", 0), ..right.clone() }),
        // this mistake has the right units, so that the scale does not reveal it
        ("square of the scale", Measured { scales: at_scales("no-light-cosine", 1), ..right.clone() }),
        (
            "same light as uniform",
            Measured { lamps: [connected("many-lights", &uniform, 1.0, "wrong-light-choice"), power], ..right.clone() },
        ),
        ("1.5 times", Measured { lamps: [uniform.clone(), uniform], ..right.clone() }),
    ];

    each_claim_fails_alone(&right, claims, mutants);
}
