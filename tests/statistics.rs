//! The statistics keep their promises: false alarms, power and error bars, measured on simulated data.
#![allow(clippy::unwrap_used)]

mod common;

use common::random::cases;
use common::{Noise, assert_rate, assert_rate_at_most, open};
use fredholm::stats::{
    Comparison, Criterion, Measured, Moments, Outcome, TermMeans, compare, critical, difference, estimate,
    min_detectable, needed_samples, observed_rate, two_sided_p, variance_slope,
};
use fredholm::terms::{Cost, Estimate, Functional, Series, World};
use glam::DVec3;
use proptest::prelude::*;

/// How the estimates of one simulated result scatter.
#[derive(Clone, Copy)]
struct Design {
    /// Relative standard error; 0 is exact.
    cv: f64,
    replicates: u64,
    /// Correlation between all estimates of one result, as prefix reuse makes it.
    correlation: f64,
}

/// Terms ½^k in the image mean and in four regions: 5 functionals × (3 terms, tail, sum, total) × 3 channels.
fn simulated(rng: &mut Noise, design: Design, truth: impl Fn(usize, usize) -> f64) -> Series {
    let Design { cv, replicates, correlation } = design;
    let shared = rng.normal() * correlation.sqrt();
    let mut measured = |mean: f64| {
        if cv == 0.0 {
            return Estimate::exact(DVec3::splat(mean));
        }
        let mut e = Estimate { mean: DVec3::ZERO, std_error: DVec3::ZERO, replicates, events: None };
        for c in 0..3 {
            let chi: f64 = (1..replicates).map(|_| rng.normal().powi(2)).sum();
            e.mean[c] = mean * (1.0 + cv * (shared + (1.0 - correlation).sqrt() * rng.normal()));
            e.std_error[c] = mean * cv * (chi / (replicates - 1) as f64).sqrt();
        }
        e
    };
    let functionals = (0..5)
        .map(|f| Functional {
            name: if f == 0 { "image".into() } else { format!("region {f}") },
            terms: (0..3).map(|k| measured(truth(f, k))).collect(),
            tail: measured(0.25),
            sum: measured(1.75),
            total: measured(2.0),
        })
        .collect();
    Series {
        world: World::Terms,
        label: "simulated".into(),
        functionals,
        cost: Cost::default(),
        unsampled: vec![],
        doubts: vec![],
        undecided: None,
        variance: Default::default(),
    }
}

fn null(_functional: usize, k: usize) -> f64 {
    0.5f64.powi(k as i32)
}

fn compare_at(alpha: f64, a: &Series, b: &Series) -> Comparison {
    compare(a, b, &Criterion { alpha, ..Criterion::default() }, &[])
}

#[test]
fn null_families_are_rejected_at_alpha() {
    let mut account = open("null_families_are_rejected_at_alpha");
    let mut rng = Noise(account.seed());
    let sampled = |replicates| Design { cv: 0.01, replicates, correlation: 0.0 };
    let exact = Design { cv: 0.0, replicates: 0, correlation: 0.0 };
    let tied = Design { correlation: 0.9, ..sampled(16) };
    let mut alarms = |alpha, a, b| {
        let differs = |rng: &mut Noise| {
            let (a, b) = (simulated(rng, a, null), simulated(rng, b, null));
            compare_at(alpha, &a, &b).outcome == Outcome::Differs
        };
        (0..2000).filter(|_| differs(&mut rng)).count() as u64
    };
    let welch = [alarms(0.05, sampled(16), sampled(16)), alarms(1e-3, sampled(16), sampled(8))];
    let student = alarms(0.05, sampled(16), exact);
    let correlated = alarms(0.05, tied, exact);
    assert_rate_at_most(&mut account, "Welch, 5 %", welch[0], 2000, 0.05);
    assert_rate_at_most(&mut account, "Welch, unequal replicates, 0.1 %", welch[1], 2000, 1e-3);
    assert_rate_at_most(&mut account, "correlated, 5 %", correlated, 2000, 0.05);
    // independent and exact in law: Holm's first step is the only one that counts, and the level is used up
    assert_rate(&mut account, "Student, 5 %", student, 2000, 1.0 - (1.0 - 0.05f64 / 90.0).powi(90));
}

#[test]
fn true_effects_do_not_raise_false_alarms_elsewhere() {
    let mut account = open("true_effects_do_not_raise_false_alarms_elsewhere");
    let mut rng = Noise(account.seed());
    let design = Design { cv: 0.005, replicates: 16, correlation: 0.0 };
    let alarms = (0..2000).filter(|_| {
        let a = simulated(&mut rng, design, null);
        let b = simulated(&mut rng, design, |f, k| null(f, k) * if k == 1 { 1.2 } else { 1.0 });
        let rows = compare_at(0.05, &a, &b).rows;
        assert_eq!(rows[1].outcome, Outcome::Differs);
        rows.iter().any(|r| r.name != "T1" && r.outcome == Outcome::Differs)
    });
    let alarms = alarms.count() as u64;
    assert_rate_at_most(&mut account, "false rejections", alarms, 2000, 0.05);
}

