//! `⟨W, T^k E⟩ = ⟨(T*)^k W, E⟩`: in the matrix world to rounding, and by estimators that walk from the light.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::{
    Noise,
    judge::{Jury, at},
};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, LightTracer, Plan, Roulette, Technique, TermEstimator};
use fredholm::math::{Key, Rgb};
use fredholm::operator::{MatrixWalk, matrix_walk::Rows};
use fredholm::progress::Progress;
use glam::DVec3;

const K: usize = 5;

/// A random substochastic matrix, with zeros, coloured albedos and a few emitters.
fn matrix(n: usize, seed: u64) -> MatrixWalk {
    let mut noise = Noise(seed);
    let mut rows = vec![];
    for _ in 0..n {
        let row: Vec<f64> = (0..n).map(|_| if noise.uniform() < 0.3 { 0.0 } else { noise.uniform() }).collect();
        let scale = (0.6 + 0.4 * noise.uniform()) / row.iter().sum::<f64>().max(1e-9);
        rows.extend(row.iter().map(|x| x * scale));
    }
    let mut colour = |lo: f64, hi: f64| {
        DVec3::new(noise.uniform(), noise.uniform(), noise.uniform()).map(|u| lo + (hi - lo) * u).as_vec3()
    };
    let rho = (0..n).map(|_| colour(0.2, 0.9)).collect();
    let emission = (0..n).map(|i| if i % 3 == 0 { colour(0.5, 2.0) } else { Rgb::ZERO }).collect();
    MatrixWalk::new(rows, rho, emission)
}

#[test]
fn an_importance_walked_back_meets_the_light() {
    for seed in 0..20 {
        let (n, t) = (7, matrix(7, seed));
        let mut noise = Noise(seed ^ 99);
        let w: Vec<DVec3> = (0..n).map(|_| DVec3::splat(noise.uniform())).collect();
        let e = t.powers(8);
        let back = t.adjoint_powers(&w, 8);
        for k in 0..=8 {
            let forward: DVec3 = (0..n).map(|i| w[i] * e[k][i]).sum();
            // any split of the k applications between the two sides
            for s in 0..=k {
                let split: DVec3 = (0..n).map(|i| back[s][i] * e[k - s][i]).sum();
                assert!((forward - split).abs().max_element() < 1e-12 * forward.max_element(), "{k} {s}");
            }
        }
    }
}

fn compare(mut jury: Jury, t: &MatrixWalk, n: u32, estimator: &impl TermEstimator<MatrixWalk>, spp: u32, power: f64) {
    let key = Key::new(jury.seed(), "adjoint");
    let amount = Amount { spp, replicates: 256, key };
    let film = render(t, &Rows(n), estimator, amount, Progress::NONE);
    let exact = t.powers(200);
    assert_eq!(film.non_finite, 0);
    for k in 0..=K + 1 {
        for i in 0..n as usize {
            let truth: DVec3 = if k <= K { exact[k][i] } else { exact[K + 1..].iter().map(|e| e[i]).sum() };
            let whole = exact.iter().map(|e| e[i]).sum();
            jury.part(&format!("k {k} row {i}"), &at(&film, i, k..k + 1), truth, whole);
        }
    }
    jury.assert_power(power, 0.0);
}

fn plan(technique: Technique) -> Plan {
    Plan { max_bounces: K, technique, roulette: Roulette::Albedo { from: 0 }.after(K) }
}

#[test]
fn light_tracing_matches_matrix_powers() {
    compare(
        Jury::open("light_tracing_matches_matrix_powers"),
        &matrix(6, 5),
        6,
        &LightTracer(plan(Technique::Mis)),
        1 << 21,
        0.5,
    );
}

#[test]
fn bidirectional_matches_matrix_powers() {
    compare(
        Jury::open("bidirectional_matches_matrix_powers"),
        &matrix(6, 5),
        6,
        &Bidirectional(plan(Technique::Mis)),
        1 << 17,
        0.1,
    );
}

/// Beyond K the eye's walks go on alone, with connections whatever the technique: they must find what no ray hits.
#[test]
fn the_tail_of_walks_from_both_ends_does_not_depend_on_the_technique() {
    let t = matrix(6, 5);
    let film = |technique| {
        let amount = Amount { spp: 64, replicates: 16, key: Key::new(1, "tail") };
        render(&t, &Rows(6), &Bidirectional(plan(technique)), amount, Progress::NONE)
    };
    let [mis, scatter, connect] = [Technique::Mis, Technique::Scatter, Technique::Connect].map(film);
    for i in 0..6 {
        let tail = mis.pixel(i, K + 1..K + 2);
        assert!(tail.0.min_element() > 0.0);
        assert_eq!((scatter.pixel(i, K + 1..K + 2), connect.pixel(i, K + 1..K + 2)), (tail, tail));
    }
}
