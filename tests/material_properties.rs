//! What holds in every scene, tried on random ones with every material and every light.
//!
//! The strongest is [`weights_are_those_of_the_path`]: a path z_0 … z_k has one contribution F and, for each way s to find
//! it, one density p_s. Both are written down here once more, in `f64`, from positions and BSDFs alone. Whatever the
//! bidirectional estimator finds must have `value · p_s = F` and `weight = p_s / Σ p_r`. The right-hand sides do not know
//! which way found the path, so the weights of all ways sum to 1, both ends agree on F (reciprocity, with the η² of
//! refraction), and a walk's densities are those of the pair of states.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::judge::Jury;
use common::ledger;
use common::random::{cases, draw, glass, items, opaque, schedule, world};
use common::sampling::{Start, Starts, collect, plan};
use common::scenes::{description, quad, room, sphere};
use fredholm::estimator::densities::{Node, PathDensities, walk};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::direction::Frame;
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::scene_transport::SurfaceStrip;
use fredholm::operator::{Adjoint, Role, SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::bsdf::{Bsdf, Sampling, TransportMode};
use fredholm::scene::description::{BsdfDescription, Description, Geometry, LightDescription, Shape, Sides};
use fredholm::scene::description::{ConductorSurface, DielectricSurface, DiffuseSurface, MirrorSurface};
use fredholm::scene::emitter::environment::Environment;
use fredholm::scene::{ESCAPED, LIGHT, Primitive, Scene, SurfaceSensor, Vertex};
use fredholm::stats::critical;
use fredholm::terms::functional::{Replicates, image_replicates};
use fredholm::terms::{Estimate, TermFilm};
use glam::{DQuat, DVec3, Vec3};
use proptest::prelude::*;
use std::f64::consts::PI;

const K: usize = 4;

/// Which estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Single,
    Prefix,
    Path,
    Light,
    Bidirectional,
}

fn film<'s>(
    scene: &'s Scene,
    sensor: &impl Sensor<SceneTransport<'s>>,
    kind: Kind,
    plan: &Plan,
    (spp, replicates): (u32, usize),
    key: Key,
) -> TermFilm {
    let (t, plan) = (SceneTransport::new(scene), plan.clone());
    let amount = Amount { spp, replicates, key };
    match kind {
        Kind::Single => render(&t, sensor, &SingleTerm(plan), amount, Progress::NONE),
        Kind::Prefix => render(&t, sensor, &Prefix(plan), amount, Progress::NONE),
        Kind::Path => render(&t, sensor, &PathTracer(plan), amount, Progress::NONE),
        Kind::Light => render(&t, sensor, &LightTracer(plan), amount, Progress::NONE),
        Kind::Bidirectional => render(&t, sensor, &Bidirectional(plan), amount, Progress::NONE),
    }
}

/// What each estimator is tried with: every technique where it matters.
fn ways() -> Vec<(Kind, Technique)> {
    let mut all = vec![(Kind::Light, Technique::Mis), (Kind::Bidirectional, Technique::Mis)];
    all.push((Kind::Bidirectional, Technique::Power));
    for technique in Technique::ALL {
        all.extend([(Kind::Prefix, technique), (Kind::Single, technique), (Kind::Path, technique)]);
    }
    all
}

fn bits(film: &TermFilm) -> Vec<u64> {
    let s = film.shape;
    let all = (0..s.pixels()).flat_map(|p| (0..s.replicates).flat_map(move |r| (0..s.slots).map(move |k| (p, r, k))));
    all.flat_map(|(p, r, k)| film.sum(p, r, k).to_array()).map(f64::to_bits).collect()
}

// ------------------------------------------------------------------------------------------------ one path, every way

/// A path and its scene, for the plain formulas: positions, unit normals (either side), where it is.
struct Reference<'a> {
    scene: &'a Scene,
    description: &'a Description,
    /// The sky alone.
    sky: Option<Environment>,
    /// Radius of what parallel light must cover.
    radius: f64,
    lights: f64,
}

impl<'a> Reference<'a> {
    fn new(scene: &'a Scene, description: &'a Description) -> Self {
        let bounds = description.primitives().into_iter().map(|(_, p)| p.bounds());
        let [low, high] = bounds.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let sky = description.lights.iter().find_map(|l| match l {
            LightDescription::Environment { sky, rotate, scale } => Some(Environment::new(sky, *rotate, *scale)),
            _ => None,
        });
        let lights = description.lights.len() + description.shapes.iter().filter(|s| s.emission != DVec3::ZERO).count();
        Self { scene, description, sky, radius: 0.5 * (high - low).length(), lights: lights as f64 }
    }

    /// Whether light from there is parallel.
    fn parallel(&self, v: &Vertex) -> bool {
        v.side == ESCAPED
            || v.side >= LIGHT && {
                let without_surface = (v.side - LIGHT) as usize + self.description.lights.len() - self.lights as usize;
                matches!(self.description.lights[without_surface], LightDescription::Directional { .. })
            }
    }

    fn direction(&self, from: &Vertex, to: &Vertex) -> DVec3 {
        if self.parallel(to) { -to.omega.as_dvec3() } else { (to.p.as_dvec3() - from.p.as_dvec3()).normalize() }
    }

