//! What the numbers of a scene mean.

use super::*;

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

/// A scene taken for Lambertian is one that a matrix can hold; one that is already stays the same.
#[test]
fn any_surface_can_be_taken_for_lambertian() {
    let lambertian = Options { lambertian: true, ..Options::default() };
    for name in builtin::names() {
        let [as_it_is, taken] = [&Options::default(), &lambertian].map(|o| scene(name, o).unwrap());
        let (before, after) = (&as_it_is.description, &taken.description);
        let all = before.materials.iter().all(|m| m.lambertian().is_some());
        assert_eq!(all, as_it_is.canonical == taken.canonical, "{name}");
        assert!(after.lights.len() == before.lights.len() && after.shapes == before.shapes, "{name}");
        for (b, a) in before.materials.iter().zip(&after.materials) {
            let rho = a.lambertian().unwrap();
            assert_eq!((&b.name, b.sides), (&a.name, a.sides), "{name}");
            assert!(rho.min_element() >= 0.0 && rho.max_element() <= 1.0, "{name}, {}: {rho}", a.name);
            // what passes through glass is lost, what a mirror reflects is not
            match b.bsdf.kind() {
                "dielectric" => assert_eq!(rho, DVec3::ZERO, "{name}, {}", a.name),
                "mirror" => assert!(rho.max_element() > 0.5, "{name}, {}", a.name),
                _ => assert!(b.lambertian().is_none_or(|b| b == rho), "{name}, {}", a.name),
            }
        }
        assert_eq!(after.radiosity_suits().is_ok(), before.lights.is_empty(), "{name}");
    }
}
