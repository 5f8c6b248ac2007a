//! Lights without a surface and surfaces that are not Lambertian, in whole scenes whose terms are known in closed form:
//! `tests/truth/direct.json` and `specular.json`, furnaces, bowls and single bodies under a sky.
//!
//! What the eye's walks find is judged from fixed points; what both ends or the light's walks find needs a camera, whose
//! truth is the closed form integrated over the image with two Gauss points per pixel and axis. Where a path has nothing to
//! choose but reflection or refraction, its samples are asserted to rounding and their numbers by the exact binomial.
#![allow(clippy::unwrap_used)]

#[path = "light_and_surface_truths/bodies.rs"]
mod bodies;
mod common;
#[path = "light_and_surface_truths/direct_light.rs"]
mod direct_light;
#[path = "light_and_surface_truths/glass_bodies.rs"]
mod glass_bodies;
#[path = "light_and_surface_truths/mirrors.rs"]
mod mirrors;

use common::judge::{Judged, Jury, at};
use common::sampling::{Start, Starts, collect, plan, point};
use common::scenes::{Surface, bands, description, quad, room, sphere};
use common::truth::case;
use common::{assert_rate, open};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::Key;
use fredholm::operator::SurfaceStrip;
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::progress::Progress;
use fredholm::scene::bsdf::{Bsdf, TransportMode, fresnel::hemispherical};
use fredholm::scene::description::{
    BsdfDescription, Choice, Colour, Description, Geometry, Ggx, LightDescription, Masking, Metal, Sides, Sky,
};
use fredholm::scene::description::{DielectricSurface, MirrorSurface};
use fredholm::scene::raster::Raster;
use fredholm::scene::{Scene, SurfaceSensor, Vertex};
use fredholm::terms::TermFilm;
use fredholm::terms::functional::image_replicates;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const K: usize = 4;

/// Which estimator, with which technique.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Prefix(Technique),
    Single(Technique),
    Path(Technique),
    Light,
    Bidirectional(Technique),
}

fn film<'s>(
    scene: &'s Scene,
    sensor: &impl Sensor<SceneTransport<'s>>,
    way: Way,
    last: usize,
    roulette: &Roulette,
    spp: u32,
    key: Key,
) -> TermFilm {
    let t = SceneTransport::new(scene);
    let amount = Amount { spp, replicates: 256, key };
    let with = |technique| Plan { max_bounces: last, technique, roulette: roulette.clone() };
    match way {
        Way::Prefix(technique) => render(&t, sensor, &Prefix(with(technique)), amount, Progress::NONE),
        Way::Single(technique) => render(&t, sensor, &SingleTerm(with(technique)), amount, Progress::NONE),
        Way::Path(technique) => render(&t, sensor, &PathTracer(with(technique)), amount, Progress::NONE),
        Way::Light => render(&t, sensor, &LightTracer(with(Technique::Mis)), amount, Progress::NONE),
        Way::Bidirectional(technique) => render(&t, sensor, &Bidirectional(with(technique)), amount, Progress::NONE),
    }
}

/// The mean over the image of what a closed form says of rays from the eye, term by term.
fn image_mean(d: &Description, truth: impl Fn(DVec3, DVec3) -> Vec<DVec3>) -> Vec<DVec3> {
    let c = &d.camera;
    let forward = (c.target - c.origin).normalize();
    let right = forward.cross(c.up).normalize();
    let up = right.cross(forward);
    let [w, h] = c.size;
    let pixel = 2.0 * (0.5 * c.fov).to_radians().tan() / f64::from(w);
    let nodes = |n: u32| (0..n).flat_map(|i| [-1.0, 1.0].map(|s| f64::from(i) + 0.5 + s * 0.5 / 3.0f64.sqrt()));
    let mut sum: Vec<DVec3> = vec![];
    for (x, y) in nodes(w).flat_map(|x| nodes(h).map(move |y| (x, y))) {
        let d = forward + right * (x - 0.5 * f64::from(w)) * pixel - up * (y - 0.5 * f64::from(h)) * pixel;
        let terms = truth(c.origin, d.normalize());
        sum.resize(terms.len(), DVec3::ZERO);
        sum.iter_mut().zip(terms).for_each(|(s, t)| *s += t / f64::from(4 * w * h));
    }
    sum
}

