//! The parameter of a family, by least squares over regions, slots and channels.
//!
//! ```text
//! c = argmin χ²(c)        χ²(c) = Σ ((S − g P(c))/σ)²        g: exposure, if it is not known
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S, σ | mean of the picture in one cell (slot, region, channel), with its error | [`Cells`] |
//! | P(c) | prediction of a family, from the cell means of the correct terms | [`Family::weights`] |
//! | c | fitted parameter, with its standard error | [`Constant`] |
//! | χ² | misfit, by which families are ranked | [`Fitted::chi2`] |
//!
//! If only the whole image is given, the terms can still be separated, because each has its light in different places. The
//! fitted constant is then compared with well-known values ([`name_of`]): π where 1/π was forgotten, 2 where something is
//! counted twice.

use super::correlated::inflation;
use super::family::Family;
use super::gap::difference;
use super::picture::{Code, Pictures, Slot};
use super::regions::{LAMPS, Region};
use serde::Serialize;
use std::f64::consts::PI;

/// A fitted constant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Constant {
    /// The constant c.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// The best parameters of a family.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// One parameter, or three for the three channels, or none.
    pub constants: Vec<Constant>,
    /// χ² at the minimum.
    pub chi2: f64,
}

impl Fitted {
    /// The parameter of each channel.
    pub fn by_channel(&self) -> [f64; 3] {
        std::array::from_fn(|c| self.constants.get(c).or(self.constants.first()).map_or(1.0, |c| c.value))
    }
}

/// One slot, region and channel.
struct Cell {
    slot: Slot,
    region: usize,
    channel: usize,
    value: f64,
    /// The same mean of the correct picture.
    right: f64,
    sigma: f64,
}

/// Means over cells.
pub struct Cells {
    cells: Vec<Cell>,
    /// For each region and channel: the means of T_k, and last of the tail.
    terms: Vec<[Vec<f64>; 3]>,
    last: usize,
    any_gain: bool,
    has_terms: bool,
}

/// Relative error that every prediction may have.
const ROUNDING: f64 = 1e-3;
/// Number of cells on each side, in the order of brightness, whose errors a cell gets.
const BESIDE: usize = 3;
/// No cell is treated as darker than this fraction of the mean.
const DIM: f64 = 0.02;
/// Largest constant that is sought, and the inverse of the smallest one.
const LARGEST: f64 = 40.0;

impl Cells {
    /// The cells of a picture over regions that do not overlap.
    pub fn new(suspect: &Pictures, reference: &Pictures, regions: &[Region], any_gain: bool) -> Self {
        let mean = |v: &[[f32; 3]], r: &Region, c: usize| {
            r.pixels.iter().map(|&p| f64::from(v[p][c])).sum::<f64>() / r.pixels.len() as f64
        };
        let last = reference.last_term().unwrap_or(0);
        let part = |k: usize| reference.layer(if k > last { Slot::Tail } else { Slot::Term(k) });
        let of = |r: &Region, c: usize| (0..=last + 1).map(|k| part(k).map_or(0.0, |l| mean(&l.mean, r, c))).collect();
        let terms = regions.iter().map(|r| std::array::from_fn(|c| of(r, c))).collect();
        let rounding = suspect.code.rounding().max(ROUNDING);
        let mut cells = vec![];
        for layer in &suspect.layers {
            let Some(right) = reference.layer(layer.slot) else { continue };
            let shared = if layer.std_error.is_some() { [1.0; 3] } else { inflation(layer, right, suspect.size) };
            for (i, region) in regions.iter().enumerate() {
                for (channel, shared) in shared.into_iter().enumerate() {
                    let (value, there) = (mean(&layer.mean, region, channel), mean(&right.mean, region, channel));
                    let r = if there > 0.0 { value / there } else { 1.0 };
                    let (m, _) = difference((layer, right, r), suspect.size[0], &region.pixels, channel, true);
                    // with a shared exponent, rounding is relative to the largest channel
                    let size = if suspect.code == Code::SharedExponent {
                        (0..3).map(|c| mean(&layer.mean, region, c)).fold(there, f64::max)
                    } else {
                        value.abs().max(there)
                    };
                    let sigma = (m.std_error * shared.sqrt()).hypot(rounding * size);
                    if value.is_finite() && sigma.is_finite() && sigma > 0.0 {
                        cells.push(Cell { slot: layer.slot, region: i, channel, value, right: there, sigma });
                    }
                }
            }
        }
        even_out(&mut cells, regions);
        let has_terms = suspect.last_term().is_some();
        Self { cells, terms, last, any_gain, has_terms }
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.cells.len()
    }

