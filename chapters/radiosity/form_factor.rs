//! A form factor as a probability: F_ij is the part of the light leaving i that arrives at j.
//!
//! ```text
//! F_ij = 1/A_i ∫∫ V cos θ_x cos θ_y/(π d²) dA_y dA_x = P(a ray from i arrives at j)        A_i F_ij = A_j F_ji
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | P | probability for uniform points on i and directions with density cos θ/π | [`form_factor`] |
//! | A_i F_ij | the integral, symmetric in i and j | [`exchange`] |
//!
//! Reference: Cohen, Wallace, *Radiosity and Realistic Image Synthesis* (1993), chapter 4.

use super::Value;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::form_factor::FormFactors;
use fredholm::operator::matrix::{LinearOperator, PatchOperator};
use fredholm::scene::{Description, Scene, Side, SurfaceSensor};
use glam::Vec3;

/// A way to draw a direction about a normal from two random numbers, with its cosine.
pub type Direction = fn(Vec3, [f32; 2]) -> (Vec3, f32);

/// Rays start this far above their surface, in metres, so that they do not hit it.
const ABOVE: f32 = 1e-4;

// ANCHOR: form_factor
/// F from the sides `from` to the sides `to`: the part of `n` rays that arrive there, and its standard error. The rays start
/// at uniform points, in directions with density cos θ/π.
fn form_factor(scene: &Scene, from: &[Side], to: &[Side], n: u32, key: Key, direction: Direction) -> Value {
    let sensor = SurfaceSensor::of(scene, from.to_vec());
    let arrives = |i: &u32| {
        let x = sensor.vertex(scene, &mut Rng::at(key, 0, *i, 0, Purpose::Start));
        let [u, v, ..] = Rng::at(key, 0, *i, 0, Purpose::Scatter).four();
        let hit = scene.trace(x.p + ABOVE * x.n, direction(x.n, [u, v]).0);
        hit.is_some_and(|y| to.contains(&y.side))
    };
    let part = (0..n).filter(arrives).count() as f64 / f64::from(n);
    (part, (part * (1.0 - part) / f64::from(n)).sqrt())
}
// ANCHOR_END: form_factor

/// The reflecting sides of the shapes of this name, and their area.
fn sides(room: &Description, scene: &Scene, name: &str) -> (Vec<Side>, f64) {
    let primitives = room.primitives().into_iter().enumerate();
    let named = primitives.filter(|(_, (shape, _))| room.shapes[*shape].name == name).map(|(i, _)| 2 * i as Side);
    let sides: Vec<Side> = named.collect();
    let area = sides.iter().map(|&s| scene.area(s)).sum();
    (sides, area)
}

/// A_i F_ij and A_j F_ji for the two shapes of these names, each by its own rays, in m².
pub(super) fn exchange(
    room: &Description,
    scene: &Scene,
    names: [&str; 2],
    rays: u32,
    seed: u64,
    direction: Direction,
) -> [Value; 2] {
    let [(i, a_i), (j, a_j)] = names.map(|name| sides(room, scene, name));
    let key = Key::new(seed, "form factors");
    let there = form_factor(scene, &i, &j, rays, key, direction);
    let back = form_factor(scene, &j, &i, rays, key.branch(1), direction);
    [(a_i * there.0, a_i * there.1), (a_j * back.0, a_j * back.1)]
}

/// The mean of the row sums Σ_j F_ij over all surfaces: the part of the light that arrives somewhere.
pub(super) fn mean_row_sum(factors: &FormFactors) -> f64 {
    let (one, mut sums) = (vec![1.0; factors.n], vec![0.0; factors.n]);
    let white = PatchOperator::new(factors, one.clone());
    white.apply(&one, &mut sums);
    white.inner(&one, &sums) / white.inner(&one, &one)
}
