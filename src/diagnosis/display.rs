//! From stored values to radiance: which curve, which exposure, and which pixels are clipped.
//!
//! ```text
//! D = curve⁻¹(s)/e          e = Σ D/Σ T over the pixels that are not clipped
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | s, D | stored value, and the radiance that it stands for | [`Developed::pictures`] |
//! | T | the correct picture | argument of [`develop`] |
//! | e | exposure, with its 95 % interval | [`Display::exposure`] |
//! | – | share of the pixels that are clipped, or beside such pixels | [`Display::hidden`] |
//!
//! A picture for a display (8 or 16 bits) is judged after every curve of [`Curve::known`] has been tried: the curve with which the picture
//! agrees best with the correct one is taken. If no known curve leads to agreement, but some rising curve does, then the picture
//! cannot be judged. A picture in floating point is linear unless a curve with one exposure explains it and a linear exposure does not.
//!
//! Noise decides which pixels are clipped. A pixel is therefore left out if several of its neighbours are clipped, or if the correct
//! picture would be clipped there; a single clipped pixel is not left out.

use super::curve::{Curve, Tone};
use super::encoded::is_encoded;
use super::gap::{Fit, compare_within, ratio};
use super::picture::{Code, Layer, Pictures, Slot};
use super::regions::{self, Region};
use crate::stats::critical;
use serde::Serialize;

/// How the stored values of a picture are read.
#[derive(Clone, Debug, Serialize)]
pub struct Display {
    /// The curve.
    pub curve: Curve,
    /// The exposure e.
    pub exposure: f64,
    /// Half width of its 95 % interval; 0 if it was given.
    pub half_width: f64,
    /// True if the exposure was fitted.
    pub fitted: bool,
    /// Share of pixels that are left out because they are clipped.
    pub hidden: f64,
    /// Share of the values that should be far above the largest stored value, and are not even near it; 0 if there are none.
    pub dark: f64,
    /// True if stored values were rounded down instead of to the nearest value.
    pub rounded_down: bool,
    /// False if the values follow a rising curve of brightness that is not known.
    pub known: bool,
}

/// A picture as radiance.
pub struct Developed {
    /// How it was read.
    pub display: Display,
    /// Its pictures, averaged down and divided by the exposure.
    pub pictures: Pictures,
    /// True for pixels of the small picture that are left out; empty if there are none.
    pub mask: Vec<bool>,
    /// True for pixels that are left out whatever the curve is.
    always: Vec<bool>,
    /// True if the values are hardly larger than one step, so that any curve fits them.
    faint: bool,
    fit: Fit,
}

/// The correct picture, and where and how strictly a picture is compared with it.
pub struct Against<'a> {
    /// The correct terms.
    pub reference: &'a Pictures,
    /// The regions that are compared.
    pub regions: &'a [Region],
    /// Factor by which the picture is averaged down.
    pub factor: usize,
    /// The exposure, if it is known.
    pub gain: Option<f64>,
    /// Pixels of the small picture that are left out anyway; empty if there are none.
    pub mask: &'a [bool],
    /// Level of the comparison.
    pub alpha: f64,
}

/// Neighbours on each side that are counted as beside a pixel.
const REACH: usize = 2;
/// A pixel is left out if more than this share of its neighbourhood is clipped: two of twenty-five.
const CLIPPED: f64 = 0.05;
/// A pixel is left out if this multiple of the correct value would be clipped.
const MARGIN: f64 = 1.3;
/// A curve explains a picture only if at most this share of it is left out.
const MOST_HIDDEN: f64 = 0.9;
/// A curve of a file in floating point is taken only if it fits this well: least p-value, and largest mean squared deviation.
const CERTAIN: f64 = 0.02;
const GOOD: f64 = 1.6;
/// Mean value, in steps, below which a picture is too dark.
const FAINT: f64 = 1.5;
/// Fewest values that should be white, for a judgement on them.
const FEWEST: usize = 12;
/// Number of brightness levels of an unknown curve.
const LEVELS: usize = 32;
/// Relative error of straight lines between levels.
const UNKNOWN: f64 = 0.01;
/// An encoded picture in floating point must have at least this range of brightness (interquartile, natural logarithm).
const RANGE: f64 = 0.3;

