//! An environment captured with a mirror ball, and an object lit by it.
//!
//! ```text
//! pixel (½ + ½ n_x, ½ − ½ n_y)      d = 2(n·e)n − e      L_i(x, d) ≈ L_map(d) for every point x of the object
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | normal of the ball at the point that a pixel of the capture shows | – |
//! | e = +z, d | direction to the camera, and the mirrored direction | `scene/emitter/mirror_ball.rs` |
//! | L_map | the captured radiance, by direction alone | [`Sky::MirrorBall`] |
//! | L_i | radiance that arrives at the object in the room; it also depends on x | – |
//!
//! The approximation takes the room as infinitely far away. Its error falls with the size of the object. Reference: Debevec,
//! *Rendering Synthetic Objects into Real Scenes* (SIGGRAPH 1998).

use super::board::{Board, GAP, MARGIN, Tile, WIDTH};
use super::measure::{Interval, Shot, from_text};
use super::stage::{SKY, lat_long};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::math::Rgb;
use fredholm::report::book::{Folder, Number, Result, Slide};
use fredholm::report::image::picture::{auto_gain, gain_label};
use fredholm::report::text::csv::Csv;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::description::{Description, LightDescription, Sky};
use fredholm::scene::emitter::environment::Environment;
use fredholm::scene::raster::Raster;
use fredholm::terms::TermImage;
use std::sync::Arc;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "captured-environments",
    topic: "Captured environments",
    caption: "A mirror ball in a room, seen from far away, shows the light that arrives at it from nearly all directions. \
              The picture of the ball becomes a map of directions, and this map lights an object. The object looks nearly \
              as in the room. The difference grows with the object, because the map has no distances.",
    scene: "room and sphere, defined by the program",
    program,
};

/// A room that is open towards +z, with a lamp and a box.
const ROOM: &str = r#"
[[shapes]]
type = "quad"
origin = [-1, -1, 1]
edge_u = [2, 0, 0]
edge_v = [0, 0, -2]
material = "white"

[[shapes]]
type = "quad"
origin = [-1, 1, -1]
edge_u = [2, 0, 0]
edge_v = [0, 0, 2]
material = "white"

[[shapes]]
type = "quad"
origin = [-1, -1, -1]
edge_u = [2, 0, 0]
edge_v = [0, 2, 0]
material = "white"

[[shapes]]
type = "quad"
origin = [1, -1, -1]
edge_u = [0, 0, 2]
edge_v = [0, 2, 0]
material = "green"

[[shapes]]
type = "quad"
origin = [-1, -1, 1]
edge_u = [0, 0, -2]
edge_v = [0, 2, 0]
material = "red"

[[shapes]]
type = "quad"
origin = [-0.5, 0.99, -0.1]
edge_u = [0.6, 0, 0]
edge_v = [0, 0, 0.6]
material = "black"
emission = [9, 8, 6]

[[shapes]]
type = "box"
min = [-0.85, -1.01, -0.4]
max = [-0.35, -0.55, 0.1]
rotate_y = 25
material = "blue"
"#;

/// The sphere at the origin, its camera and all materials. Words in capitals are replaced.
const SPHERE: &str = r#"
name = "captured"

[camera]
origin = [0, 0, DISTANCE]
target = [0, 0, 0]
up = [0, 1, 0]
fov = FOV
size = [64, 64]

[materials]
white = { type = "diffuse", reflectance = [0.7, 0.7, 0.7], sides = "front" }
green = { type = "diffuse", reflectance = [0.15, 0.5, 0.1], sides = "front" }
red = { type = "diffuse", reflectance = [0.6, 0.08, 0.06], sides = "front" }
blue = { type = "diffuse", reflectance = [0.15, 0.25, 0.6] }
black = { type = "diffuse", reflectance = [0, 0, 0] }
object = { OBJECT }

[[shapes]]
name = "object"
type = "sphere"
center = [0, 0, 0]
radius = RADIUS
material = "object"
"#;