/// Judges the image means of terms 0..: 2 % is proved or half a term would have been seen; terms that are 0 must be 0.
fn check_image(jury: &mut Jury, name: &str, d: &Description, way: Way, spp: u32, truth: &[DVec3]) {
    // a particle finds the picture more rarely than a path finds the light
    let spp = if way == Way::Light { 8 * spp } else { spp };
    let scene = Scene::new(d);
    let key = Key::new(jury.seed(), &format!("{name} {way:?}"));
    let film = film(&scene, &scene.camera, way, K, &Roulette::Constant { from: K, q: 0.3 }, spp, key);
    assert_eq!(film.non_finite, 0, "{name} {way:?}");
    let image = image_replicates(&film);
    let whole: DVec3 = truth.iter().sum();
    if let Way::Path(_) = way {
        let judged =
            jury.judge(&format!("{name}, {way:?}, sum"), &image.estimate(0..1), whole, 0.02 * whole, 0.3 * whole);
        assert_ne!(judged, Judged::TooNoisy, "{name}, {way:?}");
        return;
    }
    for (k, &truth) in truth.iter().enumerate() {
        let (e, label) = (image.estimate(k..k + 1), format!("{name}, {way:?}, T{k}"));
        if truth == DVec3::ZERO {
            assert_eq!(e.mean, DVec3::ZERO, "{label}");
            continue;
        }
        let judged = jury.judge(&label, &e, truth, 0.02 * truth, 0.5 * truth + 0.01 * whole);
        assert_ne!(judged, Judged::TooNoisy, "{label}: {e:?}, truth {truth}");
    }
}

fn all_ways() -> Vec<Way> {
    let mut all: Vec<Way> = Technique::ALL.into_iter().map(Way::Prefix).collect();
    all.extend([Way::Single(Technique::Mis), Way::Path(Technique::Mis), Way::Light]);
    all.extend([Way::Bidirectional(Technique::Mis), Way::Bidirectional(Technique::Power)]);
    all
}

/// An image of the floor, with nothing else in sight.
fn over_the_floor(surfaces: &[Surface], lights: Vec<LightDescription>, rho: f64) -> Description {
    let floor = quad(DVec3::new(-1.5, 4.5, 0.0), DVec3::NEG_Y * 6.0, DVec3::X * 6.0);
    let mut all = vec![(floor, DVec3::splat(rho), DVec3::ZERO)];
    all.extend_from_slice(surfaces);
    let mut d = description(&all);
    (d.camera.origin, d.camera.target, d.camera.up) = (DVec3::new(3.0, 3.0, 1.5), DVec3::new(1.0, 1.0, 0.0), DVec3::Z);
    (d.camera.fov, d.lights) = (20.0, lights);
    d
}

/// T⁰ … T^K where only T¹ is not zero.
fn once(x: f64) -> Vec<DVec3> {
    let mut terms = vec![DVec3::ZERO; K + 2];
    terms[1] = DVec3::splat(x);
    terms
}

/// Where a ray meets z = 0.
fn on_floor(o: DVec3, d: DVec3) -> DVec3 {
    o - d * (o.z / d.z)
}

/// Lambert's formula: the form factor of a polygon from p with normal z, all of it above the horizon.
fn polygon(p: DVec3, corners: &[DVec3]) -> f64 {
    let v: Vec<DVec3> = corners.iter().map(|c| (c - p).normalize()).collect();
    let edge = |i: usize| {
        let (a, b) = (v[i], v[(i + 1) % v.len()]);
        a.dot(b).acos() * a.cross(b).normalize().z
    };
    ((0..v.len()).map(edge).sum::<f64>() / TAU).abs()
}

fn mirror(rho: f64) -> BsdfDescription {
    BsdfDescription::Mirror(MirrorSurface { reflectance: DVec3::splat(rho) })
}

fn glass(ior: f64, choice: Choice, rough: Option<Ggx>) -> BsdfDescription {
    BsdfDescription::Dielectric(DielectricSurface { ior, ior_outside: 1.0, choice, rough })
}

fn sky(radiance: f64) -> LightDescription {
    LightDescription::Environment { sky: Sky::Constant(DVec3::splat(radiance)), rotate: 0.0, scale: 1.0 }
}

/// These surfaces of one material, both sides, under a sky of 1.
fn under_the_sky(shapes: &[Geometry], bsdf: &BsdfDescription) -> Description {
    let surfaces: Vec<Surface> = shapes.iter().map(|g| (g.clone(), DVec3::ZERO, DVec3::ZERO)).collect();
    let mut d = description(&surfaces);
    d.materials.iter_mut().for_each(|m| (m.bsdf, m.sides) = (bsdf.clone(), Sides::Both));
    d.lights = vec![sky(1.0)];
    d
}

/// A vertex on the top, z = 0 or the pole of the unit sphere below it, asked at this angle.
fn tilted(scene: &Scene, degrees: f64) -> Vertex {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let d = DVec3::new(-sin, 0.0, -cos);
    scene.trace((-2.0 * d - scene.origin()).as_vec3(), d.as_vec3()).unwrap()
}
