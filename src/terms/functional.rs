//! Linear functionals of a film: the image mean, 16 region means, 8 fixed ±1 projections.
//!
//! `φ(X) = Σ_p w_p X_p`, a weighted sum over the pixels p. Averages give statistical power: a mean over all pixels shows a
//! bias that no single pixel can show. The region means show where the bias is. The projections detect light that is only
//! moved within the image, which changes no mean.
//!
//! All are built from sums over a 16 × 16 grid of tiles, so each pixel is read only once.
//!
//! ```text
//! few replicates, pixels that share no path:     se² = Σ_p w_p² se_p²,     dof = (R − 1) (Σ_p w_p² se_p²)² / Σ_p w_p⁴ se_p⁴
//! ```
//!
//! Two or three replicates of the whole image may agree by chance, so their scatter says little about the error. But each
//! pixel has its own error se_p from R replicates, and together the pixels determine the error much better (Satterthwaite,
//! *Biometrics Bulletin* 2, 1946).

use super::film::TermFilm;
use super::largest::Largest;
use super::series::{Estimate, Events, Functional};
use crate::math::{Key, Purpose, Rng};
use glam::DVec3;
use std::ops::Range;

const GRID: usize = 16;
const REGIONS: usize = 4;
const PROJECTIONS: u32 = 8;
/// With fewer replicates than this, errors come from the pixels.
const REPLICATES: usize = 8;

/// The slots of one functional, replicate by replicate.
#[derive(Clone, Debug)]
pub struct Replicates {
    /// Mean of each slot.
    pub mean: Vec<DVec3>,
    /// `deviation[r][slot] = Σ_p w_p (S_r − n_r m)/N`; the sum over r is 0.
    pub deviation: Vec<Vec<DVec3>>,
    /// Sums from which the events of each slot follow; empty if they were not counted.
    pub counted: Vec<Counted>,
}

/// Sums over the contributions x = r + g + b to one slot. [`Events`] follow from them, also for several slots together.
#[derive(Clone, Debug, Default)]
pub struct Counted {
    /// Σ x.
    pub sum: f64,
    /// Σ x².
    pub square: f64,
    /// Data of the slot over the whole image.
    pub all: Whole,
}

/// Data of a slot that is known only for the whole image: Σ x² and the largest contributions.
#[derive(Clone, Debug, Default)]
pub struct Whole {
    square: f64,
    largest: Largest,
}

/// The events of several slots together.
fn events(slots: &[Counted]) -> Option<Events> {
    let first = slots.first()?;
    let (sum, square) = slots.iter().fold((0.0, 0.0), |a, c| (a.0 + c.sum, a.1 + c.square));
    let (mut largest, mut everywhere) = (first.all.largest.clone(), first.all.square);
    for c in &slots[1..] {
        largest.merge(&c.all.largest);
        everywhere += c.all.square;
    }
    let mean = if square > 0.0 { sum * sum / square } else { 0.0 };
    Some(Events { mean, variance: largest.spread(everywhere), tail: largest.tail() })
}

impl Replicates {
    /// The estimate of the sum of some slots.
    pub fn estimate(&self, slots: Range<usize>) -> Estimate {
        let r = self.deviation.len();
        let square = |d: &Vec<DVec3>| d[slots.clone()].iter().sum::<DVec3>().powf(2.0);
        let variance = self.deviation.iter().map(square).sum::<DVec3>() * covariance_factor(r);
        let mean = self.mean[slots.clone()].iter().sum();
        let events = self.counted.get(slots.clone()).and_then(events);
        Estimate { mean, std_error: variance.map(f64::sqrt), replicates: r as u64, events }
    }

    /// Covariance of the means of two slots, per channel.
    pub fn covariance(&self, a: usize, b: usize) -> DVec3 {
        self.deviation.iter().map(|d| d[a] * d[b]).sum::<DVec3>() * covariance_factor(self.deviation.len())
    }