    /// (S, P(c), σ) of every cell that the family predicts.
    fn pairs(&self, family: Family, c: f64, channel: Option<usize>) -> Vec<[f64; 3]> {
        let slots: std::collections::BTreeMap<Slot, Option<Vec<f64>>> =
            self.cells.iter().map(|cell| (cell.slot, family.weights(cell.slot, self.last, c))).collect();
        let pair = |cell: &Cell| {
            let weights = slots[&cell.slot].as_ref()?;
            let terms = &self.terms[cell.region][cell.channel];
            let sum: f64 = weights.iter().zip(terms).map(|(w, t)| w * t).sum();
            Some([cell.value, sum + family.offset(cell.slot, self.has_terms, c), cell.sigma])
        };
        self.cells.iter().filter(|cell| channel.is_none_or(|c| c == cell.channel)).filter_map(pair).collect()
    }

    fn chi2(&self, family: Family, c: f64, channel: Option<usize>) -> f64 {
        let pairs = self.pairs(family, c, channel);
        let sum = |f: &dyn Fn(&[f64; 3]) -> f64| pairs.iter().map(|p| f(p) / (p[2] * p[2])).sum::<f64>();
        let gain = if self.any_gain { sum(&|p| p[0] * p[1]) / sum(&|p| p[1] * p[1]) } else { 1.0 };
        let gain = if gain.is_finite() { gain } else { 1.0 };
        sum(&|p| (p[0] - gain * p[1]).powi(2))
    }

    /// χ² of the hypothesis that the picture is correct.
    pub fn correct(&self) -> f64 {
        self.chi2(Family::Exposure, 1.0, None)
    }

    /// The parameters of a family that fit best. None if there is no minimum inside [1/40, 40].
    pub fn fit(&self, family: Family) -> Option<Fitted> {
        match family.parameters() {
            0 => Some(Fitted { constants: vec![], chi2: self.chi2(family, 1.0, None) }),
            3 if self.any_gain => self.balance(family),
            3 => {
                let each: Option<Vec<(Constant, f64)>> = (0..3).map(|c| self.linear(family, Some(c))).collect();
                let each = each?;
                let chi2 = each.iter().map(|e| e.1).sum();
                Some(Fitted { constants: each.into_iter().map(|e| e.0).collect(), chi2 })
            }
            _ if family.is_linear() && !self.any_gain => {
                let (constant, chi2) = self.linear(family, None)?;
                Some(Fitted { constants: vec![constant], chi2 })
            }
            _ => self.search(family),
        }
    }

    /// Factors of three channels whose common factor is unknown; their mean is set to 1.
    fn balance(&self, family: Family) -> Option<Fitted> {
        let each: Vec<(Constant, f64)> = (0..3).map(|c| self.linear(family, Some(c))).collect::<Option<_>>()?;
        let mean = each.iter().map(|e| e.0.value).sum::<f64>() / 3.0;
        let scaled = |c: Constant| Constant { value: c.value / mean, std_error: c.std_error / mean };
        Some(Fitted { constants: each.iter().map(|e| scaled(e.0)).collect(), chi2: each.iter().map(|e| e.1).sum() })
    }

    /// Least squares for a prediction A + c B.
    fn linear(&self, family: Family, channel: Option<usize>) -> Option<(Constant, f64)> {
        let (zero, one) = (self.pairs(family, 0.0, channel), self.pairs(family, 1.0, channel));
        let (mut sb, mut bb) = (0.0, 0.0);
        for (a, b) in zero.iter().zip(&one) {
            let (rest, slope, w) = (a[0] - a[1], b[1] - a[1], 1.0 / (a[2] * a[2]));
            sb += w * rest * slope;
            bb += w * slope * slope;
        }
        let value = sb / bb;
        let off = |p: &[f64; 3], b: &[f64; 3]| ((p[0] - p[1] - value * (b[1] - p[1])) / p[2]).powi(2);
        let chi2: f64 = zero.iter().zip(&one).map(|(p, b)| off(p, b)).sum();
        let excess = (chi2 / zero.len().max(1) as f64).max(1.0);
        (bb > 0.0 && value.is_finite()).then(|| (Constant { value, std_error: (excess / bb).sqrt() }, chi2))
    }

