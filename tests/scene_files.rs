//! Scene files: what is wrong is refused at its line and key, what is right is what the file says.
#![allow(clippy::unwrap_used)]

#[path = "scene_files/materials_and_lights.rs"]
mod materials_and_lights;
#[path = "scene_files/meaning.rs"]
mod meaning;
#[path = "scene_files/obj.rs"]
mod obj;
#[path = "scene_files/obj_in_the_wild.rs"]
mod obj_in_the_wild;
#[path = "scene_files/overrides.rs"]
mod overrides;

#[path = "scene_files/refused.rs"]
mod refused;
#[path = "scene_files/too_large.rs"]
mod too_large;

use fredholm::{
    math::Rgb,
    report::image::picture::srgb,
    scene::{
        Primitive, SceneError, builtin,
        description::{BsdfDescription, Choice, Colour, Geometry, Ggx, LightDescription, Masking, Metal, Sides, Sky},
        load::{Loaded, Options, scene, toml},
        raster::Raster,
    },
};
use glam::{DVec2, DVec3};
use std::{
    f64::consts::PI,
    path::{Path, PathBuf},
};

/// One of everything; the errors below are edits of it.
const GOOD: &str = r#"name = "good"

[camera]
origin = [0, 0, 4]
target = [0, 0, 0]
up = [0, 1, 0]
fov = 40
size = [8, 6]

[materials.white]
type = "diffuse"
reflectance = [0.7, 0.7, 1]

[materials.left]
type = "diffuse"
reflectance = [0.6, 0.1, 0.1]
sides = "front"

[[shapes]]
type = "quad"
origin = [0, 0, 0]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
material = "white"
emission = [1, 2, 3]

[[shapes]]
type = "box"
min = [0, 0, 0]
max = [1, 1, 1]
rotate_y = 10
material = "left"

[[shapes]]
type = "sphere"
center = [0, 0, 0]
radius = 2
z = [-0.5, 0.5]
inward = true
material = "left"

[[shapes]]
type = "disk"
center = [0, 0, 0]
normal = [0, 0, 2]
radius = 0.5
material = "white"

[[shapes]]
type = "mesh"
vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]]
faces = [[0, 1, 2], [0, 3, 2]]
material = "white"

[expect]
terms = [1, 0.5]
gamma = 0.5
source = "by hand"
"#;

fn options(set: &[&str], emit: &[&str]) -> Options {
    let own = |list: &[&str]| list.iter().map(|s| (*s).to_owned()).collect();
    Options { set: own(set), emit: own(emit), ..Options::default() }
}

fn parse(text: &str) -> Result<Loaded, SceneError> {
    toml(text, Path::new("bad.toml"), &Options::default())
}

fn with(set: &[&str]) -> Result<Loaded, SceneError> {
    toml(GOOD, Path::new("bad.toml"), &options(set, &[]))
}

#[test]
fn the_good_scene_is_read_as_written() {
    let d = parse(GOOD).unwrap().description;
    assert_eq!((d.name.as_str(), d.camera.fov, d.camera.size), ("good", 40.0, [8, 6]));
    assert_eq!((d.camera.origin, d.camera.target, d.camera.up), (DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y));
    assert_eq!((d.materials[0].name.as_str(), d.materials[0].sides), ("white", Sides::Both));
    assert_eq!((d.materials[1].lambertian().unwrap(), d.materials[1].sides), (DVec3::new(0.6, 0.1, 0.1), Sides::Front));
    assert_eq!(d.shapes.iter().map(|s| s.material).collect::<Vec<_>>(), [0, 1, 1, 0, 0]);
    assert_eq!((d.shapes[0].emission, d.shapes[1].emission), (DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO));
    assert_eq!(d.shapes[3].name, "shapes[3]");
    assert_eq!(d.shapes[0].geometry, Geometry::Quad { origin: DVec3::ZERO, edge_u: DVec3::X, edge_v: DVec3::Y });
    assert_eq!(
        d.shapes[1].geometry,
        Geometry::Box { min: DVec3::ZERO, max: DVec3::ONE, rotate_y: 10.0, inward: false }
    );
    assert_eq!(
        d.shapes[2].geometry,
        Geometry::Sphere { center: DVec3::ZERO, radius: 2.0, z: [-0.5, 0.5], inward: true }
    );
    assert_eq!(
        d.shapes[3].geometry,
        Geometry::Disk { center: DVec3::ZERO, normal: DVec3::new(0.0, 0.0, 2.0), radius: 0.5 }
    );
    let Geometry::Mesh { vertices, faces, .. } = &d.shapes[4].geometry else { panic!() };
    assert_eq!(
        (vertices.len(), vertices[3], faces.as_slice()),
        (4, DVec3::new(2.0, 0.0, 0.0), &[[0, 1, 2], [0, 3, 2]][..])
    );
    let expect = d.expect.unwrap();
    assert_eq!((expect.terms, expect.gamma, expect.source.as_str()), (vec![1.0, 0.5], Some(0.5), "by hand"));
}

