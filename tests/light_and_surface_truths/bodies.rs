//! Single bodies and bowls under a sky: their albedo, and the terms of what they reflect.

use super::*;
use fredholm::scene::description::{ConductorSurface, DiffuseSurface, MirrorSurface, PhongSurface, PlasticSurface};

/// ∫ f cos dω, by the midpoint rule in the disk of half vectors seen from above, where lobes are round.
fn albedo(bsdf: &Bsdf, wo: Vec3) -> DVec3 {
    const N: i32 = 600;
    let mut sum = DVec3::ZERO;
    // ω_i = reflection of ω_o about h: dω_i = 4 (ω_o·h) dh, dh = dx dy/h_z
    for (i, j) in (0..N).flat_map(|i| (0..2 * N).map(move |j| (i, j))) {
        let (r, phi) = ((f64::from(i) + 0.5) / f64::from(N), TAU * (f64::from(j) + 0.5) / f64::from(2 * N));
        // r = tan θ/(1 + tan θ): dense at the normal
        let tan = r / (1.0 - r);
        let z = 1.0 / (1.0 + tan * tan).sqrt();
        let h = DVec3::new(tan * z * phi.cos(), tan * z * phi.sin(), z);
        let c = wo.as_dvec3().dot(h);
        let wi = 2.0 * c * h - wo.as_dvec3();
        if c > 0.0 && wi.z > 0.0 {
            // dh = z³ tan dtan dφ
            let dh = z.powi(3) * tan / (1.0 - r).powi(2) / f64::from(N) * TAU / f64::from(2 * N);
            let f = bsdf.eval(wo, wi.as_vec3(), TransportMode::Radiance).as_dvec3();
            sum += f * wi.z * 4.0 * c * dh;
        }
    }
    sum
}

/// A convex body in a sky of 1: T¹ is its albedo in that direction, and there is nothing else.
#[test]
fn convex_bodies_show_their_albedo() {
    let mut jury = Jury::open("convex_bodies_show_their_albedo");
    let rho = DVec3::new(0.9, 0.5, 0.2);
    let colour = || Colour::Uniform(rho);
    let ggx = |alpha: f64| Some(Ggx { alpha, masking: Masking::HeightCorrelated });
    let gold = Metal::Fresnel { eta: DVec3::new(0.17, 0.4, 1.4), k: DVec3::new(3.1, 2.4, 1.6) };
    let mut kinds = vec![
        BsdfDescription::Diffuse(DiffuseSurface { reflectance: colour() }),
        BsdfDescription::Mirror(MirrorSurface { reflectance: rho }),
        BsdfDescription::Conductor(ConductorSurface { metal: gold, rough: None }),
        BsdfDescription::Plastic(PlasticSurface { reflectance: colour(), ior: 1.5, rough: None }),
    ];
    for alpha in [0.1, 0.4, 1.0] {
        kinds.push(BsdfDescription::Conductor(ConductorSurface { metal: gold, rough: ggx(alpha) }));
        kinds.push(BsdfDescription::Plastic(PlasticSurface { reflectance: colour(), ior: 1.5, rough: ggx(alpha) }));
    }
    for exponent in [1.0, 40.0] {
        kinds.push(BsdfDescription::Phong(PhongSurface {
            reflectance: Colour::Uniform(0.5 * rho),
            specular: DVec3::splat(0.4),
            exponent,
        }));
    }
    for bsdf in &kinds {
        let scene = Scene::new(&under_the_sky(&[sphere(DVec3::NEG_Z, 1.0, false)], bsdf));
        let angles = [0.0, 45.0, 75.0];
        let starts = Starts(angles.map(|a| Start::At(tilted(&scene, a))).to_vec());
        let side = Bsdf::new(bsdf, false);
        let delta = side.has_delta();
        for way in [
            Way::Prefix(Technique::Scatter),
            Way::Prefix(Technique::Mis),
            Way::Prefix(Technique::Connect),
            Way::Single(Technique::Power),
        ] {
            let film = film(
                &scene,
                &starts,
                way,
                2,
                &Roulette::LECTURE,
                1 << 15,
                Key::new(jury.seed(), &format!("{bsdf:?} {way:?}")),
            );
            for (i, &degrees) in angles.iter().enumerate() {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let wo = DVec3::new(sin, 0.0, cos).as_vec3();
                let truth = if delta || matches!(bsdf, BsdfDescription::Diffuse(_)) {
                    side.albedo(wo).as_dvec3()
                } else {
                    albedo(&side, wo)
                };
                let label = format!("{bsdf:?}, {way:?}, {degrees}°");
                assert!(truth.max_element() < 1.0 + 1e-3, "{label}: {truth}");
                jury.judge(&label, &at(&film, i, 1..2), truth, 0.01 * truth, 0.3 * truth);
                assert!([0, 2, 3].iter().all(|&k| at(&film, i, k..k + 1).mean == DVec3::ZERO), "{label}");
            }
        }
    }
    jury.assert_power(0.2, 0.05);
}

