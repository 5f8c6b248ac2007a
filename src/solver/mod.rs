//! Deterministic solvers for the radiance L, on patches.
//!
//! ```text
//! (I − T) L = E        L = Σ_{k≥0} T^k E
//! ```
//!
//! | method | place |
//! |---|---|
//! | term by term | [`Neumann`] |
//! | LU factorisation | [`direct`] |
//! | up to rounding, without a matrix | [`settle`] |
//! | iterations whose steps can be inspected ([`Watched`]) | [`PartialSums`], [`Jacobi`], [`Sor`], [`Southwell`], [`Chebyshev`], [`ConjugateGradients`], [`Gmres`] |
//! | comparison of all these methods | [`comparison`] |
//! | extrapolation of the series | [`accelerate`] |

pub mod accelerate;
mod chebyshev;
pub mod comparison;
pub mod direct;
#[cfg(test)]
mod example;
mod iteration;
mod krylov;
pub mod neumann;
mod radiosity;
mod settle;
mod southwell;
mod stationary;

pub use chebyshev::Chebyshev;
pub use iteration::{Iteration, IterationStep, Watched, residual};
pub use krylov::{ConjugateGradients, Gmres};
pub use neumann::Neumann;
pub use radiosity::{Radiosity, Solution};
pub use settle::{Settled, settle};
pub use southwell::Southwell;
pub use stationary::{Jacobi, PartialSums, Sor};
