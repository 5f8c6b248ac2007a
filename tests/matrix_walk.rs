//! The heart: every estimator, walking on a matrix, against the powers of that matrix.
//!
//! On a [`MatrixWalk`] `T^k E` is known to rounding, with no discretisation and no geometry in between, and the estimators
//! are the very ones that render scenes. Compared are all rows one by one and their mean, for k = 0..=8, the tail and the
//! total (against the resolvent `(I − T)⁻¹ E`), for
//! single, prefix, path tracer × scatter, connect, MIS × six roulette schedules.
//!
//! **Power.** 12 000 comparisons of the largest test share 5·10⁻⁹, so t* ≈ 7.6 at 255 degrees of freedom. A value of
//! coefficient of variation cv is proved within 1 % (and an error of 1 % is missed as rarely as a false alarm is raised)
//! from n = (2 t* cv/0.01)² ≈ 2·10⁶ cv² samples on, and an error of half the value is seen from 900 cv² samples on. The
//! mean over rows has 2¹⁹ samples here (2¹⁸ on small matrices, a quarter for single): 1 % for cv ≤ 0.5, which are the low
//! terms, and 50 % up to cv = 24. A row by itself has an eighth of that; what is then too noisy to judge is counted, and
//! limited. The nightly run has 32 times as many samples.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::{Judged, Jury, at};
use common::sampling::{Kind, TECHNIQUES, collect, film, mean_of, plan};
use common::{Noise, truth};
use fredholm::estimator::{Prefix, Roulette, Technique};
use fredholm::math::{Key, Rgb};
use fredholm::operator::MatrixWalk;
use fredholm::operator::matrix_walk::Rows;
use fredholm::terms::Estimate;
use fredholm::terms::functional::image_replicates;
use glam::DVec3;
use nalgebra::{DMatrix, DVector};

/// K: terms k = 0..=K, then the tail.
const K: usize = 8;

/// T = diag(ρ) F and E, with a copy for the algebra.
struct Matrix {
    walk: MatrixWalk,
    f: DMatrix<f64>,
    rho: Vec<Rgb>,
    emission: Vec<Rgb>,
}

impl Matrix {
    fn new(rows: &[Vec<f64>], rho: Vec<Rgb>, emission: Vec<Rgb>) -> Self {
        let n = rho.len();
        let f = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
        Self { walk: MatrixWalk::new(rows.concat(), rho.clone(), emission.clone()), f, rho, emission }
    }

    fn n(&self) -> usize {
        self.rho.len()
    }

    /// diag(g(ρ)) F of one channel.
    fn weighted(&self, channel: usize, g: impl Fn(f64) -> f64) -> DMatrix<f64> {
        let n = self.n();
        DMatrix::from_fn(n, n, |i, j| g(f64::from(self.rho[i][channel])) * self.f[(i, j)])
    }

    /// (I − T)⁻¹ E.
    fn solution(&self) -> Vec<DVec3> {
        let mut all = vec![DVec3::ZERO; self.n()];
        for c in 0..3 {
            let e = DVector::from_fn(self.n(), |i, _| f64::from(self.emission[i][c]));
            let system = DMatrix::identity(self.n(), self.n()) - self.weighted(c, |r| r);
            let x = system.lu().solve(&e).unwrap();
            all.iter_mut().zip(x.iter()).for_each(|(a, x)| a[c] = *x);
        }
        all
    }

    /// Whether everything beyond K has a finite fourth moment with this schedule, so that its measured error can be
    /// trusted: r(diag(ρ⁴/s³) F) < 1 for constant survival s. The schedules that follow albedo or throughput keep all
    /// weights below 1.
    fn trusts(&self, roulette: &Roulette) -> bool {
        let s: f64 = match roulette {
            Roulette::Constant { q, .. } => 1.0 - q,
            Roulette::Table(q) => 1.0 - q.last().unwrap(),
            _ => return true,
        };
        let radius = |c| {
            let eigenvalues = self.weighted(c, |r| r.powi(4) / s.powi(3)).complex_eigenvalues();
            eigenvalues.iter().map(|l| l.re.hypot(l.im)).fold(0.0, f64::max)
        };
        (0..3).all(|c| radius(c) < 0.95)
    }
}