/// Reads a picture as radiance, with the curve and the exposure that explain it.
pub fn develop(stored: &Pictures, against: &Against) -> Developed {
    let with = |curve| try_curve(stored, (curve, false), against.gain, against);
    let explains = |d: &Developed| {
        let seen = !d.fit.gaps.is_empty() && d.display.hidden <= MOST_HIDDEN && !d.faint;
        seen && d.fit.p >= against.alpha
    };
    let best = || {
        let gain = against.gain.filter(|_| stored.code.for_display());
        let down = if stored.code == Code::EightBit { vec![false, true] } else { vec![false] };
        let ways = Curve::known().into_iter().flat_map(|curve| down.iter().map(move |d| (curve, *d)));
        ways.map(|way| try_curve(stored, way, gain, against))
            .filter(explains)
            .min_by(|a, b| a.fit.misfit.total_cmp(&b.fit.misfit))
    };
    if stored.code.for_display() {
        return best().unwrap_or_else(|| {
            let usual = with(Curve::SRGB);
            let known = !follows_some_curve(&usual, against);
            Developed { display: Display { known, ..usual.display }, ..usual }
        });
    }
    let linear = with(Curve::LINEAR);
    if explains(&linear) || explains(&try_curve(stored, (Curve::LINEAR, false), None, against)) || !has_range(against) {
        return linear;
    }
    let certain = |d: &Developed| d.display.hidden < 0.5 && d.fit.p >= CERTAIN && d.fit.misfit <= GOOD;
    if let Some(best) = best().filter(certain) {
        return best;
    }
    // encoded, and wrong even after decoding
    let whole = linear.pictures.layer(Slot::Whole).zip(against.reference.layer(Slot::Whole));
    if whole.is_some_and(|(a, b)| is_encoded(&a.mean, &b.mean)) {
        let decoded = Curve::known().into_iter().take(2).map(|curve| try_curve(stored, (curve, false), None, against));
        return decoded.min_by(|a, b| a.fit.misfit.total_cmp(&b.fit.misfit)).unwrap_or(linear);
    }
    linear
}

/// Reads a picture with one curve, rounded down or to the nearest value. The exposure is fitted if it is not given.
fn try_curve(
    stored: &Pictures,
    (curve, rounded_down): (Curve, bool),
    gain: Option<f64>,
    against: &Against,
) -> Developed {
    let Against { reference, factor, .. } = *against;
    let mut full = decoded(stored, curve, rounded_down);
    let clipped = clipped(stored, &mut full, curve);
    let small = full.shrunk(factor);
    let size = small.size;
    let beside = mask_of(&clipped, stored.size[0], factor, size);
    let given = |p: usize| regions::holds(against.mask, p);
    let mut mask: Vec<bool> = (0..beside.len()).map(|p| beside[p] || given(p)).collect();
    let pair = small.layers.iter().rev().find_map(|l| Some((l, reference.layer(l.slot)?)));
    let top = if stored.code.for_display() { curve.decode([1.0; 3])[0] } else { f64::INFINITY };
    let (mut exposure, mut half_width) = (gain.unwrap_or(1.0), 0.0);
    // lamps and edges do not decide the exposure: curves compress them most
    let inner: Vec<usize> = against.regions.iter().filter(|r| r.in_grid()).flat_map(|r| r.pixels.clone()).collect();
    if let Some((layer, right)) = pair {
        for _ in 0..3 {
            let mut seen: Vec<usize> = inner.iter().copied().filter(|&p| !mask[p]).collect();
            if seen.len() < regions::FEWEST {
                seen = (0..mask.len()).filter(|&p| !mask[p]).collect();
            }
            if gain.is_none() && !seen.is_empty() {
                let r = ratio(layer, right, size[0], &seen);
                if r.mean.is_finite() && r.mean > 0.0 {
                    (exposure, half_width) = (r.mean, critical(0.05, r.dof) * r.std_error);
                }
            }
            let bright = |p: usize| right.mean[p].iter().any(|v| MARGIN * exposure * f64::from(*v) > top);
            (0..mask.len()).for_each(|p| mask[p] = beside[p] || given(p) || bright(p));
        }
    }
    let always = (0..mask.len()).map(|p| beside[p] || given(p)).collect();
    let plain = curve.tone == Tone::None && stored.code != Code::Jpeg;
    let dark = pair.filter(|_| plain).map_or(0.0, |(layer, right)| dark_whites(layer, right, exposure, top, given));
    let hidden = mask.iter().enumerate().filter(|(p, m)| **m && !given(*p)).count() as f64 / mask.len().max(1) as f64;
    if mask.iter().all(|m| !m) {
        mask.clear();
    }
    let dim: Vec<usize> = inner.iter().copied().filter(|&p| !regions::holds(&mask, p)).collect();
    let sum = |v: &[[f32; 3]]| dim.iter().flat_map(|&p| v[p]).map(f64::from).sum::<f64>();
    let faint = !small.step.is_empty() && pair.is_some_and(|(l, _)| sum(&l.mean) < FAINT * sum(&small.step));
    let pictures = small.times(1.0 / exposure);
    // a fitted exposure may be off by its error
    let slack = if gain.is_none() { 2.0 * half_width / exposure + 1e-3 } else { 0.0 };
    let fit = compare_within(&pictures, reference, &regions::without(against.regions.to_vec(), &mask), slack.min(0.02));
    let fitted = gain.is_none();
    let display = Display { curve, exposure, half_width, fitted, hidden, dark, rounded_down, known: true };
    Developed { display, pictures, mask, always, faint, fit }
}

