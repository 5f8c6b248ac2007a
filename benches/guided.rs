//! Gain in efficiency by a guide: `cargo bench --bench guided [-- SCENE SPP PATCHES RAYS BSDF SEEDS]`.
//!
//! ```text
//! gain = (relMSE · seconds) without a guide / (relMSE · seconds) with the guide        relMSE = mean of (I − R)²/(R² + ε²)
//! ```
//!
//! I is the image and R a guided reference with 16 times the samples and independent random numbers. The error of the
//! reference affects both sides equally. ε is a tenth of the image mean.
//!
//! Seconds are CPU seconds of all threads (read from Linux), so that other load on the machine has little effect. The errors
//! have heavy tails. Each gain is therefore the median over seeds, printed with the smallest and the largest value.
//! `in 60 s` is the gain at equal time if 60 seconds of work include the preparation of the guide: the gain times
//! (1 − preparation/60 s).
//! time when 60 seconds of work include the guide's preparation: times 1 − preparation/60 s.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::guide::tracked::{Tracked, TrackedSensor};
use fredholm::guide::{self, ByExpectation, Expecting, Guide, GuidedTransport, Recipe};
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::progress::Progress;
use fredholm::scene::{Camera, Scene, load};
use fredholm::terms::TermFilm;
use glam::DVec3;

/// CPU seconds of all threads of this process so far, to a hundredth.
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

/// Estimator and roulette. Without a guide the expected light is not known, and paths end by albedo instead: from vertex 2
/// on, and from vertex K on if the terms are kept.
const KINDS: [&str; 4] = ["prefix", "prefix window", "path", "window"];

fn run<T: Expecting>(t: &T, camera: &Camera, what: &str, spp: u32, key: Key) -> Run
where
    Camera: Sensor<T>,
{
    let start = worked();
    let plan = |roulette| Plan { max_bounces: 8, technique: Technique::Mis, roulette };
    let (amount, end) = (Amount::new(spp, key), ByExpectation::Window { from: 0 });
    let knows = camera.start(t, 0, &mut Rng::at(key, 0, 0, 0, Purpose::Start)).and_then(|x| t.expected(&x)).is_some();
    let (kept, usual) = (plan(Roulette::Albedo { from: 8 }), plan(Roulette::Albedo { from: 2 }));
    let film = match what {
        "prefix window" if knows => {
            let prefix = guide::Prefix { max_bounces: kept.max_bounces, technique: kept.technique, end };
            render(&Tracked(t), &TrackedSensor(camera), &prefix, amount, Progress::NONE)
        }
        "prefix" | "prefix window" => render(t, camera, &Prefix(kept), amount, Progress::NONE),
        _ => {
            let end = (knows && what == "window").then_some(end);
            render(t, camera, &guide::PathTracer { plan: usual, end }, amount, Progress::NONE)
        }
    };
    Run { film, seconds: worked() - start }
}

/// The median, the smallest and the largest value.
fn middle(mut all: Vec<f64>) -> [f64; 3] {
    all.sort_by(f64::total_cmp);
    [all[all.len() / 2], all[0], all[all.len() - 1]]
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

/// Median over the pixels of se². Unlike the mean, it is not dominated by a few fireflies.
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
    let (spp, seeds) = (number(1, 64.0) as u32, number(5, 5.0) as u64);
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
        let guide = Guide::new(&description, recipe, Key::new(0, "guide"), Progress::NONE).unwrap().unwrap();
        let prepared = worked() - start;
        let guided = GuidedTransport { scene: plain, guide: &guide };
        let camera = &scene.camera;
        let reference = image(&run(&guided, camera, "prefix", 16 * spp, Key::new(100, "reference")).film);
        println!("{name}: {} patches prepared in {prepared:.2} s, {spp} spp, {seeds} seeds", guide.len());
        for what in KINDS {
            let (mut times, mut errors, mut gains, mut medians) = ([vec![], vec![]], [vec![], vec![]], vec![], vec![]);
            for seed in 0..seeds {
                let key = |side: &str| Key::new(seed, &format!("{side} {what}"));
                let runs =
                    [run(&plain, camera, what, spp, key("plain")), run(&guided, camera, what, spp, key("guided"))];
                let [p, g] = runs.each_ref().map(|r| rel_mse(&r.film, &reference) * r.seconds);
                let [mp, mg] = runs.each_ref().map(|r| median_variance(&r.film) * r.seconds);
                let paths = reference.len() as f64 * f64::from(spp);
                for (side, r) in runs.iter().enumerate() {
                    times[side].push(1e9 * r.seconds / paths);
                    errors[side].push(rel_mse(&r.film, &reference));
                }
                gains.push(p / g);
                medians.push(mp / mg);
            }
            let [tp, tg] = times.map(|t| middle(t)[0]);
            let [ep, eg] = errors.map(|e| middle(e)[0]);
            let [gain, least, most] = middle(gains);
            println!(
                "  {what:12} unguided {tp:5.0} ns, relMSE {ep:.2e}; guided {tg:5.0} ns, relMSE {eg:.2e}; equal time {gain:.2} ({least:.2} to {most:.2}), in 60 s {:.2}; median pixel {:.2}",
                gain * (1.0 - prepared / 60.0),
                middle(medians)[0],
            );
        }
    }
}
