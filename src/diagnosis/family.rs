//! Families of mistakes with a parameter: explanations that need no simulation, because they change the correct terms by a rule.
//!
//! ```text
//! S_k = m_k(c) T_k + a        S = Σ_k m_k(c) T_k        c, a: fitted
//! ```
//!
//! | family | m_k | what is wrong |
//! |---|---|---|
//! | [`Family::Exposure`] | c | units, exposure, number of samples in the mean |
//! | [`Family::Colour`] | c_red, c_green, c_blue | colour of the light, or white balance |
//! | [`Family::Connection`] | 1, c, c, c, … | a constant in the connection to the light |
//! | [`Family::Bounce`] from v | c^max(0, k − v) | the bounce: its density, or roulette without its weight. For v = 0, the BSDF |
//! | [`Family::Term`] k | c for one k | one term is weighted |
//! | [`Family::Missing`] k | 0 for one k | one term is missing |
//! | [`Family::Cut`] after n | 1 to n, then 0 | truncation |
//! | [`Family::Renumbered`] | S_k = T_{k+1} or T_{k−1} | the numbering of terms |
//! | [`Family::Added`] k | 1, and a constant a in term k | a constant ambient term |
//! | [`Family::InWhole`] k | 1; the whole image holds 1 + c times T_k | the sum of the terms |
//! | [`Family::WholeOnly`] | 1; the whole image is c times the correct one | the scale of the sum |
//!
//! If a file has terms and a whole image, the whole image is replaced by the *rest*, the whole image minus the sum of the terms, in the
//! slot of the tail ([`joined`]). The rest has less noise than the whole image, and does not repeat what the terms already say.

use super::picture::{Code, Layer, Pictures, Slot};

/// A family of mistakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// The same factor on all light, including emission.
    Exposure,
    /// A factor for each channel, on all light.
    Colour,
    /// The same factor on all reflected light.
    Connection,
    /// One more factor at every bounce after the given number of bounces.
    Bounce(usize),
    /// A factor on one term.
    Term(usize),
    /// One term is missing.
    Missing(usize),
    /// No light after the given term.
    Cut(usize),
    /// Slot k shows the term k + n, where n is the given number.
    Renumbered(i8),
    /// A constant is added to one term.
    Added(usize),
    /// The whole image holds one term more or less often than its own layers.
    InWhole(usize),
    /// The whole image has another scale than its own layers.
    WholeOnly,
}

impl Family {
    /// All families that can be told apart with the given slots, for terms up to `last`.
    pub fn all(slots: &[Slot], last: usize, any_gain: bool) -> Vec<Self> {
        let terms = slots.iter().any(|s| matches!(s, Slot::Term(_)));
        let mut all = vec![Self::Connection];
        if !any_gain {
            all.extend([Self::Exposure, Self::Added(0)]);
        }
        all.push(Self::Colour);
        // in an image alone, later terms look too much alike
        let (single, start) = if terms { (last, last.min(6)) } else { (last.min(4), last.min(4)) };
        // without a known exposure, a factor on every reflection differs from one on every later bounce by the emission only
        all.extend((usize::from(any_gain)..=start).map(Self::Bounce));
        all.extend((0..=single).flat_map(|k| [Self::Missing(k), Self::Term(k)]));
        all.extend((0..=last).map(Self::Cut));
        if terms {
            all.extend([Self::Renumbered(1), Self::Renumbered(-1)]);
            all.extend((1..=last).map(Self::Added));
        }
        if terms && slots.contains(&Slot::Tail) {
            all.extend((0..=last).map(Self::InWhole));
            all.push(Self::WholeOnly);
        }
        all
    }

    /// Returns true if the parameter is an amount of light, which may be negative, instead of a factor.
    pub fn is_addition(self) -> bool {
        matches!(self, Self::Added(_) | Self::InWhole(_))
    }

    /// Number of fitted parameters.
    pub fn parameters(self) -> usize {
        match self {
            Self::Missing(_) | Self::Cut(_) | Self::Renumbered(_) => 0,
            Self::Colour => 3,
            _ => 1,
        }
    }

    /// Returns true if the prediction is a straight line in the parameter.
    pub fn is_linear(self) -> bool {
        !matches!(self, Self::Bounce(_))
    }

    /// Returns true if the family says nothing about a slot that the file has. The tail holds terms with different factors.
    pub fn leaves_out(self, slot: Slot) -> bool {
        match self {
            Self::Renumbered(_) => true,
            Self::Bounce(_) => slot == Slot::Tail,
            _ => false,
        }
    }

    /// The factor m_k of term k with parameter c.
    pub fn factor(self, k: usize, c: f64) -> f64 {
        match self {
            Self::Exposure | Self::Colour => c,
            Self::Connection if k > 0 => c,
            Self::Bounce(from) => c.powi(k.saturating_sub(from) as i32),
            Self::Term(n) if n == k => c,
            Self::Missing(n) if n == k => 0.0,
            Self::Cut(after) if k > after => 0.0,
            _ => 1.0,
        }
    }