    /// dω/dμ(to): |cos|/r² of a surface, 1 of the sky, 0 of what no ray hits.
    fn angle(&self, from: &Vertex, to: &Vertex) -> f64 {
        match to.side {
            ESCAPED => 1.0,
            side if side < LIGHT => self.cosine(to, self.direction(from, to)) / self.r2(from, to),
            _ => 0.0,
        }
    }

    fn r2(&self, a: &Vertex, b: &Vertex) -> f64 {
        (b.p.as_dvec3() - a.p.as_dvec3()).length_squared()
    }

    fn cosine(&self, v: &Vertex, d: DVec3) -> f64 {
        v.n.as_dvec3().dot(d).abs()
    }

    /// The BSDF on the side of `before`, and the local directions.
    fn local(&self, before: DVec3, at: &Vertex, after: DVec3) -> (Bsdf, Vec3, Vec3) {
        let flip = at.n.as_dvec3().dot(before) < 0.0;
        let seen = if flip { Vertex { n: -at.n, side: at.side ^ 1, ..*at } } else { *at };
        let frame = Frame::new(seen.n);
        (self.scene.bsdf(&seen), frame.local(before.as_vec3()), frame.local(after.as_vec3()))
    }

    /// Scattering at `at` from the direction `wo` to `wi`: f |cos|, and its density in solid angle. A delta part stands for
    /// its factor of the delta function of n² times projected solid angle, which is the same from both ends.
    fn scatter(&self, wo: DVec3, at: &Vertex, wi: DVec3, delta: bool) -> (DVec3, f64) {
        let (bsdf, o, i) = self.local(wo, at, wi);
        if !delta {
            let f = bsdf.eval(o, i, TransportMode::Radiance).as_dvec3() * f64::from(i.z.abs());
            return (f, f64::from(bsdf.pdf(o, i, Sampling::Bsdf)));
        }
        let draws = [0.0, 1.0 - f32::EPSILON / 2.0]
            .map(|u| bsdf.sample(o, Sampling::Bsdf, TransportMode::Radiance, [0.5, 0.5, u]));
        let s = draws.into_iter().flatten().find(|s| s.delta && (s.wi.z > 0.0) == (i.z > 0.0)).unwrap();
        let relative = match bsdf {
            Bsdf::Dielectric(fredholm::scene::bsdf::dielectric::Dielectric::Smooth(d)) if i.z < 0.0 => {
                f64::from(d.interface.eta)
            }
            _ => 1.0,
        };
        let density = f64::from(s.pdf) * self.cosine(at, wi) * relative;
        (s.weight.as_dvec3() * density, density)
    }

    /// Density with which light starts at z.
    fn emit(&self, z: &Vertex) -> f64 {
        match z.side {
            ESCAPED => self.sky.as_ref().map_or(0.0, |s| f64::from(s.pdf(-z.omega))) / self.lights,
            side if side >= LIGHT => 1.0 / self.lights,
            side => {
                let (shape, _) = self.description.primitives()[(side / 2) as usize];
                let mine = self.description.primitives().into_iter().filter(|(s, _)| *s == shape);
                let area: f64 = mine.map(|(_, p)| p.area()).sum();
                let shines = side & 1 == 0 && self.description.shapes[shape].emission != DVec3::ZERO;
                if shines { 1.0 / (area * self.lights) } else { 0.0 }
            }
        }
    }

    /// Density with which next-event estimation at x chooses z.
    fn connect(&self, x: &Vertex, z: &Vertex) -> f64 {
        if z.side < LIGHT && self.emit(z) > 0.0 {
            let (shape, primitive) = self.description.primitives()[(z.side / 2) as usize];
            let whole = matches!(self.description.shapes[shape].geometry, Geometry::Sphere { inward: false, .. });
            if let (Primitive::Sphere { center, radius, z: [-1.0, 1.0], .. }, true) = (primitive, whole) {
                let sin2 = radius * radius / (center - x.p.as_dvec3()).length_squared();
                if sin2 < 1.0 {
                    let one_minus_cos = sin2 / (1.0 + (1.0 - sin2).sqrt());
                    return self.angle(x, z) / (2.0 * PI * one_minus_cos * self.lights);
                }
            }
        }
        self.emit(z)
    }

    /// Emission with its cosine, and the density of light that starts at z going to x, in the measure of x.
    fn shine(&self, z: &Vertex, x: &Vertex) -> (DVec3, f64) {
        let to = if self.parallel(z) { z.omega.as_dvec3() } else { self.direction(z, x) };
        let light = self.scene.light(z).as_dvec3();
        if z.side < LIGHT {
            let cos = z.n.as_dvec3().dot(to).max(0.0);
            return (light * cos, cos / PI * self.angle(z, x));
        }
        let arrives = self.cosine(x, to);
        let density = if self.parallel(z) {
            arrives / (PI * self.radius * self.radius)
        } else {
            arrives / (4.0 * PI * self.r2(z, x))
        };
        (light, density)
    }

