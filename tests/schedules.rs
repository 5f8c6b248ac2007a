//! The noise of a roulette schedule is predicted without rendering it: recorded moments against the algebra of matrices,
//! predictions against measurements, and the best schedule against its rivals.
//!
//! **Heavy tails.** A measured variance has a variance itself only where moments of order four are finite, the spectral radius
//! of `ρ⁴F/(1 − q)³` below 1; beyond it a measurement comes out too small most of the time, and proves nothing. So the schedules
//! compared here stay inside, which every scene asserts of the largest q that goes on for ever. Efficiency against the lecture's
//! schedule is another matter: in the Cornell box its variance is infinite, so its measured efficiency flatters it.
//!
//! **Power.** A prediction and a measurement of 2²⁰ paths each have standard errors of about 1 %; at the ledger's level
//! t* ≈ 8, so a single contradiction of 12 % is seen, and the median over all schedules is held to 3 %.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::Account;
use common::judge::{Judged, Jury};
use common::sampling::{TECHNIQUES, collect, plan};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix;
use fredholm::estimator::record::record;
use fredholm::estimator::render::Amount;
use fredholm::estimator::{Prefix, Roulette, Technique, Vertices};
use fredholm::math::{Key, Rgb};
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::{MatrixWalk, SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Description, Scene};
use fredholm::stats::Noise;
use fredholm::study::roulette::{self, Radii};
use fredholm::terms::cross_moments::{CrossMoments, Value};
use fredholm::terms::{Estimate, Recorded};
use glam::DVec3;
use std::sync::atomic::AtomicBool;

fn scene(name: &str, side: u32) -> (Description, Scene) {
    seen(name, side, &[])
}

/// The same with other keys.
fn seen(name: &str, side: u32, set: &[&str]) -> (Description, Scene) {
    let size = format!("camera.size=[{side},{side}]");
    let set = set.iter().map(|s| (*s).to_owned()).chain([size]).collect();
    let options = Options { set, ..Options::default() };
    let description = load::scene(name, &options).unwrap().description;
    let scene = Scene::new(&description);
    (description, scene)
}

/// Rows that keep part of their light and lose some of it, three colours, two of four emit.
const N: usize = 4;
const F: [[f64; N]; N] = [[0.1, 0.4, 0.3, 0.1], [0.3, 0.0, 0.2, 0.5], [0.25, 0.25, 0.1, 0.3], [0.0, 0.6, 0.2, 0.1]];

fn rho() -> Vec<Rgb> {
    vec![Rgb::new(0.9, 0.5, 0.3), Rgb::new(0.6, 0.8, 0.2), Rgb::new(0.7, 0.7, 0.7), Rgb::new(0.4, 0.2, 0.9)]
}

fn emission() -> Vec<Rgb> {
    vec![Rgb::new(1.0, 2.0, 0.5), Rgb::ZERO, Rgb::new(0.5, 0.25, 3.0), Rgb::ZERO]
}

fn walk() -> MatrixWalk {
    MatrixWalk::new(F.concat(), rho(), emission())
}

// ------------------------------------------------------------------------------------------------ identities

/// Slot by slot the paths are those of the prefix estimator: same numbers, same terms, same rays.
fn the_same_paths<T: Transport>(t: &T, sensor: &impl Sensor<T>, schedule: &str, samples: u32) {
    const K: usize = 5;
    let key = Key::new(3, "vertices");
    for technique in TECHNIQUES {
        let plan = plan(K, technique, &schedule.parse().unwrap());
        let terms = collect(t, sensor, &Prefix(plan.clone()), samples, 4, key);
        let slots = collect(t, sensor, &Vertices(plan), samples, 4, key);
        assert!(terms.values.iter().any(|v| *v != DVec3::ZERO), "nothing to compare");
        for (x, y) in terms.paths().zip(slots.paths()) {
            for (k, term) in x.iter().enumerate() {
                let sum: DVec3 = (0..y.len()).filter(|&a| Vertices::term(a) == k).map(|a| y[a]).sum();
                assert!((sum - *term).abs().cmple(1e-6 * term.abs()).all(), "{technique}, T{k}: {sum} for {term}");
            }
        }
        assert_eq!(terms.rays.iter().sum::<u64>(), slots.rays.iter().sum::<u64>(), "{technique}");
    }
}

