//! Runs every solver on the same system and compares each step with a solution that is exact up to rounding.
//!
//! ```text
//! error of a step = ‖x − L‖_w / ‖L‖_w        ⟨u, v⟩_w = Σ Aᵢ uᵢ vᵢ/ρᵢ        L by LU, or by GMRES up to rounding
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | applications | products with T, or other work in units of one product | [`Point::applications`] |
//! | λ_min, λ_max | ends of the spectrum by Lanczos, computed once and only if needed; their cost is added to that of Chebyshev and SOR | [`System::ends`] |
//!
//! T is self-adjoint in the weight 1/ρ. In this norm the eigenvalues give the rate at which the error of every stationary
//! method falls, and the bounds for Chebyshev's iteration hold.
//!
//! A sampled T is self-adjoint only within its noise. For it, LU and [`ConjugateGradients`] are not available. The ends of
//! the spectrum are then those of its symmetric part; they enclose the real parts of all eigenvalues.

mod history;

use super::direct::{self, Singular};
use super::{Chebyshev, ConjugateGradients, Gmres, Iteration, Jacobi, PartialSums, Sor, Southwell, Watched, settle};
use crate::operator::algebra::Expression;
use crate::operator::matrix::{Extremes, PatchOperator, Transposed, Weight, extremes};
use crate::operator::rays::RayOperator;
pub use history::{History, Point, Solver, Solvers};
use std::sync::OnceLock;
use std::time::Instant;

/// The method that computed the reference solution L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// LU factorisation.
    Lu {
        /// Its run time.
        seconds: f64,
    },
    /// GMRES, until its residual stopped falling.
    Gmres {
        /// Number of products with T.
        applications: usize,
    },
}

/// The system (I − T) L = E of one channel, with its reference solution and its spectrum.
#[derive(Clone, Debug)]
pub struct System<'a, T> {
    /// The operator T of one colour channel.
    pub operator: &'a T,
    /// The emission E per patch.
    pub emission: Vec<f64>,
    /// The reference solution L per patch.
    pub light: Vec<f64>,
    /// The method that computed L.
    pub reference: Reference,
    weight: Weight,
    ends: OnceLock<Ends>,
}

/// The ends of the spectrum, and the cost of computing them.
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// λ_min and λ_max.
    pub found: Extremes,
    /// Number of products with T.
    pub applications: usize,
    /// Run time in seconds.
    pub seconds: f64,
}

/// Limits at which the run of a solver stops.
#[derive(Clone, Copy)]
pub struct Limits<'a> {
    /// Stop when the relative error is at most this.
    pub error: f64,
    /// Stop when this number of applications is reached.
    pub applications: f64,
    /// Called before every step; the run stops if it returns true.
    pub stopped: &'a dyn Fn() -> bool,
}

/// Residual at which Lanczos stops. The error of an eigenvalue is about the square of this, and a more accurate result would
/// cost more than it saves.
const ENDS: f64 = 1e-3;

/// Maximum number of Lanczos steps.
const STEPS: usize = 200;

impl<'a> System<'a, PatchOperator<'a>> {
    /// Computes the reference solution by LU.
    ///
    /// # Errors
    /// [`Singular`] if a part of the scene neither absorbs light nor lets it escape.
    pub fn new(operator: &'a PatchOperator<'a>, emission: Vec<f64>) -> Result<Self, Singular> {
        let clock = Instant::now();
        let light = direct::solve(operator, &emission)?.x;
        let reference = Reference::Lu { seconds: clock.elapsed().as_secs_f64() };
        Ok(Self { operator, emission, light, reference, weight: operator.weight(), ends: OnceLock::new() })
    }
}

impl<'a> System<'a, RayOperator<'a>> {
    /// Computes the reference solution by GMRES, up to rounding.
    ///
    /// # Errors
    /// [`Singular`] if a part of the scene neither absorbs light nor lets it escape.
    pub fn sampled(operator: &'a RayOperator<'a>, emission: Vec<f64>) -> Result<Self, Singular> {
        let settled = settle(operator, &emission)?;
        let reference = Reference::Gmres { applications: settled.applications };
        let weight = Weight::new(&operator.rays.area, &operator.rho);
        Ok(Self { operator, emission, light: settled.x, reference, weight, ends: OnceLock::new() })
    }
}