fn schedules() -> [Roulette; 6] {
    ["none", "lecture", "constant:0.2@0", "table:0,0.1,0.3,0.2", "albedo@1", "throughput@1"].map(|s| s.parse().unwrap())
}

/// What a film's slots stand for: the terms, the tail, the total.
fn quantities(kind: Kind) -> Vec<(String, std::ops::Range<usize>)> {
    if kind == Kind::Path {
        return vec![("total".into(), 0..1)];
    }
    let mut all: Vec<_> = (0..=K).map(|k| (format!("T{k}"), k..k + 1)).collect();
    all.extend([("tail".into(), K + 1..K + 2), ("total".into(), 0..K + 2)]);
    all
}

/// Every estimator × technique × schedule, 2^`log2_paths` paths over all rows (a quarter for single, which takes four times
/// as long).
fn check(mut jury: Jury, matrix: &Matrix, log2_paths: u32, least_equivalent: f64, most_too_noisy: f64) {
    let n = matrix.n();
    let (powers, solution) = (matrix.walk.powers(K), matrix.solution());
    let partial: Vec<DVec3> = (0..n).map(|i| powers.iter().map(|t| t[i]).sum()).collect();
    let mut stream = 0;
    for kind in [Kind::Prefix, Kind::Single, Kind::Path] {
        for technique in TECHNIQUES {
            for roulette in schedules() {
                let ends = roulette.ends();
                let exact = |what: &str, k: usize, row: usize| match what {
                    "tail" if ends => solution[row] - partial[row],
                    "tail" => DVec3::ZERO,
                    "total" if ends => solution[row],
                    "total" => partial[row],
                    _ => powers[k][row],
                };
                let log2 = log2_paths - if kind == Kind::Single { 2 } else { 0 };
                stream += 1;
                let key = Key::new(jury.seed(), "walk").branch(stream);
                let spp = (1 << log2) / n as u32;
                let film = film(&matrix.walk, &Rows(n as u32), kind, &plan(K, technique, &roulette), spp, key);
                assert_eq!(film.non_finite, 0);
                let mean = image_replicates(&film);
                for (what, slots) in quantities(kind) {
                    if matches!(what.as_str(), "tail" | "total") && !matrix.trusts(&roulette) {
                        continue;
                    }
                    let label = format!("{kind:?}, {technique}, {roulette}, {what}");
                    for (row, &whole) in solution.iter().enumerate() {
                        let truth = exact(&what, slots.start, row);
                        let e = at(&film, row, slots.clone());
                        jury.part(&format!("{label}, row {row}"), &e, truth, whole);
                    }
                    // the mean over rows must be judged, whatever the noise of single rows
                    let average = |x: &dyn Fn(usize) -> DVec3| (0..n).map(x).sum::<DVec3>() / n as f64;
                    let (truth, whole) = (average(&|i| exact(&what, slots.start, i)), average(&|i| solution[i]));
                    let (e, delta) = (mean.estimate(slots), 0.01 * truth + 1e-4 * whole);
                    let judged = jury.judge(&format!("{label}, mean"), &e, truth, delta, 0.5 * truth + 0.005 * whole);
                    assert_ne!(judged, Judged::TooNoisy, "{label}: {e:?}, truth {truth}");
                }
            }
        }
    }
    jury.assert_power(least_equivalent, most_too_noisy);
}

/// Eight rows whose sums are below 1, all albedos different in every channel and at most 0.58, so that the fourth moments
/// of all schedules are finite; five rows emit.
fn substochastic() -> Matrix {
    let mut noise = Noise(8);
    let rows: Vec<Vec<f64>> = (0..8)
        .map(|_| {
            let row: Vec<f64> = (0..8).map(|_| noise.uniform()).collect();
            let scale = (0.8 + 0.19 * noise.uniform()) / row.iter().sum::<f64>();
            row.iter().map(|f| f * scale).collect()
        })
        .collect();
    let mut colour = |lo: f64, hi: f64| DVec3::from_array([(); 3].map(|()| lo + (hi - lo) * noise.uniform())).as_vec3();
    let rho = (0..8).map(|_| colour(0.25, 0.58)).collect();
    let emission = (0..8).map(|i| if i % 3 == 1 { Rgb::ZERO } else { colour(0.2, 1.0) }).collect();
    Matrix::new(&rows, rho, emission)
}

