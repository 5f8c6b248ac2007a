//! Linear functionals of a film: the image mean, 16 region means, 8 fixed ±1 projections.
//!
//! `φ(X) = Σ_p w_p X_p`. Aggregation is what buys power: a mean over all pixels sees a bias that no single pixel can, the
//! regions say where, and the projections catch what is moved about without changing any mean.
//!
//! All are built from the sums over a 16 × 16 grid of tiles, so a pixel is read once.

use super::film::TermFilm;
use super::series::{Estimate, Functional};
use crate::math::{Key, Purpose, Rng};
use glam::DVec3;

const GRID: usize = 16;
const REGIONS: usize = 4;
const PROJECTIONS: u32 = 8;

/// The terms of one functional, replicate by replicate.
#[derive(Clone, Debug)]
pub struct Replicates {
    /// Mean of each slot.
    pub mean: Vec<DVec3>,
    /// `deviation[r][slot] = Σ_p w_p (S_r − n_r m)/N`; they sum to 0 over r.
    pub deviation: Vec<Vec<DVec3>>,
}

impl Replicates {
    /// The estimate of a sum of slots.
    pub fn estimate(&self, slots: std::ops::Range<usize>) -> Estimate {
        let r = self.deviation.len();
        let square = |d: &Vec<DVec3>| d[slots.clone()].iter().sum::<DVec3>().powf(2.0);
        let variance = self.deviation.iter().map(square).sum::<DVec3>() * covariance_factor(r);
        let mean = self.mean[slots.clone()].iter().sum();
        Estimate { mean, std_error: variance.map(f64::sqrt), replicates: r as u64 }
    }

    /// Covariance of the means of two slots, per channel.
    pub fn covariance(&self, a: usize, b: usize) -> DVec3 {
        self.deviation.iter().map(|d| d[a] * d[b]).sum::<DVec3>() * covariance_factor(self.deviation.len())
    }

    /// As the terms, tail, sum and total of a functional; a film with one slot is a path tracer's.
    pub fn functional(&self, name: &str) -> Functional {
        let slots = self.mean.len();
        let k = slots - 1;
        Functional {
            name: name.to_string(),
            terms: (0..k).map(|s| self.estimate(s..s + 1)).collect(),
            tail: if k == 0 { Estimate::default() } else { self.estimate(k..slots) },
            sum: if k == 0 { Estimate::default() } else { self.estimate(0..k) },
            total: self.estimate(0..slots),
            events: vec![],
        }
    }
}

/// `(Σ x)²/Σ x²` over the tiles with a weight: for the terms, the tail, the sum and the total.
fn events(film: &TermFilm, t: &Tiles, inside: impl Fn(usize) -> bool) -> Vec<f64> {
    let slots = film.shape.slots;
    let over = |slots_of: std::ops::Range<usize>| {
        let tiles = (0..GRID * GRID).filter(|&i| inside(i));
        let (sum, square) = tiles
            .flat_map(|i| slots_of.clone().map(move |s| i * slots + s))
            .fold((0.0, 0.0), |a, at| (a.0 + t.sum[at], a.1 + t.square[at]));
        if square > 0.0 { sum * sum / square } else { 0.0 }
    };
    let last = slots - 1;
    if last == 0 {
        return vec![0.0, 0.0, over(0..1)];
    }
    (0..slots).map(|s| over(s..s + 1)).chain([over(0..last), over(0..slots)]).collect()
}

fn covariance_factor(replicates: usize) -> f64 {
    // 0/0 for one replicate: its error is not known
    let r = replicates as f64;
    if replicates == 1 { f64::NAN } else { r / (r - 1.0) }
}

/// Per tile of the grid, slot and replicate: Σ_p m_p and Σ_p (S_r − n_r m_p)/N.
struct Tiles {
    pixels: Vec<f64>,
    mean: Vec<DVec3>,
    deviation: Vec<DVec3>,
    /// Σ (r + g + b) and Σ (r + g + b)² of all that was added.
    sum: Vec<f64>,
    square: Vec<f64>,
}

fn tiles(film: &TermFilm) -> Tiles {
    let (slots, replicates) = (film.shape.slots, film.shape.replicates);
    let [w, h] = film.shape.size.map(|s| s as usize);
    let mut t = Tiles {
        pixels: vec![0.0; GRID * GRID],
        mean: vec![DVec3::ZERO; GRID * GRID * slots],
        deviation: vec![DVec3::ZERO; GRID * GRID * slots * replicates],
        sum: vec![0.0; GRID * GRID * slots],
        square: vec![0.0; GRID * GRID * slots],
    };
    for p in 0..w * h {
        let tile = (p / w) * GRID / h * GRID + (p % w) * GRID / w;
        let n = f64::from(film.samples[p]);
        t.pixels[tile] += 1.0;
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
    t
}

/// The image mean alone, replicate by replicate.
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
    Replicates {
        mean: (0..slots).map(mean).collect(),
        deviation: (0..replicates).map(|r| (0..slots).map(|s| deviation(r, s)).collect()).collect(),
    }
}

/// The same functionals of images that are known without error: `slots[s][pixel]`, the terms k = 0..=K and the tail.
pub fn exact_functionals(size: [u32; 2], slots: &[Vec<DVec3>]) -> Vec<Functional> {
    let mut all = functionals(&TermFilm::exact(size, slots));
    for f in &mut all {
        f.terms.iter_mut().chain([&mut f.tail, &mut f.sum, &mut f.total]).for_each(|e| *e = Estimate::exact(e.mean));
        f.events.clear();
    }
    all
}

/// Image mean, region means and projections of a film, in that order.
pub fn functionals(film: &TermFilm) -> Vec<Functional> {
    let t = tiles(film);
    let pixels = film.shape.pixels() as f64;
    let everywhere = events(film, &t, |_| true);
    let image = weighted(film, &t, |_| 1.0, pixels).functional("image");
    let mut all = vec![Functional { events: everywhere.clone(), ..image }];
    let step = GRID / REGIONS;
    for (row, column) in (0..REGIONS).flat_map(|y| (0..REGIONS).map(move |x| (y, x))) {
        let inside = |i: usize| i / GRID / step == row && i % GRID / step == column;
        let count: f64 = (0..GRID * GRID).filter(|&i| inside(i)).map(|i| t.pixels[i]).sum();
        if count > 0.0 {
            let name = format!("region {row},{column}");
            let region = weighted(film, &t, |i| if inside(i) { 1.0 } else { 0.0 }, count).functional(&name);
            all.push(Functional { events: events(film, &t, inside), ..region });
        }
    }
    let key = Key::new(0, "projections");
    for j in 0..PROJECTIONS {
        let sign = |i: usize| if Rng::at(key, i as u32, j, 0, Purpose::Start).one() < 0.5 { -1.0 } else { 1.0 };
        let projection = weighted(film, &t, sign, pixels).functional(&format!("projection {j}"));
        all.push(Functional { events: everywhere.clone(), ..projection });
    }
    all
}
