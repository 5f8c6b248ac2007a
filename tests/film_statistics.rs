//! The statistics of a film, which are computed in one pass over its memory, compared with their definitions pixel by pixel.

#![allow(clippy::unwrap_used)]

use fredholm::engine::Settings;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Prefix, Roulette};
use fredholm::operator::SceneTransport;
use fredholm::progress::Progress;
use fredholm::scene::{Scene, load};
use fredholm::terms::functional::{functionals, image_replicates};
use fredholm::terms::statistics::Statistics;
use fredholm::terms::variance::{Snapshot, snapshot};
use fredholm::terms::{TermFilm, TermImage};
use glam::DVec3;
use std::ops::Range;

/// Terms up to k = 2 and the tail, in pixels that fill no block and no tile.
fn film(spp: u32) -> TermFilm {
    let options = load::Options { set: vec!["camera.size=[37,21]".into()], ..Default::default() };
    let scene = Scene::new(&load::scene("cornell", &options).unwrap().description);
    let settings = Settings { max_bounces: 2, roulette: Roulette::Albedo { from: 2 }, ..Settings::default() };
    let t = SceneTransport::new(&scene);
    render(&t, &scene.camera, &Prefix(settings.plan()), Amount::new(spp, settings.key("statistics", 1)), Progress::NONE)
}

/// The slots of every image: each alone, all but the last, all.
fn parts(film: &TermFilm) -> Vec<Range<usize>> {
    let slots = film.shape.slots;
    (0..slots).map(|s| s..s + 1).chain([0..slots - 1, 0..slots]).collect()
}

/// Mean and deviations of the replicates at a pixel: m = Σ S_r/N, d_r = (S_r − n_r m)/N.
fn definition(film: &TermFilm, pixel: usize, slots: Range<usize>) -> (DVec3, Vec<DVec3>) {
    let (r, n) = (film.shape.replicates, f64::from(film.samples[pixel]));
    let sum = |i: usize| slots.clone().map(|s| film.sum(pixel, i, s)).sum::<DVec3>();
    let mean = (0..r).map(sum).sum::<DVec3>() / n;
    (mean, (0..r).map(|i| (sum(i) - mean * film.count(pixel, i)) / n).collect())
}

/// The numbers of a snapshot; its squared errors are NaN, because there is no reference.
fn numbers(snapshot: &Snapshot) -> Vec<(&[f64], DVec3, f64)> {
    snapshot.scatter.iter().map(|s| (s.q.as_slice(), s.channels, s.events)).collect()
}

fn close(a: f64, b: f64, what: &str) {
    assert!((a - b).abs() <= 1e-11 * a.abs().max(b.abs()), "{what}: {a} and {b}");
}

/// 23 samples leave replicates with one and with two; with 5 the errors of the functionals come from the pixels.
#[test]
fn one_pass_finds_what_the_definitions_say() {
    for spp in [23, 5] {
        let film = film(spp);
        let (pixels, r) = (film.shape.pixels(), film.shape.replicates as f64);
        let found = Statistics::of(&film);
        assert_eq!(found.images.len(), parts(&film).len());
        for (part, slots) in parts(&film).into_iter().enumerate() {
            let (mut events, mut q) = (vec![], vec![0.0; film.shape.replicates]);
            let (mut m, mut channels) = (DVec3::ZERO, DVec3::ZERO);
            for p in 0..pixels {
                let (mean, d) = definition(&film, p, slots.clone());
                let error = (d.iter().map(|d| d * d).sum::<DVec3>() * r / (r - 1.0)).map(f64::sqrt);
                let image: &TermImage = &found.images[part];
                for c in 0..3 {
                    assert!((f64::from(image.mean[p][c]) - mean[c]).abs() <= 1e-7 * mean[c], "{part} {p}");
                    assert!(
                        (f64::from(image.std_error[p][c]) - error[c]).abs() <= 1e-7 * error[c].max(1e-9),
                        "{part} {p}"
                    );
                }
                let square: f64 = slots.clone().map(|s| film.square(p, s)).sum();
                let sum = mean.element_sum() * f64::from(film.samples[p]);
                events.extend((square > 0.0).then(|| sum * sum / square));
                d.iter().zip(&mut q).for_each(|(d, q)| *q += (d * r).length_squared() / (3.0 * pixels as f64));
                m += mean / pixels as f64;
                channels += error * error / pixels as f64;
            }
            events.sort_by(f64::total_cmp);
            close(found.events[part], events.get(events.len() / 2).copied().unwrap_or(0.0), "events");
            close(found.replicates.estimate(slots.clone()).mean.y, m.y, "mean");
            // the sum without the tail has no place in the snapshot
            let Some(place) = (part < film.shape.slots)
                .then_some(part)
                .or((slots.end == film.shape.slots).then_some(film.shape.slots))
            else {
                continue;
            };
            let scatter = &found.snapshot.scatter[place];
            scatter.q.iter().zip(&q).for_each(|(a, b)| close(*a, *b, "q"));
            (0..3).for_each(|c| close(scatter.channels[c], channels[c], "V"));
        }
        // products of different replicates
        for (slot, norm) in found.norms.iter().enumerate() {
            let mut value = 0.0;
            for p in 0..pixels {
                let m: Vec<DVec3> =
                    (0..film.shape.replicates).map(|i| film.sum(p, i, slot) / film.count(p, i)).collect();
                let all: DVec3 = m.iter().sum();
                value += all.length_squared() - m.iter().map(|m| m.length_squared()).sum::<f64>();
            }
            let value = value / (3.0 * pixels as f64 * r * (r - 1.0));
            assert!((norm.unwrap().value - value).abs() <= 1e-10 * value.abs(), "{slot}");
        }
        // the functions that read the film for themselves
        assert_eq!(found.functionals, functionals(&film));
        assert_eq!(numbers(&found.snapshot), numbers(&snapshot(&film)));
        let alone = image_replicates(&film);
        assert_eq!((&alone.mean, &alone.deviation), (&found.replicates.mean, &found.replicates.deviation));
        for (part, slots) in parts(&film).into_iter().enumerate() {
            assert_eq!(TermImage::of(&film, slots), found.images[part]);
        }
    }
}

#[test]
fn the_statistics_have_the_same_bits_on_any_number_of_threads() {
    let film = film(23);
    let in_pool = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Statistics::of(&film))
    };
    let (one, three) = (in_pool(1), in_pool(3));
    assert_eq!((one.images, one.events), (three.images, three.events));
    assert_eq!(numbers(&one.snapshot), numbers(&three.snapshot));
    assert_eq!((one.norms, one.functionals), (three.norms, three.functionals));
}
