//! The rendering equation as a test: compares estimates of L and of E + T L at points and directions of a scene.
//!
//! ```text
//! d_r = (L − (E + T L))(x), replicate r        t = d̄ / (s_d/√R)        p = P(|T_{R−1}| ≥ |t|)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x | a point with a direction: chosen by the surface sensor, or seen through a pixel | [`points`] |
//! | L, E + T L | the two sides, estimated from independent paths | [`Balance`] |
//! | p | p-value of "no difference at this point", for the mean over channels and for each channel | [`Balance::p`], [`Balance::channels`] |
//! | aggregate | mean of d over all points | [`aggregate`] |
//! | verdict | on all points together, at level α | [`judge`] |
//!
//! The error of an aggregate contains only the noise at its points. It does not contain the random choice of points, because
//! the equation must hold at every point.

mod balance;
mod judge;

pub use balance::{Balance, aggregate, evidence};
pub use judge::{Group, Judgement, judge};

use crate::engine::Settings;
use crate::engine::by_rays::variance;
use crate::estimator::render::{Amount, render};
use crate::estimator::{Equilibrium, Plan};
use crate::math::{Key, Purpose, Rng};
use crate::operator::{SceneTransport, Sensor, Transport};
use crate::progress::Progress;
use crate::scene::{Scene, SurfaceSensor, Vertex};
use crate::terms::TermImage;

/// Replicates per point.
pub const REPLICATES: usize = 32;

/// A sensor with one pixel per given point.
struct Fixed<'a>(&'a [Vertex]);

impl Sensor<SceneTransport<'_>> for Fixed<'_> {
    fn size(&self) -> [u32; 2] {
        [self.0.len() as u32, 1]
    }
    fn start(&self, _: &SceneTransport<'_>, pixel: u32, _: &mut Rng) -> Option<Vertex> {
        Some(self.0[pixel as usize])
    }
}

/// Source of the random points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Points uniform on all surfaces, with cosine-distributed directions.
    Surface,
    /// Points seen through random pixels of the camera.
    Camera,
}

/// Returns `n` random points, or fewer if most camera rays hit no surface.
pub fn points(scene: &Scene, from: Origin, n: u32, seed: u64) -> Vec<Vertex> {
    let key = Key::new(seed, "points of equilibrium");
    let t = SceneTransport::new(scene);
    let [w, h] = scene.camera.size;
    let sensor = SurfaceSensor::new(scene);
    let one = |i: u32| {
        let mut rng = Rng::at(key, i, from as u32, 0, Purpose::Start);
        match from {
            Origin::Surface => Some(sensor.vertex(scene, &mut rng)),
            Origin::Camera => {
                let pixel = ((f64::from(rng.one()) * f64::from(w * h)) as u32).min(w * h - 1);
                scene.camera.start(&t, pixel, &mut rng).filter(|x| x.on_surface())
            }
        }
    };
    (0..64 * n).filter_map(one).take(n as usize).collect()
}

/// The estimator of both sides. `factor` multiplies the weight of the step in E + T L; 1 leaves the equation correct, any
/// other value breaks it on purpose.
fn estimator(settings: &Settings, factor: f32) -> Equilibrium {
    Equilibrium { plan: Plan { roulette: settings.path_roulette.clone(), ..settings.plan() }, factor }
}

/// Estimates both sides at the given points, with `settings.spp` samples each.
pub fn at_points(
    scene: &Scene,
    at: &[Vertex],
    settings: &Settings,
    factor: f32,
    progress: Progress<'_>,
) -> Vec<Balance> {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let key = settings.key("equilibrium at points", REPLICATES);
    let amount = Amount { spp: settings.spp, replicates: REPLICATES.min(settings.spp as usize), key };
    progress.begin("L and E + T L at points", at.len() as u64 * u64::from(settings.spp));
    let film = render(&t, &Fixed(at), &estimator(settings, factor), amount, progress);
    let variance = variance(&t, None, settings);
    let balance = |(i, x): (usize, &Vertex)| Balance::of(&film, i, *x, t.emission(x).as_dvec3(), variance);
    at.iter().enumerate().map(balance).collect()
}

/// Estimates both sides through the camera: returns the image of L and the image of E + T L.
pub fn through_camera(scene: &Scene, settings: &Settings, factor: f32, progress: Progress<'_>) -> [TermImage; 2] {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let replicates = REPLICATES.min(settings.spp as usize);
    let amount =
        Amount { spp: settings.spp, replicates, key: settings.key("equilibrium through the camera", replicates) };
    let [w, h] = scene.camera.size;
    progress.begin("L and E + T L through the camera", u64::from(w) * u64::from(h) * u64::from(settings.spp));
    let film = render(&t, &scene.camera, &estimator(settings, factor), amount, progress);
    [0, 1].map(|slot| TermImage::of(&film, slot..slot + 1))
}
