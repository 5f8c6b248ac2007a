//! The error of an image against the number of paths, for four ways to draw the paths of one pixel.
//!
//! ```text
//! RMSE² = ⟨(L_N − L)²⟩ = σ²/N + b²        ln V(N) = ln c + b ln N
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | ⟨ ⟩ | mean over pixels and channels | [`fredholm::terms::scatter`] |
//! | L | reference from independent paths; its own noise is subtracted | [`reference`] |
//! | V, b | variance of the pixels, fitted slope | [`Curve::slope`] |
//! | b² | square of the bias: it does not fall with N | [`Curve::bias`] |
//!
//! Reference: Veach (1997), sections 2.4 and 2.5.

use fredholm::estimator::render::{Amount, render, render_in_passes};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::math::{Key, Points};
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::Scene;
use fredholm::study::convergence::{NoiseCurve, Recorder, Reference};
use fredholm::terms::functional::image_replicates;
use fredholm::terms::scatter::Scatter;
use fredholm::terms::{TermFilm, TermImage, Variance};
use fredholm::zoo::{Mistake, Right, Walk, walk::Whole};

/// The largest value of a clamped path.
pub(super) const CLAMP: f32 = 0.25;
/// Replicates of a film whose image mean gets an error.
const MANY: usize = 128;

/// The error of one way to draw paths.
#[derive(Clone, Debug)]
pub struct Curve {
    /// N, and the RMSE of an image of N paths.
    pub rmse: Vec<(u32, Number)>,
    /// Slope of the variance; none if it does not fall.
    pub slope: Option<Number>,
    /// Mean of the image over that of the reference, minus 1, at the largest N.
    pub bias: Number,
}

/// The lower part of the Cornell box: no pixel shows the lamp.
pub(super) fn room(folder: &Folder<'_>) -> book::Result<Scene> {
    let size = folder.pick(32, 24);
    super::load(
        "cornell",
        &[format!("camera.size=[{size}, {size}]"), "camera.target=[0, -0.3, 0]".into(), "camera.fov=26".into()],
    )
}

/// Light with at most two reflections.
fn plan() -> Plan {
    Plan { max_bounces: 2, technique: Technique::Connect, roulette: Roulette::Never }
}

/// An image of many paths, by another estimator and from other random numbers.
pub(super) fn reference(room: &Scene, folder: &Folder<'_>) -> (Reference, Number) {
    let amount = Amount::new(folder.pick(8192, 1024), Key::new(folder.seed, "reference"));
    let film = render(&SceneTransport::new(room), &room.camera, &Prefix(plan()), amount, folder.progress);
    let total = TermImage::of(&film, 0..film.shape.slots);
    (Reference { total, ..Reference::default() }, mean(&film))
}

/// Mean of the image over pixels and channels.
pub(super) fn mean(film: &TermFilm) -> Number {
    let all = image_replicates(film);
    let grey = |x: &dyn Fn(usize) -> f64| (0..3).map(x).sum::<f64>() / 3.0;
    let slots = 0..film.shape.slots;
    let value = grey(&|c| slots.clone().map(|s| all.mean[s][c]).sum());
    // the channels of a path depend on each other, so the error is that of their sum
    let of = |d: &Vec<glam::DVec3>| grey(&|c| slots.clone().map(|s| d[s][c]).sum()).powi(2);
    let r = all.deviation.len() as f64;
    Number { value, std_error: (all.deviation.iter().map(of).sum::<f64>() * r / (r - 1.0)).sqrt() }
}

// ANCHOR: curve
/// Renders once, and looks at the film when every pixel has N = 16, 32, 64, … paths.
pub(super) fn curve(
    room: &Scene,
    mistake: &dyn Mistake,
    points: Points,
    (reference, right): &(Reference, Number),
    folder: &Folder<'_>,
) -> book::Result<Curve> {
    let amount = Amount::new(folder.pick(1024, 256), Key::new(folder.seed, "curve").with_points(points, 16));
    let estimator = Whole(Walk { plan: plan(), mistake });
    let mut recorder = Recorder::new(Some(reference), vec![]);
    let t = SceneTransport::new(room);
    let film = render_in_passes(&t, &room.camera, &estimator, amount, folder.progress, &mut |film, planned| {
        recorder.look(film);
        planned
    });
    let stands = recorder.stands();
    let slope = NoiseCurve::all(&stands, true, Variance::Finite).pop().and_then(|curve| curve.slope());
    Ok(Curve {
        rmse: stands.iter().map(|s| (s.spp, rmse(&s.parts[0]))).collect(),
        slope: slope.map(|s| Number { value: s.slope, std_error: s.std_error }),
        bias: mean(&film).over(*right).minus(Number { value: 1.0, std_error: 0.0 }),
    })
}
// ANCHOR_END: curve

/// √MSE, with the error of a square root.
fn rmse(scatter: &Scatter) -> Number {
    let root = scatter.squared_error().unwrap_or(f64::NAN).sqrt();
    Number { value: root, std_error: scatter.squared_error_error() / (2.0 * root) }
}

// ANCHOR: same
/// Every pixel uses the random numbers of pixel 0.
struct SameInAllPixels;
impl Mistake for SameInAllPixels {
    fn address(&self, _pixel: u32, sample: u32) -> (u32, u32) {
        (0, sample)
    }
}
// ANCHOR_END: same

/// The same numbers in all pixels, over different ones: noise of a pixel, error of the mean of the image.
pub(super) fn same_in_all_pixels(room: &Scene, folder: &Folder<'_>) -> [Number; 2] {
    let found = |mistake: &dyn Mistake, stream: &str| {
        let amount = Amount { spp: folder.pick(256, 128), replicates: MANY, key: Key::new(folder.seed, stream) };
        let estimator = Whole(Walk { plan: plan(), mistake });
        let film = render(&SceneTransport::new(room), &room.camera, &estimator, amount, folder.progress);
        let scatter = Scatter::of(&film, 0..1, None);
        let pixel = scatter.variance().sqrt();
        let se = mean(&film).std_error;
        // the relative error of a standard deviation from R replicates is 1/√(2(R − 1))
        let relative = 1.0 / (2.0 * (MANY as f64 - 1.0)).sqrt();
        [
            Number { value: pixel, std_error: scatter.variance_error() / (2.0 * pixel) },
            Number { value: se, std_error: relative * se },
        ]
    };
    let ([a, b], [c, d]) = (found(&SameInAllPixels, "same"), found(&Right, "different"));
    [a.over(c), b.over(d)]
}