#[test]
fn slots_of_a_path_add_up_to_its_terms() {
    for schedule in ["none", "constant:0.3@0", "constant:0.2@5", "albedo@1"] {
        the_same_paths(&walk(), &Rows(N as u32), schedule, 64);
        let (_, scene) = scene("cornell", 8);
        the_same_paths(&SceneTransport::new(&scene), &scene.camera, schedule, 4);
    }
}

/// One replicate after the other, one block after the other: the same bits for any number of threads.
#[test]
fn recordings_do_not_depend_on_threads() {
    let (_, scene) = scene("cornell", 40);
    let settings = Settings { max_bounces: 4, ..Settings::default() };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut r = pool.install(|| roulette::pilot(&scene, &settings, 8, Progress::NONE).unwrap());
        r.seconds = 0.0;
        r
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert_eq!(one.paths, 40 * 40 * 8);
    assert!(one.all.second.iter().flatten().all(|m| m.is_finite()));
}

/// Half an image has other moments.
#[test]
fn an_interrupted_recording_is_none() {
    let (_, scene) = scene("cornell", 8);
    let stop = AtomicBool::new(true);
    assert_eq!(roulette::pilot(&scene, &Settings::default(), 8, Progress::NONE.stopped_by(&stop)), None);
}

// ------------------------------------------------------------------------------------------------ against algebra

/// `diag(g(ρ)) F x` of one channel.
fn apply(channel: usize, g: impl Fn(f64) -> f64, x: &[f64]) -> Vec<f64> {
    let row = |i: usize| g(f64::from(rho()[i][channel])) * (0..N).map(|j| F[i][j] * x[j]).sum::<f64>();
    (0..N).map(row).collect()
}

/// `E[Y_j Y_k]` at every row for what vertices j ≤ k score: with u(x) the mean of what a vertex scores and u₂(x) that of its
/// square, `(diag(ρ²)F)^j u₂` for j = k and `(diag(ρ²)F)^j [u · T^{k−j} u]` for j < k, because what a vertex scores does
/// not depend on where its path goes on.
fn exact(channel: usize, j: usize, k: usize, u: &[f64], square: &[f64]) -> Vec<f64> {
    let mut x: Vec<f64> = if j == k {
        square.to_vec()
    } else {
        let later = (j..k).fold(u.to_vec(), |x, _| apply(channel, |r| r, &x));
        u.iter().zip(later).map(|(a, b)| a * b).collect()
    };
    (0..j).for_each(|_| x = apply(channel, |r| r * r, &x));
    x
}

#[test]
fn recorded_moments_are_those_of_the_matrix() {
    const K: usize = 3;
    let mut jury = Jury::open("recorded_moments_are_those_of_the_matrix");
    let t = walk();
    let e = |c: usize| -> Vec<f64> { emission().iter().map(|e| f64::from(e[c])).collect() };
    let average = |x: Vec<f64>| x.iter().sum::<f64>() / N as f64;
    for (stream, technique) in [Technique::Scatter, Technique::Connect].into_iter().enumerate() {
        let plan = plan(K, technique, &"constant:0.2@3".parse().unwrap());
        let key = Key::new(jury.seed(), "moments").branch(stream as u32);
        let amount = Amount { spp: 1 << 19, replicates: 256, key };
        let r = record(&t, &Rows(N as u32), &Vertices(plan), amount, Progress::NONE).unwrap();
        // hits score E at every vertex; connections score one of two lamps, weight ρ F · 2 E, after the hit at the eye
        let (slot, vertices): (fn(usize) -> usize, usize) =
            if technique == Technique::Scatter { (|v| 2 * v, K + 1) } else { (|v| 2 * v + 1, K) };
        let score = |c: usize| match technique {
            Technique::Scatter => (e(c), e(c).iter().map(|e| e * e).collect()),
            _ => {
                let squares: Vec<f64> = e(c).iter().map(|e| 2.0 * e * e).collect();
                let square = |i: usize| {
                    let sum: f64 = (0..N).map(|j| (F[i][j]).powi(2) * squares[j]).sum();
                    f64::from(rho()[i][c]).powi(2) * sum
                };
                (apply(c, |r| r, &e(c)), (0..N).map(square).collect::<Vec<f64>>())
            }
        };
        for (j, k) in (0..vertices).flat_map(|k| (0..=k).map(move |j| (j, k))) {
            let (a, b) = (slot(j), slot(k));
            let at = |m: &CrossMoments, of: fn(&CrossMoments) -> &[Vec<f64>; 3], c: usize| of(m)[c][b * m.slots + a];
            let estimate = |of: fn(&CrossMoments) -> &[Vec<f64>; 3]| {
                let v: [Value; 3] = std::array::from_fn(|c| r.value(|m| at(m, of, c)));
                Estimate {
                    mean: DVec3::from_array(v.map(|v| v.value)),
                    std_error: DVec3::from_array(v.map(|v| v.std_error)),
                    replicates: r.replicates(),
                    events: None,
                }
            };
            let second = DVec3::from_array(std::array::from_fn(|c| {
                let (u, square) = score(c);
                average(exact(c, j, k, &u, &square))
            }));
            let product = DVec3::from_array(std::array::from_fn(|c| {
                let power = |v: usize| (0..v).fold(score(c).0, |x, _| apply(c, |r| r, &x));
                average(power(j).iter().zip(power(k)).map(|(a, b)| a * b).collect())
            }));
            // E itself has no noise: exact, but for the single precision of its squares
            if j + k == 0 && technique == Technique::Scatter {
                let got = estimate(|m| &m.second).mean;
                assert!((got - second).abs().cmple(1e-6 * second).all(), "{got} {second}");
                continue;
            }
            let what = format!("{technique}, vertices {j} and {k}");
            let mut judge = |what: &str, e: &Estimate, truth: DVec3| {
                assert_ne!(jury.judge(what, e, truth, 0.05 * truth, 0.2 * truth), Judged::TooNoisy, "{what}: {e:?}");
            };
            judge(&format!("M, {what}"), &estimate(|m| &m.second), second);
            judge(&format!("m, {what}"), &estimate(|m| &m.product), product);
        }
    }
    jury.assert_power(0.7, 0.0);
}

