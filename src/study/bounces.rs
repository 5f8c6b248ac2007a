//! How many bounces are enough?
//!
//! ```text
//! enough(ε) = min { K : Σ_{k>K} m_k ≤ ε Σ_{k≥j} m_k }        j = 0: all light        j = 2: indirect light
//! guaranteed: ‖Σ_{k>K} T^k E‖₁ ≤ γ^(K+1−j)/(1 − γ) · ‖T^j E‖₁ ≤ γ^(K+1−j)/(1 − γ) · ‖Σ_{k≥j} T^k E‖₁
//! ```
//!
//! | symbol | type | meaning | place |
//! |---|---|---|---|
//! | K | `usize` | the last term that is kept | [`Enough`] |
//! | ε | `f64` | the fraction that may be left out | `part` of [`enough`] |
//! | j | `usize` | the first term that counts as light | `from` of [`enough`] |
//! | m_k | `f64` | mean of T^k E over the picture or over all surfaces, averaged over the channels | [`Bounces`] |
//! | γ | `f64` | the largest albedo, which ‖T‖₁ does not exceed | [`guaranteed`] |
//!
//! The terms up to k = 100 are estimated by prefixes of paths that end by roulette. No image is kept, so a long series costs little.
//! The measured K is usually far smaller than the guaranteed one, because no path meets only the brightest surface.
//!
//! Reference: the bound is the geometric series of ‖T‖₁ ≤ γ < 1; see Arvo, *The role of functional analysis in global illumination* (1995).

use super::strip;
use crate::engine::Settings;
use crate::engine::by_rays::Estimator;
use crate::math::Rng;
use crate::operator::{SceneTransport, Sensor, SurfaceStrip};
use crate::progress::Progress;
use crate::scene::{Camera, Scene, SurfaceSensor, Vertex, bsdf::Sampling};
use crate::stats::Evidence;
use crate::terms::functional::Replicates;
use std::fmt;

/// The last term that is estimated separately.
const LONGEST: usize = 100;
/// The vertex from which paths end by roulette.
const ROULETTE_FROM: usize = 4;
/// Pixels of the sensors. Each sees everything, so their number changes only the parallelism.
const PIXELS: u32 = 64;
/// Paths of each sensor at most.
const MOST_PATHS: u32 = 1 << 20;
/// Standard errors between which the remainder is called equal to ε.
const SURE: f64 = 3.0;

/// The means of the terms k = 0..=100 and of everything longer, replicate by replicate.
#[derive(Clone, Debug)]
pub struct Bounces {
    /// Means over the picture.
    pub picture: Replicates,
    /// Means over all surfaces: ‖T^k E‖₁ per area.
    pub surfaces: Replicates,
}

/// The number of bounces after which enough light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Enough {
    /// The smallest K that the noise allows; none if no K up to 100 is enough.
    pub least: Option<usize>,
    /// The smallest K that is enough beyond doubt (3 standard errors); none if there is no such K up to 100.
    pub most: Option<usize>,
}

impl fmt::Display for Enough {
    /// `8`, `8–9` where the noise leaves two candidates, `≥ 8`, or `> 100`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match (self.least, self.most) {
            (Some(a), Some(b)) if a == b => a.to_string(),
            (Some(a), Some(b)) => format!("{a}–{b}"),
            (Some(a), None) => format!("≥ {a}"),
            (None, _) => format!("> {LONGEST}"),
        };
        f.pad(&text)
    }
}

/// The picture as a strip of equal pixels, each of them the whole picture.
struct PictureStrip<'a>(&'a Camera);

impl Sensor<SceneTransport<'_>> for PictureStrip<'_> {
    fn size(&self) -> [u32; 2] {
        [PIXELS, 1]
    }
    fn start(&self, t: &SceneTransport, _pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        let [w, h] = self.0.size.map(f64::from);
        let (u, v) = (rng.four(), rng.four());
        // 48 bits for the place in the picture: a pixel of 32768 keeps 33 of them
        let wide = |a: f32, b: f32| f64::from(a) + f64::from(b) / 16_777_216.0;
        let (x, y) = (w * wide(u[0], v[0]), h * wide(u[1], v[1]));
        let (column, row) = (x.floor().min(w - 1.0), y.floor().min(h - 1.0));
        let (o, d) = self.0.ray((row * w + column) as u32, [(x - column) as f32, (y - row) as f32]);
        t.scene.look(o, d)
    }
}

/// Measures the terms of a scene up to k = 100, with about `paths` paths for the picture and as many for the surfaces. Returns
/// nothing where the variance of such long paths is not known to be finite, or if the work was stopped.
///
/// ```
/// use fredholm::engine::Settings;
/// use fredholm::progress::Progress;
/// use fredholm::scene::{Scene, load};
/// use fredholm::study::bounces::{bounces, enough, guaranteed};
///
/// // the furnace: T^k E = 0.5^k E, so that the remainder after K is 0.5^(K+1) of the whole
/// let options = load::Options { set: vec!["camera.size=[8,8]".into()], ..Default::default() };
/// let scene = Scene::new(&load::scene("furnace", &options)?.description);
/// let found = bounces(&scene, 1 << 15, &Settings::default(), Progress::NONE).unwrap();
/// assert_eq!(enough(&found.picture, 0, 0.1).to_string(), "3");
/// assert_eq!(guaranteed(0.5, 0, 0.1), Some(4));
/// # Ok::<(), fredholm::scene::SceneError>(())
/// ```
pub fn bounces(scene: &Scene, paths: u32, settings: &Settings, progress: Progress<'_>) -> Option<Bounces> {
    let t = SceneTransport { scene, sampling: Sampling::Bsdf };
    let settings = strip::settings(scene, LONGEST, ROULETTE_FROM, settings)?;
    let paths = paths.min(MOST_PATHS);
    let begin = |name: &str| progress.begin(name, u64::from(strip::samples(paths, PIXELS)) * u64::from(PIXELS));
    let (picture, surfaces) = ("long terms, picture", "long terms, surfaces");
    begin(picture);
    let sensor = PictureStrip(&scene.camera);
    let picture = strip::means(&t, &sensor, Estimator::Prefix, picture, paths, &settings, progress);
    begin(surfaces);
    let sensor = SurfaceStrip { sensor: SurfaceSensor::new(scene), pixels: PIXELS };
    let surfaces = strip::means(&t, &sensor, Estimator::Prefix, surfaces, paths, &settings, progress);
    (!progress.stopped()).then_some(Bounces { picture, surfaces })
}

