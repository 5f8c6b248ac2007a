//! One of everything wrong with a scene file, each refused at its line and key.

use super::*;

/// (text of GOOD, its replacement, line, key, what)
#[rustfmt::skip]
const REFUSED: &[(&str, &str, usize, &str, &str)] = &[
    // the file
    ("name = \"good\"", "nane = \"good\"", 1, "nane", "unknown key `nane`"),
    ("name = \"good\"", "name = 3", 1, "name", "expected a string, found an integer"),
    ("name = \"good\"", "name = \"../up\"", 1, "name", "the scene name `../up` cannot be used for the output folder"),
    ("name = \"good\"", "name = \" \"", 1, "name", "the string is empty"),
    ("[camera]", "[kamera]", 3, "kamera", "unknown key `kamera`"),
    ("[expect]", "[[lights]]\ntype = \"lamp\"\n[expect]", 56, "lights[0].type", "`lamp` is not a type of light"),
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
    ("origin = [0, 0, 4]", "origin = [0, 0, 1e13]", 4, "camera.origin[2]", "1e13 m is too large for single-precision rays"),
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
    ("sides = \"front\"", "sides = \"fornt\"", 17, "materials.left.sides", "`fornt` is not a choice of sides"),
    ("sides = \"front\"", "side = \"front\"", 17, "materials.left.side", "unknown key `side`"),
    ("sides = \"front\"", "texture = \"a.png\"", 17, "materials.left.texture", "reflectance and texture are both given"),
    ("type = \"diffuse\"\nreflectance = [0.6", "type = \"diffus\"\nreflectance = [0.6", 15, "materials.left.type", "`diffus` is not a type of material"),
    // light
    ("emission = [1, 2, 3]", "emission = [1, -2, 3]", 25, "shapes[0].emission", "emission -2 is negative"),
    ("emission = [1, 2, 3]", "emission = [1, 1e31, 3]", 25, "shapes[0].emission", "emission 1e31 is too large"),
    ("emission = [1, 2, 3]", "power = [1, -2, 3]", 25, "shapes[0].power", "power -2 is negative"),
    ("emission = [1, 2, 3]", "emission = [1, 2, 3]\npower = [1, 1, 1]", 26, "shapes[0].power", "emission and power are both given"),
    // shapes
    ("type = \"quad\"", "type = \"quat\"", 20, "shapes[0].type", "`quat` is not a type of shape"),
    ("type = \"quad\"\n", "", 19, "shapes[0].type", "missing key `type`"),
    ("material = \"white\"\nemission", "material = \"whit\"\nemission", 24, "shapes[0].material", "unknown material `whit`"),
    ("material = \"white\"\nemission", "emission", 19, "shapes[0].material", "missing key `material`"),
    ("edge_u = [1, 0, 0]", "edge_u = [0, 0, 0]", 22, "shapes[0].edge_u", "the edge has zero length"),
    ("edge_u = [1, 0, 0]", "edge_w = [1, 0, 0]", 22, "shapes[0].edge_w", "unknown key `edge_w`"),
    ("edge_v = [0, 1, 0]", "edge_v = [-3, 0, 0]", 23, "shapes[0].edge_v", "edge_u and edge_v are parallel, so the quad has no area"),
    ("max = [1, 1, 1]", "max = [1, 0, 1]", 30, "shapes[1].max", "the box has no extent along y: min 0, max 0"),
    ("rotate_y = 10", "rotate_y = inf", 31, "shapes[1].rotate_y", "inf is not finite"),
    ("radius = 2", "radius = 0", 37, "shapes[2].radius", "radius 0 is not positive"),
    ("radius = 2", "radius = -2", 37, "shapes[2].radius", "radius -2 is not positive"),
    ("radius = 2\n", "", 34, "shapes[2].radius", "missing key `radius`"),
    ("z = [-0.5, 0.5]", "z = [0.5, 0.5]", 38, "shapes[2].z", "the band [0.5, 0.5] is empty"),
    ("z = [-0.5, 0.5]", "z = [0.5, -0.5]", 38, "shapes[2].z", "the band [0.5, -0.5] is empty"),
    ("z = [-0.5, 0.5]", "z = [-0.5, 1.5]", 38, "shapes[2].z", "the band [-0.5, 1.5] reaches beyond the sphere"),
    ("inward = true", "inward = 1", 39, "shapes[2].inward", "expected true or false, found an integer"),
    ("normal = [0, 0, 2]", "normal = [0, 0, 0]", 45, "shapes[3].normal", "the normal has zero length"),
    ("radius = 0.5", "radius = 2020-01-01", 46, "shapes[3].radius", "expected a number, found a date"),
    ("[0, 3, 2]]", "[0, 4, 2]]", 52, "shapes[4].faces[1]", "vertex index 4 is out of range, the mesh has 4 vertices"),
    ("[0, 3, 2]]", "\n[0, -1, 2]]", 53, "shapes[4].faces[1]", "vertex index -1 is out of range, the mesh has 4 vertices"),
    ("[0, 3, 2]]", "[0, 1, 3]]", 52, "shapes[4].faces[1]", "the triangle [0, 1, 3] has no area"),
    ("[0, 3, 2]]", "[0, 1, 1]]", 52, "shapes[4].faces[1]", "the triangle [0, 1, 1] has no area"),
    ("[0, 3, 2]]", "[0, 1, 2, 3]]", 52, "shapes[4].faces[1]", "expected 3 vertex indices, found 4"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = []", 52, "shapes[4].faces", "the mesh has no faces"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0]]", 53, "shapes[4].uvs", "the mesh has 1 uvs for 4 vertices"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0], [0, 1], [1, 1], [1]]", 53, "shapes[4].uvs[3]", "expected 2 numbers, found 1"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0], [0, nan], [1, 1], [1, 0]]", 53, "shapes[4].uvs[1][1]", "NaN is not finite"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\nuvs = [[0, 0], [0, 1e6], [1, 1], [1, 0]]", 53, "shapes[4].uvs[1]", "the texture coordinate [0, 1000000] is too large"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\ntransform = [[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]]", 53, "shapes[4].transform", "the transform flattens the shape, because its determinant is zero"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\ntransform = [[1, 0, 0], [0, 1, 0], [1, 1, 0]]", 53, "shapes[4].transform[0]", "expected 4 numbers, found 3"),
    ("type = \"disk\"", "type = \"obj\"\nfile = \"no.obj\"", 45, "shapes[3].center", "unknown key `center`"),
    ("type = \"disk\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 2]\nradius = 0.5", "type = \"obj\"\nfile = \"no.obj\"", 44, "shapes[3].file", "cannot read `no.obj`"),
    ("edge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"white\"\nemission = [1, 2, 3]", "edge_u = [1e-6, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"white\"\npower = [1e30, 0, 0]", 25, "shapes[0].power", "this power makes the radiance 3.183e35, which is too large"),
    ("faces = [[0, 1, 2], [0, 3, 2]]", "faces = [[0, 1, 2]]\ntransform = [[1e12, 0, 0, 1], [0, 1e12, 0, 0], [0, 0, 1e12, 0]]", 53, "shapes[4].transform", "the transform makes the shape too large or one of its triangles too thin"),
    // closed forms
    ("terms = [1, 0.5]", "terms = []", 56, "expect.terms", "terms is empty"),
    ("terms = [1, 0.5]", "terms = [1, -0.5]", 56, "expect.terms[1]", "-0.5 is negative"),
    ("gamma = 0.5", "gama = 0.5", 57, "expect.gama", "unknown key `gama`"),
    ("source = \"by hand\"", "", 55, "expect.source", "missing key `source`"),
    ("gamma = 0.5", "gamma = 1", 57, "expect.gamma", "with gamma = 1 the series diverges"),
    ("gamma = 0.5", "gamma = 0.5\ntotal = 2", 57, "expect.gamma", "gamma and total both give the terms beyond the last one"),
    ("gamma = 0.5", "total = 1.4", 57, "expect.total", "the whole series, 1.4, is smaller than the sum of the given terms, 1.5"),
    ("gamma = 0.5", "tolerance = 2", 57, "expect.tolerance", "a tolerance of 2"),
];

#[test]
fn what_is_wrong_is_refused_at_its_line_and_key() {
    refusals(GOOD, Path::new("bad.toml"), REFUSED);
}
