//! Scene files: what is wrong is refused at its line and key, what is right is what the file says.
#![allow(clippy::unwrap_used)]

use fredholm::{
    math::Rgb,
    report::picture::srgb,
    scene::{
        Primitive, SceneError, builtin,
        description::{BsdfDescription, Choice, Colour, Geometry, Ggx, LightDescription, Masking, Metal, Sides, Sky},
        load::{Loaded, Options, scene, toml},
        raster::Raster,
    },
};
use glam::{DVec2, DVec3};
use proptest::{
    prelude::*,
    test_runner::{Config, RngAlgorithm, TestRng, TestRunner},
};
use std::{
    cell::Cell,
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

/// (text of GOOD, its replacement, line, key, what)
#[rustfmt::skip]
const REFUSED: &[(&str, &str, usize, &str, &str)] = &[
    // the file
    ("name = \"good\"", "nane = \"good\"", 1, "nane", "unknown key `nane`"),
    ("name = \"good\"", "name = 3", 1, "name", "expected a string, found an integer"),
    ("name = \"good\"", "name = \"../up\"", 1, "name", "`../up` cannot be the name of a folder"),
    ("name = \"good\"", "name = \" \"", 1, "name", "the string is empty"),
    ("[camera]", "[kamera]", 3, "kamera", "unknown key `kamera`"),
    ("[expect]", "[[lights]]\ntype = \"lamp\"\n[expect]", 56, "lights[0].type", "`lamp` is no type of light"),
    ("[expect]", "[[lights]]\n[expect]", 55, "lights[0].type", "missing key `type`"),
    ("[expect]", "[lights]\n[expect]", 55, "lights", "expected an array of tables, [[lights]], found a table"),
    // the camera
    ("up = [0, 1, 0]\n", "", 3, "camera.up", "missing key `up`"),
    ("fov = 40", "fovv = 40", 7, "camera.fovv", "unknown key `fovv`"),
    ("fov = 40", "fov = \"40\"", 7, "camera.fov", "expected a number, found a string"),
    ("fov = 40", "fov = 0", 7, "camera.fov", "fov 0 is outside (0, 180)"),
    ("fov = 40", "fov = 180", 7, "camera.fov", "fov 180 is outside (0, 180)"),
    ("fov = 40", "fov = nan", 7, "camera.fov", "NaN is not finite"),
    ("size = [8, 6]", "size = [8, 0]", 8, "camera.size[1]", "0 is outside [1, 32768]"),
    ("size = [8, 6]", "size = [8.5, 6]", 8, "camera.size[0]", "expected an integer, found a number"),
    ("size = [8, 6]", "size = [8, 6, 1]", 8, "camera.size", "expected 2 integers, found 3"),
    ("origin = [0, 0, 4]", "origin = [0, 0]", 4, "camera.origin", "expected 3 numbers, found 2"),
    ("origin = [0, 0, 4]", "origin = [0, inf, 0]", 4, "camera.origin[1]", "inf is not finite"),
    ("origin = [0, 0, 4]", "origin = [0, 0, 1e13]", 4, "camera.origin[2]", "1e13 m is too far for single-precision rays"),
    ("origin = [0, 0, 4]", "origin = [0, 0, 0]", 5, "camera.target", "camera origin and target are the same point"),
    ("up = [0, 1, 0]", "up = [0, 0, 2]", 6, "camera.up", "up is parallel to the viewing direction"),
    ("up = [0, 1, 0]", "up = [0, 0, 0]", 6, "camera.up", "up has zero length"),
    // materials
    ("type = \"diffuse\"\nreflectance = [0.6", "reflectance = [0.6", 14, "materials.left.type", "missing key `type`"),
    ("reflectance = [0.6, 0.1, 0.1]\n", "", 14, "materials.left.reflectance", "missing key `reflectance`"),
    ("[0.6, 0.1, 0.1]", "[0.6, 1.2, 0.1]", 16, "materials.left.reflectance", "reflectance 1.2 is outside [0, 1]"),
    ("[0.6, 0.1, 0.1]", "[0.6, -0.1, 0.1]", 16, "materials.left.reflectance", "reflectance -0.1 is outside [0, 1]"),
    ("[0.6, 0.1, 0.1]", "[0.6,\n\n nan, 0.1]", 18, "materials.left.reflectance[1]", "NaN is not finite"),
    ("[0.6, 0.1, 0.1]", "0.6", 16, "materials.left.reflectance", "expected 3 numbers, found a number"),
    ("sides = \"front\"", "sides = \"fornt\"", 17, "materials.left.sides", "`fornt` is no choice of sides"),
    ("sides = \"front\"", "side = \"front\"", 17, "materials.left.side", "unknown key `side`"),
    ("sides = \"front\"", "texture = \"a.png\"", 17, "materials.left.texture", "reflectance and texture are both given"),
    ("type = \"diffuse\"\nreflectance = [0.6", "type = \"diffus\"\nreflectance = [0.6", 15, "materials.left.type", "`diffus` is no type of material"),
    // light
    ("emission = [1, 2, 3]", "emission = [1, -2, 3]", 25, "shapes[0].emission", "emission -2 is negative"),
    ("emission = [1, 2, 3]", "emission = [1, 1e31, 3]", 25, "shapes[0].emission", "emission 1e31 is too large"),
    ("emission = [1, 2, 3]", "power = [1, -2, 3]", 25, "shapes[0].power", "power -2 is negative"),
    ("emission = [1, 2, 3]", "emission = [1, 2, 3]\npower = [1, 1, 1]", 26, "shapes[0].power", "emission and power are both given"),
    // shapes
    ("type = \"quad\"", "type = \"quat\"", 20, "shapes[0].type", "`quat` is no type of shape"),
    ("type = \"quad\"\n", "", 19, "shapes[0].type", "missing key `type`"),
    ("material = \"white\"\nemission", "material = \"whit\"\nemission", 24, "shapes[0].material", "unknown material `whit`"),
    ("material = \"white\"\nemission", "emission", 19, "shapes[0].material", "missing key `material`"),
    ("edge_u = [1, 0, 0]", "edge_u = [0, 0, 0]", 22, "shapes[0].edge_u", "the edge has zero length"),
    ("edge_u = [1, 0, 0]", "edge_w = [1, 0, 0]", 22, "shapes[0].edge_w", "unknown key `edge_w`"),
    ("edge_v = [0, 1, 0]", "edge_v = [-3, 0, 0]", 23, "shapes[0].edge_v", "edge_u and edge_v are parallel, the quad has no area"),
    ("max = [1, 1, 1]", "max = [1, 0, 1]", 30, "shapes[1].max", "the box has no extent along y: min 0, max 0"),
    ("rotate_y = 10", "rotate_y = inf", 31, "shapes[1].rotate_y", "inf is not finite"),
    ("radius = 2", "radius = 0", 37, "shapes[2].radius", "radius 0 is not positive"),
    ("radius = 2", "radius = -2", 37, "shapes[2].radius", "radius -2 is not positive"),
    ("radius = 2\n", "", 34, "shapes[2].radius", "missing key `radius`"),
    ("z = [-0.5, 0.5]", "z = [0.5, 0.5]", 38, "shapes[2].z", "the band [0.5, 0.5] is empty"),
    ("z = [-0.5, 0.5]", "z = [0.5, -0.5]", 38, "shapes[2].z", "the band [0.5, -0.5] is empty"),
    ("z = [-0.5, 0.5]", "z = [-0.5, 1.5]", 38, "shapes[2].z", "the band [-0.5, 1.5] leaves the sphere"),
    ("inward = true", "inward = 1", 39, "shapes[2].inward", "expected true or false, found an integer"),
    ("normal = [0, 0, 2]", "normal = [0, 0, 0]", 45, "shapes[3].normal", "the normal has zero length"),
    ("radius = 0.5", "radius = 2020-01-01", 46, "shapes[3].radius", "expected a number, found a date"),
    ("[0, 3, 2]]", "[0, 4, 2]]", 52, "shapes[4].faces[1]", "vertex index 4 is out of range, the mesh has 4 vertices"),
    ("[0, 3, 2]]", "\n[0, -1, 2]]", 53, "shapes[4].faces[1]", "vertex index -1 is out of range, the mesh has 4 vertices"),
    ("[0, 3, 2]]", "[0, 1, 3]]", 52, "shapes[4].faces[1]", "the triangle [0, 1, 3] has no area"),
    ("[0, 3, 2]]", "[0, 1, 1]]", 52, "shapes[4].faces[1]", "the triangle [0, 1, 1] has no area"),
    ("[0, 3, 2]]", "[0, 1, 2, 3]]", 52, "shapes[4].faces[1]", "expected 3 vertex indices, found 4"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = []", 52, "shapes[4].faces", "the mesh has no faces"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0]]", 53, "shapes[4].uvs", "1 uvs for 4 vertices"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0], [0, 1], [1, 1], [1]]", 53, "shapes[4].uvs[3]", "expected 2 numbers, found 1"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0], [0, nan], [1, 1], [1, 0]]", 53, "shapes[4].uvs[1][1]", "NaN is not finite"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0], [0, 1e6], [1, 1], [1, 0]]", 53, "shapes[4].uvs[1]", "the texture coordinate [0, 1000000] is too far out"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\ntransform = [[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]]", 53, "shapes[4].transform", "the transform flattens the shape, its determinant is zero"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\ntransform = [[1, 0, 0], [0, 1, 0], [1, 1, 0]]", 53, "shapes[4].transform[0]", "expected 4 numbers, found 3"),
    ("type = \"disk\"", "type = \"obj\"\nfile = \"no.obj\"", 45, "shapes[3].center", "unknown key `center`"),
    ("type = \"disk\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 2]\nradius = 0.5", "type = \"obj\"\nfile = \"no.obj\"", 44, "shapes[3].file", "cannot read `no.obj`"),
    ("edge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"white\"\nemission = [1, 2, 3]", "edge_u = [1e-6, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"white\"\npower = [1e30, 0, 0]", 25, "shapes[0].power", "that power makes the radiance 3.183e35"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\ntransform = [[1e12, 0, 0, 1], [0, 1e12, 0, 0], [0, 0, 1e12, 0]]", 53, "shapes[4].transform", "the transform makes the shape too large, or a triangle of it too thin"),
    // closed forms
    ("terms = [1, 0.5]", "terms = []", 56, "expect.terms", "terms is empty"),
    ("terms = [1, 0.5]", "terms = [1, -0.5]", 56, "expect.terms[1]", "-0.5 is negative"),
    ("gamma = 0.5", "gama = 0.5", 57, "expect.gama", "unknown key `gama`"),
    ("source = \"by hand\"", "", 55, "expect.source", "missing key `source`"),
];

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