/// The 2 × 2 cases of the truth file, one per channel; they share F.
fn two_surfaces(ids: [&str; 3]) -> Matrix {
    let cases = ids.map(|id| truth::case("two_surface", id));
    let of = |key: &str, i: usize| DVec3::from_array([0, 1, 2].map(|c: usize| cases[c].list(key)[i])).as_vec3();
    Matrix::new(&cases[0].table("F"), vec![of("rho", 0), of("rho", 1)], vec![of("E", 0), of("E", 1)])
}

/// One row reflects nothing, one row lets everything escape, one shines without reflecting.
fn absorbing() -> Matrix {
    let rows =
        [vec![0.5, 0.3, 0.05, 0.15], vec![0.6, 0.2, 0.1, 0.1], vec![0.0, 0.0, 0.0, 0.0], vec![0.4, 0.2, 0.2, 0.2]];
    let rho = vec![Rgb::new(0.55, 0.5, 0.3), Rgb::new(0.4, 0.58, 0.5), Rgb::splat(0.5), Rgb::ZERO];
    Matrix::new(&rows, rho, vec![Rgb::ZERO, Rgb::new(0.5, 1.0, 0.2), Rgb::splat(0.3), Rgb::new(2.0, 1.0, 1.5)])
}

/// Only row 0 emits, and it does not see itself.
fn single_emitter() -> Matrix {
    let rows = [vec![0.0, 0.3, 0.3, 0.4], vec![0.4, 0.1, 0.2, 0.3], vec![0.3, 0.3, 0.1, 0.2], vec![0.5, 0.0, 0.4, 0.1]];
    let rho =
        vec![Rgb::new(0.5, 0.3, 0.58), Rgb::new(0.55, 0.5, 0.4), Rgb::new(0.3, 0.58, 0.5), Rgb::new(0.58, 0.4, 0.45)];
    Matrix::new(&rows, rho, vec![Rgb::new(1.0, 2.0, 3.0), Rgb::ZERO, Rgb::ZERO, Rgb::ZERO])
}

fn plates() -> Matrix {
    two_surfaces(["plates_0.9_0.4", "plates_0.8_0.2", "plates_0.9_0.4"])
}

fn shells() -> Matrix {
    two_surfaces(["concentric_spheres_r0.25"; 3])
}

#[test]
fn powers_are_the_closed_forms() {
    let close = |matrix: &Matrix, ids: [&str; 3]| {
        for (c, id) in ids.iter().enumerate() {
            let case = truth::case("two_surface", id);
            for (k, row) in case.table("terms").iter().enumerate() {
                for (i, truth) in row.iter().enumerate() {
                    let got = matrix.walk.powers(10)[k][i][c];
                    assert!((got - truth).abs() <= 1e-6 * truth, "{id} k = {k}, row {i}: {got} {truth}");
                }
            }
            for (i, truth) in case.list("L").iter().enumerate() {
                assert!((matrix.solution()[i][c] / truth - 1.0).abs() < 1e-6, "{id}");
            }
        }
    };
    close(&plates(), ["plates_0.9_0.4", "plates_0.8_0.2", "plates_0.9_0.4"]);
    close(&shells(), ["concentric_spheres_r0.25"; 3]);
    close(&two_surfaces(["coaxial_cylinders_r0.5"; 3]), ["coaxial_cylinders_r0.5"; 3]);
}

#[test]
fn estimators_match_a_random_substochastic_matrix() {
    check(Jury::open("estimators_match_a_random_substochastic_matrix"), &substochastic(), 19, 0.15, 0.22);
}

