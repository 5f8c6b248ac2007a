//! Sobol points beside independent ones: equally spread, equally unbiased, with errors as honest, and less noise.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::judge::{Jury, at};
use common::sampling::{Kind, TECHNIQUES, collect, film, plan};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{PathTracer, Prefix, Roulette, Technique};
use fredholm::math::{Key, Points, Purpose, Rgb, Rng, fnv1a};
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::{MatrixWalk, SceneTransport};
use fredholm::progress::Progress;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Scene, description::Description};
use fredholm::stats::{critical, variance_slope};
use fredholm::terms::functional::image_replicates;
use fredholm::terms::variance::snapshot;
use glam::DVec3;

const PURPOSES: [Purpose; 4] = [Purpose::Start, Purpose::Connect, Purpose::Scatter, Purpose::Roulette];

fn sobol(seed: u64, name: &str, replicates: usize) -> Key {
    Key::new(seed, name).with_points(Points::Sobol, replicates)
}

fn builtin(name: &str, size: [u32; 2]) -> Description {
    let mut d = load::scene(name, &Options::default()).unwrap().description;
    d.camera.size = size;
    d
}

/// Four rows that lose light; rows 0 and 2 emit.
fn walk() -> MatrixWalk {
    let rows = [[0.1, 0.3, 0.3, 0.2], [0.4, 0.1, 0.2, 0.3], [0.3, 0.3, 0.1, 0.2], [0.5, 0.0, 0.4, 0.1]];
    let rho = vec![Rgb::new(0.5, 0.3, 0.6), Rgb::new(0.6, 0.5, 0.4), Rgb::new(0.3, 0.6, 0.5), Rgb::splat(0.4)];
    let emission = vec![Rgb::new(1.0, 2.0, 3.0), Rgb::ZERO, Rgb::splat(0.5), Rgb::ZERO];
    MatrixWalk::new(rows.concat(), rho, emission)
}

/// The numbers of every published result: they may never move.
#[test]
fn independent_numbers_are_the_bits_they_always_were() {
    let mut bytes = vec![];
    for (seed, pixel, sample, bounce) in (0..3u64).flat_map(|s| {
        let pixels = [0u32, 1, 77, 4095].into_iter();
        let places = move |p| [0u32, 1, 255, 1 << 20].into_iter().flat_map(move |i| [0, 1, 9].map(|b| (s, p, i, b)));
        pixels.flat_map(places)
    }) {
        for purpose in PURPOSES {
            let key = Key::new(seed, "prefix");
            for key in [key, key.branch(3).with_points(Points::Independent, 16)] {
                let mut rng = Rng::at(key, pixel, sample, bounce, purpose);
                let u = [rng.four(), rng.four()].concat();
                bytes.extend(u.iter().flat_map(|u| u.to_bits().to_le_bytes()));
            }
        }
    }
    assert_eq!(fnv1a(bytes), 0x91dd_de7a_cc98_c947);
}

/// The smallest t for which the points are a (t, m, 2)-net: every elementary interval of area 2^(t−m) holds 2^t of them.
fn net_quality(points: &[[f32; 2]]) -> u32 {
    let m = points.len().ilog2();
    let fills = |t: u32, q: u32| {
        let (nx, ny) = (1usize << q, 1usize << (m - t - q));
        let mut count = vec![0u32; nx * ny];
        points.iter().for_each(|p| {
            count[(f64::from(p[0]) * nx as f64) as usize * ny + (f64::from(p[1]) * ny as f64) as usize] += 1;
        });
        count.iter().all(|&c| c == 1 << t)
    };
    (0..=m).find(|&t| (0..=m - t).all(|q| fills(t, q))).unwrap()
}

/// Point j of replicate r at some place.
fn point(key: Key, r: u32, replicates: u32, j: u32, (bounce, purpose, draw): (usize, Purpose, u32)) -> [f32; 4] {
    let mut rng = Rng::at(key, 5, r + replicates * j, bounce, purpose);
    for _ in 0..draw {
        rng.four();
    }
    rng.four()
}

