//! Second moments of the slot values of one path.
//!
//! ```text
//! M_ab = mean over pixels of E[Y_a Y_b]            m_ab = mean over pixels of E[Y_a] E[Y_b]            Cov_ab = M_ab − m_ab
//! ```
//!
//! With n samples of a pixel and S_a the sum of their Y_a, both have unbiased estimates. M_ab is estimated by the mean of
//! the products within one sample. m_ab is estimated by the mean of the products of two different samples,
//! `(S_a S_b − Σ_i Y_a Y_b) / (n(n − 1))`. Standard errors come from the jackknife over the R replicates, each left out in
//! turn (Efron and Stein, 1981).
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | Y_a | value that one path scores in slot a | the estimator's slots |
//! | M, m | per channel, row by row | [`CrossMoments::second`], [`CrossMoments::product`] |
//! | c_a | rays per path, requested for slot a | [`CrossMoments::rays`] |

/// Moments of one sample, averaged over the pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CrossMoments {
    /// Number of slots.
    pub slots: usize,
    /// M_ab per channel, `slots × slots` values row by row.
    pub second: [Vec<f64>; 3],
    /// m_ab per channel, in the same layout; NaN where there is only one sample.
    pub product: [Vec<f64>; 3],
    /// Rays requested per path, by slot.
    pub rays: Vec<f64>,
}

impl CrossMoments {
    /// M_ab, averaged over the channels.
    pub fn second(&self, a: usize, b: usize) -> f64 {
        self.second.iter().map(|m| m[a * self.slots + b]).sum::<f64>() / 3.0
    }

    /// m_ab, averaged over the channels.
    pub fn product(&self, a: usize, b: usize) -> f64 {
        self.product.iter().map(|m| m[a * self.slots + b]).sum::<f64>() / 3.0
    }
}

/// A value with its standard error; NaN where the error is not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// Moments of all samples, and the same without each replicate, from which standard errors follow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Moments of all samples.
    pub all: CrossMoments,
    /// Moments of all samples but those of replicate r, for each r.
    pub without: Vec<CrossMoments>,
    /// Number of paths.
    pub paths: u64,
    /// Samples that were not finite; they stay in the sums.
    pub non_finite: u64,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Mean of all slots together, by pixel.
    pub image: Vec<[f32; 3]>,
    /// Mean of slot 0, emission seen directly, by pixel.
    pub emission: Vec<[f32; 3]>,
}

impl Recorded {
    /// A smooth function of the moments, with its standard error by the jackknife.
    pub fn value(&self, f: impl Fn(&CrossMoments) -> f64) -> Value {
        let r = self.without.len() as f64;
        let each: Vec<f64> = self.without.iter().map(&f).collect();
        let center = each.iter().sum::<f64>() / r;
        let spread: f64 = each.iter().map(|x| (x - center).powi(2)).sum();
        let std_error = if r < 2.0 { f64::NAN } else { (spread * (r - 1.0) / r).sqrt() };
        Value { value: f(&self.all), std_error }
    }

    /// Number of independent replicates.
    pub fn replicates(&self) -> u64 {
        self.without.len() as u64
    }
}

/// Sums over some pixels with n samples each in R replicates, from which the moments are computed. Only b ≤ a is filled.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) slots: usize,
    /// Samples of one pixel, by replicate.
    pub(crate) counts: Vec<u32>,
    pub(crate) pixels: u64,
    /// Σ Y_a Y_b, by replicate, channel, a, b.
    pub(crate) squares: Vec<f64>,
    /// S_a S_b summed over pixels, with all samples and without each replicate: index r + 1 (0 for all), channel, a, b.
    pub(crate) products: Vec<f64>,
    /// Rays, by replicate and slot.
    pub(crate) rays: Vec<u64>,
    pub(crate) non_finite: u64,
}

impl Sums {
    pub(crate) fn new(slots: usize, counts: Vec<u32>) -> Self {
        let (r, matrix) = (counts.len(), 3 * slots * slots);
        let (squares, products) = (vec![0.0; r * matrix], vec![0.0; (r + 1) * matrix]);
        Self { slots, rays: vec![0; r * slots], counts, squares, products, ..Self::default() }
    }

    /// Adds a path of replicate r; `y` holds its slot values in one channel.
    pub(crate) fn path(&mut self, r: usize, channel: usize, y: &[f64]) {
        let n = self.slots;
        add_square(&mut self.squares[(r * 3 + channel) * n * n..][..n * n], y);
    }

