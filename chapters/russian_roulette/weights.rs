//! The squared weight of a path, bounce by bounce: it decides whether the variance is finite.
//!
//! ```text
//! E[α_k² 1{alive}] = E[W_k²]/(1 − q)^k,    W_k = ρ_0 ρ_1 … ρ_{k−1},    E[W_{k+1}²]/E[W_k²] → r(ρ²F)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | W_k | weight at vertex k without roulette, red channel; 0 if the path has left the scene | [`squares`] |
//! | α_k | weight with roulette, W_k/(1 − q)^k | [`with_roulette`] |
//! | r(ρ²F) | factor per bounce of the late E\[W_k²\] | [`growth`] |
//!
//! Red is the channel in which the walls reflect most.

use super::load;
use fredholm::estimator::Technique;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::report::book::{self, Folder, Number};
use fredholm::study::enumeration::{Stop, follow};

/// The last vertex.
pub(super) const LAST: usize = 16;
/// The growth is measured between these two vertices.
const FROM_TO: [usize; 2] = [8, 16];
/// Groups of paths from which errors are computed.
const GROUPS: usize = 64;
/// The q for which second moments are drawn.
pub(super) const QS: [f64; 3] = [0.0, 0.5, 0.65];

/// E[W_k²] and its growth.
#[derive(Clone, Debug)]
pub struct Weights {
    /// E[W_k²] for k = 0, …, LAST.
    pub second: Vec<Number>,
    /// Its factor per bounce.
    pub growth: Number,
}

// ANCHOR: squares
/// W_0^p, W_1^p, … of one path without roulette, with p = 2: the squared products of its albedos.
fn squares(path: &[Stop], power: i32) -> Vec<f64> {
    let mut all = vec![1.0];
    for stop in path {
        let rho = stop.weight.map_or(0.0, |w| f64::from(w.x)); // no next vertex: the path has left the scene
        all.push(all[all.len() - 1] * rho.powi(power));
    }
    all.resize(LAST + 1, 0.0);
    all
}

/// E[α_k² 1{alive}], if paths end with probability q at every vertex.
pub(super) fn with_roulette(second: Number, k: usize, q: f64) -> Number {
    second.times((1.0 - q).powi(-(k as i32)))
}
// ANCHOR_END: squares

/// A function of the means of all groups, with its standard error by the jackknife over the groups.
fn value(groups: &[Vec<f64>], f: impl Fn(&[f64]) -> f64) -> Number {
    let n = groups.len() as f64;
    let all: Vec<f64> = (0..=LAST).map(|k| groups.iter().map(|g| g[k]).sum::<f64>() / n).collect();
    let without = |g: &Vec<f64>| f(&all.iter().zip(g).map(|(m, x)| (m * n - x) / (n - 1.0)).collect::<Vec<_>>());
    let each: Vec<f64> = groups.iter().map(without).collect();
    let centre = each.iter().sum::<f64>() / n;
    let spread = each.iter().map(|x| (x - centre).powi(2)).sum::<f64>();
    Number { value: f(&all), std_error: (spread * (n - 1.0) / n).sqrt() }
}

/// The factor per bounce between two late vertices.
fn growth(m: &[f64]) -> f64 {
    let [j, k] = FROM_TO;
    (m[k] / m[j]).powf(1.0 / (k - j) as f64)
}

/// Follows paths without roulette through the Cornell box. `power` is 2.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn weights(folder: &Folder<'_>, power: i32) -> book::Result<Weights> {
    let (scene, _) = load("cornell", 64)?;
    let (t, key) = (SceneTransport::new(&scene), Key::new(folder.seed, "weights"));
    let (pixels, samples) = (scene.camera.size[0] * scene.camera.size[1], folder.pick(64, 32));
    let mut groups = vec![vec![0.0; LAST + 1]; GROUPS];
    for (pixel, sample) in (0..pixels).flat_map(|p| (0..samples).map(move |s| (p, s))) {
        let start = scene.camera.start(&t, pixel, &mut Rng::at(key, pixel, sample, 0, Purpose::Start));
        let Some(start) = start else { continue };
        let path = follow(&t, start, Technique::Scatter, (key, pixel, sample), LAST);
        let group = &mut groups[(pixel * samples + sample) as usize % GROUPS];
        group.iter_mut().zip(squares(&path, power)).for_each(|(sum, x)| *sum += x);
    }
    let per_path = GROUPS as f64 / f64::from(pixels * samples);
    groups.iter_mut().flatten().for_each(|sum| *sum *= per_path);
    Ok(Weights { second: (0..=LAST).map(|k| value(&groups, |m| m[k])).collect(), growth: value(&groups, growth) })
}
