//! How many bounces are enough, and which bounce lights what: against closed forms, the image, and the sum over all surfaces.
#![allow(clippy::unwrap_used)]

mod common;

use common::sampling::difference;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::progress::Progress;
use fredholm::scene::{Description, Scene, load};
use fredholm::study::bounces::{bounces, enough};
use fredholm::study::lit::{LAST, lit};
use fredholm::terms::Estimate;
use glam::DVec3;

fn scene(name: &str) -> (Description, Scene) {
    let options = load::Options { set: vec!["camera.size=[32,24]".into()], ..Default::default() };
    let description = load::scene(name, &options).unwrap().description;
    let scene = Scene::new(&description);
    (description, scene)
}

/// In the furnace T^k E = ρ^k E everywhere, with ρ = ½ in all channels: the remainder after K is exactly 2^−(K+1).
#[test]
fn the_furnace_needs_the_bounces_of_its_geometric_series() {
    let (_, scene) = scene("furnace");
    let found = bounces(&scene, 1 << 16, &Settings::default(), Progress::NONE).unwrap();
    for terms in [&found.picture, &found.surfaces] {
        for (part, from, exact) in [(0.1, 0, 3), (0.01, 0, 6), (0.0012, 0, 9), (0.1, 2, 5), (0.01, 2, 8)] {
            let k = enough(terms, from, part);
            assert_eq!((k.least, k.most), (Some(exact), Some(exact)), "{part} of the terms from k = {from}");
        }
    }
}

/// A pixel that is the whole picture has the mean of the image, whatever the shape of the image.
#[test]
fn the_strip_of_whole_pictures_has_the_means_of_the_image() {
    let mut account = common::open("the_strip_of_whole_pictures_has_the_means_of_the_image");
    let (_, scene) = scene("cornell");
    let settings = Settings { spp: 4096, seed: account.seed(), ..Settings::default() };
    let strip = bounces(&scene, 1 << 20, &settings, Progress::NONE).unwrap().picture;
    let image = by_rays::terms(&scene, Estimator::Prefix, &settings, Progress::NONE);
    // T0 is left out: its noise is the edge of the lamp, which random places in the picture meet far more than pixels do
    for k in 1..=3 {
        let apart = difference(&strip.estimate(k..k + 1), &image.series.image().terms[k]);
        let delta = 0.2 * image.series.image().terms[k].mean;
        account.assert_equivalent(&format!("T{k}"), &apart, DVec3::ZERO, delta);
    }
}

/// ⟨all surfaces, T^k E⟩ is the mean of ⟨S, T^k E⟩ over the surfaces S, weighted by their area. Two sets of paths.
#[test]
fn the_surfaces_add_up_to_the_norm_over_all_surfaces() {
    let mut account = common::open("the_surfaces_add_up_to_the_norm_over_all_surfaces");
    let (description, scene) = scene("cornell");
    let settings = Settings { seed: account.seed(), ..Settings::default() };
    let all = bounces(&scene, 1 << 20, &settings, Progress::NONE).unwrap().surfaces;
    let surfaces = lit(&description, &scene, 1 << 18, &settings, Progress::NONE);
    assert_eq!(surfaces.len(), 6);
    let area: f64 = surfaces.iter().map(|s| s.area).sum();
    for k in 1..=LAST {
        let each = surfaces.iter().map(|s| (s.area / area, s.terms.estimate(k..k + 1)));
        let (mean, variance) = each.fold((DVec3::ZERO, DVec3::ZERO), |(mean, variance), (w, e)| {
            (mean + w * e.mean, variance + (w * e.std_error).powf(2.0))
        });
        let sum = Estimate { mean, std_error: variance.powf(0.5), replicates: 64, events: None };
        let whole = all.estimate(k..k + 1);
        account.assert_equivalent(&format!("T{k}"), &difference(&sum, &whole), DVec3::ZERO, 0.1 * whole.mean);
    }
}

/// The first light of a surface: nothing reaches the ceiling directly, because the lamp shines down from it.
#[test]
fn the_ceiling_waits_for_the_second_bounce() {
    let (description, scene) = scene("cornell");
    let surfaces = lit(&description, &scene, 1 << 14, &Settings::default(), Progress::NONE);
    let ceiling = surfaces.iter().find(|s| s.name == "ceiling").unwrap().shares();
    let floor = surfaces.iter().find(|s| s.name == "floor").unwrap().shares();
    assert_eq!(ceiling[0], 0.0);
    assert!(ceiling[1] > 0.5 && floor[0] > 0.5);
    for shares in [ceiling, floor] {
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{shares:?}");
    }
}
