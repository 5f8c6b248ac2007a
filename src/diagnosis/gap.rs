//! Comparison of two sets of pictures: is the difference larger than the noise, and where?
//!
//! ```text
//! d = mean over a region of S − P        t = d / se(d)
//! p adjusted by Holm in two families with half the level each: image means over slots × channels, and these × regions
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S, P | the suspect, and the prediction of an explanation | arguments of [`compare`] |
//! | se(d) | from the `_se` layers of both pictures; without them, from the scatter of S − P inside blocks of 8 × 8 pixels | `spread` here |
//! | r | ratio of means; its error comes from S − r P by the same rule | [`ratio`] |
//! | κ | variance divided by mean, per pixel: the median over the regions; no region gets a smaller variance than κ times its mean | [`compare`] |
//! | n_eff | (Σ v)²/Σ v² of the pixel variances: the number of pixels that carry the noise | [`Gap::p`] |
//!
//! The local scatter contains the noise of both pictures. If the explanation has a wrong spatial shape, it also contains
//! that misfit. The estimated noise is then too large rather than too small, so that noise is not mistaken for a bias.
//!
//! Noise from rare hits grows with the number of hits. A region that got none by chance looks dark and without noise. The
//! lower bound κ times the mean corrects this.
//!
//! If fewer than ten pixels carry the noise, a t-test is not valid. Then the tests in `rare` look for excessive fireflies
//! and for missing lamps, and otherwise nothing is rejected. Pixels share noise after a wide filter or a lossy file; where
//! neighbours do, errors are widened (`correlated`). A difference within the rounding of the file is none. References: Welch
//! (1947); Holm (1979).

use super::correlated::{inflation, without};
use super::picture::{Layer, Pictures, Slot};
use super::rare::{Pixel, deficit, excess};
use super::regions::{LAMPS, Region};
use super::rounding::tolerance;
use crate::stats::evidence::JUDGED_PIXELS;
use crate::stats::{Measured, holm, two_sided_p};

/// Side of the blocks, in pixels, inside which the scatter is measured.
const BLOCK: usize = 8;

/// One comparison: one slot, one region, one channel.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// The picture that is compared.
    pub slot: Slot,
    /// Index of the region.
    pub region: usize,
    /// 0, 1, 2: red, green, blue.
    pub channel: usize,
    /// Mean of the suspect.
    pub suspect: f64,
    /// Mean of the prediction.
    pub predicted: f64,
    /// Standard error of their difference.
    pub std_error: f64,
    /// Degrees of freedom of the standard error.
    pub dof: f64,
    /// p-value of no difference, not adjusted. It is 1 if the difference is rounding, or if no valid test exists.
    pub p: f64,
    /// The p-value adjusted for the number of comparisons.
    pub adjusted: f64,
    /// True if too few pixels carry the noise for a t-test.
    pub few: bool,
}

/// All comparisons of two sets of pictures.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Every comparison.
    pub gaps: Vec<Gap>,
    /// The smallest adjusted p-value.
    pub p: f64,
    /// Index of the comparison with the smallest adjusted p-value.
    pub worst: usize,
    /// Mean of ((S − P)/se)² over the comparisons: about 1 if P explains S.
    pub misfit: f64,
}

impl Fit {
    /// The comparison with the strongest evidence against equality. None if nothing was compared.
    pub fn worst(&self) -> Option<&Gap> {
        self.gaps.get(self.worst)
    }
}

/// Returns true if the two differ where the prediction has no noise at all. That is the case if S/P is the same number,
/// other than 1, in every pixel of the region where P is positive and its error is zero. There must be at least four such
/// pixels. A noisy suspect would not show the same ratio twice.
fn differs_without_noise(a: &Layer, b: &Layer, pixels: &[usize], channel: usize, rounding: f64) -> bool {
    let Some(errors) = &b.std_error else { return false };
    let known = pixels.iter().filter(|&&p| errors[p][channel] == 0.0 && b.mean[p][channel] > 0.0);
    let mut ratios = known.map(|&p| f64::from(a.mean[p][channel]) / f64::from(b.mean[p][channel]));
    let Some(first) = ratios.next() else { return false };
    let mut count = 1;
    (first - 1.0).abs() > rounding
        && ratios.all(|r| {
            count += 1;
            (r - first).abs() <= 1e-6 * first.abs()
        })
        && count >= 4
}

