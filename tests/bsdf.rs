//! How surfaces scatter: densities are those of the samples, weights those of the formulas, energy is never gained, and
//! light may go either way.
#![allow(clippy::unwrap_used, clippy::print_stderr, unreachable_pub)]

#[path = "bsdf/chi_square.rs"]
mod chi_square;
mod common;
#[path = "bsdf/laws.rs"]
mod laws;
#[path = "bsdf/surfaces.rs"]
mod surfaces;

use chi_square::{Cells, Chart, p_value, together};
use common::random::cases;
use common::{Noise, truth};
use fredholm::scene::bsdf::fresnel::{Interface, conductor, hemispherical};
use fredholm::scene::bsdf::{Bsdf, BsdfSample, Sampling, TransportMode};
use fredholm::scene::description::{BsdfDescription, Choice, Colour, Ggx, Masking, Metal};
use fredholm::scene::description::{ConductorSurface, DielectricSurface, MirrorSurface, PlasticSurface};
use fredholm::terms::Estimate;
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use surfaces::{Surface, all, fresnel, glass, gold, metal, outgoing, plastic, tilted};

const BOTH: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Flux];

/// Pilot samples in a cell.
const PILOT: usize = 8;

/// A multiple of 2⁻²⁴ in [0, 1), as the library's own.
fn uniform(noise: &mut Noise) -> f32 {
    (noise.bits() >> 40) as f32 / (1u32 << 24) as f32
}

fn three(noise: &mut Noise) -> [f32; 3] {
    std::array::from_fn(|_| uniform(noise))
}

/// Where a sample went.
enum Draw {
    Direction(Vec3),
    /// A delta direction, with the probability of its choice.
    Delta(f32),
    Nowhere,
}

impl From<Option<BsdfSample>> for Draw {
    fn from(sample: Option<BsdfSample>) -> Self {
        match sample {
            Some(s) if s.delta => Self::Delta(s.pdf),
            Some(s) => Self::Direction(s.wi),
            None => Self::Nowhere,
        }
    }
}

/// p-values of `n` draws at two resolutions; `None` where the density does not even add up.
fn p_values(
    wo: Vec3,
    cuts: &[f64],
    n: usize,
    noise: &mut Noise,
    draw: impl Fn([f32; 3]) -> Draw,
    pdf: impl Fn(Vec3) -> f32,
) -> Option<[f64; 2]> {
    let chart = Chart::about(wo);
    let mut pilot: Vec<[f64; 2]> = vec![];
    for _ in 0..n / 4 {
        if let Draw::Direction(wi) = draw(three(noise)) {
            pilot.push(chart.at(wi));
        }
    }
    let (mut found, mut nowhere, mut delta, mut p_delta) = (vec![], 0, 0, 0.0);
    for _ in 0..n {
        match draw(three(noise)) {
            Draw::Direction(wi) => found.push(chart.at(wi)),
            Draw::Delta(p) => (delta, p_delta) = (delta + 1, f64::from(p)),
            Draw::Nowhere => nowhere += 1,
        }
    }
    let cells = Cells::new(&mut pilot, PILOT, cuts);
    let density = |z: f64, phi: f64| DVec3::splat(f64::from(pdf(chart.direction(z, phi))));
    let expected: Vec<f64> = cells.integrals(density, 1e-4).iter().map(|v| v.x).collect();
    let mut counts = vec![0u64; expected.len()];
    found.iter().for_each(|&x| counts[cells.find(x)] += 1);
    let missing = 1.0 - p_delta - expected.iter().sum::<f64>();
    let result = [128, 512].map(|count| {
        let (mut observed, mut expected) = together(&counts, &expected, count);
        observed.extend([delta, nowhere]);
        expected.extend([p_delta, missing]);
        p_value(&observed, &expected)
    });
    (missing > -1e-3).then_some(result)
}

