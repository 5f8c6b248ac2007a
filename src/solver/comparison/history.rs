//! The names of the solvers, and the record of their steps.

use crate::math::names::named;
use std::fmt;
use std::str::FromStr;

/// A method to solve (I − T) L = E.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Partial sums of the Neumann series.
    Neumann,
    /// Jacobi's iteration.
    Jacobi,
    /// Gauss–Seidel iteration.
    GaussSeidel,
    /// Successive over-relaxation (SOR) with Young's ω.
    Sor,
    /// Southwell's relaxation: progressive shooting.
    Southwell,
    /// Chebyshev's semi-iteration, with the ends of the spectrum from Lanczos.
    Chebyshev,
    /// Conjugate gradients in the inner product with weight 1/ρ.
    ConjugateGradients,
    /// GMRES without restarts.
    Gmres,
    /// LU factorisation.
    Lu,
}

impl Solver {
    /// All solvers; the direct one is last.
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

    /// Returns true if the solver works with stored rays. Conjugate gradients need a self-adjoint T, and LU needs a matrix.
    pub fn suits_rays(self) -> bool {
        !matches!(self, Self::ConjugateGradients | Self::Lu)
    }

    /// The name of the solver in tables.
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
    /// Writes the name as it is typed on the command line.
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

/// The choice of solvers to compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solvers {
    /// All solvers.
    All,
    /// This solver only; the direct solution is always added as a reference.
    One(Solver),
}

impl Solvers {
    /// All possible choices.
    pub fn choices() -> Vec<Self> {
        std::iter::once(Self::All).chain(Solver::ALL.map(Self::One)).collect()
    }

    /// Returns true if this choice includes `solver`.
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

/// The state of a solver after one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Number of steps so far.
    pub step: usize,
    /// Work so far, in products with T.
    pub applications: f64,
    /// ‖x‖ in the area inner product.
    pub norm: f64,
    /// Residual ‖E − (I − T) x‖ in the area inner product.
    pub residual: f64,
    /// Relative error ‖x − L‖_w/‖L‖_w, with the weight w = A/ρ.
    pub error: f64,
    /// Seconds so far.
    pub seconds: f64,
}

/// All recorded steps of one solver.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// The solver.
    pub solver: Solver,
    /// Its steps, beginning with the start.
    pub points: Vec<Point>,
}

impl History {
    /// The first step whose error is at most `error`; `None` if there is none.
    pub fn reaches(&self, error: f64) -> Option<&Point> {
        self.points.iter().find(|p| p.error <= error)
    }
}