// ------------------------------------------------------------------------------------------------ against rendering

/// All inside the domain of finite fourth moments of the scenes below.
const SCHEDULES: [&str; 21] = [
    "none",
    "constant:0.05@0",
    "constant:0.1@0",
    "constant:0.15@0",
    "constant:0.2@0",
    "constant:0.05@1",
    "constant:0.1@1",
    "constant:0.15@1",
    "constant:0.2@1",
    "constant:0.05@2",
    "constant:0.1@2",
    "constant:0.15@2",
    "constant:0.2@2",
    "table:0,0.3,0.1",
    "table:0.3,0.1",
    "table:0.5,0,0.1",
    "table:0,0.5,0.1",
    "table:0.2,0.2,0.2,0",
    "table:0,0.1,0.2,0.1",
    "table:0.1,0.2,0.3,0.1",
    "table:0,0,0.4,0.1",
];
const LARGEST: f64 = 0.2;

fn equal(what: &str, predicted: &[Value; 3], measured: &[Value; 3], replicates: u64, account: &mut Account) {
    let of = |f: &dyn Fn(usize) -> f64| DVec3::from_array(std::array::from_fn(f));
    let difference = Estimate {
        mean: of(&|i| measured[i].value - predicted[i].value),
        std_error: of(&|i| measured[i].std_error.hypot(predicted[i].std_error)),
        replicates,
        events: None,
    };
    account.assert_consistent(what, &difference, DVec3::ZERO);
}

