//! The scene `veach-mis`: the points of its plates that the camera sees, and the scene with one lamp only.

use fredholm::report::book;
use fredholm::scene::description::Geometry;
use fredholm::scene::{Description, Scene, Side, Vertex, load};
use glam::DVec3;

/// Number of plates, and of lamps. The plates are the first shapes of the scene, from smooth to rough.
pub const PLATES: usize = 4;
/// α of each plate, and the radius of each lamp in metres.
pub const ALPHA: [f64; PLATES] = [0.005, 0.02, 0.06, 0.2];
/// See [`ALPHA`].
pub const RADIUS: [f64; PLATES] = [0.18, 0.3, 0.5, 0.85];

/// The scene with a picture of this size.
///
/// # Errors
/// If it cannot be loaded.
pub fn veach([w, h]: [u32; 2]) -> book::Result<Description> {
    let set = vec![format!("camera.size=[{w}, {h}]")];
    Ok(load::scene("veach-mis", &load::Options { set, ..load::Options::default() })?.description)
}

/// The scene in which only one lamp emits; the others are black spheres.
pub fn only(lamp: usize, scene: &Description) -> Scene {
    let mut scene = scene.clone();
    let lamps = scene.shapes.iter_mut().filter(|s| s.emission != DVec3::ZERO);
    lamps.enumerate().filter(|(j, _)| *j != lamp).for_each(|(_, s)| s.emission = DVec3::ZERO);
    Scene::new(&scene)
}

/// The side of a plate, found by a ray from the camera to its middle.
fn side(description: &Description, scene: &Scene, plate: usize) -> Option<Side> {
    let Geometry::Quad { origin, edge_u, edge_v } = description.shapes[plate].geometry else { return None };
    let eye = description.camera.origin;
    let towards = (origin + 0.5 * (edge_u + edge_v) - eye).normalize();
    Some(scene.trace((eye - scene.origin()).as_vec3(), towards.as_vec3())?.side)
}

/// The points of each plate that lie in the middle of a pixel, each with its direction to the camera.
///
/// # Errors
/// If the camera does not see a plate.
pub fn points(description: &Description, scene: &Scene) -> book::Result<Vec<Vec<Vertex>>> {
    let [w, h] = description.camera.size;
    let seen = |pixel| {
        let (eye, towards) = scene.camera.ray(pixel, [0.5, 0.5]);
        scene.trace(eye, towards)
    };
    let all: Vec<Vertex> = (0..w * h).filter_map(seen).collect();
    let of = |plate| {
        let side = side(description, scene, plate).ok_or("the camera does not see a plate")?;
        let points: Vec<Vertex> = all.iter().copied().filter(|x| x.side == side).collect();
        if points.is_empty() { Err("a plate is smaller than a pixel".into()) } else { Ok(points) }
    };
    (0..PLATES).map(of).collect()
}