/// One channel of the difference a − f·b over some pixels: its mean with error, and the number of pixels that carry its
/// noise. `known` selects the `_se` layers as source of the error, where both have them.
pub(super) fn difference(
    (a, b, factor): (&Layer, &Layer, f64),
    width: usize,
    pixels: &[usize],
    channel: usize,
    known: bool,
) -> (Measured, f64) {
    let n = pixels.len() as f64;
    let d = |p: usize| f64::from(a.mean[p][channel]) - factor * f64::from(b.mean[p][channel]);
    let mean = pixels.iter().map(|&p| d(p)).sum::<f64>() / n;
    let (variance, carried, dof) = match (&a.std_error, &b.std_error) {
        (Some(s), Some(t)) if known => {
            let v = |p: usize| f64::from(s[p][channel]).powi(2) + (factor * f64::from(t[p][channel])).powi(2);
            let (one, two) = pixels.iter().fold((0.0, 0.0), |acc, &p| (acc.0 + v(p), acc.1 + v(p) * v(p)));
            // each pixel error comes from few replicates, but the sum over many pixels has many degrees of freedom
            (one / (n * n), if two > 0.0 { one * one / two } else { n }, (n - 1.0).max(1.0))
        }
        _ => spread(&d, width, pixels),
    };
    (Measured { mean, std_error: variance.sqrt(), dof }, carried)
}

/// Variance of the mean of `d` over some pixels, from the scatter inside blocks. Also returns the number of pixels that
/// carry the noise, and the degrees of freedom.
fn spread(d: &dyn Fn(usize) -> f64, width: usize, pixels: &[usize]) -> (f64, f64, f64) {
    let mut blocks: std::collections::BTreeMap<usize, Vec<f64>> = std::collections::BTreeMap::new();
    for &p in pixels {
        blocks.entry(p / width / BLOCK * width + p % width / BLOCK).or_default().push(d(p));
    }
    let n = pixels.len() as f64;
    let (mut variance, mut second, mut fourth, mut dof) = (0.0, 0.0, 0.0, 0.0);
    for block in blocks.values() {
        let m = block.len() as f64;
        let mean = block.iter().sum::<f64>() / m;
        let squares: Vec<f64> = block.iter().map(|x| (x - mean) * (x - mean)).collect();
        let sum: f64 = squares.iter().sum();
        // a block of one pixel has no scatter and contributes nothing
        variance += if m > 1.0 { m * sum / (m - 1.0) } else { 0.0 };
        dof += m - 1.0;
        second += sum;
        fourth += squares.iter().map(|s| s * s).sum::<f64>();
    }
    // for a normal variable, (Σ x²)²/Σ x⁴ is n/3
    let carried = if fourth > 0.0 { 3.0 * second * second / fourth } else { n };
    (variance / (n * n), carried, dof.max(1.0))
}

/// The median; 0 for an empty list.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// One channel of a layer and its prediction, for regions where few pixels carry the noise.
struct Rare<'a> {
    layers: (&'a Layer, &'a Layer),
    errors: &'a [[f32; 3]],
    channel: usize,
    width: usize,
    regions: &'a [Region],
}

