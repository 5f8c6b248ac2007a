//! Walks from the lights in waves: the batched methods of a scene give the bits of the methods for one state, and estimators
//! give the same contributions for any number of walks at once.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::random::{draw, world};
use common::sampling::plan;
use fredholm::estimator::{Batch, Bidirectional, Job, LightTracer, Paths, Plan, Pyramid, Roulette, Technique};
use fredholm::estimator::{TermEstimator, TermSink};
use fredholm::math::{Columns, Key, Purpose, Rgb, Rng};
use fredholm::operator::adjoint::{AdjointStep, Toward};
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::transport::{Seen, Step};
use fredholm::operator::{Adjoint, MatrixWalk, Role, SceneTransport, Sensor, Transport};
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Camera, Scene, Vertex};

/// The same transport without its batched methods: the defaults handle one state after the other.
struct OneByOne<'a>(SceneTransport<'a>);

impl Transport for OneByOne<'_> {
    type State = Vertex;
    type Wave = Vec<Vertex>;
    fn emission(&self, at: &Vertex) -> Rgb {
        self.0.emission(at)
    }
    fn scatter(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        self.0.scatter(at, rng)
    }
    fn connect(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        self.0.connect(at, rng)
    }
    fn albedo(&self, at: &Vertex) -> Rgb {
        self.0.albedo(at)
    }
    fn lit(&self) -> Rgb {
        self.0.lit()
    }
    fn connects_to_all(&self) -> bool {
        self.0.connects_to_all()
    }
}

impl Adjoint for OneByOne<'_> {
    fn emit(&self, rng: &mut Rng) -> Option<(Vertex, f32)> {
        self.0.emit(rng)
    }
    fn emit_density(&self, at: &Vertex) -> f32 {
        self.0.emit_density(at)
    }
    fn connect_density(&self, from: &Vertex, at: &Vertex) -> f32 {
        self.0.connect_density(from, at)
    }
    fn walk(&self, at: &Vertex, role: Role, rng: &mut Rng) -> Option<AdjointStep<Vertex>> {
        self.0.walk(at, role, rng)
    }
    fn toward(&self, at: &Vertex, to: &Vertex, role: Role) -> Toward {
        self.0.toward(at, to, role)
    }
    fn delta_density(&self, at: &Vertex, to: &Vertex, choice: f32) -> f32 {
        self.0.delta_density(at, to, choice)
    }
    fn facing(&self, at: &Vertex, other: &Vertex) -> Vertex {
        self.0.facing(at, other)
    }
    fn link(&self, eye: &Vertex, light: &Vertex) -> f32 {
        self.0.link(eye, light)
    }
}

/// The camera for [`OneByOne`].
struct View(Camera);

impl<'a> Sensor<OneByOne<'a>> for View {
    fn size(&self) -> [u32; 2] {
        self.0.size
    }
    fn start(&self, t: &OneByOne<'a>, pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        self.0.start(&t.0, pixel, rng)
    }
    fn project(&self, t: &OneByOne<'a>, at: &Vertex) -> Option<Seen<Vertex>> {
        self.0.project(&t.0, at)
    }
    fn density(&self, t: &OneByOne<'a>, at: &Vertex) -> f32 {
        self.0.density(&t.0, at)
    }
    fn sees(&self, t: &OneByOne<'a>, at: &Vertex) -> bool {
        self.0.sees(&t.0, at)
    }
}

/// Everything that an estimator adds: slot, pixel, sample and the bits of the value, sorted; and its rays.
#[derive(Debug, Default, PartialEq)]
struct Everything {
    list: Vec<(usize, u32, u32, [u32; 3])>,
    rays: Vec<usize>,
}

impl TermSink for Everything {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        for i in 0..pixel.len() {
            if value.get(i) != Rgb::ZERO {
                self.list.push((slot, pixel[i], sample[i], value.get(i).to_array().map(f32::to_bits)));
            }
        }
    }
    fn rays(&mut self, slot: usize, rays: usize) {
        if rays > 0 {
            self.rays.resize(self.rays.len().max(slot + 1), 0);
            self.rays[slot] += rays;
        }
    }
}

const SAMPLES: u32 = 7;

/// All contributions, `at_once` pixels and samples at a time.
fn everything<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    at_once: [u32; 2],
) -> Everything {
    let ([w, h], key) = (sensor.size(), Key::new(3, "waves"));
    let (mut all, mut paths) = (Everything::default(), Paths::default());
    for first in (0..SAMPLES).step_by(at_once[1] as usize) {
        for pixel in (0..w * h).step_by(at_once[0] as usize) {
            let pixels = pixel..(pixel + at_once[0]).min(w * h);
            let batch = &Batch { key, pixels, samples: first..(first + at_once[1]).min(SAMPLES) };
            estimator.sample(&Job { t, sensor, batch }, &mut paths, &mut all);
        }
    }
    all.list.sort_unstable();
    all
}

fn plans() -> [Plan; 3] {
    let schedule = |s: &str| s.parse::<Roulette>().unwrap();
    [
        plan(5, Technique::Mis, &Roulette::Never),
        plan(4, Technique::Power, &schedule("albedo@1")),
        plan(2, Technique::Mis, &schedule("table:0,0.2,0.1,0.4")),
    ]
}