/// Predictions of every schedule against renders of their own streams: the whole image, T1, T2, T3, T5 and the tail. The
/// median of |measured/predicted − 1| over the schedules comes back for each scene, with the largest |z| of the whole image.
fn compare(mut account: Account, scenes: &[(&str, u32)], schedules: &[&str], paths: u32) -> Vec<(f64, f64)> {
    let mut medians = vec![];
    for &(name, side) in scenes {
        // not into the lamp: its rim would be all the noise there is
        let floor = ["camera.origin=[0,0.6,0.9]", "camera.target=[0,-0.9,-0.5]"];
        let (description, scene) = seen(name, side, if name == "cornell" { &floor } else { &[] });
        let matrix = by_matrix::dense_matrix(&description, &scene, 100, 1.0, 0, Progress::NONE).unwrap();
        let radii = Radii::new(Some(&matrix.radiosity), &scene, LARGEST);
        assert!(radii.fourth < 0.95, "{name} at q = {LARGEST}: {radii:?}");
        let settings = Settings { max_bounces: 12, seed: account.seed(), ..Settings::default() };
        let spp = paths / (side * side);
        // all predictions share its error: four times the paths
        let recorded = roulette::pilot(&scene, &settings, 4 * spp, Progress::NONE).unwrap();
        let (mut errors, mut beyond, mut largest, mut all) = (vec![], 0, 0.0_f64, 0);
        for text in schedules {
            let schedule: Roulette = text.parse().unwrap();
            let schedule = schedule.then(12, roulette::beyond(&scene)).unwrap();
            let p = Noise::predicted(&recorded, &schedule).unwrap();
            let render = roulette::measure(&scene, &settings, &schedule, spp, Progress::NONE).unwrap();
            let m = Noise::measured(&render);
            let parts = |n: &Noise| [[n.all, n.terms[1], n.terms[2]], [n.terms[3], n.terms[5], n.tail]];
            for (i, (p, m)) in parts(&p).iter().zip(&parts(&m)).enumerate() {
                equal(&format!("{name}, {text}, part {i}"), p, m, render.replicates(), &mut account);
                for (p, m) in p.iter().zip(m) {
                    let z = (m.value - p.value) / m.std_error.hypot(p.std_error);
                    beyond += u32::from(z.abs() > 3.0);
                    all += 1;
                }
            }
            let z = (m.all.value - p.all.value) / m.all.std_error.hypot(p.all.std_error);
            let ratio = m.all.value / p.all.value;
            let error = m.all.std_error.hypot(p.all.std_error) / p.all.value;
            assert!(error < 0.04, "{name}, {text}: a ratio known to {error} proves little");
            eprintln!(
                "{name:>12} {text:<24} predicted {:.5} ± {:.5} measured {:.5} ± {:.5} ratio {ratio:.4} z {z:+.2}",
                p.all.value, p.all.std_error, m.all.value, m.all.std_error
            );
            assert!((m.rays.value / p.rays.value - 1.0).abs() < 0.01, "{name}, {text}: rays {:?} {:?}", m.rays, p.rays);
            errors.push((ratio - 1.0).abs());
            largest = largest.max(z.abs());
        }
        errors.sort_by(f64::total_cmp);
        let median = errors[errors.len() / 2];
        eprintln!(
            "{name}: median error {:.2} %, largest |z| {largest:.2}; {beyond} of {all} parts beyond 3 σ",
            100.0 * median
        );
        medians.push((median, largest));
    }
    medians
}

/// A few seconds.
#[test]
fn predicted_variances_are_measured() {
    let schedules: Vec<&str> = SCHEDULES.into_iter().step_by(4).collect();
    compare(common::open("predicted_variances_are_measured"), &[("cornell", 16)], &schedules, 1 << 16);
}

#[test]
#[ignore = "nightly: 66 renders"]
fn predicted_variances_are_measured_at_length() {
    let scenes = [("cornell", 32), ("sphere", 32), ("shells", 32)];
    let found = compare(common::open("predicted_variances_are_measured_at_length"), &scenes, &SCHEDULES, 1 << 18);
    assert!(found.iter().all(|f| f.0 < 0.03), "{found:?}");
}

/// The optimum of each scene, found by a pilot, against the lecture's schedule and against albedo roulette, all used as the
/// path tracer uses them: from vertex 0 on. Albedo roulette knows more, because it depends on the path, and may win: it
/// does inside the Cornell box, looking at its floor. On the sphere the two are 2 % apart, too close to prove.
#[test]
#[ignore = "nightly: 16 renders"]
fn the_best_schedule_is_the_most_efficient() {
    let mut account = common::open("the_best_schedule_is_the_most_efficient");
    let level = account.spend(8);
    let mut won = 0;
    // the lecture's variance is infinite in the Cornell box: more samples, for an error bar that means little
    for (name, spp) in [("cornell", 2048), ("sphere", 512), ("shells", 512), ("many-lights", 512)] {
        let (_, scene) = scene(name, 32);
        let settings = Settings { seed: account.seed(), max_bounces: 16, ..Settings::default() };
        let best = roulette::optimal(&scene, &settings, Progress::NONE).unwrap();
        let lecture = Roulette::LECTURE.then(16, roulette::beyond(&scene)).unwrap();
        let schedules = [best.roulette.clone(), lecture, Roulette::Albedo { from: 2 }];
        let measured: Vec<(Noise, u64)> = schedules
            .iter()
            .map(|s| {
                let r: Recorded = roulette::measure(&scene, &settings, s, spp, Progress::NONE).unwrap();
                (Noise::measured(&r), r.replicates())
            })
            .collect();
        let seconds = roulette::seconds_per_path(&scene, &settings, &schedules, 128);
        let work = |i: usize| measured[i].0.all.value * seconds[i];
        let mut beaten = true;
        for (i, rival) in [(1, "lecture"), (2, "albedo")] {
            let (a, b) = (measured[0].0.efficiency, measured[i].0.efficiency);
            let gain = a.value / b.value;
            let error = gain * (a.std_error / a.value).hypot(b.std_error / b.value);
            let t = fredholm::stats::critical(level, measured[0].1 as f64 - 1.0);
            beaten &= gain - t * error > 1.0;
            eprintln!(
                "{name:>12}: {gain:.3} ± {error:.3} times {rival} per ray (t* = {t:.1}), {:.3} per second",
                work(i) / work(0)
            );
        }
        eprintln!(
            "{name:>12}: {} (predicted {:.3} ± {:.3} of lecture)",
            best.roulette, best.gain.value, best.gain.std_error
        );
        won += u32::from(beaten);
    }
    assert!(won >= 3, "the best schedule won on {won} of 4 scenes");
}

