//! Patterns: explanations of the ratios r_k by a rule with one fitted constant. They need no simulation.
//!
//! ```text
//! S_k = m_k(c) T_k        S = Σ_k m_k(c) T_k        c = argmin Σ ((S − P(c))/σ)² over slots × regions
//! ```
//!
//! | pattern | m_k | what is wrong |
//! |---|---|---|
//! | [`Pattern::Everything`] | c | units or exposure |
//! | [`Pattern::Connection`] | 1, c, c, c, … | a constant in the connection to the light |
//! | [`Pattern::Bounce`] from v | c^max(0, k − v) | the bounce: its density, or roulette without its weight. For v = 0, the BSDF |
//! | [`Pattern::Cut`] after n | 1 to n, then 0 | truncation |
//! | [`Pattern::Shift`] | S_k = T_{k+1} or T_{k−1} | the numbering of terms |
//!
//! If only the whole image is given, the terms can still be separated, because each has its light in different places. The
//! fitted constant is then compared with well-known values ([`name_of`]): π where 1/π was forgotten, 2 where something is
//! counted twice.

use super::gap::ratio;
use super::picture::{Layer, Pictures, Slot};
use super::regions::Region;
use std::f64::consts::PI;

/// A rule for the ratios r_k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// The same factor on all light, including emission.
    Everything,
    /// The same factor on all reflected light.
    Connection,
    /// One more factor at every bounce after the given number of bounces.
    Bounce(usize),
    /// No light after the given term.
    Cut(usize),
    /// Slot k shows the term k + n, where n is the given number.
    Shift(i8),
}

impl Pattern {
    /// All patterns that are tried, for terms up to `last`.
    pub fn all(last: usize) -> Vec<Self> {
        let mut all = vec![Self::Everything, Self::Connection];
        all.extend((0..4).map(Self::Bounce));
        all.extend([Self::Shift(1), Self::Shift(-1)]);
        all.extend((0..=last).map(Self::Cut));
        all
    }

    /// Returns true if the pattern has a constant to fit.
    pub fn has_constant(self) -> bool {
        matches!(self, Self::Everything | Self::Connection | Self::Bounce(_))
    }

    /// The factor m_k of term k with constant c.
    pub fn factor(self, k: usize, c: f64) -> f64 {
        match self {
            Self::Everything => c,
            Self::Connection => {
                if k == 0 {
                    1.0
                } else {
                    c
                }
            }
            Self::Bounce(from) => c.powi(k.saturating_sub(from) as i32),
            Self::Cut(after) => {
                if k > after {
                    0.0
                } else {
                    1.0
                }
            }
            Self::Shift(_) => 1.0,
        }
    }

    /// The number of the correct term that slot k shows, if there is one.
    fn source(self, k: usize) -> Option<usize> {
        if let Self::Shift(by) = self { k.checked_add_signed(by.into()) } else { Some(k) }
    }

    /// Applies the pattern to the correct terms. Errors of terms are added linearly, as if all terms came from the same
    /// paths. The whole tail is treated as term K + 1. Terms that the reference does not have are left out.
    pub fn predict(self, reference: &Pictures, slots: &[Slot], c: f64) -> Pictures {
        let last = reference.last_term().unwrap_or(0);
        let part = |k: usize| reference.layer(if k > last { Slot::Tail } else { Slot::Term(k) });
        let blank = || vec![[0.0f32; 3]; reference.size[0] * reference.size[1]];
        let sum = |slot: Slot, parts: Vec<(f64, &Layer)>| {
            let (mut mean, mut std_error) = (blank(), Some(blank()));
            for (f, l) in parts {
                let add = |to: &mut Vec<[f32; 3]>, from: &[[f32; 3]], f: f32| {
                    to.iter_mut().zip(from).for_each(|(t, v)| (0..3).for_each(|i| t[i] += f * v[i]));
                };
                add(&mut mean, &l.mean, f as f32);
                match (&mut std_error, &l.std_error) {
                    (Some(to), Some(from)) => add(to, from, f.abs() as f32),
                    _ => std_error = None,
                }
            }
            Layer { slot, mean, std_error }
        };
        let layer = |&slot: &Slot| match slot {
            Slot::Term(k) => match self.source(k) {
                None => Some(sum(slot, vec![])),
                Some(s) if s > last => None,
                Some(s) => Some(sum(slot, vec![(self.factor(s, c), part(s)?)])),
            },
            Slot::Tail => match self {
                Self::Shift(_) => None,
                _ => Some(sum(slot, vec![(self.factor(last + 1, c), part(last + 1)?)])),
            },
            Slot::Whole => {
                let kept = (0..=last + 1).filter(|&k| !matches!(self, Self::Shift(by) if by > 0 && k < by as usize));
                Some(sum(slot, kept.filter_map(|k| Some((self.factor(k, c), part(k)?))).collect()))
            }
        };
        Pictures { size: reference.size, layers: slots.iter().filter_map(layer).collect(), code: reference.code }
    }

