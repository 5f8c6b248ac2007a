//! Russian roulette schedules for a scene: predicts their noise and cost from a pilot run, measures them, and finds the
//! best.
//!
//! ```text
//! pilot: paths without roulette up to vertex K  →  M_ab, m_ab, c_v  →  V and rays of every schedule  →  the best one
//! ```
//!
//! M_ab, m_ab are the cross moments of what is scored at the vertices of a path, and c_v the rays at vertex v
//! ([`crate::stats::schedule`]). V is the variance of one path.
//!
//! Beyond vertex K the pilot ends paths with a constant probability q ≤ 1 − max albedo ([`beyond`]), and so does every
//! schedule that is compared with it. With survival s = 1 − q ≥ max albedo the weights do not grow, because `ρ²/s ≤ ρ` and
//! `ρ⁴/s³ ≤ ρ`. The tail then has finite second and fourth moments, whatever the schedule does before vertex K.
//!
//! If the albedo is 1, or if only the bound 1 is known, the growth R of second moments without roulette is
//! [measured](crate::engine::known::growth). Then q = (1 − R)/4 is used. It makes R/(1 − q) < 1. Since fourth moments grow
//! no faster, R/(1 − q)³ < 1 holds, too.
//!
//! | quantity | is finite if | place |
//! |---|---|---|
//! | variance under constant q | the spectral radius of ρ²F/(1 − q) is below 1 | [`Radii::second`] |
//! | variance of the measured variance | the spectral radius of ρ⁴F/(1 − q)³ is below 1 | [`Radii::fourth`] |
//!
//! Without a matrix, F is replaced by 1 and ρ by the largest albedo. This gives upper bounds of the radii: a bound below 1
//! proves that the moment is finite, a bound above 1 proves nothing. Both radii assume that directions are sampled in
//! proportion to the BSDF times the cosine, so that the weight of a bounce is the albedo.

use super::some_pixels::SomePixels;
use crate::engine::Settings;
use crate::engine::known::growth::{CLEAR, FromLight, growth};
use crate::engine::known::resort::two_digits;
use crate::estimator::record::record;
use crate::estimator::render::{Amount, render};
use crate::estimator::{Plan, Prefix, Roulette, Vertices};
use crate::guide::ByExpectation;
use crate::math::Key;
use crate::math::names::named;
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

/// Paths of a pilot run. The schedule found from them has an efficiency within one or two percent of the best.
const PILOT: u64 = 1 << 18;
/// Smallest and largest number of vertices K that the pilot run records.
const DEPTH: [usize; 2] = [16, 64];
/// The smallest q beyond K: a mean length of a million vertices. It is only reached if the variance is not known to be
/// finite.
const LEAST: f64 = 1e-6;
/// Replicates from which the errors are computed.
const REPLICATES: u32 = 64;

/// Probability of termination q from vertex K on: 1 − the largest albedo of the scene, rounded down to two digits. If the
/// largest albedo is 1, a quarter of the fraction that second moments lose per vertex.
pub fn beyond(scene: &Scene) -> f64 {
    let rho = f64::from((scene.max_albedo() * scene.lit()).max_element());
    let loss = if rho < 1.0 {
        1.0 - rho
    } else if let Some((_, q)) = scene.last_resort() {
        // the same quarter of the same loss, measured when the scene was opened
        f64::from(q)
    } else {
        let t = SceneTransport::new(scene);
        let g = growth(&FromLight { t: &t, roulette: &Roulette::Never }, 0, 2, 0);
        0.25 * (1.0 - g.rate - CLEAR * g.std_error)
    };
    two_digits(loss).clamp(LEAST, 0.99)
}

fn amount(spp: u32, settings: &Settings, stream: &str) -> Amount {
    // the moments describe single samples: use independent random numbers even if the images use quasi-random points
    Amount { spp, replicates: spp.min(REPLICATES) as usize, key: Key::new(settings.seed, stream) }
}

/// Traces paths that are not ended by roulette before vertex K = `settings.max_bounces`, and records the mean products
/// E[X_j X_k] of what they contribute to the terms j and k. None if interrupted.
pub fn pilot(scene: &Scene, settings: &Settings, spp: u32, progress: Progress<'_>) -> Option<Recorded> {
    let [w, h] = scene.camera.size;
    pilot_of(scene, settings, spp, w * h, progress)
}

