//! The input pictures: terms, their sum, and the standard errors of their pixels.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S_k | picture of T^k E by the renderer under test | [`Slot::Term`] |
//! | S | the whole image, Σ_k S_k including the tail | [`Slot::Whole`] |
//! | s | standard error of a pixel, if the file contains it | [`Layer::std_error`] |

use crate::engine::by_rays::Sampled;
use crate::terms::TermImage;
use serde::Serialize;

/// The part of L = Σ T^k E that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub enum Slot {
    /// The term T^k E.
    Term(usize),
    /// The sum of all terms after the last one given.
    Tail,
    /// The whole image.
    Whole,
}

impl Slot {
    /// Its name in a sentence: `T2`, or `the image` for the whole one.
    pub fn in_words(self) -> String {
        if self == Self::Whole { "the image".into() } else { self.to_string() }
    }
}

impl std::fmt::Display for Slot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Term(k) => write!(f, "T{k}"),
            Self::Tail => f.write_str("tail"),
            Self::Whole => f.write_str("whole"),
        }
    }
}

/// One picture: linear RGB, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The part it shows.
    pub slot: Slot,
    /// Radiance of each pixel.
    pub mean: Vec<[f32; 3]>,
    /// Standard error of each pixel; none if not known.
    pub std_error: Option<Vec<[f32; 3]>>,
}

/// Number format of the file. It determines the rounding error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Code {
    /// 32-bit floating point.
    Float,
    /// 16-bit floating point, even if it was converted to 32 bits afterwards.
    Half,
    /// Radiance HDR: three mantissas of 8 bits with one exponent.
    SharedExponent,
    /// 16 bits, encoded for a display. Values are stored as numbers from 0 to 1.
    SixteenBit,
    /// 8 bits, encoded for a display. Values are stored as numbers from 0 to 1.
    EightBit,
    /// JPEG: 8 bits, encoded for a display, in blocks that lose detail.
    Jpeg,
}

impl Code {
    /// Relative differences of means up to this value are attributed to rounding. The values of a shared exponent are rounded relative
    /// to the largest channel.
    pub fn rounding(self) -> f64 {
        match self {
            Self::Float => 1e-5,
            Self::Half => 1e-3,
            Self::SharedExponent | Self::SixteenBit => 4e-3,
            Self::EightBit => 1e-2,
            Self::Jpeg => 3e-2,
        }
    }

    /// Returns true if the values are encoded for a display, so that their exposure and their curve are unknown.
    pub fn for_display(self) -> bool {
        self.step() > 0.0
    }

    /// Distance between two neighbouring stored values; 0 for floating point.
    pub fn step(self) -> f64 {
        match self {
            Self::Float | Self::Half | Self::SharedExponent => 0.0,
            Self::SixteenBit => 1.0 / 65535.0,
            Self::EightBit | Self::Jpeg => 1.0 / 255.0,
        }
    }
}

/// Pictures of one scene by one renderer.
#[derive(Clone, Debug, PartialEq)]
pub struct Pictures {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// One or more layers, each slot at most once.
    pub layers: Vec<Layer>,
    /// Number format of the file.
    pub code: Code,
    /// Distance between neighbouring stored values, as radiance, for each pixel; empty for floating point.
    pub step: Vec<[f32; 3]>,
}

impl Pictures {
    /// The layers of a render by this program.
    pub fn of(sampled: &Sampled, size: [u32; 2]) -> Self {
        let layer = |slot, image: &TermImage| Layer {
            slot,
            mean: image.mean.clone(),
            std_error: Some(image.std_error.clone()),
        };
        let mut layers: Vec<Layer> =
            sampled.terms.iter().enumerate().map(|(k, image)| layer(Slot::Term(k), image)).collect();
        if !sampled.terms.is_empty() && !sampled.series.image().tail.is_none() {
            layers.push(layer(Slot::Tail, &sampled.tail));
        }
        layers.push(layer(Slot::Whole, &sampled.total));
        Self { size: size.map(|s| s as usize), layers, code: Code::Float, step: vec![] }
    }

    /// The layer of a slot, if there is one.
    pub fn layer(&self, slot: Slot) -> Option<&Layer> {
        self.layers.iter().find(|l| l.slot == slot)
    }

    /// The number of the last term, if there is any.
    pub fn last_term(&self) -> Option<usize> {
        let k = |l: &Layer| if let Slot::Term(k) = l.slot { Some(k) } else { None };
        self.layers.iter().filter_map(k).max()
    }

