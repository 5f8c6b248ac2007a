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
use fredholm::operator::matrix::LinearOperator;
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::scene::{Description, Scene, load};
use fredholm::solver::comparison::{History, Limits, Solver, System};
use fredholm::solver::{Jacobi, Neumann};
use fredholm::stats::convergence_order;
use fredholm::study::surface;
use std::process::ExitCode;

#[path = "radiosity/claims.rs"]
mod claims;
#[path = "radiosity/exercises.rs"]
mod exercises;
#[path = "radiosity/figures.rs"]
mod figures;
#[path = "radiosity/form_factor.rs"]
pub mod form_factor;
#[path = "radiosity/mesh.rs"]
mod mesh;
#[path = "radiosity/sweeps.rs"]
pub mod sweeps;
pub use claims::claims;
use form_factor::{Direction, exchange};
use sweeps::{Sweeps, apart};

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 7,
    name: "07_radiosity",
    title: "Radiosity: the same series as a matrix",
    shows: "B = E + ρFB: form factors, powers of the matrix as terms, sweeps, mesh error, modes",
    next: &["fredholm radiosity cornell --modes 8", "fredholm radiosity cornell --solver all", "fredholm chapter 8"],
    program,
    exercises: exercises::EXERCISES,
};

/// K of the terms that are compared with paths.
const LAST: usize = 6;
const RED: usize = 0;

/// An estimate and its standard error.
pub type Value = (f64, f64);

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

/// Measures everything. `direction` draws the rays of form factors, `sweeps` makes the iteration next to the partial sums.
///
/// # Errors
/// If a scene cannot be loaded or has no matrix, which is a defect of the program.
pub fn measure(folder: &Folder<'_>, direction: Direction, sweeps: Sweeps) -> book::Result<Measured> {
    let (seed, progress) = (folder.seed, folder.progress);
    let load = |name: &str| load::scene(name, &load::Options::default()).map(|s| s.description);
    let matrix = |room: &Description, n| by_matrix::dense_matrix(room, &Scene::new(room), n, 1.0, LAST, progress);
    let (room, cube) = (load("cornell")?, load("cube")?);
    let scene = Scene::new(&room);
    let widths = folder.pick([300, 1200], [100, 400]);
    let (rays, paths, n) = folder.pick((1 << 20, 1 << 20, 3), (1 << 18, 1 << 19, 2));
    let cubes = [n, 2 * n, 4 * n].map(|n| 6 * n * n); // n × n patches on each wall
    let [coarse, fine] = widths.map(|n| matrix(&room, n));
    let (coarse, fine) = (coarse?, fine?);
    let cubes = cubes.map(|n| matrix(&cube, n)).into_iter().collect::<Result<Vec<_>, _>>()?;

    let settings = Settings { seed, max_bounces: LAST, ..Settings::default() };
    let paths = surface::norms(&scene, Estimator::Prefix, paths, &settings, progress);
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

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, cosine_hemisphere, |t, e| Box::new(Jacobi::new(t, e)))?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