    /// The minimum of χ² over ln c: the best point of a grid, then the golden section.
    fn search(&self, family: Family) -> Option<Fitted> {
        let misfit = |ln: f64| self.chi2(family, ln.exp(), None);
        let (limit, steps) = (LARGEST.ln(), 160);
        let grid: Vec<(f64, f64)> = (0..=steps)
            .map(|i| limit * (2.0 * f64::from(i) / f64::from(steps) - 1.0))
            .map(|ln| (ln, misfit(ln)))
            .collect();
        let best = (0..grid.len()).min_by(|&a, &b| grid[a].1.total_cmp(&grid[b].1))?;
        if best == 0 || best + 1 == grid.len() {
            return None;
        }
        let (mut lo, mut hi) = (grid[best - 1].0, grid[best + 1].0);
        let g = 0.5 * (5f64.sqrt() - 1.0);
        for _ in 0..40 {
            let (a, b) = (hi - g * (hi - lo), lo + g * (hi - lo));
            if misfit(a) < misfit(b) { hi = b } else { lo = a }
        }
        let ln = 0.5 * (lo + hi);
        // χ² rises by 1 at one standard error; if the family does not fit, the error is widened
        let (h, least) = (1e-3, misfit(ln));
        let bend = (misfit(ln + h) + misfit(ln - h) - 2.0 * least) / (h * h);
        let excess = (least / self.cells.len().max(1) as f64).max(1.0);
        let std_error = (2.0 * excess / bend).sqrt();
        let constant = Constant { value: ln.exp(), std_error: std_error * ln.exp() };
        (std_error.is_finite() && bend > 0.0).then(|| Fitted { constants: vec![constant], chi2: least })
    }
}

/// The error of a cell, estimated from its own pixels, depends on the light that the cell got by chance, and a fit with such errors is
/// biased to dark cells. Each cell therefore gets the error of other cells that are about as bright: the variance over the mean of the
/// [`BESIDE`] next darker and the next brighter ones, for each slot and channel. The region of lamps keeps its own.
fn even_out(cells: &mut [Cell], regions: &[Region]) {
    let slots: std::collections::BTreeSet<(Slot, usize)> = cells.iter().map(|c| (c.slot, c.channel)).collect();
    for (slot, channel) in slots {
        let mine = |c: &Cell| c.slot == slot && c.channel == channel && regions[c.region].name != LAMPS;
        let mut order: Vec<usize> = (0..cells.len()).filter(|&i| mine(&cells[i])).collect();
        order.sort_by(|&a, &b| cells[a].right.total_cmp(&cells[b].right));
        let level = order.iter().map(|&i| cells[i].right).sum::<f64>() / order.len().max(1) as f64;
        let size = |c: &Cell| regions[c.region].pixels.len() as f64;
        let bright = |c: &Cell| c.right.max(DIM * level);
        let relative: Vec<f64> =
            order.iter().map(|&i| cells[i].sigma.powi(2) * size(&cells[i]) / bright(&cells[i])).collect();
        for (place, &i) in order.iter().enumerate() {
            let near = place.saturating_sub(BESIDE)..(place + BESIDE + 1).min(order.len());
            let others: Vec<f64> =
                near.filter(|p| *p != place).map(|p| relative[p]).filter(|r| r.is_finite()).collect();
            let usual = others.iter().sum::<f64>() / others.len() as f64;
            let sigma = (usual * bright(&cells[i]) / size(&cells[i])).sqrt();
            if sigma.is_finite() && sigma > 0.0 {
                cells[i].sigma = sigma;
            }
        }
    }
}

const NAMED: [(f64, &str); 12] = [
    (2.0, "2"),
    (0.5, "1/2"),
    (PI, "π"),
    (1.0 / PI, "1/π"),
    (2.0 * PI, "2π"),
    (0.5 / PI, "1/(2π)"),
    (4.0, "4"),
    (0.25, "1/4"),
    (3.0, "3"),
    (1.0 / 3.0, "1/3"),
    (0.5 * PI, "π/2"),
    (2.0 / PI, "2/π"),
];

/// The name of the well-known value that a fitted constant matches. It must lie within three standard errors, or within 0.5
/// % if that is more. None if three standard errors exceed 5 %.
///
/// ```
/// use fredholm::diagnosis::fit::{Constant, name_of};
/// assert_eq!(name_of(Constant { value: 3.15, std_error: 6e-3 }), Some("π"));
/// assert_eq!(name_of(Constant { value: 3.15, std_error: 0.6 }), None);
/// assert_eq!(name_of(Constant { value: 0.7, std_error: 2e-3 }), None);
/// ```
pub fn name_of(c: Constant) -> Option<&'static str> {
    let reach = (3.0 * c.std_error / c.value).max(5e-3);
    let near = |known: f64| (c.value / known).ln().abs() <= reach;
    NAMED.iter().find(|(known, _)| reach <= 0.05 && near(*known)).map(|n| n.1)
}