/// The smallest K such that the terms k > K are at most the fraction `part` of the terms k ≥ `from`.
pub fn enough(terms: &Replicates, from: usize, part: f64) -> Enough {
    let slots = terms.mean.len();
    let mut least = None;
    for last in from..slots - 1 {
        // Σ_{k>K} m_k − ε Σ_{k≥j} m_k, with its standard error from the replicates
        let weight = |k: usize| f64::from(k > last) - part * f64::from(k >= from);
        let weighed = |m: &dyn Fn(usize) -> f64| (0..slots).map(|k| weight(k) * m(k)).sum::<f64>();
        let value = weighed(&|k| terms.mean[k].element_sum());
        let n = terms.deviation.len() as f64;
        let squares = terms.deviation.iter().map(|d| weighed(&|k| d[k].element_sum()).powi(2)).sum::<f64>();
        let error = (squares * n / (n - 1.0)).sqrt();
        // a standard error from a few events says nothing
        let rest = terms.estimate(last + 1..slots);
        let known = rest.mean.element_sum() == 0.0 || Evidence::of(&rest).no_error.is_none();
        if value <= SURE * error {
            least = least.or(Some(last));
        }
        if !known {
            return Enough { least: least.or(Some(last)), most: None };
        }
        if value <= -SURE * error || (value <= 0.0 && error == 0.0) {
            return Enough { least, most: Some(last) };
        }
    }
    Enough { least, most: None }
}

/// The smallest K for which the largest albedo γ guarantees, over all surfaces, that the terms k > K are at most the fraction
/// `part` of the terms k ≥ `from`. None where γ ≥ 1 guarantees nothing.
pub fn guaranteed(albedo: f64, from: usize, part: f64) -> Option<usize> {
    if albedo >= 1.0 {
        return None;
    }
    // γ = 0: the logarithm is −∞ and the first term is all there is
    let steps = ((part * (1.0 - albedo)).ln() / albedo.ln() - 1.0).max(0.0);
    Some(from + steps.ceil() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn geometric(rate: f64, noise: f64) -> Replicates {
        let mean: Vec<DVec3> = (0..LONGEST).map(|k| DVec3::splat(rate.powi(k as i32))).collect();
        let deviation = [-1.0, 1.0].map(|s| mean.iter().map(|m| *m * s * noise).collect());
        Replicates { mean, deviation: deviation.into(), counted: vec![] }
    }

    /// In a geometric series the remainder after K is rate^(K+1−j) of the terms from j on.
    #[test]
    fn a_geometric_series_needs_what_its_rate_says() {
        for rate in [0.3f64, 0.5, 0.8] {
            for (from, part) in [(0, 0.1f64), (0, 0.01), (2, 0.1), (2, 0.001)] {
                let exact = from + ((part.ln() / rate.ln()) - 1.0).ceil().max(0.0) as usize;
                let both = Enough { least: Some(exact), most: Some(exact) };
                assert_eq!(enough(&geometric(rate, 0.0), from, part), both, "{rate} {from} {part}");
                assert!(guaranteed(rate, from, part) >= Some(exact));
            }
        }
    }

    #[test]
    fn the_guaranteed_bounce_is_the_smallest_that_the_bound_allows() {
        for (g, part) in [(0.8858f64, 0.01), (0.5, 0.1), (0.3, 0.001)] {
            let bound = |last: usize| g.powi(last as i32 + 1) / (1.0 - g);
            let last = guaranteed(g, 0, part).unwrap_or(0);
            assert!(bound(last) <= part * (1.0 + 1e-9) && bound(last - 1) > part, "{g} {part}: {last}");
        }
        assert_eq!(guaranteed(1.0, 0, 0.1), None);
        assert_eq!(guaranteed(0.0, 2, 0.1), Some(2));
    }

    #[test]
    fn noise_leaves_a_range_and_words_say_so() {
        // replicates that move the remainder against the whole by a third
        let mut noisy = geometric(0.5, 0.0);
        noisy.deviation = [-1.0, 1.0]
            .map(|s| (0..LONGEST).map(|k| noisy.mean[k] * if k == 0 { 0.0 } else { 0.1 * s }).collect())
            .into();
        let range = enough(&noisy, 0, 0.1);
        assert!(range.least < range.most && range.most.is_some(), "{range}");
        assert!(range.to_string().contains('–'));
        assert_eq!(enough(&geometric(0.99, 0.0), 0, 1e-9).to_string(), "> 100");
    }
}
