//! The norms ‖T^k E‖₁ of the terms over the whole scene, measured with the surface sensor.
//!
//! The norm is `∫∫ (T^k E)(x, ω) cos θ dω dA / (πA)`, with A the total area of all surfaces. It is estimated by the plain
//! mean over uniform surface points and cosine-distributed directions. The estimate is unbiased and does not depend on the
//! camera. For the matrix, the same number is `Σ A_i (T_h^k E)_i / A`. The bounds that follow from ‖T‖₁ ≤ max albedo hold
//! for this norm.

use super::strip;
use crate::engine::Settings;
use crate::engine::by_rays::{Begins, Estimator};
use crate::operator::{SceneTransport, SurfaceStrip};
use crate::progress::Progress;
use crate::scene::{Scene, SurfaceSensor};
use crate::terms::functional::Replicates;

/// Number of pixels in the strip; the paths of different pixels are traced in parallel.
const STRIP: u32 = 256;

/// The surface norms of all terms, one value per replicate, from about `paths` paths in total. An estimator that starts
/// paths at the lights is replaced by [`Estimator::Prefix`].
pub fn norms(
    scene: &Scene,
    estimator: Estimator,
    paths: u32,
    settings: &Settings,
    progress: Progress<'_>,
) -> Replicates {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let sensor = SurfaceStrip { sensor: SurfaceSensor::new(scene), pixels: STRIP };
    progress.begin(&format!("surface norms, {estimator}"), u64::from(strip::samples(paths, STRIP)) * u64::from(STRIP));
    let name = format!("surface {estimator}");
    // paths from the lights cannot be connected to this sensor
    let estimator = if estimator.begins() == Begins::AtEye { estimator } else { Estimator::Prefix };
    strip::means(&t, &sensor, estimator, &name, paths, settings, progress)
}
