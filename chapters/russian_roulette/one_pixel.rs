//! Many paths through one pixel, one value for each: what a sample variance and a median do where the variance is infinite.
//!
//! ```text
//! V_N = Σ_{i≤N} (S_i − mean)²/(N − 1)          P(S > x) ∝ x^{−α}          median of the means of n paths
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S_i | indirect light that path i finds, red channel | [`indirect`] |
//! | V_N | sample variance of the first N paths | [`running`] |
//! | α | exponent of the tail: the variance is infinite if α < 2 | [`exponent`] |
//! | n | paths of one estimate | [`median`] |
//!
//! Reference: Hill, *A simple general approach to inference about the tail of a distribution*, Annals of Statistics 3 (1975).

use super::load;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::math::{Key, Rng};
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Camera, Scene, Vertex};

/// Paths that are rendered at once: SIDE × SIDE × REPLICATES.
const SIDE: u32 = 64;
const REPLICATES: usize = 16;
/// The exponent is measured from one of this many paths, those with the largest values.
const LARGEST: usize = 256;
/// The numbers n of paths of one estimate.
pub(super) const PATHS: [usize; 6] = [1, 4, 16, 64, 256, 1024];

/// The pixel of the back wall right in the middle of an image of 64 × 64, seen by each of many paths.
struct OnePixel<'a>(&'a Camera);

impl Sensor<SceneTransport<'_>> for OnePixel<'_> {
    fn size(&self) -> [u32; 2] {
        [SIDE, SIDE]
    }
    fn start(&self, t: &SceneTransport<'_>, _: u32, rng: &mut Rng) -> Option<Vertex> {
        let [width, height] = self.0.size;
        self.0.start(t, height * 3 / 8 * width + width / 2, rng)
    }
}

/// Paths through one pixel under one schedule.
#[derive(Clone, Debug)]
pub struct Paths {
    /// The schedule.
    pub schedule: Roulette,
    /// N and V_N.
    pub running: Vec<(f64, f64)>,
    /// α of the largest values.
    pub exponent: Number,
    /// Mean of all paths. Its error is not known where the variance is infinite.
    pub mean: Number,
    /// Medians of estimates with n paths each, for each n of [`PATHS`].
    pub medians: Vec<Number>,
}

/// Σ_{k≥2} T^k E, red channel, one value for each path: the tail behind K = 1.
fn indirect(scene: &Scene, schedule: &Roulette, many: u32, folder: &Folder<'_>) -> Vec<f64> {
    let plan = Plan { max_bounces: 1, technique: Technique::Mis, roulette: schedule.clone() };
    let key = |part| Key::new(folder.seed, &format!("one pixel {schedule}")).branch(part);
    let (t, pixel, tail) = (SceneTransport::new(scene), OnePixel(&scene.camera), 2);
    let one_part = |part| {
        let amount = Amount { spp: REPLICATES as u32, replicates: REPLICATES, key: key(part) };
        let film = render(&t, &pixel, &Prefix(plan.clone()), amount, folder.progress);
        let paths = (0..film.shape.pixels()).flat_map(|p| (0..REPLICATES).map(move |r| (p, r)));
        paths.map(|(p, r)| film.sum(p, r, tail).x).collect::<Vec<_>>()
    };
    (0..many).flat_map(one_part).collect()
}

/// N and V_N, for about eight values of N in each octave, from 64 on.
fn running(values: &[f64]) -> Vec<(f64, f64)> {
    let (mut mean, mut squares, mut next, mut found) = (0.0, 0.0, 64.0f64, vec![]);
    for (i, x) in values.iter().enumerate() {
        let (n, off) = ((i + 1) as f64, x - mean);
        mean += off / n;
        squares += off * (x - mean);
        if n >= next {
            found.push((n, squares / (n - 1.0)));
            next = n * 2f64.powf(0.125);
        }
    }
    found
}

/// α from the m largest values: 1/α is the mean of ln(x/x_m) over them.
fn exponent(sorted: &[f64]) -> Number {
    let m = sorted.len() / LARGEST;
    let top = &sorted[sorted.len() - m..];
    let alpha = m as f64 / top.iter().map(|x| (x / top[0]).ln()).sum::<f64>();
    Number { value: alpha, std_error: alpha / (m as f64).sqrt() }
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// Median of the means of n paths each. Its error: half the distance of the values that lie √R/2 places away.
fn median(values: &[f64], n: usize) -> Number {
    let means = sorted(values.chunks_exact(n).map(|c| c.iter().sum::<f64>() / n as f64).collect());
    let (middle, away) = (means.len() / 2, ((means.len() as f64).sqrt() / 2.0).ceil() as usize);
    Number { value: means[middle], std_error: 0.5 * (means[middle + away] - means[middle - away]) }
}

/// Renders and evaluates the paths under one schedule, `parts` times 2¹⁶ of them.
///
/// # Errors
/// If the scene cannot be loaded, or if the program is stopped.
pub fn paths(folder: &Folder<'_>, schedule: &Roulette, parts: u32) -> book::Result<Paths> {
    let (scene, _) = load("cornell", 64)?;
    let values = indirect(&scene, schedule, parts, folder);
    if folder.progress.stopped() {
        return Err("stopped".into());
    }
    let (n, running) = (values.len() as f64, running(&values));
    let variance = running.last().map_or(f64::NAN, |last| last.1);
    Ok(Paths {
        schedule: schedule.clone(),
        exponent: exponent(&sorted(values.clone())),
        mean: Number { value: values.iter().sum::<f64>() / n, std_error: (variance / n).sqrt() },
        medians: PATHS.iter().map(|&n| median(&values, n)).collect(),
        running,
    })
}