    /// The terms, tail, sum and total as a functional. If there is one slot only, it is that of a path tracer.
    pub fn functional(&self, name: &str) -> Functional {
        let slots = self.mean.len();
        let k = slots - 1;
        Functional {
            name: name.to_string(),
            terms: (0..k).map(|s| self.estimate(s..s + 1)).collect(),
            tail: if k == 0 { Estimate::default() } else { self.estimate(k..slots) },
            sum: if k == 0 { Estimate::default() } else { self.estimate(0..k) },
            total: self.estimate(0..slots),
        }
    }
}

fn covariance_factor(replicates: usize) -> f64 {
    // 0/0 for one replicate: its error is unknown
    let r = replicates as f64;
    if replicates == 1 { f64::NAN } else { r / (r - 1.0) }
}

/// Per tile of the grid, slot and replicate: Σ_p m_p and Σ_p (S_r − n_r m_p)/N.
struct Tiles {
    pixels: Vec<f64>,
    /// Filled if replicates are few and pixels share no path: Σ_p se_p² and Σ_p se_p⁴ of the terms, the tail, the sum and
    /// the total.
    noise: Vec<[DVec3; 2]>,
    /// Data of each slot over the whole image.
    whole: Vec<Whole>,
    mean: Vec<DVec3>,
    deviation: Vec<DVec3>,
    /// Σ (r + g + b), and below Σ (r + g + b)², of all contributions.
    sum: Vec<f64>,
    square: Vec<f64>,
}

fn tiles(film: &TermFilm) -> Tiles {
    let (slots, replicates) = (film.shape.slots, film.shape.replicates);
    let [w, h] = film.shape.size.map(|s| s as usize);
    let mut t = Tiles {
        pixels: vec![0.0; GRID * GRID],
        noise: vec![],
        whole: vec![],
        mean: vec![DVec3::ZERO; GRID * GRID * slots],
        deviation: vec![DVec3::ZERO; GRID * GRID * slots * replicates],
        sum: vec![0.0; GRID * GRID * slots],
        square: vec![0.0; GRID * GRID * slots],
    };
    let parts = parts(slots);
    let by_pixels = (2..REPLICATES).contains(&replicates) && !film.shared;
    if by_pixels {
        t.noise = vec![[DVec3::ZERO; 2]; GRID * GRID * parts.len()];
    }
    for p in 0..w * h {
        let tile = (p / w) * GRID / h * GRID + (p % w) * GRID / w;
        let n = f64::from(film.samples[p]);
        t.pixels[tile] += 1.0;
        for (at, part) in parts.iter().enumerate().filter(|_| by_pixels) {
            let v = film.pixel(p, part.clone()).1.powf(2.0);
            let noise = &mut t.noise[tile * parts.len() + at];
            *noise = [noise[0] + v, noise[1] + v * v];
        }
        for s in 0..slots {
            let mean = (0..replicates).map(|r| film.sum(p, r, s)).sum::<DVec3>() / n;
            t.mean[tile * slots + s] += mean;
            t.sum[tile * slots + s] += mean.element_sum() * n;
            t.square[tile * slots + s] += film.square(p, s);
            let at = (tile * slots + s) * replicates;
            for (r, d) in t.deviation[at..at + replicates].iter_mut().enumerate() {
                *d += (film.sum(p, r, s) - mean * film.count(p, r)) / n;
            }
        }
    }
    let square = |s: usize| (0..GRID * GRID).map(|i| t.square[i * slots + s]).sum();
    t.whole = (0..slots).map(|s| Whole { square: square(s), largest: film.largest[s].clone() }).collect();
    t
}

/// The slot ranges of the terms, the tail, the sum and the total, in this order; a single slot gives only its own range.
fn parts(slots: usize) -> Vec<Range<usize>> {
    let single = (0..slots).map(|s| s..s + 1);
    if slots == 1 { single.collect() } else { single.chain([0..slots - 1, 0..slots]).collect() }
}

/// The image mean, replicate by replicate.
pub fn image_replicates(film: &TermFilm) -> Replicates {
    weighted(film, &tiles(film), |_| 1.0, film.shape.pixels() as f64)
}