    /// Adds a complete pixel; `sums` holds S_a in one channel, by replicate.
    pub(crate) fn pixel(&mut self, channel: usize, sums: &[f64]) {
        let n = self.slots;
        let mut all = vec![0.0; n];
        sums.chunks(n).for_each(|s| all.iter_mut().zip(s).for_each(|(a, s)| *a += s));
        add_square(&mut self.products[channel * n * n..][..n * n], &all);
        for (r, s) in sums.chunks(n).enumerate() {
            let rest: Vec<f64> = all.iter().zip(s).map(|(a, s)| a - s).collect();
            add_square(&mut self.products[((r + 1) * 3 + channel) * n * n..][..n * n], &rest);
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        let sum = |a: &mut [f64], b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        sum(&mut self.squares, &other.squares);
        sum(&mut self.products, &other.products);
        self.rays.iter_mut().zip(&other.rays).for_each(|(a, b)| *a += b);
        self.pixels += other.pixels;
        self.non_finite += other.non_finite;
    }

    pub(crate) fn moments(&self, seconds: f64) -> Recorded {
        let replicates = self.counts.len();
        let samples: u64 = self.counts.iter().map(|&n| u64::from(n)).sum();
        let without = if replicates < 2 { vec![] } else { (0..replicates).map(|r| self.leaving(Some(r))).collect() };
        let paths = self.pixels * samples;
        let (all, non_finite) = (self.leaving(None), self.non_finite);
        Recorded { all, without, paths, non_finite, seconds, ..Recorded::default() }
    }

    /// The moments without replicate `out`, or of all samples if `out` is None.
    fn leaving(&self, out: Option<usize>) -> CrossMoments {
        let n = self.slots;
        let kept: Vec<usize> = (0..self.counts.len()).filter(|&r| Some(r) != out).collect();
        let count: f64 = kept.iter().map(|&r| f64::from(self.counts[r])).sum();
        let pixels = self.pixels as f64;
        let square = |channel: usize, at: usize| -> f64 {
            kept.iter().map(|&r| self.squares[(r * 3 + channel) * n * n + at]).sum()
        };
        let products = &self.products[out.map_or(0, |r| r + 1) * 3 * n * n..];
        let full = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let cells = (0..n * n).map(|i| (i / n, i % n));
            cells.map(|(a, b)| value(a.max(b) * n + a.min(b))).collect()
        };
        let second = |c: usize| full(&|at| square(c, at) / (pixels * count));
        let product =
            |c: usize| full(&|at| (products[c * n * n + at] - square(c, at)) / (pixels * count * (count - 1.0)));
        let rays = |a: usize| kept.iter().map(|&r| self.rays[r * n + a]).sum::<u64>() as f64 / (pixels * count);
        CrossMoments {
            slots: n,
            second: [0, 1, 2].map(second),
            product: [0, 1, 2].map(product),
            rays: (0..n).map(rays).collect(),
        }
    }
}

/// Adds the lower triangle of y yᵀ with its diagonal. Zeros are skipped, because most slots of most paths are 0.
fn add_square(matrix: &mut [f64], y: &[f64]) {
    let n = y.len();
    for (a, &ya) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
        matrix[a * n..=a * n + a].iter_mut().zip(y).for_each(|(m, yb)| *m += ya * yb);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels, three replicates of two samples: compared with the definitions.
    #[test]
    fn moments_are_those_of_the_definition() {
        let y = |pixel: usize, sample: usize| {
            let x = (1 + pixel * 7 + sample * 3) as f64;
            [x.sin().abs(), (2.0 * x).cos().abs()]
        };
        let mut sums = Sums::new(2, vec![2, 2, 2]);
        for pixel in 0..2 {
            let mut by_replicate = vec![0.0; 6];
            for sample in 0..6 {
                let (r, y) = (sample / 2, y(pixel, sample));
                sums.path(r, 1, &y);
                (0..2).for_each(|a| by_replicate[r * 2 + a] += y[a]);
            }
            sums.pixel(1, &by_replicate);
            sums.pixels += 1;
        }
        let recorded = sums.moments(0.0);
        let check = |m: &CrossMoments, samples: &[usize]| {
            let n = samples.len() as f64;
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let (mut second, mut product) = (0.0, 0.0);
                for p in 0..2 {
                    for &i in samples {
                        second += y(p, i)[a] * y(p, i)[b] / (2.0 * n);
                        for &j in samples.iter().filter(|j| **j != i) {
                            product += y(p, i)[a] * y(p, j)[b] / (2.0 * n * (n - 1.0));
                        }
                    }
                }
                assert!((m.second[1][a * 2 + b] - second).abs() < 1e-14);
                assert!((m.product[1][a * 2 + b] - product).abs() < 1e-14);
            }
        };
        check(&recorded.all, &[0, 1, 2, 3, 4, 5]);
        check(&recorded.without[1], &[0, 1, 4, 5]);
        assert_eq!(recorded.paths, 12);
        assert_eq!(recorded.value(|m| m.second[0][0]), Value { value: 0.0, std_error: 0.0 });
    }
}