#[test]
fn what_is_wrong_is_refused_at_its_line_and_key() {
    refusals(GOOD, Path::new("bad.toml"), REFUSED);
}

// ------------------------------------------------------------------------------------------------ materials and lights

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

/// (text of RICH, its replacement, line, key, what)
#[rustfmt::skip]
const RICH_REFUSED: &[(&str, &str, usize, &str, &str)] = &[
    // keys that belong elsewhere or are missing
    ("sides = \"front\"", "alpha = 0.1", 15, "materials.silver.alpha", "unknown key `alpha`"),
    ("sides = \"front\"", "texture = \"wall.png\"", 15, "materials.silver.texture", "unknown key `texture`"),
    ("reflectance = [0.9, 0.8, 0.7]\n", "", 12, "materials.silver.reflectance", "missing key `reflectance`"),
    ("texture = \"wall.png\"\n", "", 8, "materials.wall.reflectance", "missing key `reflectance`"),
    ("[0.9, 0.8, 0.7]", "[0.9, 1.1, 0.7]", 14, "materials.silver.reflectance", "reflectance 1.1 is outside [0, 1]"),
    ("reflectance = [0.5, 0.6, 0.7]\n", "", 24, "materials.chrome.eta", "missing key `eta`"),
    ("k = [3.98, 2.39, 1.6]\n", "", 17, "materials.gold.k", "missing key `k`"),
    ("eta = [0.143, 0.375, 1.442]\n", "", 17, "materials.gold.eta", "missing key `eta`"),
    ("ior = 1.5\n", "", 28, "materials.glass.ior", "missing key `ior`"),
    ("specular = [0.3, 0.3, 0.3]\n", "", 40, "materials.lacquer.specular", "missing key `specular`"),
    ("exponent = 50\n", "", 40, "materials.lacquer.exponent", "missing key `exponent`"),
    // metals
    ("masking = \"separable\"", "reflectance = [0.5, 0.5, 0.5]", 22, "materials.gold.reflectance", "eta, k and reflectance are both given"),
    ("eta = [0.143, 0.375, 1.442]", "eta = [0, 0.375, 1.442]", 19, "materials.gold.eta", "eta 0 is outside [0.001, 100]"),
    ("k = [3.98, 2.39, 1.6]", "k = [3.98, -2.39, 1.6]", 20, "materials.gold.k", "k -2.39 is outside [0, 100]"),
    // roughness
    ("alpha = 0.1\n", "alpha = 0\n", 21, "materials.gold.alpha", "alpha 0 is below 0.001"),
    ("alpha = 0.1\n", "alpha = -0.1\n", 21, "materials.gold.alpha", "alpha -0.1 is below 0.001"),
    ("alpha = 0.1\n", "alpha = 1.1\n", 21, "materials.gold.alpha", "alpha 1.1 is above 1"),
    ("alpha = 0.1\n", "alpha = nan\n", 21, "materials.gold.alpha", "NaN is not finite"),
    ("alpha = 0.1\n", "", 21, "materials.gold.masking", "masking without alpha"),
    ("masking = \"separable\"", "masking = \"smith\"", 22, "materials.gold.masking", "`smith` is no kind of masking"),
    // glass
    ("ior = 1.5", "ior = 0.9", 30, "materials.glass.ior", "ior 0.9 is outside [1, 10]"),
    ("ior_outside = 1.33", "ior_outside = 11", 31, "materials.glass.ior_outside", "ior_outside 11 is outside [1, 10]"),
    ("ior_outside = 1.33", "ior_outside = 1.5", 33, "materials.glass.alpha", "alpha between indices 1.5 and 1.5, which hardly differ"),
    ("choice = 0.25", "choice = 0", 32, "materials.glass.choice", "choice 0 is outside (0, 1)"),
    ("choice = 0.25", "choice = 1", 32, "materials.glass.choice", "choice 1 is outside (0, 1)"),
    ("choice = 0.25", "choice = \"fresnell\"", 32, "materials.glass.choice", "`fresnell` is no choice of reflection"),
    ("choice = 0.25", "choice = true", 32, "materials.glass.choice", "expected a number, found a boolean"),
    ("choice = 0.25", "sides = \"both\"", 32, "materials.glass.sides", "a dielectric has no sides"),
    // plastic and phong
    ("alpha = 0.2", "ior = 0.5", 38, "materials.cup.ior", "ior 0.5 is outside [1, 10]"),
    ("specular = [0.3, 0.3, 0.3]", "specular = [0.31, 0.3, 0.3]", 43, "materials.lacquer.specular", "reflectance 0.7 and specular 0.31 exceed 1 together"),
    ("specular = [0.3, 0.3, 0.3]", "specular = [-0.3, 0.3, 0.3]", 43, "materials.lacquer.specular", "specular -0.3 is outside [0, 1]"),
    ("exponent = 50", "exponent = -1", 44, "materials.lacquer.exponent", "exponent -1 is outside [0, 1e6]"),
    ("reflectance = [0.7, 0.6, 0.5]\nspecular", "texture = \"wall.png\"\nspecular", 43, "materials.lacquer.specular", "reflectance 1 and specular 0.3 exceed 1 together"),
    // textures
    ("texture = \"wall.png\"", "texture = 3", 10, "materials.wall.texture", "expected a string, found an integer"),
    ("texture = \"wall.png\"", "texture = \"wall.tga\"", 10, "materials.wall.texture", "`DIR/wall.tga` is no image this program reads"),
    ("texture = \"wall.png\"", "texture = \"bright.exr\"", 10, "materials.wall.texture", "the texel in column 1, row 0 of `DIR/bright.exr` reflects 1.5, more than it receives"),
    ("material = \"gold\"", "material = \"wall\"", 57, "shapes[1].material", "material `wall` has a texture, this sphere has no texture coordinates"),
    ("uvs = [[0, 0], [1, 0], [1, 1], [2, 0]]\nmaterial = \"glass\"", "material = \"wall\"", 63, "shapes[2].material", "material `wall` has a texture, this mesh has no texture coordinates"),
    // lights
    ("type = \"directional\"\ndirection = [0, -2, 0]\nirradiance = [1, 2, 3]", "type = \"environment\"\nradiance = [1, 1, 1]", 79, "lights[2].type", "a second environment"),
    ("position = [0, 3, 0]\n", "", 66, "lights[0].position", "missing key `position`"),
    ("position = [0, 3, 0]", "power = [0, 3, 0]", 68, "lights[0].power", "unknown key `power`"),
    ("intensity = [10, 20, 30]", "intensity = [10, -20, 30]", 69, "lights[0].intensity", "intensity -20 is negative"),
    ("intensity = [10, 20, 30]", "intensity = [10, 2e30, 30]", 69, "lights[0].intensity", "intensity 2e30 is too large"),
    ("direction = [0, -2, 0]", "direction = [0, 0, 0]", 80, "lights[2].direction", "the direction has zero length"),
    ("irradiance = [1, 2, 3]", "irradiance = [1, 2]", 81, "lights[2].irradiance", "expected 3 numbers, found 2"),
    ("file = \"sky.hdr\"", "radiance = [1, 1, 1]", 74, "lights[1].mapping", "mapping without file"),
    ("file = \"sky.hdr\"\nmapping = \"latlong\"", "radiance = [1, 1, -1]", 73, "lights[1].radiance", "radiance -1 is negative"),
    ("file = \"sky.hdr\"", "radiance = [1, 1, 1]\nfile = \"sky.hdr\"", 74, "lights[1].file", "radiance and file are both given"),
    ("file = \"sky.hdr\"\nmapping = \"latlong\"\n", "", 71, "lights[1].radiance", "missing key `radiance`"),
    ("mapping = \"latlong\"", "mapping = \"cube\"", 74, "lights[1].mapping", "`cube` is no mapping of a sky"),
    ("mapping = \"latlong\"", "mapping = \"mirror-ball\"", 73, "lights[1].file", "the photograph of a mirror sphere is 3×2 pixels, not square"),
    ("rotate = 90", "rotate = inf", 75, "lights[1].rotate", "inf is not finite"),
    ("scale = 2", "scale = -2", 76, "lights[1].scale", "scale -2 is outside [0, 1e30]"),
    ("scale = 2", "scale = 1e30", 76, "lights[1].scale", "the radiance 2.000e30 is too large"),
    ("file = \"sky.hdr\"", "file = \"nan.exr\"", 73, "lights[1].file", "the texel in column 1, row 1 of `DIR/nan.exr` is [0.5, NaN, 0.5]"),
    ("file = \"sky.hdr\"", "file = \"negative.exr\"", 73, "lights[1].file", "the texel in column 0, row 1 of `DIR/negative.exr` is [0.5, 0.5, -1]"),
    ("file = \"sky.hdr\"", "file = \"clear.png\"", 73, "lights[1].file", "cannot read `DIR/clear.png`: it has transparent texels"),
];

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

