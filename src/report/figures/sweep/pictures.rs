//! The sheet of a sweep: a picture for each value at one exposure, and below it the noise and the efficiency of the value.
//!
//! ```text
//! L − E = Σ_{k≥1} T^k E        V₁ = variance of one sample of L − E        V = variance of one sample of L
//! ```
//!
//! The noise of reflected light, L − E, is given besides that of the whole image. The edge of a visible lamp can have most of the
//! variance of L, although it covers few pixels; V₁ is the noise that is seen on all other surfaces.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | E | emission seen directly, the term k = 0 | [`Shown::emission`] |
//! | V₁ | variance of one sample of reflected light | [`Shown::reflected`] |
//! | V | variance of one sample of the whole image | [`Row::total`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

use super::rows::{Row, Sweep};
use crate::engine::by_rays::Sampled;
use crate::report::{
    ReportError,
    figures::pictures::{self, Setting},
    image::{picture::Picture, typeset::Caption},
    text::ranking::Candidate,
};
use crate::terms::TermFilm;
use crate::terms::cross_moments::Value;
use crate::terms::scatter::Scatter;

/// The image of one value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// The whole image.
    pub image: Vec<[f32; 3]>,
    /// Its term k = 0.
    pub emission: Vec<[f32; 3]>,
    /// Samples per pixel and scatter of reflected light, Σ T^k E with k ≥ 1, after the last complete pass; none without replicates.
    pub reflected: Option<(u32, Scatter)>,
}

/// The scatter of reflected light of a film whose slots are the terms and the tail, with its samples per pixel. None without
/// replicates.
pub fn reflected(film: &TermFilm) -> Option<(u32, Scatter)> {
    let slots = film.shape.slots;
    (film.shape.replicates > 1 && slots > 1).then(|| (film.least_samples(), Scatter::of(film, 1..slots, None)))
}

impl Shown {
    /// The image of a finished render, with what [`reflected`] found in its film.
    pub fn new(sampled: &Sampled, reflected: Option<(u32, Scatter)>) -> Self {
        let emission = sampled.terms.first().map_or_else(Vec::new, |t| t.mean.clone());
        Self { image: sampled.total.mean.clone(), emission, reflected }
    }
}

pub(super) fn setting<'a>(r: &Row, shown: &'a Shown) -> Setting<'a> {
    let unknown = Value { value: f64::NAN, std_error: f64::NAN };
    let of_reflected = shown.reflected.as_ref().map_or(unknown, |(n, s)| Value {
        value: f64::from(*n) * s.variance(),
        std_error: f64::from(*n) * s.variance_error(),
    });
    let rays = r.rays_per_path();
    let without = shown.reflected.iter().flat_map(|(n, s)| {
        let one = move |i: usize| f64::from(*n) * s.variance_without(i) * rays;
        (0..s.replicates()).map(one)
    });
    let work = Candidate {
        name: r.value.clone(),
        work: of_reflected.value * rays,
        relative_error: of_reflected.std_error / of_reflected.value,
        replicates: r.image.total.replicates,
        without: without.collect(),
    };
    let cut = if r.image.tail.is_none() { format!(" (k ≤ {})", r.image.terms.len() - 1) } else { String::new() };
    Setting {
        label: format!("{}{cut}", r.value),
        image: &shown.image,
        emission: &shown.emission,
        spp: r.spp,
        noise: [("k ≥ 1", of_reflected), ("all k", Value { value: r.total.value, std_error: r.total.std_error })],
        replicates: r.image.total.replicates,
        known: r.known,
        rays_per_path: rays,
        seconds_per_path: Some(r.seconds / r.paths as f64),
        work,
    }
}

/// Draws a picture for each value at one exposure, with its numbers below.
///
/// # Errors
/// If there is no row, the images do not match the size, or the text cannot be drawn.
pub fn pictures(sweep: &Sweep, shown: &[Shown], size: [usize; 2], caption: &Caption) -> Result<Picture, ReportError> {
    let settings: Vec<Setting> = sweep.rows.iter().zip(shown).map(|(r, s)| setting(r, s)).collect();
    let title = format!("{} by {}", caption.scene, sweep.over);
    pictures::draw(&title, size, &settings, "reflected light, k ≥ 1", caption)
}