/// χ² of every sampler of every surface that has a density.
fn densities(account: &mut common::Account, n: usize) {
    let mut noise = Noise(account.seed());
    let mut smallest = 1.0f64;
    for surface in all() {
        let bsdf = surface.bsdf();
        if !bsdf.connects() {
            continue;
        }
        for (i, wo) in outgoing().into_iter().enumerate() {
            for &sampling in surface.samplings(i) {
                let draw = |u| bsdf.sample(wo, sampling, TransportMode::Radiance, u).into();
                let pdf = |wi| bsdf.pdf(wo, wi, sampling);
                let what = format!("{sampling:?}, {wo}, {surface:?}");
                let p = p_values(wo, &surface.cuts(wo), n, &mut noise, draw, pdf);
                let p = p.unwrap_or_else(|| panic!("{what}: the density adds up to more than 1"));
                let level = account.spend(2);
                assert!(p[0] > level && p[1] > level, "{what}: p = {p:?}, level {level:e}");
                smallest = smallest.min(p[0]).min(p[1]);
            }
        }
    }
    eprintln!("smallest of the p-values: {smallest:.1e}");
}

#[test]
fn directions_have_the_density_they_claim() {
    densities(&mut common::open("directions_have_the_density_they_claim"), 40_000);
}

#[test]
#[ignore = "minutes"]
fn a_million_directions_have_the_density_they_claim() {
    densities(&mut common::open("a_million_directions_have_the_density_they_claim"), 1_000_000);
}

/// The same judge, on densities that are wrong in ways that have happened.
#[test]
fn wrong_densities_are_found() {
    let mut account = common::open("wrong_densities_are_found");
    let mut noise = Noise(account.seed());
    let mut wrong = |what: &str, wo: Vec3, draw: &dyn Fn([f32; 3]) -> Draw, pdf: &dyn Fn(Vec3) -> f32| {
        let level = account.spend(1);
        let p = p_values(wo, &[0.0], 40_000, &mut noise, draw, pdf).map_or(0.0, |p| p[0].min(p[1]));
        assert!(p < level, "{what}: p = {p:e} passes the level {level:e}");
    };
    let rough = |alpha| metal(gold(), Some(Ggx { alpha, masking: Masking::Separable })).bsdf();
    let own = |bsdf: Bsdf, wo: Vec3| move |u| bsdf.sample(wo, Sampling::Bsdf, TransportMode::Radiance, u).into();
    let half = |wo: Vec3, wi: Vec3| (wo + wi).normalize();
    for wo in outgoing() {
        let b = rough(0.4);
        let pdf = |wi: Vec3| b.pdf(wo, wi, Sampling::Bsdf);
        wrong("density of h for that of ω_i", wo, &own(b, wo), &|wi| 4.0 * wo.dot(half(wo, wi)) * pdf(wi));
        wrong("dω_i = 4 dω_h", wo, &own(b, wo), &|wi| wo.dot(half(wo, wi)) * pdf(wi));
        wrong("α off by 10 %", wo, &own(b, wo), &|wi| rough(0.44).pdf(wo, wi, Sampling::Bsdf));
        let g = glass(Choice::Fresnel, Some(Ggx { alpha: 0.4, masking: Masking::Separable }), false).bsdf();
        let side = |wi: Vec3| if wi.z > 0.0 { 1.3 } else { 1.0 };
        wrong("reflection too likely", wo, &own(g, wo), &|wi| side(wi) * g.pdf(wo, wi, Sampling::Bsdf));
        // η² (ω_i·h)/(…)² without the η²
        let squeeze = |wi: Vec3| if wi.z > 0.0 { 1.0 } else { 1.0 / 2.25 };
        wrong("no η² in dh/dω_i", wo, &own(g, wo), &|wi| squeeze(wi) * g.pdf(wo, wi, Sampling::Bsdf));
        let p = plastic(surfaces::RHO, None).bsdf();
        wrong("choice left out", wo, &own(p, wo), &|wi| Sampling::Cosine.pdf(wi.z.max(0.0)));
    }
    let malley = |u: [f32; 3]| {
        let (r, phi) = (u[0], u[1] * std::f32::consts::TAU);
        Draw::Direction(Vec3::new(r * phi.cos(), r * phi.sin(), (1.0 - r * r).sqrt()))
    };
    wrong("Malley without the root", Vec3::Z, &malley, &|wi| Sampling::Cosine.pdf(wi.z.max(0.0)));
}

