//! A solution with the same mistake on both sides of its equation.
//!
//! ```text
//! L' = E + T' L'        residual in its own equation  |E + T' L' − L'| = 0        in the right one  |E + T L' − L'| > 0
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T, T' | the matrix of the cube; the same with all albedos times s, a wrong value read from a table | [`own_equation`] |
//! | L, L' | solutions of L = E + T L and L' = E + T' L' | |
//! | deficit | 1 − (mean of L' − E)/(mean of L − E), the reflected light that is missing | [`OwnEquation::deficit`] |
//!
//! Reference: chapter 14 of the book has the tests that compare with something from outside.

use fredholm::engine::by_matrix;
use fredholm::operator::matrix::{LinearOperator, PatchOperator};
use fredholm::report::book::{self, Folder};
use fredholm::scene::{Scene, load};
use fredholm::solver::direct;

/// The wrong solution.
#[derive(Clone, Copy, Debug)]
pub struct OwnEquation {
    /// Largest residual over the patches in its own equation.
    pub own: f64,
    /// Largest residual in the right equation.
    pub right: f64,
    /// Part of the reflected light that is missing.
    pub deficit: f64,
}

// ANCHOR: own
/// Solves the cube with all albedos times s, and puts the solution into both equations; the green channel.
pub fn own_equation(folder: &Folder<'_>, s: f64) -> book::Result<OwnEquation> {
    let room = load::scene("cube", &load::Options::default())?.description;
    let r = by_matrix::dense_matrix(&room, &Scene::new(&room), 150, 1.0, 0, folder.progress)?.radiosity;
    let (t, e) = (r.operator(1), r.emission(1));
    let wrong = PatchOperator::new(t.factors, t.rho.iter().map(|rho| s * rho).collect());
    let (l, l_wrong) = (direct::solve(&t, &e)?.x, direct::solve(&wrong, &e)?.x);
    let reflected = |l: &[f64]| l.iter().zip(&e).zip(t.area()).map(|((l, e), a)| a * (l - e)).sum::<f64>();
    let residual = |t: &PatchOperator<'_>| direct::residual(t, &e, &l_wrong);
    Ok(OwnEquation { own: residual(&wrong), right: residual(&t), deficit: 1.0 - reflected(&l_wrong) / reflected(&l) })
}
// ANCHOR_END: own
