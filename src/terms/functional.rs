//! Linear functionals of a film: the image mean, 16 region means, 8 fixed ±1 projections.
//!
//! `φ(X) = Σ_p w_p X_p`, a weighted sum over the pixels p. Averages give statistical power: a mean over all pixels shows a
//! bias that no single pixel can show. The region means show where the bias is. The projections detect light that is only
//! moved within the image, which changes no mean.
//!
//! All are built from sums over a 16 × 16 grid of tiles (`terms::tiles`), so each pixel is read only once.
//!
//! ```text
//! few replicates, pixels that share no path:     se² = Σ_p w_p² se_p²,     dof = (R − 1) (Σ_p w_p² se_p²)² / Σ_p w_p⁴ se_p⁴
//! ```
//!
//! Two or three replicates of the whole image may agree by chance, so their scatter says little about the error. But each
//! pixel has its own error se_p from R replicates, and together the pixels determine the error much better (Satterthwaite,
//! *Biometrics Bulletin* 2, 1946).

use super::film::{Shape, TermFilm};
use super::series::{Estimate, Events, Functional};
pub use super::tiles::Whole;
use super::tiles::{GRID, Tiles};
use crate::math::{Key, Purpose, Rng};
use glam::DVec3;
use std::ops::Range;

const REGIONS: usize = 4;
const PROJECTIONS: u32 = 8;

/// The slots of one functional, replicate by replicate.
#[derive(Clone, Debug, Default)]
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

/// The image mean, replicate by replicate.
pub fn image_replicates(film: &TermFilm) -> Replicates {
    image(&Tiles::of(film))
}

/// The image mean, replicate by replicate, from the tiles of a film.
pub(super) fn image(t: &Tiles) -> Replicates {
    weighted(t, |_| 1.0, t.shape.pixels() as f64)
}

fn weighted(t: &Tiles, weight: impl Fn(usize) -> f64, total: f64) -> Replicates {
    let Shape { slots, replicates, .. } = t.shape;
    let mut mean = vec![DVec3::ZERO; slots];
    let mut deviation = vec![DVec3::ZERO; slots * replicates];
    let whole = |all: &Whole| Counted { all: all.clone(), ..Counted::default() };
    let mut counted: Vec<Counted> = t.whole.iter().map(whole).collect();
    for (tile, w) in t.tiles.iter().map(|(i, tile)| (tile, weight(*i))).filter(|t| t.1 != 0.0) {
        mean.iter_mut().zip(&tile.mean).for_each(|(a, m)| *a += *m * w);
        deviation.iter_mut().zip(&tile.deviation).for_each(|(a, d)| *a += *d * w);
        for (c, (sum, square)) in counted.iter_mut().zip(tile.sum.iter().zip(&tile.square)) {
            (c.sum, c.square) = (c.sum + sum, c.square + square);
        }
    }
    mean.iter_mut().for_each(|m| *m /= total);
    let of = |r: usize| (0..slots).map(|s| deviation[s * replicates + r] / total).collect();
    Replicates { mean, deviation: (0..replicates).map(of).collect(), counted }
}

/// The same as `weighted`, as a functional, with errors from the pixels where replicates are few.
fn functional(t: &Tiles, weight: impl Fn(usize) -> f64, total: f64, name: &str) -> Functional {
    let mut found = weighted(t, &weight, total).functional(name);
    if !t.noisy() {
        return found;
    }
    let of = |part: usize| {
        t.tiles.iter().fold([DVec3::ZERO; 2], |a, (i, tile)| {
            let (w2, v) = ((weight(*i) / total).powi(2), tile.noise[part]);
            [a[0] + w2 * v[0], a[1] + w2 * w2 * v[1]]
        })
    };
    let single = (t.shape.replicates - 1) as f64;
    let known = |e: &mut Estimate, [v, v2]: [DVec3; 2]| {
        e.std_error = v.map(f64::sqrt);
        let dof = (0..3).filter(|&c| v2[c] > 0.0).map(|c| single * v[c] * v[c] / v2[c]);
        let least = dof.fold(f64::INFINITY, f64::min);
        e.replicates = 1 + if least.is_finite() { least.max(single) as u64 } else { single as u64 };
    };
    match t.shape.slots {
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
    all(&Tiles::of(film))
}

/// The functionals of [`functionals`], from the tiles of a film.
pub(super) fn all(t: &Tiles) -> Vec<Functional> {
    let pixels = t.shape.pixels() as f64;
    let mut all = vec![functional(t, |_| 1.0, pixels, "image")];
    let step = GRID / REGIONS;
    for (row, column) in (0..REGIONS).flat_map(|y| (0..REGIONS).map(move |x| (y, x))) {
        let inside = |i: usize| i / GRID / step == row && i % GRID / step == column;
        let count: f64 = t.tiles.iter().filter(|(i, _)| inside(*i)).map(|(_, tile)| tile.pixels).sum();
        if count > 0.0 {
            let weight = |i: usize| if inside(i) { 1.0 } else { 0.0 };
            all.push(functional(t, weight, count, &format!("region {row},{column}")));
        }
    }
    let key = Key::new(0, "projections");
    for j in 0..PROJECTIONS {
        let sign = |i: usize| if Rng::at(key, i as u32, j, 0, Purpose::Start).one() < 0.5 { -1.0 } else { 1.0 };
        all.push(functional(t, sign, pixels, &format!("projection {j}")));
    }
    all
}
