//! Whether a picture that should be linear was stored with the curve of a display.
//!
//! ```text
//! linear       ln P = ln R + c           slope 1
//! encoded      ln P ≈ ln R / 2.2 + c     slope 0.45, and ln s⁻¹(P) = ln R + c
//! ```
//!
//! An encoded picture differs from the right one almost everywhere, by an amount that depends on the brightness alone. No mistake in
//! light transport does that, so the curve is recognised before any other cause is sought. The exposure c is free.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | P, R | the picture and the right one, channels of all pixels | arguments of [`is_encoded`] |
//! | s | transfer curve of IEC 61966-2-1 (1999), or the power 1/2.2 | [`is_encoded`] |

/// Slopes of ln P against ln R that an encoded picture may have; the curve of sRGB is straight where it is dark.
const ENCODED: std::ops::RangeInclusive<f64> = 0.3..=0.8;
/// The same after decoding.
const LINEAR: std::ops::RangeInclusive<f64> = 0.85..=1.2;
/// Decoding must bring the picture this much closer to the right one.
const CLOSER: f64 = 0.6;
/// Largest range of the ratio of the decoded picture to the right one, over parts of the picture. Where samples were encoded before
/// their mean was taken, the ratio is smaller where the noise is larger.
const EVEN: f64 = 0.12;
/// Parts of a picture.
const PARTS: usize = 8;
/// Fewest values that can tell a curve.
const FEWEST: usize = 64;
/// Smallest range of brightness (interquartile, natural logarithm) that can tell a curve.
const RANGE: f64 = 0.3;

/// Returns true if the values of a picture are those of the right one after the curve of a display.
///
/// ```
/// use fredholm::diagnosis::encoded::is_encoded;
/// let right: Vec<[f32; 3]> = (1..100).map(|i| [0.01 * i as f32, 0.2, 0.004 * i as f32]).collect();
/// let encoded: Vec<[f32; 3]> = right.iter().map(|p| p.map(|v| (0.7 * v).powf(1.0 / 2.2))).collect();
/// assert!(is_encoded(&encoded, &right) && !is_encoded(&right, &right));
/// ```
pub fn is_encoded(picture: &[[f32; 3]], right: &[[f32; 3]]) -> bool {
    let srgb = |s: f64| if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
    let gamma = |s: f64| s.powf(2.2);
    let curves: [&dyn Fn(f64) -> f64; 2] = [&srgb, &gamma];
    curves.iter().any(|decode| is_encoded_by(decode, picture, right))
}

fn is_encoded_by(decode: &dyn Fn(f64) -> f64, picture: &[[f32; 3]], right: &[[f32; 3]]) -> bool {
    // what is clipped or black tells nothing
    let tells = |p: f64, r: f64| p > 0.0 && p < 0.999 && r > 0.0 && r.is_finite();
    let pairs = |c: usize| picture.iter().zip(right).map(move |(p, r)| (f64::from(p[c]), f64::from(r[c])));
    let seen: Vec<(f64, f64)> = (0..3).flat_map(pairs).filter(|(p, r)| tells(*p, *r)).collect();
    if seen.len() < FEWEST {
        return false;
    }
    let x: Vec<f64> = seen.iter().map(|(_, r)| r.ln()).collect();
    let (stored, decoded): (Vec<f64>, Vec<f64>) = seen.iter().map(|(p, _)| (p.ln(), decode(*p).ln())).unzip();
    if spread(x.clone()) < RANGE || !ENCODED.contains(&slope(&x, &stored)) || !LINEAR.contains(&slope(&x, &decoded)) {
        return false;
    }
    // values of equal brightness together: their mean has little noise
    let mut bright = seen.clone();
    bright.sort_by(|a, b| a.1.total_cmp(&b.1));
    let apart = |of: &dyn Fn(f64) -> f64| {
        let ratio = |some: &[(f64, f64)]| {
            let sums = some.iter().fold((0.0, 0.0), |a, (p, r)| (a.0 + of(*p), a.1 + r));
            (sums.0 / sums.1).ln()
        };
        spread(bright.chunks(bright.len().div_ceil(PARTS)).map(ratio).collect())
    };
    let part = |c: usize, part: usize| {
        let some: Vec<(f64, f64)> = pairs(c).skip(part * picture.len() / PARTS).take(picture.len() / PARTS).collect();
        let sums = some.iter().filter(|(p, r)| tells(*p, *r)).fold((0.0, 0.0), |a, (p, r)| (a.0 + decode(*p), a.1 + r));
        (sums.1 > 0.0).then(|| (sums.0 / sums.1).ln())
    };
    let ratios: Vec<f64> = (0..3).flat_map(|c| (0..PARTS).filter_map(move |i| part(c, i))).collect();
    apart(decode) < CLOSER * apart(&|p| p) && ratios.len() > PARTS && spread(ratios) < EVEN
}

