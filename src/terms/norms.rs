//! The L2 norm of an image, without the bias of its noise.
//!
//! `E[m̂²] = m² + Var m̂`, so the norm of a noisy image is too large. Products of different replicates r ≠ s have no such
//! term:
//!
//! `‖X‖² ≈ mean over pixels of  Σ_{r≠s} m_r m_s / (R(R−1))`,
//!
//! Here m_r is the mean of replicate r at a pixel. The estimate is unbiased. It may be negative; then only an upper limit of
//! the norm is known. The standard error comes from the jackknife over replicates (Efron and Stein, 1981).

use super::deviations::Deviations;
use super::film::Shape;
use pulp::{Arch, Simd};

/// A squared norm, averaged over pixels and channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquaredNorm {
    /// Unbiased estimate of the mean of X² over pixels and channels.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// Interleaved parts of a sum: their order does not depend on the width of the vector registers.
const LANES: usize = 8;

/// Sums over pixels and channels: C = Σ S², A_r = Σ S m_r, B_r = Σ m_r², with S = Σ_r m_r.
#[derive(Clone)]
pub(super) struct NormSums {
    c: [f64; LANES],
    a: Vec<[f64; LANES]>,
    b: Vec<[f64; LANES]>,
}

impl NormSums {
    pub(super) fn new(replicates: usize) -> Self {
        let zero = [0.0; LANES];
        Self { c: zero, a: vec![zero; replicates], b: vec![zero; replicates] }
    }

    /// Adds a piece. `means` is working memory.
    pub(super) fn piece(&mut self, d: &Deviations, means: &mut Vec<f64>) {
        means.resize(d.of.len() + d.mean.len(), 0.0);
        products(d, means, self);
    }

    fn plus(mut self, other: &Self) -> Self {
        let own = [&mut self.c].into_iter().chain(&mut self.a).chain(&mut self.b);
        for (a, b) in own.zip([&other.c].into_iter().chain(&other.a).chain(&other.b)) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
        self
    }

    /// The squared norm of an image from the sums over its bands. Needs three replicates with equal numbers of samples; None if
    /// there are fewer.
    pub(super) fn norm<'a>(
        bands: impl Iterator<Item = &'a Self>,
        Shape { size: [w, h], replicates: r, .. }: Shape,
    ) -> Option<SquaredNorm> {
        if r < 3 {
            return None;
        }
        let s = bands.fold(Self::new(r), |a, b| a.plus(b));
        let added = |lanes: &[f64; LANES]| lanes.iter().sum::<f64>();
        let (c, a, b): (f64, Vec<f64>, Vec<f64>) =
            (added(&s.c), s.a.iter().map(added).collect(), s.b.iter().map(added).collect());
        let (all, n) = (b.iter().sum::<f64>(), r as f64);
        let scale = 1.0 / (3.0 * f64::from(w) * f64::from(h));
        let value = scale * (c - all) / (n * (n - 1.0));
        let without = |i: usize| scale * ((c - 2.0 * a[i] + b[i]) - (all - b[i])) / ((n - 1.0) * (n - 2.0));
        let center = (0..r).map(without).sum::<f64>() / n;
        let spread: f64 = (0..r).map(|i| (without(i) - center).powi(2)).sum();
        Some(SquaredNorm { value, std_error: (spread * (n - 1.0) / n).sqrt() })
    }
}

/// m_r = m + d_r N/n_r, and their products.
#[pulp::with_simd(products = Arch::new())]
#[inline(always)]
fn products_with_simd<'a, S: Simd>(_simd: S, d: &'a Deviations, memory: &'a mut [f64], sums: &'a mut NormSums) {
    let width = d.mean.len();
    let (sum, means) = memory.split_at_mut(width);
    sum.fill(0.0);
    for (r, means) in means.chunks_exact_mut(width).enumerate() {
        let (of, scale) = (&d.replicate(r)[..width], d.scale(r));
        for i in 0..width {
            means[i] = d.mean[i] + of[i] * scale;
            sum[i] += means[i];
        }
    }
    add_products(sum, sum, &mut sums.c);
    for (r, m) in means.chunks_exact(width).enumerate() {
        add_products(sum, m, &mut sums.a[r]);
        add_products(m, m, &mut sums.b[r]);
    }
}

#[inline(always)]
fn add_products(x: &[f64], y: &[f64], sums: &mut [f64; LANES]) {
    let ((xs, x), (ys, y)) = (x.as_chunks::<LANES>(), y.as_chunks::<LANES>());
    let mut s = *sums;
    for (x, y) in xs.iter().zip(ys) {
        for l in 0..LANES {
            s[l] += x[l] * y[l];
        }
    }
    x.iter().zip(y).zip(&mut s).for_each(|((x, y), s)| *s += x * y);
    *sums = s;
}
