//! ‖T^k E‖₁ over the whole scene: the terms as the surface sensor sees them.
//!
//! `∫∫ (T^k E)(x, ω) cos θ dω dA / (πA)`, the plain mean over uniform surface points and cosine-distributed directions: camera-free,
//! unbiased, and the same number as `Σ A_i (T_h^k E)_i / A` of the matrix. The bounds of ‖T‖₁ ≤ max albedo hold for it.

use crate::engine::Settings;
use crate::engine::by_rays::{self, Begins, Estimator};
use crate::estimator::render::Amount;
use crate::operator::{SceneTransport, SurfaceStrip};
use crate::progress::Progress;
use crate::scene::{Scene, SurfaceSensor};
use crate::terms::functional::{Replicates, image_replicates};

/// Replicates behind the errors: enough for a covariance of ten terms.
const REPLICATES: u32 = 64;
/// Paths that run side by side.
const STRIP: u32 = 256;

/// The surface norms of the terms, replicate by replicate, from about `paths` paths.
pub fn norms(
    scene: &Scene,
    estimator: Estimator,
    paths: u32,
    settings: &Settings,
    progress: Progress<'_>,
) -> Replicates {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let strip = SurfaceStrip { sensor: SurfaceSensor::new(scene), pixels: STRIP };
    let spp = (paths / STRIP).next_multiple_of(REPLICATES).max(REPLICATES);
    let key = settings.key(&format!("surface {estimator}"), REPLICATES as usize);
    let amount = Amount { spp, replicates: REPLICATES as usize, key };
    progress.begin(&format!("surface norms, {estimator}"), u64::from(spp) * u64::from(STRIP));
    // walks from the light cannot be led to this sensor
    let estimator = if estimator.begins() == Begins::AtEye { estimator } else { Estimator::Prefix };
    let film = by_rays::film(&t, &strip, estimator, settings.plan(), amount, &mut by_rays::Passes::of(progress));
    image_replicates(&film)
}
