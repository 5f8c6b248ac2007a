//! The pictures of a well-known homework: every bounce alone and added up, Russian roulette, and more and more samples.
//!
//! ```text
//! without roulette: T^k E for k ≤ K        with roulette: Σ_{k≤m} T^k E for every m, and Σ T^k E over all k
//! MSE(n) = ⟨(S_n − X)²⟩ − ⟨se_X²⟩          S_n: Σ_{k≤K} of the first n samples, X: the same sum without roulette
//! ```
//!
//! Two renders with independent random numbers give everything. Their terms must be equal up to noise, because roulette is unbiased; [`Homework::verdict`]
//! states whether they are. The samples 16, 32, …, N are the first samples of the render with roulette. The pictures of fewer
//! samples are renders of their own.
//!
//! | symbol | type | meaning | place |
//! |---|---|---|---|
//! | K | `usize` | [`LAST`], the last bounce that is shown alone | |
//! | T^k E | [`Sampled`] | without roulette | [`Homework::terms`] |
//! | S_n | [`Grown`] | after n samples per pixel | [`Homework::grown`] |
//!
//! Reference: the assignment *PathTracer* of CS184/284A, University of California, Berkeley, part 4.

use crate::engine::Settings;
use crate::engine::by_rays::{self, Estimator, Sampled};
use crate::engine::passes::Watch;
use crate::estimator::Roulette;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::stats::{Comparison, Criterion, compare};
use crate::study::stages::reference_seed;
use crate::terms::{TermFilm, TermImage};

/// The last bounce that is shown alone.
pub const LAST: usize = 5;

/// Roulette of the homework: the first indirect bounce is always followed, every further one ends with this probability.
pub const ROULETTE: Roulette = Roulette::Constant { from: 1, q: 0.35 };

/// The sum of all terms after some samples per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// Samples per pixel.
    pub spp: u32,
    /// Σ T^k E over all k, row by row.
    pub pixels: Vec<[f32; 3]>,
    /// Squared error of Σ_{k≤K}, averaged over pixels and channels; unbiased, so that it may be negative.
    pub squared_error: f64,
}

/// All pictures of the homework.
#[derive(Clone, Debug)]
pub struct Homework {
    /// T^k E for k ≤ K; paths do not end before.
    pub terms: Sampled,
    /// T^k E for k ≤ K and everything longer, with [`ROULETTE`].
    pub roulette: Sampled,
    /// The render with roulette after 1, 2, 4, … samples per pixel.
    pub grown: Vec<Grown>,
}

impl Homework {
    /// Compares the terms without and with roulette: is roulette unbiased?
    pub fn verdict(&self) -> Comparison {
        compare(&self.terms.series, &self.roulette.series, &Criterion::default(), &[])
    }

    /// Σ_{k≤m} T^k E without or with roulette, row by row.
    pub fn partial_sum(of: &Sampled, m: usize) -> Vec<[f32; 3]> {
        let mut sum = vec![[0.0f32; 3]; of.total.mean.len()];
        for term in of.terms.iter().take(m + 1) {
            sum.iter_mut().zip(&term.mean).for_each(|(s, t)| (0..3).for_each(|c| s[c] += t[c]));
        }
        sum
    }
}

/// Renders everything with up to `spp` samples per pixel. None if interrupted.
///
/// ```
/// use fredholm::progress::Progress;
/// use fredholm::scene::{Scene, load};
/// use fredholm::study::homework::homework;
///
/// let options = load::Options { set: vec!["camera.size=[8,8]".into()], ..Default::default() };
/// let scene = Scene::new(&load::scene("furnace", &options)?.description);
/// let done = homework(&scene, 32, 0, Progress::NONE).unwrap();
/// // the furnace: T^k E = 0.5^k E, with and without roulette, within five standard errors
/// for side in [&done.terms, &done.roulette] {
///     let third = side.series.image().terms[3];
///     assert!((third.mean.x - 0.125).abs() < 5.0 * third.std_error.x && third.std_error.x < 0.01, "{third:?}");
/// }
/// assert_eq!(done.grown.iter().map(|g| g.spp).collect::<Vec<_>>(), [1, 2, 4, 8, 16, 32]);
/// # Ok::<(), fredholm::scene::SceneError>(())
/// ```
pub fn homework(scene: &Scene, spp: u32, seed: u64, progress: Progress<'_>) -> Option<Homework> {
    let settings = Settings { spp, seed, max_bounces: LAST, roulette: Roulette::Never, ..Settings::default() };
    // random numbers of its own: otherwise both renders would have the same first vertices
    let own = Settings { seed: reference_seed(seed), ..settings.clone() };
    let terms = by_rays::terms(scene, Estimator::Prefix, &own, progress.named("no roulette"));
    let reference = &terms.sum;
    let ended = Settings { roulette: ROULETTE, ..settings };

    let mut grown = vec![];
    // fewer samples than replicates cannot be read from the long render
    for n in (0..4).map(|i| 1 << i).take_while(|&n| n < spp.min(16)) {
        let few = by_rays::terms(scene, Estimator::Prefix, &Settings { spp: n, ..ended.clone() }, progress.silent());
        let squared_error = squared_error(&few.sum.mean, reference);
        grown.push(Grown { spp: n, pixels: few.total.mean, squared_error });
    }
    let mut look = |film: &TermFilm| {
        let n = film.least_samples();
        if n.is_power_of_two() && grown.last().is_none_or(|g| g.spp < n) {
            let sum = TermImage::of(film, 0..LAST + 1).mean;
            let pixels = TermImage::of(film, 0..LAST + 2).mean;
            grown.push(Grown { spp: n, pixels, squared_error: squared_error(&sum, reference) });
        }
        Some(2 * n.next_power_of_two())
    };
    let progress = progress.named("roulette");
    let watch = Watch { look: Some(&mut look), ..Watch::NONE };
    let roulette = by_rays::watched(scene, Some(Estimator::Prefix), &ended, progress, watch);
    (!progress.stopped()).then_some(Homework { terms, roulette, grown })
}

/// ⟨(m − X)²⟩ − ⟨se_X²⟩ over pixels and channels.
fn squared_error(pixels: &[[f32; 3]], reference: &TermImage) -> f64 {
    let square = |a: f32| f64::from(a) * f64::from(a);
    let each = pixels.iter().zip(&reference.mean).zip(&reference.std_error);
    let sum: f64 = each.flat_map(|((m, x), e)| (0..3).map(move |c| square(m[c] - x[c]) - square(e[c]))).sum();
    sum / (3 * pixels.len()) as f64
}
