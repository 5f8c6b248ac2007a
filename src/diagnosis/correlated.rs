//! Noise that neighbouring pixels share, after a pixel filter wider than a pixel or in a lossy file.
//!
//! ```text
//! var(mean of n pixels) = σ²/n · f        f = 1 + 2 Σ_lags ρ(lag)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | ρ | correlation of S − r T at two pixels, after a plane in x and y and a factor r were fitted to each block | here |
//! | f | factor on the variance of a mean; 1 if neighbours are uncorrelated | [`inflation`] |
//!
//! A picture with a wrong shape also has residuals that neighbours share. The factor is then too large rather than too small.

use super::picture::Layer;

/// Side of the blocks, in pixels.
const BLOCK: usize = 16;
/// Correlations of neighbours up to this value count as none.
const NONE: f64 = 0.12;

/// The factor f of each channel.
pub(super) fn inflation(suspect: &Layer, predicted: &Layer, [w, h]: [usize; 2]) -> [f64; 3] {
    std::array::from_fn(|c| {
        let mut residual = vec![f64::NAN; w * h];
        for (y0, x0) in (0..h / BLOCK).flat_map(|y| (0..w / BLOCK).map(move |x| (y * BLOCK, x * BLOCK))) {
            let pixels: Vec<usize> = (0..BLOCK * BLOCK).map(|i| (y0 + i / BLOCK) * w + x0 + i % BLOCK).collect();
            let place = |p: usize| [1.0, (p % w - x0) as f64, (p / w - y0) as f64, f64::from(predicted.mean[p][c])];
            let basis: [Vec<f64>; 4] = std::array::from_fn(|i| pixels.iter().map(|&p| place(p)[i]).collect());
            let rest = without(pixels.iter().map(|&p| f64::from(suspect.mean[p][c])).collect(), &basis);
            pixels.iter().zip(rest).for_each(|(&p, r)| residual[p] = r);
        }
        let lag = |dx: isize, dy: isize| {
            let (mut sum, mut n) = (0.0, 0.0);
            for p in 0..w * h {
                let (x, y) = ((p % w) as isize + dx, (p / w) as isize + dy);
                if x >= 0 && y >= 0 && x < w as isize && y < h as isize {
                    let product = residual[p] * residual[y as usize * w + x as usize];
                    if product.is_finite() {
                        (sum, n) = (sum + product, n + 1.0);
                    }
                }
            }
            if n > 0.0 { sum / n } else { 0.0 }
        };
        let own = lag(0, 0);
        if own <= 0.0 {
            return 1.0;
        }
        let near = [(1, 0), (0, 1)].map(|(x, y)| lag(x, y) / own);
        if 0.5 * (near[0] + near[1]) < NONE {
            return 1.0;
        }
        let far: f64 = [(1, 1), (1, -1), (2, 0), (0, 2)].into_iter().map(|(x, y)| (lag(x, y) / own).max(0.0)).sum();
        (1.0 + 2.0 * (near[0] + near[1] + far)).max(1.0)
    })
}

/// The values without their components along some vectors (Gram and Schmidt).
pub(super) fn without(mut values: Vec<f64>, basis: &[Vec<f64>]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut directions: Vec<Vec<f64>> = vec![];
    for vector in basis {
        let mut rest = vector.clone();
        for d in &directions {
            let along = dot(&rest, d);
            rest.iter_mut().zip(d).for_each(|(r, x)| *r -= along * x);
        }
        let length = dot(&rest, &rest).sqrt();
        if length > 1e-9 * dot(vector, vector).sqrt() && length > 0.0 {
            rest.iter_mut().for_each(|x| *x /= length);
            let along = dot(&values, &rest);
            values.iter_mut().zip(&rest).for_each(|(v, x)| *v -= along * x);
            directions.push(rest);
        }
    }
    values
}
