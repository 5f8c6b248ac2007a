//! How cost grows: fits that keep their promises, scenes of the size that they say, counts that must not grow, and the figure.
//! No test depends on a time.
#![allow(clippy::unwrap_used)]

mod common;

use common::program::{run, run_tidily};
use common::{Noise, assert_rate_at_most, open};
use fredholm::engine::{Settings, by_rays};
use fredholm::progress::Progress;
use fredholm::report::figures::growth as report;
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::summary;
use fredholm::scene::{Scene, load};
use fredholm::stats::power_law::{Sized, power_law};
use fredholm::stats::{critical, half_width_95};
use fredholm::study::growth::{Growth, Room, Run, Subject, Varied, lamps, measure};
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use tempfile::TempDir;

/// Costs 3 n^1.3 at six sizes, five times each. Every measurement is off by `noise`, and every size by `bend`.
fn simulated(rng: &mut Noise, noise: f64, bend: f64) -> Vec<Sized> {
    let size = |i: i32| {
        let (size, off) = (4f64.powi(i), bend * rng.normal());
        let cost = |rng: &mut Noise| 3.0 * size.powf(1.3) * (off + noise * rng.normal()).exp();
        Sized { size, costs: (0..5).map(|_| cost(rng)).collect() }
    };
    (0..6).map(size).collect()
}

#[test]
fn exponents_have_the_error_they_claim() {
    let mut account = open("exponents_have_the_error_they_claim");
    let mut rng = Noise(account.seed());
    const TRIALS: u64 = 4000;
    for (noise, bend) in [(0.05, 0.0), (0.3, 0.0), (0.02, 0.1), (0.05, 0.03)] {
        let (mut missed, mut last_missed, mut sum, mut square, mut width) = (0, 0, 0.0, 0.0, 0.0);
        for _ in 0..TRIALS {
            let fit = power_law(&simulated(&mut rng, noise, bend)).unwrap();
            let (off, half) = (fit.exponent - 1.3, half_width_95(fit.std_error, fit.dof + 1));
            missed += u64::from(off.abs() > half);
            // between the last two sizes a bend is no error: it is the exponent there
            let half = half_width_95(fit.last[1], fit.dof + 1);
            last_missed += u64::from(bend == 0.0 && (fit.last[0] - 1.3).abs() > half);
            (sum, square, width) = (sum + off, square + off * off, width + half);
        }
        let what = format!("noise {noise}, bend {bend}");
        assert_rate_at_most(&mut account, &what, missed, TRIALS, 0.05);
        assert_rate_at_most(&mut account, &format!("{what}, the last two sizes"), last_missed, TRIALS, 0.05);
        let mean = sum / TRIALS as f64;
        let z = mean / (square / TRIALS as f64 / TRIALS as f64).sqrt();
        assert!(z.abs() < critical(account.spend(1), f64::INFINITY), "{what}: off by {mean} on average, z = {z:.1}");
        // an interval that covers because it is endless would be no use
        assert!(missed > 0 && width / (TRIALS as f64) < 1.0, "{what}");
    }
}

#[test]
fn a_wrong_exponent_is_told_apart() {
    let mut rng = Noise(1);
    let fit = power_law(&simulated(&mut rng, 0.05, 0.0)).unwrap();
    let half = half_width_95(fit.std_error, fit.dof + 1);
    // 1.3 is neither 1 nor 1.5, and 5 % of noise show it
    assert!(fit.exponent - half > 1.2 && fit.exponent + half < 1.4, "{fit:?}");
}

#[test]
fn one_late_measurement_moves_nothing() {
    let exact = |i: i32| Sized { size: 4f64.powi(i), costs: vec![2.0 * 4f64.powi(i); 5] };
    let mut points: Vec<Sized> = (0..5).map(exact).collect();
    assert!((power_law(&points).unwrap().exponent - 1.0).abs() < 1e-12);
    points[3].costs[2] *= 10.0;
    let fit = power_law(&points).unwrap();
    assert!((fit.exponent - 1.0).abs() < 1e-12 && fit.std_error > 0.05, "{fit:?}");
}

#[test]
fn what_has_no_exponent_gives_none() {
    let one = |size: f64, cost: f64| Sized { size, costs: vec![cost] };
    assert!(power_law(&[]).is_none() && power_law(&[one(1.0, 1.0)]).is_none());
    assert!(power_law(&[one(2.0, 1.0), one(2.0, 3.0)]).is_none());
    assert!(power_law(&[one(1.0, 1.0), one(2.0, 0.0)]).is_none());
    assert!(power_law(&[one(1.0, 1.0), Sized { size: 2.0, costs: vec![] }]).is_none());
    // two sizes, measured once: an exponent, and no error of it
    let fit = power_law(&[one(1.0, 1.0), one(2.0, 4.0)]).unwrap();
    assert!((fit.exponent - 2.0).abs() < 1e-12 && half_width_95(fit.std_error, fit.dof + 1).is_nan());
}

