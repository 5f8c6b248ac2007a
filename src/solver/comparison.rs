//! Every solver on the same system, step by step, against its solution to rounding.
//!
//! ```text
//! error of a step = ‖x − L‖_w / ‖L‖_w        ⟨u, v⟩_w = Σ Aᵢ uᵢ vᵢ/ρᵢ        L by LU, or by GMRES to rounding
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | applications | products with T, or work worth as much | [`Point::applications`] |
//! | λ_min, λ_max | ends of the spectrum, by Lanczos, once if at all; Chebyshev and SOR are charged for them | [`System::ends`] |
//!
//! The weight 1/ρ is that in which T is self-adjoint: there the error of every stationary method falls by its eigenvalues,
//! and the bounds of Chebyshev's iteration hold.
//!
//! T as sampled is self-adjoint within its noise only. There is no LU of it and no [`ConjugateGradients`]; the ends are those of
//! its symmetric part, which hold the real parts of all eigenvalues.

mod history;

use super::direct::{self, Singular};
use super::{Chebyshev, ConjugateGradients, Gmres, Iteration, Jacobi, PartialSums, Sor, Southwell, Watched, settle};
use crate::operator::algebra::Expression;
use crate::operator::matrix::{Extremes, PatchOperator, Transposed, Weight, extremes};
use crate::operator::rays::RayOperator;
pub use history::{History, Point, Solver, Solvers};
use std::sync::OnceLock;
use std::time::Instant;

/// Where L comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// LU.
    Lu {
        /// Its time.
        seconds: f64,
    },
    /// GMRES, until its residual fell no more.
    Gmres {
        /// Products with T.
        applications: usize,
    },
}

/// (I − T) L = E with what is known about it.
#[derive(Clone, Debug)]
pub struct System<'a, T> {
    /// T of one channel.
    pub operator: &'a T,
    /// E.
    pub emission: Vec<f64>,
    /// L.
    pub light: Vec<f64>,
    /// Who found L.
    pub reference: Reference,
    weight: Weight,
    ends: OnceLock<Ends>,
}

/// Ends of the spectrum, and what they took.
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// λ_min and λ_max.
    pub found: Extremes,
    /// Products with T.
    pub applications: usize,
    /// Seconds.
    pub seconds: f64,
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

/// Steps that Lanczos may take.
const STEPS: usize = 200;

impl<'a> System<'a, PatchOperator<'a>> {
    /// Solves by LU.
    ///
    /// # Errors
    /// [`Singular`] if the channel keeps all its light.
    pub fn new(operator: &'a PatchOperator<'a>, emission: Vec<f64>) -> Result<Self, Singular> {
        let clock = Instant::now();
        let light = direct::solve(operator, &emission)?.x;
        let reference = Reference::Lu { seconds: clock.elapsed().as_secs_f64() };
        Ok(Self { operator, emission, light, reference, weight: operator.weight(), ends: OnceLock::new() })
    }
}

impl<'a> System<'a, RayOperator<'a>> {
    /// Solves by GMRES to rounding.
    ///
    /// # Errors
    /// [`Singular`] if the channel keeps all its light.
    pub fn sampled(operator: &'a RayOperator<'a>, emission: Vec<f64>) -> Result<Self, Singular> {
        let settled = settle(operator, &emission)?;
        let reference = Reference::Gmres { applications: settled.applications };
        let weight = Weight::new(&operator.rays.area, &operator.rho);
        Ok(Self { operator, emission, light: settled.x, reference, weight, ends: OnceLock::new() })
    }
}

impl<T: Transposed> System<'_, T> {
    /// The solvers that are possible here.
    pub fn solvers(&self) -> Vec<Solver> {
        Solver::ALL.into_iter().filter(|s| self.dense() || s.suits_rays()).collect()
    }

    /// ‖E − (I − T) L‖/‖E‖ in the area inner product.
    pub fn residual(&self) -> f64 {
        let left = super::residual(self.operator, &self.emission, &self.light);
        self.operator.norm(&left) / self.operator.norm(&self.emission)
    }

    /// The ends of the spectrum, found once, by the first who asks.
    pub fn ends(&self) -> &Ends {
        self.ends.get_or_init(|| {
            let clock = Instant::now();
            let (found, each) = if self.dense() {
                (extremes(self.operator, &self.weight, ENDS, STEPS), 1)
            } else {
                // T and its adjoint
                let symmetric = Expression::from(self.operator).symmetric_part(&self.weight);
                (extremes(&symmetric, &self.weight, ENDS, STEPS), 2)
            };
            Ends { found, applications: each * found.steps, seconds: clock.elapsed().as_secs_f64() }
        })
    }

    /// [a, b] that holds the spectrum, b < 1.
    pub fn bracket(&self) -> [f64; 2] {
        let ends = self.ends().found;
        let [a, b] = ends.bracket();
        [a, b.min(0.5 * (1.0 + ends.largest))]
    }

    /// ‖x − L‖_w/‖L‖_w.
    pub fn error(&self, x: &[f64]) -> f64 {
        let difference: Vec<f64> = x.iter().zip(&self.light).map(|(x, l)| x - l).collect();
        self.weight.norm(&difference) / self.weight.norm(&self.light)
    }

    /// Runs a solver until its error is small enough, or it can go no further. One that is not possible here has no steps.
    pub fn history(&self, solver: Solver, limits: Limits<'_>) -> History {
        let (t, e) = (self.operator, &self.emission);
        // the ends are known before the first step, and have to be paid for
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
            // written so that NaN ends it, too
            if !(error > limits.error && s.applications < limits.applications) {
                break;
            }
        }
        points
    }

    fn dense(&self) -> bool {
        matches!(self.reference, Reference::Lu { .. })
    }

    /// LU: n³/3 multiplications, n/3 products with T.
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
