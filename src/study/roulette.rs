//! Roulette schedules of a scene: predicted, measured, chosen.
//!
//! ```text
//! pilot: paths without roulette up to vertex K  →  M_ab, m_ab, c_v  →  V and rays of every schedule  →  the best one
//! ```
//!
//! Beyond vertex K the pilot goes on with constant q ≤ 1 − max albedo ([`beyond`]), and so does every schedule that is compared
//! with it: with survival s ≥ max albedo no weight grows, `ρ²/s ≤ ρ` and `ρ⁴/s³ ≤ ρ`, so that the tail has finite moments of
//! second and of fourth order whatever stands in the table before. Where the albedo is 1, or is only known to be at most 1, the
//! growth R of second moments without roulette is [measured](crate::engine::known::growth), and q = (1 − R)/4: then R/(1 − q) < 1 and, since the moments
//! of fourth order grow no faster, R/(1 − q)³ < 1.
//!
//! | what | finite where | place |
//! |---|---|---|
//! | variance under constant q | the spectral radius of ρ²F/(1 − q) is below 1 | [`Radii::second`] |
//! | variance of the measured variance | that of ρ⁴F/(1 − q)³ is | [`Radii::fourth`] |
//!
//! Without a matrix the largest albedo stands for F: then a radius below 1 proves that the moment is finite, and one above 1
//! proves nothing. Both speak of directions drawn like the reflectance, whose weights are albedos.

use crate::engine::Settings;
use crate::engine::known::growth::{CLEAR, FromLight, growth};
use crate::engine::known::resort::two_digits;
use crate::estimator::record::record;
use crate::estimator::render::{Amount, render};
use crate::estimator::{Plan, Prefix, Roulette, Vertices};
use crate::guide::ByExpectation;
use crate::math::Key;
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::solver::Radiosity;
use crate::stats::optimal::{optimal_reach, schedule};
use crate::stats::schedule::{Noise, Part, Separable, gain};
use crate::terms::Variance;
use crate::terms::cross_moments::{Recorded, Value};
use std::fmt;
use std::str::FromStr;
use std::time::Instant;

/// Paths of a pilot: enough for a schedule that is as good as the best to a percent or two.
const PILOT: u64 = 1 << 18;
/// Vertices a pilot looks at: at least, and at most.
const DEPTH: [usize; 2] = [16, 64];
/// The least q beyond K: paths of a million vertices. It is only reached where the variance is not known to be finite.
const LEAST: f64 = 1e-6;
/// Replicates behind the errors.
const REPLICATES: u32 = 64;

/// q from vertex K on: at most 1 − the largest albedo of the scene, or a quarter of what second moments lose at a vertex.
pub fn beyond(scene: &Scene) -> f64 {
    let rho = f64::from((scene.max_albedo() * scene.lit()).max_element());
    let loss = if rho < 1.0 {
        1.0 - rho
    } else {
        let t = SceneTransport::new(scene);
        let g = growth(&FromLight { t: &t, roulette: &Roulette::Never }, 0, 2, 0);
        0.25 * (1.0 - g.rate - CLEAR * g.std_error)
    };
    two_digits(loss).clamp(LEAST, 0.99)
}

fn amount(spp: u32, settings: &Settings, stream: &str) -> Amount {
    // moments are those of one sample: independent points, whatever the images are made with
    Amount { spp, replicates: spp.min(REPLICATES) as usize, key: Key::new(settings.seed, stream) }
}

/// The cross moments of paths without roulette before vertex K = `settings.max_bounces`; nothing if interrupted.
pub fn pilot(scene: &Scene, settings: &Settings, spp: u32, progress: Progress<'_>) -> Option<Recorded> {
    let roulette = Roulette::Constant { from: settings.max_bounces, q: beyond(scene) };
    let t = SceneTransport { scene, sampling: settings.sampling };
    let [w, h] = scene.camera.size;
    progress.begin("cross moments", u64::from(w) * u64::from(h) * u64::from(spp));
    let estimator = Vertices(Plan { roulette, ..settings.plan() });
    record(&t, &scene.camera, &estimator, amount(spp, settings, "cross moments"), progress)
}

