//! A caustic, and what three estimators find of it.
//!
//! ```text
//! from the eye, with connections:   not L S … E of a light without area        from the light:   not L … S E
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L, E | the lamp, the eye | [`Light`] |
//! | S, D | a reflection or refraction at glass; a reflection at the floor | – |
//! | L D E, L S D E, L S S D E | what the eye sees on the floor: k = 1, 2, 3 | [`Found::floor`] |
//! | L D S E, L D S S E | the floor seen in the glass: k = 2, 3 | [`Found::ball`] |
//!
//! Reference: Heckbert, *Adaptive radiosity textures for bidirectional ray tracing* (1990).

use super::glass::without_roulette;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::description::LightDescription;
use fredholm::scene::{Description, Scene, load};
use fredholm::terms::TermImage;
use fredholm::zoo::{self, Mistake};
use glam::DVec3;

/// The light of the scene `caustic`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// The lamp of 60 W, a disk of this radius.
    Disk(f64),
    /// A point light in its place, with the intensity of the lamp along its axis.
    Point,
}

/// K: two refractions, the floor, two refractions.
pub(super) const LAST: usize = 5;

/// What one estimator finds.
#[derive(Clone, Debug)]
pub struct Found {
    /// Samples per pixel: walks from the eye, or particles divided by the number of pixels.
    pub spp: u32,
    /// The sum of the terms k ≤ 5.
    pub image: Vec<[f32; 3]>,
    /// T^k E for k = 0, …, 5, mean over the pixels that show only the floor.
    pub floor: Vec<Number>,
    /// The same over the pixels that show only the glass.
    pub ball: Vec<Number>,
}

/// The scene `caustic` with another light or camera.
fn scene(light: Light, mut set: Vec<String>) -> book::Result<Description> {
    if let Light::Disk(radius) = light {
        set.push(format!("shapes.2.radius={radius}"));
    }
    let mut scene = load::scene("caustic", &load::Options { set, ..load::Options::default() })?.description;
    if light == Light::Point {
        scene.shapes.truncate(2); // the floor and the ball
        let (position, intensity) = (DVec3::new(-0.8, 3.0, -0.4), DVec3::splat(60.0 / std::f64::consts::PI));
        scene.lights = vec![LightDescription::Point { position, intensity }];
    }
    Ok(scene)
}

// ANCHOR: found
/// The scene by a path tracer with connections, by a light tracer, and by a bidirectional estimator.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn found(folder: &Folder<'_>, light: Light) -> book::Result<[Found; 3]> {
    let size = folder.pick(128, 64);
    let scene = Scene::new(&scene(light, vec![format!("camera.size=[{size}, {size}]")])?);
    let pixels = [false, true].map(|glass| showing(&scene, glass));
    let by = |estimator, technique, spp| {
        let settings = Settings { max_bounces: LAST, technique, ..without_roulette(folder, spp) };
        let light = by_rays::terms(&scene, estimator, &settings, folder.progress);
        let [floor, ball] = pixels.each_ref().map(|p| light.terms.iter().map(|term| mean(term, p)).collect());
        Found { spp, image: light.sum.mean, floor, ball }
    };
    Ok([
        by(Estimator::Prefix, Technique::Connect, folder.pick(32, 16)),
        by(Estimator::Light, Technique::Mis, folder.pick(128, 64)),
        by(Estimator::Bidirectional, Technique::Mis, folder.pick(32, 16)),
    ])
}
// ANCHOR_END: found

/// The pixels in which the camera sees only glass, or only other surfaces: at the corners and in the middle.
fn showing(scene: &Scene, glass: bool) -> Vec<usize> {
    const INSIDE: f32 = 0.999;
    let places = [[0.0, 0.0], [INSIDE, 0.0], [0.0, INSIDE], [INSIDE, INSIDE], [0.5, 0.5]];
    let sees = |pixel: u32, u: [f32; 2]| {
        let (origin, direction) = scene.camera.ray(pixel, u);
        scene.trace(origin, direction).is_some_and(|at| scene.bsdf(&at).has_delta() == glass)
    };
    let [w, h] = scene.camera.size;
    (0..w * h).filter(|&pixel| places.iter().all(|&u| sees(pixel, u))).map(|pixel| pixel as usize).collect()
}

/// Mean over some pixels. A particle adds to at most one pixel of a term, so the errors of the pixels are those of
/// independent counts.
fn mean(term: &TermImage, pixels: &[usize]) -> Number {
    let n = pixels.len() as f64;
    let sum: f64 = pixels.iter().map(|&p| f64::from(term.mean[p][0])).sum();
    let squares: f64 = pixels.iter().map(|&p| f64::from(term.std_error[p][0]).powi(2)).sum();
    Number { value: sum / n, std_error: squares.sqrt() / n }
}

// ANCHOR: caustic
/// The caustic of a lamp of radius 0.4 m, k = 2 and 3, by the path tracer and by the light tracer. The camera is below the
/// ball and sees only the floor.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn caustic(folder: &Folder<'_>, step: &dyn Mistake) -> book::Result<[Number; 2]> {
    let camera =
        "camera={ origin = [0.34, 0.38, 0.6], target = [0.34, 0, 0.17], up = [0, 1, 0], fov = 30, size = [64, 64] }";
    let scene = Scene::new(&scene(Light::Disk(0.4), vec![camera.into()])?);
    let settings = |spp| Settings { max_bounces: 3, ..without_roulette(folder, spp) };
    let plan = Plan { max_bounces: 3, technique: Technique::Connect, roulette: Roulette::Never };
    let path = zoo::of(&plan, step, "caustic", &scene, &settings(folder.pick(256, 64)), folder.progress);
    let light = by_rays::terms(&scene, Estimator::Light, &settings(folder.pick(512, 128)), folder.progress);
    Ok([path, light].map(|found| (&found.replicates.estimate(2..4)).into()))
}
// ANCHOR_END: caustic
