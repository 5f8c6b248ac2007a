//! Walks on the matrix that are led: by the answer itself they have no variance, by anything else they keep their mean, and their
//! variance is what the recursion of second moments says.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::Noise;
use common::judge::{Judged, Jury, at};
use common::sampling::{collect, mean_of};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Absorption, Plan, Prefix, Roulette, Technique, TermEstimator};
use fredholm::guide::GuidedWalk;
use fredholm::guide::walk::GuidedRows;
use fredholm::math::Key;
use fredholm::operator::form_factor::FormFactors;
use fredholm::operator::matrix::{PatchOperator, Rows};
use fredholm::progress::Progress;
use fredholm::solver::{Neumann, direct};
use fredholm::terms::TermFilm;
use glam::DVec3;
use nalgebra::{DMatrix, DVector};

const N: usize = 9;

/// A random mesh: some pairs do not see each other, some patches shine.
fn mesh(seed: u64) -> (FormFactors, Vec<f64>, Vec<f64>) {
    let mut noise = Noise(seed);
    let mut f = vec![];
    for _ in 0..N {
        let row: Vec<f64> = (0..N).map(|_| if noise.uniform() < 0.3 { 0.0 } else { noise.uniform() }).collect();
        let scale = (0.7 + 0.3 * noise.uniform()) / row.iter().sum::<f64>().max(1e-9);
        f.extend(row.iter().map(|x| (x * scale) as f32));
    }
    let rho = (0..N).map(|_| 0.2 + 0.7 * noise.uniform()).collect();
    let e = (0..N).map(|i| if i % 4 == 0 { 0.5 + noise.uniform() } else { 0.0 }).collect();
    (FormFactors { n: N, f, area: vec![1.0; N], rays: 0 }, rho, e)
}

fn plan(max_bounces: usize) -> Plan {
    Plan { max_bounces, technique: Technique::Scatter, roulette: Roulette::Never }
}

const WHOLE: GuidedRows = GuidedRows { rows: N as u32, left: 0 };

/// A guide that is wrong by up to a factor either way, and nowhere 0.
fn wrong_guide(b: &[f64], factor: f64, seed: u64) -> Vec<f64> {
    let mut noise = Noise(seed);
    b.iter().map(|b| b * factor.powf(2.0 * noise.uniform() - 1.0)).collect()
}

#[test]
fn led_by_the_answer_every_walk_is_the_answer() {
    for seed in 0..10 {
        let (factors, rho, e) = mesh(seed);
        let t = PatchOperator::new(&factors, rho);
        let b = direct::solve(&t, &e).unwrap().x;
        let walk = GuidedWalk::whole(&t, &e, b.clone());
        let all = collect(&walk, &WHOLE, &Absorption(plan(0)), 256, 64, Key::new(seed, "zero variance"));
        for (path, row) in all.paths().zip((0..N).flat_map(|i| [i; 256])) {
            let x: DVec3 = path.iter().sum();
            assert!((x.x / b[row] - 1.0).abs() < 2e-5, "seed {seed}, row {row}: {} {}", x.x, b[row]);
        }
        // and every term by walks of its own
        let powers: Vec<Vec<f64>> = Neumann::new(&t, e.clone()).take(6).collect();
        for k in 1..6 {
            let walk = GuidedWalk::term(&t, &e, powers[..k].to_vec());
            let rows = GuidedRows { rows: N as u32, left: k as u32 };
            let all = collect(&walk, &rows, &Prefix(plan(k)), 64, 64, Key::new(seed, "zero variance, term"));
            for (path, row) in all.paths().zip((0..N).flat_map(|i| [i; 64])) {
                let truth = powers[k][row];
                assert!((path[k].x - truth).abs() <= 1e-5 * truth, "seed {seed}, k = {k}: {} {truth}", path[k].x);
            }
        }
    }
}

fn film(walk: &GuidedWalk, estimator: &impl for<'a> TermEstimator<GuidedWalk<'a>>, spp: u32, key: Key) -> TermFilm {
    let amount = Amount { spp, replicates: 256, key };
    render(walk, &WHOLE, estimator, amount, Progress::NONE)
}