#[test]
fn wrong_materials_and_lights_are_refused_at_their_line_and_key() {
    let dir = gallery();
    let rows = RICH_REFUSED.iter().map(|&(a, b, n, k, w)| (a, b, n, k, w.replace("DIR", dir.path().to_str().unwrap())));
    let rows: Vec<_> = rows.collect();
    let rows: Vec<_> = rows.iter().map(|(a, b, n, k, w)| (*a, *b, *n, *k, w.as_str())).collect();
    refusals(RICH, &dir.path().join("rich.toml"), &rows);
    for (file, says) in [
        ("none.png", "No such file"),
        ("broken.png", "cannot read"),
        ("broken.exr", "cannot read"),
        ("broken.jpg", "cannot read"),
    ] {
        let text = RICH.replace("sky.hdr", file);
        let e = toml(&text, &dir.path().join("rich.toml"), &Options::default()).unwrap_err();
        assert!(e.what.contains(says) && e.what.contains(file), "{e}");
        assert_eq!((e.line, e.key.as_deref()), (Some(73), Some("lights[1].file")));
        assert!(e.help.is_some());
    }
}

#[test]
fn the_rich_scene_is_read_as_written() {
    let dir = gallery();
    let read = |text: &str| toml(text, &dir.path().join("rich.toml"), &Options::default()).unwrap().description;
    let d = read(RICH);
    let ggx = |alpha, masking| Some(Ggx { alpha, masking });
    let bsdf = |name: &str| d.materials.iter().find(|m| m.name == name).unwrap().bsdf.clone();
    let silver = d.materials.iter().find(|m| m.name == "silver").unwrap();
    assert_eq!(silver.sides, Sides::Front);
    assert_eq!(silver.bsdf, BsdfDescription::Mirror { reflectance: DVec3::new(0.9, 0.8, 0.7) });
    let metal = Metal::Fresnel { eta: DVec3::new(0.143, 0.375, 1.442), k: DVec3::new(3.98, 2.39, 1.6) };
    assert_eq!(bsdf("gold"), BsdfDescription::Conductor { metal, rough: ggx(0.1, Masking::Separable) });
    let metal = Metal::Reflectance(DVec3::new(0.5, 0.6, 0.7));
    assert_eq!(bsdf("chrome"), BsdfDescription::Conductor { metal, rough: None });
    let rough = ggx(0.3, Masking::HeightCorrelated);
    let choice = Choice::Constant(0.25);
    assert_eq!(bsdf("glass"), BsdfDescription::Dielectric { ior: 1.5, ior_outside: 1.33, choice, rough });
    let reflectance = Colour::Uniform(DVec3::new(0.4, 0.5, 0.6));
    let rough = ggx(0.2, Masking::HeightCorrelated);
    assert_eq!(bsdf("cup"), BsdfDescription::Plastic { reflectance, ior: 1.5, rough });
    let reflectance = Colour::Uniform(DVec3::new(0.7, 0.6, 0.5));
    assert_eq!(bsdf("lacquer"), BsdfDescription::Phong { reflectance, specular: DVec3::splat(0.3), exponent: 50.0 });
    let Geometry::Mesh { uvs, .. } = &d.shapes[2].geometry else { panic!() };
    assert_eq!(uvs[1], [DVec2::ZERO, DVec2::new(2.0, 0.0), DVec2::ONE]);
    // lights in the order of the file
    let [point, LightDescription::Environment { sky: Sky::LatLong(sky), rotate, scale }, sun] = d.lights.as_slice()
    else {
        panic!("{:?}", d.lights)
    };
    let (position, intensity) = (DVec3::new(0.0, 3.0, 0.0), DVec3::new(10.0, 20.0, 30.0));
    assert_eq!(*point, LightDescription::Point { position, intensity });
    let (direction, irradiance) = (DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(*sun, LightDescription::Directional { direction, irradiance });
    assert_eq!((*rotate, *scale, sky.size), (90.0, 2.0, [3, 2]));
    assert_eq!(sky.texels, SKY.map(Rgb::from_array), "the values are exact in RGBE");

    // defaults, and glass without a step of the index
    let d = read(&RICH.replace("choice = 0.25\nalpha = 0.3", "").replace("ior_outside = 1.33", ""));
    let glass = BsdfDescription::Dielectric { ior: 1.5, ior_outside: 1.0, choice: Choice::Fresnel, rough: None };
    assert_eq!(d.materials[4].bsdf, glass);
    read(
        &RICH
            .replace("choice = 0.25\nalpha = 0.3", "choice = \"fresnel\"")
            .replace("ior_outside = 1.33", "ior_outside = 1.5"),
    );
    let constant = read(&RICH.replace("file = \"sky.hdr\"\nmapping = \"latlong\"\n", "radiance = [1, 2, 3]\n"));
    let sky = Sky::Constant(DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(constant.lights[1], LightDescription::Environment { sky, rotate: 90.0, scale: 2.0 });
}

/// Every format, decoded: linear ones as they are, sRGB ones by the inverse of the curve that pictures are written with.
#[test]
fn images_are_linear() {
    let dir = gallery();
    let texels = |file: &str, mapping: &str| {
        let text = RICH.replace("sky.hdr", file).replace("latlong", mapping);
        let d = toml(&text, &dir.path().join("rich.toml"), &Options::default()).unwrap().description;
        match d.lights[1].clone() {
            LightDescription::Environment { sky: Sky::LatLong(r) | Sky::MirrorBall(r), .. } => r.texels.clone(),
            l => panic!("{l:?}"),
        }
    };
    assert_eq!(texels("sky.exr", "mirror-ball"), SKY[..4].iter().map(|t| Rgb::from_array(*t)).collect::<Vec<_>>());
    let coded = |file: &str| {
        texels(file, "latlong").iter().map(|t| t.to_array().map(|x| srgb(f64::from(x)))).collect::<Vec<_>>()
    };
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7);
    let wall = coded("wall.png");
    assert!(near(wall[0], [0.0, 10.0 / 255.0, 11.0 / 255.0]) && near(wall[1], [128.0 / 255.0, 188.0 / 255.0, 1.0]));
    assert!(near(coded("deep.png")[0], [32768.0 / 65535.0, 0.0, 1.0]));
    assert!(near(coded("solid.png")[0], [1.0, 2.0, 3.0].map(|n| n / 255.0)));
    assert_eq!(coded("flat.jpg").len(), 64);
    assert!(coded("flat.jpg").iter().all(|t| near(*t, [128.0 / 255.0; 3])));
}

/// Lights and the contents of images are part of what is hashed.
#[test]
fn canonical_text_holds_lights_and_textures() {
    let dir = gallery();
    let canonical = |text: &str| toml(text, &dir.path().join("rich.toml"), &Options::default()).unwrap().canonical;
    let own = canonical(RICH);
    assert_eq!(own, canonical(RICH));
    for (from, to) in [
        ("intensity = [10, 20, 30]", "intensity = [10, 20, 31]"),
        ("rotate = 90", "rotate = 91"),
        ("sky.hdr", "sky.exr"),
        ("wall.png", "deep.png"),
        ("[2, 0]]\nmaterial", "[2, 1]]\nmaterial"),
    ] {
        assert_ne!(own, canonical(&RICH.replace(from, to)), "{to}");
    }
    let before = std::fs::read(dir.path().join("wall.png")).unwrap();
    image::RgbImage::from_pixel(2, 1, image::Rgb([1, 2, 3])).save(dir.path().join("wall.png")).unwrap();
    assert_ne!(own, canonical(RICH), "another image under the same name");
    std::fs::write(dir.path().join("wall.png"), before).unwrap();
    assert_eq!(own, canonical(RICH));
}

/// A light without a surface lights a scene; one that sends nothing does not.
#[test]
fn lights_light_a_scene() {
    let dark = GOOD.replace("emission = [1, 2, 3]\n", "");
    for (light, lit) in [
        ("type = \"point\"\nposition = [0, 0, 1]\nintensity = [0, 0, 1]", true),
        ("type = \"point\"\nposition = [0, 0, 1]\nintensity = [0, 0, 0]", false),
        ("type = \"directional\"\ndirection = [0, 0, 1]\nirradiance = [0, 0, 1]", true),
        ("type = \"directional\"\ndirection = [0, 0, 1]\nirradiance = [0, 0, 0]", false),
        ("type = \"environment\"\nradiance = [0, 0, 1]", true),
        ("type = \"environment\"\nradiance = [0, 0, 0]", false),
        ("type = \"environment\"\nradiance = [0, 0, 1]\nscale = 0", false),
    ] {
        let text = format!("{dark}\n[[lights]]\n{light}\n");
        match parse(&text) {
            Ok(l) => assert!(lit && l.description.lights.len() == 1, "{light}"),
            Err(e) => assert!(!lit && e.what == "nothing in the scene emits light", "{light}: {e}"),
        }
    }
    let set = ["lights[0].position=[0, 2, 0]"];
    let text = format!("{dark}\n[[lights]]\ntype = \"point\"\nposition = [0, 0, 1]\nintensity = [1, 1, 1]\n");
    let d = toml(&text, Path::new("x.toml"), &options(&set, &[])).unwrap().description;
    assert!(matches!(d.lights[0], LightDescription::Point { position: DVec3 { y: 2.0, .. }, .. }));
}

/// The corners of a face keep their place in the image when a mirroring transform reverses its winding.
#[test]
fn texture_coordinates_follow_their_corner() {
    let uvs = "[[0, 0], [1, 0], [1, 1], [2, 0]]";
    for (rows, mirrored) in [("[[1,0,0,0],[0,1,0,0],[0,0,1,0]]", false), ("[[-1,0,0,0],[0,1,0,0],[0,0,1,0]]", true)] {
        let set = [format!("shapes[4].uvs={uvs}"), format!("shapes[4].transform={rows}")];
        let d = with(&set.each_ref().map(String::as_str)).unwrap().description;
        let Geometry::Mesh { vertices, faces, uvs } = &d.shapes[4].geometry else { panic!() };
        assert_eq!(faces[0] == [0, 2, 1], mirrored);
        for (face, uv) in faces.iter().zip(uvs) {
            for (i, uv) in face.iter().zip(uv) {
                let v = vertices[*i as usize];
                // the coordinates above are x and y of the vertex
                assert_eq!(*uv, DVec2::new(v.x.abs(), v.y));
            }
        }
    }
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
        assert!(e.what.starts_with("cannot read the file"), "{e}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("latin.TOML");
    std::fs::write(&path, b"# fine\nname = \"caf\xe9\"\n").unwrap();
    let e = scene(path.to_str().unwrap(), &Options::default()).unwrap_err();
    assert_eq!((e.what.as_str(), e.line), ("the file is not UTF-8 text", Some(2)));
}

// ------------------------------------------------------------------------------------------------ overrides

#[test]
fn overrides_replace_values() {
    let d = with(&[
        "materials.white.reflectance=[0.25, 0.5, 0.75]",
        "materials.white.sides=front",
        "shapes[1].emission=[4, 5, 6]",
        "shapes.2.inward = false",
        "camera.size[0]=16",
        "camera.fov=50",
        "camera.fov=60",
        "name=\"other\"",
    ])
    .unwrap()
    .description;
    assert_eq!(
        (d.materials[0].lambertian().unwrap(), d.materials[0].sides),
        (DVec3::new(0.25, 0.5, 0.75), Sides::Front)
    );
    assert_eq!(d.shapes[1].emission, DVec3::new(4.0, 5.0, 6.0));
    assert!(matches!(d.shapes[2].geometry, Geometry::Sphere { inward: false, .. }));
    assert_eq!((d.camera.size, d.camera.fov, d.name.as_str()), ([16, 6], 60.0, "other"));
    // an override can light a dark scene, and a wrong file can be put right
    let dark = GOOD.replace("emission = [1, 2, 3]\n", "").replace("fov = 40", "fov = 400");
    assert!(toml(&dark, Path::new("x.toml"), &options(&["shapes[0].power=[1, 1, 1]", "camera.fov=40"], &[])).is_ok());
}

#[test]
fn wrong_overrides_name_themselves() {
    for (set, key, what, help) in [
        (
            "materials.whit.reflectance=[1,1,1]",
            "materials.whit.reflectance",
            "`materials` has no `whit`",
            "did you mean `white`?",
        ),
        ("camera.fvo=3", "camera.fvo", "unknown key `fvo`", "did you mean `fov`?"),
        ("camra.fov=3", "camra.fov", "the scene has no `camra`", "did you mean `camera`?"),
        ("camera.fov=300", "camera.fov", "fov 300 is outside (0, 180)", "degrees"),
        ("camera.fov=[1", "camera.fov", "`[1` is not a TOML value", "number"),
        ("camera.fov", "camera.fov", "an override needs a value", "KEY=VALUE"),
        ("camera.fov=", "camera.fov", "`` is not a TOML value", "number"),
        ("camera.fov.x=3", "camera.fov.x", "`camera.fov` is an integer, it has no `x`", "leave"),
        ("shapes[5].emission=[1,1,1]", "shapes[5].emission", "`shapes` has no [5], it has 5 elements", "start at 0"),
        ("shapes[x].emission=[1,1,1]", "shapes[x].emission", "`shapes[x].emission` is not a key", "shapes[5].emission"),
        ("shapes[0].emission=[1,-1,1]", "shapes[0].emission", "emission -1 is negative", "at least 0"),
        (
            "materials.white.reflectance[1]=2",
            "materials.white.reflectance",
            "reflectance 2 is outside [0, 1]",
            "receives",
        ),
        ("materials.new={type=\"diffuse\"}", "materials.new.reflectance", "missing key `reflectance`", "add"),
        ("light=3", "light", "unknown key `light`", "keys here"),
    ] {
        let e = with(&[set]).expect_err(set);
        assert!(e.what.starts_with(what), "{set}: {e}");
        assert_eq!((e.key, e.line, e.file), (Some(format!("--set {key}")), None, None), "{set}");
        assert!(e.help.as_deref().unwrap_or_default().contains(help), "{set}: {:?}", e.help);
    }
}

#[test]
fn emit_lights_every_shape_of_a_material() {
    let good = Path::new("good.toml");
    let d = toml(GOOD, good, &options(&[], &["left=7, 8, 9"])).unwrap().description;
    let lit: Vec<_> = d.shapes.iter().map(|s| s.emission.x).collect();
    assert_eq!(lit, [1.0, 7.0, 7.0, 0.0, 0.0]);
    for (emit, what) in [
        ("lfet=1,1,1", "no shape has a material `lfet`"),
        ("left", "no radiance is given"),
        ("left=1,1", "`1,1` is not a radiance of three channels"),
        ("left=1,1,x", "`1,1,x` is not a radiance of three channels"),
        ("left=1,1,-1", "`1,1,-1` is not a radiance of three channels"),
        ("left=1,1,NaN", "`1,1,NaN` is not a radiance of three channels"),
    ] {
        let e = toml(GOOD, good, &options(&[], &[emit])).expect_err(emit);
        assert_eq!((e.what.as_str(), e.key), (what, Some(format!("--emit {emit}"))));
    }
}

// ------------------------------------------------------------------------------------------------ meaning

/// Φ = L π A for every kind of shape, A being written down by hand.
#[test]
fn power_is_radiance_times_pi_times_area() {
    let areas = [1.0, 6.0, 4.0 * PI * 4.0 * 0.5, PI * 0.25, 0.5 + 1.0];
    for (i, area) in areas.into_iter().enumerate() {
        let text = GOOD.replace("emission = [1, 2, 3]\n", "");
        let set = format!("shapes[{i}].power=[10, 20, 0]");
        let d = toml(&text, Path::new("x.toml"), &options(&[&set], &[])).unwrap().description;
        let wanted = DVec3::new(10.0, 20.0, 0.0) / (PI * area);
        assert!((d.shapes[i].emission - wanted).length() < 1e-14 * wanted.length(), "shape {i}");
    }
}

/// A mirroring transform moves the front with the surface: n·(image of the front side) stays positive.
#[test]
fn transforms_move_the_front_along() {
    for rows in [
        "[[2, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7]]",
        "[[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]",
        "[[1, 0, 0, 0], [0, 1, 0, 0], [0.5, 0, -3, 1]]",
    ] {
        let d = with(&[&format!("shapes[4].transform={rows}")]).unwrap().description;
        let numbers: Vec<f64> = rows.split(['[', ']', ',']).filter_map(|t| t.trim().parse().ok()).collect();
        let image = |v: DVec3| DVec3::from_array([0, 4, 8].map(|i| DVec3::from_slice(&numbers[i..]).dot(v)));
        let Primitive::Triangle([a, b, c]) = d.shapes[4].geometry.primitives()[0] else { panic!() };
        assert_eq!(a, DVec3::new(numbers[3], numbers[7], numbers[11]), "the corner at 0 moves by the last column");
        // the untransformed triangle (0,0,0) (1,0,0) (1,1,0) has its front at +z
        assert!((b - a).cross(c - a).dot(image(DVec3::Z)) > 0.0, "{rows}");
        assert!([b - a, c - a].contains(&image(DVec3::X)), "{rows}");
    }
}

#[test]
fn built_ins_load_without_a_warning() {
    assert_eq!(builtin::names()[..5], ["cornell", "furnace", "sphere", "shells", "cornell-spheres"]);
    let files = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")).unwrap();
    assert_eq!(files.filter(|f| f.as_ref().unwrap().path().extension().is_some_and(|e| e == "toml")).count(), 14);
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/README.md")).unwrap();
    for b in &builtin::ALL {
        let loaded = scene(b.name, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((loaded.description.name.as_str(), loaded.warnings.len()), (b.name, 0));
        assert!(readme.contains(&format!("[`{0}`]({0}.toml)", b.name)) && b.source.starts_with("# "));
        // the file is the same scene, and the canonical text depends on nothing but the scene
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{}.toml", b.name));
        let again = scene(file.to_str().unwrap(), &Options::default()).unwrap();
        assert_eq!(again.canonical, loaded.canonical);
        let other = scene(b.name, &options(&["camera.fov=41"], &[])).unwrap();
        assert_ne!(other.canonical, loaded.canonical);
    }
}

/// The corners of both blocks as Mitsuba 3 writes them out, and the walls' normals into the room.
#[test]
fn cornell_corners() {
    let small = [
        [0.135820493, -1.0, 0.0053975],
        [0.709602475, -1.0, 0.180820495],
        [0.135820493, -0.4, 0.0053975],
        [0.709602475, -0.4, 0.180820495],
        [-0.039602499, -1.0, 0.579179525],
        [0.534179509, -1.0, 0.754602492],
        [-0.039602499, -0.4, 0.579179525],
        [0.534179509, -0.4, 0.754602492],
    ];
    let tall = [
        [-0.708859086, -1.01, -0.470960885],
        [-0.139039099, -1.01, -0.658859074],
        [-0.708859086, 0.21, -0.470960885],
        [-0.139039099, 0.21, -0.658859074],
        [-0.520960927, -1.01, 0.098859102],
        [0.048859101, -1.01, -0.089039102],
        [-0.520960927, 0.21, 0.098859102],
        [0.048859101, 0.21, -0.089039102],
    ];
    let d = scene("cornell", &Options::default()).unwrap().description;
    let center_of = |i: usize| DVec3::from([[0.335, -0.7, 0.38], [-0.33, -0.4, -0.28]][i - 6]);
    for (i, corners) in [(6, small), (7, tall)] {
        let mut found = 0;
        for p in d.shapes[i].geometry.primitives() {
            let Primitive::Parallelogram { origin, edge_u, edge_v } = p else { panic!() };
            for q in [origin, origin + edge_u, origin + edge_v, origin + edge_u + edge_v] {
                assert!(corners.iter().any(|&c| (q - DVec3::from(c)).length() < 1e-6), "{q} is no corner of block {i}");
            }
            // counts each of the eight corners three times, once per face
            found += corners
                .iter()
                .filter(|&&c| {
                    let w = DVec3::from(c) - origin;
                    w.dot(edge_u.cross(edge_v)).abs() < 1e-6
                })
                .count();
            assert!(edge_u.cross(edge_v).dot(origin + 0.5 * (edge_u + edge_v) - center_of(i)) > 0.0);
        }
        assert_eq!(found, 24);
    }
    for s in &d.shapes[..6] {
        let Geometry::Quad { origin, edge_u, edge_v } = s.geometry else { panic!() };
        let to_room = DVec3::ZERO - (origin + 0.5 * (edge_u + edge_v));
        assert!(edge_u.cross(edge_v).dot(to_room) > 0.0, "{} looks out of the room", s.name);
    }
    assert!(d.materials.iter().all(|m| m.sides == Sides::Front));
    assert_eq!(d.shapes[5].emission, DVec3::new(18.387, 13.9873, 6.75357));
}

/// The closed forms from their formulas, not from the file.
#[test]
fn expected_terms_of_the_built_ins() {
    let expect = |name| scene(name, &Options::default()).unwrap().description.expect.unwrap();
    let near = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
    let furnace: Vec<f64> = (0..9).map(|k| 0.5f64.powi(k)).collect();
    assert!(near(&expect("furnace").terms, &furnace));
    assert_eq!(expect("furnace").gamma, Some(0.5));
    let disk = PI * (0.6f64 / 0.8).powi(2) / 4.0;
    let sphere: Vec<f64> = (0..9).map(|k| if k == 0 { disk } else { 0.1 * 0.6f64.powi(k) }).collect();
    assert!(near(&expect("sphere").terms, &sphere));
    let mut pair = [0.0, 1.0];
    let mut shells = Vec::new();
    for _ in 0..9 {
        shells.push(pair[1]);
        pair = [0.9 * pair[1], 0.6 * (pair[0] / 16.0 + pair[1] * 15.0 / 16.0)];
    }
    assert!(near(&expect("shells").terms, &shells));
    let bowl: Vec<f64> = (0..9).map(|k| if k == 0 { 0.0 } else { 0.7 * 0.4 * 0.42f64.powi(k - 1) }).collect();
    assert!(near(&expect("sky-bowl").terms, &bowl));
    // the ball of glass covers a disk; midpoints of rings of equal area, R at each
    let (rings, frame) = (100_000, 4.0 * 22.5f64.to_radians().tan().powi(2));
    let mut glass = [0.0; 9];
    for i in 0..rings {
        let tan2 = (f64::from(i) + 0.5) / f64::from(rings) / 8.0;
        let sin = 3.0 * (tan2 / (1.0 + tan2)).sqrt();
        let (c, t) = ((1.0 - sin * sin).sqrt(), (1.0 - sin * sin / 2.25).sqrt());
        let r = 0.5 * (((c - 1.5 * t) / (c + 1.5 * t)).powi(2) + ((1.5 * c - t) / (1.5 * c + t)).powi(2));
        let terms = (1..9).map(|k| if k == 1 { r } else { (1.0 - r).powi(2) * r.powi(k - 2) });
        glass[1..].iter_mut().zip(terms).for_each(|(sum, t)| *sum += t * PI / 8.0 / frame / f64::from(rings));
    }
    glass[0] = 1.0 - PI / 8.0 / frame;
    let claimed = expect("glass-furnace").terms;
    assert!(claimed.iter().zip(glass).all(|(a, b)| (a - b).abs() < 1e-6), "{claimed:?} {glass:?}");
}

// ------------------------------------------------------------------------------------------------ OBJ

fn bad(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes").join(name).to_str().unwrap().to_owned()
}

#[test]
fn wrong_obj_files_are_refused_at_their_line() {
    for (file, in_file, line, key, what) in [
        ("nan.obj", "nan.obj", Some(4), Some("v"), "the vertex 0 nan 1 is not finite, or beyond 1e12"),
        ("short_vertex.obj", "short_vertex.obj", Some(4), Some("v"), "`0 1` is not a position"),
        (
            "out_of_range.obj",
            "out_of_range.obj",
            Some(5),
            Some("f"),
            "vertex index 4 is out of range, the file has 3 vertices",
        ),
        (
            "relative_out_of_range.obj",
            "relative_out_of_range.obj",
            Some(4),
            Some("f"),
            "vertex index -4 is out of range, the file has 3 vertices",
        ),
        (
            "zero_index.obj",
            "zero_index.obj",
            Some(4),
            Some("f"),
            "vertex index 0 is out of range, the file has 3 vertices",
        ),
        ("two_corners.obj", "two_corners.obj", Some(4), Some("f"), "the face `1 2` has fewer than 3 corners"),
        ("bad_corner.obj", "bad_corner.obj", Some(4), Some("f"), "`x` is not a corner"),
        ("nameless_material.obj", "nameless_material.obj", Some(4), Some("usemtl"), "usemtl needs a name"),
        ("all_flat.obj", "all_flat.obj", None, None, "every triangle of the file is without area"),
        ("no_faces.obj", "no_faces.obj", None, None, "the file has no faces"),
        ("missing_mtl.obj", "missing_mtl.obj", Some(2), Some("mtllib"), "cannot find the material file `nowhere.mtl`"),
        ("kd_above_one.obj", "kd_above_one.mtl", Some(3), Some("wall.Kd"), "reflectance 1.2 is outside [0, 1]"),
        ("negative_ke.obj", "negative_ke.mtl", Some(3), Some("wall.Ke"), "emission -1 is outside [0, 1e30]"),
        ("bad_kd.obj", "bad_kd.mtl", Some(2), Some("wall.Kd"), "`Kd 0.5 0.5` is not a colour"),
        (
            "vt_out_of_range.obj",
            "vt_out_of_range.obj",
            Some(5),
            Some("f"),
            "vt index 2 is out of range, the file has 1",
        ),
        ("bad_vt.obj", "bad_vt.obj", Some(4), Some("vt"), "`0 nan` is not a texture coordinate"),
        ("negative_ks.obj", "negative_ks.mtl", Some(3), Some("wall.Ks"), "Ks -0.1 is outside [0, 1e30]"),
        ("bad_ns.obj", "bad_ns.mtl", Some(3), Some("wall.Ns"), "`Ns many` is not a number from 0 on"),
        ("d_above_one.obj", "d_above_one.mtl", Some(3), Some("wall.d"), "`d 1.5` is not a number from 0 to 1"),
        ("headless.obj", "headless.mtl", Some(1), Some("Kd"), "Kd before the first newmtl"),
        ("dark.obj", "dark.obj", None, None, "nothing in the scene emits light"),
    ] {
        let e = scene(&bad(file), &Options::default()).expect_err(file);
        assert_eq!((e.what.as_str(), e.line, e.key.as_deref()), (what, line, key), "{file}");
        assert_eq!(e.file.as_deref().and_then(Path::file_name), Some(in_file.as_ref()));
        assert!(e.help.is_some(), "{file}");
    }
}

#[test]
fn a_dark_obj_says_how_to_light_it() {
    let e = scene(&bad("ambient_light.obj"), &Options::default()).unwrap_err();
    assert_eq!(
        e.help.as_deref(),
        Some(
            "material `light` has Ka 20 20 20 but no Ke: Ka is ambient reflection, not emission; pass --emit light=20,20,20; materials in use: light"
        )
    );
    let lit = scene(&bad("ambient_light.obj"), &options(&[], &["light=20,20,20"])).unwrap().description;
    assert_eq!(lit.shapes[0].emission, DVec3::splat(20.0));
    assert!(scene(&bad("dark.obj"), &options(&[], &["default=1,1,1"])).is_ok());
}

#[test]
fn an_imperfect_obj_loads_with_warnings() {
    let Loaded { description: d, warnings, .. } = scene(&bad("imperfect.obj"), &Options::default()).unwrap();
    let names: Vec<_> = d.shapes.iter().map(|s| (s.name.as_str(), d.materials[s.material].name.as_str())).collect();
    assert_eq!(names, [("sheet", "ligth"), ("sheet", "light"), ("dart", "glossy")]);
    let kd: Vec<_> = d.shapes.iter().map(|s| d.materials[s.material].lambertian().unwrap().x).collect();
    assert_eq!(kd, [0.5, 0.5, 0.25]);
    assert_eq!(d.shapes[1].emission, DVec3::new(17.0, 12.0, 4.0));
    assert_eq!(d.shapes.iter().map(|s| s.geometry.primitives().len()).collect::<Vec<_>>(), [2, 1, 2]);
    let triangle = Primitive::Triangle([DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 2.0, 0.0)]);
    assert_eq!(d.shapes[1].geometry.primitives(), [triangle]);
    let of = |w: &String| w.rsplit_once("imperfect.obj").map(|(_, w)| w.to_owned());
    let warnings: Vec<String> = warnings.iter().filter_map(of).collect();
    assert_eq!(
        warnings,
        [
            ":10: material `ligth` is not defined, it is grey 0.5; did you mean `light`?",
            ":13: material `light` has no Kd, it is grey 0.5",
            ":16: material `glossy` has map_Kd wood.png on polygons without vt, Kd is used",
            ":16: material `glossy` has Ks but no Ns, it is diffuse",
            ": triangles without area, left out: 1",
        ]
    );
    // seen from +z, the two metres fill 90 % of the frame
    let distance = 1.0 / (39.3077f64.to_radians() / 2.0).tan() / 0.9;
    assert!((d.camera.origin - DVec3::new(1.0, 1.0, distance)).length() < 1e-12);
    assert_eq!((d.camera.target, d.camera.size, d.name.as_str()), (DVec3::new(1.0, 1.0, 0.0), [256, 256], "imperfect"));
}

/// The table of `scenes/README.md`: statements of an MTL, the material they become, and what is said about it.
#[test]
fn mtl_materials() {
    let dir = gallery();
    let (obj, mtl) = (dir.path().join("a.obj"), dir.path().join("a.mtl"));
    let grey = |x: f64| Colour::Uniform(DVec3::splat(x));
    let diffuse = |x: f64| BsdfDescription::Diffuse { reflectance: grey(x) };
    let mirror = |x: f64| BsdfDescription::Mirror { reflectance: DVec3::splat(x) };
    let phong = |kd: f64, ks: f64, exponent: f64| BsdfDescription::Phong {
        reflectance: grey(kd),
        specular: DVec3::splat(ks),
        exponent,
    };
    let glass = |ior: f64| BsdfDescription::Dielectric { ior, ior_outside: 1.0, choice: Choice::Fresnel, rough: None };
    // the two texels of wall.png, decoded
    let wall = |factor: f64| {
        let read = RICH.replace("sky.hdr", "wall.png");
        let d = toml(&read, &dir.path().join("x.toml"), &Options::default()).unwrap().description;
        let LightDescription::Environment { sky: Sky::LatLong(r), .. } = &d.lights[1] else { panic!() };
        let texels = r.texels.iter().map(|t| (t.as_dvec3() * factor).as_vec3()).collect();
        BsdfDescription::Diffuse { reflectance: Colour::Texture(Raster::new(r.size, texels).into()) }
    };
    for (statements, placed, wanted, said) in [
        ("Kd 0.25", true, diffuse(0.25), &[][..]),
        ("Kd 0.25\nKs 0\nNs 10\nillum 2\nNi 1.5\nd 1\nTr 0\nTf 1 1 1", true, diffuse(0.25), &[]),
        ("", true, diffuse(0.5), &["has no Kd, it is grey 0.5"]),
        // lobes
        ("Kd 0.25\nKs 0.5\nNs 20", true, phong(0.25, 0.5, 20.0), &[]),
        ("Kd 0\nKs 0.75\nNs 200\nillum 2", true, phong(0.0, 0.75, 200.0), &[]),
        ("Kd 0.25\nKs 0.5", true, diffuse(0.25), &["has Ks but no Ns, it is diffuse"]),
        ("Kd 0.25\nKs 0.5\nNs 20\nillum 1", true, diffuse(0.25), &["has Ks, which illum 1 leaves out"]),
        (
            "Kd 1\nKs 1\nNs 20",
            true,
            phong(0.5, 0.5, 20.0),
            &["returns more than it receives, Kd + Ks reach 2: divided by that"],
        ),
        (
            "Kd 0.25\nKs 0.5\nNs 20\nillum 3",
            true,
            phong(0.25, 0.5, 20.0),
            &["mirrors in illum 3 beside its Kd: it is a lobe of exponent 20"],
        ),
        // mirrors
        ("Ks 0.75\nillum 3", true, mirror(0.75), &[]),
        ("Kd 0.01\nKs 0.95\nNs 1024\nillum 5", true, mirror(0.95), &["is a mirror, without its Kd"]),
        ("Ks 2\nillum 3", true, mirror(1.0), &["returns more than it receives, Ks reaches 2: divided by that"]),
        // glass
        ("Kd 0\nNi 1.33\nillum 7", true, glass(1.33), &[]),
        (
            "Kd 0.01\nKs 0.3\nTf 0.1\nNs 1024\nNi 2.5\nillum 7",
            true,
            glass(2.5),
            &["is clear glass, without its Kd, Tf"],
        ),
        ("d 0.5", true, glass(1.5), &["has no Ni, 1.5 is used"]),
        ("Tr 0.5\nNi 1.2", true, glass(1.2), &[]),
        ("d -halo 0.5\nNi 1", true, glass(1.0), &["has Ni 1 and d below 1, it is invisible"]),
        ("d 0.5\nNi 0", true, glass(1.5), &["has Ni 0 outside [1, 10], 1.5 is used"]),
        ("Kd 0.25\nd 1\nTr 1", true, diffuse(0.25), &["has d 1 and Tr 1, which contradict each other: d counts"]),
        (
            "Kd 0.25\nillum 4\nNi 1",
            true,
            diffuse(0.25),
            &["has illum 4, but neither d below 1 nor Ni above 1: it is opaque"],
        ),
        // images
        ("map_Kd wall.png # beside the MTL", true, wall(1.0), &[]),
        ("Kd 0.5\nmap_Kd .\\wall.png", true, wall(0.5), &[]),
        ("Kd 0.5\nmap_Kd wall.png", false, diffuse(0.5), &["has map_Kd wall.png on polygons without vt, Kd is used"]),
        ("map_Kd -s 1 2 -clamp on wall.png", true, wall(1.0), &["has map_Kd options -s 1 2 -clamp on ignored"]),
        ("Kd 0.5\nmap_Kd oak wood.png", true, diffuse(0.5), &["has map_Kd oak wood.png, which is missing, Kd is used"]),
        (
            "Kd 0.5\nmap_Kd a.mtl",
            true,
            diffuse(0.5),
            &["has map_Kd a.mtl, which is no EXR, HDR, PNG or JPEG, Kd is used"],
        ),
        ("Kd 0\nmap_Kd wall.png", true, wall(0.0), &["has Kd 0, which makes its map_Kd black"]),
        ("Kd 0.25\nbump b.png\nmap_d c.png", true, diffuse(0.25), &["has bump b.png, map_d c.png ignored"]),
    ] {
        std::fs::write(&mtl, format!("newmtl a\nKe 1\n{statements}\n")).unwrap();
        let face = if placed { "f 1/1 2/2 3/3" } else { "f 1/1 2 3/3" };
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
        std::fs::write(&obj, format!("mtllib a.mtl\n{vertices}usemtl a\n{face}\n")).unwrap();
        let Loaded { description: d, warnings, .. } = scene(obj.to_str().unwrap(), &Options::default()).unwrap();
        assert_eq!(d.materials[0].bsdf, wanted, "{statements}");
        let said: Vec<_> = said.iter().map(|w| format!("{}:8: material `a` {w}", obj.display())).collect();
        assert_eq!(warnings, said, "{statements}");
        let Geometry::Mesh { uvs, .. } = &d.shapes[0].geometry else { panic!() };
        assert_eq!(*uvs, if placed { vec![[DVec2::ZERO, DVec2::X, DVec2::Y]] } else { vec![] });
    }
    // an image that is there but wrong is an error at its line
    std::fs::write(&mtl, "newmtl a\nKe 1\nmap_Kd bright.exr\n").unwrap();
    let e = scene(obj.to_str().unwrap(), &Options::default()).unwrap_err();
    assert!(e.what.ends_with("reflects 1.5, more than it receives"), "{e}");
    assert_eq!((e.file, e.line, e.key.as_deref()), (Some(mtl), Some(3), Some("a.map_Kd")));
}

/// One material with an image on two groups, one of them without vt: two materials, and one warning.
#[test]
fn images_go_where_texture_coordinates_are() {
    let dir = gallery();
    let obj = dir.path().join("a.obj");
    std::fs::write(dir.path().join("a.mtl"), "newmtl a\nKe 1\nKd 0.5\nmap_Kd wall.png\n").unwrap();
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 2 1\nvt 0 1\nusemtl a\n\
        g one\nf 1/-4 2/-3 3/-2 4/-1\ng two\nf 1 2 3\ng three\nf 1//1 2//1 3//1\ng four\nf 4/4 3/3 2/2\n";
    std::fs::write(&obj, text).unwrap();
    let Loaded { description: d, warnings, .. } = scene(obj.to_str().unwrap(), &Options::default()).unwrap();
    assert_eq!(d.shapes.iter().map(|s| s.material).collect::<Vec<_>>(), [0, 1, 1, 0]);
    assert!(d.materials[0].lambertian().is_none() && d.materials[1].lambertian() == Some(DVec3::splat(0.5)));
    assert_eq!((d.materials.len(), warnings.len()), (2, 1), "{warnings:?}");
    let Geometry::Mesh { uvs, .. } = &d.shapes[0].geometry else { panic!() };
    let [a, b, c, e] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(DVec2::from);
    assert_eq!(*uvs, [[a, b, c], [a, c, e]]);
    // a textured material of the scene needs them everywhere
    let text = RICH.replace(
        "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"gold\"",
        "type = \"obj\"\nfile = \"a.obj\"\nmaterial = \"wall\"",
    );
    let e = toml(&text, &dir.path().join("rich.toml"), &Options::default()).unwrap_err();
    assert_eq!(e.what, "material `wall` has a texture, this obj has no texture coordinates");
    assert_eq!((e.line, e.key.as_deref()), (Some(56), Some("shapes[1].material")));
}

/// The dart 0 1 2 3 with its reflex corner at 2 is star-shaped from 0; as 1 2 3 0 its fan overlaps itself.
#[test]
fn fans_of_concave_polygons_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dart.obj");
    for (face, warned) in [("1 2 3 4", false), ("2 3 4 1", true)] {
        std::fs::write(&path, format!("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf {face}\n")).unwrap();
        let loaded = scene(path.to_str().unwrap(), &options(&[], &["default=1,1,1"])).unwrap();
        assert_eq!(loaded.warnings.iter().any(|w| w.contains("polygons that are not convex: 1")), warned, "{face}");
    }
}

#[test]
fn obj_inside_toml() {
    let text = GOOD.replace("emission = [1, 2, 3]\n", "");
    let shape = "type = \"obj\"\nfile = \"imperfect.obj\"";
    let text = text.replace("type = \"disk\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 2]\nradius = 0.5", shape);
    let file = PathBuf::from(bad("here.toml"));
    let load = |text: &str, set: &[&str]| toml(text, &file, &options(set, &[]));
    // with a material the MTL is not read, and power spreads over the 2·2 + 2 + 2 square metres of all groups
    let d = load(&text, &["shapes[3].power=[8, 8, 8]"]).unwrap().description;
    assert_eq!((d.shapes.len(), d.materials.len()), (7, 2));
    let area: f64 = d.shapes[3..6].iter().flat_map(|s| s.geometry.primitives()).map(|p| p.area()).sum();
    assert!((d.shapes[3].emission.x - 8.0 / (PI * area)).abs() < 1e-14 && (area - 8.0).abs() < 1e-12);
    // without, its materials follow those of the scene
    let own = text.replace("imperfect.obj\"\nmaterial = \"white\"", "imperfect.obj\"");
    let d = load(&own, &["shapes[3].transform=[[1,0,0,10],[0,1,0,0],[0,0,1,0]]"]).unwrap().description;
    let names: Vec<_> = d.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["white", "left", "ligth", "light", "glossy"]);
    assert_eq!(d.shapes[4].emission, DVec3::new(17.0, 12.0, 4.0));
    assert_eq!(d.shapes[4].geometry.primitives()[0].bounds()[0].x, 10.0);
    let e = load(&own, &["shapes[3].emission=[1,1,1]"]).unwrap_err();
    assert_eq!(e.what, "the light of an OBJ comes from its MTL");
    let e = load(&own, &["shapes[3].file=nowhere.obj"]).unwrap_err();
    assert_eq!(e.key.as_deref(), Some("--set shapes[3].file"));
}

