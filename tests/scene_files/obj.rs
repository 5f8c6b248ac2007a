//! Geometry of OBJ files, materials of MTL files.

use super::*;
use fredholm::scene::description::{DielectricSurface, DiffuseSurface, MirrorSurface, PhongSurface};

#[test]
fn wrong_obj_files_are_refused_at_their_line() {
    for (file, in_file, line, key, what) in [
        ("nan.obj", "nan.obj", Some(4), Some("v"), "the vertex 0 nan 1 is not finite or exceeds 1e12"),
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
        ("all_flat.obj", "all_flat.obj", None, None, "no triangle of the file has an area"),
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
        ("headless.obj", "headless.mtl", Some(1), Some("Kd"), "Kd comes before the first newmtl"),
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
            ":10: material `ligth` is not defined; grey 0.5 is used; did you mean `light`?",
            ":13: material `light` has no Kd; grey 0.5 is used",
            ":16: material `glossy` has map_Kd wood.png, but its polygons have no vt; Kd is used",
            ":16: material `glossy` has Ks but no Ns, so it is rendered as diffuse",
            ": triangles without area that are ignored: 1",
        ]
    );
    // seen from +z, the two metres fill 90 % of the frame
    let distance = 1.0 / (39.3077f64.to_radians() / 2.0).tan() / 0.9;
    assert!((d.camera.origin - DVec3::new(1.0, 1.0, distance)).length() < 1e-12);
    assert_eq!((d.camera.target, d.camera.size, d.name.as_str()), (DVec3::new(1.0, 1.0, 0.0), [256, 256], "imperfect"));
}

