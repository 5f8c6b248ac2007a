//! Acceleration of the series: exact where theory says so, and as noisy as its derivatives say.
#![allow(clippy::unwrap_used)]

mod common;

use common::sampling::{collect, mean_of, plan};
use common::truth;
use fredholm::estimator::{Prefix, Roulette, Technique};
use fredholm::math::{Key, Rgb};
use fredholm::operator::MatrixWalk;
use fredholm::operator::matrix_walk::Rows;
use fredholm::report::figures::extrapolation::Measured;
use fredholm::solver::accelerate::{Accelerated, aitken, known_rate, plain, two_step, wynn};
use glam::DVec3;
use nalgebra::DMatrix;

fn close(what: &str, got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "{what}: {got} instead of {expected}, off by {:e}", got - expected);
}

/// Component 0 of T^k E for k = 0..n.
fn terms_of(t: &[Vec<f64>], e: &[f64], n: usize) -> Vec<f64> {
    let mut x = e.to_vec();
    let mut terms = vec![];
    for _ in 0..n {
        terms.push(x[0]);
        x = t.iter().map(|row| row.iter().zip(&x).map(|(t, x)| t * x).sum()).collect();
    }
    terms
}

#[test]
fn a_two_by_two_matrix_is_summed_exactly_by_wynn() {
    let case = truth::case("acceleration", "acceleration_2x2");
    let terms = terms_of(&case.table("T"), &case.list("E"), 7);
    let sums = case.list("partial_sums");
    (0..7).for_each(|n| close("partial sum", plain(&terms[..=n]).value, sums[n], 1e-13));
    close("Aitken", aitken(&terms[..3]).unwrap().value, case.number("aitken0"), 1e-12);
    close("ε₄", wynn(&terms[..5]).unwrap().value, case.number("eps4"), 1e-12);
    close("ε₄", wynn(&terms[..5]).unwrap().value, case.number("exact"), 1e-12);
    // an even number of terms leaves the first sum out
    close("ε₄ of S₁..S₅", wynn(&terms[..6]).unwrap().value, case.number("exact"), 1e-12);
}

#[test]
fn each_is_exact_for_its_number_of_eigenvalues() {
    let series = |modes: &[(f64, f64)], n: i32| -> (Vec<f64>, f64) {
        let term = |k| modes.iter().map(|(c, l)| c * l.powi(k)).sum();
        ((0..n).map(term).collect(), modes.iter().map(|(c, l)| c / (1.0 - l)).sum())
    };
    // furnace: one eigenvalue
    let (terms, limit) = series(&[(1.0, 0.8)], 2);
    close("Aitken", aitken(&terms).unwrap().value, limit, 1e-14);
    close("known rate", known_rate(&terms, 0.8).unwrap().value, limit, 1e-14);
    // inside of a sphere: geometric from k = 1 on
    close("Aitken", aitken(&[2.0, 0.5, 0.3]).unwrap().value, 2.0 + 0.5 / 0.4, 1e-14);
    // three eigenvalues: seven partial sums
    let (terms, limit) = series(&[(1.0, 0.8), (-0.5, 0.3), (2.0, -0.4)], 7);
    close("ε₆", wynn(&terms).unwrap().value, limit, 1e-10);
    assert!((aitken(&terms).unwrap().value - limit).abs() > 1e-3, "Aitken is not");
    // two plates of which one is lit: Aitken is stuck, two steps at once are exact
    let (terms, limit) = series(&[(0.5, 0.6), (0.5, -0.6)], 5);
    close("Aitken returns S₀", aitken(&terms[..2]).unwrap().value, 1.0, 1e-15);
    assert_eq!(wynn(&[1.0, 0.0, 0.36]), None, "Wynn divides by zero");
    close("two steps", two_step(&terms).unwrap().value, limit, 1e-14);
    close("plates", limit, 1.5625, 1e-15);
}