// ------------------------------------------------------------------------------------------------ the command

fn fredholm(desk: &std::path::Path, line: &str) -> (i32, String, String) {
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
    let output = command.args(line.split_whitespace()).current_dir(desk).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn the_command_predicts_verifies_and_optimises() {
    let desk = tempfile::TempDir::new().unwrap();
    let line = "roulette sphere --size 16x16 --spp 64 --max-bounces 6 --schedules none,table:0,0.2,0.1,albedo --verify --optimise -o out";
    let (code, out, err) = fredholm(desk.path(), line);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.lines().all(|l| l.starts_with("fredholm ") || l.chars().count() <= 100), "{out}");
    for word in ["table:0,0.2,0.1", "measured", "times that of lecture per ray", "times that of albedo per ray"] {
        assert!(out.contains(word), "{word}: {out}");
    }
    let folder = desk.path().join("out");
    let csv = std::fs::read_to_string(folder.join("roulette.csv")).unwrap();
    // five schedules of seven terms, tail and all
    assert_eq!(csv.lines().count(), 1 + 5 * 9);
    let summary = fredholm::report::text::summary::read(&folder.join("summary.json")).unwrap();
    let moments = summary.cross_moments.unwrap();
    assert_eq!(moments["slots"].as_array().unwrap().len(), 14);
    assert_eq!(moments["slots"][13]["kind"], "tail");
    assert_eq!(moments["second"][2][13].as_array().unwrap().len(), 14);
    assert!(summary.files.iter().all(|f| folder.join(f).exists()));
    let (code, _, err) = fredholm(desk.path(), "roulette sphere --schedules half");
    assert!(code == 2 && err.contains("unknown roulette `half`") && err.contains("help:"), "{err}");
}

#[test]
fn the_best_schedule_can_be_asked_for_wherever_there_is_roulette() {
    let desk = tempfile::TempDir::new().unwrap();
    let common = "--size 16x16 --spp 64 --max-bounces 3 -q";
    let (code, out, err) = fredholm(
        desk.path(),
        &format!("sweep sphere --over roulette --schedules lecture,albedo,optimal {common} -o a"),
    );
    assert!(code == 0 && out.contains("optimal") && err.contains("optimal is table:"), "{out}{err}");
    let (code, out, err) = fredholm(desk.path(), &format!("render sphere --roulette optimal {common} -o b"));
    assert!(code == 0 && out.contains("roulette: path tracer table:"), "{out}{err}");
    let (code, _, err) = fredholm(desk.path(), &format!("series sphere --worlds terms {common} -o c"));
    assert_eq!(code, 0, "{err}");
    let summary = fredholm::report::text::summary::read(&desk.path().join("c/summary.json")).unwrap();
    let moments = summary.cross_moments.unwrap();
    // two samples per pixel of 64; the moments of what is seen directly are those of the image
    assert_eq!((moments["paths"].as_u64(), moments["max_bounces"].as_u64()), (Some(512), Some(3)));
    // the eye is a slot of its own: its ray is the only one before vertex 1 but for a connection
    assert_eq!(moments["rays"][0], 1.0);
}