/// Files made by others, where they are at hand: a scene or a clear error, and never a panic.
#[test]
fn real_obj_files() {
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/inputs");
    let Ok(folder) = std::fs::read_dir(inputs.join("obj-edge-cases")) else { return };
    let edge_cases = folder.map(|f| f.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "obj"));
    let (mut loaded, mut refused) = (0, 0);
    for path in edge_cases {
        let path = path.to_str().unwrap();
        match scene(path, &Options::default()) {
            Ok(l) => sound(&l),
            // what is only dark is lit and loads
            Err(e) if e.what == "nothing in the scene emits light" => {
                let help = e.help.unwrap();
                let name = help.rsplit_once("in use: ").unwrap().1.rsplit(", ").next().unwrap();
                sound(&scene(path, &options(&[], &[&format!("{name}=1,1,1")])).unwrap());
                loaded += 1;
            }
            Err(e) => {
                assert!(e.file.is_some() && e.help.is_some(), "{e}");
                refused += 1;
            }
        }
    }
    assert_eq!((loaded, refused), (37, 9));
    let cornell = scene(inputs.join("akuna/CornellBox-Original.obj").to_str().unwrap(), &Options::default()).unwrap();
    let d = cornell.description;
    assert_eq!(d.primitives().len(), 36);
    let light = d.shapes.iter().find(|s| s.name == "light").unwrap();
    assert_eq!(light.emission, DVec3::new(17.0, 12.0, 4.0));
    let Primitive::Triangle([a, b, c]) = light.geometry.primitives()[0] else { panic!() };
    assert!((b - a).cross(c - a).y < 0.0, "the light shines down");
    let left = d.materials.iter().find(|m| m.name == "leftWall").unwrap();
    assert_eq!(left.lambertian().unwrap(), DVec3::new(0.63, 0.065, 0.05));
    let tall = d.materials.iter().find(|m| m.name == "tallBox").unwrap();
    let specular = DVec3::new(0.725, 0.71, 0.68);
    let reflectance = Colour::Uniform(DVec3::ZERO);
    assert_eq!(tall.bsdf, BsdfDescription::Phong { reflectance, specular, exponent: 200.0 });
    assert_eq!(cornell.warnings, [""; 0]);
    let cow = scene(inputs.join("spot.obj").to_str().unwrap(), &options(&[], &["default=1,1,1"])).unwrap();
    assert_eq!((cow.description.primitives().len(), cow.warnings.len()), (5856, 0));
}