impl Rare<'_> {
    fn pixels(&self, region: &Region, lamps: bool) -> Vec<Pixel> {
        let ((a, b), c) = (self.layers, self.channel);
        let chosen = region.pixels.iter().filter(|p| region.lamps.binary_search(p).is_ok() == lamps);
        chosen.map(|&p| [a.mean[p][c], b.mean[p][c], self.errors[p][c]].map(f64::from)).collect()
    }

    /// Returns true if many pixels carry the noise of the prediction. Otherwise the prediction itself may contain fireflies.
    fn steady(&self, region: &Region) -> bool {
        let squares = self.pixels(region, false).into_iter().map(|[.., s]| s * s);
        let (one, two) = squares.fold((0.0, 0.0), |a, v| (a.0 + v, a.1 + v * v));
        one * one >= JUDGED_PIXELS * two
    }

    /// Variance of the suspect divided by that of the prediction: the median over the regions.
    fn noise(&self) -> f64 {
        let of = |r: &Region| {
            let (m, _) = difference((self.layers.0, self.layers.1, 1.0), self.width, &r.pixels, self.channel, false);
            let own = r.pixels.iter().map(|&p| f64::from(self.errors[p][self.channel]).powi(2)).sum::<f64>();
            (m.std_error * r.pixels.len() as f64).powi(2) / own
        };
        let all: Vec<f64> = self.regions.iter().map(of).filter(|v| v.is_finite()).collect();
        if all.is_empty() { f64::INFINITY } else { median(all) }
    }

    /// p-value of no difference. Every renderer finds directly visible emission equally well, so that a missing lamp can be
    /// tested. For all other light it is unknown how rarely a correct renderer finds it.
    fn p(&self, region: &Region, brighter: bool) -> f64 {
        if brighter {
            let steady = self.steady(&self.regions[0]) && self.steady(region);
            return if steady { excess(&self.pixels(region, false)) } else { 1.0 };
        }
        let emitted = matches!(self.layers.0.slot, Slot::Term(0) | Slot::Whole) && !region.lamps.is_empty();
        if emitted { deficit(&self.pixels(region, true), self.noise()) } else { 1.0 }
    }
}

/// Returns true if most light of the layer in this region is emission seen directly.
fn emits(layer: &Layer, region: &Region) -> bool {
    region.name == LAMPS && matches!(layer.slot, Slot::Term(0) | Slot::Whole)
}

/// Variance of the mean over the region of lamps, and the number of pixels that carry it. Wrong emission is no scatter: multiples of the
/// prediction and of the emission are taken out before the scatter is measured. None for other regions, and if the errors are known.
fn beside_lamps(a: &Layer, b: &Layer, region: &Region, channel: usize, width: usize) -> Option<(f64, f64)> {
    if !emits(a, region) || region.emission.is_empty() || (a.std_error.is_some() && b.std_error.is_some()) {
        return None;
    }
    let value = |l: &Layer| region.pixels.iter().map(|&p| f64::from(l.mean[p][channel])).collect::<Vec<f64>>();
    let emission = region.emission.iter().map(|e| f64::from(e[channel])).collect();
    let rest = without(value(a), &[emission, value(b)]);
    let at: std::collections::BTreeMap<usize, f64> = region.pixels.iter().copied().zip(rest).collect();
    let (variance, carried, _) = spread(&|p| at[&p], width, &region.pixels);
    // the noise of the prediction was taken out with it
    let own =
        |errors: &Vec<[f32; 3]>| region.pixels.iter().map(|&p| f64::from(errors[p][channel]).powi(2)).sum::<f64>();
    let n = region.pixels.len() as f64;
    Some((variance + b.std_error.as_ref().map_or(0.0, own) / (n * n), carried))
}

/// Compares every slot that both sets have, in every region.
pub fn compare(suspect: &Pictures, predicted: &Pictures, regions: &[Region]) -> Fit {
    compare_within(suspect, predicted, regions, 0.0)
}