#[test]
fn p_values_are_uniform_without_an_effect() {
    let mut account = open("p_values_are_uniform_without_an_effect");
    let mut rng = Noise(account.seed());
    for replicates in [4, 16] {
        let p: Vec<f64> = (0..50_000)
            .map(|_| {
                let draws: Vec<DVec3> = (0..replicates).map(|_| DVec3::splat(3.0 + rng.normal())).collect();
                let d = difference(Measured::of(&estimate(&draws), 0), Measured::exact(3.0));
                two_sided_p(d.mean / d.std_error, d.dof)
            })
            .collect();
        for level in [0.001, 0.01, 0.1, 0.5] {
            let hits = p.iter().filter(|p| **p <= level).count() as u64;
            assert_rate(&mut account, &format!("p ≤ {level}, {replicates} replicates"), hits, 50_000, level);
        }
    }
}

/// 3 % in one term at a standard error of 0.3 % of the difference: ten standard errors against a critical value of 5.
#[test]
fn a_shift_of_three_percent_is_found() {
    let mut account = open("a_shift_of_three_percent_is_found");
    let mut rng = Noise(account.seed());
    let design = Design { cv: 0.003 / 2f64.sqrt(), replicates: 256, correlation: 0.0 };
    let found = (0..200).filter(|_| {
        let a = simulated(&mut rng, design, null);
        let b = simulated(&mut rng, design, |f, k| null(f, k) * if k == 2 { 1.03 } else { 1.0 });
        let row = &compare_at(1e-3, &a, &b).rows[2];
        row.name == "T2" && row.outcome == Outcome::Differs
    });
    let missed = 200 - found.count() as u64;
    // 15 scalars would all have to stay below their critical value
    assert_rate_at_most(&mut account, "missed", missed, 200, 1e-9);
}

#[test]
fn the_planned_power_is_reached() {
    let mut account = open("the_planned_power_is_reached");
    let mut rng = Noise(account.seed());
    let (alpha, beta, trials) = (1e-3, 0.1, 20_000);

    // n from the plan, then the mean of n samples of mean 1 + δ
    let (cv, delta) = (2.0, 0.05);
    let n = needed_samples(cv, delta, alpha, beta);
    let z = critical(alpha, f64::INFINITY);
    let missed =
        (0..trials).filter(|_| (delta + cv / n.sqrt() * rng.normal()).abs() <= z * cv / n.sqrt()).count() as u64;
    assert_rate(&mut account, "missed with n samples", missed, trials, beta);

    // 256 replicates: an effect of the size that was called detectable. The noise of s adds to that of the mean: β = 0.1
    // becomes P(Z > z_β / √(1 + t²/2ν)) at first order
    let dof: f64 = 255.0;
    let effect = min_detectable(1.0, dof, alpha, beta);
    let t = critical(alpha, dof);
    let missed = (0..trials).filter(|_| {
        let s = ((0..255).map(|_| rng.normal().powi(2)).sum::<f64>() / dof).sqrt();
        (effect + rng.normal()).abs() <= t * s
    });
    let missed = missed.count() as u64;
    let z_beta = critical(2.0 * beta, f64::INFINITY) / (1.0 + t * t / (2.0 * dof)).sqrt();
    assert_rate(&mut account, "missed at min_detectable", missed, trials, 0.5 * two_sided_p(z_beta, f64::INFINITY));
}

/// Variance over trials against the variance that was claimed: their ratio has relative error √(2/n) if the estimates
/// are normal.
fn assert_variance(account: &mut common::Account, what: &str, values: &[f64], claimed: f64) {
    let mut m = Moments::new(1);
    values.iter().for_each(|v| m.push(&[*v]));
    let z = (m.variance(0) / claimed - 1.0) / (2.0 / values.len() as f64).sqrt();
    let limit = critical(account.spend(1), f64::INFINITY);
    assert!(z.abs() < limit, "{what}: variance {:e}, claimed {claimed:e}, z = {z:.1}", m.variance(0));
}

