//! Runs an estimator and records the [cross moments](crate::terms::cross_moments) of its slots: each path gives one vector
//! of slot values.
//!
//! A block of pixels is one job. It takes all samples of its pixels, one replicate after the other, and adds the products of
//! the slot values of every path. Blocks are added in their order, so the sums have the same bits for any number of threads.
//! `R · slots²` sums are kept (R replicates), and two images: of all slots together, and of slot 0. An image per slot is not kept.

use super::render::Amount;
use super::{Batch, Job, Paths, TermEstimator, TermSink};
use crate::math::Columns;
use crate::operator::{Sensor, Transport};
use crate::progress::Progress;
use crate::terms::cross_moments::{Recorded, Sums};
use crate::terms::film::BLOCK;
use rayon::prelude::*;
use std::time::Instant;

/// Samples of each pixel of a block that walk together as one wave.
const AT_ONCE: u32 = 8;
/// Blocks whose sums are held in memory at once.
const SIDE_BY_SIDE: usize = 16;

/// The slot values of the paths of one batch: `values[(path · 3 + channel) · slots + slot]`.
struct Wave {
    first: u32,
    pixels: u32,
    sample: u32,
    slots: usize,
    values: Vec<f64>,
    rays: Vec<u64>,
}

impl TermSink for Wave {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        for i in 0..pixel.len() {
            let path = ((sample[i] - self.sample) * self.pixels + pixel[i] - self.first) as usize;
            let at = |channel: usize| (path * 3 + channel) * self.slots + slot;
            self.values[at(0)] += f64::from(value.x[i]);
            self.values[at(1)] += f64::from(value.y[i]);
            self.values[at(2)] += f64::from(value.z[i]);
        }
    }
    fn rays(&mut self, slot: usize, rays: usize) {
        self.rays[slot] += rays as u64;
    }
}

/// The means of all slots together and of slot 0, for each pixel. `sums` holds S_a by pixel, channel, replicate.
fn means(sums: &[f64], slots: usize, replicates: usize, samples: u32) -> Vec<[[f32; 3]; 2]> {
    let of_pixel = |pixel: &[f64]| {
        let mean = |kept: usize| {
            [0, 1, 2].map(|channel| {
                let all = pixel[channel * replicates * slots..][..replicates * slots].chunks(slots);
                let sum: f64 = all.map(|s| s[..kept].iter().sum::<f64>()).sum();
                (sum / f64::from(samples)) as f32
            })
        };
        [mean(slots), mean(1)]
    };
    sums.chunks(3 * replicates * slots).map(of_pixel).collect()
}

/// Records the moments of the slot values of one path. The key must give independent points, because only then is the mean
/// of the product of two samples the product of their means. Each replicate gets a contiguous range of the samples. Returns
/// nothing if `progress` is stopped before the end, because half an image has other moments. Also returns nothing for
/// estimators that splat, because their paths belong to no pixel.
pub fn record<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    amount: Amount,
    progress: Progress<'_>,
) -> Option<Recorded> {
    if estimator.splats() {
        return None;
    }
    let started = Instant::now();
    let (slots, [w, h]) = (estimator.slots(), sensor.size());
    let replicates = (amount.replicates as u32).clamp(1, amount.spp.max(1));
    let start = |r: u32| (u64::from(r) * u64::from(amount.spp) / u64::from(replicates)) as u32;
    let counts: Vec<u32> = (0..replicates).map(|r| start(r + 1) - start(r)).collect();

    let job = |paths: &mut Paths<T::Wave>, first: u32| {
        let pixels = first..(first + BLOCK as u32).min(w * h);
        let count = pixels.len();
        let mut sums = Sums::new(slots, counts.clone());
        // S_a, the sum of slot a, by pixel, channel, replicate
        let per_channel = counts.len() * slots;
        let mut pixel_sums = vec![0.0; count * 3 * per_channel];
        let mut wave = Wave { first, pixels: count as u32, sample: 0, slots, values: vec![], rays: vec![0; slots] };
        for r in 0..counts.len() {
            wave.rays.fill(0);
            let of_replicate = start(r as u32)..start(r as u32 + 1);
            for s in of_replicate.clone().step_by(AT_ONCE as usize) {
                let samples = s..(s + AT_ONCE).min(of_replicate.end);
                wave.sample = s;
                wave.values.clear();
                wave.values.resize(samples.len() * count * 3 * slots, 0.0);
                let batch = &Batch { key: amount.key, pixels: pixels.clone(), samples };
                estimator.sample(&Job { t, sensor, batch }, paths, &mut wave);
                for (i, y) in wave.values.chunks(slots).enumerate() {
                    let (path, channel) = (i / 3, i % 3);
                    sums.path(r, channel, y);
                    let at = ((path % count) * 3 + channel) * per_channel + r * slots;
                    pixel_sums[at..at + slots].iter_mut().zip(y).for_each(|(s, y)| *s += y);
                    sums.non_finite += u64::from(channel == 0 && y.iter().any(|y| !y.is_finite()));
                }
            }
            sums.rays[r * slots..(r + 1) * slots].copy_from_slice(&wave.rays);
        }
        for (i, s) in pixel_sums.chunks(per_channel).enumerate() {
            sums.pixel(i % 3, s);
        }
        sums.pixels = count as u64;
        progress.advance(count as u64 * u64::from(amount.spp));
        (sums, means(&pixel_sums, slots, counts.len(), start(replicates)))
    };

    let blocks: Vec<u32> = (0..w * h).step_by(BLOCK).collect();
    let mut all = Sums::new(slots, counts.clone());
    let (mut image, mut emission) = (vec![], vec![]);
    for some in blocks.chunks(SIDE_BY_SIDE) {
        if progress.stopped() {
            return None;
        }
        let done: Vec<_> = some.par_iter().map_init(Paths::default, |paths, &first| job(paths, first)).collect();
        for (sums, means) in done {
            all.add(&sums);
            image.extend(means.iter().map(|m| m[0]));
            emission.extend(means.iter().map(|m| m[1]));
        }
    }
    Some(Recorded { image, emission, ..all.moments(started.elapsed().as_secs_f64()) })
}