    /// F and p_0 … p_{k+1}; None where a cosine or a distance is so small that `f32` has lost it.
    fn path(&self, z: &[Vertex], delta: &[bool]) -> Option<(DVec3, Vec<f64>)> {
        let k = z.len() - 1;
        let c = &self.description.camera;
        let eye = Vertex { p: c.origin.as_vec3(), ..Vertex::default() };
        let after = |i: usize| self.direction(&z[i], &z[i + 1]);
        let before = |i: usize| if i == 0 { self.direction(&z[0], &eye) } else { self.direction(&z[i], &z[i - 1]) };
        let conditioned = |i: usize| {
            let cosines = i == k || self.cosine(&z[i], after(i)) > 0.03 && self.cosine(&z[i], before(i)) > 0.03;
            let light = i < k || z[i].side >= LIGHT || self.cosine(&z[i], before(i)) > 0.03;
            let close = i == 0 || self.parallel(&z[i]) || self.r2(&z[i - 1], &z[i]) > 0.01;
            cosines && light && close
        };
        if !(0..=k).all(conditioned) {
            return None;
        }
        // the camera: uniform in the plane of the image
        let seen = if self.parallel(&z[0]) { -z[0].omega.as_dvec3() } else { self.direction(&eye, &z[0]) };
        let pixel = 2.0 * (0.5 * c.fov).to_radians().tan() / f64::from(c.size[0]);
        let cos = seen.dot((c.target - c.origin).normalize());
        let share = 1.0 / f64::from(c.size[0] * c.size[1]);
        let from_camera = share / (pixel * pixel * cos.powi(3)) * self.angle(&eye, &z[0]);

        // both directions of every step
        let (mut from_eye, mut from_light) = (vec![from_camera], vec![0.0; k + 1]);
        let mut f = DVec3::splat(from_camera);
        for i in 0..k {
            let (value, density) = self.scatter(before(i), &z[i], after(i), delta[i]);
            from_eye.push(density * self.angle(&z[i], &z[i + 1]));
            // a point is reached by 1/r², a direction by 1
            let reached = match z[i + 1].side {
                side if side >= LIGHT && self.parallel(&z[i + 1]) => 1.0,
                side if side >= LIGHT => 1.0 / self.r2(&z[i], &z[i + 1]),
                _ => self.angle(&z[i], &z[i + 1]),
            };
            f *= value * reached;
            if i > 0 {
                let (_, density) = self.scatter(after(i), &z[i], before(i), delta[i]);
                from_light[i - 1] = density * self.angle(&z[i], &z[i - 1]);
            }
        }
        f *= self.scene.light(&z[k]).as_dvec3();
        from_light[k] = self.emit(&z[k]);
        if k > 0 {
            from_light[k - 1] = self.shine(&z[k], &z[k - 1]).1;
        }
        let density = |s: usize| {
            let t = k + 1 - s;
            if s > 0 && (delta[t] || t > 0 && delta[t - 1]) {
                return 0.0;
            }
            let light: f64 =
                if s == 1 && t > 0 { self.connect(&z[k - 1], &z[k]) } else { from_light[t..].iter().product() };
            from_eye[..t].iter().product::<f64>() * light
        };
        Some((f, (0..=k + 1).map(density).collect()))
    }
}

/// A path that was found: its way, states, delta vertices, value, densities and weight.
struct Find {
    s: usize,
    path: Vec<Vertex>,
    delta: Vec<bool>,
    value: Rgb,
    weight: f32,
    densities: PathDensities,
}

/// The stream that light is followed with, as the estimators have it.
const LIGHT_STREAM: u32 = 0x4c49_4748;

