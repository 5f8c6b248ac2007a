//! Both weights of a point sum to 1. The two weights are computed in two different measures.
//!
//! ```text
//! wᵢ = pᵢ/(p₀ + p₁)  per solid angle        wⱼ = qⱼ/(q₀ + q₁)  per area, q = p cos θ_y/d²        wᵢ + wⱼ = 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p₀, p₁ | densities per solid angle, from the strategy that found the point | `Factors::pair` |
//! | q₀, q₁ | densities per area, computed for the pair of points alone | `Adjoint::{toward, connect_density}` |
//!
//! The factor cos θ_y/d² cancels in wⱼ, so the measure makes no difference if all densities have the same one.

use super::plates::{points, veach};
use super::{found, weight};
use fredholm::estimator::Technique;
use fredholm::math::Key;
use fredholm::operator::{Adjoint, Role, SceneTransport, Transport};
use fredholm::report::book::{self, Folder};
use fredholm::scene::{Scene, Vertex};
use rayon::prelude::*;

/// q₁ of light sampling from x, for the point y on a lamp.
pub type Density = fn(&SceneTransport<'_>, &Vertex, &Vertex) -> f32;

/// q₁: the density of light sampling, per area.
pub fn per_area(t: &SceneTransport<'_>, x: &Vertex, y: &Vertex) -> f32 {
    t.connect_density(x, y)
}

/// The largest |wᵢ + wⱼ − 1| over points that either strategy finds from the plates, for the balance and the power
/// heuristic; and the number of points.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn sums(folder: &Folder<'_>, q_light: Density) -> book::Result<(f64, u64)> {
    let description = veach([96, 64])?;
    let scene = Scene::new(&description);
    let t = SceneTransport::new(&scene);
    let (key, many) = (Key::new(folder.seed, "sums"), folder.pick(64, 8));
    let of = |i: usize, x: &Vertex, y: &Vertex, pair: [f32; 2]| {
        let q = [t.toward(x, y, Role::Radiance).density, q_light(&t, x, y)];
        let sum = |h| weight(h, i, pair) + weight(h, 1 - i, [q[1 - i], q[i]]);
        [Technique::Mis, Technique::Power].map(|h| f64::from(sum(h) - 1.0).abs()).into_iter().fold(0.0, f64::max)
    };
    let at = |n: usize, x: &Vertex| {
        let mut worst = (0.0f64, 0);
        for j in 0..many {
            for (i, y) in found(&t, x, key, [n as u32, j]).iter().enumerate() {
                if let Some(y) = y.filter(|y| t.emission(&y.state).y > 0.0) {
                    worst = (worst.0.max(of(i, x, &y.state, y.pair)), worst.1 + 1);
                }
            }
        }
        worst
    };
    let all: Vec<Vertex> = points(&description, &scene)?.concat();
    let found: Vec<(f64, u64)> = all.par_iter().enumerate().map(|(n, x)| at(n, x)).collect();
    Ok(found.into_iter().fold((0.0, 0), |(a, n), (b, m)| (a.max(b), n + m)))
}
