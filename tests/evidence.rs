//! What does not carry a verdict gets none, and what has no error is printed without one: the cases that were wrong, and their kinds.
//!
//! | test | what it holds |
//! |---|---|
//! | `few_samples_never_tell_equal_estimators_apart` | 40 seeds × 2, 3, 4, 8 samples × three scenes: no difference where there is none |
//! | `what_has_not_happened_yet_decides_nothing` | lamps, caustics, narrow views, corners that hardly a path meets |
//! | `intervals_cover_where_they_are_shown` | 95 % intervals of skewed sums |
//! | `shipped_scenes_do_not_differ_from_themselves` (nightly) | every shipped scene × 12 seeds |
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::{assert_rate_at_most, open};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator, Sampled};
use fredholm::estimator::Technique;
use fredholm::progress::Progress;
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Scene, builtin};
use fredholm::stats::{Comparison, Criterion, Evidence, Outcome, compare, half_width_95};
use fredholm::terms::Series;
use rayon::prelude::*;

/// One glowing square before black.
const SQUARE: &str = r#"
camera = { origin = [0, 0, 4], target = [0, 0, 0], up = [0, 1, 0], fov = 40, size = [8, 8] }
materials.w = { type = "diffuse", reflectance = [0.5, 0.5, 0.5] }
[[shapes]]
type = "quad"
origin = [-1, -1, 0]
edge_u = [2, 0, 0]
edge_v = [0, 2, 0]
material = "w"
emission = [1, 1, 1]
"#;

/// A small glowing ball before black: no pixel is covered wholly.
const DISK: &str = r#"
camera = { origin = [0, 0, 4], target = [0, 0, 0], up = [0, 1, 0], fov = 40, size = [8, 8] }
materials.w = { type = "diffuse", reflectance = [0.5, 0.5, 0.5] }
[[shapes]]
type = "sphere"
center = [0, 0, 0]
radius = 0.9
material = "w"
emission = [1, 1, 1]
"#;

/// A box with a lamp of a 60 000th of its surface.
const TINY_LAMP: &str = r#"
camera = { origin = [0, 0, 0.9], target = [0, 0, 0], up = [0, 1, 0], fov = 39.3, size = [16, 16] }
materials.white = { type = "diffuse", reflectance = [0.5, 0.5, 0.5] }
[[shapes]]
type = "box"
min = [-1, -1, -1]
max = [1, 1, 1]
inward = true
material = "white"
[[shapes]]
type = "quad"
origin = [-0.01, 0.99, -0.01]
edge_u = [0.02, 0, 0]
edge_v = [0, 0, 0.02]
material = "white"
power = [10, 10, 10]
"#;

/// The camera stands in a closed black block inside a glowing room.
const NOTHING_TO_SEE: &str = r#"
camera = { origin = [0, -0.5, 0], target = [0, -0.5, 1], up = [0, 1, 0], fov = 60, size = [16, 16] }
materials.w = { type = "diffuse", reflectance = [0.5, 0.5, 0.5] }
[[shapes]]
type = "box"
min = [-1, -1, -1]
max = [1, 1, 1]
inward = true
material = "w"
emission = [1, 1, 1]
[[shapes]]
type = "box"
min = [-0.4, -0.9, -0.4]
max = [0.4, -0.1, 0.4]
material = "w"
"#;

/// Three glowing walls that meet in a corner, seen in the corner: one bounce gives 3/4.
const CORNER: &str = r#"
camera = { origin = [0.5, 0.5, 0.5], target = [0.00001, 0.00001, 0], up = [0, 1, 0], fov = 0.0001, size = [4, 4] }
materials.white = { type = "diffuse", reflectance = [1, 1, 1] }
[[shapes]]
type = "quad"
origin = [0, 0, 0]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
material = "white"
emission = [1, 1, 1]
[[shapes]]
type = "quad"
origin = [0, 0, 0]
edge_u = [0, 1, 0]
edge_v = [0, 0, 1]
material = "white"
emission = [1, 1, 1]
[[shapes]]
type = "quad"
origin = [0, 0, 0]
edge_u = [0, 0, 1]
edge_v = [1, 0, 0]
material = "white"
emission = [1, 1, 1]
"#;

fn scene(text: &str, set: &[&str]) -> Scene {
    let options = Options { set: set.iter().map(|s| (*s).to_owned()).collect(), ..Options::default() };
    if !text.contains('\n') {
        return Scene::new(&load::scene(text, &options).unwrap().description);
    }
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, text).unwrap();
    Scene::new(&load::scene(file.to_str().unwrap(), &options).unwrap().description)
}

fn settings(technique: Technique, spp: u32, seed: u64) -> Settings {
    Settings { technique, spp, seed, max_bounces: 4, ..Settings::default() }
}