/// One of every material and light.
const RICH: &str = r#"[camera]
origin = [0, 0, 4]
target = [0, 0, 0]
up = [0, 1, 0]
fov = 40
size = [8, 6]

[materials.wall]
type = "diffuse"
texture = "wall.png"

[materials.silver]
type = "mirror"
reflectance = [0.9, 0.8, 0.7]
sides = "front"

[materials.gold]
type = "conductor"
eta = [0.143, 0.375, 1.442]
k = [3.98, 2.39, 1.6]
alpha = 0.1
masking = "separable"

[materials.chrome]
type = "conductor"
reflectance = [0.5, 0.6, 0.7]

[materials.glass]
type = "dielectric"
ior = 1.5
ior_outside = 1.33
choice = 0.25
alpha = 0.3

[materials.cup]
type = "plastic"
reflectance = [0.4, 0.5, 0.6]
alpha = 0.2

[materials.lacquer]
type = "phong"
reflectance = [0.7, 0.6, 0.5]
specular = [0.3, 0.3, 0.3]
exponent = 50

[[shapes]]
type = "quad"
origin = [0, 0, 0]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
material = "wall"

[[shapes]]
type = "sphere"
center = [0, 0, 0]
radius = 1
material = "gold"

[[shapes]]
type = "mesh"
vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]]
faces = [[0, 1, 2], [0, 3, 2]]
uvs = [[0, 0], [1, 0], [1, 1], [2, 0]]
material = "glass"

[[lights]]
type = "point"
position = [0, 3, 0]
intensity = [10, 20, 30]

[[lights]]
type = "environment"
file = "sky.hdr"
mapping = "latlong"
rotate = 90
scale = 2

[[lights]]
type = "directional"
direction = [0, -2, 0]
irradiance = [1, 2, 3]
"#;

/// Texels of the images below, linear.
const SKY: [[f32; 3]; 6] =
    [[0.0, 0.25, 0.5], [1.0, 2.0, 0.5], [0.0, 0.0, 0.0], [0.5, 0.5, 0.5], [0.125, 1.0, 0.75], [2.0, 0.5, 0.25]];

/// A folder with the images that scenes of these tests name.
fn gallery() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let exr = |name: &str, texels: &[[f32; 3]]| {
        let at = |x: usize, y: usize| texels[2 * y + x].into();
        exr::prelude::write_rgb_file(dir.path().join(name), 2, 2, at).unwrap();
    };
    let grey = [0.5; 3];
    exr("sky.exr", &SKY[..4]);
    exr("bright.exr", &[grey, [0.5, 1.5, 0.5], grey, grey]);
    exr("nan.exr", &[grey, grey, grey, [0.5, f32::NAN, 0.5]]);
    exr("negative.exr", &[grey, grey, [0.5, 0.5, -1.0], grey]);
    let sky = image::Rgb32FImage::from_fn(3, 2, |x, y| image::Rgb(SKY[(3 * y + x) as usize]));
    sky.save(dir.path().join("sky.hdr")).unwrap();
    let wall = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb([[0, 10, 11], [128, 188, 255]][x as usize]));
    wall.save(dir.path().join("wall.png")).unwrap();
    let deep = image::ImageBuffer::<image::Rgb<u16>, _>::from_pixel(1, 1, image::Rgb([32768, 0, 65535]));
    deep.save(dir.path().join("deep.png")).unwrap();
    image::RgbImage::from_pixel(8, 8, image::Rgb([128, 128, 128])).save(dir.path().join("flat.jpg")).unwrap();
    image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 255])).save(dir.path().join("solid.png")).unwrap();
    image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 254])).save(dir.path().join("clear.png")).unwrap();
    std::fs::write(dir.path().join("broken.png"), b"\x89PNG\r\n\x1a\n nothing").unwrap();
    std::fs::write(dir.path().join("broken.exr"), b"\x76\x2f\x31\x01 nothing").unwrap();
    std::fs::write(dir.path().join("broken.jpg"), b"").unwrap();
    dir
}

