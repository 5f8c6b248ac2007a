//! Scatter of the replicates of a film: variance, squared error, and the standard errors of both.
//!
//! ```text
//! x_r = R S_r / N      m = mean of the x_r      q_r = ⟨(x_r − m)²⟩      V = Σ q_r / (R(R−1))
//! MSE = ⟨(m − X)²⟩ − ⟨se_X²⟩                    se² = (R−1)/R · Σ_i (θ_(i) − θ̄_(·))²
//! ```
//!
//! Here ⟨ ⟩ is the mean over pixels and channels, S_r the sum of replicate r, N the number of samples of a pixel, and θ_(i)
//! the estimate without replicate i, scaled to the same R. Pixels and channels of one replicate may depend on each other
//! (colours of one path, splats, Sobol points), and samples may have heavy tails. Leaving out whole replicates accounts for
//! all of this; a formula for independent normal pixels would not.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of the mean, averaged over pixels and channels; unbiased | [`Scatter::variance`] |
//! | X, se_X | a reference with its own independent error | [`Scatter::of`] |
//! | MSE | bias² + V; unbiased, so it may be negative | [`Scatter::squared_error`] |
//! | θ_(i) | the estimate without replicate i | [`Scatter::variance_without`], [`Scatter::squared_error_without`] |
//!
//! The error of MSE holds for this one reference. The noise of the reference adds [`Scatter::reference_error`], which is the
//! same for every number of samples. Reference: Efron and Stein, *Annals of Statistics* 9 (1981), the jackknife.

use super::TermImage;
use super::deviations::{Deviations, Piece, bands};
use super::film::{Shape, TermFilm};
use super::largest::Largest;
use glam::DVec3;
use pulp::{Arch, Simd};
use rayon::prelude::*;
use std::ops::Range;

/// Scatter of the replicates of a sum of slots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scatter {
    /// q_r, by replicate.
    pub q: Vec<f64>,
    /// V per channel.
    pub channels: DVec3,
    /// ⟨(x_r − m)(m − X)⟩, by replicate; empty without a reference.
    cross: Vec<f64>,
    /// Mean square error of the image m against the reference X: ⟨(m − X)²⟩ − ⟨se_X²⟩, averaged over pixels, where the second
    /// term removes the noise of the reference; NaN without a reference.
    error: f64,
    /// Standard error of the mean square error that comes from the noise of the reference image.
    pub reference_error: f64,
    /// (Σ x²)²/Σ x⁴ over all contributions x: the number of equal events that would determine V as well.
    pub events: f64,
}

/// Sums over some pixels.
#[derive(Clone)]
pub(super) struct Sums {
    /// The sum of the [rows](Row) of some pieces.
    row: Vec<f64>,
    cross: Vec<f64>,
    square: f64,
    noise: f64,
    noise_squared: f64,
}

/// What a snapshot needs of one piece and one sum of slots, as `R + 4` numbers: Σ d_r² by replicate, where x_r − m = R d_r; the same
/// over all replicates by channel; Σ x² of all contributions. Rows of pieces are added in the order of the pieces, so that parts of
/// a film rendered apart give the same bits.
#[derive(Default)]
pub(super) struct Row {
    /// Σ d_r² by replicate, in 24 interleaved parts: eight pixels of three channels.
    lanes: Vec<[f64; LANES]>,
}

const LANES: usize = 24;

/// Length of a row.
pub(super) fn row_length(replicates: usize) -> usize {
    replicates + 4
}

impl Row {
    /// Writes the row of a piece; `added` is Σ x² of its contributions to these slots.
    pub(super) fn write(&mut self, d: &Deviations, added: f64, row: &mut [f64]) {
        let replicates = d.replicates;
        self.lanes.clear();
        self.lanes.resize(replicates, [0.0; LANES]);
        squares(&d.of, &mut self.lanes);
        row.fill(0.0);
        for (r, lanes) in self.lanes.iter().enumerate() {
            for rgb in lanes.as_chunks::<3>().0 {
                row[r] += rgb[0] + rgb[1] + rgb[2];
                for c in 0..3 {
                    row[replicates + c] += rgb[c];
                }
            }
        }
        row[replicates + 3] = added;
    }
}

