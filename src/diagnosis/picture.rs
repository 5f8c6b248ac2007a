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
    /// 8 bits, encoded with the sRGB curve.
    EightBit,
}

impl Code {
    /// Relative differences of means up to this value are attributed to rounding.
    pub fn rounding(self) -> f64 {
        match self {
            Self::Float => 1e-5,
            Self::Half => 1e-3,
            Self::EightBit => 1e-2,
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
        Self { size: size.map(|s| s as usize), layers, code: Code::Float }
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
        Self { size: [w, h], layers: layers.collect(), code: self.code }
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
        let small = Pictures { size: [4, 4], layers: vec![layer], code: Code::Float }.shrunk(2);
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