/// Whatever loads is sound: finite, with area, lit, and every index in range.
fn sound(l: &Loaded) {
    let d = &l.description;
    assert!(d.primitives().iter().all(|(_, p)| p.area() > 0.0 && p.area().is_finite()));
    assert!(d.shapes.iter().all(|s| s.material < d.materials.len() && s.emission.is_finite()));
    assert!(d.shapes.iter().any(|s| s.emission.max_element() > 0.0) || !d.lights.is_empty());
    assert!(d.camera.origin.is_finite() && d.camera.size.iter().all(|&n| n > 0));
}

fn bad(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes").join(name).to_str().unwrap().to_owned()
}

#[test]
fn one_error_in_full() {
    let text = GOOD.replace(
        "material = \"left\"\n\n[[shapes]]\ntype = \"sphere\"",
        "material = \"lfet\"\n\n[[shapes]]\ntype = \"sphere\"",
    );
    insta::assert_snapshot!(parse(&text).unwrap_err(), @r"
    error: unknown material `lfet`
      --> bad.toml:32  shapes[1].material
    help: did you mean `left`? materials: white, left
    ");
}

#[test]
fn syntax_errors_keep_their_line() {
    for (from, to, line) in [
        ("fov = 40", "fov = ", 7),
        ("[materials.left]", "[materials.left", 14),
        ("type = \"sphere\"", "type = \"sphere", 35),
        ("gamma = 0.5", "gamma = 0.5\ngamma = 0.5", 58),
    ] {
        let e = parse(&GOOD.replace(from, to)).unwrap_err();
        assert!(e.what.starts_with("not valid TOML: "), "{e}");
        assert_eq!((e.line, e.key), (Some(line), None), "{to:?}");
    }
}

#[test]
fn a_scene_needs_shapes_and_light() {
    let dark = GOOD.replace("emission = [1, 2, 3]\n", "");
    let e = parse(&dark).unwrap_err();
    assert_eq!(e.what, "nothing in the scene emits light");
    assert!(e.help.unwrap().contains("materials in use: left, white"));
    let (head, _) = GOOD.split_once("[[shapes]]").unwrap();
    assert_eq!(parse(head).unwrap_err().what, "missing key `shapes`");
    let e = parse(&format!("shapes = []\n{head}")).unwrap_err();
    assert_eq!((e.what.as_str(), e.line), ("the scene has no shapes", Some(1)));
    assert_eq!(parse("").unwrap_err().what, "missing key `camera`");
    let empty_table = GOOD.replace("[[shapes]]\ntype = \"quad\"", "[shapes]\ntype = \"quad\"");
    assert!(parse(&empty_table).is_err());
}

#[test]
fn names_of_scenes() {
    let e = scene("cornel", &Options::default()).unwrap_err();
    insta::assert_snapshot!(e, @r"
    error: `cornel` is neither a built-in scene nor a .toml or .obj file
    help: did you mean `cornell`? built-in scenes: cornell, furnace, sphere, shells, cornell-spheres, veach-mis, veach-ajar, env-ggx, caustic, glass-furnace, mirror-corridor, sky-bowl, many-lights, cube
    ");
    assert!(!scene("teapot", &Options::default()).unwrap_err().help.unwrap().contains("did you mean"));
    for missing in ["no/such.toml", "no/such.obj"] {
        let e = scene(missing, &Options::default()).unwrap_err();
        assert_eq!(e.file.as_deref(), Some(Path::new(missing)));
        assert!(e.what.ends_with("does not exist"), "{e}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("latin.TOML");
    std::fs::write(&path, b"# fine\nname = \"caf\xe9\"\n").unwrap();
    let e = scene(path.to_str().unwrap(), &Options::default()).unwrap_err();
    assert_eq!((e.what.as_str(), e.line), ("the file is not UTF-8 text", Some(2)));
}

/// Each edit of `good`, read as if it lay in `folder`, is refused as the row says.
fn refusals(good: &str, file: &Path, rows: &[(&str, &str, usize, &str, &str)]) {
    for &(from, to, line, key, what) in rows {
        assert_eq!(good.matches(from).count(), 1, "{from:?} is not one place of the scene");
        let e = toml(&good.replace(from, to), file, &Options::default()).expect_err(to);
        assert_eq!((e.what.as_str(), e.line, e.key.as_deref()), (what, Some(line), Some(key)), "{to:?}");
        assert_eq!(e.file.as_deref(), Some(file));
        assert!(e.help.is_some_and(|h| h.len() > 5), "{what} has no help");
    }
}