#[test]
fn derivatives_are_those_of_the_values() {
    let terms = [1.0, 0.7, 0.44, 0.3, 0.2];
    type Method = fn(&[f64]) -> Option<Accelerated>;
    let methods: [(&str, Method); 5] = [
        ("plain", |t| Some(plain(t))),
        ("Aitken", aitken),
        ("two-step", two_step),
        ("known rate", |t| known_rate(t, 0.8)),
        ("Wynn", wynn),
    ];
    for (name, method) in methods {
        let at = method(&terms).unwrap();
        for k in 0..terms.len() {
            let moved = |by: f64| {
                let mut terms = terms;
                terms[k] += by;
                method(&terms).unwrap().value
            };
            let h = 1e-6;
            let slope = (moved(h) - moved(-h)) / (2.0 * h);
            close(&format!("{name}, ∂/∂t{k}"), at.gradient[k], slope, 1e-6 * slope.abs().max(1.0));
        }
    }
    // ε₂ is Aitken, derivatives and all
    let [a, w] = [aitken(&terms[..3]).unwrap(), wynn(&terms[..3]).unwrap()];
    close("ε₂", w.value, a.value, 1e-14);
    a.gradient.iter().zip(&w.gradient).for_each(|(a, w)| close("∇ε₂", *w, *a, 1e-11));
    // at g = 0.8: 25 and −15 for the last two terms; a known rate has 5
    let g = aitken(&[1.0, 0.8]).unwrap().gradient;
    close("∂A/∂t₀", g[0], 1.0 - 0.64 / 0.04, 1e-11);
    close("∂A/∂t₁", g[1], 25.0, 1e-11);
    close("known rate", known_rate(&[1.0, 0.8], 0.8).unwrap().gradient[1], 5.0, 1e-14);
}

/// What a run prints: independent terms and terms of one path, by hand.
#[test]
fn a_measured_series_is_off_by_what_is_left_out() {
    // t = 8, 4, 2 and 2 for the rest, each with an error of 0.1
    let mean = vec![8.0, 4.0, 2.0, 2.0];
    let measured = |covariance| Measured { label: "by hand".into(), mean: mean.clone(), covariance, used: 3 };
    let [plain, aitken, two_step, known, wynn] = measured(DMatrix::from_diagonal_element(4, 4, 0.01)).outcomes(0.5);
    let (plain, aitken, known, wynn) = (plain.unwrap(), aitken.unwrap(), known.unwrap(), wynn.unwrap());
    assert!(two_step.is_none(), "two steps need five terms");
    // the sum leaves the rest out, and nothing else: only the noise of the rest is in it
    close("off", plain.off[0], -2.0 / 16.0, 1e-15);
    close("its error", plain.off[1], 0.1 / 16.0, 1e-15);
    close("noise", plain.noise, 0.03f64.sqrt() / 16.0, 1e-15);
    close("gain", plain.gain, 1.0, 1e-15);
    // known rate: 14 + 2; ∇ = (1, 1, 2), d = (0, 0, 1, −1)
    close("known rate", known.off[0], 0.0, 1e-15);
    close("its error", known.off[1], 0.02f64.sqrt() / 16.0, 1e-15);
    close("its gain", known.gain, 2f64.sqrt(), 1e-14);
    // Aitken: g = ½, ∇ = (1, 0, 4), d = (0, −1, 3, −1)
    close("Aitken", aitken.off[0], 0.0, 1e-15);
    close("its error", aitken.off[1], 0.11f64.sqrt() / 16.0, 1e-15);
    close("its gain", aitken.gain, (17.0f64 / 3.0).sqrt(), 1e-14);
    close("Wynn is Aitken", wynn.gain, aitken.gain, 1e-12);
    // one path whose terms all move together, in proportion: nothing is amplified, and off has no noise
    let together = DMatrix::from_fn(4, 4, |i, j| 1e-4 * mean[i] * mean[j]);
    for method in [0, 1, 3, 4] {
        let o = measured(together.clone()).outcomes(0.5)[method].unwrap();
        close("relative noise", o.noise / (1.0 + o.off[0]), 0.01, 1e-12);
        close("off is off", o.off[1], 0.01 * o.off[0].abs(), 1e-9);
    }
}

