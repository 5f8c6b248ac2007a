//! The 8-bit code of a linear value, without a power for every pixel.
//!
//! ```text
//! code(v) = round(255 s(v)) = number of thresholds t₁ < t₂ < … < t₂₅₅ with tᵢ ≤ v        tᵢ = min { v : round(255 s(v)) ≥ i }
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | s | transfer curve of sRGB, which increases | [`srgb`](super::picture::srgb) |
//! | tᵢ | the smallest value with code i, found by bisection in s itself, so that every code is that of the formula | [`Codes::new`] |

/// Parts of [0, 1) for which the first code is known. In each of them lie at most two thresholds.
const PARTS: usize = 4096;

/// The thresholds of a curve.
pub(super) struct Codes {
    /// t₁ to t₂₅₅, then two that no value reaches.
    thresholds: [f64; 257],
    /// The code at the start of each part.
    first: [u8; PARTS],
}

impl Codes {
    /// The codes of an increasing curve from [0, 1] to [0, 1].
    pub(super) fn new(curve: impl Fn(f64) -> f64) -> Self {
        // the bit patterns of non-negative numbers have the order of the numbers
        let code = |bits: u64| (255.0 * curve(f64::from_bits(bits))).round();
        let mut thresholds = [f64::INFINITY; 257];
        let mut from = 0u64;
        for (i, t) in thresholds[..255].iter_mut().enumerate() {
            let (mut below, mut at) = (from, 1.0f64.to_bits());
            while below + 1 < at {
                let middle = below + (at - below) / 2;
                *(if code(middle) > i as f64 { &mut at } else { &mut below }) = middle;
            }
            (*t, from) = (f64::from_bits(at), below);
        }
        let start = |part: usize| part as f64 / PARTS as f64;
        let first = std::array::from_fn(|part| thresholds.partition_point(|t| *t <= start(part)) as u8);
        Self { thresholds, first }
    }

    /// The code of a value in [0, 1].
    #[inline]
    pub(super) fn of(&self, v: f64) -> u8 {
        // two comparisons and no branch: a processor cannot predict the codes of noisy pixels
        let first = self.first[((v * PARTS as f64) as usize).min(PARTS - 1)];
        let next = usize::from(first);
        first + u8::from(self.thresholds[next] <= v) + u8::from(self.thresholds[next + 1] <= v)
    }
}

#[cfg(test)]
mod tests {
    use super::Codes;
    use crate::report::image::picture::srgb;

    #[test]
    fn codes_are_those_of_the_formula() {
        let codes = Codes::new(srgb);
        let formula = |v: f64| (255.0 * srgb(v)).round() as u8;
        let values = (0..=200_000).map(|i| f64::from(i) / 200_000.0);
        // and the neighbours of every threshold
        let near = codes.thresholds[..255]
            .iter()
            .flat_map(|t| [-1i64, 0, 1].map(|d| f64::from_bits((t.to_bits() as i64 + d) as u64)));
        for v in values.chain(near).filter(|v| *v <= 1.0) {
            assert_eq!(codes.of(v), formula(v), "{v}");
        }
        assert_eq!((codes.of(0.0), codes.of(1.0)), (0, 255));
        let part = |t: &f64| (t * super::PARTS as f64) as usize;
        let parts: Vec<usize> = codes.thresholds[..255].iter().map(part).collect();
        assert!(parts.windows(3).all(|three| three[0] < three[2]), "no part has three thresholds");
    }
}
