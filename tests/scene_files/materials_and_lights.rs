//! Materials, lights and images, read and refused.

use super::*;
use fredholm::scene::description::{ConductorSurface, DielectricSurface, MirrorSurface, PhongSurface, PlasticSurface};

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
    ("masking = \"separable\"", "reflectance = [0.5, 0.5, 0.5]", 22, "materials.gold.reflectance", "eta and k are given together with reflectance"),
    ("eta = [0.143, 0.375, 1.442]", "eta = [0, 0.375, 1.442]", 19, "materials.gold.eta", "eta 0 is outside [0.001, 100]"),
    ("k = [3.98, 2.39, 1.6]", "k = [3.98, -2.39, 1.6]", 20, "materials.gold.k", "k -2.39 is outside [0, 100]"),
    // roughness
    ("alpha = 0.1\n", "alpha = 0\n", 21, "materials.gold.alpha", "alpha 0 is below 0.001"),
    ("alpha = 0.1\n", "alpha = -0.1\n", 21, "materials.gold.alpha", "alpha -0.1 is below 0.001"),
    ("alpha = 0.1\n", "alpha = 1.1\n", 21, "materials.gold.alpha", "alpha 1.1 is above 1"),
    ("alpha = 0.1\n", "alpha = nan\n", 21, "materials.gold.alpha", "NaN is not finite"),
    ("alpha = 0.1\n", "", 21, "materials.gold.masking", "masking is given without alpha"),
    ("masking = \"separable\"", "masking = \"smith\"", 22, "materials.gold.masking", "`smith` is not a kind of masking"),
    // glass
    ("ior = 1.5", "ior = 0.9", 30, "materials.glass.ior", "ior 0.9 is outside [1, 10]"),
    ("ior_outside = 1.33", "ior_outside = 11", 31, "materials.glass.ior_outside", "ior_outside 11 is outside [1, 10]"),
    ("ior_outside = 1.33", "ior_outside = 1.5", 33, "materials.glass.alpha", "alpha is given, but the indices 1.5 and 1.5 hardly differ"),
    ("choice = 0.25", "choice = 0", 32, "materials.glass.choice", "choice 0 is outside (0, 1)"),
    ("choice = 0.25", "choice = 1", 32, "materials.glass.choice", "choice 1 is outside (0, 1)"),
    ("choice = 0.25", "choice = \"fresnell\"", 32, "materials.glass.choice", "`fresnell` is not a choice of reflection"),
    ("choice = 0.25", "choice = true", 32, "materials.glass.choice", "expected a number, found a boolean"),
    ("choice = 0.25", "sides = \"both\"", 32, "materials.glass.sides", "a dielectric always has both sides"),
    // plastic and phong
    ("alpha = 0.2", "ior = 0.5", 38, "materials.cup.ior", "ior 0.5 is outside [1, 10]"),
    ("specular = [0.3, 0.3, 0.3]", "specular = [0.31, 0.3, 0.3]", 43, "materials.lacquer.specular", "the sum of reflectance 0.7 and specular 0.31 exceeds 1"),
    ("specular = [0.3, 0.3, 0.3]", "specular = [-0.3, 0.3, 0.3]", 43, "materials.lacquer.specular", "specular -0.3 is outside [0, 1]"),
    ("exponent = 50", "exponent = -1", 44, "materials.lacquer.exponent", "exponent -1 is outside [0, 1e6]"),
    ("reflectance = [0.7, 0.6, 0.5]\nspecular", "texture = \"wall.png\"\nspecular", 43, "materials.lacquer.specular", "the sum of reflectance 1 and specular 0.3 exceeds 1"),
    // textures
    ("texture = \"wall.png\"", "texture = 3", 10, "materials.wall.texture", "expected a string, found an integer"),
    ("texture = \"wall.png\"", "texture = \"wall.tga\"", 10, "materials.wall.texture", "`DIR/wall.tga` is not an image that this program can read"),
    ("texture = \"wall.png\"", "texture = \"bright.exr\"", 10, "materials.wall.texture", "the texel in column 1, row 0 of `DIR/bright.exr` reflects 1.5 times the light that it receives"),
    ("material = \"gold\"", "material = \"wall\"", 57, "shapes[1].material", "material `wall` has a texture, but this sphere has no texture coordinates"),
    ("uvs = [[0, 0], [1, 0], [1, 1], [2, 0]]\nmaterial = \"glass\"", "material = \"wall\"", 63, "shapes[2].material", "material `wall` has a texture, but this mesh has no texture coordinates"),
    // lights
    ("type = \"directional\"\ndirection = [0, -2, 0]\nirradiance = [1, 2, 3]", "type = \"environment\"\nradiance = [1, 1, 1]", 79, "lights[2].type", "there is a second environment"),
    ("position = [0, 3, 0]\n", "", 66, "lights[0].position", "missing key `position`"),
    ("position = [0, 3, 0]", "power = [0, 3, 0]", 68, "lights[0].power", "unknown key `power`"),
    ("intensity = [10, 20, 30]", "intensity = [10, -20, 30]", 69, "lights[0].intensity", "intensity -20 is negative"),
    ("intensity = [10, 20, 30]", "intensity = [10, 2e30, 30]", 69, "lights[0].intensity", "intensity 2e30 is too large"),
    ("direction = [0, -2, 0]", "direction = [0, 0, 0]", 80, "lights[2].direction", "the direction has zero length"),
    ("irradiance = [1, 2, 3]", "irradiance = [1, 2]", 81, "lights[2].irradiance", "expected 3 numbers, found 2"),
    ("file = \"sky.hdr\"", "radiance = [1, 1, 1]", 74, "lights[1].mapping", "mapping is given without file"),
    ("file = \"sky.hdr\"\nmapping = \"latlong\"", "radiance = [1, 1, -1]", 73, "lights[1].radiance", "radiance -1 is negative"),
    ("file = \"sky.hdr\"", "radiance = [1, 1, 1]\nfile = \"sky.hdr\"", 74, "lights[1].file", "radiance and file are both given"),
    ("file = \"sky.hdr\"\nmapping = \"latlong\"\n", "", 71, "lights[1].radiance", "missing key `radiance`"),
    ("mapping = \"latlong\"", "mapping = \"cube\"", 74, "lights[1].mapping", "`cube` is not a mapping of a sky"),
    ("mapping = \"latlong\"", "mapping = \"mirror-ball\"", 73, "lights[1].file", "the photograph of a mirror sphere is 3×2 pixels, not square"),
    ("rotate = 90", "rotate = inf", 75, "lights[1].rotate", "inf is not finite"),
    ("scale = 2", "scale = -2", 76, "lights[1].scale", "scale -2 is outside [0, 1e30]"),
    ("scale = 2", "scale = 1e30", 76, "lights[1].scale", "the radiance 2.000e30 is too large"),
    ("file = \"sky.hdr\"", "file = \"nan.exr\"", 73, "lights[1].file", "the texel in column 1, row 1 of `DIR/nan.exr` is [0.5, NaN, 0.5]"),
    ("file = \"sky.hdr\"", "file = \"negative.exr\"", 73, "lights[1].file", "the texel in column 0, row 1 of `DIR/negative.exr` is [0.5, 0.5, -1]"),
    ("file = \"sky.hdr\"", "file = \"clear.png\"", 73, "lights[1].file", "cannot read `DIR/clear.png`: it has transparent texels"),
];

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
    assert_eq!(silver.bsdf, BsdfDescription::Mirror(MirrorSurface { reflectance: DVec3::new(0.9, 0.8, 0.7) }));
    let metal = Metal::Fresnel { eta: DVec3::new(0.143, 0.375, 1.442), k: DVec3::new(3.98, 2.39, 1.6) };
    assert_eq!(
        bsdf("gold"),
        BsdfDescription::Conductor(ConductorSurface { metal, rough: ggx(0.1, Masking::Separable) })
    );
    let metal = Metal::Reflectance(DVec3::new(0.5, 0.6, 0.7));
    assert_eq!(bsdf("chrome"), BsdfDescription::Conductor(ConductorSurface { metal, rough: None }));
    let rough = ggx(0.3, Masking::HeightCorrelated);
    let choice = Choice::Constant(0.25);
    assert_eq!(
        bsdf("glass"),
        BsdfDescription::Dielectric(DielectricSurface { ior: 1.5, ior_outside: 1.33, choice, rough })
    );
    let reflectance = Colour::Uniform(DVec3::new(0.4, 0.5, 0.6));
    let rough = ggx(0.2, Masking::HeightCorrelated);
    assert_eq!(bsdf("cup"), BsdfDescription::Plastic(PlasticSurface { reflectance, ior: 1.5, rough }));
    let reflectance = Colour::Uniform(DVec3::new(0.7, 0.6, 0.5));
    assert_eq!(
        bsdf("lacquer"),
        BsdfDescription::Phong(PhongSurface { reflectance, specular: DVec3::splat(0.3), exponent: 50.0 })
    );
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
    let glass = BsdfDescription::Dielectric(DielectricSurface {
        ior: 1.5,
        ior_outside: 1.0,
        choice: Choice::Fresnel,
        rough: None,
    });
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
