//! Rays per second of one thread: `cargo bench --bench rays [-- 70000 1000000 crossover lost:10000000 rays:1000000]`.
//!
//! | argument | measures |
//! |---|---|
//! | a number | a closed room of about so many triangles: Mrays/s of the tree, and lost hits |
//! | `rays:N` | with N rays of each kind (a million) |
//! | `lost:N` | so many more rays in each room for the count of lost hits (none) |
//! | `crossover` | packets beside the tree for small numbers of shapes |
//!
//! Times are CPU seconds, medians of interleaved rounds. A hit is **lost** if the tree finds nothing although one exists. Two
//! counts are printed. Of all rays in a closed room, those that hit nothing are tested against every triangle by the same formula;
//! those that every triangle misses too started outside, because a bounce may start beyond a narrow edge. On a sample of the
//! rays, the tree is compared with the test of every triangle, where t and the triangle must be equal.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

#[path = "ray_sets/mod.rs"]
mod ray_sets;

use fredholm::scene::Scene;
use fredholm::scene::batch::{RayBatch, Way, triangles};
use ray_sets::{BATCH, Ray, Set, Work, bounces, cpu_seconds, medians, random, room, sets};

const ROUNDS: usize = 7;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let value = |name: &str| words.iter().find_map(|w| w.strip_prefix(name)?.parse::<usize>().ok());
    let (n, more) = (value("rays:").unwrap_or(1_000_000), value("lost:").unwrap_or(0));
    let mut sizes: Vec<usize> = words.iter().filter_map(|w| w.parse().ok()).collect();
    let crossing = words.iter().any(|w| w == "crossover");
    if sizes.is_empty() && !crossing {
        sizes = vec![70_000, 1_000_000];
    }
    sizes.iter().for_each(|&size| closed_room(size, n, more));
    if crossing {
        crossover();
    }
}

fn batches(rays: &[Ray]) -> Vec<RayBatch> {
    rays.chunks(BATCH).map(RayBatch::new).collect()
}

fn trace(scene: &Scene, batches: &mut [RayBatch], any: bool, way: Way) {
    for b in batches {
        if any { b.occluded(scene, way) } else { b.closest(scene, way) }
    }
}

fn closed_room(size: usize, n: usize, more: usize) {
    let description = room(size);
    let start = cpu_seconds();
    let scene = Scene::new(&description);
    let corners = triangles(&scene);
    println!("{} triangles, scene built in {:.2} CPU-s", corners.len(), cpu_seconds() - start);
    let sets = sets(&scene, n);
    for set in &sets {
        let ways = [Way::Tree, Way::Single, Way::Plain];
        let all = ways.map(|_| std::cell::RefCell::new(batches(&set.rays)));
        let work = |(i, way): (usize, &Way)| -> Work<'_> {
            let (scene, set, all, way) = (&scene, set, &all[i], *way);
            (format!("{way:?}"), Box::new(move || trace(scene, &mut all.borrow_mut(), set.any, way)))
        };
        let mut works: Vec<Work<'_>> = ways.iter().enumerate().map(work).collect();
        let found = medians(ROUNDS, &mut works);
        for ((name, _), [time, _]) in works.iter().zip(&found) {
            print!("  {:10} {name:6} {:7.3} Mrays/s", set.name, set.rays.len() as f64 * 1e-6 / time);
        }
        println!();
    }
    let (mut outside, mut lost) = (0, 0);
    for set in sets.iter().filter(|s| !s.any) {
        missed(&scene, &set.rays, &mut outside, &mut lost);
    }
    let mut traced: usize = sets.iter().filter(|s| !s.any).map(|s| s.rays.len()).sum();
    let (mut rays, mut next) = (sets[2].rays.clone(), random(7));
    while traced < more {
        rays = bounces(&scene, &corners, &rays, &mut next);
        missed(&scene, &rays, &mut outside, &mut lost);
        traced += rays.len();
    }
    println!(
        "  hits lost in the closed room: {lost} of {traced}, {} in 10⁹ ({outside} rays start outside)",
        rate(lost, traced)
    );
    compare(&scene, &sets, (2e10 / corners.len() as f64) as usize);
}

fn rate(found: usize, of: usize) -> f64 {
    found as f64 * 1e9 / of as f64
}

/// Counts rays that hit nothing: `outside` if every triangle misses them too, otherwise `lost`.
fn missed(scene: &Scene, rays: &[Ray], outside: &mut usize, lost: &mut usize) {
    for rays in rays.chunks(BATCH) {
        let mut batch = RayBatch::new(rays);
        batch.closest(scene, Way::Tree);
        let none: Vec<Ray> = (0..rays.len()).filter(|i| batch.hit(*i).is_none()).map(|i| rays[i]).collect();
        let mut truth = RayBatch::new(&none);
        truth.closest(scene, Way::EveryShape);
        let there = (0..none.len()).filter(|i| truth.hit(*i).is_some()).count();
        (*lost, *outside) = (*lost + there, *outside + none.len() - there);
    }
}

/// The tree against every triangle, on about `n` rays of each kind.
fn compare(scene: &Scene, sets: &[Set; 4], n: usize) {
    for set in sets {
        let rays: Vec<Ray> = set.rays.iter().step_by((set.rays.len() / n).max(1)).copied().collect();
        let (mut lost, mut more, mut other) = (0, 0, 0);
        for rays in rays.chunks(BATCH) {
            let [mut tree, mut truth] = [RayBatch::new(rays), RayBatch::new(rays)];
            if set.any {
                tree.occluded(scene, Way::Tree);
                truth.occluded(scene, Way::Packets);
            } else {
                tree.closest(scene, Way::Tree);
                truth.closest(scene, Way::Packets);
            }
            for i in 0..rays.len() {
                let [a, b] = [&truth, &tree].map(|x| if set.any { x.blocked(i).then_some((0.0, 0)) } else { x.hit(i) });
                lost += usize::from(a.is_some() && b.is_none());
                more += usize::from(a.is_none() && b.is_some());
                other += usize::from(a.is_some() && b.is_some() && a != b);
            }
        }
        println!(
            "  {:10} against every triangle, {} rays: {lost} lost ({} in 10⁹), {more} invented, {other} another hit",
            set.name,
            rays.len(),
            rate(lost, rays.len())
        );
    }
}

/// Packets and tree on small scenes, in ns per ray. Each round repeats the rays, since CPU time counts in steps of some ms.
fn crossover() {
    const TIMES: usize = 20;
    for size in [12, 96, 240, 480] {
        let scene = Scene::new(&room(size));
        let shapes = triangles(&scene).len();
        for set in &sets(&scene, 50_000) {
            let mut all = [batches(&set.rays), batches(&set.rays)];
            let [packets, tree] = &mut all;
            let mut works: Vec<Work<'_>> = vec![
                ("packets".into(), Box::new(|| (0..TIMES).for_each(|_| trace(&scene, packets, set.any, Way::Packets)))),
                ("tree".into(), Box::new(|| (0..TIMES).for_each(|_| trace(&scene, tree, set.any, Way::Tree)))),
            ];
            let found = medians(ROUNDS, &mut works).into_iter().map(|[t, _]| t * 1e9 / (TIMES * set.rays.len()) as f64);
            let [p, t] = found.collect::<Vec<f64>>()[..] else { unreachable!() };
            println!("{shapes:5} triangles, {:10} packets {p:7.1} ns, tree {t:7.1} ns", set.name);
        }
    }
}