/// Terms 0.7^k with 3 % noise that passes from term to term, as along the prefix of a path.
#[test]
fn rates_have_the_error_they_claim() {
    let mut account = open("rates_have_the_error_they_claim");
    let mut rng = Noise(account.seed());
    let trials = 4000;
    for replicates in [16u64, 64] {
        let sd = 0.01 * (replicates as f64).sqrt(); // of one replicate: 1 % in the mean
        let mut claimed = Moments::new(1);
        let (mut rates, mut misfits) = (Vec::new(), 0);
        for _ in 0..trials {
            let mut terms = Moments::new(8);
            for _ in 0..replicates {
                let mut x = rng.normal();
                let one: Vec<f64> = (0..8)
                    .map(|k| {
                        x = 0.8 * x + 0.6 * rng.normal();
                        0.7f64.powi(k) * (1.0 + sd * x)
                    })
                    .collect();
                terms.push(&one);
            }
            let fit = observed_rate(&TermMeans::from(&terms)).unwrap();
            assert_eq!(fit.window, 4..8);
            rates.push(fit.rate);
            claimed.push(&[fit.std_error * fit.std_error]);
            misfits += u64::from(fit.p <= 0.05);
        }
        let mean = rates.iter().sum::<f64>() / f64::from(trials);
        assert!((mean - 0.7).abs() < 2e-4, "first-order bias of the logarithm: {mean}");
        assert_variance(&mut account, &format!("rate, {replicates} replicates"), &rates, claimed.mean()[0]);
        assert_rate(&mut account, &format!("misfit, {replicates} replicates"), misfits, trials as u64, 0.05);
    }
}

/// Running means of independent samples at n = 1, 2, 4, … 64 in 16 replicates.
#[test]
fn variance_slopes_have_the_error_they_claim() {
    let mut account = open("variance_slopes_have_the_error_they_claim");
    let mut rng = Noise(account.seed());
    let (mut slopes, mut claimed, mut misfits) = (Vec::new(), 0.0, 0);
    for _ in 0..3000 {
        let mut at: Vec<Moments> = vec![Moments::new(1); 7];
        for _ in 0..16 {
            let mut sum = 0.0;
            for i in 1..=64u32 {
                sum += rng.normal();
                if i.is_power_of_two() {
                    at[i.trailing_zeros() as usize].push(&[sum / f64::from(i)]);
                }
            }
        }
        let points: Vec<(f64, f64)> = (0..7).map(|i| (f64::from(1 << i), at[i].variance(0))).collect();
        let fit = variance_slope(&points, 15.0).unwrap();
        slopes.push(fit.slope);
        claimed = fit.std_error * fit.std_error;
        misfits += u64::from(fit.p <= 0.01);
    }
    let mean = slopes.iter().sum::<f64>() / 3000.0;
    let z = (mean + 1.0) / (claimed / 3000.0).sqrt();
    assert!(z.abs() < critical(account.spend(1), f64::INFINITY), "mean slope {mean}, z = {z:.1}");
    assert_variance(&mut account, "slope", &slopes, claimed);
    // ln χ² is skew, so the misfit is not quite χ²; it must still be of that size
    assert!(misfits < 150, "{misfits} of 3000 misfits at 1 %");
}

proptest! {
    #![proptest_config(cases(256))]

    /// Replicates may come in any order and in any parts: the moments are the same, to rounding.
    #[test]
    fn moments_do_not_depend_on_order_and_split(
        rows in prop::collection::vec(prop::array::uniform3(-5.0..5.0f64), 2..60),
        cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..6),
        seed in any::<u64>(),
        offset in prop_oneof![Just(0.0), Just(1e5)],
    ) {
        let rows: Vec<[f64; 3]> = rows.into_iter().map(|r| r.map(|x| x + offset)).collect();
        let whole = |rows: &[[f64; 3]]| {
            let mut m = Moments::new(3);
            rows.iter().for_each(|r| m.push(r));
            m
        };
        let reference = whole(&rows);
        // shuffled (Fisher and Yates), cut, and the parts merged in a random order
        let mut rng = Noise(seed);
        let mut shuffled = rows.clone();
        (1..shuffled.len()).rev().for_each(|i| shuffled.swap(i, (rng.uniform() * (i + 1) as f64) as usize));
        let mut at: Vec<usize> = cuts.iter().map(|c| c.index(rows.len() + 1)).collect();
        at.extend([0, rows.len()]);
        at.sort_unstable();
        let mut parts: Vec<Moments> = at.windows(2).map(|w| whole(&shuffled[w[0]..w[1]])).collect();
        let mut merged = Moments::new(3);
        while !parts.is_empty() {
            let i = (rng.uniform() * parts.len() as f64) as usize;
            merged.merge(&parts.swap_remove(i));
        }
        prop_assert_eq!(merged.count(), rows.len() as u64);
        for a in 0..3 {
            prop_assert!((merged.mean()[a] - reference.mean()[a]).abs() < 1e-12 * (5.0 + offset));
            for b in 0..3 {
                let (x, y) = (merged.covariance()[(a, b)], reference.covariance()[(a, b)]);
                prop_assert!((x - y).abs() < 1e-13 * (25.0 + 10.0 * offset), "{} {}", x, y);
            }
        }
        let rgb = |rows: &[[f64; 3]]| rows.iter().map(|r| DVec3::from(*r)).collect::<Vec<_>>();
        let (e, f) = (estimate(&rgb(&rows)), estimate(&rgb(&shuffled)));
        prop_assert!((e.mean - f.mean).abs().max_element() < 1e-12 * (5.0 + offset));
        prop_assert!((e.std_error - f.std_error).abs().max_element() < 1e-10 * (5.0 + offset));
    }
}
