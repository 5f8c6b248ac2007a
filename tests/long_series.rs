//! Series of a thousand terms and more: results with honest error bars, or none; light that escapes from where nothing absorbs.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::scenes::{bands, description, room, sphere};
use fredholm::engine::Settings;
use fredholm::engine::batches::Side;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::engine::known::growth::{FromEye, growth, proved};
use fredholm::engine::known::resort::with_last_resort;
use fredholm::engine::passes::Watch;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{PathTracer, Plan, Prefix, Roulette, Technique, TermEstimator};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::progress::Progress;
use fredholm::scene::{Scene, bsdf::Sampling};
use fredholm::stats::evidence::Reason;
use fredholm::stats::{Criterion, Detector, Outcome, compare};
use fredholm::study::convergence::{NoiseCurve, Recorder};
use fredholm::study::equilibrium::{self, Origin, judge};
use fredholm::study::roulette::beyond;
use fredholm::terms::functional::image_replicates;
use fredholm::terms::{Estimate, Variance};
use glam::DVec3;

const K: usize = 4;

/// Inside of a sphere of one albedo in which everything shines: L = 1/(1 − ρ).
fn furnace(rho: f64) -> Scene {
    Scene::new(&description(&[(sphere(DVec3::ZERO, 1.0, true), DVec3::splat(rho), DVec3::ONE)]))
}

/// The whole and its error from 16384 paths in 256 replicates.
fn whole<'a>(scene: &'a Scene, estimator: &impl TermEstimator<SceneTransport<'a>>, seed: u64) -> Estimate {
    let amount = Amount { spp: 256, replicates: 256, key: Key::new(seed, "long") };
    let t = SceneTransport::new(scene);
    let film = render(&t, &scene.camera, estimator, amount, Progress::NONE);
    let r = image_replicates(&film);
    r.estimate(0..r.mean.len())
}

fn plan(roulette: Roulette) -> Plan {
    Plan { max_bounces: K, technique: Technique::Mis, roulette }
}

/// Albedo 0.999: a result that was 45 % too dark, with an error bar of 9 %.
#[test]
fn a_thousand_bounces_have_their_closed_form() {
    let mut account = common::open("a_thousand_bounces_have_their_closed_form");
    let scene = furnace(0.999);
    let truth = DVec3::splat(1.0 / (1.0 - f64::from(0.999f32)));
    let terms = whole(&scene, &Prefix(plan(Roulette::Albedo { from: K })), account.seed());
    let path = whole(&scene, &PathTracer(plan(Roulette::Albedo { from: 2 })), account.seed() ^ 1);
    for (what, e) in [("terms", terms), ("path", path)] {
        account.assert_equivalent(what, &e, truth, 0.08 * truth);
    }
}

/// Nothing absorbs, and a twentieth of the sphere is open: L = 20, with and without the last resort of the scene.
#[test]
fn albedo_one_with_a_hole_has_its_closed_form() {
    let mut account = common::open("albedo_one_with_a_hole_has_its_closed_form");
    let make = || Scene::new(&description(&bands(1.0, &[0.9, -1.0], &[1.0], &[1.0])));
    let open = with_last_resort(make());
    assert!(open.last_resort().is_some_and(|(_, q)| q > 0.005 && q < 0.0125), "{:?}", open.last_resort());
    for (i, scene) in [make(), open].iter().enumerate() {
        assert!(proved(scene, Sampling::Bsdf, &Roulette::Albedo { from: 2 }));
        let seed = account.seed() ^ i as u64;
        let terms = whole(scene, &Prefix(plan(Roulette::Albedo { from: K })), seed);
        let path = whole(scene, &PathTracer(plan(Roulette::Albedo { from: 2 })), seed ^ 2);
        for (what, e) in [("terms", terms), ("path", path)] {
            account.assert_equivalent(what, &e, DVec3::splat(20.0), DVec3::splat(1.6));
        }
        // the schedules that are compared with each other go on with a q that keeps the variance finite
        assert!(beyond(scene) > 0.005 && beyond(scene) < 0.0125, "{}", beyond(scene));
    }
}

/// In a furnace second moments grow by ρ²/(1 − q), whatever the path; where directions are uniform by 4/3 of that, in the mean.
#[test]
fn the_growth_of_second_moments_is_that_of_the_furnace() {
    let of = |scene: &Scene, sampling, roulette: &Roulette| {
        let t = SceneTransport { scene, sampling };
        let q = |v: usize, throughput, at: &fredholm::scene::Vertex| roulette.q(&t, v, throughput, at);
        growth(&FromEye { t: &t, sensor: &scene.camera, q }, 2, 2, 0)
    };
    for (rho, q, variance) in [
        (0.999, 0.5, Variance::Infinite),
        (0.8, 0.5, Variance::Infinite),
        (0.6, 0.5, Variance::Finite),
        (0.999, 1.0 / 64.0, Variance::Infinite),
    ] {
        let scene = furnace(rho);
        let g = of(&scene, Sampling::Bsdf, &Roulette::Constant { from: 2, q });
        assert!((g.rate - rho * rho / (1.0 - q)).abs() < 1e-4, "{rho} {q}: {g:?}");
        assert_eq!(g.variance(), variance, "{rho} {q}");
        assert_eq!(proved(&scene, Sampling::Bsdf, &Roulette::Constant { from: 2, q }), variance == Variance::Finite);
    }
    let albedo = Roulette::Albedo { from: 2 };
    for (rho, variance) in [(0.9, Variance::Infinite), (0.6, Variance::Finite)] {
        let scene = furnace(rho);
        let g = of(&scene, Sampling::Uniform, &albedo);
        assert!((g.rate - 4.0 / 3.0 * rho).abs() < 0.05 * rho, "{rho}: {g:?}");
        assert_eq!(g.variance(), variance);
        assert!(!proved(&scene, Sampling::Uniform, &albedo));
        // analog survival: no weight ever grows
        assert_eq!(of(&scene, Sampling::Bsdf, &albedo).variance(), Variance::Finite);
    }
}

