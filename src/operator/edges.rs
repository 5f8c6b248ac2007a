//! The essential band: the continuous spectrum of T that edges between surfaces cause, whatever the rest of the scene is.
//!
//! ```text
//! along a right-angled edge between albedos ρ₁ and ρ₂ the spectrum of T in L₂ holds  [−κ √(ρ₁ρ₂), κ √(ρ₁ρ₂)]
//! κ = ¼ B(¾, ¾) = Γ(¾)²/(2√π) = 0.4236065…
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | κ | L₂ norm of the operator with kernel xy/2(x² + y²)^{3/2} on a half line: its Mellin symbol at −½ | [`KAPPA`] |
//! | √(ρ₁ρ₂) | geometric mean of the albedos at an edge; the largest value over the mesh counts | [`essential_band`] |
//!
//! Near an edge the kernel is homogeneous of degree −2: if a function is squeezed towards the edge, its image under T is
//! squeezed in the same way. Therefore T is not compact, and the band is continuous spectrum. As a mesh is refined, its
//! eigenvalues fill the band ever more densely, and no eigenvalue inside the band converges to a limit. Three faces that
//! meet in a corner widen the band further, which is not computed here. Eigenvalues just outside the band may therefore
//! drift as well.
//!
//! The band has a known closed form only for right angles. Patches that meet at other angles are counted separately.
//!
//! Reference: Atkinson, *The Numerical Solution of Integral Equations of the Second Kind* (1997), chapter 8, for Mellin
//! convolutions at edges.

use super::form_factor::FormFactors;
use super::patches::{Patch, Patches};
use glam::DVec3;

/// κ = Γ(¾)²/(2√π): half width of the band for albedo 1.
pub const KAPPA: f64 = 0.423_606_542_396_989_5;

/// The essential band of a mesh, and the number of edges that contribute to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Band {
    /// κ √(ρ₁ρ₂), the largest value over all right-angled edges; 0 if there are none.
    pub half_width: f64,
    /// Pairs of patches that meet at a right angle and see each other.
    pub right: usize,
    /// Pairs of patches that meet at another angle below 180°; their band is not known.
    pub other: usize,
}

/// The essential band of one colour channel; `rho` holds its albedo per patch.
pub fn essential_band(patches: &Patches, factors: &FormFactors, rho: &[f64]) -> Band {
    let reach: Vec<f64> = patches.iter().map(radius).collect();
    let mut band = Band::default();
    for i in 0..patches.len() {
        let row = factors.row(i);
        for j in i + 1..patches.len() {
            let (a, b) = (&patches[i], &patches[j]);
            let near = reach[i] + reach[j];
            let apart = a.primitive == b.primitive || row[j] == 0.0 || a.centre.distance(b.centre) > near;
            if apart || rho[i] * rho[j] == 0.0 || a.ball.is_some() || b.ball.is_some() || !meet(a, b, near) {
                continue;
            }
            let cosine = a.normal.dot(b.normal).abs();
            if cosine < 1e-6 {
                band.right += 1;
                band.half_width = band.half_width.max(KAPPA * (rho[i] * rho[j]).sqrt());
            } else if cosine < 1.0 - 1e-6 {
                band.other += 1;
            }
        }
    }
    band
}

fn radius(p: &Patch) -> f64 {
    p.polygon.iter().map(|c| c.distance(p.centre)).fold(0.0, f64::max)
}

/// Returns true if an edge of one patch lies along the other patch: at least two of three inner points of the edge lie on
/// it.
fn meet(a: &Patch, b: &Patch, size: f64) -> bool {
    let touches = |p: &Patch, q: &Patch| {
        let next = p.polygon.iter().cycle().skip(1);
        p.polygon.iter().zip(next).any(|(from, to)| {
            [0.25, 0.5, 0.75].iter().filter(|s| inside(q, from.lerp(*to, **s), 1e-9 * size)).count() >= 2
        })
    };
    touches(a, b) || touches(b, a)
}

/// Returns true if a point lies in a convex polygon or on its boundary.
fn inside(p: &Patch, x: DVec3, tolerance: f64) -> bool {
    let next = p.polygon.iter().cycle().skip(1);
    let left = |(from, to): (&DVec3, &DVec3)| {
        let along = (*to - *from).normalize_or_zero();
        p.normal.cross(along).dot(x - *from) >= -tolerance
    };
    (x - p.centre).dot(p.normal).abs() <= tolerance && p.polygon.iter().zip(next).all(left)
}
