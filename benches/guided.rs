//! What a guide gains: `cargo bench --bench guided [-- SCENE SPP PATCHES RAYS BSDF]`.
//!
//! ```text
//! gain = (relMSE · seconds) of the BSDF / (relMSE · seconds) of the guide        relMSE = mean of (I − R)²/(R² + ε²)
//! ```
//!
//! R is a reference of 16 times the samples from streams of its own, guided and unguided in equal parts; ε is a tenth of the image
//! mean. The seconds are those that all threads worked (Linux tells), so that other work on the machine matters little, and the seconds of the guide's preparation stand beside them: in an equal-time
//! comparison of T seconds the gain is multiplied by 1 − preparation/T.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use fredholm::estimator::render::{Amount, Unwatched, render};
use fredholm::estimator::{PathTracer, Plan, Prefix, Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::guided::{Guide, GuidedTransport, Recipe};
use fredholm::operator::{SceneTransport, Sensor, Transport};
use fredholm::scene::{Camera, Scene, load};
use fredholm::terms::TermFilm;
use glam::DVec3;
use std::sync::atomic::AtomicBool;

/// Seconds that this process has worked, in all its threads; hundredths.
fn worked() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let after_name = stat.rsplit(") ").next().unwrap();
    let ticks: f64 = after_name.split(' ').skip(11).take(2).map(|t| t.parse::<f64>().unwrap()).sum();
    ticks / 100.0
}

struct Run {
    film: TermFilm,
    seconds: f64,
}

/// Whether a transport knows what to expect.
trait Expects {
    fn expects(&self) -> bool;
}

impl Expects for SceneTransport<'_> {
    fn expects(&self) -> bool {
        false
    }
}

impl Expects for GuidedTransport<'_> {
    fn expects(&self) -> bool {
        true
    }
}

fn run<T: Transport + Expects>(t: &T, camera: &Camera, what: &str, spp: u32, seed: u64) -> Run
where
    Camera: Sensor<T>,
{
    let (stop, start) = (AtomicBool::new(false), worked());
    let plan = |roulette| Plan { max_bounces: 8, technique: Technique::Mis, roulette };
    let amount = Amount::new(spp, Key::new(seed, what));
    let film = match what {
        "path" => render(t, camera, &PathTracer(plan(Roulette::Albedo { from: 2 })), amount, &mut Unwatched, &stop),
        // without a guide nobody knows what to expect, and this is roulette by albedo from vertex 2 on
        "contribution" => {
            let roulette = if t.expects() { Roulette::Contribution { from: 1 } } else { Roulette::Albedo { from: 2 } };
            render(t, camera, &PathTracer(plan(roulette)), amount, &mut Unwatched, &stop)
        }
        _ => render(t, camera, &Prefix(plan(Roulette::Albedo { from: 8 })), amount, &mut Unwatched, &stop),
    };
    Run { film, seconds: worked() - start }
}

fn image(film: &TermFilm) -> Vec<DVec3> {
    (0..film.shape.pixels()).map(|p| film.pixel(p, 0..film.shape.slots).0).collect()
}

fn rel_mse(film: &TermFilm, reference: &[DVec3]) -> f64 {
    let mean = reference.iter().sum::<DVec3>() / reference.len() as f64;
    let error = |(a, r): (&DVec3, &DVec3)| {
        let e = (*a - *r).powf(2.0) / (r.powf(2.0) + (0.1 * mean).powf(2.0));
        e.element_sum() / 3.0
    };
    image(film).iter().zip(reference).map(error).sum::<f64>() / reference.len() as f64
}

/// Median over the pixels of se²: what the few fireflies of the mean do not hide.
fn median_variance(film: &TermFilm) -> f64 {
    let mut all: Vec<f64> =
        (0..film.shape.pixels()).map(|p| film.pixel(p, 0..film.shape.slots).1.powf(2.0).element_sum()).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

fn main() {
    let args: Vec<String> = std::env::args().filter(|a| !a.starts_with("--")).skip(1).collect();
    let number = |i: usize, default: f64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(default);
    let scenes = args.first().map_or("cornell,veach-ajar,many-lights".to_string(), Clone::clone);
    let spp = number(1, 64.0) as u32;
    for name in scenes.split(',') {
        let mut description = load::scene(name, &load::Options::default()).unwrap().description;
        description.camera.size = [48, 48];
        let scene = Scene::new(&description);
        let plain = SceneTransport::new(&scene);
        let mut recipe = Recipe::default();
        recipe.patches = number(2, recipe.patches as f64) as usize;
        recipe.fineness.rays = number(3, recipe.fineness.rays as f64) as usize;
        recipe.bsdf = number(4, recipe.bsdf);
        let start = worked();
        let stop = AtomicBool::new(false);
        let guide = Guide::new(&description, recipe, Key::new(0, "guide"), |_| (), &|| (), &stop).unwrap().unwrap();
        let prepared = worked() - start;
        let guided = GuidedTransport { scene: plain, guide: &guide };
        let camera = &scene.camera;
        let many = 8 * spp;
        let halves = [run(&plain, camera, "prefix", many, 101), run(&guided, camera, "prefix", many, 102)];
        let [a, b] = halves.each_ref().map(|h| image(&h.film));
        let reference: Vec<DVec3> = a.iter().zip(&b).map(|(a, b)| 0.5 * (*a + *b)).collect();
        println!("{name}: {} patches prepared in {prepared:.2} s, {spp} spp", guide.len());
        for what in ["prefix", "path", "contribution"] {
            let [p, g] = [run(&plain, camera, what, spp, 1), run(&guided, camera, what, spp, 2)];
            let [ep, eg] = [&p, &g].map(|r| rel_mse(&r.film, &reference));
            let paths = p.film.shape.pixels() as f64 * f64::from(spp);
            println!(
                "  {what:12} unguided {:5.0} ns, relMSE {ep:.3e}; guided {:5.0} ns, relMSE {eg:.3e}; equal samples {:.2}, equal time {:.2} (median pixel {:.2})",
                1e9 * p.seconds / paths,
                1e9 * g.seconds / paths,
                ep / eg,
                ep * p.seconds / (eg * g.seconds),
                median_variance(&p.film) * p.seconds / (median_variance(&g.film) * g.seconds)
            );
        }
    }
}
