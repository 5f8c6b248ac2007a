//! Scene files: what is wrong is refused at its line and key, what is right is what the file says.
#![allow(clippy::unwrap_used)]

use fredholm::scene::{
    Primitive, SceneError, builtin,
    description::{Geometry, Sides},
    load::{Loaded, Options, scene, toml},
};
use glam::DVec3;
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
    Options { set: own(set), emit: own(emit) }
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
    ("[expect]", "[[lights]]\ntype = \"point\"\n[expect]", 55, "lights[0]", "point lights are not supported yet"),
    ("[expect]", "[[lights]]\ntype = \"lamp\"\n[expect]", 55, "lights[0]", "unknown light type `lamp`"),
    ("[expect]", "[lights]\n[expect]", 55, "lights", "[[lights]] are not supported yet"),
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
    ("sides = \"front\"", "texture = \"a.png\"", 17, "materials.left.texture", "textures are not supported yet"),
    ("type = \"diffuse\"\nreflectance = [0.6", "type = \"mirror\"\nreflectance = [0.6", 15, "materials.left.type", "material type `mirror` is not supported yet"),
    ("type = \"diffuse\"\nreflectance = [0.6", "type = \"diffus\"\nreflectance = [0.6", 15, "materials.left.type", "unknown material type `diffus`"),
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
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0]]", 53, "shapes[4].uvs", "uvs are not supported yet"),
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

#[test]
fn what_is_wrong_is_refused_at_its_line_and_key() {
    for &(from, to, line, key, what) in REFUSED {
        assert_eq!(GOOD.matches(from).count(), 1, "{from:?} is not one place of GOOD");
        let e = parse(&GOOD.replace(from, to)).expect_err(to);
        assert_eq!((e.what.as_str(), e.line, e.key.as_deref()), (what, Some(line), Some(key)), "{to:?}");
        assert_eq!(e.file.as_deref(), Some(Path::new("bad.toml")));
        assert!(e.help.is_some_and(|h| h.len() > 5), "{what} has no help");
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
    help: did you mean `cornell`? built-in scenes: cornell, furnace, sphere, shells
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
    assert_eq!(builtin::names(), ["cornell", "furnace", "sphere", "shells"]);
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
            ":16: material `glossy` has Ks 0.5 0.5 0.5, map_Kd wood.png ignored, only Kd and Ke are read",
            ": triangles without area, left out: 1",
        ]
    );
    // seen from +z, the two metres fill 90 % of the frame
    let distance = 1.0 / (39.3077f64.to_radians() / 2.0).tan() / 0.9;
    assert!((d.camera.origin - DVec3::new(1.0, 1.0, distance)).length() < 1e-12);
    assert_eq!((d.camera.target, d.camera.size, d.name.as_str()), (DVec3::new(1.0, 1.0, 0.0), [256, 256], "imperfect"));
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
    assert_eq!(cornell.warnings.len(), 2, "{:?}", cornell.warnings);
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
    assert!(d.shapes.iter().any(|s| s.emission.max_element() > 0.0));
    assert!(d.camera.origin.is_finite() && d.camera.size.iter().all(|&n| n > 0));
}

#[test]
fn garbage_in_toml_never_panics() {
    let (good, refused) = (Cell::new(0), Cell::new(0));
    runner(2000)
        .run(&edits(), |edits| {
            match parse(&edited(GOOD, &edits)) {
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