impl<T: Transposed> System<'_, T> {
    /// The solvers that can be used with this operator.
    pub fn solvers(&self) -> Vec<Solver> {
        Solver::ALL.into_iter().filter(|s| self.dense() || s.suits_rays()).collect()
    }

    /// Relative residual of the reference solution, ‖E − (I − T) L‖/‖E‖ in the area inner product.
    pub fn residual(&self) -> f64 {
        let left = super::residual(self.operator, &self.emission, &self.light);
        self.operator.norm(&left) / self.operator.norm(&self.emission)
    }

    /// The ends of the spectrum. They are computed at the first call and stored.
    pub fn ends(&self) -> &Ends {
        self.ends.get_or_init(|| {
            let clock = Instant::now();
            let (found, each) = if self.dense() {
                (extremes(self.operator, &self.weight, ENDS, STEPS), 1)
            } else {
                // each application needs T and its adjoint
                let symmetric = Expression::from(self.operator).symmetric_part(&self.weight);
                (extremes(&symmetric, &self.weight, ENDS, STEPS), 2)
            };
            Ends { found, applications: each * found.steps, seconds: clock.elapsed().as_secs_f64() }
        })
    }

    /// An interval [a, b] that contains the spectrum, with b < 1.
    pub fn bracket(&self) -> [f64; 2] {
        let ends = self.ends().found;
        let [a, b] = ends.bracket();
        [a, b.min(0.5 * (1.0 + ends.largest))]
    }

    /// The relative error ‖x − L‖_w/‖L‖_w.
    pub fn error(&self, x: &[f64]) -> f64 {
        let difference: Vec<f64> = x.iter().zip(&self.light).map(|(x, l)| x - l).collect();
        self.weight.norm(&difference) / self.weight.norm(&self.light)
    }

    /// Runs a solver until its error is small enough, another limit is reached, or it cannot improve further. A solver that
    /// cannot be used here returns no steps.
    pub fn history(&self, solver: Solver, limits: Limits<'_>) -> History {
        let (t, e) = (self.operator, &self.emission);
        // the ends are known before the first step; their cost is added to every step
        let informed = || (self.ends().applications as f64, self.ends().seconds);
        let radius = || self.bracket().map(f64::abs).into_iter().fold(0.0, f64::max);
        let points = match solver {
            Solver::Neumann => self.watch(|| PartialSums::new(t, e), limits, (0.0, 0.0)),
            Solver::Jacobi => self.watch(|| Jacobi::new(t, e), limits, (0.0, 0.0)),
            Solver::GaussSeidel => self.watch(|| Sor::gauss_seidel(t, e), limits, (0.0, 0.0)),
            Solver::Sor => {
                let omega = Sor::<T>::young(radius());
                self.watch(|| Sor::new(t, e, omega), limits, informed())
            }
            Solver::Southwell => self.watch(|| Southwell::new(t, e), limits, (0.0, 0.0)),
            Solver::Chebyshev => {
                let bracket = self.bracket();
                self.watch(|| Chebyshev::new(t, e, bracket), limits, informed())
            }
            Solver::ConjugateGradients if self.dense() => {
                self.watch(|| ConjugateGradients::new(t, self.weight.clone(), e), limits, (0.0, 0.0))
            }
            Solver::ConjugateGradients => vec![],
            Solver::Gmres => self.watch(|| Gmres::new(t, e), limits, (0.0, 0.0)),
            Solver::Lu => self.direct().into_iter().collect(),
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
            // this form of the condition also stops at NaN
            if !(error > limits.error && s.applications < limits.applications) {
                break;
            }
        }
        points
    }

    fn dense(&self) -> bool {
        matches!(self.reference, Reference::Lu { .. })
    }

    /// The single step of LU: n³/3 multiplications, which count as n/3 products with T.
    fn direct(&self) -> Option<Point> {
        let Reference::Lu { seconds } = self.reference else { return None };
        let residual = super::residual(self.operator, &self.emission, &self.light);
        Some(Point {
            step: 1,
            applications: self.light.len() as f64 / 3.0,
            norm: self.operator.norm(&self.light),
            residual: self.operator.norm(&residual),
            error: 0.0,
            seconds,
        })
    }
}
