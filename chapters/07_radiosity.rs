//! Chapter 7, radiosity: the same series as a matrix over patches.
//!
//! ```text
//! B = E + ρ F B,   T_h = ρ F      B = Σ T_h^k E      A_i F_ij = A_j F_ji      Σ_j F_ij = 1 in a closed room
//! Jacobi: B ← E + T_h B, after n sweeps Σ_{k≤n} T_h^k E      error ~ r(T_h)^n
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | F_ij | the part of the light leaving patch i that arrives at patch j | `FormFactors`; by rays: [`form_factor`](mod@form_factor) |
//! | T_h, E | diag(ρ) F and emission of one channel, on patches of width h | `PatchOperator`, `Radiosity::emission` |
//! | m_k | mean of the k-th term over all surfaces, by matrix and by paths | [`Measured::matrix`], [`Measured::paths`] |
//! | ‖x‖_w | √Σ A x²/ρ, the norm in which T_h is symmetric | `PatchOperator::weighted_norm` |
//! | λ, u | eigenvalue and mode, T_h u = λ u; the largest λ is r(T_h) | `Modes` |
//!
//! Reference: Cohen, Wallace, *Radiosity and Realistic Image Synthesis* (1993).
//!
//! `fredholm chapter 7`, or `cargo run --release --example 07_radiosity -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::engine::{Settings, by_matrix, by_rays::Estimator};
use fredholm::math::direction::cosine_hemisphere;
use fredholm::operator::matrix::{LinearOperator, PatchOperator};
use fredholm::progress::Progress;
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::report::text::number::{plus_minus, significant};
use fredholm::scene::{Description, Scene, load};
use fredholm::solver::comparison::{History, Limits, Solver, System};
use fredholm::solver::{Iteration, Jacobi, Neumann, PartialSums};
use fredholm::stats::convergence_order;
use fredholm::study::surface;
use std::process::ExitCode;

#[path = "radiosity/figures.rs"]
mod figures;
#[path = "radiosity/form_factor.rs"]
pub mod form_factor;
#[path = "radiosity/mesh.rs"]
mod mesh;
use form_factor::{Direction, exchange};

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 7,
    name: "07_radiosity",
    title: "Radiosity: the same series as a matrix",
    shows: "B = E + ρFB: form factors, powers of the matrix as terms, sweeps, mesh error, modes",
    next: &["fredholm radiosity cornell --modes 8", "fredholm radiosity cornell --solver all", "fredholm chapter 8"],
    program,
};

/// K of the terms that are compared with paths.
const LAST: usize = 6;
const RED: usize = 0;

/// An estimate and its standard error.
pub type Value = (f64, f64);
/// Makes the iteration that is compared with the partial sums.
pub type Sweeps = for<'a> fn(&'a PatchOperator<'a>, &[f64]) -> Box<dyn Iteration + 'a>;

/// All that claims and figures need.
#[derive(Clone)]
pub struct Measured {
    /// The least and the largest row sum of F in the closed cube.
    pub row_sums: [f64; 2],
    /// Their mean over the surfaces of the open Cornell box.
    pub open: f64,
    /// A_i F_ij and A_j F_ji between floor and tall block, by rays.
    pub exchange: [Value; 2],
    /// m_k by paths, and by the matrix on a coarse and a fine mesh.
    pub paths: Vec<Value>,
    /// See `paths`.
    pub matrix: [Vec<f64>; 2],
    /// The largest difference of Jacobi's iterates and the partial sums, relative to the largest radiance.
    pub sweeps_apart: f64,
    /// r(T_h).
    pub radius: f64,
    /// Errors of Jacobi, Gauss–Seidel and conjugate gradients.
    pub histories: Vec<History>,
    /// Widths of the patches of the cube with the errors, and the order p of these errors.
    pub mesh: Vec<(f64, f64)>,
    /// See `mesh`.
    pub order: f64,
    /// Ratios of consecutive terms in ‖·‖_w and in ‖·‖₁.
    pub ratios: [Vec<f64>; 2],
}

// ANCHOR: sweeps
/// The largest difference of an iteration and the partial sums of the series, over `n` sweeps and all patches.
fn apart(t: &PatchOperator<'_>, e: &[f64], mut sweeps: Box<dyn Iteration + '_>, n: usize) -> f64 {
    let mut series = PartialSums::new(t, e);
    let mut largest = 0.0f64;
    for _ in 0..n {
        sweeps.advance();
        series.advance();
        largest = sweeps.iterate().iter().zip(series.iterate()).fold(largest, |d, (x, s)| d.max((x - s).abs()));
    }
    largest / series.iterate().iter().copied().fold(0.0, f64::max)
}
// ANCHOR_END: sweeps