const MIRROR: &str = "type = \"mirror\", reflectance = [1, 1, 1]";
const MATT: &str = "type = \"diffuse\", reflectance = [0.7, 0.7, 0.7]";
const GLOSSY: &str = "type = \"conductor\", reflectance = [0.9, 0.9, 0.9], alpha = 0.15";

/// Radius of the mirror ball, m: small, so that the map is that of one point.
const BALL: f64 = 0.02;
/// Radius of the object in the pictures, m.
const RADIUS: f64 = 0.2;
/// Distance of the camera from the object, m.
const NEAR: f64 = 3.9;

/// The sphere, seen from `distance` so that it takes `part` of the width of the image.
fn sphere(object: &str, radius: f64, distance: f64, part: f64, rest: &str, size: u32) -> Result<Description> {
    let fov = 2.0 * ((radius / distance).asin().tan() / part).atan().to_degrees();
    let text = SPHERE.replace("DISTANCE", &distance.to_string()).replace("FOV", &fov.to_string());
    let text = text.replace("OBJECT", object).replace("RADIUS", &radius.to_string());
    from_text(&format!("{text}{rest}"), [size, size])
}

/// The object alone, lit by a sky.
fn lit_by(object: &str, radius: f64, sky: &Sky, size: u32) -> Result<Scene> {
    let alone = sphere(object, radius, NEAR, 0.7, SKY, size)?;
    let lights = vec![LightDescription::Environment { sky: sky.clone(), rotate: 0.0, scale: 1.0 }];
    Ok(Scene::new(&Description { lights, ..alone }))
}

/// The whole image: all terms and the tail.
fn whole(scene: &Scene, spp: u32, stream: &str, folder: &Folder<'_>) -> TermImage {
    let plan = Plan { max_bounces: 1, technique: Technique::Mis, roulette: Roulette::Albedo { from: 2 } };
    Shot::new(scene, Sampling::Bsdf, &Prefix(plan), spp, stream, folder).image(0..3)
}

/// Mean over the pixels that show the object only, and over the channels.
fn on_object(alone: &Scene, image: &TermImage) -> Number {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let hit = |pixel: u32, u: [f32; 2]| {
        let (start, direction) = alone.camera.ray(pixel, u);
        alone.trace(start, direction).is_some()
    };
    let inside: Vec<usize> = (0..image.mean.len()).filter(|&p| corners.iter().all(|&u| hit(p as u32, u))).collect();
    let n = inside.len() as f64;
    let grey = |v: [f32; 3]| v.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0;
    let value = inside.iter().map(|&p| grey(image.mean[p])).sum::<f64>() / n;
    let error = inside.iter().map(|&p| grey(image.std_error[p]).powi(2)).sum::<f64>().sqrt() / n;
    Number { value, std_error: error }
}