/// The share of the values above six times the largest stored one that are stored as less than half of it. A pixel at the edge of a lamp
/// may be dark, because filters differ.
fn dark_whites(layer: &Layer, right: &Layer, exposure: f64, top: f64, given: impl Fn(usize) -> bool) -> f64 {
    let white = |p: usize, c: usize| exposure * f64::from(right.mean[p][c]) > 6.0 * top;
    let all: Vec<(usize, usize)> = (0..layer.mean.len())
        .filter(|p| !given(*p))
        .flat_map(|p| (0..3).map(move |c| (p, c)))
        .filter(|(p, c)| white(*p, *c))
        .collect();
    let dark = all.iter().filter(|(p, c)| f64::from(layer.mean[*p][*c]) < 0.5 * top).count();
    if all.len() < FEWEST { 0.0 } else { dark as f64 / all.len() as f64 }
}

/// The layers as radiance, and the distance between neighbouring stored values.
fn decoded(stored: &Pictures, curve: Curve, rounded_down: bool) -> Pictures {
    if curve == Curve::LINEAR {
        return stored.clone();
    }
    // a value that was rounded down stands for the middle of its step
    let shift = if rounded_down { 0.5 * stored.code.step() } else { 0.0 };
    let of =
        |v: [f64; 3]| curve.decode(if rounded_down { v.map(|x| (x + shift).min(1.0)) } else { v }).map(|x| x as f32);
    let layer = |l: &Layer| Layer {
        slot: l.slot,
        mean: l.mean.iter().map(|v| of(v.map(f64::from))).collect(),
        std_error: None,
    };
    let half = 0.5 * stored.code.step();
    let last = stored.layers.last().filter(|_| half > 0.0);
    let width = |v: &[f32; 3]| -> [f32; 3] {
        let at = |by: f64| of(v.map(|x| (f64::from(x) + by).clamp(0.0, 1.0 - half)));
        let (below, middle, above) = (at(-half), at(0.0), at(half));
        std::array::from_fn(|c| if v[c] > 0.0 { above[c] - below[c] } else { 2.0 * (above[c] - middle[c]) })
    };
    let step = last.map_or(vec![], |l| l.mean.iter().map(width).collect());
    Pictures { layers: stored.layers.iter().map(layer).collect(), step, ..stored.clone() }
}

/// True for the pixels of the stored picture that are clipped. Values that no radiance has are set to zero, and count as clipped; in
/// floating point they exclude the curve, so that all pixels count as clipped.
fn clipped(stored: &Pictures, full: &mut Pictures, curve: Curve) -> Vec<bool> {
    let pixels = stored.size[0] * stored.size[1];
    let mut flags = vec![false; pixels];
    if curve == Curve::LINEAR {
        return flags;
    }
    let largest = stored.layers.iter().flat_map(|l| l.mean.iter().flatten()).fold(0.0f32, |a, v| a.max(*v));
    let top = 1.0 - 0.5 * stored.code.step().max(1e-3) as f32;
    for (from, to) in stored.layers.iter().zip(&mut full.layers) {
        for (p, flag) in flags.iter_mut().enumerate() {
            let clips = largest <= 1.0 + 1e-3 && from.mean[p].iter().any(|v| *v >= top);
            let unknown = from.mean[p].iter().all(|v| v.is_finite()) && to.mean[p].iter().any(|v| v.is_nan());
            if unknown && !clips && !stored.code.for_display() {
                return vec![true; pixels];
            }
            *flag |= clips || unknown;
            if unknown {
                to.mean[p] = [0.0; 3];
            }
        }
    }
    flags
}

