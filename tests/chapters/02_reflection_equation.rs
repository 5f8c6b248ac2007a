//! Each claim of chapter 2 fails if one ingredient of its measurement is wrong.

use crate::each_claim_fails_alone;
use crate::reflection_equation::{Measured, claims, cones, distance, limit, measure, mirror_ball::capture, sphere};
use fredholm::report::book::Folder;
use fredholm::zoo::{self, Mistake, Right};

fn mistake(name: &str) -> &'static dyn Mistake {
    zoo::find(name).unwrap().mistake
}

#[test]
fn every_claim_fails_if_its_measurement_is_wrong() {
    let out = tempfile::tempdir().unwrap();
    let folder = Folder::new(out.path(), "test").unwrap().quick(true);
    let right = measure(&folder, &Right, f32::INFINITY).unwrap();

    let clipped = capture(&folder, 1.0).unwrap();
    let (mut by_distance, mut same_size, mut never_cut) = (right.clone(), right.clone(), right.clone());
    // a renderer that applies the inverse-square law to radiance
    by_distance.distance.iter_mut().for_each(|(d, l, _)| l.value /= *d * *d);
    // a large object that is lit as if all its points were where the mirror ball was
    same_size.captured.in_room[2].1 = right.captured.in_room[0].1.clone();
    never_cut.captured.under_clipped = right.captured.under.clone();

    let wrong: [(&str, Measured); 8] = [
        ("E = π L sin²α", Measured { cones: cones(&folder, mistake("no-receiver-cosine")).unwrap(), ..right.clone() }),
        (
            "E_point/E_disc",
            Measured { limit: limit(&folder, mistake("disk-light-without-root")).unwrap(), ..right.clone() },
        ),
        ("radiance of the lamp", by_distance),
        (
            "irradiance falls",
            Measured { distance: distance(&folder, mistake("no-inverse-square")).unwrap(), ..right.clone() },
        ),
        ("Pharr's sphere", Measured { sphere: sphere(&folder, mistake("half-bounce")).unwrap(), ..right.clone() }),
        ("radius 5 cm", Measured { captured: clipped, ..right.clone() }),
        ("radius 30 cm", same_size),
        ("cuts radiance", never_cut),
    ];
    each_claim_fails_alone(&right, claims, wrong);
}