/// Everything one pair of walks finds, with the paths themselves: the loops of `Bidirectional::find` once more.
fn finds(t: &SceneTransport, key: Key, pixel: u32, sample: u32, last: usize) -> Vec<Find> {
    let sensor = &t.scene.camera;
    let share = 1.0 / (sensor.size[0] * sensor.size[1]) as f32;
    let numbers = |key: Key| move |v: usize, purpose: Purpose| Rng::at(key, pixel, sample, v, purpose);
    let (eye_numbers, light_numbers) = (numbers(key), numbers(key.branch(LIGHT_STREAM)));
    let (mut eye, mut light) = (vec![], vec![]);
    if let Some(start) = sensor.start(t, pixel, &mut eye_numbers(0, Purpose::Start)) {
        eye.push(Node::new(start, Rgb::ONE, sensor.density(t, &start) * share));
        walk(t, &mut eye, last, Role::Radiance, |v| eye_numbers(v, Purpose::Scatter), |_| ());
    }
    if let Some((start, density)) = t.emit(&mut light_numbers(0, Purpose::Start)) {
        light.push(Node::new(start, Rgb::splat(1.0 / density), density));
        walk(t, &mut light, last, Role::Emission, |v| light_numbers(v, Purpose::Scatter), |_| ());
    }
    let mut all = vec![];
    let mut find = |eye: &[Node<Vertex>], light: &[Node<Vertex>], seen: Option<(Vertex, f32)>, value: Rgb| {
        let nodes = || eye.iter().chain(light.iter().rev());
        let mut delta: Vec<bool> = nodes().map(|n| n.delta.is_some()).collect();
        // the vertices that are linked scatter by what is no delta part
        let t_ = eye.len();
        [t_.checked_sub(1), (t_ < delta.len()).then_some(t_)].into_iter().flatten().for_each(|i| delta[i] = false);
        let densities = PathDensities::new(t, eye, light, seen);
        let weight = densities.weight(false);
        all.push(Find { s: light.len(), path: nodes().map(|n| n.state).collect(), delta, value, weight, densities });
    };
    for (k, x) in eye.iter().enumerate() {
        let e = t.emission(&x.state);
        if e != Rgb::ZERO {
            find(&eye[..=k], &[], None, x.throughput * e);
        }
    }
    for (v, x) in eye.iter().take(last).enumerate() {
        if let Some(c) = t.connect(&x.state, &mut eye_numbers(v, Purpose::Connect)) {
            let y = Node::new(c.state, Rgb::ONE, t.emit_density(&c.state));
            find(&eye[..=v], &[y], None, x.throughput * c.weight * t.emission(&c.state));
        }
    }
    for (i, x) in eye.iter().enumerate() {
        for (j, y) in light.iter().enumerate().skip(1).take(last.saturating_sub(i + 1)) {
            let here = t.toward(&x.state, &y.state, Role::Radiance).value;
            let value = x.throughput * here * t.toward(&y.state, &x.state, Role::Flux).value * y.throughput;
            let link = if value == Rgb::ZERO { 0.0 } else { t.link(&x.state, &y.state) };
            if link > 0.0 {
                find(&eye[..=i], &light[..=j], None, value * link);
            }
        }
    }
    for (k, y) in light.iter().enumerate() {
        let Some(seen) = sensor.project(t, &y.state) else { continue };
        let role = if k == 0 { Role::Emission } else { Role::Flux };
        let value = y.throughput * t.toward(&y.state, &seen.eye, role).value * seen.importance;
        if value != Rgb::ZERO && sensor.sees(t, &y.state) {
            find(&[], &light[..=k], Some((seen.eye, seen.density * share)), value * share);
        }
    }
    all
}

/// How many paths of each kind were compared, and the errors.
#[derive(Default)]
struct Compared {
    errors: Vec<f64>,
    ways: [usize; 7],
    delta: usize,
    refracted: usize,
    sky: usize,
    point: usize,
    beam: usize,
}

fn compare_paths(d: &Description, seed: u64, samples: u32, seen: &mut Compared) {
    const LAST: usize = 5;
    let scene = Scene::new(d);
    let t = SceneTransport::new(&scene);
    let centred = d.centred().scene;
    let reference = Reference::new(&scene, &centred);
    let (key, pixels) = (Key::new(seed, "paths"), scene.camera.size[0] * scene.camera.size[1]);
    let bidirectional = Bidirectional(plan(LAST, Technique::Mis, &Roulette::Never));
    for (pixel, sample) in (0..pixels).flat_map(|p| (0..samples).map(move |s| (p, s))) {
        let finds = finds(&t, key, pixel, sample, LAST);
        // the estimator finds just these
        let mut theirs = vec![];
        bidirectional.find(
            &t,
            &scene.camera,
            (key, pixel, sample),
            |f| theirs.push((f.s, f.k, f.value, f.weight)),
            |_| (),
        );
        theirs.retain(|f| f.2 != Rgb::ZERO);
        let ours = finds.iter().filter(|f| f.value != Rgb::ZERO);
        let ours: Vec<_> = ours.map(|f| (f.s, f.path.len() - 1, f.value, f.weight)).collect();
        assert!(ours.iter().all(|f| f.2.is_finite() && f.3.is_finite()), "scene {seed}: {ours:?}");
        assert_eq!(ours, theirs);

        for f in finds.iter().filter(|f| f.value.min_element() > 1e-20) {
            let Some((contribution, densities)) = reference.path(&f.path, &f.delta) else { continue };
            let material = |v: &Vertex| match v.side {
                side if side < LIGHT => {
                    format!("{:?}", d.materials[d.shapes[d.primitives()[(side / 2) as usize].0].material].bsdf)
                }
                _ => "light".into(),
            };
            let path =
                || f.path.iter().zip(&f.delta).map(|(v, delta)| format!("  {v:?} delta {delta} {}", material(v)));
            let what = || format!("s = {}, scene {seed}\n{}", f.s, path().collect::<Vec<_>>().join("\n"));
            let (sum, mine) = (densities.iter().sum::<f64>(), densities[f.s]);
            assert!(mine > 0.0, "found where it cannot be: {densities:?} {}", what());
            let total = mine / sum;
            let weight_error = (f64::from(f.weight) - total).abs();
            let value_error = (f.value.as_dvec3() * mine / contribution - 1.0).abs().max_element();
            let density_error = (0..densities.len()).map(|r| {
                let q = f.densities.density(r);
                // what never matters may be lost
                if densities[r].max(q) < 1e-6 * sum { 0.0 } else { (q / densities[r] - 1.0).abs() }
            });
            let error = density_error.fold(weight_error.max(value_error), f64::max);
            assert!(
                error < 0.1,
                "weight {} for {total}, value·p/F {}, densities {densities:?} against {:?}, {}",
                f.weight,
                f.value.as_dvec3() * mine / contribution,
                (0..densities.len()).map(|r| f.densities.density(r)).collect::<Vec<_>>(),
                what()
            );
            seen.errors.push(error);
            seen.ways[f.s] += 1;
            let inner = || (1..f.path.len() - 1).filter(|&i| f.delta[i]);
            seen.delta += usize::from(inner().count() > 0);
            let crosses = |i: usize| {
                let n = f.path[i].n.as_dvec3();
                let [a, b] = [i - 1, i + 1].map(|j| n.dot(reference.direction(&f.path[i], &f.path[j])));
                a * b < 0.0
            };
            seen.refracted += usize::from((1..f.path.len().max(2) - 1).any(crosses));
            let z = f.path.last().unwrap();
            seen.sky += usize::from(z.side == ESCAPED);
            seen.beam += usize::from(z.side != ESCAPED && reference.parallel(z));
            seen.point += usize::from(z.side != ESCAPED && z.side >= LIGHT && !reference.parallel(z));
        }
    }
}