fn terms(s: &Scene, estimator: Estimator, settings: &Settings) -> Sampled {
    by_rays::terms(s, estimator, settings, Progress::NONE)
}

fn path(s: &Scene, settings: &Settings) -> Sampled {
    by_rays::path(s, settings, Progress::NONE)
}

fn judged(a: &Series, b: &Series) -> Comparison {
    compare(a, b, &Criterion::default(), &[])
}

#[test]
fn few_samples_never_tell_equal_estimators_apart() {
    let mut account = open("few_samples_never_tell_equal_estimators_apart");
    let scenes = [scene(SQUARE, &[]), scene(DISK, &[]), scene("cornell", &["camera.size=[8,8]"])];
    let cases: Vec<(usize, u32, u64)> = (0..3)
        .flat_map(|s| [2, 3, 4, 8].into_iter().flat_map(move |spp| (0..40).map(move |seed| (s, spp, seed))))
        .collect();
    let base = account.seed();
    let one = |&(s, spp, seed): &(usize, u32, u64)| {
        let settings = settings(Technique::Mis, spp, base.wrapping_add(seed));
        let (a, b) = (terms(&scenes[s], Estimator::Prefix, &settings), path(&scenes[s], &settings));
        let c = terms(&scenes[s], Estimator::Single, &settings);
        [judged(&a.series, &b.series).outcome, judged(&a.series, &c.series).outcome]
    };
    let outcomes: Vec<Outcome> = cases.par_iter().flat_map_iter(one).collect();
    let differ = outcomes.iter().filter(|o| **o == Outcome::Differs).count() as u64;
    eprintln!("{differ} of {} comparisons differ", outcomes.len());
    assert_rate_at_most(&mut account, "differ", differ, outcomes.len() as u64, Criterion::default().alpha);
    assert_eq!(differ, 0);
}

/// Where ± 0 is right two samples are enough to agree.
#[test]
fn a_furnace_agrees_at_two_samples() {
    let s = scene("furnace", &["camera.size=[8,8]"]);
    let settings = settings(Technique::Scatter, 2, 1);
    let [a, b] = [Estimator::Prefix, Estimator::Single].map(|e| terms(&s, e, &settings).series);
    let c = judged(&a, &b);
    // the tail has the noise of its roulette
    let rows = c.rows.iter().filter(|r| r.name.starts_with('T'));
    assert!(rows.clone().count() == 5 && rows.clone().all(|r| r.outcome == Outcome::Agrees), "{c:?}");
}

#[test]
fn what_has_not_happened_yet_decides_nothing() {
    let open = |c: &Comparison, name: &str| {
        let row = c.rows.iter().find(|r| r.name == name).unwrap();
        assert_eq!(row.outcome, Outcome::Inconclusive, "{row:?}");
        row.reason.clone().unwrap()
    };
    let tiny = scene(TINY_LAMP, &[]);
    let right = terms(&tiny, Estimator::Prefix, &settings(Technique::Mis, 256, 1));
    assert!(right.series.image().terms[1..].iter().all(|e| Evidence::of(e).no_verdict.is_none()));
    for (spp, seed) in [(2, 0), (16, 1), (256, 2), (256, 3), (1024, 4)] {
        let hits = terms(&tiny, Estimator::Prefix, &settings(Technique::Scatter, spp, seed));
        let c = judged(&hits.series, &right.series);
        assert!(["T1", "T2", "T4", "tail", "total"].iter().all(|n| open(&c, n).contains("lamps")), "{c:?}");
        assert!(hits.series.image().terms[1..].iter().all(|e| Evidence::of(e).no_error.is_some()));
        // two black pictures are no better
        let again = terms(&tiny, Estimator::Prefix, &settings(Technique::Scatter, spp, seed + 10));
        open(&judged(&hits.series, &again.series), "T1");
    }
    // a narrow view that particles hardly ever hit
    let narrow = scene("cornell", &["camera.fov=0.01", "camera.size=[8,8]"]);
    let eye = terms(&narrow, Estimator::Prefix, &settings(Technique::Mis, 256, 1));
    let light = terms(&narrow, Estimator::Light, &settings(Technique::Mis, 256, 1));
    assert!(open(&judged(&light.series, &eye.series), "T1").contains("in view of the camera"));
    // caustics: samples that look well, of a mean that is far off
    let caustic = scene("caustic", &["camera.size=[8,8]"]);
    let eye = terms(&caustic, Estimator::Prefix, &settings(Technique::Mis, 256, 1));
    let both = terms(&caustic, Estimator::Bidirectional, &settings(Technique::Mis, 256, 2));
    for name in ["T2", "T3", "total"] {
        assert!(open(&judged(&eye.series, &both.series), name).contains("mirrors or glass"));
    }
    assert!(Evidence::of(&eye.series.image().terms[3]).no_error.is_some());
    assert_eq!(judged(&eye.series, &both.series).rows.iter().filter(|r| r.outcome == Outcome::Differs).count(), 0);
    // light from beside: 3/4, of which almost all comes from points that are hardly ever chosen
    let corner = scene(CORNER, &[]);
    for seed in 0..20 {
        let found = terms(&corner, Estimator::Prefix, &settings(Technique::Connect, 256, seed));
        let e = found.series.image().terms[1];
        let (mean, half) = (e.mean.x, half_width_95(e.std_error.x, e.replicates));
        let covers = (mean - 0.75).abs() <= half;
        assert!(covers || Evidence::of(&e).no_error.is_some(), "{seed}: {mean} ± {half}, {:?}", e.events);
    }
}