fn program(folder: &Folder<'_>) -> Result<()> {
    let (size, spp) = (folder.pick(180, 90), folder.pick(48, 16));
    let far = sphere(MIRROR, BALL, 1000.0 * BALL, 1.0, ROOM, 2 * size)?;
    let capture = whole(&Scene::new(&far), folder.pick(32, 16), "capture", folder).mean;
    let photo = Raster::new([2 * size; 2], capture.iter().map(|&p| Rgb::from(p)).collect());
    let sky = Sky::MirrorBall(Arc::new(photo));
    let environment = Environment::new(&sky, 0.0, 1.0);
    let map = lat_long(2 * size, |d| environment.radiance(d));

    let mut views = vec![];
    for (name, object) in [("Matt", MATT), ("Glossy", GLOSSY)] {
        let room = Scene::new(&sphere(object, RADIUS, NEAR, 0.7, ROOM, size)?);
        let object = lit_by(object, RADIUS, &sky, size)?;
        for (place, scene) in [("in the room", &room), ("lit by the map", &object)] {
            let image = whole(scene, spp, &format!("{name} {place}"), folder);
            views.push((format!("{name}, {place}"), on_object(&object, &image), image.mean));
        }
    }
    let gain = auto_gain(&views[0].2);
    let mut board = Board::new(
        "A captured environment: light that depends on the direction only",
        &format!(
            "Lᵢ(x, d) ≈ L_map(d). All pictures: gain {}. The walls are 1 m from the centre of the sphere. ± is the 95 % interval.",
            gain_label(gain)
        ),
    );
    let top = board.y;
    let grown = |tile: Tile| tile.enlarged(folder.pick(1, 2));
    let first = grown(Tile::new(2 * size, &capture, gain, "The ball from far away", vec![]).fine());
    let second = grown(Tile::new(4 * size, &map, gain, "The same radiance by longitude and latitude", vec![]).fine());
    board.row(vec![first], [MARGIN, MARGIN + 180.0]);
    let bottom = board.y;
    board.y = top;
    board.row(vec![second], [MARGIN + 180.0 + GAP, MARGIN + 540.0 + GAP]);
    explain(&mut board, (MARGIN + 540.0 + 3.0 * GAP, top + 26.0));
    board.y = bottom;

    let tiles = views.iter().map(|(label, mean, pixels)| {
        grown(Tile::new(size, pixels, gain, label, vec![format!("mean {}", mean.words())]))
    });
    let tiles = tiles.collect();
    let width = 4.0 * 180.0 + 3.0 * GAP;
    let top = board.y;
    board.row(tiles, [MARGIN, MARGIN + width]);
    let bottom = board.y;
    let differences = by_size(folder, &sky)?;
    let (x, mut y) = (MARGIN + width + GAP, top + 26.0);
    y = board.paragraph(
        "Matt sphere: mean by the map − mean in the room, in % of it, by radius",
        (x, y),
        WIDTH - MARGIN - x,
        13.0,
    ) + 4.0;
    for (radius, d) in &differences {
        y = board.paragraph(&format!("{radius} m: {} %", d.words()), (x, y), WIDTH - MARGIN - x, 13.0) + 4.0;
    }
    board.y = bottom;
    board.finish(folder, &SLIDE, |_| Ok(()))
}

/// How a pixel of the capture becomes a direction.
fn explain(board: &mut Board, (x, y): (f64, f64)) {
    let room = WIDTH - MARGIN - x;
    let y = board.paragraph("d = 2(n·e)n − e", (x, y), room, 18.0);
    let text =
        "n: normal of the ball in this pixel, e: direction to the camera. The rim shows what is behind the ball.";
    let y = board.paragraph(text, (x, y + 6.0), room, 14.0);
    let file = "In a scene file: [[lights]] type = \"environment\", file = \"ball.exr\", mapping = \"mirror-ball\".";
    board.paragraph(file, (x, y + 6.0), room, 14.0);
}

/// Radii for which the error of the map is measured, m.
const RADII: [f64; 3] = [0.1, 0.2, 0.4];

/// The relative difference of the mean over a matt sphere, map against room, in percent, for each radius. It must be larger
/// for the largest sphere than for the smallest.
fn by_size(folder: &Folder<'_>, sky: &Sky) -> Result<Vec<(f64, Number)>> {
    let (size, spp) = (32, folder.pick(256, 64));
    let mut csv = Csv::new("radius,room,room_std_error,map,map_std_error");
    let mut all = vec![];
    for radius in RADII {
        let room = Scene::new(&sphere(MATT, radius, NEAR, 0.7, ROOM, size)?);
        let alone = lit_by(MATT, radius, sky, size)?;
        let right = on_object(&alone, &whole(&room, spp, &format!("room, {radius}"), folder));
        let map = on_object(&alone, &whole(&alone, spp, &format!("map, {radius}"), folder));
        csv.put(radius).numbers([right.value, right.std_error, map.value, map.std_error]).end();
        let r = map.over(right);
        all.push((radius, Number { value: 100.0 * (r.value - 1.0), std_error: 100.0 * r.std_error }));
    }
    folder.text("captured-environments.csv", &csv.text())?;
    let (small, large) = (all[0].1, all[2].1);
    if large.value.abs() - small.value.abs() < 3.0 * large.std_error.hypot(small.std_error) {
        return Err(format!("the error does not grow with the object: {} %, {} %", small.words(), large.words()).into());
    }
    Ok(all)
}
