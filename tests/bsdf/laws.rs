//! Laws of every surface: energy, reciprocity, Fresnel, and samples that say what they are.

use super::*;
use fredholm::scene::description::{
    ConductorSurface, DielectricSurface, DiffuseSurface, MirrorSurface, PhongSurface, PlasticSurface,
};

/// White furnace: what comes back is at most what came, and `albedo` says how much, or a bound that is not too small.
#[test]
fn no_surface_gains_energy() {
    for surface in all() {
        let bsdf = surface.bsdf();
        for z in [1.0, 0.8, 0.4, 0.1, 0.01] {
            let wo = tilted(z, 0.7);
            let truth =
                quadrature(&surface, &bsdf, wo, TransportMode::Flux, 30_000) + delta(&surface, wo, TransportMode::Flux);
            let (bound, max) = (bsdf.albedo(wo).as_dvec3(), bsdf.max_albedo().as_dvec3());
            let what = format!("z = {z}, {surface:?}: {truth}, bound {bound}, {max}");
            let slack = DVec3::splat(1e-5);
            assert!(truth.cmple(bound + slack).all() && bound.cmple(max + 1e-6).all(), "{what}");
            assert!(max.max_element() <= 1.0 + 1e-6, "{what}");
            let exact = match &surface.description {
                BsdfDescription::Diffuse(_) | BsdfDescription::Mirror(_) => true,
                BsdfDescription::Conductor(ConductorSurface { rough, .. })
                | BsdfDescription::Plastic(PlasticSurface { rough, .. }) => rough.is_none(),
                BsdfDescription::Dielectric(DielectricSurface { rough, .. }) => rough.is_none(),
                BsdfDescription::Phong(_) => z == 1.0,
            };
            assert!(!exact || (truth - bound).abs().max_element() < 2e-5, "{what}");
            let rough_plastic =
                matches!(surface.description, BsdfDescription::Plastic(PlasticSurface { rough: Some(_), .. }));
            assert!(!rough_plastic || (bound - truth).max_element() < 0.02, "{what}");
        }
    }
}

/// Microfacets that hide each other lose light, the more the rougher they are; smooth glass and a white coated base lose
/// none.
#[test]
fn only_roughness_loses_energy() {
    let wo = tilted(0.5, 0.0);
    let left = |surface: &Surface| quadrature(surface, &surface.bsdf(), wo, TransportMode::Flux, 30_000).x;
    let rough = |alpha| Some(Ggx { alpha, masking: Masking::HeightCorrelated });
    let alphas = [0.05, 0.2, 0.5, 1.0];
    for make in [|r| metal(Metal::Reflectance(DVec3::ONE), r), |r| glass(Choice::Fresnel, r, false)] {
        let kept = alphas.map(|a| left(&make(rough(a))));
        assert!(kept.windows(2).all(|w| w[1] < w[0]) && kept[0] > 0.99 && kept[3] < 0.9, "{kept:?}");
    }
    for z in [1.0, 0.5, 0.1, 0.001, 1e-4] {
        let wo = tilted(z, 0.3);
        for back in [false, true] {
            assert_eq!(glass(Choice::Fresnel, None, back).bsdf().albedo(wo), Vec3::ONE);
        }
        let white = plastic(DVec3::ONE, None).bsdf().albedo(wo);
        assert!((white - Vec3::ONE).abs().max_element() < 3e-7, "{white}");
    }
}

/// f(ω_o, ω_i)/η_i² is symmetric, and flux goes the other way round.
#[test]
fn light_may_go_either_way() {
    let mut noise = Noise(3);
    let mut crossed = 0;
    for surface in all() {
        let (here, other) = (surface.bsdf(), Surface { back: !surface.back, ..surface.clone() }.bsdf());
        if !here.connects() {
            continue;
        }
        for _ in 0..2000 {
            let wo = tilted(noise.uniform(), 6.0 * noise.uniform());
            let at_random = tilted(2.0 * noise.uniform() - 1.0, 6.0 * noise.uniform());
            let sampled = here.sample(wo, Sampling::Bsdf, TransportMode::Radiance, three(&mut noise));
            for wi in [Some(at_random), sampled.map(|s| s.wi)].into_iter().flatten() {
                let crosses = wi.z < 0.0;
                let mirrored = |v: Vec3| if crosses { Vec3::new(v.x, v.y, -v.z) } else { v };
                let back = if crosses { &other } else { &here };
                let eta2 = if crosses { surface.eta.powi(2) } else { 1.0 };
                let there = |mode| here.eval(wo, wi, mode).as_dvec3();
                let and_back = |mode| back.eval(mirrored(wi), mirrored(wo), mode).as_dvec3();
                let [radiance, flux] = BOTH.map(there);
                let [radiance_back, flux_back] = BOTH.map(and_back);
                // rounding of h, as steep as the lobe makes it where the directions graze
                let steep = 1e-5 / (surface.width * f64::from(wo.z.min(wi.z.abs())).min(surface.width).max(1e-3));
                let same = |a: DVec3, b: DVec3| (a - b).abs().cmple(1e-6 + (1e-5 + steep) * b).all();
                let what = format!("{wo} {wi} {surface:?}: {radiance} {flux} {radiance_back} {flux_back}");
                assert!(same(radiance * eta2, radiance_back), "{what}");
                assert!(same(radiance, flux_back) && same(flux, radiance_back), "{what}");
                crossed += usize::from(crosses && radiance.x > 0.0);
            }
        }
    }
    assert!(crossed > 10_000, "{crossed}");
}

