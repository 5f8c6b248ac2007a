//! Cost of a path: `cargo bench --bench paths [-- SPP] [NAME]`, one thread, Cornell box 256×256, k = 0..=8, MIS.
//!
//! Prints nanoseconds per path, as medians of five interleaved rounds, and the cost of keeping all terms relative to keeping
//! only their sum. With a name, only the estimators whose names contain it are measured.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{
    Bidirectional, Job, LightTracer, PathTracer, Paths, Plan, Prefix, Roulette, SingleTerm, Technique, TermEstimator,
    TermSink,
};
use fredholm::math::{Columns, Key};
use fredholm::operator::{SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::{Scene, load};
use std::time::Instant;

/// The prefix estimator with all terms added to one slot: the same paths, without separate terms.
struct OnlyTheSum(Prefix);

struct OneSlot<'a, S>(&'a mut S);

impl<S: TermSink> TermSink for OneSlot<'_, S> {
    fn add(&mut self, _: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        self.0.add(0, pixel, sample, value);
    }
}

impl<T: Transport> TermEstimator<T> for OnlyTheSum {
    fn slots(&self) -> usize {
        1
    }
    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        self.0.sample(job, paths, &mut OneSlot(sink));
    }
}

fn main() {
    let spp = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(32);
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    let scene = Scene::new(&load::scene("cornell", &load::Options::default()).unwrap().description);
    let t = SceneTransport::new(&scene);
    let plan = |roulette| Plan { max_bounces: 8, technique: Technique::Mis, roulette };
    let (cut, tail) = (plan(Roulette::Never), plan(Roulette::Albedo { from: 8 }));
    let time = |what: &str| {
        let (amount, start) = (Amount::new(spp, Key::new(0, what)), Instant::now());
        let camera = &scene.camera;
        let film = match what {
            "prefix, all terms" => render(&t, camera, &Prefix(cut.clone()), amount, Progress::NONE),
            "prefix, sum only" => render(&t, camera, &OnlyTheSum(Prefix(cut.clone())), amount, Progress::NONE),
            "prefix, all terms and tail" => render(&t, camera, &Prefix(tail.clone()), amount, Progress::NONE),
            "light" => render(&t, camera, &LightTracer(cut.clone()), amount, Progress::NONE),
            "bidirectional" => render(&t, camera, &Bidirectional(cut.clone()), amount, Progress::NONE),
            "path tracer (scalar)" => render(&t, camera, &PathTracer(cut.clone()), amount, Progress::NONE),
            _ => render(&t, camera, &SingleTerm(cut.clone()), amount, Progress::NONE),
        };
        start.elapsed().as_secs_f64() * 1e9 / (film.shape.pixels() as f64 * f64::from(spp))
    };
    let names = [
        "prefix, all terms",
        "prefix, sum only",
        "prefix, all terms and tail",
        "path tracer (scalar)",
        "single",
        "light",
        "bidirectional",
    ];
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-') && a.parse::<u32>().is_err());
    let names = names.into_iter().filter(|name| wanted.as_ref().is_none_or(|w| name.contains(w.as_str())));
    let names: Vec<&str> = names.collect();
    let mut times = vec![vec![]; names.len()];
    for _ in 0..5 {
        for (&name, times) in names.iter().zip(&mut times) {
            times.push(time(name));
        }
    }
    let median = |v: &mut Vec<f64>| {
        v.sort_by(f64::total_cmp);
        v[v.len() / 2]
    };
    let medians: Vec<f64> = times.iter_mut().map(median).collect();
    for (name, ns) in names.iter().zip(&medians) {
        println!("{name:28} {ns:7.0} ns per path");
    }
    if wanted.is_none() {
        println!("all terms / sum only         {:7.2}", medians[0] / medians[1]);
        println!("all terms / path tracer      {:7.2}", medians[0] / medians[3]);
    }
}