/// Averaged over the body and its directions: Walsh's integral in closed form, and ρ of a Lambertian body, from all ends.
#[test]
fn bodies_reflect_their_share_of_the_sky() {
    let mut jury = Jury::open("bodies_reflect_their_share_of_the_sky");
    let fresnel = case("fresnel", "fresnel_diffuse_1.5");
    let (out, inside) = (fresnel.number("F_out"), fresnel.number("F_in"));
    assert!((hemispherical(1.5) - out).abs() < 1e-9);
    let rho = DVec3::new(0.9, 0.5, 0.2);
    // what enters, 1 − F_out, leaves the base ρ(1 − F_in)/(1 − ρ F_in) of it
    let plastic = rho.map(|rho| out + (1.0 - out) * rho * (1.0 - inside) / (1.0 - rho * inside));
    let colour = Colour::Uniform(rho);
    for (name, bsdf, truth) in [
        (
            "plastic",
            BsdfDescription::Plastic(PlasticSurface { reflectance: colour.clone(), ior: 1.5, rough: None }),
            plastic,
        ),
        ("paper", BsdfDescription::Diffuse(DiffuseSurface { reflectance: colour }), rho),
    ] {
        let mut d = under_the_sky(&[sphere(DVec3::ZERO, 1.0, false)], &bsdf);
        d.materials[0].sides = Sides::Front;
        let scene = Scene::new(&d);
        let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 };
        for technique in Technique::ALL {
            let film = film(
                &scene,
                &strip,
                Way::Prefix(technique),
                2,
                &Roulette::LECTURE,
                1 << 13,
                Key::new(jury.seed(), &format!("{name} {technique}")),
            );
            let image = image_replicates(&film);
            let judged =
                jury.judge(&format!("{name}, {technique}"), &image.estimate(1..2), truth, 0.01 * truth, 0.1 * truth);
            assert_ne!(judged, Judged::TooNoisy);
            assert!([0, 2, 3].iter().all(|&k| image.estimate(k..k + 1).mean == DVec3::ZERO));
        }
        // from a camera that sees the body only
        if name == "paper" {
            (d.camera.origin, d.camera.fov) = (DVec3::new(0.0, 0.0, 3.0), 20.0);
            let mut terms = once(0.0);
            terms[1] = rho;
            for way in all_ways() {
                check_image(&mut jury, name, &d, way, 1024, &terms);
            }
        }
    }
    jury.assert_power(0.4, 0.0);
}

/// A bowl under a real sky.
#[test]
fn bowls_under_the_sky_have_their_terms() {
    let mut jury = Jury::open("bowls_under_the_sky_have_their_terms");
    for id in ["bowl_hemisphere_rho0.7", "bowl_shallow_rho0.5"] {
        let case = case("spheres", id);
        let (z, rho) = (case.number("z_cut_over_R"), case.number("rho"));
        let mut d = description(&bands(1.0, &[z, -1.0], &[rho], &[0.0]));
        d.lights = vec![sky(case.number("sky"))];
        (d.camera.origin, d.camera.target, d.camera.up) = (DVec3::new(0.0, 0.3, 1.0), DVec3::NEG_Z, DVec3::Y);
        d.camera.fov = 25.0;
        let terms: Vec<DVec3> = case.list("terms").into_iter().take(K + 1).map(DVec3::splat).collect();
        for way in all_ways() {
            let mut terms = terms.clone();
            if let Way::Path(_) = way {
                terms = vec![DVec3::splat(case.number("L"))];
            }
            check_image(&mut jury, id, &d, way, 4096, &terms);
        }
    }
    jury.assert_power(0.1, 0.0);
}