#[test]
fn fresnel_is_exact() {
    for (id, eta) in [("fresnel_dielectric_1.5000", 1.5), ("fresnel_dielectric_2.4200", 2.42)] {
        let case = truth::case("fresnel", id);
        let interface = Interface::new(1.0, eta);
        for (degrees, row) in case.list("degrees").iter().zip(case.table("rows")) {
            let r = f64::from(interface.reflectance(degrees.to_radians().cos() as f32));
            assert!((r - row[2]).abs() < 1e-6, "η {eta}, {degrees}°: {r} for {}", row[2]);
        }
        assert!((f64::from(interface.reflectance(1.0)) - case.number("normal")).abs() < 1e-7);
        // at Brewster's angle only s is reflected: ½ ((η² − 1)/(η² + 1))²
        let r = f64::from(interface.reflectance(case.number("brewster_deg").to_radians().cos() as f32));
        let s = (eta * eta - 1.0) / (eta * eta + 1.0);
        assert!((r - 0.5 * s * s).abs() < 1e-7, "{r}");
        // at the critical angle, and beyond it
        let inside = Interface::new(eta, 1.0);
        let critical = (1.0 - 1.0 / (eta * eta)).sqrt();
        assert!(inside.reflectance((critical * (1.0 - 1e-6)) as f32) == 1.0 && inside.reflectance(1e-4) == 1.0);
        assert!(inside.refracted((critical * (1.0 - 1e-6)) as f32).is_none());
        assert!(inside.reflectance((critical * (1.0 + 1e-6)) as f32) < 1.0);
        // Snell and Fresnel the other way
        for i in 1..100 {
            let c = f64::from(i as f32 / 100.0);
            let t = f64::from(interface.refracted(c as f32).unwrap()) / eta;
            assert!((t * t - 1.0 + (1.0 - c * c) / (eta * eta)).abs() < 1e-6);
            let (there, back) = (interface.reflectance(c as f32), inside.reflectance(t as f32));
            // inside, the rounding of t weighs 1/c
            assert!(f64::from(there - back).abs() < eta * eta * 1e-6 / c, "{c}: {there} {back}");
            assert!((f64::from(there) - fresnel(c, eta, 0.0)).abs() < 3e-7);
        }
    }
    for (id, eta, k) in [("fresnel_conductor_0.2_3.9", 0.2, 3.9), ("fresnel_conductor_2.9_3.0", 2.9, 3.0)] {
        let case = truth::case("fresnel", id);
        for (degrees, row) in case.list("degrees").iter().zip(case.table("rows")) {
            let r = conductor(degrees.to_radians().cos() as f32, Vec3::splat(eta), Vec3::splat(k)).y;
            assert!((f64::from(r) - row[2]).abs() < 1e-6, "η {eta}, {degrees}°: {r} for {}", row[2]);
        }
    }
    let case = truth::case("fresnel", "fresnel_diffuse_1.5");
    assert!((hemispherical(1.5) - case.number("F_out")).abs() < 1e-14);
    assert!((hemispherical(1.0 / 1.5) - case.number("F_in")).abs() < 1e-14);
}

/// The closed form against the midpoint rule, and a metal without absorption against glass.
#[test]
fn fresnel_agrees_with_itself() {
    for eta in [1.0 + 1e-7, 1.0 + 1e-5, 1.001, 1.01, 1.3, 1.5, 2.42, 10.0, 0.9, 0.5] {
        let n = 100_000;
        let at = |i: usize| (i as f64 + 0.5) / n as f64;
        let mean = (0..n).map(|i| 2.0 * at(i) * fresnel(at(i), eta, 0.0)).sum::<f64>() / n as f64;
        assert!(
            (hemispherical(eta) - mean).abs() < 1e-6 + 1e-4 * mean.min(0.01),
            "{eta}: {} {mean}",
            hemispherical(eta)
        );
        for i in 1..200 {
            let c = i as f32 / 200.0;
            let (metal, glass) =
                (conductor(c, Vec3::splat(eta as f32), Vec3::ZERO).x, Interface::new(1.0, eta).reflectance(c));
            let t2 = (eta * eta - 1.0 + f64::from(c * c)).abs();
            assert!(f64::from(metal - glass).abs() < 1e-6 / t2.sqrt().min(1.0), "η {eta}, {c}: {metal} {glass}");
        }
    }
}

