//! Naive recursion as a program: a function that calls itself N times at every hit.
//!
//! ```text
//! L_k(x) = E(x) + Σ_{i=1}^{N} (1/N) w_i L_{k+1}(y_i)        L_K = E        rays of depth k: N^k
//! ```

use super::{K, Value, load};
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::{SceneTransport, Transport};
use fredholm::report::book;
use glam::Vec3;

// ANCHOR: recursion
/// L(x) up to K reflections, with n rays from every hit, each of weight `share`. Counts the rays of every depth.
fn radiance<T: Transport>(t: &T, x: &T::State, k: usize, (n, share): (u32, f32), key: Key, rays: &mut [u64]) -> Rgb {
    let mut reflected = Rgb::ZERO;
    if k < K {
        for child in 0..n {
            let key = key.branch(child); // random numbers of its own
            rays[k + 1] += 1;
            if let Some(y) = t.scatter(x, &mut Rng::at(key, 0, 0, 0, Purpose::Scatter)) {
                reflected += share * y.weight * radiance(t, &y.state, k + 1, (n, share), key, rays);
            }
        }
    }
    t.emission(x) + reflected
}
// ANCHOR_END: recursion

/// Naive recursion from a point of the furnace or of the sphere: the rays of one recursion, and the mean of `paths`.
pub fn recursion(scene: &str, paths: u32, seed: u64, n: u32, share: f32) -> book::Result<([u64; K + 1], Value)> {
    let scene = load(scene, 16)?;
    let (t, key) = (SceneTransport::new(&scene), Key::new(seed, "recursion").branch(n));
    let x = scene.look(Vec3::ZERO, Vec3::NEG_Z).ok_or("the ray leaves the scene")?;
    let (mut rays, mut sums) = ([0; K + 1], [0.0; 2]);
    for path in 0..paths {
        rays = [1, 0, 0, 0, 0];
        let l = f64::from(radiance(&t, &x, 0, (n, share), key.branch(path), &mut rays).x);
        sums = [sums[0] + l, sums[1] + l * l];
    }
    let [mean, square] = sums.map(|s| s / f64::from(paths));
    Ok((rays, [mean, ((square - mean * mean).max(0.0) / f64::from(paths)).sqrt()]))
}