    /// The constant that fits best, with its standard error. None if there is no minimum inside [1/40, 40].
    pub fn fit(self, suspect: &Pictures, reference: &Pictures, regions: &[Region]) -> Option<Constant> {
        if !self.has_constant() {
            return None;
        }
        let cells = Cells::new(suspect, reference, regions);
        let misfit = |ln: f64| cells.misfit(self, ln.exp());
        let (limit, steps) = (40f64.ln(), 160);
        let grid: Vec<f64> = (0..=steps).map(|i| limit * (2.0 * f64::from(i) / f64::from(steps) - 1.0)).collect();
        let best = (0..grid.len()).min_by(|&a, &b| misfit(grid[a]).total_cmp(&misfit(grid[b])))?;
        if best == 0 || best + 1 == grid.len() {
            return None;
        }
        // golden section
        let (mut lo, mut hi) = (grid[best - 1], grid[best + 1]);
        let g = 0.5 * (5f64.sqrt() - 1.0);
        for _ in 0..60 {
            let (a, b) = (hi - g * (hi - lo), lo + g * (hi - lo));
            if misfit(a) < misfit(b) { hi = b } else { lo = a }
        }
        let ln = 0.5 * (lo + hi);
        // χ² rises by 1 at one standard error; if the model does not fit, the error is widened
        let h = 1e-3;
        let bend = (misfit(ln + h) + misfit(ln - h) - 2.0 * misfit(ln)) / (h * h);
        let excess = (misfit(ln) / cells.count().max(1) as f64).max(1.0);
        let std_error = (2.0 * excess / bend).sqrt();
        (std_error.is_finite() && bend > 0.0).then(|| Constant { value: ln.exp(), relative_error: std_error })
    }
}

/// A fitted constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// The constant c.
    pub value: f64,
    /// Standard error of ln c, where c is the fitted constant: the relative error of c.
    pub relative_error: f64,
}

/// Region means with their weights, as used by the fit.
struct Cells {
    /// Slot, region, mean S of the suspect, and its σ.
    seen: Vec<(Slot, usize, f64, f64)>,
    /// For each region: the means of T_k, and last of the tail.
    terms: Vec<Vec<f64>>,
}

impl Cells {
    fn new(suspect: &Pictures, reference: &Pictures, regions: &[Region]) -> Self {
        // use the regions of the grid without the image as a whole, if there are any, because they do not overlap
        let regions = if regions.len() > 1 { &regions[1..] } else { regions };
        let mean = |l: &Layer, r: &Region| {
            r.pixels.iter().map(|&p| f64::from(l.mean[p].iter().sum::<f32>()) / 3.0).sum::<f64>()
                / r.pixels.len() as f64
        };
        let last = reference.last_term().unwrap_or(0);
        let part = |k: usize| reference.layer(if k > last { Slot::Tail } else { Slot::Term(k) });
        let terms =
            regions.iter().map(|r| (0..=last + 1).map(|k| part(k).map_or(0.0, |l| mean(l, r))).collect()).collect();
        let mut seen = vec![];
        for layer in &suspect.layers {
            let Some(right) = reference.layer(layer.slot) else { continue };
            for (i, region) in regions.iter().enumerate() {
                let value = mean(layer, region);
                let r = ratio(layer, right, suspect.size[0], &region.pixels);
                let right = mean(right, region);
                let sigma = (r.std_error * right).hypot(1e-3 * value.abs().max(right));
                if value.is_finite() && sigma.is_finite() && sigma > 0.0 {
                    seen.push((layer.slot, i, value, sigma));
                }
            }
        }
        Self { seen, terms }
    }

    fn count(&self) -> usize {
        self.seen.len()
    }