#[test]
fn pairs_of_numbers_fill_every_elementary_interval() {
    let replicates = 3;
    let places =
        [(0, Purpose::Start, 0), (0, Purpose::Scatter, 0), (7, Purpose::Connect, 1), (300, Purpose::Roulette, 0)];
    for seed in 0..4 {
        let key = sobol(seed, "net", 3);
        for place in places {
            for r in 0..replicates {
                for m in [2, 4, 5, 8, 10] {
                    let all: Vec<[f32; 4]> = (0..1 << m).map(|j| point(key, r, replicates, j, place)).collect();
                    let pair = |a: usize, b: usize| all.iter().map(|u| [u[a], u[b]]).collect::<Vec<_>>();
                    assert_eq!(net_quality(&pair(0, 1)), 0, "first pair, {place:?}, r = {r}, m = {m}");
                    assert_eq!(net_quality(&pair(2, 3)), 0, "second pair, {place:?}, r = {r}, m = {m}");
                    assert!(all.iter().flatten().all(|u| (0.0..1.0).contains(u)));
                }
            }
        }
        // the check can fail: independent numbers clump, and two replicates together are no net
        let loose: Vec<[f32; 2]> = (0..256)
            .map(|i| Rng::at(Key::new(seed, "net"), 5, i, 0, Purpose::Start).four())
            .map(|u| [u[0], u[1]])
            .collect();
        assert!(net_quality(&loose) > 2);
        let of = |r| (0..128).map(move |j| point(key, r, replicates, j, places[0])).map(|u| [u[0], u[1]]);
        assert!(net_quality(&of(0).chain(of(1)).collect::<Vec<_>>()) > 0);
    }
}

#[test]
fn replicates_places_pixels_and_long_runs_have_scrambles_of_their_own() {
    let key = sobol(1, "own", 2);
    let first = |key: Key, pixel: u32, sample: u32, bounce, purpose| -> Vec<u32> {
        (0..8).map(|j| Rng::at(key, pixel, sample + 2 * j, bounce, purpose).one().to_bits()).collect()
    };
    let all = [
        first(key, 5, 0, 0, Purpose::Start),
        first(key, 5, 1, 0, Purpose::Start),
        first(key, 6, 0, 0, Purpose::Start),
        first(key, 5, 0, 1, Purpose::Start),
        first(key, 5, 0, 0, Purpose::Scatter),
        first(key.branch(1), 5, 0, 0, Purpose::Start),
        first(key, 5, 2 << 16, 0, Purpose::Start),
        first(sobol(1, "own", 1), 5, 0, 0, Purpose::Start),
    ];
    for (i, a) in all.iter().enumerate() {
        for b in &all[..i] {
            assert!(a.iter().zip(b).filter(|(x, y)| x == y).count() < 2, "{a:?} {b:?}");
        }
    }
}

/// Bulk numbers, packets and scalar code agree under Sobol points too: Σ terms = path tracer, path by path.
#[test]
fn waves_and_single_paths_read_the_same_points() {
    let d = builtin("cornell", [4, 4]);
    let scene = Scene::new(&d);
    let t = SceneTransport::new(&scene);
    let key = sobol(3, "same", 4);
    for technique in TECHNIQUES {
        let plan = plan(3, technique, &Roulette::Albedo { from: 1 });
        let terms = collect(&t, &scene.camera, &Prefix(plan.clone()), 64, 16, key);
        let path = collect(&t, &scene.camera, &PathTracer(plan), 64, 7, key);
        for (slots, whole) in terms.paths().zip(path.paths()) {
            let sum: DVec3 = slots.iter().sum();
            assert!((sum - whole[0]).abs().max_element() <= 1e-5 * whole[0].max_element(), "{sum} {}", whole[0]);
        }
    }
}

#[test]
fn sobol_points_move_no_mean() {
    let mut jury = Jury::open("sobol_points_move_no_mean");
    let (walk, k) = (walk(), 5);
    let powers = walk.powers(k);
    let whole: Vec<DVec3> = (0..4).map(|i| walk.powers(80).iter().map(|t| t[i]).sum()).collect();
    for (i, kind) in [Kind::Prefix, Kind::Single, Kind::Path].into_iter().enumerate() {
        for technique in TECHNIQUES {
            for roulette in ["albedo@1", "constant:0.2@0"] {
                let plan = plan(k, technique, &roulette.parse().unwrap());
                let key = sobol(jury.seed(), &format!("{kind:?} {technique} {roulette}"), 256);
                let film = film(&walk, &Rows(4), kind, &plan, if i == 1 { 1 << 15 } else { 1 << 16 }, key);
                for row in 0..4 {
                    let what = format!("{kind:?}, {technique}, {roulette}, row {row}");
                    if kind == Kind::Path {
                        jury.part(&format!("{what}, total"), &at(&film, row, 0..1), whole[row], whole[row]);
                        continue;
                    }
                    for (s, term) in powers.iter().enumerate() {
                        jury.part(&format!("{what}, T{s}"), &at(&film, row, s..s + 1), term[row], whole[row]);
                    }
                    jury.part(&format!("{what}, total"), &at(&film, row, 0..k + 2), whole[row], whole[row]);
                }
            }
        }
    }
    // rays: the furnace, with directions that have noise
    let d = builtin("furnace", [4, 4]);
    let scene = Scene::new(&d);
    let t = SceneTransport { scene: &scene, sampling: Sampling::Uniform };
    for technique in TECHNIQUES {
        let key = sobol(jury.seed(), &format!("furnace {technique}"), 256);
        let film = film(&t, &scene.camera, Kind::Prefix, &plan(4, technique, &Roulette::Never), 1 << 13, key);
        let image = image_replicates(&film);
        for s in 0..=4 {
            let truth = DVec3::splat(0.5f64.powi(s as i32));
            jury.part(&format!("furnace, {technique}, T{s}"), &image.estimate(s..s + 1), truth, DVec3::splat(2.0));
        }
    }
    jury.assert_power(0.25, 0.04);
}

