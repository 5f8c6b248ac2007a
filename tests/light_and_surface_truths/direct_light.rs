//! Direct light of lights without a surface, in closed form, from the eye and from both ends.

use super::*;

#[test]
fn lights_without_a_surface_light_points_exactly() {
    let case = case("direct", "direct_point_light");
    let (i, h, rho) = (case.number("I"), case.number("h"), case.number("rho"));
    let light = LightDescription::Point { position: DVec3::Z * h, intensity: DVec3::splat(i) };
    let sun =
        LightDescription::Directional { direction: DVec3::new(1.0, 2.0, -2.0), irradiance: DVec3::new(1.0, 2.0, 3.0) };
    for (name, light) in [("point", light), ("sun", sun)] {
        let scene = Scene::new(&over_the_floor(&[], vec![light], rho));
        for (offset, truth) in case.list("offsets").into_iter().zip(case.list("T1")) {
            let truth =
                if name == "sun" { rho / PI * 2.0 / 3.0 * DVec3::new(1.0, 2.0, 3.0) } else { DVec3::splat(truth) };
            let starts = Starts(vec![Start::At(point(&scene, DVec3::X * offset, DVec3::Z))]);
            for technique in [Technique::Connect, Technique::Mis, Technique::Power] {
                let plan = plan(3, technique, &Roulette::LECTURE);
                let t = SceneTransport::new(&scene);
                let samples = [
                    collect(&t, &starts, &Prefix(plan.clone()), 64, 32, Key::new(1, name)),
                    collect(&t, &starts, &SingleTerm(plan.clone()), 64, 32, Key::new(1, name)),
                ];
                for path in samples.iter().flat_map(|s| s.paths()) {
                    assert!(
                        (path[1] / truth - 1.0).abs().max_element() < 2e-6,
                        "{name}, {technique}: {} {truth}",
                        path[1]
                    );
                    assert!([0, 2, 3, 4].iter().all(|&k| path[k] == DVec3::ZERO), "{name}, {technique}: {path:?}");
                }
                for path in collect(&t, &starts, &PathTracer(plan), 64, 32, Key::new(1, name)).paths() {
                    assert!((path[0] / truth - 1.0).abs().max_element() < 2e-6, "{name}, {technique}");
                }
            }
        }
    }
}

#[test]
fn direct_light_is_the_closed_form_from_both_ends() {
    let mut jury = Jury::open("direct_light_is_the_closed_form_from_both_ends");
    let mut judge = |name: &str, d: &Description, seen_by_hits: bool, truth: &dyn Fn(DVec3) -> f64| {
        let terms = image_mean(d, |o, dir| once(truth(on_floor(o, dir))));
        for way in all_ways() {
            if seen_by_hits || way != Way::Prefix(Technique::Scatter) {
                check_image(&mut jury, name, d, way, 1024, &terms);
            }
        }
    };

    let c = case("direct", "direct_rect_light");
    let corners: Vec<DVec3> = c.table("light").iter().map(|p| DVec3::from_slice(p)).collect();
    let (le, rho) = (c.number("Le"), c.number("rho"));
    for (p, t) in c.table("points").iter().zip(c.list("T1")) {
        assert!((rho * le * polygon(DVec3::from_slice(p), &corners) / t - 1.0).abs() < 1e-9);
    }
    let light = (quad(corners[0], corners[3] - corners[0], corners[1] - corners[0]), DVec3::ZERO, DVec3::splat(le));
    judge("rectangle", &over_the_floor(&[light], vec![], rho), true, &|p| rho * le * polygon(p, &corners));

    let c = case("direct", "direct_disk_light");
    let (r, h, le, rho) = (c.number("R"), c.number("h"), c.number("Le"), c.number("rho"));
    let f = |a2: f64| {
        let s = h * h + a2;
        rho * le * 0.5 * (1.0 - (s - r * r) / ((s + r * r).powi(2) - 4.0 * r * r * a2).sqrt())
    };
    for (a, t) in c.list("offsets").into_iter().zip(c.list("T1")) {
        assert!((f(a * a) / t - 1.0).abs() < 1e-9);
    }
    let light =
        (Geometry::Disk { center: DVec3::Z * h, normal: DVec3::NEG_Z, radius: r }, DVec3::ZERO, DVec3::splat(le));
    judge("disk", &over_the_floor(&[light], vec![], rho), true, &|p| f(p.length_squared()));

    let (c, s) = (case("direct", "direct_point_light"), case("direct", "direct_sphere_equals_point"));
    let (h, rho, i) = (c.number("h"), c.number("rho"), s.number("I"));
    let f = |p: DVec3| rho / PI * i * h / (p.length_squared() + h * h).powf(1.5);
    let light = (sphere(DVec3::Z * h, s.number("R"), false), DVec3::ZERO, DVec3::splat(s.number("Le")));
    judge("ball", &over_the_floor(&[light], vec![], rho), true, &f);
    let light = LightDescription::Point { position: DVec3::Z * h, intensity: DVec3::splat(i) };
    judge("point", &over_the_floor(&[], vec![light], rho), false, &f);

    let light = LightDescription::Directional { direction: DVec3::new(1.0, 2.0, -2.0), irradiance: DVec3::splat(3.0) };
    judge("sun", &over_the_floor(&[], vec![light], rho), false, &|_| rho / PI * 3.0 * 2.0 / 3.0);

    // a sky that is quadratic, about five axes
    let c = case("direct", "direct_env_quadratic");
    let rho = c.number("rho");
    for (cos, t) in c.list("n_dot_u").into_iter().zip(c.list("T1")).take(3) {
        let axis = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let [w, h] = [256, 128];
        let texel = |i: u32| {
            let (theta, phi) =
                (PI * (f64::from(i / w) + 0.5) / f64::from(h), TAU * ((f64::from(i % w) + 0.5) / f64::from(w) - 0.5));
            let d = DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
            Vec3::splat(d.dot(axis).powi(2) as f32)
        };
        let sky = Sky::LatLong(Arc::new(Raster::new([w, h], (0..w * h).map(texel).collect())));
        let light = LightDescription::Environment { sky, rotate: 0.0, scale: 1.0 };
        judge(&format!("sky {cos}"), &over_the_floor(&[], vec![light], rho), true, &|_| t);
    }
    jury.assert_power(0.1, 0.0);
}