    fn misfit(&self, pattern: Pattern, c: f64) -> f64 {
        let cell = |&(slot, region, value, sigma): &(Slot, usize, f64, f64)| {
            let terms = &self.terms[region];
            let at = |k: usize| pattern.factor(k, c) * terms.get(k).copied().unwrap_or(0.0);
            let predicted = match slot {
                Slot::Term(k) => at(k),
                Slot::Tail => at(terms.len() - 1),
                Slot::Whole => (0..terms.len()).map(at).sum(),
            };
            ((value - predicted) / sigma).powi(2)
        };
        self.seen.iter().map(cell).sum()
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
/// use fredholm::diagnosis::pattern::{Constant, name_of};
/// assert_eq!(name_of(Constant { value: 3.15, relative_error: 2e-3 }), Some("π"));
/// assert_eq!(name_of(Constant { value: 3.15, relative_error: 0.2 }), None);
/// assert_eq!(name_of(Constant { value: 0.7, relative_error: 2e-3 }), None);
/// ```
pub fn name_of(c: Constant) -> Option<&'static str> {
    let reach = (3.0 * c.relative_error).max(5e-3);
    let near = |known: f64| (c.value / known).ln().abs() <= reach;
    NAMED.iter().find(|(known, _)| reach <= 0.05 && near(*known)).map(|n| n.1)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diagnosis::picture::Code;
    use crate::diagnosis::regions::grid;
    use crate::math::{Key, Purpose, Rng};

    /// Terms that lie in different places, with a little noise.
    fn terms(seed: u64) -> Pictures {
        let key = Key::new(seed, "terms");
        let value = |k: usize, p: usize| {
            let (x, y) = ((p % 32) as f32 / 32.0, (p / 32) as f32 / 32.0);
            let shape = 1.0 + (3.0 * x * (k + 1) as f32).sin() * 0.5 + y * (k % 3) as f32 * 0.4;
            let noise = Rng::at(key, p as u32, k as u32, 0, Purpose::Start).one() - 0.5;
            [0.6f32.powi(k as i32) * shape * (1.0 + 0.02 * noise); 3]
        };
        let mut layers: Vec<Layer> = (0..7)
            .map(|k| Layer {
                slot: if k < 6 { Slot::Term(k) } else { Slot::Tail },
                mean: (0..1024).map(|p| value(k, p)).collect(),
                std_error: None,
            })
            .collect();
        let whole = (0..1024).map(|p| [layers.iter().map(|l| l.mean[p][0]).sum::<f32>(); 3]).collect();
        layers.push(Layer { slot: Slot::Whole, mean: whole, std_error: None });
        Pictures { size: [32, 32], layers, code: Code::Float }
    }

    #[test]
    fn constants_come_back_from_terms_and_from_the_whole_alone() {
        let (right, regions) = (terms(1), grid([32, 32]));
        let slots: Vec<Slot> = right.layers.iter().map(|l| l.slot).collect();
        for pattern in
            [Pattern::Everything, Pattern::Connection, Pattern::Bounce(0), Pattern::Bounce(1), Pattern::Bounce(2)]
        {
            for c in [0.5, 0.7, PI] {
                let suspect = pattern.predict(&terms(2), &slots, c);
                for part in [suspect.clone(), suspect.only(|s| s == Slot::Whole)] {
                    let found = pattern.fit(&part, &right, &regions).unwrap();
                    let off = (found.value / c).ln().abs();
                    assert!(off < 5.0 * found.relative_error && off < 0.01, "{pattern:?} {c}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn cuts_and_shifts_are_predicted() {
        let right = terms(1);
        let slots = [Slot::Term(0), Slot::Term(2), Slot::Term(5), Slot::Whole];
        let cut = Pattern::Cut(1).predict(&right, &slots, 1.0);
        assert!(cut.layer(Slot::Term(2)).unwrap().mean.iter().all(|v| *v == [0.0; 3]));
        let early = Pattern::Shift(1).predict(&right, &slots, 1.0);
        assert_eq!(early.layer(Slot::Term(2)).unwrap().mean, right.layer(Slot::Term(3)).unwrap().mean);
        assert!(early.layer(Slot::Term(5)).is_none());
        let late = Pattern::Shift(-1).predict(&right, &slots, 1.0);
        assert_eq!(late.layer(Slot::Term(0)).unwrap().mean[0], [0.0; 3]);
        assert_eq!(late.layer(Slot::Term(2)).unwrap().mean, right.layer(Slot::Term(1)).unwrap().mean);
    }
}