/// Terms under a schedule as the path tracer would use it, from vertex 0 on; nothing if interrupted. Read with
/// [`Noise::measured`].
pub fn measure(
    scene: &Scene,
    settings: &Settings,
    schedule: &Roulette,
    spp: u32,
    progress: Progress<'_>,
) -> Option<Recorded> {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let [w, h] = scene.camera.size;
    progress.begin(&format!("roulette {schedule}"), u64::from(w) * u64::from(h) * u64::from(spp));
    let estimator = Prefix(Plan { roulette: schedule.clone(), ..settings.plan() });
    let amount = amount(spp, settings, &format!("roulette {schedule}"));
    record(&t, &scene.camera, &estimator, amount, progress)
}

/// Wall-clock seconds per path that the terms take under each schedule without any bookkeeping: the least of three rounds of
/// `spp` samples, taken in turn so that a busy machine is unfair to all alike.
pub fn seconds_per_path(scene: &Scene, settings: &Settings, schedules: &[Roulette], spp: u32) -> Vec<f64> {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let paths = f64::from(scene.camera.size[0]) * f64::from(scene.camera.size[1]) * f64::from(spp);
    let mut least = vec![f64::INFINITY; schedules.len()];
    for _ in 0..3 {
        for (least, schedule) in least.iter_mut().zip(schedules) {
            let estimator = Prefix(Plan { roulette: schedule.clone(), ..settings.plan() });
            let started = Instant::now();
            let film = render(&t, &scene.camera, &estimator, amount(spp, settings, "time"), Progress::NONE);
            *least = least.min(started.elapsed().as_secs_f64() / paths);
            drop(film);
        }
    }
    least
}

/// The schedule with the most efficiency, and what it is expected to be.
#[derive(Clone, Debug)]
pub struct Optimal {
    /// A table: K entries, then q beyond.
    pub roulette: Roulette,
    /// Predicted noise and cost.
    pub noise: Noise,
    /// Its efficiency over that of the lecture's schedule, both as tables to K.
    pub gain: Value,
}

/// The best schedule for the whole image, from a recording of [`pilot`]. Its prediction comes from the same paths that chose
/// it, and is a little too good.
pub fn best(recorded: &Recorded, scene: &Scene) -> Option<Optimal> {
    let last = (recorded.all.slots / 2).checked_sub(1)?;
    let roulette = schedule(&optimal_reach(&Separable::of(&recorded.all, Part::All)), beyond(scene));
    let noise = Noise::predicted(recorded, &roulette)?;
    let lecture = Roulette::LECTURE.then(last, beyond(scene))?;
    let gain = gain(recorded, &roulette, &lecture)?;
    Some(Optimal { roulette, noise, gain })
}

/// The best schedule for a scene and these settings, from a pilot of its own stream; nothing if interrupted.
///
/// ```
/// use fredholm::scene::{Scene, load};
/// use fredholm::engine::Settings;
/// use fredholm::progress::Progress;
/// use fredholm::study::roulette;
///
/// let options = load::Options { set: vec!["camera.size=[8,8]".into()], ..Default::default() };
/// let scene = Scene::new(&load::scene("cornell", &options)?.description);
/// let best = roulette::optimal(&scene, &Settings::default(), Progress::NONE);
/// assert!(best.is_some_and(|b| b.gain.value > 1.0));
/// # Ok::<(), fredholm::scene::SceneError>(())
/// ```
pub fn optimal(scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Option<Optimal> {
    let settings = Settings { max_bounces: settings.max_bounces.clamp(DEPTH[0], DEPTH[1]), ..settings.clone() };
    let [w, h] = scene.camera.size.map(u64::from);
    let spp = (PILOT / (w * h)).clamp(8, 1 << 12) as u32;
    best(&pilot(scene, &settings, spp, progress)?, scene)
}

/// A schedule as it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// This one.
    Given(Roulette),
    /// By what a guide says is still to come.
    ByExpectation(ByExpectation),
    /// The one with the most efficiency, which only the scene can tell.
    Optimal,
}

