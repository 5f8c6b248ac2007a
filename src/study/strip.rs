//! The terms as a sensor without an image sees them: all pixels of a strip see the same, so only means remain.
//!
//! Without an image, long series and many surfaces cost little memory. Surface norms, long terms and light by surface use it.

use crate::engine::Settings;
use crate::engine::by_rays::{self, Estimator};
use crate::engine::passes::Passes;
use crate::estimator::Roulette;
use crate::estimator::render::Amount;
use crate::operator::{SceneTransport, Sensor};
use crate::progress::Progress;
use crate::scene::{Scene, bsdf::Sampling};
use crate::terms::Variance;
use crate::terms::functional::{Replicates, image_replicates};

/// Replicates from which the errors are computed: enough for a covariance matrix of ten terms.
const REPLICATES: u32 = 64;

/// Samples of each pixel of a strip of `pixels`, for about `paths` paths in total.
pub(super) fn samples(paths: u32, pixels: u32) -> u32 {
    (paths / pixels).next_multiple_of(REPLICATES).max(REPLICATES)
}

/// The means of all terms, replicate by replicate, from about `paths` paths. `name` is that of the stream of random numbers.
pub(super) fn means<'s>(
    t: &SceneTransport<'s>,
    sensor: &impl Sensor<SceneTransport<'s>>,
    estimator: Estimator,
    name: &str,
    paths: u32,
    settings: &Settings,
    progress: Progress<'_>,
) -> Replicates {
    let replicates = REPLICATES as usize;
    let spp = samples(paths, sensor.size()[0]);
    let amount = Amount { spp, replicates, key: settings.key(name, replicates) };
    let film = by_rays::film(t, sensor, estimator, settings.plan(), amount, &mut Passes::of(progress));
    image_replicates(&film)
}

/// The settings for terms up to k = `last` by prefixes of paths that end by albedo from vertex `from` on. None where the
/// variance of such paths is not known to be finite.
pub(super) fn settings(scene: &Scene, last: usize, from: usize, settings: &Settings) -> Option<Settings> {
    let settings = Settings {
        max_bounces: last,
        sampling: Sampling::Bsdf,
        roulette: Roulette::Albedo { from },
        points: Default::default(),
        ..settings.clone()
    };
    let t = SceneTransport { scene, sampling: Sampling::Bsdf };
    (by_rays::variance(&t, Some(Estimator::Prefix), &settings) == Variance::Finite).then_some(settings)
}