#[test]
fn estimators_match_two_plates() {
    check(Jury::open("estimators_match_two_plates"), &plates(), 18, 0.18, 0.05);
}

#[test]
fn estimators_match_concentric_spheres() {
    check(Jury::open("estimators_match_concentric_spheres"), &shells(), 18, 0.25, 0.05);
}

#[test]
fn estimators_match_a_matrix_with_absorbing_rows() {
    check(Jury::open("estimators_match_a_matrix_with_absorbing_rows"), &absorbing(), 18, 0.15, 0.2);
}

#[test]
fn estimators_match_a_matrix_with_a_single_emitter() {
    check(Jury::open("estimators_match_a_matrix_with_a_single_emitter"), &single_emitter(), 18, 0.15, 0.2);
}

#[test]
#[ignore = "nightly: 32 times the samples"]
fn estimators_match_matrices_at_length() {
    check(Jury::open("estimators_match_matrices_at_length"), &substochastic(), 24, 0.5, 0.05);
}

/// The second moment of the scatter estimator with survival s_v has a recursion of its own,
/// `E X_k² = Π_{v<k} diag(ρ²/s_v) F · E²`: the measured variance of every term against it, where moments of order four
/// are finite, as they are for any fixed k.
#[test]
fn variances_follow_the_recursion_of_second_moments() {
    let mut jury = Jury::open("variances_follow_the_recursion_of_second_moments");
    let matrix = single_emitter();
    let n = matrix.n();
    let powers = matrix.walk.powers(4);
    for (stream, (q, schedule)) in
        [([0.0; 4], "none"), ([0.1; 4], "constant:0.1@0"), ([0.0, 0.1, 0.3, 0.2], "table:0,0.1,0.3,0.2")]
            .into_iter()
            .enumerate()
    {
        let estimator = Prefix(plan(4, Technique::Scatter, &schedule.parse().unwrap()));
        let key = Key::new(jury.seed(), "variance").branch(stream as u32);
        let all = collect(&matrix.walk, &Rows(n as u32), &estimator, 1 << 18, 256, key);
        for (k, term) in powers.iter().enumerate().skip(1) {
            for (row, &mean) in term.iter().enumerate() {
                let exact = DVec3::from_array([0, 1, 2].map(|c| {
                    let mut x = DVector::from_fn(n, |i, _| f64::from(matrix.emission[i][c]).powi(2));
                    (0..k).rev().for_each(|v| x = matrix.weighted(c, |r| r * r / (1.0 - q[v])) * &x);
                    x[row] - mean[c].powi(2)
                }));
                let squares = (0..1 << 18).map(|s| (all.path(row as u32, s)[k] - mean).powf(2.0));
                let measured = mean_of(squares.collect::<Vec<_>>().into_iter());
                let what = format!("variance of T{k}, row {row}, {schedule}");
                let judged = jury.judge(&what, &measured, exact, 0.05 * exact, 0.2 * exact);
                assert_ne!(judged, Judged::TooNoisy, "{what}: {measured:?}, exact {exact}");
            }
        }
    }
    jury.assert_power(0.35, 0.0);
}

/// What the comparisons above are worth: with one weight wrong by 2 % every estimator is found out.
#[test]
fn a_small_error_in_the_operator_is_seen() {
    let mut account = common::open("a_small_error_in_the_operator_is_seen");
    let right = single_emitter();
    let mut rho = right.rho.clone();
    rho[3] *= 1.02;
    let wrong = MatrixWalk::new(right.f.transpose().as_slice().to_vec(), rho, right.emission.clone());
    for (stream, technique) in TECHNIQUES.into_iter().enumerate() {
        let key = Key::new(account.seed(), "wrong").branch(stream as u32);
        let plan = plan(K, technique, &Roulette::Never);
        let film = film(&wrong, &Rows(4), Kind::Prefix, &plan, 1 << 18, key);
        let row: Estimate = at(&film, 3, 0..K + 2);
        account.assert_differs(
            &format!("{technique}, total of row 3"),
            &row,
            right.walk.powers(K).iter().map(|t| t[3]).sum(),
        );
    }
}
