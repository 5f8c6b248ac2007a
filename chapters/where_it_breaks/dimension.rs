//! Noise of the terms T^k E by independent random numbers and by Sobol points, while the number of samples grows.
//!
//! ```text
//! T^k E = an integral over 2k numbers      V ∝ N^b,  b = −1 for every k      gain of Sobol points: V_independent/V_Sobol
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of a pixel, averaged over the pixels, with its standard error | [`Scatter`] |
//! | N, b | samples per pixel; the fitted slope | [`NoiseCurve`] |
//! | gain | how many times more samples independent numbers need | [`Dimension::gain`] |
//!
//! Two more numbers choose the point in the pixel. Directions are the only technique, so that each bounce takes two numbers.
//!
//! Reference: Owen, *Scrambled net variance for integrals of smooth functions* (1997).

use super::claims::UNKNOWN;
use fredholm::engine::passes::Watch;
use fredholm::engine::{Settings, by_rays, by_rays::Estimator};
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, load};
use fredholm::study::convergence::{NoiseCurve, Recorder};
use fredholm::terms::{Variance, scatter::Scatter};

/// The last term.
pub const LAST: usize = 4;

/// The noise of the terms k = 0, …, 4.
#[derive(Clone)]
pub struct Dimension {
    /// By independent numbers.
    pub independent: Vec<NoiseCurve>,
    /// By Sobol points.
    pub even: Vec<NoiseCurve>,
}

// ANCHOR: noise
/// V against N for the terms of the cube, by one kind of points.
pub fn noise(folder: &Folder<'_>, points: Points) -> book::Result<Vec<NoiseCurve>> {
    let set = vec!["camera.size=[16, 16]".into()];
    let scene = Scene::new(&load::scene("cube", &load::Options { set, ..Default::default() })?.description);
    let (technique, roulette, spp) = (Technique::Scatter, Roulette::Never, folder.pick(8192, 1024));
    let settings =
        Settings { points, technique, roulette, spp, max_bounces: LAST, seed: folder.seed, ..Settings::default() };
    let mut record = Recorder::new(None, vec![]); // V after every pass, at N = 16, 32, 64, …
    let watch = Watch { look: Some(&mut |film| record.look(film)), ..Watch::NONE };
    by_rays::watched(&scene, Some(Estimator::Prefix), &settings, folder.progress, watch);
    let mut curves = NoiseCurve::all(&record.stands(), false, Variance::Finite);
    curves.truncate(LAST + 1); // the last curve is that of the sum
    Ok(curves)
}
// ANCHOR_END: noise

/// V with its standard error.
pub fn variance(scatter: &Scatter) -> Number {
    Number { value: scatter.variance(), std_error: scatter.variance_error() }
}

impl Dimension {
    /// How many times more samples independent numbers need for the term k, at the largest N.
    pub fn gain(&self, k: usize) -> Number {
        let last = |curves: &[NoiseCurve]| curves[k].points.last().map(|(_, s)| variance(s)).unwrap_or(UNKNOWN);
        last(&self.independent).over(last(&self.even))
    }
}