/// The same with only some pixels, spread evenly over the picture at random; all of them if there are no more.
pub fn pilot_of(scene: &Scene, settings: &Settings, spp: u32, pixels: u32, progress: Progress<'_>) -> Option<Recorded> {
    let roulette = Roulette::Constant { from: settings.max_bounces, q: beyond(scene) };
    let t = SceneTransport { scene, sampling: settings.sampling };
    let all = scene.camera.size[0] * scene.camera.size[1];
    progress.begin("cross moments", u64::from(pixels.min(all)) * u64::from(spp));
    let estimator = Vertices(Plan { roulette, ..settings.plan() });
    let amount = amount(spp, settings, "cross moments");
    if pixels >= all {
        return record(&t, &scene.camera, &estimator, amount, progress);
    }
    let key = Key::new(settings.seed, "pixels of the cross moments");
    record(&t, &SomePixels { camera: &scene.camera, pixels, key }, &estimator, amount, progress)
}

/// Measures the terms under `schedule`, applied from vertex 0 on as in the path tracer. The result is read with
/// [`Noise::measured`]. None if interrupted.
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

/// Wall-clock seconds per path under each schedule, without recording of moments. Each schedule is timed three times with
/// `spp` samples, and the smallest time counts. The schedules take turns, so that other load on the machine affects all of
/// them equally.
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

/// The quantity for which a schedule is optimal: the one whose variance · rays is minimised.
///
/// The whole image includes T^0 E, emission seen directly. Its variance is aliasing, for example at the edge of a lamp that is
/// seen. Roulette at later vertices cannot reduce it. Where it dominates, new camera paths are worth more than long ones, and the
/// optimum for the whole image ends most paths at once, although that makes indirect light much noisier. Direct light can
/// have the same effect (in `veach-mis` it has 25 % of the variance, indirect light 0.01 %), which is why
/// [`Aim::Indirect`] begins at k = 2 and not at k = 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// The whole image, Σ_{k≥0} T^k E.
    Whole,
    /// Indirect light, Σ_{k≥2} T^k E.
    Indirect,
}

impl Aim {
    /// Both quantities.
    pub const ALL: [Self; 2] = [Self::Whole, Self::Indirect];

    /// The terms that belong to the quantity.
    pub fn part(self) -> Part {
        match self {
            Self::Whole => Part::All,
            Self::Indirect => Part::INDIRECT,
        }
    }

    /// The name of the optimal schedule on the command line.
    pub fn schedule_name(self) -> &'static str {
        match self {
            Self::Whole => "optimal",
            Self::Indirect => "optimal-indirect",
        }
    }
}

impl fmt::Display for Aim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Whole { "whole" } else { "indirect" })
    }
}

impl FromStr for Aim {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

/// The schedule with the highest efficiency 1/(variance · cost) for one quantity, and its predicted noise.
#[derive(Clone, Debug)]
pub struct Optimal {
    /// The quantity whose variance is meant.
    pub aim: Aim,
    /// The schedule as a table: q at vertices 0 to K − 1, then the constant q from vertex K on.
    pub roulette: Roulette,
    /// Predicted noise and cost.
    pub noise: Noise,
    /// Its efficiency for `aim` divided by that of the lecture's schedule. Both schedules are tables up to K with the same q
    /// beyond.
    pub gain: Value,
}

/// The best schedule for a quantity, from a recording made by [`pilot`]. The prediction uses the same paths that chose
/// the schedule, so that it is slightly too optimistic.
pub fn best(recorded: &Recorded, scene: &Scene, aim: Aim) -> Option<Optimal> {
    let roulette = schedule(&optimal_reach(&Separable::of(&recorded.all, aim.part())), beyond(scene));
    let noise = Noise::predicted(recorded, &roulette)?;
    let gain = gain(recorded, &roulette, &lecture(recorded, scene)?, aim.part())?;
    Some(Optimal { aim, roulette, noise, gain })
}

/// The lecture's schedule as a table up to vertex K of a recording, then with the same constant q as every predicted schedule.
pub fn lecture(recorded: &Recorded, scene: &Scene) -> Option<Roulette> {
    Roulette::LECTURE.then((recorded.all.slots / 2).checked_sub(1)?, beyond(scene))
}

/// How many times the rays of the lecture's schedule another schedule needs for the same error, for parts of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Relative {
    /// Terms k = 0 to 4, or to K if K is less. NaN for a term without noise.
    pub terms: Vec<Value>,
    /// The whole image.
    pub whole: Value,
    /// Indirect light, k ≥ 2.
    pub indirect: Value,
}

impl Relative {
    /// The prediction for the schedule `of`, from a recording made by [`pilot`]. None if its q depends on more than the number of
    /// the vertex, as in roulette by albedo.
    pub fn predicted(recorded: &Recorded, scene: &Scene, of: &Roulette) -> Option<Self> {
        let base = lecture(recorded, scene)?;
        // work of one schedule over that of the other is the gain of the other over the one
        let rays = |part: Part| gain(recorded, &base, of, part);
        let terms = (0..(recorded.all.slots / 2).min(5)).map(|k| rays(Part::Term(k))).collect::<Option<_>>()?;
        Some(Self { terms, whole: rays(Part::All)?, indirect: rays(Part::INDIRECT)? })
    }