impl Scatter {
    /// Scatter of the sum over some slots. `reference` is an image of the same quantity from an independent stream.
    ///
    /// Needs at least one sample per replicate and pixel.
    pub fn of(film: &TermFilm, slots: Range<usize>, reference: Option<&TermImage>) -> Self {
        let replicates = film.shape.replicates;
        let band = |pixels: Range<usize>| {
            let (mut sums, mut d) = (Sums::new(replicates, reference.is_some()), Deviations::default());
            let (mut row, mut numbers) = (Row::default(), vec![0.0; row_length(replicates)]);
            for piece in Piece::all(film, pixels) {
                d.begin(&piece);
                d.slots(&piece, slots.clone());
                row.write(&d, slots.clone().map(|s| piece.squares(s).sum::<f64>()).sum(), &mut numbers);
                sums.add(&numbers);
                if let Some(x) = reference {
                    sums.compare(&piece, &d, x);
                }
            }
            sums
        };
        let parts: Vec<Sums> = bands(film.shape).into_par_iter().map(band).collect();
        Sums::scatter(parts.iter(), film.shape, &film.largest[slots])
    }

    /// R, the number of replicates.
    pub fn replicates(&self) -> usize {
        self.q.len()
    }

    /// V; NaN with one replicate.
    pub fn variance(&self) -> f64 {
        let n = self.q.len() as f64;
        self.q.iter().sum::<f64>() / (n * (n - 1.0))
    }

    /// V of R replicates, estimated without replicate `i`; NaN with fewer than three.
    pub fn variance_without(&self, i: usize) -> f64 {
        let n = self.q.len() as f64;
        (self.q.iter().sum::<f64>() - self.q[i] * n / (n - 1.0)) / (n * (n - 2.0))
    }

    /// Standard error of V; NaN with fewer than three replicates.
    pub fn variance_error(&self) -> f64 {
        jackknife((0..self.q.len()).map(|i| self.variance_without(i)))
    }

    /// MSE, if there is a reference.
    pub fn squared_error(&self) -> Option<f64> {
        (!self.cross.is_empty()).then_some(self.error)
    }

    /// MSE of R replicates without replicate `i`. NaN without a reference.
    pub fn squared_error_without(&self, i: usize) -> f64 {
        let Some(cross) = self.cross.get(i) else { return f64::NAN };
        let n = self.q.len() as f64;
        // deviation of the mean without replicate i from X; its variance is that of R − 1 replicates
        let about = self.error - 2.0 * cross / (n - 1.0) + self.q[i] / ((n - 1.0) * (n - 1.0));
        about - self.variance_without(i) * (n / (n - 1.0) - 1.0)
    }

    /// Standard error of MSE, including that of the reference. NaN without a reference.
    pub fn squared_error_error(&self) -> f64 {
        jackknife((0..self.q.len()).map(|i| self.squared_error_without(i))).hypot(self.reference_error)
    }
}

/// Jackknife standard error `√((R−1)/R · Σ (θ_(i) − θ̄)²)` from estimates that each leave out one replicate.
///
/// ```
/// // for a mean it is the usual standard error: √(Σ(x−x̄)²/(n(n−1)))
/// let x = [1.0, 2.0, 4.0, 5.0];
/// let without = x.iter().map(|xi| (12.0 - xi) / 3.0);
/// assert!((fredholm::terms::scatter::jackknife(without) - (10.0f64 / 12.0).sqrt()).abs() < 1e-15);
/// ```
pub fn jackknife(without: impl Iterator<Item = f64>) -> f64 {
    let all: Vec<f64> = without.collect();
    let n = all.len() as f64;
    let mean = all.iter().sum::<f64>() / n;
    let spread: f64 = all.iter().map(|x| (x - mean) * (x - mean)).sum();
    (spread * (n - 1.0) / n).sqrt()
}

impl Sums {
    /// Nothing yet; `compared` with a reference or not.
    pub(super) fn new(replicates: usize, compared: bool) -> Self {
        Self {
            row: vec![0.0; row_length(replicates)],
            cross: vec![0.0; if compared { replicates } else { 0 }],
            square: 0.0,
            noise: 0.0,
            noise_squared: 0.0,
        }
    }

    /// Adds the row of a piece.
    pub(super) fn add(&mut self, row: &[f64]) {
        self.row.iter_mut().zip(row).for_each(|(a, b)| *a += b);
    }

    /// Adds the differences of a piece from a reference.
    fn compare(&mut self, piece: &Piece<'_>, d: &Deviations, x: &TermImage) {
        let rgb = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        for (i, p) in piece.pixels.clone().enumerate() {
            let mean = DVec3::from_slice(&d.mean[3 * i..]);
            let (off, error) = (mean - rgb(x.mean[p]), rgb(x.std_error[p]));
            let noise = error.length_squared();
            for (r, cross) in self.cross.iter_mut().enumerate() {
                *cross += DVec3::from_slice(&d.replicate(r)[3 * i..]).dot(off);
            }
            self.square += off.length_squared();
            self.noise += noise;
            self.noise_squared += noise * noise;
        }
    }

