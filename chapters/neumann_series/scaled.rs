//! All rooms whose albedos are s times those of one room, from the terms of that room.
//!
//! ```text
//! L(s) = Σ (s T)^k E = Σ s^k T^k E = (I − s T)⁻¹ E        |s| r(T) < 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | s^k | weight of the term k | [`sum`] |
//! | s T | transport with all albedos times s | [`darker`], [`towards_pole`] |
//! | 1/r(T) | the least s > 0 for which I − s T has no inverse | [`TOWARDS_THE_POLE`] |
//!
//! Reference: Kress, *Linear Integral Equations* (1989), chapter 2.

use super::{LAST, RED, Value};
use fredholm::engine::by_matrix::Matrix;
use fredholm::operator::matrix::{LinearOperator, PatchOperator};
use fredholm::scene::description::{Description, Material};
use fredholm::solver::{Radiosity, direct};
use fredholm::terms::functional::Replicates;

/// s of the room that is rendered anew.
pub(super) const DARKER: f64 = 0.8;
/// s r(T) of the rooms that the matrix solves.
pub(super) const TOWARDS_THE_POLE: [f64; 11] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 0.999];

// ANCHOR: scaled
/// Σ weight(s, k) m_k over k ≥ 1, with weight s^k; everything beyond K gets the weight of k = K + 1.
pub(super) fn sum(terms: &Replicates, s: f64, weight: fn(f64, usize) -> f64) -> Value {
    let sum = |m: &dyn Fn(usize) -> f64| (1..LAST + 2).map(|k| weight(s, k) * m(k)).sum::<f64>();
    let n = terms.deviation.len() as f64;
    let squares: f64 = terms.deviation.iter().map(|d| sum(&|k| d[k][RED]).powi(2)).sum();
    (sum(&|k| terms.mean[k][RED]), (squares * n / (n - 1.0)).sqrt())
}

/// The same room with all albedos times s.
pub(super) fn darker(room: &Description, s: f64) -> Description {
    let dark = |m: &Material| Material::diffuse(&m.name, s * m.lambertian().unwrap_or_default(), m.sides);
    Description { materials: room.materials.iter().map(dark).collect(), ..room.clone() }
}
// ANCHOR_END: scaled

/// s, and the reflected light of the matrix with all albedos times s.
pub(super) fn towards_pole(room: &Matrix<Radiosity>) -> Result<Vec<(f64, f64)>, direct::Singular> {
    let (t, e) = (room.radiosity.operator(RED), room.radiosity.emission(RED));
    let area: f64 = t.area().iter().sum();
    let reflected = |sr: f64| {
        let s = sr / room.radii[0].value[RED];
        let scaled = PatchOperator::new(t.factors, t.rho.iter().map(|rho| s * rho).collect());
        let light = direct::solve(&scaled, &e)?.x;
        Ok((s, light.iter().zip(&e).zip(t.area()).map(|((l, e), a)| a * (l - e) / area).sum()))
    };
    TOWARDS_THE_POLE.into_iter().map(reflected).collect()
}