/// A description of any kind, with its extremes.
fn any_surface() -> impl Strategy<Value = (BsdfDescription, bool)> {
    let channel = || prop_oneof![6 => 0.0..1.0f64, 1 => Just(0.0), 1 => Just(1.0)];
    let rgb = move || (channel(), channel(), channel()).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    let masking = prop_oneof![Just(Masking::Separable), Just(Masking::HeightCorrelated)];
    let alpha = prop_oneof![4 => (-3.0..0.0f64).prop_map(|e| 10f64.powf(e)), 1 => Just(1e-3), 1 => Just(1.0)];
    let rough = prop::option::weighted(0.7, (alpha, masking).prop_map(|(alpha, masking)| Ggx { alpha, masking }));
    let choice = prop_oneof![Just(Choice::Fresnel), (0.01..0.99f64).prop_map(Choice::Constant)];
    let index = prop::array::uniform3(0.05..5.0f64).prop_map(DVec3::from);
    let metal = prop_oneof![
        rgb().prop_map(Metal::Reflectance),
        (index.clone(), index).prop_map(|(eta, k)| Metal::Fresnel { eta, k })
    ];
    let ior = || prop_oneof![4 => 1.05..3.0f64, 1 => 0.4..0.95f64, 1 => Just(1.0)];
    let exponent = prop_oneof![1 => Just(0.0), 4 => (0.0..6.0f64).prop_map(|e| 10f64.powf(e))];
    let description = prop_oneof![
        rgb().prop_map(|r| BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(r) })),
        rgb().prop_map(|reflectance| BsdfDescription::Mirror(MirrorSurface { reflectance })),
        (metal, rough.clone()).prop_map(|(metal, rough)| BsdfDescription::Conductor(ConductorSurface { metal, rough })),
        (ior(), choice, rough.clone()).prop_map(|(ior, choice, rough)| BsdfDescription::Dielectric(
            DielectricSurface { ior, ior_outside: 1.0, choice, rough }
        )),
        (rgb(), ior().prop_map(|n| n.max(1.0 / n)), rough).prop_map(|(r, ior, rough)| BsdfDescription::Plastic(
            PlasticSurface { reflectance: Colour::Uniform(r), ior, rough }
        )),
        (rgb(), rgb(), exponent).prop_map(|(d, s, exponent)| BsdfDescription::Phong(PhongSurface {
            reflectance: Colour::Uniform(0.5 * d),
            specular: 0.5 * s,
            exponent
        })),
    ];
    (description, any::<bool>())
}

fn any_number() -> impl Strategy<Value = f32> {
    let last = (1u32 << 24) - 1;
    prop_oneof![6 => 0..=last, 1 => Just(0), 1 => Just(last), 1 => Just(1)].prop_map(|i| i as f32 / (1u32 << 24) as f32)
}

fn any_direction() -> impl Strategy<Value = Vec3> {
    let z =
        prop_oneof![4 => 0.0..1.0f64, 2 => (-4.0..0.0f64).prop_map(|e| 10f64.powf(e)), 1 => Just(1.0), 1 => Just(1e-4)];
    (z, 0.0..6.3f64).prop_map(|(z, phi)| tilted(z.max(1e-4), phi))
}

proptest! {
    #![proptest_config(cases(3000))]

    #[test]
    fn samples_are_finite_and_say_what_they_are(
        (description, back) in any_surface(),
        wo in any_direction(),
        other in any_direction(),
        below in any::<bool>(),
        draws in prop::collection::vec(prop::array::uniform3(any_number()), 64),
    ) {
        let bsdf = Bsdf::new(&description, back);
        prop_assert!(bsdf.albedo(wo).is_finite() && bsdf.max_albedo().is_finite());
        prop_assert!(bsdf.albedo(wo).cmple(bsdf.max_albedo() + 1e-6).all());
        for (sampling, mode) in [Sampling::Bsdf, Sampling::Cosine, Sampling::Uniform].map(|s| BOTH.map(|c| (s, c))).concat() {
            let wi = if below { -other } else { other };
            let (f, p) = (bsdf.eval(wo, wi, mode), bsdf.pdf(wo, wi, sampling));
            prop_assert!(f.is_finite() && f.min_element() >= 0.0 && p.is_finite() && p >= 0.0, "{} {}: {} {}", wo, wi, f, p);
            for &u in &draws {
                let Some(s) = bsdf.sample(wo, sampling, mode, u) else { continue };
                prop_assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0, "{:?} {:?}", u, s);
                prop_assert!((s.wi.length() - 1.0).abs() < 1e-6 && s.wi.z != 0.0, "{:?} {:?} {}", u, s, s.wi.length());
                prop_assert!(s.pdf > 0.0 && s.pdf.is_finite(), "{:?} {:?}", u, s);
                prop_assert!((s.delta && bsdf.has_delta() && s.pdf <= 1.0) || (!s.delta && bsdf.connects()));
                if !s.delta {
                    let (f, p) = (bsdf.eval(wo, s.wi, mode), bsdf.pdf(wo, s.wi, sampling));
                    prop_assert!((p / s.pdf - 1.0).abs() < 1e-5, "{:?} {:?}: {}", u, s, p);
                    let (a, b) = (s.weight * s.pdf, f * s.wi.z.abs());
                    prop_assert!((a - b).abs().cmple(1e-5 * a.max(b) + 1e-30).all(), "{:?} {:?}: {} {}", u, s, a, b);
                }
            }
        }
    }
}