/// ∇Aᵀ C ∇A against the variance of A over 8192 groups of paths on a matrix, three albedos at once.
///
/// The squared deviation of a nearly normal A has a relative error of √(2/8192) = 1.6 %, so ± 20 % can be proved at
/// t* ≈ 6.5. The first order holds where the noise of t_n − t_{n+1} is small beside it: a group of 2048 paths makes it
/// about 4 %, and what the second order adds to the variance goes with the square of that.
#[test]
fn accelerated_series_are_as_noisy_as_predicted() {
    const TERMS: usize = 3;
    const GROUPS: usize = 8192;
    const SIZE: usize = 2048;
    let mut account = common::open("accelerated_series_are_as_noisy_as_predicted");
    let rows = [[0.1, 0.5, 0.2, 0.1], [0.4, 0.0, 0.3, 0.2], [0.3, 0.3, 0.1, 0.3], [0.2, 0.2, 0.5, 0.1]];
    let rho = [[0.7, 0.6, 0.4], [0.7, 0.5, 0.3], [0.6, 0.6, 0.2], [0.7, 0.6, 0.5]].map(Rgb::from_array);
    let emission = [[1.0; 3], [0.5; 3], [0.8; 3], [1.5; 3]].map(Rgb::from_array);
    let walk = MatrixWalk::new(rows.concat(), rho.to_vec(), emission.to_vec());
    let exact = walk.powers(TERMS - 1);
    let prefix = Prefix(plan(TERMS - 1, Technique::Scatter, &Roulette::Never));
    let key = Key::new(account.seed(), "groups");
    // a path in each of the four rows is one sample of the mean over rows; SIZE/4 of them are a group
    let group = |g: usize| -> [DVec3; TERMS] {
        let all = collect(&walk, &Rows(4), &prefix, SIZE as u32 / 4, SIZE as u32 / 4, key.branch(g as u32));
        let mut sum = [DVec3::ZERO; TERMS];
        all.paths().for_each(|path| sum.iter_mut().zip(path).for_each(|(s, x)| *s += *x));
        sum.map(|s| s / SIZE as f64)
    };
    let groups: Vec<[DVec3; TERMS]> = (0..GROUPS).map(group).collect();
    type Method = fn(&[f64], f64) -> Option<Accelerated>;
    let methods: [(&str, Method); 4] = [
        ("plain", |t, _| Some(plain(t))),
        ("Aitken", |t, _| aitken(t)),
        ("known rate", known_rate),
        ("Wynn", |t, _| wynn(t)),
    ];
    for (name, method) in methods {
        let mut deviations = vec![DVec3::ZERO; GROUPS];
        let (mut predicted, mut gain) = (DVec3::ZERO, DVec3::ZERO);
        for c in 0..3 {
            let truth: Vec<f64> = exact.iter().map(|t| t.iter().map(|v| v[c]).sum::<f64>() / 4.0).collect();
            let rate = truth[TERMS - 1] / truth[TERMS - 2];
            let at = method(&truth, rate).unwrap();
            let n = at.gradient.len();
            // the covariance of the replicates, as a run of the program has it
            let mean: Vec<f64> = (0..n).map(|k| groups.iter().map(|g| g[k][c]).sum::<f64>() / GROUPS as f64).collect();
            let entry =
                |a: usize, b: usize| groups.iter().map(|g| (g[a][c] - mean[a]) * (g[b][c] - mean[b])).sum::<f64>();
            let covariance = DMatrix::from_fn(n, n, |a, b| entry(a, b) / (GROUPS as f64 - 1.0));
            predicted[c] = at.std_error(&covariance).powi(2);
            gain[c] = at.amplification(&covariance);
            let values: Vec<f64> = groups
                .iter()
                .map(|g| method(&g.iter().map(|t| t[c]).collect::<Vec<_>>(), rate).unwrap().value)
                .collect();
            let centre = values.iter().sum::<f64>() / GROUPS as f64;
            deviations.iter_mut().zip(values).for_each(|(d, v)| d[c] = (v - centre).powi(2));
        }
        let measured = mean_of(deviations.into_iter());
        let what = format!("variance of {name}, amplification {gain:.2}");
        account.assert_equivalent(&what, &measured, predicted, 0.2 * predicted);
        // plain sums are not amplified; every extrapolation is, the more the slower the decay
        let ordered =
            if name == "plain" { (gain - 1.0).abs().max_element() < 1e-12 } else { gain.x > gain.y && gain.y > gain.z };
        assert!(ordered && gain.min_element() > 1.0 - 1e-12, "{what}");
    }
}