#[test]
fn weights_are_those_of_the_path() {
    let mut seen = Compared::default();
    for (i, mut d) in draw(world(), 160).enumerate() {
        d.camera.size = [4, 3];
        compare_paths(&d, i as u64, 12, &mut seen);
    }
    seen.errors.sort_by(f64::total_cmp);
    let at = |q: f64| seen.errors[(q * (seen.errors.len() - 1) as f64) as usize];
    eprintln!(
        "{} paths, ways {:?}, {} with delta vertices, {} refracted, {} from the sky, {} from a point, {} from a direction; \
         errors: median {:.1e}, 99 % {:.1e}, largest {:.1e}",
        seen.errors.len(),
        seen.ways,
        seen.delta,
        seen.refracted,
        seen.sky,
        seen.point,
        seen.beam,
        at(0.5),
        at(0.99),
        at(1.0)
    );
    assert!(at(0.5) < 5e-5 && at(0.99) < 2e-3);
    assert!(seen.ways.iter().all(|&n| n > 300));
    for n in [seen.delta, seen.refracted, seen.sky, seen.point, seen.beam] {
        assert!(n > 300);
    }
}

// ------------------------------------------------------------------------------------------------ any scene at all

const AMOUNT: (u32, usize) = (8, 8);

fn small(mut d: Description) -> Description {
    d.camera.size = [6, 4];
    d
}