/// Every edge of the ball belongs to two triangles, so that it is closed; the numbers of triangles are those that are said.
#[test]
fn rooms_have_their_triangles_and_no_crack() {
    for frequency in [1, 2, 3, 10] {
        let room = Room { frequency };
        let mut text = vec![];
        room.write("room.mtl", &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let lines = |key: &str| text.lines().filter_map(|l| l.strip_prefix(key)).collect::<Vec<_>>();
        let (corners, faces) = (lines("v "), lines("f "));
        assert_eq!(faces.len() as u64, room.triangles());
        assert_eq!(Room::of(room.triangles()), Some(room));
        let mut edges: HashMap<[&str; 2], u32> = HashMap::new();
        for face in &faces[..20 * (frequency * frequency) as usize] {
            let at: Vec<&str> = face.split(' ').map(|i| corners[i.parse::<usize>().unwrap() - 1]).collect();
            for i in 0..3 {
                let mut edge = [at[i], at[(i + 1) % 3]];
                edge.sort_unstable();
                *edges.entry(edge).or_default() += 1;
            }
        }
        assert!(edges.values().all(|n| *n == 2), "{frequency}: {edges:?}");
    }
    assert_eq!(Room { frequency: 1 }.triangles(), 36);
    assert!([0, 16, 35, 37].iter().all(|n| Room::of(*n).is_none()));
}

#[test]
fn lamps_share_one_watt() {
    for n in [1, 2, 10, 100, 1000] {
        let loaded = load::toml(&lamps(n), Path::new("lamps.toml"), &load::Options::default()).unwrap();
        assert!(loaded.warnings.is_empty());
        let lights = Scene::new(&loaded.description).lights;
        let power: f64 = lights.powers().iter().sum();
        assert!(lights.len() as u64 == n && (power - 1.0).abs() < 1e-12, "{n}: {power} W");
    }
}

/// A connection chooses one light, however many there are: rays per path stay the same.
#[test]
fn more_lights_take_no_more_rays() {
    let rays = |n: u64| {
        let loaded = load::toml(&lamps(n), Path::new("lamps.toml"), &load::Options::default()).unwrap();
        let settings = Settings { spp: 16, max_bounces: 4, ..Settings::default() };
        let of =
            by_rays::terms(&Scene::new(&loaded.description), by_rays::Estimator::Prefix, &settings, Progress::NONE);
        of.series.cost.rays as f64 / of.series.cost.paths as f64
    };
    let (few, many) = (rays(4), rays(400));
    assert!(few > 1.0 && (many / few - 1.0).abs() < 0.1, "{few} and {many} rays per path");
}

/// A clock that ticks once per look: every part of every subject is timed, and only while it works.
#[test]
fn every_part_is_timed_once() {
    let folder = TempDir::new().unwrap();
    let mesh = folder.path().join("room.obj");
    Room { frequency: 1 }.write("room.mtl", &mut fs::File::create(&mesh).unwrap()).unwrap();
    fs::write(folder.path().join("room.mtl"), Room::materials()).unwrap();
    for subject in Subject::ALL {
        let ticks = AtomicU64::new(0);
        let clock = || ticks.fetch_add(1, Ordering::Relaxed) as f64;
        let smallest = subject.sizes(true, 2)[0];
        let seconds = measure(subject, smallest, 0, &mesh, &clock).unwrap();
        assert_eq!(seconds.len(), subject.parts().len());
        let by_clock = subject.parts().iter().zip(&seconds).filter(|(p, _)| p.name != "wall clock");
        assert!(by_clock.clone().all(|(_, s)| *s == 1.0), "{subject:?}: {seconds:?}");
        assert_eq!(ticks.into_inner(), 2 * by_clock.count() as u64, "{subject:?}");
    }
}

/// A study whose costs are the promised powers, three times each.
fn promised() -> Growth {
    let mut growth = Growth::new(false, 8);
    for p in &mut growth.points {
        let n = p.size as f64;
        let seconds: Vec<f64> = p.subject.parts().iter().map(|part| 1e-3 * n.powf(part.expected)).collect();
        p.runs = vec![Run { seconds, peak: Some(1000 + 100 * p.size) }; 3];
    }
    growth
}

#[test]
fn every_round_visits_every_point() {
    let growth = promised();
    let all: Vec<usize> = (0..growth.points.len()).collect();
    let rounds = [growth.order(0, 0), growth.order(0, 1), growth.order(1, 0)];
    for round in &rounds {
        let mut sorted = round.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, all);
    }
    assert!(rounds[0] != rounds[1] && rounds[0] != rounds[2] && rounds[0] == growth.order(0, 0));
}

