//! Mistakes in the density of directions: members of the zoo, on the matt surface.
//!
//! ```text
//! E[f cos θ L/p'] = ∫ f cos θ L p/p' dω      p: true density, p': the density that the estimator assumes
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p, p' | true and assumed density | `Mistake::direction` |
//! | D | Kolmogorov's distance of sin²θ from the uniform law, which it has if p = cos θ/π | [`distance`] |
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), ch. 2.

use super::situations::{RHO, SITUATIONS, situation};
use super::spread::spread;
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, bsdf::Sampling};
use fredholm::stats::uniformity;
use fredholm::zoo::{self, Mistake};
use glam::Vec3;

// ANCHOR: wrong
/// The mean on the matt surface with a mistake, divided by the correct mean ρ sin²α.
pub fn with(folder: &Folder<'_>, mistake: &dyn Mistake, i: usize) -> book::Result<Number> {
    let (scene, x) = situation(i)?;
    let one = |u: &mut Rng| {
        let [u, v, ..] = u.four();
        let (to, p) = mistake.direction(x.n, Sampling::Cosine, [u, v]); // the density that the estimator assumes
        let f = mistake.lambert(scene.albedo(x.side));
        let seen = scene.look(Scene::offset_origin(x.p, x.n), to);
        let arrives = seen.map_or(Rgb::ZERO, |y| scene.light(&y));
        f64::from((mistake.bounce(f, x.n.dot(to), p) * arrives).x)
    };
    let exact = RHO * SITUATIONS[i].1.to_radians().sin().powi(2);
    Ok(spread(folder.seed, &format!("with {i}"), folder.pick(1 << 13, 1 << 12), one).mean.times(1.0 / exact))
}
// ANCHOR_END: wrong

/// Kolmogorov's distance of sin²θ from the uniform law, for 4096 directions.
pub fn distance(folder: &Folder<'_>, mistake: &dyn Mistake) -> f64 {
    let key = Key::new(folder.seed, "distance");
    let up = |n: u32| {
        let [u, v, ..] = Rng::at(key, 0, n, 0, Purpose::Scatter).four();
        f64::from(mistake.direction(Vec3::Z, Sampling::Cosine, [u, v]).0.z)
    };
    uniformity(&(0..4096).map(|n| 1.0 - up(n) * up(n)).collect::<Vec<_>>()).distance
}

/// The mistake of a member of the zoo.
pub fn member(name: &str) -> book::Result<&'static dyn Mistake> {
    Ok(zoo::find(name).ok_or("the zoo has no such member")?.mistake)
}