/// No number stands beside a mean whose variance is infinite, and no verdict rests on it; its terms keep theirs.
#[test]
fn infinite_variance_is_said_in_place_of_an_error() {
    let scene = furnace(0.999);
    let settings = Settings { spp: 32, max_bounces: K, ..Settings::default() };
    let lecture = Settings { roulette: Roulette::LECTURE, path_roulette: Roulette::LECTURE, ..settings.clone() };
    let short = by_rays::terms(&scene, Estimator::Prefix, &lecture, Progress::NONE);
    let path = by_rays::path(&scene, &lecture, Progress::NONE);
    for s in [&short, &path] {
        assert_eq!(s.series.variance, Variance::Infinite);
        let image = s.series.image();
        assert_eq!(image.total.std_error, DVec3::INFINITY);
        assert!(image.terms.iter().all(|t| t.std_error.is_finite()));
        assert!(s.total.std_error.iter().all(|e| e[0] == f32::INFINITY));
        assert!(s.doubt.unwrap().doubt().unwrap().starts_with("has infinite variance"));
    }
    let compared = compare(&short.series, &path.series, &Criterion::default(), &[]);
    let row = compared.rows.iter().find(|r| r.name == "total").unwrap();
    assert_eq!(row.outcome, Outcome::Inconclusive);
    assert!(row.reason.as_deref().unwrap().contains("infinite"), "{row:?}");
    // the same where batches are watched,
    let side = Side { estimator: None, settings: lecture.clone() };
    let mut watched = Detector::new(Criterion::default()).doubting(&side.limits(&scene));
    for i in 0..3 {
        let batch = |name| side.batch(&scene, name, i).functionals;
        watched.push(&batch("first"), &batch("second"));
    }
    let total = watched.findings().into_iter().find(|f| f.name == "total").unwrap();
    assert_eq!(total.outcome, Outcome::Inconclusive);
    assert!(total.reason.as_deref().unwrap().contains("infinite"), "{total:?}");
    // where both sides of the equation are held against each other,
    let at = equilibrium::points(&scene, Origin::Surface, 4, 1);
    let balances = equilibrium::at_points(&scene, &at, &lecture, 1.0, Progress::NONE);
    assert!(balances.iter().all(|b| b.evidence().no_error == Some(Reason::Infinite)));
    let judged = judge(&[("surface", &balances)], 0.05, 0.5);
    assert_eq!((judged.outcome, judged.judged), (Outcome::Inconclusive, 0));
    // and where noise falls: samples whose variance were finite would have a slope
    let mut recorder = Recorder::new(None, vec![64, 128, 256]);
    let longer = Settings { spp: 256, ..lecture.clone() };
    let swept = by_rays::watched(
        &scene,
        Some(Estimator::Prefix),
        &longer,
        Progress::NONE,
        Watch { look: Some(&mut |film| recorder.look(film)), ..Watch::NONE },
    );
    let stands = recorder.stands();
    for (variance, known) in [(Variance::Finite, true), (swept.series.variance, false)] {
        let parts = NoiseCurve::all(&stands, true, variance);
        let all = parts.iter().find(|p| p.name == "all").unwrap();
        assert_eq!(all.slope().is_some(), known, "{variance:?}");
    }
    // by albedo everything keeps its error
    let usual = by_rays::path(&scene, &settings, Progress::NONE);
    assert!(usual.doubt.is_none() && usual.series.image().total.std_error.is_finite());
}

/// A lamp without blue: what is white in blue alone keeps no path alive.
#[test]
fn a_channel_without_light_has_no_say() {
    let scene = Scene::new(&description(&[(
        room(DVec3::NEG_ONE, DVec3::ONE, 0.0),
        DVec3::new(0.5, 0.5, 1.0),
        DVec3::new(1.0, 1.0, 0.0),
    )]));
    assert_eq!(scene.lit().as_dvec3(), DVec3::new(1.0, 1.0, 0.0));
    let settings = Settings { spp: 16, max_bounces: K, ..Settings::default() };
    let path = by_rays::path(&scene, &settings, Progress::NONE);
    let mean = path.series.image().total.mean;
    assert!((mean - DVec3::new(2.0, 2.0, 0.0)).abs().max_element() < 0.2, "{mean}");
    assert!(path.series.cost.rays < 20 * path.series.cost.paths);
}