/// The table of `scenes/README.md`: statements of an MTL, the material they become, and what is said about it. Long,
/// because it is that table.
#[test]
fn mtl_materials() {
    let dir = gallery();
    let (obj, mtl) = (dir.path().join("a.obj"), dir.path().join("a.mtl"));
    let grey = |x: f64| Colour::Uniform(DVec3::splat(x));
    let diffuse = |x: f64| BsdfDescription::Diffuse(DiffuseSurface { reflectance: grey(x) });
    let mirror = |x: f64| BsdfDescription::Mirror(MirrorSurface { reflectance: DVec3::splat(x) });
    let phong = |kd: f64, ks: f64, exponent: f64| {
        BsdfDescription::Phong(PhongSurface { reflectance: grey(kd), specular: DVec3::splat(ks), exponent })
    };
    let glass = |ior: f64| {
        BsdfDescription::Dielectric(DielectricSurface { ior, ior_outside: 1.0, choice: Choice::Fresnel, rough: None })
    };
    // the two texels of wall.png, decoded
    let wall = |factor: f64| {
        let read = RICH.replace("sky.hdr", "wall.png");
        let d = toml(&read, &dir.path().join("x.toml"), &Options::default()).unwrap().description;
        let LightDescription::Environment { sky: Sky::LatLong(r), .. } = &d.lights[1] else { panic!() };
        let texels = r.texels.iter().map(|t| (t.as_dvec3() * factor).as_vec3()).collect();
        BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Texture(Raster::new(r.size, texels).into()) })
    };
    for (statements, placed, wanted, said) in [
        ("Kd 0.25", true, diffuse(0.25), &[][..]),
        ("Kd 0.25\nKs 0\nNs 10\nillum 2\nNi 1.5\nd 1\nTr 0\nTf 1 1 1", true, diffuse(0.25), &[]),
        ("", true, diffuse(0.5), &["has no Kd; grey 0.5 is used"]),
        // lobes
        ("Kd 0.25\nKs 0.5\nNs 20", true, phong(0.25, 0.5, 20.0), &[]),
        ("Kd 0\nKs 0.75\nNs 200\nillum 2", true, phong(0.0, 0.75, 200.0), &[]),
        ("Kd 0.25\nKs 0.5", true, diffuse(0.25), &["has Ks but no Ns, so it is rendered as diffuse"]),
        ("Kd 0.25\nKs 0.5\nNs 20\nillum 1", true, diffuse(0.25), &["has Ks, which illum 1 does not use"]),
        (
            "Kd 1\nKs 1\nNs 20",
            true,
            phong(0.5, 0.5, 20.0),
            &["reflects more light than it receives: Kd + Ks reach 2, so its colours are divided by that"],
        ),
        (
            "Kd 0.25\nKs 0.5\nNs 20\nillum 3",
            true,
            phong(0.25, 0.5, 20.0),
            &["has illum 3 (mirror) and Kd; it is rendered with a Phong lobe of exponent 20"],
        ),
        // mirrors
        ("Ks 0.75\nillum 3", true, mirror(0.75), &[]),
        ("Kd 0.01\nKs 0.95\nNs 1024\nillum 5", true, mirror(0.95), &["is rendered as a mirror, without its Kd"]),
        (
            "Ks 2\nillum 3",
            true,
            mirror(1.0),
            &["reflects more light than it receives: Ks reaches 2, so its colours are divided by that"],
        ),
        // glass
        ("Kd 0\nNi 1.33\nillum 7", true, glass(1.33), &[]),
        (
            "Kd 0.01\nKs 0.3\nTf 0.1\nNs 1024\nNi 2.5\nillum 7",
            true,
            glass(2.5),
            &["is rendered as clear glass, without its Kd, Tf"],
        ),
        ("d 0.5", true, glass(1.5), &["has no Ni; 1.5 is used"]),
        ("Tr 0.5\nNi 1.2", true, glass(1.2), &[]),
        ("d -halo 0.5\nNi 1", true, glass(1.0), &["has Ni 1 and d below 1, so it is invisible"]),
        ("d 0.5\nNi 0", true, glass(1.5), &["has Ni 0 outside [1, 10]; 1.5 is used instead"]),
        ("Kd 0.25\nd 1\nTr 1", true, diffuse(0.25), &["has d 1 and Tr 1, which contradict each other; d is used"]),
        (
            "Kd 0.25\nillum 4\nNi 1",
            true,
            diffuse(0.25),
            &["has illum 4, but neither d below 1 nor Ni above 1, so it is opaque"],
        ),
        // images
        ("map_Kd wall.png # beside the MTL", true, wall(1.0), &[]),
        ("Kd 0.5\nmap_Kd .\\wall.png", true, wall(0.5), &[]),
        (
            "Kd 0.5\nmap_Kd wall.png",
            false,
            diffuse(0.5),
            &["has map_Kd wall.png, but its polygons have no vt; Kd is used"],
        ),
        (
            "map_Kd -s 1 2 -clamp on wall.png",
            true,
            wall(1.0),
            &["has map_Kd options that are ignored: -s 1 2 -clamp on"],
        ),
        (
            "Kd 0.5\nmap_Kd oak wood.png",
            true,
            diffuse(0.5),
            &["has map_Kd oak wood.png, but there is no file FOLDER/oak wood.png; Kd is used"],
        ),
        (
            "Kd 0.5\nmap_Kd a.mtl",
            true,
            diffuse(0.5),
            &["has map_Kd a.mtl, which is not an EXR, HDR, PNG or JPEG file; Kd is used"],
        ),
        ("Kd 0\nmap_Kd wall.png", true, wall(0.0), &["has Kd 0, which makes its map_Kd black"]),
        (
            "Kd 0.25\nbump b.png\nmap_d c.png",
            true,
            diffuse(0.25),
            &["has statements that are ignored: bump b.png, map_d c.png"],
        ),
    ] {
        std::fs::write(&mtl, format!("newmtl a\nKe 1\n{statements}\n")).unwrap();
        let face = if placed { "f 1/1 2/2 3/3" } else { "f 1/1 2 3/3" };
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
        std::fs::write(&obj, format!("mtllib a.mtl\n{vertices}usemtl a\n{face}\n")).unwrap();
        let Loaded { description: d, warnings, .. } = scene(obj.to_str().unwrap(), &Options::default()).unwrap();
        assert_eq!(d.materials[0].bsdf, wanted, "{statements}");
        let folder = dir.path().display().to_string();
        let line = |w: &&str| format!("{}:8: material `a` {}", obj.display(), w.replace("FOLDER", &folder));
        let said: Vec<_> = said.iter().map(line).collect();
        assert_eq!(warnings, said, "{statements}");
        let Geometry::Mesh { uvs, .. } = &d.shapes[0].geometry else { panic!() };
        assert_eq!(*uvs, if placed { vec![[DVec2::ZERO, DVec2::X, DVec2::Y]] } else { vec![] });
    }
    // an image that is there but wrong is an error at its line
    std::fs::write(&mtl, "newmtl a\nKe 1\nmap_Kd bright.exr\n").unwrap();
    let e = scene(obj.to_str().unwrap(), &Options::default()).unwrap_err();
    assert!(e.what.ends_with("reflects 1.5 times the light that it receives"), "{e}");
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
    assert_eq!(e.what, "material `wall` has a texture, but this obj has no texture coordinates");
    assert_eq!((e.line, e.key.as_deref()), (Some(56), Some("shapes[1].material")));
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
    assert_eq!(e.what, "an OBJ without `material` takes its emission from its MTL");
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
    assert_eq!(tall.bsdf, BsdfDescription::Phong(PhongSurface { reflectance, specular, exponent: 200.0 }));
    assert_eq!(cornell.warnings, [""; 0]);
    let cow = scene(inputs.join("spot.obj").to_str().unwrap(), &options(&[], &["default=1,1,1"])).unwrap();
    assert_eq!((cow.description.primitives().len(), cow.warnings.len()), (5856, 0));
}