proptest! {
    #![proptest_config(cases(160))]

    #[test]
    fn every_sample_is_finite_and_none_negative(d in world()) {
        let d = small(d);
        let scene = Scene::new(&d);
        for (kind, technique) in ways() {
            let plan = plan(K, technique, &Roulette::LECTURE);
            let film = film(&scene, &scene.camera, kind, &plan, AMOUNT, Key::new(1, "finite"));
            prop_assert_eq!(film.non_finite, 0, "{:?} {}", kind, technique);
            for p in 0..film.shape.pixels() {
                for slot in 0..film.shape.slots {
                    let (mean, _) = film.pixel(p, slot..slot + 1);
                    prop_assert!(mean.is_finite() && mean.min_element() >= 0.0, "{:?} {}: {}", kind, technique, mean);
                }
            }
        }
        // and from everywhere, where that sensor is known
        let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 };
        for technique in Technique::ALL {
            let plan = plan(K, technique, &Roulette::LECTURE);
            prop_assert_eq!(film(&scene, &strip, Kind::Prefix, &plan, AMOUNT, Key::new(2, "finite")).non_finite, 0);
        }
    }

    /// Σ X_k + tail is the path tracer's sample.
    #[test]
    fn terms_and_tail_are_the_path_tracer_in_any_scene(d in world(), roulette in schedule()) {
        let d = small(d);
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let key = Key::new(3, "identity");
        // white surfaces must not keep a path for ever
        let ends = match roulette {
            Roulette::Albedo { from } | Roulette::Throughput { from } => Roulette::Constant { from, q: 0.4 },
            other => other,
        };
        for technique in Technique::ALL {
            let plan = plan(2, technique, &ends);
            let terms = collect(&t, &scene.camera, &Prefix(plan.clone()), 8, 8, key);
            let paths = collect(&t, &scene.camera, &PathTracer(plan), 8, 8, key);
            for (terms, path) in terms.paths().zip(paths.paths()) {
                let sum: DVec3 = terms.iter().sum();
                let scale = 2e-5 * path[0].abs().max(DVec3::splat(1e-6));
                prop_assert!((sum - path[0]).abs().cmple(scale).all(), "{}, {}: {} {}", technique, ends, sum, path[0]);
            }
        }
    }

    /// Lengths times s, intensities of points times s²: s a power of two, so not one bit changes.
    #[test]
    fn a_scaled_scene_has_the_same_bits(d in world()) {
        let d = small(d);
        let (one, eight) = (Scene::new(&d), Scene::new(&scaled(&d, 8.0)));
        let quarter = Scene::new(&scaled(&d, 0.25));
        for (kind, technique) in ways() {
            let plan = plan(3, technique, &Roulette::LECTURE);
            let of = |scene: &Scene| bits(&film(scene, &scene.camera, kind, &plan, (4, 4), Key::new(4, "scale")));
            let bits = of(&one);
            prop_assert!(of(&eight) == bits && of(&quarter) == bits, "{:?} {}", kind, technique);
        }
    }

    /// Batched and one by one, in waves of any size.
    #[test]
    fn waves_have_the_bits_of_single_paths(d in world()) {
        let d = small(d);
        let (packets, single) = (Scene::new(&d), Scene::new(&d).one_by_one());
        for (kind, technique) in ways() {
            let plan = plan(3, technique, &Roulette::LECTURE);
            let of = |scene: &Scene| bits(&film(scene, &scene.camera, kind, &plan, (4, 4), Key::new(5, "waves")));
            prop_assert!(of(&packets) == of(&single), "{:?} {}", kind, technique);
        }
        let t = SceneTransport::new(&packets);
        for technique in Technique::ALL {
            let estimator = Prefix(plan(3, technique, &Roulette::LECTURE));
            let of = |wave| collect(&t, &packets.camera, &estimator, 8, wave, Key::new(6, "waves")).values;
            prop_assert!(of(8) == of(1), "{}", technique);
        }
    }

    /// A particle among surfaces that lose nothing keeps its power: E π A/P, 4π I/P, step by step.
    #[test]
    fn a_particle_keeps_its_power(things in prop::collection::vec(lossless(), 1..5), items in items(), point in any::<bool>()) {
        let mut d = common::random::furnished(DVec3::ONE, &items);
        for (m, bsdf) in d.materials.iter_mut().zip(things.iter().cycle()) {
            (m.bsdf, m.sides) = (bsdf.clone(), Sides::Both);
        }
        if point {
            d.shapes.iter_mut().for_each(|s| s.emission = DVec3::ZERO);
            d.lights = vec![LightDescription::Point { position: DVec3::new(0.7, 0.8, -0.9), intensity: DVec3::new(1.0, 2.0, 3.0) }];
        }
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let powers: Vec<DVec3> = match point {
            true => vec![4.0 * PI * DVec3::new(1.0, 2.0, 3.0)],
            false => {
                let area = |i: usize| d.primitives().iter().filter(|(s, _)| *s == i).map(|(_, p)| p.area()).sum::<f64>();
                let glow = (0..d.shapes.len()).filter(|&i| d.shapes[i].emission != DVec3::ZERO);
                glow.map(|i| PI * area(i) * d.shapes[i].emission).collect()
            }
        };
        for sample in 0..64 {
            let rng = |v: usize, purpose| Rng::at(Key::new(7, "power"), 0, sample, v, purpose);
            let (mut y, density) = t.emit(&mut rng(0, Purpose::Start)).unwrap();
            let (mut through, mut role) = (1.0 / f64::from(density) * DVec3::ONE, Role::Emission);
            for v in 0..12 {
                let Some(step) = t.walk(&y, role, &mut rng(v, Purpose::Scatter)) else { break };
                through *= step.weight.as_dvec3();
                (y, role) = (step.state, Role::Flux);
                let kept = powers.iter().any(|p| (through / (p * powers.len() as f64) - 1.0).abs().max_element() < 1e-4);
                prop_assert!(kept, "{} after {} steps, powers {:?}", through, v + 1, powers);
            }
        }
    }
}

/// What loses nothing whatever happens: weights are exactly 1.
fn lossless() -> impl Strategy<Value = BsdfDescription> {
    use fredholm::scene::description::{Choice, Colour, Metal};
    prop_oneof![
        Just(BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(DVec3::ONE) })),
        Just(BsdfDescription::Mirror(MirrorSurface { reflectance: DVec3::ONE })),
        Just(BsdfDescription::Conductor(ConductorSurface { metal: Metal::Reflectance(DVec3::ONE), rough: None })),
        (1.1..2.5f64).prop_map(|ior| BsdfDescription::Dielectric(DielectricSurface {
            ior,
            ior_outside: 1.0,
            choice: Choice::Fresnel,
            rough: None
        })),
    ]
}

/// All lengths times s.
fn scaled(d: &Description, s: f64) -> Description {
    transformed(d, DQuat::IDENTITY, s, true)
}