impl Schedule {
    /// The schedule, of walks without a guide; none if it is yet to be found.
    pub fn given(&self) -> Option<Roulette> {
        match self {
            Self::Given(roulette) => Some(roulette.clone()),
            Self::ByExpectation(end) => Some(end.plain()),
            Self::Optimal => None,
        }
    }
}

impl fmt::Display for Schedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Given(roulette) => roulette.fmt(f),
            Self::ByExpectation(end) => end.fmt(f),
            Self::Optimal => f.write_str("optimal"),
        }
    }
}

/// `optimal`, or as [`ByExpectation`], or as [`Roulette`].
impl FromStr for Schedule {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "optimal" {
            return Ok(Self::Optimal);
        }
        if let Ok(end) = text.parse() {
            return Ok(Self::ByExpectation(end));
        }
        let more =
            |why: String| if why.starts_with("unknown") { why + "; contribution[@V] or window[@V]" } else { why };
        text.parse().map(Self::Given).map_err(more)
    }
}

/// q from some vertex on, where a schedule settles on one.
pub fn constant(schedule: &Roulette) -> Option<f64> {
    match schedule {
        Roulette::Constant { q, .. } => Some(*q),
        Roulette::Table(q) => q.last().copied(),
        _ => None,
    }
}

/// Spectral radii that decide whether moments are finite under constant survival.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// Of ρ²F/s: the variance.
    pub second: f64,
    /// Of ρ⁴F/s³: the variance of the measured variance.
    pub fourth: f64,
    /// Whether these are only upper bounds, from the largest albedo.
    pub bounds: bool,
}

impl Radii {
    /// For walks that end with probability `q` everywhere; the largest over the channels.
    pub fn new(matrix: Option<&Radiosity>, scene: &Scene, q: f64) -> Self {
        let (s, largest) = (1.0 - q, |r: [f64; 3]| r.into_iter().fold(0.0, f64::max));
        match matrix {
            Some(m) => Self {
                second: largest(m.second_moment_radius(s)),
                fourth: largest(m.fourth_moment_radius(s)),
                bounds: false,
            },
            None => {
                let rho = f64::from(scene.max_albedo().max_element());
                Self { second: rho * rho / s, fourth: rho.powi(4) / s.powi(3), bounds: true }
            }
        }
    }

    /// Whether the variance is finite, as far as this tells: bounds prove that it is, or nothing.
    pub fn variance(&self) -> Option<Variance> {
        match (self.second < 1.0, self.bounds) {
            (true, true) => Some(Variance::Finite),
            (false, false) => Some(Variance::Infinite),
            _ => None,
        }
    }

    /// What the reader of an error bar must know, if anything: in words, after the name of what is estimated.
    pub fn warning(&self) -> Option<String> {
        let Self { second, fourth, bounds } = *self;
        match (bounds, second >= 1.0, fourth >= 1.0) {
            (false, true, _) => {
                Some(format!("has infinite variance:\nthe spectral radius of ρ²F/(1−q) is {second:.3} ≥ 1"))
            }
            (false, false, true) => Some(format!(
                "has finite variance, but that of the measured variance is infinite:\n\
                 the spectral radius of ρ⁴F/(1−q)³ is {fourth:.3} ≥ 1, and error bars come out too small"
            )),
            (true, true, _) => Some(format!(
                "may have infinite variance:\nthe bound max ρ²/(1−q) = {second:.3} ≥ 1 does not exclude it"
            )),
            (true, false, true) => Some(format!(
                "has finite variance, but error bars may come out too small: the bound\n\
                 max ρ⁴/(1−q)³ = {fourth:.3} ≥ 1 does not exclude that the measured variance has none"
            )),
            _ => None,
        }
    }
}