// ------------------------------------------------------------------------------------------------ never a panic

fn runner(cases: u32) -> TestRunner {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    TestRunner::new_with_rng(Config { cases, failure_persistence: None, ..Config::default() }, rng)
}

/// A change to a text: a splice anywhere, or another value for one of its numbers.
#[derive(Clone, Debug)]
enum Edit {
    Splice { at: prop::sample::Index, cut: usize, put: String },
    Number { which: prop::sample::Index, put: String },
}

/// Up to three changes.
fn edits() -> impl Strategy<Value = Vec<Edit>> {
    #[rustfmt::skip]
    let nasty = prop::sample::select(vec![
        "nan", "-inf", "1e400", "9223372036854775807", "-9223372036854775808", "[", "]]", "0", "-1", "\"", "'''", "= ",
        "[[shapes]]\n", "{}", "\n", "#", "é", "\u{feff}", "\0", "/", "//", "1/1", "f 1 1 1\n", "usemtl ", "mtllib .\n", "\\\n",
    ]);
    let token = prop_oneof!["[ -~\n]{0,6}", nasty.prop_map(str::to_owned)];
    let number = prop_oneof![
        (-4i32..5).prop_map(|i| i.to_string()),
        (-3.0..3.0).prop_map(|x: f64| x.to_string()),
        any::<f64>().prop_map(|x| x.to_string()),
    ];
    let splice = (any::<prop::sample::Index>(), 0usize..12, token);
    let edit = prop_oneof![
        splice.prop_map(|(at, cut, put)| Edit::Splice { at, cut, put }),
        (any::<prop::sample::Index>(), number).prop_map(|(which, put)| Edit::Number { which, put }),
    ];
    prop::collection::vec(edit, 1..4)
}

