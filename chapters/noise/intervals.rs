//! How often the 95 % interval of a pixel covers the truth.
//!
//! ```text
//! T E = ρ p E at every point of a sphere      X = ρ E if the ray hits the lamp (probability p), else 0
//! interval: m ± t se        t: 2.13 for 16 replicates, two-sided 95 %        P(no path finds the lamp) = (1 − p)^N
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p | part of the sphere that the lamp covers: (1 − z)/2 for the cap above z | [`LARGE`], [`TINY`] |
//! | ρ, E | albedo 0.6; radiance of the lamp, 1/p, so that T E = ρ for every lamp | [`TRUTH`] |
//! | N | paths of a pixel, in 16 replicates | [`PATHS`] |
//! | m, se | mean of a pixel and its standard error | [`intervals`] |
//!
//! The light of the term k = 1 is the same at every point of the sphere, so the pixels of one image are repetitions of one
//! experiment whose result is known.

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Folder, Number};
use fredholm::terms::TermFilm;

/// Parts of the sphere that the lamps cover.
pub(super) const LARGE: f64 = 0.3;
/// See [`LARGE`].
pub(super) const TINY: f64 = 1.0 / 128.0;
/// ρ p E with E = 1/p.
pub(super) const TRUTH: f64 = 0.6;
/// Paths of a pixel.
pub(super) const PATHS: u32 = 64;
const REPLICATES: u32 = 16;

/// The intervals of all pixels.
#[derive(Clone, Debug)]
pub struct Covered {
    /// p.
    pub lamp: f64,
    /// m and half width, pixel by pixel.
    pub intervals: Vec<(f64, f64)>,
    /// Part of the pixels whose interval covers the truth.
    pub covered: Number,
    /// Part of the pixels that are black.
    pub black: Number,
    /// Mean of all pixels.
    pub mean: Number,
    /// Median of all pixels.
    pub median: f64,
}

// ANCHOR: intervals
/// m and half width of every pixel, for the term k = 1.
pub(super) fn intervals(film: &TermFilm, half_width: fn(f64, u64) -> f64) -> Vec<(f64, f64)> {
    let interval = |p: usize| {
        let (m, se) = film.pixel(p, 1..2);
        (m.x, half_width(se.x, u64::from(REPLICATES)))
    };
    (0..film.shape.pixels()).map(interval).collect()
}

fn covers(&(m, half): &(f64, f64)) -> bool {
    (m - TRUTH).abs() <= half
}
// ANCHOR_END: intervals

/// Renders the sphere with a lamp that covers the part p of it.
pub(super) fn measure(p: f64, half_width: fn(f64, u64) -> f64, folder: &Folder<'_>) -> book::Result<Covered> {
    let (z, e) = (1.0 - 2.0 * p, 1.0 / p);
    let size = folder.pick(192, 112);
    let scene = super::load(
        "sphere",
        &[
            format!("shapes.0.z=[{z}, 1]"),
            format!("shapes.1.z=[-1, {z}]"),
            format!("shapes.0.emission=[{e}, {e}, {e}]"),
            format!("camera.size=[{size}, {size}]"),
        ],
    )?;
    let plan = Plan { max_bounces: 1, technique: Technique::Scatter, roulette: Roulette::Never };
    let key = Key::new(folder.seed, &format!("lamp {p}"));
    let amount = Amount { spp: PATHS, replicates: REPLICATES as usize, key };
    let film = render(&SceneTransport::new(&scene), &scene.camera, &Prefix(plan), amount, folder.progress);
    let intervals = intervals(&film, half_width);
    let mut sorted: Vec<f64> = intervals.iter().map(|i| i.0).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let e = fredholm::stats::estimate(&sorted.iter().map(|&x| glam::DVec3::splat(x)).collect::<Vec<_>>());
    Ok(Covered {
        lamp: p,
        covered: part(intervals.iter().filter(|i| covers(i)).count(), intervals.len()),
        black: part(intervals.iter().filter(|i| i.0 == 0.0).count(), intervals.len()),
        mean: Number::from(&e),
        median: sorted[sorted.len() / 2],
        intervals,
    })
}

/// A part of n pixels, with the error of a binomial distribution.
fn part(count: usize, n: usize) -> Number {
    let value = count as f64 / n as f64;
    Number { value, std_error: (value * (1.0 - value) / n as f64).sqrt() }
}