/// Turned about the origin and scaled by s. Kept whole where the turn allows it, else taken apart into primitives.
fn transformed(d: &Description, turn: DQuat, s: f64, whole: bool) -> Description {
    let mut all = d.clone();
    let map = |p: DVec3| turn * p * s;
    (all.camera.origin, all.camera.target) = (map(d.camera.origin), map(d.camera.target));
    all.camera.up = turn * d.camera.up;
    for light in &mut all.lights {
        match light {
            LightDescription::Point { position, intensity } => {
                (*position, *intensity) = (map(*position), *intensity * s * s)
            }
            LightDescription::Directional { direction, .. } => *direction = turn * *direction,
            LightDescription::Environment { .. } => {}
        }
    }
    if whole {
        for shape in &mut all.shapes {
            match &mut shape.geometry {
                Geometry::Mesh { vertices, .. } => vertices.iter_mut().for_each(|v| *v *= s),
                Geometry::Quad { origin, edge_u, edge_v } => [origin, edge_u, edge_v].into_iter().for_each(|v| *v *= s),
                Geometry::Box { min, max, .. } => [min, max].into_iter().for_each(|v| *v *= s),
                Geometry::Sphere { center, radius, .. } | Geometry::Disk { center, radius, .. } => {
                    *center *= s;
                    *radius *= s;
                }
            }
        }
        return all;
    }
    all.shapes.clear();
    for (shape, primitive) in d.primitives() {
        let geometry = match primitive {
            Primitive::Triangle(p) => {
                Geometry::Mesh { vertices: p.map(map).to_vec(), faces: vec![[0, 1, 2]], uvs: vec![] }
            }
            Primitive::Parallelogram { origin, edge_u, edge_v } => {
                Geometry::Quad { origin: map(origin), edge_u: map(edge_u), edge_v: map(edge_v) }
            }
            Primitive::Sphere { center, radius, z, inward } => {
                Geometry::Sphere { center: map(center), radius: radius * s, z, inward }
            }
            Primitive::Disk { center, normal, radius } => {
                Geometry::Disk { center: map(center), normal: turn * normal, radius: radius * s }
            }
        };
        all.shapes.push(Shape { geometry, ..d.shapes[shape].clone() });
    }
    all
}

// ------------------------------------------------------------------------------------------------ means

fn difference(a: &Estimate, b: &Estimate) -> Estimate {
    let std_error = (a.std_error * a.std_error + b.std_error * b.std_error).map(f64::sqrt);
    Estimate { mean: a.mean - b.mean, std_error, replicates: a.replicates, events: None }
}

/// Judges the slots of two images of what should be one.
fn same(jury: &mut Jury, what: &str, a: &Replicates, b: &Replicates) {
    let whole = a.estimate(0..K + 2).mean;
    for k in 0..K + 2 {
        let (a, b) = (a.estimate(k..k + 1), b.estimate(k..k + 1));
        // the larger, so that what one of them has not seen at all is not taken for nothing
        let size = a.mean.max(b.mean);
        let delta = 0.02 * size + 0.01 * whole;
        jury.judge(&format!("{what}, slot {k}"), &difference(&a, &b), DVec3::ZERO, delta, 0.3 * size + 0.03 * whole);
    }
}

/// Whether an estimator sees all there is; a path from a light without area through glass or a mirror it might not.
fn sees_all(scene: &Scene, kind: Kind, technique: Technique) -> bool {
    let (point, delta) = (scene.lights.any_delta(), scene.any_delta_surface());
    match kind {
        Kind::Light => !delta,
        _ => !point || !delta && (technique != Technique::Scatter || kind == Kind::Bidirectional),
    }
}

const WAYS: [(Kind, Technique, u32); 5] = [
    (Kind::Prefix, Technique::Mis, 512),
    (Kind::Path, Technique::Mis, 512),
    (Kind::Single, Technique::Power, 256),
    (Kind::Light, Technique::Mis, 512),
    (Kind::Bidirectional, Technique::Mis, 256),
];

#[test]
fn all_estimators_agree_in_any_scene() {
    let mut jury = Jury::open("all_estimators_agree_in_any_scene");
    for (i, d) in draw(world(), 24).enumerate() {
        let d = small(d);
        let scene = Scene::new(&d);
        let images: Vec<_> = WAYS
            .into_iter()
            .filter(|w| sees_all(&scene, w.0, w.1))
            .map(|(kind, technique, spp)| {
                let key = Key::new(jury.seed(), &format!("{kind:?}")).branch(i as u32);
                let plan = plan(K, technique, &Roulette::Constant { from: K, q: 0.3 });
                (kind, image_replicates(&film(&scene, &scene.camera, kind, &plan, (spp, 256), key)))
            })
            .collect();
        let Some((_, first)) = images.first() else { continue };
        for (kind, image) in &images[1..] {
            if *kind == Kind::Path {
                let (a, b) = (first.estimate(0..K + 2), image.estimate(0..1));
                let size = a.mean.max(b.mean);
                jury.judge(&format!("scene {i}, path"), &difference(&a, &b), DVec3::ZERO, 0.02 * size, 0.3 * size);
            } else {
                same(&mut jury, &format!("scene {i}, {kind:?}"), first, image);
            }
        }
    }
    jury.assert_power(0.2, 0.4);
}

#[test]
fn means_do_not_depend_on_the_axes() {
    let mut jury = Jury::open("means_do_not_depend_on_the_axes");
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.3, -2.0);
    let upright = |d: &Description| {
        let image = |l: &LightDescription| {
            matches!(l, LightDescription::Environment { sky: fredholm::scene::description::Sky::LatLong(_), .. })
        };
        !d.lights.iter().any(image)
    };
    for (i, d) in draw(world(), 24).enumerate().filter(|(_, d)| upright(d)).take(10) {
        let d = small(d);
        // the same primitives in both, so that lights are as many
        let scenes = [DQuat::IDENTITY, turn].map(|turn| Scene::new(&transformed(&d, turn, 1.7, false)));
        for (kind, technique, spp) in [
            (Kind::Prefix, Technique::Mis, 512),
            (Kind::Light, Technique::Mis, 256),
            (Kind::Bidirectional, Technique::Mis, 256),
        ] {
            let [a, b] = [0, 1].map(|j: usize| {
                let key = Key::new(jury.seed(), &format!("{kind:?} {j}")).branch(i as u32);
                let plan = plan(K, technique, &Roulette::Constant { from: K, q: 0.3 });
                image_replicates(&film(&scenes[j], &scenes[j].camera, kind, &plan, (spp, 256), key))
            });
            same(&mut jury, &format!("scene {i}, {kind:?}"), &a, &b);
        }
    }
    jury.assert_power(0.2, 0.4);
}