    /// The number for one quantity.
    pub fn of(&self, aim: Aim) -> Value {
        if aim == Aim::Whole { self.whole } else { self.indirect }
    }
}

/// The best schedule of a scene with these settings for one quantity. The pilot run uses random numbers that no render uses. None if
/// interrupted.
///
/// ```
/// use fredholm::scene::{Scene, load};
/// use fredholm::engine::Settings;
/// use fredholm::progress::Progress;
/// use fredholm::study::roulette;
///
/// let options = load::Options { set: vec!["camera.size=[8,8]".into()], ..Default::default() };
/// let scene = Scene::new(&load::scene("cornell", &options)?.description);
/// let best = roulette::optimal(&scene, &Settings::default(), roulette::Aim::Whole, Progress::NONE);
/// assert!(best.is_some_and(|b| b.gain.value > 1.0));
/// # Ok::<(), fredholm::scene::SceneError>(())
/// ```
pub fn optimal(scene: &Scene, settings: &Settings, aim: Aim, progress: Progress<'_>) -> Option<Optimal> {
    let settings = Settings { max_bounces: settings.max_bounces.clamp(DEPTH[0], DEPTH[1]), ..settings.clone() };
    let [w, h] = scene.camera.size.map(u64::from);
    let spp = (PILOT / (w * h)).clamp(8, 1 << 12) as u32;
    best(&pilot(scene, &settings, spp, progress)?, scene, aim)
}

/// A roulette schedule as the user requests it.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// A schedule given explicitly.
    Given(Roulette),
    /// Termination by the light that a guide expects the rest of the path to find.
    ByExpectation(ByExpectation),
    /// The schedule with the highest efficiency for one quantity; it must first be computed for the scene by [`optimal`].
    Optimal(Aim),
}

impl Schedule {
    /// The schedule for walks without a guide. None if it must first be computed.
    pub fn given(&self) -> Option<Roulette> {
        match self {
            Self::Given(roulette) => Some(roulette.clone()),
            Self::ByExpectation(end) => Some(end.plain()),
            Self::Optimal(_) => None,
        }
    }

    /// The quantity for which the schedule must first be computed. None if the schedule is known.
    pub fn aim(&self) -> Option<Aim> {
        if let Self::Optimal(aim) = self { Some(*aim) } else { None }
    }
}

impl fmt::Display for Schedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Given(roulette) => roulette.fmt(f),
            Self::ByExpectation(end) => end.fmt(f),
            Self::Optimal(aim) => f.write_str(aim.schedule_name()),
        }
    }
}

/// Parses `optimal`, `optimal-indirect`, or a schedule in the syntax of [`ByExpectation`] or [`Roulette`].
impl FromStr for Schedule {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(aim) = Aim::ALL.into_iter().find(|aim| aim.schedule_name() == text) {
            return Ok(Self::Optimal(aim));
        }
        if let Ok(end) = text.parse() {
            return Ok(Self::ByExpectation(end));
        }
        let more =
            |why: String| if why.starts_with("unknown") { why + "; contribution[@V] or window[@V]" } else { why };
        text.parse().map(Self::Given).map_err(more)
    }
}

/// The constant q that a schedule reaches from some vertex on; none for schedules that depend on albedo or throughput.
pub fn constant(schedule: &Roulette) -> Option<f64> {
    match schedule {
        Roulette::Constant { q, .. } => Some(*q),
        Roulette::Table(q) => q.last().copied(),
        _ => None,
    }
}

/// Spectral radii of operators that are made from T, for roulette with the same q at every vertex. They decide whether mean and
/// variance of the path tracer are finite. Here s = 1 − q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// Spectral radius of ρ²F/s: below 1 if the variance is finite.
    pub second: f64,
    /// Spectral radius of ρ⁴F/s³: below 1 if the variance of the measured variance is finite.
    pub fourth: f64,
    /// True if the values are only upper bounds, computed from the largest albedo.
    pub bounds: bool,
}

impl Radii {
    /// The radii for walks that end with probability `q` at every vertex; the largest of the three channels.
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

    /// The answer for the variance, where it is known. An upper bound can only prove that the variance is finite.
    pub fn variance(&self) -> Option<Variance> {
        match (self.second < 1.0, self.bounds) {
            (true, true) => Some(Variance::Finite),
            (false, false) => Some(Variance::Infinite),
            _ => None,
        }
    }

    /// A warning that belongs to an error bar, if one is needed. The words continue a sentence that begins with the name of
    /// the estimator.
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
                 max ρ⁴/(1−q)³ = {fourth:.3} ≥ 1 does not exclude that the variance of the measured variance is infinite"
            )),
            _ => None,
        }
    }
}