/// ∫ f |cos θ_i| dω_i without deltas, as well as `n` samples deserve.
fn quadrature(surface: &Surface, bsdf: &Bsdf, wo: Vec3, mode: TransportMode, n: usize) -> DVec3 {
    if !bsdf.connects() {
        return DVec3::ZERO;
    }
    let (mut noise, chart) = (Noise(7), Chart::about(wo));
    let mut pilot = vec![];
    for _ in 0..n / 4 {
        if let Draw::Direction(wi) = bsdf.sample(wo, Sampling::Bsdf, mode, three(&mut noise)).into() {
            pilot.push(chart.at(wi));
        }
    }
    let f = |z: f64, phi: f64| bsdf.eval(wo, chart.direction(z, phi), mode).as_dvec3() * z.abs();
    Cells::new(&mut pilot, PILOT, &surface.cuts(wo)).integrals(f, 2e-5).iter().sum()
}

/// What a delta part adds to the albedo.
fn delta(surface: &Surface, wo: Vec3, mode: TransportMode) -> DVec3 {
    let c = f64::from(wo.z);
    match &surface.description {
        BsdfDescription::Mirror(MirrorSurface { reflectance }) => *reflectance,
        BsdfDescription::Conductor(ConductorSurface { metal: Metal::Reflectance(r), rough: None }) => *r,
        BsdfDescription::Conductor(ConductorSurface { metal: Metal::Fresnel { eta, k }, rough: None }) => {
            DVec3::from_array(std::array::from_fn(|i| fresnel(c, eta[i], k[i])))
        }
        BsdfDescription::Dielectric(DielectricSurface { rough: None, .. }) => {
            let f = fresnel(c, surface.eta, 0.0);
            let squeezed = if mode == TransportMode::Radiance { surface.eta.powi(-2) } else { 1.0 };
            DVec3::splat(f + (1.0 - f) * squeezed)
        }
        BsdfDescription::Plastic(PlasticSurface { ior, rough: None, .. }) => DVec3::splat(fresnel(c, *ior, 0.0)),
        _ => DVec3::ZERO,
    }
}

/// E[f |cos θ_i|/p] = ∫ f |cos θ_i| dω_i, for light either way.
fn weights(account: &mut common::Account, n: u64) {
    let mut noise = Noise(account.seed());
    for surface in all() {
        let bsdf = surface.bsdf();
        let mode = if surface.eta == 1.0 { &BOTH[..1] } else { &BOTH };
        for ((i, wo), &mode) in outgoing().into_iter().enumerate().flat_map(|wo| mode.iter().map(move |c| (wo, c))) {
            let truth = quadrature(&surface, &bsdf, wo, mode, n as usize) + delta(&surface, wo, mode);
            for &sampling in surface.samplings(i) {
                let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
                for _ in 0..n {
                    if let Some(s) = bsdf.sample(wo, sampling, mode, three(&mut noise)) {
                        let w = s.weight.as_dvec3();
                        (sum, squares) = (sum + w, squares + w * w);
                    }
                }
                let mean = sum / n as f64;
                let variance = (squares / n as f64 - mean * mean).max(DVec3::ZERO);
                // what f32 and the quadrature leave
                let std_error = (variance / n as f64 + DVec3::splat(1e-10)).map(f64::sqrt);
                let what = format!("{sampling:?}, {mode:?}, {wo}, {surface:?}");
                let limit = if sampling == Sampling::Bsdf { 0.02 } else { 0.25 };
                assert!(std_error.max_element() < limit * truth.max_element(), "{what}: {std_error} of {truth}");
                account.assert_consistent(&what, &Estimate { mean, std_error, replicates: n, events: None }, truth);
            }
        }
    }
}

#[test]
fn weights_average_to_the_albedo() {
    weights(&mut common::open("weights_average_to_the_albedo"), 20_000);
}

#[test]
#[ignore = "minutes"]
fn a_million_weights_average_to_the_albedo() {
    weights(&mut common::open("a_million_weights_average_to_the_albedo"), 1_000_000);
}
