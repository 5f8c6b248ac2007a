//! The error of the mesh: the mean radiance of each wall of a cube, compared with a solution that uses no patches.
//!
//! ```text
//! error(h) = √(1/6 Σ_walls (mean of B_h − mean of L)²) ≈ c h^p
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | B_h | solution on patches of width h | `Matrix::solution` |
//! | L | solution by spectral collocation, 7 digits, green channel | [`KNOWN`] |
//!
//! Reference: Atkinson, *The planar radiosity equation and its numerical solution*, IMA Journal of Numerical Analysis 20 (2000).

use fredholm::engine::by_matrix::Matrix;
use fredholm::solver::Radiosity;

const GREEN: usize = 1;
/// Mean radiance of the walls y = 0, y = 1, z = 0, z = 1, x = 0, x = 1 of the cube, from `scenes/cube.toml`.
const KNOWN: [f64; 6] = [0.303_755_5, 1.209_892_4, 0.319_333_3, 0.319_333_3, 0.114_853_9, 0.180_889_0];

// ANCHOR: mesh
/// Width of the patches, and the root mean square over the walls of the error of their mean radiance.
pub(super) fn error(cube: &Matrix<Radiosity>) -> (f64, f64) {
    let patches = &cube.radiosity.patches;
    let mean = |wall: usize| {
        let on = patches.iter().zip(&cube.solution.radiance).filter(|(p, _)| p.side.primitive == wall);
        let (light, area) = on.fold((0.0, 0.0), |s, (p, l)| (s.0 + p.area * l[GREEN], s.1 + p.area));
        light / area
    };
    let squares: f64 = (0..6).map(|wall| (mean(wall) - KNOWN[wall]).powi(2)).sum();
    (cube.radii[0].h, (squares / 6.0).sqrt())
}
// ANCHOR_END: mesh