/// How often the 95 % interval from 16 replicates misses the truth, on a matrix, with `scrambles` scrambles.
fn misses(seed: u64, scrambles: usize, trials: u32) -> u64 {
    let walk = walk();
    let truth = walk.powers(2)[2][1].y + walk.powers(1)[1][1].y;
    let plan = plan(2, Technique::Mis, &Roulette::Never);
    let missed = |trial: u32| {
        let key = Key::new(seed, "calibration").with_points(Points::Sobol, scrambles).branch(trial);
        let amount = Amount { spp: 16 * 32, replicates: 16, key };
        let film = render(&walk, &Rows(2), &Prefix(plan.clone()), amount, Progress::NONE);
        let e = at(&film, 1, 1..3);
        (e.mean.y - truth).abs() > critical(0.05, 15.0) * e.std_error.y
    };
    (0..trials).filter(|&trial| missed(trial)).count() as u64
}

#[test]
fn errors_from_replicates_cover_the_truth() {
    let mut account = common::open("errors_from_replicates_cover_the_truth");
    let trials = 3000;
    let honest = misses(account.seed(), 16, trials);
    common::assert_rate(&mut account, "misses of 95 % intervals", honest, trials.into(), 0.05);
    // one scramble dealt to all replicates: they avoid each other, and the error is much too large
    let shared = misses(account.seed(), 1, trials);
    eprintln!("{honest} of {trials} intervals miss; {shared} if the replicates share a scramble");
    assert!(shared < honest / 4, "{shared} {honest}");
}

/// Variance of the mean of n points, n = 4, …, 1024, from R replicates. The integrand is smooth in each pair of numbers and adds up
/// over the pairs: points of different pairs are independent, so that products of pairs would keep slope −1.
fn curve(key: Key, replicates: u32) -> Vec<(f64, f64)> {
    let f = |u: [f32; 4]| u.chunks(2).map(|u| u.iter().map(|&x| 0.5 + f64::from(x)).product::<f64>()).sum::<f64>();
    let mean = |r: u32, n: u32| {
        let all = (0..n).map(|j| f(Rng::at(key, 0, r + replicates * j, 0, Purpose::Scatter).four()));
        all.sum::<f64>() / f64::from(n)
    };
    let variance = |n: u32| {
        let means: Vec<DVec3> = (0..replicates).map(|r| DVec3::splat(mean(r, n))).collect();
        (f64::from(n), fredholm::stats::estimate(&means).std_error.x.powi(2) * f64::from(replicates))
    };
    (2..=10).map(|m| variance(1 << m)).collect()
}

#[test]
fn the_variance_of_a_smooth_integrand_falls_faster() {
    let mut account = common::open("the_variance_of_a_smooth_integrand_falls_faster");
    let slope = |key| variance_slope(&curve(key, 256), 255.0).unwrap();
    let t = critical(account.spend(2), f64::INFINITY);
    let (loose, even) = (slope(Key::new(account.seed(), "slope")), slope(sobol(account.seed(), "slope", 256)));
    eprintln!("slopes: independent {:.3}, Sobol {:.3}", loose.slope, even.slope);
    assert!((loose.slope + 1.0).abs() <= t * loose.std_error, "{loose:?}");
    assert!(even.slope + t * even.std_error < -1.5, "{even:?}");
}

#[test]
fn no_term_of_a_furnace_is_noisier() {
    let mut account = common::open("no_term_of_a_furnace_is_noisier");
    let d = builtin("furnace", [8, 8]);
    let scene = Scene::new(&d);
    let t = SceneTransport { scene: &scene, sampling: Sampling::Uniform };
    let level = account.spend(2 * 6);
    let z = critical(level, f64::INFINITY);
    for technique in [Technique::Scatter, Technique::Mis] {
        let plan = plan(6, technique, &Roulette::Never);
        let of = |key| snapshot(&film(&t, &scene.camera, Kind::Prefix, &plan, 256 * 64, key)).slots;
        let (loose, even) = (of(Key::new(account.seed(), "noise")), of(sobol(account.seed(), "noise", 256)));
        for k in 1..=6 {
            let (a, b) = (even[k], loose[k]);
            let error = a.std_error.hypot(b.std_error);
            eprintln!("{technique}, T{k}: {:.4} of the independent variance", a.value / b.value);
            assert!(a.value - b.value <= z * error, "T{k}: {a:?} {b:?}");
            if k == 1 {
                assert!(b.value - a.value > z * error, "T1 must gain: {a:?} {b:?}");
            }
        }
    }
}