    /// The factors with which the correct terms 0, 1, …, K and the tail add up to the picture of one slot. None if the slot shows
    /// something that the reference does not have.
    pub fn weights(self, slot: Slot, last: usize, c: f64) -> Option<Vec<f64>> {
        let mut weights = vec![0.0; last + 2];
        match (slot, self) {
            (Slot::Term(k), Self::Renumbered(by)) => match k.checked_add_signed(by.into()) {
                Some(source) if source > last => return None,
                Some(source) => weights[source] = 1.0,
                None => {}
            },
            (Slot::Term(k), _) if k <= last => weights[k] = self.factor(k, c),
            (Slot::Tail, Self::Renumbered(_) | Self::Bounce(_)) | (Slot::Term(_), _) => return None,
            (Slot::Tail, Self::InWhole(k)) => {
                weights[k] = c;
                weights[last + 1] += 1.0;
            }
            (Slot::Tail, Self::WholeOnly) => {
                weights.fill(c - 1.0);
                weights[last + 1] = c;
            }
            (Slot::Tail, _) => weights[last + 1] = self.factor(last + 1, c),
            (Slot::Whole, _) => (0..=last + 1).for_each(|k| weights[k] = self.factor(k, c)),
        }
        Some(weights)
    }

    /// The constant that is added to a slot.
    pub fn offset(self, slot: Slot, terms: bool, c: f64) -> f64 {
        match (self, slot) {
            (Self::Added(n), Slot::Term(k)) if n == k => c,
            (Self::Added(_), Slot::Whole) if !terms => c,
            _ => 0.0,
        }
    }

    /// Applies the family to the correct terms; one parameter for each channel. Errors of terms are added linearly, as if all terms
    /// came from the same paths. The whole tail is treated as term K + 1. Slots that the reference cannot predict are left out.
    pub fn predict(self, reference: &Pictures, slots: &[Slot], c: [f64; 3]) -> Pictures {
        let last = reference.last_term().unwrap_or(0);
        let terms = slots.iter().any(|s| matches!(s, Slot::Term(_)));
        let part = |k: usize| reference.layer(if k > last { Slot::Tail } else { Slot::Term(k) });
        let blank = || vec![[0.0f32; 3]; reference.size[0] * reference.size[1]];
        let layer = |&slot: &Slot| {
            let weights = c.map(|c| self.weights(slot, last, c));
            let offset = c.map(|c| self.offset(slot, terms, c) as f32);
            let (mut mean, mut std_error) = (vec![offset; blank().len()], Some(blank()));
            for k in 0..=last + 1 {
                let mut of = [0.0f32; 3];
                for (channel, weights) in weights.iter().enumerate() {
                    of[channel] = weights.as_ref()?[k] as f32;
                }
                if of == [0.0; 3] {
                    continue;
                }
                // a reference without a tail ends with its last term
                let Some(from) = part(k) else { continue };
                let add = |to: &mut Vec<[f32; 3]>, from: &[[f32; 3]], f: [f32; 3]| {
                    to.iter_mut().zip(from).for_each(|(t, v)| (0..3).for_each(|i| t[i] += f[i] * v[i]));
                };
                add(&mut mean, &from.mean, of);
                match (&mut std_error, &from.std_error) {
                    (Some(to), Some(from)) => add(to, from, of.map(f32::abs)),
                    _ => std_error = None,
                }
            }
            Some(Layer { slot, mean, std_error })
        };
        Pictures { layers: slots.iter().filter_map(layer).collect(), ..reference.clone() }
    }
}

/// How the whole image of a file relates to its own layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Relation {
    /// There is only one of the two, or some terms are missing, or the format is too coarse for a difference.
    Apart,
    /// The whole image is the sum of its layers.
    Sum,
    /// The whole image holds more than its layers, or less.
    Rest,
}

/// Values that differ by less than this fraction are the same.
const SAME: f32 = 2e-4;

/// Replaces the whole image by the rest, in the slot of the tail, or leaves it out if it is the sum of the layers.
pub fn joined(pictures: &Pictures, last: usize) -> (Pictures, Relation) {
    let whole = pictures.layer(Slot::Whole);
    let parts: Vec<&Layer> = pictures.layers.iter().filter(|l| l.slot != Slot::Whole).collect();
    let complete = (0..=last).all(|k| pictures.layer(Slot::Term(k)).is_some());
    let Some(whole) = whole.filter(|_| complete && pictures.last_term().is_some()) else {
        return (pictures.clone(), Relation::Apart);
    };
    let rest = |p: usize| -> [f32; 3] {
        std::array::from_fn(|c| whole.mean[p][c] - parts.iter().map(|l| l.mean[p][c]).sum::<f32>())
    };
    let rest: Vec<[f32; 3]> = (0..whole.mean.len()).map(rest).collect();
    let level = whole.mean.iter().flatten().sum::<f32>() / (3 * whole.mean.len()) as f32;
    let same = |(r, w): (&f32, &f32)| {
        r.abs() <= SAME.max(2.0 * pictures.code.rounding() as f32) * w.abs().max(0.1 * level) || r.is_nan()
    };
    if rest.iter().flatten().zip(whole.mean.iter().flatten()).all(same) {
        return (pictures.only(|s| s != Slot::Whole), Relation::Sum);
    }
    // the rounding of a coarser format is larger than the rest
    if pictures.layer(Slot::Tail).is_some() || pictures.code != Code::Float {
        return (pictures.clone(), Relation::Apart);
    }
    let mut joined = pictures.only(|s| s != Slot::Whole);
    joined.layers.push(Layer { slot: Slot::Tail, mean: rest, std_error: None });
    (joined, Relation::Rest)
}