/// ‖T‖₁ ≤ the largest albedo, for surfaces that let nothing through.
#[test]
fn no_material_gains_energy() {
    let mut account = common::open("no_material_gains_energy");
    let threshold = critical(ledger::share("no_material_gains_energy").level(), 255.0);
    let scenes = (items(), prop::collection::vec(opaque(0.8), 6), prop::collection::vec(opaque(1.0), 6));
    for (i, (items, dim, bright)) in draw(scenes, 40).enumerate() {
        let mut d = common::random::furnished(DVec3::ONE, &items);
        let materials = if i % 2 == 0 { dim } else { bright };
        d.materials.iter_mut().zip(materials).for_each(|(m, bsdf)| m.bsdf = bsdf);
        let scene = Scene::new(&d);
        let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 };
        let bound = scene.max_albedo().as_dvec3();
        let key = Key::new(account.seed(), "gain").branch(i as u32);
        let means = image_replicates(&film(
            &scene,
            &strip,
            Kind::Prefix,
            &plan(K, Technique::Mis, &Roulette::Never),
            (512, 256),
            key,
        ));
        for k in 0..K {
            account.spend(3);
            let n = means.deviation.len() as f64;
            let squares: DVec3 = means.deviation.iter().map(|d| (d[k + 1] - bound * d[k]).powf(2.0)).sum();
            let excess = means.mean[k + 1] - bound * means.mean[k];
            let limit = threshold * (squares * (n / (n - 1.0))).map(f64::sqrt) + 1e-6 * means.mean[k];
            assert!(excess.cmple(limit).all(), "scene {i}, T{}: {excess} above {limit}", k + 1);
        }
    }
}

/// Two patches of the same albedo in one room with anything between: light from A seen at B is light from B seen at A.
#[test]
fn two_patches_may_change_places() {
    let mut jury = Jury::open("two_patches_may_change_places");
    let between = (prop::collection::vec((prop_oneof![opaque(1.0), glass()], any::<bool>()), 3), 0.2..0.45f64);
    for (i, (materials, size)) in draw(between, 10).enumerate() {
        // A on the floor, B on the wall, of different areas
        let a = quad(DVec3::new(-0.9, -0.99, 0.6), DVec3::X * 0.7, DVec3::NEG_Z * 0.9);
        let b = quad(DVec3::new(0.99, -0.2, -0.5), DVec3::Z * 0.6, DVec3::Y * 0.5);
        let area = [0.7 * 0.9, 0.6 * 0.5];
        let ball = sphere(DVec3::new(0.1, -0.3, 0.1), size, false);
        let block = Geometry::Box {
            min: DVec3::new(-0.6, 0.2, -0.7),
            max: DVec3::new(-0.1, 0.8, -0.2),
            rotate_y: 30.0,
            inward: false,
        };
        let rho = DVec3::new(0.9, 0.7, 0.5);
        let mut d = description(&[
            (a, rho, DVec3::ZERO),
            (b, rho, DVec3::ZERO),
            (room(DVec3::splat(-1.0), DVec3::ONE, 0.0), rho, DVec3::ZERO),
            (ball, rho, DVec3::ZERO),
            (block, rho, DVec3::ZERO),
        ]);
        for (j, (bsdf, both)) in materials.into_iter().enumerate() {
            // the room itself does not let light out
            let bsdf = if j == 0 && matches!(bsdf, BsdfDescription::Dielectric(_)) {
                d.materials[0].bsdf.clone()
            } else {
                bsdf
            };
            d.materials[j + 2].bsdf = bsdf;
            d.materials[j + 2].sides = if both { Sides::Both } else { Sides::Front };
        }
        let [to_b, to_a] = [0, 1].map(|lit: usize| {
            let mut d = d.clone();
            d.shapes[lit].emission = DVec3::ONE;
            let scene = Scene::new(&d);
            let at = Starts(vec![Start::On(2 * (1 - lit as u32)); 16]);
            let key = Key::new(jury.seed(), ["a", "b"][lit]).branch(i as u32);
            let plan = plan(K, Technique::Mis, &Roulette::Constant { from: K, q: 0.3 });
            let mut r = image_replicates(&film(&scene, &at, Kind::Prefix, &plan, (6144, 256), key));
            let scale = area[1 - lit];
            r.mean.iter_mut().for_each(|m| *m *= scale);
            r.deviation.iter_mut().flatten().for_each(|m| *m *= scale);
            r
        });
        same(&mut jury, &format!("scene {i}"), &to_b, &to_a);
    }
    jury.assert_power(0.25, 0.4);
}