/// The range that holds the middle half of some values.
fn spread(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() * 3 / 4] - values[values.len() / 4]
}

/// Slope of y against x, from the means of the lower and of the upper third of x (Bartlett 1949), which noise in x biases less than
/// least squares.
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    let third = order.len() / 3;
    let mean = |of: &[f64], some: &[usize]| some.iter().map(|&i| of[i]).sum::<f64>() / third as f64;
    let (low, high) = (&order[..third], &order[order.len() - third..]);
    (mean(y, high) - mean(y, low)) / (mean(x, high) - mean(x, low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Key, Purpose, Rng};

    /// A picture with a range of brightness, and the same with the noise of a render.
    fn pair(noise: f32) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
        let key = Key::new(3, "encoding");
        let right = |i: u32| {
            let mut rng = Rng::at(key, i, 0, 0, Purpose::Start);
            [0.5, 0.3, 0.1].map(|c| c * (0.05 + rng.one()).powi(2))
        };
        let right: Vec<[f32; 3]> = (0..2000).map(right).collect();
        let noisy = |(i, p): (usize, &[f32; 3])| {
            let mut rng = Rng::at(key, i as u32, 1, 0, Purpose::Start);
            p.map(|v| v * (1.0 + noise * (2.0 * rng.one() - 1.0)))
        };
        let picture = right.iter().enumerate().map(noisy).collect();
        (right, picture)
    }

    #[test]
    fn curves_of_displays_are_recognised_at_any_exposure_and_noise() {
        for noise in [0.0, 0.3, 0.8] {
            for exposure in [0.3f32, 1.0, 2.0] {
                let (right, picture) = pair(noise);
                let of = |f: &dyn Fn(f64) -> f64| -> Vec<[f32; 3]> {
                    picture.iter().map(|p| p.map(|v| f(f64::from(exposure * v)) as f32)).collect()
                };
                let srgb = |v: f64| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
                assert!(is_encoded(&of(&srgb), &right), "sRGB, noise {noise}, exposure {exposure}");
                assert!(is_encoded(&of(&|v| v.powf(1.0 / 2.2)), &right), "gamma, noise {noise}, exposure {exposure}");
                // the right picture, a constant, light that is missing where it is dark, and a square
                // samples that are encoded before their mean is taken: one of two, which is half the time black
                let before = of(&|v| 0.5 * (2.0 * v).powf(1.0 / 2.2));
                let uneven: Vec<[f32; 3]> = picture
                    .iter()
                    .zip(&before)
                    .enumerate()
                    .map(|(i, (p, b))| if i % 500 < 250 { *b } else { p.map(|v| (exposure * v).powf(1.0 / 2.2)) })
                    .collect();
                assert!(!is_encoded(&uneven, &right), "before the mean, noise {noise}, exposure {exposure}");
                for linear in [&(|v| v) as &dyn Fn(f64) -> f64, &|v| 3.0 * v, &|v| (v - 0.01).max(0.0), &|v| v * v] {
                    assert!(!is_encoded(&of(linear), &right), "noise {noise}, exposure {exposure}");
                }
            }
        }
    }
}
