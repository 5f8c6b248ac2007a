//! Every solver on the same system, step by step, against the direct solution.
//!
//! ```text
//! error of a step = ‖x − L‖_w / ‖L‖_w        ⟨u, v⟩_w = Σ Aᵢ uᵢ vᵢ/ρᵢ        L by LU
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | applications | products with T, or work worth as much: n² multiplications | [`Point::applications`] |
//! | λ_min, λ_max | ends of the spectrum, by Lanczos; their cost is charged to Chebyshev and SOR | [`System::ends`] |
//!
//! The weight 1/ρ is that in which T is self-adjoint: there the error of every stationary method falls by its eigenvalues,
//! and the bounds of Chebyshev's iteration hold.

use super::direct::{self, Singular};
use super::{Chebyshev, ConjugateGradients, Gmres, Iteration, Jacobi, PartialSums, Sor, Southwell, Watched};
use crate::operator::matrix::{Extremes, LinearOperator, PatchOperator, extremes};
use std::time::Instant;

/// A way to solve (I − T) L = E.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Partial sums of the series.
    Neumann,
    /// Jacobi's iteration.
    Jacobi,
    /// Gauss–Seidel.
    GaussSeidel,
    /// Over-relaxation with Young's ω.
    Sor,
    /// Progressive shooting.
    Southwell,
    /// Chebyshev's semi-iteration with the ends found by Lanczos.
    Chebyshev,
    /// Conjugate gradients in the weight 1/ρ.
    ConjugateGradients,
    /// GMRES without restarts.
    Gmres,
    /// LU factorisation.
    Lu,
}

impl Solver {
    /// All of them; the direct one is last.
    pub const ALL: [Self; 9] = [
        Self::Neumann,
        Self::Jacobi,
        Self::GaussSeidel,
        Self::Sor,
        Self::Southwell,
        Self::Chebyshev,
        Self::ConjugateGradients,
        Self::Gmres,
        Self::Lu,
    ];

    /// Its name, as in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Neumann => "Neumann",
            Self::Jacobi => "Jacobi",
            Self::GaussSeidel => "Gauss–Seidel",
            Self::Sor => "SOR",
            Self::Southwell => "Southwell",
            Self::Chebyshev => "Chebyshev",
            Self::ConjugateGradients => "CG",
            Self::Gmres => "GMRES",
            Self::Lu => "LU",
        }
    }
}

/// One step of a solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Steps so far.
    pub step: usize,
    /// Work so far, in products with T.
    pub applications: f64,
    /// ‖x‖_A.
    pub norm: f64,
    /// ‖E − (I − T) x‖_A.
    pub residual: f64,
    /// ‖x − L‖_w/‖L‖_w.
    pub error: f64,
    /// Seconds so far.
    pub seconds: f64,
}

/// What a solver did.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// Which one.
    pub solver: Solver,
    /// Its steps, the start first.
    pub points: Vec<Point>,
}

impl History {
    /// The first step with an error of at most `error`.
    pub fn reaches(&self, error: f64) -> Option<&Point> {
        self.points.iter().find(|p| p.error <= error)
    }
}

/// (I − T) L = E with what is known about it.
#[derive(Clone, Debug)]
pub struct System<'a> {
    /// T of one channel.
    pub operator: &'a PatchOperator<'a>,
    /// E.
    pub emission: Vec<f64>,
    /// L.
    pub light: Vec<f64>,
    /// Seconds that LU took.
    pub direct_seconds: f64,
    /// λ_min and λ_max.
    pub ends: Extremes,
    /// Seconds that they took.
    ends_seconds: f64,
}

/// When a study stops.
#[derive(Clone, Copy)]
pub struct Limits<'a> {
    /// Error that is good enough.
    pub error: f64,
    /// Applications that are too many.
    pub applications: f64,
    /// Asked before every step.
    pub stopped: &'a dyn Fn() -> bool,
}

