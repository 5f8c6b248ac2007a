//! Variance and squared error as they fall: slopes with honest errors, and squared errors without the noise of the reference.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::ledger;
use common::sampling::plan;
use fredholm::estimator::render::{Amount, render, render_in_passes};
use fredholm::estimator::{Prefix, Roulette, Technique, TermEstimator};
use fredholm::math::{Key, Points, Rgb};
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::{MatrixWalk, SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::load::{self, Options};
use fredholm::stats::{Measured, Slope, critical, two_sided_p};
use fredholm::study::convergence::NoiseCurve;
use fredholm::terms::scatter::Scatter;
use fredholm::terms::{TermFilm, TermImage, Variance};
use std::ops::Range;
use std::slice;

/// The curves of sums of slots from 1 to `spp / replicates` samples per replicate, all of one render.
fn curves<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    amount: Amount,
    slots: &[Range<usize>],
) -> Vec<NoiseCurve> {
    let empty = |_| NoiseCurve { name: "all".into(), points: vec![], variance: Variance::Finite };
    let mut parts: Vec<NoiseCurve> = slots.iter().map(empty).collect();
    render_in_passes(t, sensor, estimator, amount, Progress::NONE, &mut |film, planned| {
        for (part, slots) in parts.iter_mut().zip(slots) {
            part.points.push((film.least_samples(), Scatter::of(film, slots.clone(), None)));
        }
        planned
    });
    parts
}