/// Black for certain is equal, and says so; black by chance is not.
#[test]
fn a_black_picture_agrees_only_where_nothing_is_met_by_chance() {
    let s = scene(NOTHING_TO_SEE, &[]);
    let settings = settings(Technique::Mis, 16, 1);
    let (a, b) = (terms(&s, Estimator::Prefix, &settings), path(&s, &settings));
    assert_eq!(judged(&a.series, &b.series).outcome, Outcome::Agrees);
    assert!(Evidence::of(&a.series.image().total).no_error.is_some());
}

/// `cornell` by hits alone has a skewed law; where its interval is shown it covers.
#[test]
fn intervals_cover_where_they_are_shown() {
    let mut account = open("intervals_cover_where_they_are_shown");
    let s = scene("cornell", &["camera.size=[8,8]"]);
    let base = account.seed();
    let truth = terms(&s, Estimator::Prefix, &settings(Technique::Mis, 1 << 14, base.wrapping_sub(1)));
    let grey = |v: glam::DVec3| v.element_sum() / 3.0;
    let mut shown = [0u64; 2];
    for spp in [512, 1024, 2048] {
        let one = |i: u64| -> Vec<bool> {
            let found = terms(&s, Estimator::Prefix, &settings(Technique::Scatter, spp, base.wrapping_add(i)));
            let pairs = found.series.image().terms.iter().zip(&truth.series.image().terms).skip(1);
            let missed = |(e, x): (&fredholm::terms::Estimate, &fredholm::terms::Estimate)| {
                let half = half_width_95(grey(e.std_error).hypot(grey(x.std_error)), e.replicates);
                Evidence::of(e).no_error.is_none().then_some(grey(e.mean - x.mean).abs() > half)
            };
            pairs.filter_map(missed).collect()
        };
        for missed in (0..100u64).into_par_iter().flat_map_iter(one).collect::<Vec<bool>>() {
            shown[usize::from(missed)] += 1;
        }
    }
    let all = shown[0] + shown[1];
    eprintln!("{} of {all} intervals miss", shown[1]);
    assert!(all > 300, "{all}");
    // terms of one path are correlated: five of a render count as one
    assert_rate_at_most(&mut account, "missed", shown[1] / 4, all / 4, 0.07);
}

#[test]
#[ignore = "fourteen scenes, twelve seeds: minutes"]
fn shipped_scenes_do_not_differ_from_themselves() {
    let mut account = open("shipped_scenes_do_not_differ_from_themselves");
    let (base, mut differ, mut all) = (account.seed(), 0, 0);
    for name in builtin::names() {
        let s = scene(name, &["camera.size=[16,16]"]);
        let one = |i: u64| {
            let settings = Settings { spp: 64, seed: base.wrapping_add(i), ..Settings::default() };
            let a = terms(&s, Estimator::Prefix, &settings);
            let (b, c) = (path(&s, &settings), terms(&s, Estimator::Bidirectional, &settings));
            [&b.series, &c.series].map(|other| match a.series.gap(other) {
                None => judged(&a.series, other).outcome,
                Some((from, _)) => judged(&a.series.before(from), other).outcome,
            })
        };
        let outcomes: Vec<Outcome> = (0..12u64).into_par_iter().flat_map_iter(one).collect();
        let count = |o| outcomes.iter().filter(|x| **x == o).count() as u64;
        let [agree, unequal, undecided] = [Outcome::Agrees, Outcome::Differs, Outcome::Inconclusive].map(count);
        eprintln!("{name}: {agree} agree, {unequal} differ, {undecided} inconclusive");
        (differ, all) = (differ + unequal, all + outcomes.len() as u64);
    }
    assert_rate_at_most(&mut account, "differ", differ, all, Criterion::default().alpha);
}