#[test]
fn the_files_hold_every_number() {
    let mut growth = promised();
    let rows = |text: &str| -> Vec<Vec<String>> {
        csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(text.as_bytes())
            .records()
            .map(|r| r.unwrap().iter().map(String::from).collect())
            .collect()
    };
    let runs = rows(&report::csv(&growth));
    assert_eq!(runs[0], ["quantity", "way", "part", "size", "repeat", "seconds", "peak_bytes"]);
    let expected: usize = growth.points.iter().map(|p| 3 * p.subject.parts().len()).sum();
    assert_eq!(runs.len(), 1 + expected);
    let fits = rows(&report::fits_csv(&growth));
    let curves: usize = Subject::ALL.iter().map(|s| s.parts().len() + 1).sum();
    assert_eq!(fits.len(), 1 + curves);
    assert_eq!(fits[0][4..8], ["exponent", "std_error", "dof", "promised"]);
    for row in fits[1..].iter().filter(|r| r[2] != "memory") {
        let [found, promised] = [&row[4], &row[7]].map(|x| x.parse::<f64>().unwrap());
        assert!((found - promised).abs() < 1e-9, "{row:?}");
    }
    assert!(report::too_fast(&growth).is_empty());
    // 100 bytes per unit on top of what does not grow
    assert!(report::memory_table(&growth).rows.iter().all(|r| r[4] == "100 B"), "{}", report::memory_table(&growth));

    // lights that are all looked at would cost as much as there are
    for p in growth.points.iter_mut().filter(|p| p.subject == Subject::Lights) {
        p.runs.iter_mut().for_each(|r| r.seconds[1] = 1e-3 * p.size as f64);
    }
    let fast = report::too_fast(&growth);
    assert!(fast.len() == 1 && fast[0].contains("lights: render"), "{fast:?}");
    assert!(report::answer(&growth).contains("Faster than promised: lights: render"));
}

#[test]
fn the_figure_prints_its_exponents() {
    let caption = Caption { command: "fredholm figure growth".into(), seed: 0, scene: "several".into() };
    let figure = report::draw(&promised(), &caption).unwrap();
    let (shown, curves) =
        (figure.svg.matches("b\u{a0}=\u{a0}").count(), Varied::ALL.map(|v| promised().times(v).len()));
    assert_eq!(shown, curves.iter().sum::<usize>());
    assert!(Varied::ALL.iter().all(|v| figure.svg.contains(v.name())) && figure.svg.contains("fredholm figure growth"));
    assert!(report::draw_memory(&promised(), &caption).unwrap().svg.contains("100\u{a0}B\u{a0}each"));
    // an interrupted study is drawn as far as it came
    // two sizes, each measured once: an exponent, and no error of it
    let mut once = promised();
    once.points.iter_mut().for_each(|p| p.runs.truncate(usize::from(p.size <= 64)));
    let rows = report::table(&once).rows;
    let exponent = |name: &str| rows.iter().find(|r| r[0] == name).map(|r| r[3].clone());
    assert_eq!(exponent("samples per pixel: render").as_deref(), Some("1.000"));
    assert_eq!(exponent("triangles: load").as_deref(), Some("–"));
    let mut begun = promised();
    begun.points.iter_mut().skip(3).for_each(|p| p.runs.clear());
    assert!(report::draw(&begun, &caption).is_ok() && report::table(&begun).rows.len() == 1);
}

#[test]
fn the_command_measures_and_leaves_nothing_behind() {
    let desk = TempDir::new().unwrap();
    let said = run_tidily(desk.path(), "figure growth --quick -q -o g");
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let record = summary::read(&desk.path().join("g/summary.json")).unwrap();
    assert!(record.files.iter().all(|f| desk.path().join("g").join(f).exists()), "{:?}", record.files);
    let runs = fs::read_to_string(desk.path().join("g/growth.csv")).unwrap();
    let threads = std::thread::available_parallelism().unwrap().get();
    let points = Growth::new(true, threads).points;
    let expected: usize = points.iter().map(|p| 2 * p.subject.parts().len()).sum();
    assert_eq!(runs.lines().count(), 1 + expected);
    // what cannot be measured is refused
    for line in ["figure growth --measure x:1:", "figure growth --measure pixels:0:"] {
        assert_eq!(run(desk.path(), line).code, 2, "{line}");
    }
    assert_eq!(run(desk.path(), "figure growth --measure triangles:36:nothing.obj").code, 3);
}