fn weighted(film: &TermFilm, t: &Tiles, weight: impl Fn(usize) -> f64, total: f64) -> Replicates {
    let (slots, replicates) = (film.shape.slots, film.shape.replicates);
    let tiles: Vec<(usize, f64)> = (0..GRID * GRID).map(|i| (i, weight(i))).filter(|w| w.1 != 0.0).collect();
    let mean = |s: usize| tiles.iter().map(|&(i, w)| t.mean[i * slots + s] * w).sum::<DVec3>() / total;
    let deviation = |r: usize, s: usize| {
        tiles.iter().map(|&(i, w)| t.deviation[(i * slots + s) * replicates + r] * w).sum::<DVec3>() / total
    };
    let counted = |s: usize| {
        let add = |of: &[f64]| tiles.iter().map(|&(i, _)| of[i * slots + s]).sum();
        Counted { sum: add(&t.sum), square: add(&t.square), all: t.whole[s].clone() }
    };
    Replicates {
        mean: (0..slots).map(mean).collect(),
        deviation: (0..replicates).map(|r| (0..slots).map(|s| deviation(r, s)).collect()).collect(),
        counted: (0..slots).map(counted).collect(),
    }
}

/// The same as `weighted`, as a functional, with errors from the pixels where replicates are few.
fn functional(film: &TermFilm, t: &Tiles, weight: impl Fn(usize) -> f64, total: f64, name: &str) -> Functional {
    let mut found = weighted(film, t, &weight, total).functional(name);
    if t.noise.is_empty() {
        return found;
    }
    let parts = parts(film.shape.slots).len();
    let of = |part: usize| {
        let add = |a: [DVec3; 2], i: usize| {
            let (w2, v) = ((weight(i) / total).powi(2), t.noise[i * parts + part]);
            [a[0] + w2 * v[0], a[1] + w2 * w2 * v[1]]
        };
        (0..GRID * GRID).fold([DVec3::ZERO; 2], add)
    };
    let single = (film.shape.replicates - 1) as f64;
    let known = |e: &mut Estimate, [v, v2]: [DVec3; 2]| {
        e.std_error = v.map(f64::sqrt);
        let dof = (0..3).filter(|&c| v2[c] > 0.0).map(|c| single * v[c] * v[c] / v2[c]);
        let least = dof.fold(f64::INFINITY, f64::min);
        e.replicates = 1 + if least.is_finite() { least.max(single) as u64 } else { single as u64 };
    };
    match film.shape.slots {
        1 => known(&mut found.total, of(0)),
        _ => found.made_of(0).enumerate().for_each(|(part, e)| known(e, of(part))),
    }
    found
}

/// The same functionals for images known without error: `slots[s][pixel]`, the terms k = 0..=K and the tail.
pub fn exact_functionals(size: [u32; 2], slots: &[Vec<DVec3>]) -> Vec<Functional> {
    let mut all = functionals(&TermFilm::exact(size, slots));
    for f in &mut all {
        f.made_of(0).for_each(|e| *e = Estimate::exact(e.mean));
    }
    all
}

/// Image mean, region means and projections of a film, in that order.
pub fn functionals(film: &TermFilm) -> Vec<Functional> {
    let t = tiles(film);
    let pixels = film.shape.pixels() as f64;
    let mut all = vec![functional(film, &t, |_| 1.0, pixels, "image")];
    let step = GRID / REGIONS;
    for (row, column) in (0..REGIONS).flat_map(|y| (0..REGIONS).map(move |x| (y, x))) {
        let inside = |i: usize| i / GRID / step == row && i % GRID / step == column;
        let count: f64 = (0..GRID * GRID).filter(|&i| inside(i)).map(|i| t.pixels[i]).sum();
        if count > 0.0 {
            let weight = |i: usize| if inside(i) { 1.0 } else { 0.0 };
            all.push(functional(film, &t, weight, count, &format!("region {row},{column}")));
        }
    }
    let key = Key::new(0, "projections");
    for j in 0..PROJECTIONS {
        let sign = |i: usize| if Rng::at(key, i as u32, j, 0, Purpose::Start).one() < 0.5 { -1.0 } else { 1.0 };
        all.push(functional(film, &t, sign, pixels, &format!("projection {j}")));
    }
    all
}
