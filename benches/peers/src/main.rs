//! The tree of this project beside Embree 3; see `README.md`.

#[path = "../../ray_sets/mod.rs"]
mod ray_sets;

use embree3::{BufferUsage, Config, Device, Format, GeometryKind, IntersectContext, SceneFlags};
use fredholm::scene::Scene;
use fredholm::scene::batch::{RayBatch, Way, triangles};
use glam::Vec3;
use ray_sets::{BATCH, Ray, Set, Work, cpu_seconds, medians, room, sets};
use std::cell::RefCell;

const WAYS: [(&str, Way); 4] =
    [("tree", Way::Tree), ("single", Way::Single), ("avx2", Way::Avx2), ("plain", Way::Plain)];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let value = |name: &str| words.iter().find_map(|w| w.strip_prefix(name)?.parse::<usize>().ok());
    let (n, rounds) = (value("rays:").unwrap_or(1_000_000), value("rounds:").unwrap_or(7));
    let mut sizes: Vec<usize> = words.iter().filter_map(|w| w.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = vec![70_000, 1_000_000];
    }
    for size in sizes {
        let start = cpu_seconds();
        let scene = Scene::new(&room(size));
        let corners = triangles(&scene);
        println!("{} triangles, scene built in {:.2} CPU-s", corners.len(), cpu_seconds() - start);
        let device = Device::with_config(Config { threads: 1, ..Default::default() }).expect("Embree");
        let start = cpu_seconds();
        let fast = build(&device, &corners, false);
        println!("  Embree built in {:.2} CPU-s", cpu_seconds() - start);
        let robust = build(&device, &corners, true);
        for set in &sets(&scene, n) {
            compare(&scene, [&fast, &robust], set, rounds);
        }
    }
}

/// Embree's scene of these triangles.
fn build<'a>(device: &Device, corners: &[[Vec3; 3]], robust: bool) -> embree3::Scene<'a> {
    let mut geometry = device.create_geometry(GeometryKind::TRIANGLE).expect("geometry");
    let n = corners.len();
    let points: Vec<[f32; 3]> = corners.iter().flatten().map(|p| p.to_array()).collect();
    let faces: Vec<[u32; 3]> = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let room = "room for a buffer";
    geometry.set_new_buffer(BufferUsage::VERTEX, 0, Format::FLOAT3, 12, 3 * n).expect(room).copy_from_slice(&points);
    geometry.set_new_buffer(BufferUsage::INDEX, 0, Format::UINT3, 12, n).expect(room).copy_from_slice(&faces);
    let mut scene = device.create_scene().expect("scene");
    if robust {
        scene.set_flags(SceneFlags::ROBUST);
    }
    scene.attach_geometry(&geometry.commit());
    scene.commit();
    scene
}

/// Traces rays one by one; writes whether each hits.
fn embree(scene: &embree3::Scene<'_>, rays: &[Ray], hits: &mut [bool], any: bool) {
    let mut context = IntersectContext::incoherent();
    for ((o, d), hit) in rays.iter().zip(hits) {
        let mut ray = embree3::Ray::segment(o.to_array(), d.to_array(), 0.0, if any { 1.0 } else { f32::INFINITY });
        *hit = if any {
            scene.occluded(&mut context, &mut ray)
        } else {
            let mut found = embree3::RayHit::from(ray);
            scene.intersect(&mut context, &mut found);
            found.hit.is_valid()
        };
    }
}

/// Prints the speed of every way on one kind of rays.
fn compare(scene: &Scene, peers: [&embree3::Scene<'_>; 2], set: &Set, rounds: usize) {
    let n = set.rays.len();
    let hits = [(); 2].map(|()| RefCell::new(vec![false; n]));
    let batches = WAYS.map(|_| RefCell::new(set.rays.chunks(BATCH).map(RayBatch::new).collect::<Vec<_>>()));
    let mut works: Vec<Work<'_>> = vec![];
    for ((name, peer), hits) in ["Embree fast", "Embree robust"].into_iter().zip(peers).zip(&hits) {
        works.push((name.into(), Box::new(move || embree(peer, &set.rays, &mut hits.borrow_mut(), set.any))));
    }
    for ((name, way), batches) in WAYS.into_iter().zip(&batches) {
        let trace = move || {
            for b in batches.borrow_mut().iter_mut() {
                if set.any { b.occluded(scene, way) } else { b.closest(scene, way) }
            }
        };
        works.push((name.into(), Box::new(trace)));
    }
    let found = medians(rounds, &mut works);
    let names: Vec<String> = works.into_iter().map(|w| w.0).collect();
    let lost = hits.iter().map(|h| h.borrow().iter().filter(|h| !**h).count()).chain(batches.iter().map(|all| {
        let missed = |(k, b): (usize, &RayBatch)| (0..BATCH.min(n - k * BATCH)).filter(|i| b.hit(*i).is_none()).count();
        all.borrow().iter().enumerate().map(missed).sum::<usize>()
    }));
    for ((name, [time, ratio]), lost) in names.iter().zip(found).zip(lost) {
        print!("  {:10} {name:13} {:7.3} Mrays/s ({ratio:.2})", set.name, n as f64 * 1e-6 / time);
        if set.any { println!() } else { println!("  {lost} lost of {n}") }
    }
}