fn edited(text: &str, edits: &[Edit]) -> String {
    let mut chars: Vec<char> = text.chars().collect();
    for edit in edits {
        match edit {
            Edit::Splice { at, cut, put } => {
                let at = at.index(chars.len() + 1);
                let end = (at + cut).min(chars.len());
                chars.splice(at..end, put.chars());
            }
            Edit::Number { which, put } => {
                let part = |i: usize| chars.get(i).is_some_and(|c| c.is_ascii_digit() || ".-".contains(*c));
                let starts: Vec<usize> = (0..chars.len()).filter(|&i| part(i) && (i == 0 || !part(i - 1))).collect();
                if starts.is_empty() {
                    continue;
                }
                let start = *which.get(&starts);
                let end = (start..).find(|&i| !part(i)).unwrap_or(chars.len());
                chars.splice(start..end, put.chars());
            }
        }
    }
    chars.into_iter().collect()
}

/// Whatever loads is sound: finite, with area, lit, and every index in range.
fn sound(l: &Loaded) {
    let d = &l.description;
    assert!(d.primitives().iter().all(|(_, p)| p.area() > 0.0 && p.area().is_finite()));
    assert!(d.shapes.iter().all(|s| s.material < d.materials.len() && s.emission.is_finite()));
    assert!(d.shapes.iter().any(|s| s.emission.max_element() > 0.0) || !d.lights.is_empty());
    assert!(d.camera.origin.is_finite() && d.camera.size.iter().all(|&n| n > 0));
}

