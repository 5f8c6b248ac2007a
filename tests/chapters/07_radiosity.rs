//! Every claim of chapter 7 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::radiosity::{Measured, claims, measure};
use fredholm::math::direction::{cosine_hemisphere, uniform_hemisphere};
use fredholm::report::book::Folder;
use fredholm::solver::{Jacobi, Sor};
use fredholm::stats::convergence_order;

#[test]
fn every_claim_of_chapter_7_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, cosine_hemisphere, |t, e| Box::new(Jacobi::new(t, e))).unwrap();

    // uniform directions in place of cosine-distributed ones; Gauss–Seidel in place of Jacobi
    let uniform = measure(&folder, uniform_hemisphere, |t, e| Box::new(Sor::gauss_seidel(t, e))).unwrap();
    // a row that loses light through a gap between two walls
    let leak = Measured { row_sums: [0.999, right.row_sums[1]], ..right.clone() };
    let no_cosine = Measured { exchange: uniform.exchange, ..right.clone() };
    let new_values_at_once = Measured { sweeps_apart: uniform.sweeps_apart, ..right.clone() };
    // one product too many for each term
    let mut shifted = right.clone();
    shifted.matrix[1].remove(0);
    shifted.matrix[1].push(0.0);
    // the largest albedo in place of the spectral radius
    let mut by_albedo = right.clone();
    by_albedo.radius = 0.8858;
    // Jacobi under the names of all solvers
    let mut all_jacobi = right.clone();
    all_jacobi.histories = vec![right.histories[0].clone(); 3];
    // an error that does not depend on the mesh, as from an albedo that is wrong
    let errors: Vec<_> = right.mesh.iter().map(|&(h, error)| (h, error + 0.01, 0.0)).collect();
    let constant = Measured { order: convergence_order(&errors).unwrap().order, ..right.clone() };
    // the norm in which T_h is not symmetric
    let mut unweighted = right.clone();
    unweighted.ratios.swap(0, 1);

    let mutants = [
        ("rows of F sum to 1", leak),
        ("rays from i and rays from j", no_cosine),
        ("is the term k of the paths", shifted),
        ("Jacobi's iterates", new_values_at_once),
        ("predicts the sweeps", by_albedo),
        ("Gauss–Seidel and conjugate gradients", all_jacobi),
        ("the error of the mesh", constant),
        ("in the norm ‖·‖_w", unweighted),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
