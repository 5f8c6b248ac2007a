//! Covariance between the slots of one path, averaged over the image.
//!
//! ```text
//! C_ab = n ⟨Cov(m_a, m_b)⟩ = n/(R(R−1)) Σ_r ⟨(x_ra − m_a)(x_rb − m_b)⟩
//! 1ᵀC1 = variance of one sample of the sum          trace C = what it would be if the slots were independent
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | C | covariance of one sample, by pair of slots, averaged (⟨ ⟩) over pixels and channels | [`Covariance::entry`] |
//! | n | samples per pixel | [`covariance`] |
//! | R, x_r, m | number of replicates, mean of replicate r, mean of all samples | [`scatter`](super::scatter) |

use super::film::TermFilm;
use super::scatter::jackknife;
use glam::DVec3;
use rayon::prelude::*;

/// C, kept replicate by replicate so that its own error is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariance {
    /// Number of slots.
    pub slots: usize,
    /// `n ⟨(x_ra − m_a)(x_rb − m_b)⟩`, row by row, by replicate.
    products: Vec<Vec<f64>>,
}

/// Computes C of a film. Every pixel must hold the same number of samples.
pub fn covariance(film: &TermFilm) -> Covariance {
    let (pixels, slots, replicates) = (film.shape.pixels(), film.shape.slots, film.shape.replicates);
    let zero = || vec![vec![0.0; slots * slots]; replicates];
    // chunks of a fixed size, added in order: the same bits for any number of threads
    let chunk = |c: usize| {
        let mut products = zero();
        let mut d = vec![DVec3::ZERO; slots];
        for p in c * 256..((c + 1) * 256).min(pixels) {
            let samples = f64::from(film.samples[p]);
            let mean = |s: usize| (0..replicates).map(|r| film.sum(p, r, s)).sum::<DVec3>() / samples;
            let means: Vec<DVec3> = (0..slots).map(mean).collect();
            for (r, of) in products.iter_mut().enumerate() {
                let scale = replicates as f64 / samples;
                (0..slots).for_each(|s| d[s] = (film.sum(p, r, s) - means[s] * film.count(p, r)) * scale);
                for a in 0..slots {
                    (0..slots).for_each(|b| of[a * slots + b] += d[a].dot(d[b]));
                }
            }
        }
        products
    };
    let parts: Vec<_> = (0..pixels.div_ceil(256)).into_par_iter().map(chunk).collect();
    let mut products = zero();
    for part in parts {
        for (all, more) in products.iter_mut().zip(part) {
            all.iter_mut().zip(more).for_each(|(a, b)| *a += b);
        }
    }
    let scale = f64::from(film.least_samples()) / (3.0 * pixels as f64);
    products.iter_mut().flatten().for_each(|x| *x *= scale);
    Covariance { slots, products }
}

impl Covariance {
    /// The entry C_ab.
    pub fn entry(&self, a: usize, b: usize) -> f64 {
        let r = self.products.len() as f64;
        self.products.iter().map(|q| q[a * self.slots + b]).sum::<f64>() / (r * (r - 1.0))
    }

    /// Standard error of C_ab; NaN with fewer than three replicates.
    pub fn std_error(&self, a: usize, b: usize) -> f64 {
        self.of(|x, y| (x, y) == (a, b)).1
    }

    /// The correlation C_ab / √(C_aa C_bb); NaN where a slot has no variance.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        self.entry(a, b) / (self.entry(a, a) * self.entry(b, b)).sqrt()
    }

    /// 1ᵀC1, the variance of one sample of the sum, with its standard error.
    pub fn sum(&self) -> (f64, f64) {
        self.of(|_, _| true)
    }

    /// trace C, with its standard error.
    pub fn trace(&self) -> (f64, f64) {
        self.of(|a, b| a == b)
    }

    /// The sum over some entries, with its standard error by the jackknife over replicates.
    fn of(&self, keep: impl Fn(usize, usize) -> bool) -> (f64, f64) {
        let (n, r) = (self.slots, self.products.len() as f64);
        let pairs = || (0..n).flat_map(|a| (0..n).map(move |b| (a, b))).filter(|&(a, b)| keep(a, b));
        let q: Vec<f64> = self.products.iter().map(|q| pairs().map(|(a, b)| q[a * n + b]).sum()).collect();
        let all: f64 = q.iter().sum();
        let without = q.iter().map(|q| (all - q * r / (r - 1.0)) / (r * (r - 2.0)));
        (all / (r * (r - 1.0)), jackknife(without))
    }
}