#[test]
fn garbage_in_toml_never_panics() {
    let (good, refused) = (Cell::new(0), Cell::new(0));
    let dir = gallery();
    let file = dir.path().join("rich.toml");
    runner(2000)
        .run(&(edits(), any::<bool>()), |(edits, rich)| {
            let text = if rich { RICH } else { GOOD };
            match toml(&edited(text, &edits), &file, &Options::default()) {
                Ok(l) => {
                    sound(&l);
                    good.set(good.get() + 1);
                }
                Err(e) => {
                    assert!(!e.what.is_empty() && e.help.is_some(), "{e}");
                    refused.set(refused.get() + 1);
                }
            }
            Ok(())
        })
        .unwrap();
    let (good, refused) = (good.get(), refused.get());
    assert!(good > 100 && refused > 500, "{good} loaded, {refused} refused: the edits test nothing");
}

#[test]
fn garbage_in_obj_mtl_and_overrides_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    let (obj, mtl) = (folder.path().join("imperfect.obj"), folder.path().join("imperfect.mtl"));
    let (obj_text, mtl_text) =
        ["imperfect.obj", "imperfect.mtl"].map(|f| std::fs::read_to_string(bad(f)).unwrap()).into();
    let good = Cell::new(0);
    runner(600)
        .run(&(edits(), edits(), edits(), any::<bool>()), |(a, b, c, both)| {
            std::fs::write(&obj, edited(&obj_text, &a)).unwrap();
            std::fs::write(&mtl, if both { edited(&mtl_text, &b) } else { mtl_text.clone() }).unwrap();
            if let Ok(l) = scene(obj.to_str().unwrap(), &Options::default()) {
                sound(&l);
                good.set(good.get() + 1);
            }
            let set = edited("shapes[4].vertices=[[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]]", &c);
            if let Ok(l) = with(&[&set]) {
                sound(&l);
            }
            Ok(())
        })
        .unwrap();
    let good = good.get();
    assert!(good > 50, "only {good} loaded: the edits test nothing");
}
