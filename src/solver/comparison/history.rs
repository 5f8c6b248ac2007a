//! The solvers by name, and what each did step by step.

use crate::math::names::named;
use std::fmt;
use std::str::FromStr;

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

    /// Whether it solves with stored rays: conjugate gradients need a self-adjoint T, LU a matrix.
    pub fn suits_rays(self) -> bool {
        !matches!(self, Self::ConjugateGradients | Self::Lu)
    }

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

impl fmt::Display for Solver {
    /// As it is typed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Neumann => "neumann",
            Self::Jacobi => "jacobi",
            Self::GaussSeidel => "gauss-seidel",
            Self::Sor => "sor",
            Self::Southwell => "southwell",
            Self::Chebyshev => "chebyshev",
            Self::ConjugateGradients => "cg",
            Self::Gmres => "gmres",
            Self::Lu => "lu",
        })
    }
}

impl FromStr for Solver {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

/// Which solvers are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solvers {
    /// Every one.
    All,
    /// This one, beside the direct solution.
    One(Solver),
}

impl Solvers {
    /// All choices.
    pub fn choices() -> Vec<Self> {
        std::iter::once(Self::All).chain(Solver::ALL.map(Self::One)).collect()
    }

    /// Whether this solver is one of them.
    pub fn include(self, solver: Solver) -> bool {
        self == Self::All || self == Self::One(solver)
    }
}

impl fmt::Display for Solvers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all"),
            Self::One(solver) => solver.fmt(f),
        }
    }
}

impl FromStr for Solvers {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::choices(), name)
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