/// How often intervals of 95 % of the slopes miss −1, curve by curve: as they are, and half as long.
fn missed(trials: u32, curves: &dyn Fn(u32) -> Vec<NoiseCurve>) -> Vec<[u64; 2]> {
    let slopes: Vec<Vec<Slope>> =
        (0..trials).map(|i| curves(i).iter().map(|part| part.slope().unwrap()).collect()).collect();
    let n = f64::from(trials);
    let of = |c: usize| {
        let all: Vec<Slope> = slopes.iter().map(|s| s[c]).collect();
        let t = critical(0.05, 15.0);
        let missed =
            [1.0, 0.5].map(|f| all.iter().filter(|s| (s.slope + 1.0).abs() > f * t * s.std_error).count() as u64);
        let mean = all.iter().map(|s| s.slope).sum::<f64>() / n;
        let variance = all.iter().map(|s| (s.slope - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let claimed = all.iter().map(|s| s.std_error.powi(2)).sum::<f64>() / n;
        let ratio = (claimed / variance).sqrt();
        eprintln!("{missed:?} of {trials} miss −1 at 95 %; mean {mean:.4}, claimed/true error {ratio:.3}");
        missed
    };
    (0..slopes[0].len()).map(of).collect()
}

/// Four rows that lose light; rows 0 and 2 emit.
fn walk() -> MatrixWalk {
    let rows = [[0.1, 0.3, 0.3, 0.2], [0.4, 0.1, 0.2, 0.3], [0.3, 0.3, 0.1, 0.2], [0.5, 0.0, 0.4, 0.1]];
    let rho = vec![Rgb::new(0.5, 0.3, 0.6), Rgb::new(0.6, 0.5, 0.4), Rgb::new(0.3, 0.6, 0.5), Rgb::splat(0.4)];
    let emission = vec![Rgb::new(1.0, 2.0, 3.0), Rgb::ZERO, Rgb::splat(0.5), Rgb::ZERO];
    MatrixWalk::new(rows.concat(), rho, emission)
}

fn builtin(name: &str, size: [u32; 2]) -> Scene {
    let mut d = load::scene(name, &Options::default()).unwrap().description;
    d.camera.size = size;
    Scene::new(&d)
}

/// The promise of a slope: its interval of 95 % misses −1 in 5 % of the renders at most. Nothing here is taken to be normal: hits of a
/// lamp are rare, three channels share every path, and the three curves of a scene share their films, which Bonferroni allows.
///
/// ln V is skewed where few events carry V, and then misses too often: in 36 pixels T2 rests on 130 events at the end of its
/// curve and on fewer than 10 at its beginning, and 7.7 % of 400 slopes missed. More pixels have more events: of 800 slopes in 256
/// and 576 pixels, with other seeds, 4.4 % missed. So the promise is tested there, at its own rate.
///
/// **Power.** At the level of one comparison, 1.3·10⁻⁹, some 40 of 256 must miss: intervals half as long miss in a third of the
/// renders and are found, which is asserted.
#[test]
fn slopes_of_renders_cover_minus_one() {
    const TRIALS: u32 = 256;
    let mut account = common::open("slopes_of_renders_cover_minus_one");
    let key = |trial: u32| Key::new(account.seed(), "slopes").branch(trial);
    let amount = |trial| Amount { spp: 16 * 16, replicates: 16, key: key(trial) };
    let (walk, scatter) = (walk(), Prefix(plan(3, Technique::Scatter, &Roulette::Never)));
    let matrix = missed(1000, &|i| curves(&walk, &Rows(4), &scatter, amount(i), slice::from_ref(&(0..5))))[0];
    let cornell = builtin("cornell", [16, 16]);
    let t = SceneTransport::new(&cornell);
    let mis = Prefix(plan(2, Technique::Mis, &Roulette::Never));
    let scene = missed(TRIALS, &|i| curves(&t, &cornell.camera, &mis, amount(i), &[1..2, 2..3, 0..4]));
    let parts = ["Cornell box, T1", "Cornell box, T2", "Cornell box, all"].into_iter().zip(scene);
    for (i, (what, [as_it_is, half])) in [("matrix, scatter", matrix)].into_iter().chain(parts).enumerate() {
        let trials = if i == 0 { 1000 } else { TRIALS.into() };
        common::assert_rate_at_most(&mut account, what, as_it_is, trials, 0.05);
        // the errors at the edge of the lamp are half too long, so that halves of them are not far off
        let found = common::at_least(half, trials, 0.05) < ledger::share("slopes_of_renders_cover_minus_one").level();
        assert!(found || i == 3, "{what}: errors half as long miss in {half} of {trials} only");
    }
}

#[test]
fn sobol_points_fall_faster_in_a_smooth_scene() {
    let mut account = common::open("sobol_points_fall_faster_in_a_smooth_scene");
    let scene = builtin("furnace", [4, 4]);
    let t = SceneTransport { scene: &scene, sampling: Sampling::Uniform };
    // uniform directions: T1 is the integral of a cosine, as smooth as they come
    let estimator = Prefix(plan(1, Technique::Scatter, &Roulette::Never));
    let slope = |points| {
        let key = Key::new(account.seed(), "smooth").with_points(points, 64);
        let amount = Amount { spp: 64 * 128, replicates: 64, key };
        curves(&t, &scene.camera, &estimator, amount, slice::from_ref(&(1..2)))[0].slope().unwrap()
    };
    let (loose, even) = (slope(Points::Independent), slope(Points::Sobol));
    let t = critical(account.spend(2), 63.0);
    eprintln!("{loose:?}\n{even:?}");
    assert!((loose.slope + 1.0).abs() <= t * loose.std_error, "{loose:?}");
    assert!(even.slope + t * even.std_error < -1.5, "{even:?}");
}

#[test]
fn squared_errors_are_unbiased() {
    let mut account = common::open("squared_errors_are_unbiased");
    let (walk, estimator) = (walk(), Prefix(plan(2, Technique::Scatter, &Roulette::Never)));
    let film = |key| {
        let amount = Amount { spp: 64, replicates: 16, key };
        render(&walk, &Rows(4), &estimator, amount, Progress::NONE)
    };
    let truth: Vec<[f64; 3]> = {
        let terms = walk.powers(2);
        (0..4).map(|row| terms.iter().map(|t| t[row]).sum::<glam::DVec3>().to_array()).collect()
    };
    // a reference as noisy as the render, and one that is 20 % too bright
    let (mut honest, mut biased, mut naive) = (vec![], vec![], vec![]);
    let trials = 2000;
    let mut claimed = 0.0;
    for trial in 0..trials {
        let key = |name| Key::new(account.seed(), name).branch(trial);
        let (film, other) = (film(key("render")), film(key("reference")));
        let mut x = TermImage::of(&other, 0..4);
        let s = Scatter::of(&film, 0..4, Some(&x));
        let (mse, v) = (s.squared_error().unwrap(), s.variance());
        honest.push(mse - v);
        claimed += s.squared_error_error().powi(2) / f64::from(trials);
        let noise: f64 = x.std_error.iter().flatten().map(|&e| f64::from(e).powi(2)).sum::<f64>() / 12.0;
        naive.push(mse + noise - v);
        x.mean.iter_mut().zip(&truth).for_each(|(m, t)| (0..3).for_each(|c| m[c] += 0.2 * t[c] as f32));
        let s = Scatter::of(&film, 0..4, Some(&x));
        biased.push(s.squared_error().unwrap() - s.variance());
    }
    let square = truth.iter().flatten().map(|t| (0.2 * t).powi(2)).sum::<f64>() / 12.0;
    let mean = |all: &[f64]| {
        let n = all.len() as f64;
        let mean = all.iter().sum::<f64>() / n;
        let variance = all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
        Measured { mean, std_error: (variance / n).sqrt(), dof: n - 1.0 }
    };
    let level = account.spend(4);
    let p = |m: Measured, truth: f64| two_sided_p((m.mean - truth) / m.std_error, m.dof);
    let (honest, biased, naive) = (mean(&honest), mean(&biased), mean(&naive));
    eprintln!("bias² {:?}, of a biased one {:?} against {square:.5}, naive {:?}", honest, biased, naive);
    assert!(p(honest, 0.0) > level, "{honest:?}");
    assert!(p(biased, square) > level && p(biased, 0.0) < level, "{biased:?}, {square}");
    assert!(p(naive, 0.0) < level, "the noise of the reference must be seen: {naive:?}");
    assert!(claimed > 0.0);
}

/// Looking at other numbers of samples changes no bit of the film, and the looks are where they were asked for.
#[test]
fn looking_changes_nothing() {
    let (walk, estimator) = (walk(), Prefix(plan(3, Technique::Scatter, &Roulette::Never)));
    let film = |at: Vec<u32>| {
        let mut looks = vec![];
        let amount = Amount { spp: 200, replicates: 10, key: Key::new(1, "looks") };
        let film =
            render_in_passes(&walk, &Rows(4), &estimator, amount, Progress::NONE, &mut |film: &TermFilm, planned| {
                let done = film.least_samples();
                looks.push(done);
                at.iter().copied().find(|&n| n > done).map_or(planned, |n| planned.min(n))
            });
        (film, looks)
    };
    let ((plain, usual), (looked, asked)) = (film(vec![]), film(vec![10, 100, 200]));
    assert_eq!((usual, asked), (vec![10, 20, 40, 80, 160, 200], vec![10, 20, 40, 80, 100, 160, 200]));
    for (p, r, s) in (0..4).flat_map(|p| (0..10).flat_map(move |r| (0..5).map(move |s| (p, r, s)))) {
        assert_eq!(plain.sum(p, r, s), looked.sum(p, r, s));
    }
}
