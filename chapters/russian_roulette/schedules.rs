//! The price of a schedule: variance of one path times its rays, relative to the lecture's schedule.
//!
//! ```text
//! squared error of a budget of B rays = V · rays/B
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V · rays | inverse of the efficiency | [`Noise`] |
//! | lecture | q = 0, 0, 0.5, … up to vertex K, then the q of all schedules | [`roulette::lecture`] |
//! | best | the schedule with the least V · rays for one quantity | [`roulette::best`] |
//!
//! Schedules that depend on the path (albedo, throughput) are measured; all others are predicted from the moments.

use fredholm::engine::Settings;
use fredholm::estimator::Roulette;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::Scene;
use fredholm::stats::schedule::{Noise, Part, gain};
use fredholm::study::roulette::{self, Aim, Relative};
use fredholm::terms::cross_moments::Recorded;

/// One schedule.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Its rays per path.
    pub rays: Number,
    /// Rays for the same error of the whole image, relative to the lecture's.
    pub whole: Number,
    /// The same for indirect light.
    pub indirect: Number,
    /// q at the first vertices; none if it depends on the path.
    pub q: Option<Vec<f64>>,
}

/// Predicts and measures. Also returns how many times the rays of the best schedule for one quantity the best one for the
/// other needs: for the whole image, then for indirect light.
pub(super) fn compare(
    folder: &Folder<'_>,
    scene: &Scene,
    settings: &Settings,
    recorded: &Recorded,
) -> book::Result<(Vec<Row>, [Number; 2])> {
    let stopped = "stopped";
    let then = |s: Roulette| s.then(settings.max_bounces, roulette::beyond(scene)).ok_or(stopped);
    let [whole, indirect] = Aim::ALL.map(|aim| roulette::best(recorded, scene, aim).ok_or(stopped));
    let (whole, indirect) = (whole?.roulette, indirect?.roulette);
    let lecture = roulette::lecture(recorded, scene).ok_or(stopped)?;
    let mut rows = vec![];
    for (name, s) in [
        ("none", then(Roulette::Never)?),
        ("constant, q = 0.2 from vertex 0", then(Roulette::Constant { from: 0, q: 0.2 })?),
        ("lecture, q = 0.5 from vertex 2", lecture.clone()),
        ("best for the whole image", whole.clone()),
        ("best for indirect light", indirect.clone()),
    ] {
        let price = Relative::predicted(recorded, scene, &s).ok_or(stopped)?;
        let rays = Noise::predicted(recorded, &s).ok_or(stopped)?.rays;
        let q = (0..5).map(|v| s.fixed(v)).collect();
        rows.push(Row { name: name.into(), rays, whole: price.whole, indirect: price.indirect, q });
    }
    let base = Noise::predicted(recorded, &lecture).ok_or(stopped)?;
    for (name, s) in [("albedo", Roulette::Albedo { from: 2 }), ("throughput", Roulette::Throughput { from: 2 })] {
        let found = roulette::measure(scene, settings, &s, folder.pick(256, 128), folder.progress).ok_or(stopped)?;
        let noise = Noise::measured(&found);
        rows.push(Row {
            name: format!("{name}, from vertex 2"),
            rays: noise.rays,
            whole: base.efficiency.over(noise.efficiency),
            indirect: base.indirect_efficiency.over(noise.indirect_efficiency),
            q: None,
        });
    }
    let for_whole = gain(recorded, &whole, &indirect, Part::All).ok_or(stopped)?;
    let for_indirect = gain(recorded, &indirect, &whole, Part::INDIRECT).ok_or(stopped)?;
    Ok((rows, [for_whole, for_indirect]))
}
