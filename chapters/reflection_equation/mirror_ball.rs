//! The captured environment: a photograph of a mirror ball in a room, used as the sky for another object.
//!
//! ```text
//! L_i(x, ω) ≈ L_i(0, ω)      0: the place of the mirror ball
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_i(0, ω) | light that arrives at the ball, from almost all directions | `photo` |
//! | L_r | light that the object reflects, in the room or under the photograph | `brightness` |
//!
//! Reference: Paul Debevec, *Rendering synthetic objects into real scenes*, SIGGRAPH 1998.

use fredholm::engine::{Settings, by_rays};
use fredholm::estimator::Roulette;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::description::{LightDescription, Sky};
use fredholm::scene::{Description, Scene, SceneError, load, raster::Raster};
use fredholm::terms::TermImage;
use glam::Vec3;
use std::sync::Arc;

const MIRROR: &str = "{ type = 'mirror', reflectance = [1, 1, 1] }";
const OBJECT: &str = "{ type = 'plastic', reflectance = [0.7, 0.7, 0.7], alpha = 0.2 }";

/// Images of the mirror ball and of the object, all from 200 radii away.
#[derive(Clone, Debug)]
pub struct Captured {
    /// The mirror ball of radius 5 cm.
    pub photo: TermImage,
    /// The object under the photograph.
    pub under: TermImage,
    /// The object under the photograph with radiance cut at 1.
    pub under_clipped: TermImage,
    /// Radius of the object in metres, and the object in the room.
    pub in_room: Vec<(f64, TermImage)>,
}

impl Captured {
    /// Radius of the object, and its brightness under the photograph divided by that in the room, minus 1.
    pub fn differences(&self) -> Vec<(f64, Number)> {
        let under = brightness(&self.under);
        self.in_room.iter().map(|(r, image)| (*r, excess(under, brightness(image)))).collect()
    }

    /// The same for the smallest object and the photograph that is cut at 1.
    pub fn clipped(&self) -> Number {
        excess(brightness(&self.under_clipped), brightness(&self.in_room[0].1))
    }
}

/// The Cornell box with a ball in place of the tall block.
fn room(folder: &Folder<'_>, material: &str, radius: f64) -> Result<Description, SceneError> {
    let set = vec![
        format!("materials.ball={material}"),
        format!(
            "shapes[7]={{ name = 'ball', type = 'sphere', center = [0, 0, 0], radius = {radius}, material = 'ball' }}"
        ),
        format!("camera.origin=[0, 0, {}]", 200.0 * radius),
        format!("camera.fov={}", 2.0 * (1.0f64 / 200.0).asin().to_degrees()), // the ball touches the edges of the image
        format!("camera.size=[{0}, {0}]", folder.pick(144, 48)),
    ];
    Ok(load::scene("cornell", &load::Options { set, ..load::Options::default() })?.description)
}

/// Takes the photograph, and renders the object under it and in the room. `white` is the largest radiance that the
/// photograph can hold.
pub fn capture(folder: &Folder<'_>, white: f32) -> book::Result<Captured> {
    let settings = Settings { spp: 64, seed: folder.seed, ..Settings::default() };
    let see = |scene: &Description| by_rays::path(&Scene::new(scene), &settings, folder.progress).total;
    // ANCHOR: capture
    let photo = see(&room(folder, MIRROR, 0.05)?);
    let under = |white: f32| -> book::Result<TermImage> {
        let texels = photo.mean.iter().map(|&radiance| Vec3::from(radiance).min(Vec3::splat(white))).collect();
        let photo = Raster::new([folder.pick(144, 48); 2], texels);
        let mut object = room(folder, OBJECT, 0.05)?;
        object.shapes.retain(|shape| shape.name == "ball"); // no room, only its photograph
        object.lights =
            vec![LightDescription::Environment { sky: Sky::MirrorBall(Arc::new(photo)), rotate: 0.0, scale: 1.0 }];
        let once = Settings { max_bounces: 1, roulette: Roulette::Never, ..settings.clone() };
        let found = by_rays::terms(&Scene::new(&object), by_rays::Estimator::Prefix, &once, folder.progress);
        Ok(found.terms[1].clone())
    };
    // ANCHOR_END: capture
    let (lit, clipped) = (under(white)?, under(white.min(1.0))?);
    let object = |radius| -> book::Result<_> { Ok((radius, see(&room(folder, OBJECT, radius)?))) };
    let in_room = [0.05, 0.1, 0.3].into_iter().map(object).collect::<book::Result<_>>()?;
    Ok(Captured { photo, under: lit, under_clipped: clipped, in_room })
}

/// x/y − 1.
pub fn excess(x: Number, y: Number) -> Number {
    let ratio = x.over(y);
    Number { value: ratio.value - 1.0, ..ratio }
}

/// Mean over the pixels inside the ball and over the three colours.
fn brightness(image: &TermImage) -> Number {
    let size = image.mean.len().isqrt();
    let from_middle = |i: usize| (2.0 * i as f64 + 1.0) / size as f64 - 1.0;
    let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for p in (0..size * size).filter(|&p| from_middle(p % size).hypot(from_middle(p / size)) < 0.95) {
        let [mean, error] = [image.mean[p], image.std_error[p]].map(|c| f64::from(c[0] + c[1] + c[2]) / 3.0);
        (n, sum, squares) = (n + 1.0, sum + mean, squares + error * error);
    }
    Number { value: sum / n, std_error: squares.sqrt() / n }
}
