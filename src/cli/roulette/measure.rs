//! Renders schedules: their noise, their images, and with `--optimise` their seconds.

use super::args::Args;
use fredholm::engine::Settings;
use fredholm::estimator;
use fredholm::progress::Progress;
use fredholm::report::figures::roulette::{Row, Shown};
use fredholm::scene::Scene;
use fredholm::stats::Noise;
use fredholm::study::roulette::{self, Aim};

/// Renders the schedules that must be rendered, and returns their images.
pub(super) fn measure(
    args: &Args,
    (scene, settings): (&Scene, &Settings),
    all: &mut [Row],
    schedules: &[estimator::Roulette],
    progress: Progress<'_>,
) -> Vec<Shown> {
    let mut shown = vec![];
    if args.verify || args.optimise {
        for (row, schedule) in all.iter_mut().zip(schedules) {
            if args.verify || rivals(args).contains(&row.name.as_str()) {
                let Some(measured) = roulette::measure(scene, settings, schedule, args.spp, progress) else { break };
                row.measured = Some(Noise::measured(&measured));
                let (image, emission) = (measured.image, measured.emission);
                shown.push(Shown { name: row.name.clone(), image, emission });
            }
        }
    }
    if args.optimise && !progress.stopped() {
        let spp = (args.spp / 4).max(1);
        let seconds = roulette::seconds_per_path(scene, settings, schedules, spp);
        all.iter_mut().zip(seconds).for_each(|(row, s)| row.seconds = Some(s));
    }
    shown
}

/// The schedules that --optimise always renders.
pub(super) fn rivals(args: &Args) -> Vec<&'static str> {
    ["lecture", "albedo"].into_iter().chain(args.aims().into_iter().map(Aim::schedule_name)).collect()
}