/// The same for a prediction that may be off by a small relative amount, because it has a fitted constant.
pub fn compare_within(suspect: &Pictures, predicted: &Pictures, regions: &[Region], slack: f64) -> Fit {
    let rounding = suspect.code.rounding().max(predicted.code.rounding()).max(slack);
    let (width, exact) = (suspect.size[0], !suspect.code.for_display());
    let mut gaps = vec![];
    for a in &suspect.layers {
        let Some(b) = predicted.layer(a.slot) else { continue };
        let shared = if a.std_error.is_some() { [1.0; 3] } else { inflation(a, b, suspect.size) };
        for (channel, shared) in shared.into_iter().enumerate() {
            let measured: Vec<(Measured, f64, f64)> = regions
                .iter()
                .map(|r| {
                    let (mut m, mut carried) = difference((a, b, 1.0), width, &r.pixels, channel, true);
                    if let Some((variance, lit)) = beside_lamps(a, b, r, channel, width) {
                        (m.std_error, carried) = (variance.sqrt(), lit);
                    }
                    let m = Measured { std_error: m.std_error * shared.sqrt(), ..m };
                    let n = r.pixels.len() as f64;
                    (m, r.pixels.iter().map(|&p| f64::from(b.mean[p][channel])).sum::<f64>() / n, carried)
                })
                .collect();
            let level = |r: usize| (measured[r].0.mean + measured[r].1).max(measured[r].1).max(0.0);
            let size = |r: usize| regions[r].pixels.len() as f64;
            let usual = |r: usize| measured[r].0.std_error.powi(2) * size(r) / level(r);
            let rare = b.std_error.as_ref().filter(|_| exact).map(|errors| Rare {
                layers: (a, b),
                errors,
                channel,
                width,
                regions,
            });
            let kappa = median((1..regions.len()).map(usual).filter(|k| *k > 0.0 && k.is_finite()).collect());
            for (r, region) in regions.iter().enumerate() {
                let (Measured { mean: difference, std_error: own, dof }, predicted, carried) = measured[r];
                let seen = difference + predicted;
                let floor = if r == 0 || emits(a, region) { 0.0 } else { (kappa * level(r) / size(r)).sqrt() };
                let std_error = own.max(floor);
                let tolerance = tolerance(suspect, (a, b), region, channel, rounding * predicted.abs());
                let beyond = (difference.abs() - tolerance).max(0.0);
                let equal = beyond == 0.0;
                let few = carried < JUDGED_PIXELS && !equal;
                let p =
                    if exact && differs_without_noise(a, b, &region.pixels, channel, rounding) || difference.is_nan() {
                        // NaN differs from every number
                        0.0
                    } else if equal {
                        1.0
                    } else if few && emits(a, region) {
                        // Chebyshev's bound needs no normal distribution
                        (std_error / beyond).powi(2).min(1.0)
                    } else if few {
                        rare.as_ref().map_or(1.0, |rare| rare.p(region, difference > 0.0))
                    } else {
                        two_sided_p(beyond / std_error, dof)
                    };
                gaps.push(Gap {
                    slot: a.slot,
                    region: r,
                    channel,
                    suspect: seen,
                    predicted,
                    std_error,
                    dof,
                    p,
                    adjusted: 1.0,
                    few,
                });
            }
        }
    }
    adjusted(gaps)
}

/// Adjusts the p-values by Holm, and finds the worst comparison.
fn adjusted(mut gaps: Vec<Gap>) -> Fit {
    // half of the level goes to the few comparisons of image means, which detect small differences that cover the whole
    // image
    let adjust = |gaps: &[Gap], image: bool| {
        let at: Vec<usize> = (0..gaps.len()).filter(|&i| (gaps[i].region == 0) == image).collect();
        let p: Vec<f64> = at.iter().map(|&i| if gaps[i].p.is_nan() { 1.0 } else { gaps[i].p }).collect();
        at.into_iter().zip(holm(&p)).map(|(i, p)| (i, (2.0 * p).min(1.0))).collect::<Vec<_>>()
    };
    for image in [true, false] {
        for (i, p) in adjust(&gaps, image) {
            gaps[i].adjusted = p;
        }
    }
    let p = gaps.iter().map(|g| g.adjusted).fold(1.0, f64::min);
    let z = |g: &Gap| if g.p == 1.0 { 0.0 } else { ((g.suspect - g.predicted) / g.std_error).abs().min(1e6) };
    let by = |a: &usize, b: &usize| {
        gaps[*a].adjusted.total_cmp(&gaps[*b].adjusted).then(z(&gaps[*b]).total_cmp(&z(&gaps[*a])))
    };
    let worst = (0..gaps.len()).min_by(by).unwrap_or(0);
    let misfit = gaps.iter().map(|g| z(g) * z(g)).sum::<f64>() / gaps.len().max(1) as f64;
    Fit { gaps, p, worst, misfit }
}

