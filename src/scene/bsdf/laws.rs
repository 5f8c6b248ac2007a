//! Tests of properties that every registered kind of surface must have. They use the examples that each kind provides.

use super::register::{BsdfDescription, KINDS};
use super::{Bsdf, Sampling, TransportMode};
use crate::math::{Key, Purpose, Rng};
use glam::Vec3;

/// Random directions over the hemisphere, and random numbers for sampling.
fn draws() -> impl Iterator<Item = (Vec3, [f32; 3])> {
    (0..400u32).map(|i| {
        let u = Rng::at(Key::new(3, "laws"), i, 0, 0, Purpose::Scatter).four();
        let z = 0.05 + 0.95 * u[3];
        (Vec3::new((1.0 - z * z).sqrt(), 0.0, z), [u[0], u[1], u[2]])
    })
}

#[test]
fn every_kind_gives_examples_of_itself() {
    let kinds: Vec<&str> = BsdfDescription::examples().iter().map(BsdfDescription::kind).collect();
    assert!(KINDS.iter().all(|k| kinds.contains(&k.name)), "{kinds:?}");
}

/// The weight of a sampled direction is f |cos θ_i|/p, except for delta directions.
#[test]
fn weights_are_f_cos_over_p() {
    for d in BsdfDescription::examples() {
        for (back, sampling) in [(false, Sampling::Bsdf), (true, Sampling::Bsdf), (false, Sampling::Uniform)] {
            let (f, mode) = (Bsdf::new(&d, back), TransportMode::Radiance);
            let mut drawn = 0;
            for (wo, u) in draws() {
                let Some(s) = f.sample(wo, sampling, mode, u).filter(|s| !s.delta) else { continue };
                let (p, weight) = (f.pdf(wo, s.wi, sampling), f.eval(wo, s.wi, mode) * s.wi.z.abs() / s.pdf);
                assert!((p - s.pdf).abs() <= 1e-3 * s.pdf, "{d:?}: {p} {}", s.pdf);
                assert!((weight - s.weight).abs().max_element() <= 2e-3 * s.weight.max_element() + 1e-6, "{d:?}");
                drawn += 1;
            }
            assert_eq!(drawn > 0, f.connects(), "{d:?}, {sampling:?}");
        }
    }
}

/// f(ω_o, ω_i) = f(ω_i, ω_o) on one side, and the albedo is at most the largest albedo, which is at most 1.
#[test]
fn surfaces_are_reciprocal_and_bounded() {
    for d in BsdfDescription::examples() {
        let (f, mode) = (Bsdf::new(&d, false), TransportMode::Radiance);
        for ((wo, _), (wi, u)) in draws().zip(draws().skip(7)) {
            let wi = Vec3::new(wi.x * (6.0 * u[0]).cos(), wi.x * (6.0 * u[0]).sin(), wi.z);
            let (a, b) = (f.eval(wo, wi, mode), f.eval(wi, wo, mode));
            assert!((a - b).abs().max_element() <= 2e-3 * a.max_element() + 1e-6, "{d:?}: {a} {b}");
            assert!(f.albedo(wo).cmple(f.max_albedo() + 1e-6).all() && f.max_albedo().max_element() <= 1.0 + 1e-6);
        }
    }
}