    /// One image that both sets have, from each: the whole image, or else the sum of the terms in both.
    pub fn image_in_common(&self, other: &Self) -> Option<[Vec<[f32; 3]>; 2]> {
        if let Some((a, b)) = self.layer(Slot::Whole).zip(other.layer(Slot::Whole)) {
            return Some([a.mean.clone(), b.mean.clone()]);
        }
        let both: Vec<(&Layer, &Layer)> = self.layers.iter().filter_map(|l| Some((l, other.layer(l.slot)?))).collect();
        both.first()?;
        let add = |mut sum: Vec<[f32; 3]>, l: &Layer| {
            sum.iter_mut().zip(&l.mean).for_each(|(s, v)| (0..3).for_each(|c| s[c] += v[c]));
            sum
        };
        let blank = vec![[0.0f32; 3]; both[0].0.mean.len()];
        let sum =
            |pick: &dyn Fn(&(&Layer, &Layer)) -> Layer| both.iter().map(pick).fold(blank.clone(), |s, l| add(s, &l));
        Some([sum(&|l| l.0.clone()), sum(&|l| l.1.clone())])
    }

    /// The same pictures with only the slots that `keep` selects.
    #[must_use]
    pub fn only(&self, keep: impl Fn(Slot) -> bool) -> Self {
        let layers = self.layers.iter().filter(|l| keep(l.slot)).cloned().collect();
        Self { layers, ..self.clone() }
    }

    /// Multiplies every value by `gain`.
    #[must_use]
    pub fn times(mut self, gain: f64) -> Self {
        let scale = |pixels: &mut Vec<[f32; 3]>| pixels.iter_mut().flatten().for_each(|v| *v *= gain as f32);
        for layer in &mut self.layers {
            scale(&mut layer.mean);
            layer.std_error.as_mut().map(scale);
        }
        scale(&mut self.step);
        self
    }

    /// Averages blocks of `factor × factor` pixels. Pixels are treated as independent. `factor` must divide both sides.
    #[must_use]
    pub fn shrunk(&self, factor: usize) -> Self {
        if factor == 1 {
            return self.clone();
        }
        let [width, height] = self.size;
        let [w, h] = [width / factor, height / factor];
        let block = |i: usize| {
            let (x, y) = (i % w * factor, i / w * factor);
            (y..y + factor).flat_map(move |y| (x..x + factor).map(move |x| y * width + x))
        };
        let n = (factor * factor) as f64;
        let gather = |pixels: &[[f32; 3]], i: usize, power: i32| -> [f32; 3] {
            std::array::from_fn(|c| {
                let sum: f64 = block(i).map(|p| f64::from(pixels[p][c]).powi(power)).sum();
                if power == 1 { (sum / n) as f32 } else { (sum.sqrt() / n) as f32 }
            })
        };
        let layers = self.layers.iter().map(|l| Layer {
            slot: l.slot,
            mean: (0..w * h).map(|i| gather(&l.mean, i, 1)).collect(),
            std_error: l.std_error.as_ref().map(|s| (0..w * h).map(|i| gather(s, i, 2)).collect()),
        });
        let step = if self.step.is_empty() { vec![] } else { (0..w * h).map(|i| gather(&self.step, i, 1)).collect() };
        Self { size: [w, h], layers: layers.collect(), code: self.code, step }
    }
}

/// Returns true if all values fit in 16-bit floating point; the file then probably had this format.
pub fn is_half(pixels: &[[f32; 3]]) -> bool {
    // a half has 10 bits of mantissa, a float 23
    pixels.iter().flatten().all(|v| v.to_bits() & 0x1fff == 0) && pixels.iter().flatten().any(|v| v.fract() != 0.0)
}

/// The smallest factor that divides both sides and leaves at most `widest` pixels on the longer one; 1 if there is none.
pub fn shrink_factor([w, h]: [usize; 2], widest: usize) -> usize {
    let divides = |f: &usize| w.is_multiple_of(*f) && h.is_multiple_of(*f);
    let enough = |f: &usize| w.max(h) / f <= widest;
    (1..=w.min(h) / 16).filter(divides).find(enough).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shrinking_keeps_means_and_adds_variances() {
        let layer = Layer {
            slot: Slot::Whole,
            mean: (0..16).map(|i| [i as f32; 3]).collect(),
            std_error: Some(vec![[2.0; 3]; 16]),
        };
        let small = Pictures { size: [4, 4], layers: vec![layer], code: Code::Float, step: vec![] }.shrunk(2);
        assert_eq!(small.size, [2, 2]);
        assert_eq!(small.layers[0].mean[1], [(2.0 + 3.0 + 6.0 + 7.0) / 4.0; 3]);
        assert_eq!(small.layers[0].std_error.as_ref().map(|s| s[0]), Some([1.0; 3]));
    }

    #[test]
    fn a_factor_divides_both_sides() {
        assert_eq!(shrink_factor([256, 256], 96), 4);
        assert_eq!(shrink_factor([64, 64], 96), 1);
        assert_eq!(shrink_factor([192, 144], 96), 2);
        assert_eq!(shrink_factor([211, 211], 96), 1);
    }

    #[test]
    fn halves_are_recognised() {
        assert!(is_half(&[[0.5, 0.25, 1.5]]));
        assert!(!is_half(&[[0.1, 0.25, 1.5]]));
        assert!(!is_half(&[[0.0, 1.0, 2.0]]));
    }
}