/// Ratio S/P of the means of two layers over some pixels, with channels averaged. Its standard error comes from the scatter
/// of S − r P. NaN if P is zero.
pub fn ratio(suspect: &Layer, predicted: &Layer, width: usize, pixels: &[usize]) -> Measured {
    let grey = |layer: &Layer| Layer {
        slot: layer.slot,
        mean: layer.mean.iter().map(|v| [(v[0] + v[1] + v[2]) / 3.0; 3]).collect(),
        // channels of one path share their noise; in the worst case they are fully correlated
        std_error: layer.std_error.as_ref().map(|s| s.iter().map(|v| [(v[0] + v[1] + v[2]) / 3.0; 3]).collect()),
    };
    let (a, b) = (grey(suspect), grey(predicted));
    let mean = |l: &Layer| pixels.iter().map(|&p| f64::from(l.mean[p][0])).sum::<f64>() / pixels.len() as f64;
    let (below, above) = (mean(&b), mean(&a));
    let r = above / below;
    let (m, _) = difference((&a, &b, r), width, pixels, 0, true);
    Measured { mean: r, std_error: m.std_error / below.abs(), dof: m.dof }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::picture::Code;
    use crate::diagnosis::regions::grid;
    use crate::math::{Key, Purpose, Rng};

    fn noisy(seed: u64, level: f32, errors: bool) -> Pictures {
        let key = Key::new(seed, "noise");
        let mean = (0..1024).map(|p| [level + 0.1 * (Rng::at(key, p, 0, 0, Purpose::Start).one() - 0.5); 3]);
        let layer = Layer {
            slot: Slot::Whole,
            mean: mean.collect(),
            std_error: errors.then(|| vec![[0.1 / 12.0f32.sqrt(); 3]; 1024]),
        };
        Pictures { size: [32, 32], layers: vec![layer], code: Code::Float, step: vec![] }
    }

    #[test]
    fn known_and_estimated_errors_agree_and_find_a_shift() {
        let regions = grid([32, 32]);
        for errors in [true, false] {
            let (a, b) = (noisy(1, 1.0, errors), noisy(2, 1.0, errors));
            let fit = compare(&a, &b, &regions);
            assert!(fit.p > 1e-3, "{}", fit.p);
            let expected = 0.1 / 12.0f64.sqrt() * (2.0f64 / 1024.0).sqrt();
            assert!((fit.gaps[0].std_error / expected - 1.0).abs() < 0.1);
            let shifted = compare(&noisy(3, 1.02, errors), &b, &regions);
            assert!(shifted.p < 1e-6);
            assert!(shifted.worst().is_some_and(|g| g.region == 0 && g.suspect > g.predicted));
            let r = ratio(&noisy(3, 2.0, errors).layers[0], &b.layers[0], 32, &regions[0].pixels);
            assert!((r.mean - 2.0).abs() < 5.0 * r.std_error && r.std_error < 0.01);
        }
    }

    #[test]
    fn what_has_no_noise_needs_few_pixels() {
        let regions = grid([32, 32]);
        let dark = |value: f32, error: f32| {
            let lamp = |p: usize| p == 500 || p == 501 || p == 532 || p == 533;
            let of = |v: f32| (0..1024).map(|p| if lamp(p) { [v; 3] } else { [0.0; 3] }).collect::<Vec<_>>();
            let layer = Layer { slot: Slot::Term(0), mean: of(value), std_error: Some(of(error)) };
            Pictures { size: [32, 32], layers: vec![layer], code: Code::Float, step: vec![] }
        };
        assert_eq!(compare(&dark(0.0, 0.0), &dark(17.0, 0.0), &regions).p, 0.0);
        assert_eq!(compare(&dark(17.0, 0.0), &dark(17.0, 0.0), &regions).p, 1.0);
        // four noisy pixels are too few for a decision
        assert_eq!(compare(&dark(0.0, 0.0), &dark(17.0, 1.0), &regions).p, 1.0);
    }

    #[test]
    fn one_bright_pixel_decides_nothing_and_nan_decides_all() {
        let regions = grid([32, 32]);
        let (mut a, b) = (noisy(1, 1.0, false), noisy(2, 1.0, false));
        a.layers[0].mean[77] = [1e6; 3];
        assert_eq!(compare(&a, &b, &regions[..1]).p, 1.0);
        a.layers[0].mean[77] = [f32::NAN; 3];
        assert_eq!(compare(&a, &b, &regions[..1]).p, 0.0);
    }
}
