//! Mirrors: images of lamps, and furnaces where mirrors and Lambertian walls are mixed.

use super::*;
use fredholm::scene::description::{ConductorSurface, DiffuseSurface};

#[test]
fn a_mirror_wall_doubles_the_light() {
    let mut jury = Jury::open("a_mirror_wall_doubles_the_light");
    let c = case("specular", "direct_mirror_wall");
    let corners = |key: &str| c.table(key).iter().map(|p| DVec3::from_slice(p)).collect::<Vec<_>>();
    let (light, image) = (corners("light"), corners("image"));
    let (le, rho, rho_m) = (c.number("Le"), c.number("rho"), c.number("mirror"));
    let wall = quad(DVec3::new(0.0, -20.0, 0.0), DVec3::Y * 40.0, DVec3::Z * 20.0);
    let lamp = (quad(light[0], light[3] - light[0], light[1] - light[0]), DVec3::ZERO, DVec3::splat(le));
    let mut d = over_the_floor(&[lamp, (wall, DVec3::ZERO, DVec3::ZERO)], vec![], rho);
    d.materials[2].bsdf = mirror(rho_m);
    d.camera.target = DVec3::new(1.7, 1.7, 0.0);
    let f = |p: DVec3| {
        let mut terms = once(rho * le * polygon(p, &light));
        terms[2] = DVec3::splat(rho * rho_m * le * polygon(p, &image));
        terms
    };
    let scene = Scene::new(&d);
    let points: Vec<DVec3> = c.table("points").iter().map(|p| DVec3::from_slice(p)).collect();
    let starts = Starts(points.iter().map(|&p| Start::At(point(&scene, p, DVec3::Z))).collect());
    for way in Technique::ALL.into_iter().map(Way::Prefix) {
        let film = film(&scene, &starts, way, K, &Roulette::LECTURE.after(K), 1 << 16, Key::new(jury.seed(), "points"));
        for (i, p) in points.iter().enumerate() {
            for (k, key) in [(1, "T1"), (2, "T2")] {
                let truth = DVec3::splat(c.list(key)[i]);
                assert!((f(*p)[k] / truth - 1.0).abs().max_element() < 1e-9);
                let judged =
                    jury.judge(&format!("{way:?} {p} T{k}"), &at(&film, i, k..k + 1), truth, 0.01 * truth, 0.5 * truth);
                // in the mirror the light is found by hits alone
                assert!(k == 2 || way == Way::Prefix(Technique::Scatter) || judged != Judged::TooNoisy);
            }
            assert!([0, 3, 4, 5].iter().all(|&k| at(&film, i, k..k + 1).mean == DVec3::ZERO));
        }
    }
    // no image of the floor itself: the camera sees the floor only, so that light's walks see all of it
    let terms = image_mean(&d, |o, dir| f(on_floor(o, dir)));
    for way in all_ways() {
        check_image(&mut jury, "mirror wall", &d, way, 4096, &terms);
    }
    // a point light has an image, too, which only light's walks can find
    let mut d = over_the_floor(
        &[(quad(DVec3::new(0.0, -20.0, 0.0), DVec3::Y * 40.0, DVec3::Z * 20.0), DVec3::ZERO, DVec3::ZERO)],
        vec![],
        rho,
    );
    d.materials[1].bsdf = mirror(rho_m);
    d.camera.target = DVec3::new(1.7, 1.7, 0.0);
    let (from, i) = (DVec3::new(1.0, 0.5, 2.0), 4.0);
    d.lights = vec![LightDescription::Point { position: from, intensity: DVec3::splat(i) }];
    let lit = |p: DVec3, from: DVec3| rho / PI * i * from.z / (from - p).length().powi(3);
    let terms = image_mean(&d, |o, dir| {
        let p = on_floor(o, dir);
        let mut terms = once(lit(p, from));
        terms[2] = DVec3::splat(rho_m * lit(p, from * DVec3::new(-1.0, 1.0, 1.0)));
        terms
    });
    for way in [Way::Light, Way::Bidirectional(Technique::Mis), Way::Bidirectional(Technique::Power)] {
        check_image(&mut jury, "image of a point", &d, way, 8192, &terms);
    }
    // and the eye's walks cannot, which is said in `engine::known::unsampled`
    let mut direct = terms.clone();
    direct[2] = DVec3::ZERO;
    check_image(&mut jury, "image of a point", &d, Way::Prefix(Technique::Mis), 1024, &direct);
    jury.assert_power(0.1, 0.1);
}

/// Every sample in a closed room whose surfaces all reflect ρ, in whatever way, is ρ^k E.
#[test]
fn mirrors_and_lambertian_walls_make_the_same_furnace() {
    let two = case("specular", "mirror_two_parallel");
    let lambert =
        |rho: f64| BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(DVec3::splat(rho)) });
    let metal = |rho: f64| {
        BsdfDescription::Conductor(ConductorSurface { metal: Metal::Reflectance(DVec3::splat(rho)), rough: None })
    };
    let rs = two.number("rs");
    for (name, materials) in [
        ("mirrors", vec![mirror(rs); 3]),
        ("walls of mirrors", vec![mirror(rs), lambert(rs), metal(rs)]),
        ("things of mirrors", vec![lambert(rs), mirror(rs), metal(rs)]),
        ("metal walls", vec![metal(rs), mirror(rs), lambert(rs)]),
    ] {
        let e = DVec3::splat(two.number("E"));
        // round things: where two faces of a block meet, a few rays in a million end on the back of the next face
        let other = sphere(DVec3::new(-0.3, -0.4, -0.2), 0.35, false);
        let shapes = [room(DVec3::splat(-1.0), DVec3::ONE, 20.0), other, sphere(DVec3::splat(0.5), 0.3, false)];
        let mut d = description(&shapes.map(|g| (g, DVec3::ZERO, e)));
        d.materials.iter_mut().zip(materials).for_each(|(m, bsdf)| m.bsdf = bsdf);
        d.camera.origin = DVec3::new(-0.5, 0.6, 0.6);
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let plan = plan(8, Technique::Scatter, &Roulette::Never);
        let samples = [
            collect(&t, &scene.camera, &Prefix(plan.clone()), 32, 32, Key::new(1, name)),
            collect(&t, &scene.camera, &SingleTerm(plan), 32, 32, Key::new(1, name)),
        ];
        for path in samples.iter().flat_map(|s| s.paths()) {
            for (k, truth) in two.list("terms").into_iter().enumerate() {
                assert!((path[k] / truth - 1.0).abs().max_element() < 2e-6, "{name}, k = {k}: {} {truth}", path[k]);
            }
        }
    }
}