/// True for pixels of the small picture with several clipped neighbours.
fn mask_of(clipped: &[bool], width: usize, factor: usize, [w, h]: [usize; 2]) -> Vec<bool> {
    let share = |x: usize, y: usize| {
        let inside =
            (y * factor..(y + 1) * factor).flat_map(|v| (x * factor..(x + 1) * factor).map(move |u| v * width + u));
        inside.filter(|&i| clipped[i]).count() as f64 / (factor * factor) as f64
    };
    let shares: Vec<f64> = (0..w * h).map(|p| share(p % w, p / w)).collect();
    let around = |x: usize, y: usize| {
        let (rows, columns) =
            (y.saturating_sub(REACH)..(y + REACH + 1).min(h), x.saturating_sub(REACH)..(x + REACH + 1).min(w));
        let n = rows.len() * columns.len();
        rows.flat_map(|v| columns.clone().map(move |u| v * w + u)).map(|p| shares[p]).sum::<f64>() / n as f64
    };
    (0..w * h).map(|p| around(p % w, p / w) > CLIPPED).collect()
}

/// Returns true if the correct picture has a range of brightness in which a curve shows.
fn has_range(against: &Against) -> bool {
    let Some(layer) = against.reference.layers.last() else { return false };
    let mut logs: Vec<f32> = layer.mean.iter().flatten().filter(|v| **v > 0.0).map(|v| v.ln()).collect();
    logs.sort_by(f32::total_cmp);
    logs.len() > 8 && f64::from(logs[logs.len() * 3 / 4] - logs[logs.len() / 4]) > RANGE
}

/// Returns true if some rising function of the brightness turns the picture into the correct one: the mean of the correct picture at
/// [`LEVELS`] levels of brightness, with straight lines between.
fn follows_some_curve(developed: &Developed, against: &Against) -> bool {
    let pair = developed.pictures.layers.iter().rev().find_map(|l| Some((l, against.reference.layer(l.slot)?)));
    let Some((layer, right)) = pair else { return false };
    // straight lines between the levels do not reach lamps
    let dim = |r: &&Region| r.lamps.is_empty() && r.name != regions::LAMPS;
    let dim: Vec<Region> = against.regions.iter().filter(dim).cloned().collect();
    let dim = regions::without(dim, &developed.always);
    let inside: std::collections::BTreeSet<usize> = dim.iter().flat_map(|r| r.pixels.iter().copied()).collect();
    let mut pairs: Vec<(f32, f32)> = inside
        .into_iter()
        .flat_map(|p| (0..3).map(move |c| (p, c)))
        .map(|(p, c)| (right.mean[p][c], layer.mean[p][c]))
        .filter(|pair| pair.0 > 0.0)
        .collect();
    if pairs.len() < 10 * LEVELS {
        return false;
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = |some: &[(f32, f32)]| {
        let (x, y) = some.iter().fold((0.0, 0.0), |a, p| (a.0 + f64::from(p.0), a.1 + f64::from(p.1)));
        (y / some.len() as f64, x / some.len() as f64)
    };
    let mut knots = vec![(0.0, 0.0)];
    knots.extend(pairs.chunks(pairs.len().div_ceil(LEVELS)).map(mean));
    if knots.windows(2).any(|w| w[1].0 <= w[0].0) {
        return false;
    }
    let straighten = |v: f32| {
        let v = f64::from(v);
        let i = knots.partition_point(|k| k.0 < v).clamp(1, knots.len() - 1);
        let (a, b) = (knots[i - 1], knots[i]);
        (a.1 + (v - a.0) * (b.1 - a.1) / (b.0 - a.0)) as f32
    };
    let mean = layer.mean.iter().map(|v| v.map(straighten)).collect();
    let layers = vec![Layer { slot: layer.slot, mean, std_error: None }];
    let straight = Pictures { layers, ..developed.pictures.clone() };
    let fit = compare_within(&straight, against.reference, &dim, UNKNOWN);
    fit.p >= against.alpha && !fit.gaps.is_empty()
}