/// The residual to which Lanczos finds the ends: an eigenvalue is off by about its square, and more would cost more than
/// it saves.
const ENDS: f64 = 1e-3;

impl<'a> System<'a> {
    /// Solves by LU and finds the ends of the spectrum.
    ///
    /// # Errors
    /// [`Singular`] if the channel keeps all its light.
    pub fn new(operator: &'a PatchOperator<'a>, emission: Vec<f64>) -> Result<Self, Singular> {
        let clock = Instant::now();
        let light = direct::solve(operator, &emission)?.x;
        let direct_seconds = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let ends = extremes(operator, ENDS, 200);
        Ok(Self { operator, emission, light, direct_seconds, ends, ends_seconds: clock.elapsed().as_secs_f64() })
    }

    /// [a, b] that holds the spectrum, b < 1.
    pub fn bracket(&self) -> [f64; 2] {
        let [a, b] = self.ends.bracket();
        [a, b.min(0.5 * (1.0 + self.ends.largest))]
    }

    /// ‖x − L‖_w/‖L‖_w.
    pub fn error(&self, x: &[f64]) -> f64 {
        let difference: Vec<f64> = x.iter().zip(&self.light).map(|(x, l)| x - l).collect();
        self.operator.weighted_norm(&difference) / self.operator.weighted_norm(&self.light)
    }

    /// Runs a solver until its error is small enough, or it can go no further.
    pub fn history(&self, solver: Solver, limits: Limits<'_>) -> History {
        let (t, e) = (self.operator, &self.emission);
        let radius = self.bracket().map(f64::abs).into_iter().fold(0.0, f64::max);
        // the ends are known before the first step, and have to be paid for
        let informed = (self.ends.steps as f64, self.ends_seconds);
        let points = match solver {
            Solver::Neumann => self.watch(|| PartialSums::new(t, e), limits, (0.0, 0.0)),
            Solver::Jacobi => self.watch(|| Jacobi::new(t, e), limits, (0.0, 0.0)),
            Solver::GaussSeidel => self.watch(|| Sor::gauss_seidel(t, e), limits, (0.0, 0.0)),
            Solver::Sor => self.watch(|| Sor::new(t, e, Sor::<PatchOperator<'_>>::young(radius)), limits, informed),
            Solver::Southwell => self.watch(|| Southwell::new(t, e), limits, (0.0, 0.0)),
            Solver::Chebyshev => self.watch(|| Chebyshev::new(t, e, self.bracket()), limits, informed),
            Solver::ConjugateGradients => self.watch(|| ConjugateGradients::new(t, e), limits, (0.0, 0.0)),
            Solver::Gmres => self.watch(|| Gmres::new(t, e), limits, (0.0, 0.0)),
            Solver::Lu => vec![self.direct()],
        };
        History { solver, points }
    }

    fn watch<I: Iteration>(
        &self,
        make: impl FnOnce() -> I,
        limits: Limits<'_>,
        (applications, seconds): (f64, f64),
    ) -> Vec<Point> {
        let mut watched = Watched::new(self.operator, &self.emission, make);
        let mut points: Vec<Point> = vec![];
        while !(limits.stopped)() {
            let Some(s) = watched.next() else { break };
            let error = self.error(watched.iteration().iterate());
            points.push(Point {
                step: s.step,
                applications: s.applications + applications,
                norm: s.norm,
                residual: s.residual,
                error,
                seconds: s.seconds + seconds,
            });
            // written so that NaN ends it, too
            if !(error > limits.error && s.applications < limits.applications) {
                break;
            }
        }
        points
    }

    /// LU: n³/3 multiplications, n/3 products with T.
    fn direct(&self) -> Point {
        let residual = super::residual(self.operator, &self.emission, &self.light);
        Point {
            step: 1,
            applications: self.light.len() as f64 / 3.0,
            norm: self.operator.norm(&self.light),
            residual: self.operator.norm(&residual),
            error: 0.0,
            seconds: self.direct_seconds,
        }
    }
}