    /// The scatter of a film from the sums over its bands, added in their order, and the largest contributions to its slots.
    pub(super) fn scatter<'a>(mut bands: impl Iterator<Item = &'a Self>, shape: Shape, slots: &[Largest]) -> Scatter {
        let (replicates, pixels) = (shape.replicates, shape.pixels() as f64);
        let n = replicates as f64;
        let first = bands.next().cloned().unwrap_or_else(|| Self::new(replicates, false));
        let s = bands.fold(first, |a, b| a.plus(b));
        let count = 3.0 * pixels;
        let mut largest = Largest::default();
        slots.iter().for_each(|slot| largest.merge(slot));
        Scatter {
            q: s.row[..replicates].iter().map(|q| q * n * n / count).collect(),
            channels: DVec3::from_slice(&s.row[replicates..]) * n / (pixels * (n - 1.0)),
            cross: s.cross.iter().map(|x| x * n / count).collect(),
            error: if s.cross.is_empty() { f64::NAN } else { (s.square - s.noise) / count },
            // error of the reference: scatter of |e|² and of se² over the pixels, for normal errors, fully correlated
            // channels and independent pixels
            reference_error: (2.0 * s.noise_squared * (1.0 + 1.0 / (n - 1.0))).sqrt() / count,
            events: largest.spread(s.row[replicates + 3]),
        }
    }

    fn plus(mut self, other: &Self) -> Self {
        self.add(&other.row);
        self.cross.iter_mut().zip(&other.cross).for_each(|(a, b)| *a += b);
        self.square += other.square;
        self.noise += other.noise;
        self.noise_squared += other.noise_squared;
        self
    }
}

/// Adds the squares of the deviations, replicate by replicate. Interleaved parts have an order that does not depend on the
/// width of the vector registers.
#[pulp::with_simd(squares = Arch::new())]
#[inline(always)]
fn squares_with_simd<'a, S: Simd>(_simd: S, deviations: &'a [f64], sums: &'a mut [[f64; LANES]]) {
    let width = deviations.len() / sums.len();
    for (row, sums) in deviations.chunks_exact(width).zip(sums) {
        let (blocks, rest) = row.as_chunks::<LANES>();
        let mut s = *sums;
        for block in blocks {
            for l in 0..LANES {
                s[l] += block[l] * block[l];
            }
        }
        rest.iter().zip(&mut s).for_each(|(d, s)| *s += d * d);
        *sums = s;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::Rgb;

    /// A film of two pixels with `replicates` known replicate means and two samples each; replicate `skip` is left out.
    fn film(replicates: usize, skip: Option<usize>) -> TermFilm {
        let kept: Vec<usize> = (0..replicates).filter(|&r| Some(r) != skip).collect();
        let mut film = TermFilm::new(Shape { size: [2, 1], slots: 1, replicates: kept.len() });
        for (place, &r) in kept.iter().enumerate() {
            for (pixel, half) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let x = ((r * r * 7 + r * 3 + half + 5 * pixel as usize) % 11) as f32;
                film.splat(0, pixel, (place + half * kept.len()) as u32, Rgb::new(x, 0.5 * x, 1.0));
            }
        }
        film.samples = vec![2 * kept.len() as u32; 2];
        film
    }

    fn reference() -> TermImage {
        TermImage { mean: vec![[4.0, 2.0, 1.0], [5.0, 3.0, 1.0]], std_error: vec![[0.1, 0.2, 0.0], [0.3, 0.0, 0.0]] }
    }

    #[test]
    fn leaving_out_is_what_a_film_without_that_replicate_says() {
        let (r, x) = (6, reference());
        let all = Scatter::of(&film(r, None), 0..1, Some(&x));
        for i in 0..r {
            let less = Scatter::of(&film(r, Some(i)), 0..1, Some(&x));
            // variances of the mean of R and of R − 1 replicates
            let v = less.variance() * (r as f64 - 1.0) / r as f64;
            assert!((all.variance_without(i) / v - 1.0).abs() < 1e-12, "{i}");
            let mse = less.squared_error().unwrap() - less.variance() + v;
            assert!((all.squared_error_without(i) - mse).abs() < 1e-12, "{i}");
        }
    }

    #[test]
    fn the_variance_is_the_mean_square_of_the_errors_of_the_pixels() {
        let film = film(5, None);
        let s = Scatter::of(&film, 0..1, None);
        let pixels: DVec3 = (0..2).map(|p| film.pixel(p, 0..1).1.powf(2.0)).sum::<DVec3>() / 2.0;
        assert!((s.channels - pixels).length() < 1e-14);
        assert!((s.variance() - pixels.element_sum() / 3.0).abs() < 1e-14);
        assert!(s.squared_error().is_none() && s.squared_error_error().is_nan());
    }
}