/// Measures everything. `direction` draws the rays of form factors, `sweeps` makes the iteration next to the partial sums.
///
/// # Errors
/// If a scene cannot be loaded or has no matrix, which is a defect of the program.
pub fn measure(quick: bool, seed: u64, direction: Direction, sweeps: Sweeps) -> book::Result<Measured> {
    let load = |name: &str| load::scene(name, &load::Options::default()).map(|s| s.description);
    let matrix = |room: &Description, n| by_matrix::dense_matrix(room, &Scene::new(room), n, 1.0, LAST, Progress::NONE);
    let (room, cube) = (load("cornell")?, load("cube")?);
    let scene = Scene::new(&room);
    let widths = if quick { [100, 400] } else { [300, 1200] };
    let (rays, paths, n) = if quick { (1 << 18, 1 << 19, 2) } else { (1 << 20, 1 << 20, 3) };
    let cubes = [n, 2 * n, 4 * n].map(|n| 6 * n * n); // n × n patches on each wall
    let [coarse, fine] = widths.map(|n| matrix(&room, n));
    let (coarse, fine) = (coarse?, fine?);
    let cubes = cubes.map(|n| matrix(&cube, n)).into_iter().collect::<Result<Vec<_>, _>>()?;

    let settings = Settings { seed, max_bounces: LAST, ..Settings::default() };
    let paths = surface::norms(&scene, Estimator::Prefix, paths, &settings, Progress::NONE);
    let estimate = |k: usize| (paths.mean[k][RED], paths.estimate(k..k + 1).std_error[RED]);

    let (t, e) = (fine.radiosity.operator(RED), fine.radiosity.emission(RED));
    let system = System::new(&t, e.clone())?;
    let limits = Limits { error: 1e-10, applications: 200.0, stopped: &|| false };
    let solvers = [Solver::Jacobi, Solver::GaussSeidel, Solver::ConjugateGradients];
    // ANCHOR: ratios
    let terms: Vec<Vec<f64>> = Neumann::new(&t, e.clone()).take(31).collect();
    let ratios = |norm: &dyn Fn(&[f64]) -> f64| terms.windows(2).map(|x| norm(&x[1]) / norm(&x[0])).collect();
    let weighted = ratios(&|x| t.weighted_norm(x));
    let mean = ratios(&|x| t.inner(&vec![1.0; x.len()], x));
    // ANCHOR_END: ratios
    let mesh: Vec<(f64, f64)> = cubes.iter().map(mesh::error).collect();
    let orders: Vec<_> = mesh.iter().map(|&(h, error)| (h, error, 0.0)).collect();
    let invariants = cubes[2].invariants;
    Ok(Measured {
        row_sums: [invariants.row_sum_min, invariants.row_sum_max],
        open: form_factor::mean_row_sum(&fine.radiosity.factors),
        exchange: exchange(&room, &scene, ["floor", "tall block"], rays, seed, direction),
        paths: (0..=LAST).map(estimate).collect(),
        matrix: [&coarse, &fine].map(|m| m.surface.iter().map(|m| m[RED]).collect()),
        sweeps_apart: apart(&t, &e, sweeps(&t, &e), 30),
        radius: fine.spectral[RED].radius,
        histories: solvers.map(|s| system.history(s, limits)).into(),
        order: convergence_order(&orders).map_or(f64::NAN, |o| o.order),
        mesh,
        ratios: [weighted, mean],
    })
}

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    let value = |(x, s): Value| plus_minus(x, s, 1);
    // two results agree if their difference and three of its standard errors are small
    let apart = |(x, s): Value, (y, t): Value| ((x - y).abs() + 3.0 * s.hypot(t)) / y;
    let rows = m.row_sums.map(|sum| (1.0 - sum).abs()).into_iter().fold(0.0, f64::max);
    let [there, back] = m.exchange;
    let powers = (1..=LAST).map(|k| apart((m.matrix[1][k], 0.0), m.paths[k])).fold(0.0, f64::max);
    let products = |i: usize, error: f64| m.histories[i].reaches(error).map_or(f64::NAN, |p| p.applications);
    let (sweeps, predicted) = (products(0, 1e-10) - products(0, 1e-4), 1e-6f64.ln() / m.radius.ln());
    let [jacobi, seidel, cg] = [0, 1, 2].map(|i| products(i, 1e-6));
    let (p, [weighted, _]) = (m.order, &m.ratios);
    let rises = weighted.windows(2).all(|r| r[1] > r[0] * (1.0 - 1e-9));
    let top = weighted.iter().copied().fold(0.0, f64::max) / m.radius;

    let exchange = format!("{} and {} m²", value(there), value(back));
    let faster = format!("{jacobi}, {seidel} and {cg} to an error of 10⁻⁶");
    let powers_found = format!("to {}, with 3 standard errors", percent(powers));
    let same = format!("to {:.0e} in 30 sweeps", m.sweeps_apart);
    let order = format!("p = {p:.2}, error {:.1e} on the finest mesh", m.mesh[2].1);
    vec![
        claim("in a closed room the rows of F sum to 1, to 10⁻⁶", format!("to {rows:.0e}"), rows < 1e-6),
        claim("rays from i and rays from j give the same A_i F_ij, to 5 %", exchange, apart(there, back) < 0.05),
        claim("T_h^k E is the term k of the paths, to 5 %, for k = 1 to 6", powers_found, powers < 0.05),
        claim("Jacobi's iterates are the partial sums, up to rounding", same, m.sweeps_apart < 1e-13),
        claim(
            "r(T_h) predicts the sweeps for six more digits, to 2 sweeps",
            format!("{sweeps} sweeps, predicted {predicted:.1}"),
            (sweeps - predicted).abs() < 2.0,
        ),
        claim(
            "Gauss–Seidel and conjugate gradients need less than 0.6 times the products of Jacobi",
            faster,
            seidel < 0.6 * jacobi && cg < 0.6 * jacobi,
        ),
        claim("the error of the mesh falls like h^p with 1.2 < p < 2", order, 1.2 < p && p < 2.0),
        claim(
            "in the norm ‖·‖_w the ratio of the terms never falls, and stays below r(T_h)",
            format!("it ends at {top:.6} r(T_h)"),
            rises && top < 1.0 + 1e-9,
        ),
    ]
}

fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder.quick, folder.seed, cosine_hemisphere, |t, e| Box::new(Jacobi::new(t, e)))?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