/// Whatever leads a walk, its mean stays.
#[test]
fn any_guide_keeps_the_mean() {
    let mut jury = Jury::open("any_guide_keeps_the_mean");
    for seed in 0..3 {
        let (factors, rho, e) = mesh(seed);
        let t = PatchOperator::new(&factors, rho);
        let b = direct::solve(&t, &e).unwrap().x;
        let powers: Vec<Vec<f64>> = Neumann::new(&t, e.clone()).take(4).collect();
        let walk = GuidedWalk::whole(&t, &e, wrong_guide(&b, 2.0, 77 + seed));
        let key = Key::new(jury.seed(), "guided").branch(seed as u32);
        let film = film(&walk, &Absorption(plan(3)), 1 << 16, key);
        for row in 0..N {
            let whole = DVec3::splat(b[row]);
            for (k, power) in powers.iter().enumerate() {
                jury.part(&format!("T{k}, row {row}"), &at(&film, row, k..k + 1), DVec3::splat(power[row]), whole);
            }
            jury.part(&format!("whole, row {row}"), &at(&film, row, 0..5), whole, whole);
        }
    }
    jury.assert_power(0.1, 0.15);
}

/// `E X² = (I − M)⁻¹ (E²/q)` with `M_ij = T_ij²/((1 − q_i) p_ij)`. The guide is only so wrong that the fourth moment is finite, too:
/// beyond, the measured variance lies.
#[test]
fn led_walks_have_their_variance() {
    let mut jury = Jury::open("led_walks_have_their_variance");
    for seed in 0..3 {
        let (factors, rho, e) = mesh(seed);
        let t = PatchOperator::new(&factors, rho);
        let b = direct::solve(&t, &e).unwrap().x;
        let v = wrong_guide(&b, 1.3, 5 + seed);
        let reach: Vec<f64> = (0..N).map(|i| (0..N).map(|j| t.entry(i, j) * v[j]).sum()).collect();
        let q: Vec<f64> = (0..N).map(|i| if e[i] > 0.0 { e[i] / (e[i] + reach[i]) } else { 0.0 }).collect();
        // T_ij^n/p_ij^{n−1} = T_ij ((T v)_i / v_j)^{n−1}
        let fourth = DMatrix::from_fn(N, N, |i, j| t.entry(i, j) * (reach[i] / (v[j] * (1.0 - q[i]))).powi(3));
        let radius = fourth.complex_eigenvalues().iter().map(|l| l.norm()).fold(0.0, f64::max);
        assert!(radius < 0.9, "seed {seed}: {radius}");
        let m = DMatrix::from_fn(N, N, |i, j| t.entry(i, j) * reach[i] / (v[j] * (1.0 - q[i])));
        let source = DVector::from_fn(N, |i, _| if q[i] > 0.0 { e[i] * e[i] / q[i] } else { 0.0 });
        let second = (DMatrix::identity(N, N) - m).lu().solve(&source).unwrap();
        let walk = GuidedWalk::whole(&t, &e, v);
        let key = Key::new(jury.seed(), "guided variance").branch(seed as u32);
        let samples = 1 << 17;
        let all = collect(&walk, &WHOLE, &Absorption(plan(0)), samples, 256, key);
        for row in 0..N {
            let exact = DVec3::splat(second[row] - b[row] * b[row]);
            let squares: Vec<DVec3> = (0..samples)
                .map(|s| (all.path(row as u32, s).iter().sum::<DVec3>() - DVec3::splat(b[row])).powf(2.0))
                .collect();
            let measured = mean_of(squares.into_iter());
            let judged = jury.judge(&format!("seed {seed}, row {row}"), &measured, exact, 0.05 * exact, 0.5 * exact);
            assert_ne!(judged, Judged::TooNoisy, "{measured:?} {exact}");
        }
    }
    jury.assert_power(0.0, 0.0);
}