/// All contributions of all estimators, the same for any batch. Returns them.
fn any_batch<T: Adjoint>(what: &str, t: &T, sensor: &impl Sensor<T>) -> Vec<Everything> {
    let mut results = vec![];
    for plan in plans() {
        let mut compare = |run: &dyn Fn([u32; 2]) -> Everything| {
            let whole = run([u32::MAX >> 1, SAMPLES]);
            for at_once in [[1, 1], [37, 3]] {
                assert!(run(at_once) == whole, "{what}, {plan:?}, {at_once:?} at once");
            }
            results.push(whole);
        };
        compare(&|at_once| everything(t, sensor, &LightTracer(plan.clone()), at_once));
        compare(&|at_once| everything(t, sensor, &Bidirectional(plan.clone()), at_once));
        compare(&|at_once| everything(t, sensor, &Pyramid(plan.clone()), at_once));
    }
    results
}

fn compare(what: &str, scene: &Scene) -> usize {
    let t = SceneTransport::new(scene);
    let waves = any_batch(what, &t, &scene.camera);
    let single = any_batch(what, &OneByOne(t), &View(scene.camera));
    for (a, b) in waves.iter().zip(&single) {
        assert_eq!(a.rays, b.rays, "{what}");
        assert_eq!(a.list.len(), b.list.len(), "{what}");
        if let Some(i) = (0..a.list.len()).find(|&i| a.list[i] != b.list[i]) {
            panic!("{what}: {:?} in a wave, {:?} one by one", a.list[i], b.list[i]);
        }
    }
    waves.iter().map(|all| all.list.len()).sum()
}

#[test]
fn batched_methods_have_the_bits_of_single_ones() {
    let mut found = 0;
    for name in ["cornell", "cornell-spheres", "caustic", "sky-bowl", "env-ggx", "glass-furnace", "veach-ajar"] {
        let mut d = load::scene(name, &Options::default()).unwrap().description;
        d.camera.size = [16, 12];
        found += compare(name, &Scene::new(&d));
    }
    assert!(found > 100_000, "{found}");
    for (i, mut d) in draw(world(), 40).enumerate() {
        d.camera.size = [8, 6];
        compare(&format!("random scene {i}"), &Scene::new(&d));
    }
}

#[test]
fn a_matrix_gives_the_same_for_any_batch() {
    let rows = vec![0.2, 0.5, 0.3, 0.6, 0.1, 0.2, 0.0, 0.7, 0.2];
    let rho = vec![Rgb::new(0.9, 0.5, 0.2), Rgb::new(0.3, 0.8, 0.6), Rgb::splat(0.7)];
    let t = MatrixWalk::new(rows, rho, vec![Rgb::new(1.0, 2.0, 0.0), Rgb::ZERO, Rgb::splat(0.5)]);
    let all = any_batch("matrix", &t, &Rows(3));
    assert!(all.iter().all(|one| one.list.len() > 50));
}

/// One particle, written down once more: the loop of the light tracer for a single walk.
fn particle<T: Adjoint>(
    t: &T,
    sensor: &impl Sensor<T>,
    plan: &Plan,
    (pixel, sample): (u32, u32),
    all: &mut Everything,
) {
    let [w, h] = sensor.size();
    let key = Key::new(3, "waves").branch(0x4c49_4748);
    let numbers = |vertex: usize, purpose: Purpose| Rng::at(key, pixel, sample, vertex, purpose);
    let Some((mut y, density)) = t.emit(&mut numbers(0, Purpose::Start)) else { return };
    let (mut throughput, mut relative, mut role) = (Rgb::splat(1.0 / density), t.lit(), Role::Emission);
    let last = plan.max_bounces + 1;
    for v in 0.. {
        if let Some(seen) = sensor.project(t, &y) {
            let value = throughput * t.toward(&y, &seen.eye, role).value * seen.importance;
            if value != Rgb::ZERO {
                all.rays(v.min(last), 1);
                if sensor.sees(t, &y) {
                    let bits = (value * (1.0 / (w * h) as f32)).to_array().map(f32::to_bits);
                    all.list.push((v.min(last), seen.pixel, sample, bits));
                }
            }
        }
        if v == plan.max_bounces && !plan.roulette.ends() {
            break;
        }
        let q = if v == 0 { 0.0 } else { plan.roulette.termination(v, relative, t.albedo(&y)) };
        if q > 0.0 {
            if numbers(v, Purpose::Roulette).one() < q {
                break;
            }
            (throughput, relative) = (throughput / (1.0 - q), relative / (1.0 - q));
        }
        all.rays((v + 1).min(last), 1);
        let Some(step) = t.walk(&y, role, &mut numbers(v, Purpose::Scatter)) else { break };
        if role == Role::Flux {
            relative *= step.weight;
        }
        (throughput, y, role) = (throughput * step.weight, step.state, Role::Flux);
    }
}

#[test]
fn a_wave_of_particles_is_many_particles() {
    let mut seen = 0;
    for name in ["cornell", "caustic", "env-ggx"] {
        let mut d = load::scene(name, &Options::default()).unwrap().description;
        d.camera.size = [16, 12];
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        for plan in plans() {
            let mut single = Everything::default();
            for (pixel, sample) in (0..16 * 12).flat_map(|p| (0..SAMPLES).map(move |s| (p, s))) {
                particle(&t, &scene.camera, &plan, (pixel, sample), &mut single);
            }
            single.list.sort_unstable();
            let wave = everything(&t, &scene.camera, &LightTracer(plan.clone()), [100, 2]);
            assert_eq!(wave.rays.len(), single.rays.len());
            assert!(wave == single, "{name}, {plan:?}");
            seen += single.list.len();
        }
    }
    // some plans find little in `caustic`, but together there is enough to compare
    assert!(seen > 1000, "{seen}");
}
