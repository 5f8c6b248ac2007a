//! Curves of a display: how radiance becomes the stored values of a picture.
//!
//! ```text
//! s = transfer(tone(e L))         L = tone⁻¹(transfer⁻¹(s))/e
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L | radiance, linear | argument of [`Curve::encode`], result of [`Curve::decode`] |
//! | e | exposure; not part of a curve | [`Display`](super::display::Display) |
//! | tone | compression of bright values: x/(1 + x) and others | [`Tone`] |
//! | transfer | code of the display: the curve of sRGB, or x^(1/γ) | [`Transfer`] |
//!
//! References: IEC 61966-2-1 (sRGB, 1999); Reinhard et al., *Photographic Tone Reproduction for Digital Images* (2002), equations
//! 3 and 4; Hable, *Filmic Tonemapping Operators* (2010); Narkowicz, *ACES Filmic Tone Mapping Curve* (2015).

use serde::{Serialize, Serializer};

/// Compression of bright values, before the transfer curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tone {
    /// None: s is proportional to radiance.
    None,
    /// x/(1 + x), channel by channel.
    Reinhard,
    /// x (1 + x/w²)/(1 + x) with the white point w.
    ReinhardWhite(f64),
    /// The luminance Y becomes Y/(1 + Y); all channels get the same factor.
    ReinhardLuminance,
    /// The rational function that Narkowicz fitted to the curve of ACES.
    Aces,
    /// Hable's curve with the white point 11.2.
    Filmic,
    /// 1 − exp(−x).
    Exponential,
}

/// Code of the display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// None.
    Linear,
    /// The curve of sRGB.
    Srgb,
    /// x^(1/γ).
    Gamma(f64),
}

/// A curve: tone, then transfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Compression of bright values.
    pub tone: Tone,
    /// Code of the display.
    pub transfer: Transfer,
}

/// Weights of the luminance (Rec. 709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// White point of Hable's curve.
const HABLE_WHITE: f64 = 11.2;

/// (a x² + b x)/(c x² + d x + f), the form of two tone curves; y ≥ 0.
struct Rational {
    top: [f64; 2],
    bottom: [f64; 3],
}

const ACES: Rational = Rational { top: [2.51, 0.03], bottom: [2.43, 0.59, 0.14] };

impl Rational {
    fn at(&self, x: f64) -> f64 {
        let ([a, b], [c, d, f]) = (self.top, self.bottom);
        (x * (a * x + b)) / (x * (c * x + d) + f)
    }

    /// The x ≥ 0 with the value y; NaN if there is none.
    fn inverse(&self, y: f64) -> f64 {
        let ([a, b], [c, d, f]) = (self.top, self.bottom);
        // (a − c y) x² + (b − d y) x − f y = 0
        let (p, q, r) = (a - c * y, b - d * y, -f * y);
        let root = (q * q - 4.0 * p * r).sqrt();
        let x = if q > 0.0 { -2.0 * r / (q + root) } else { (root - q) / (2.0 * p) };
        if x >= 0.0 { x } else { f64::NAN }
    }
}

/// Hable's curve with the constants A = 0.15, B = 0.5, C = 0.1, D = 0.2, E = 0.02, F = 0.3, so that f(0) = 0.
fn hable(x: f64) -> f64 {
    let (a, b, c, d, e, f) = (0.15, 0.5, 0.1, 0.2, 0.02, 0.3);
    (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f
}

/// The inverse of [`hable`] by bisection.
fn hable_inverse(y: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e6);
    if y.is_nan() || y < 0.0 || y > hable(high) {
        return f64::NAN;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if hable(middle) < y { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

impl Tone {
    fn apply(self, x: f64) -> f64 {
        match self {
            Self::None | Self::ReinhardLuminance => x,
            Self::Reinhard => x / (1.0 + x),
            Self::ReinhardWhite(w) => x * (1.0 + x / (w * w)) / (1.0 + x),
            Self::Aces => ACES.at(x),
            Self::Filmic => hable(x) / hable(HABLE_WHITE),
            Self::Exponential => -(-x).exp_m1(),
        }
    }

    fn invert(self, y: f64) -> f64 {
        match self {
            Self::None | Self::ReinhardLuminance => y,
            Self::Reinhard if y < 1.0 => y / (1.0 - y),
            Self::Exponential if y < 1.0 => -(-y).ln_1p(),
            Self::Reinhard | Self::Exponential => f64::NAN,
            Self::ReinhardWhite(w) => {
                let (q, s) = (1.0 - y, 1.0 / (w * w));
                // s x² + q x − y = 0
                2.0 * y / (q + (q * q + 4.0 * s * y).sqrt())
            }
            Self::Aces => ACES.inverse(y),
            Self::Filmic => hable_inverse(y * hable(HABLE_WHITE)),
        }
    }
}

impl Transfer {
    fn apply(self, x: f64) -> f64 {
        match self {
            Self::Linear => x,
            Self::Srgb if x <= 0.003_130_8 => 12.92 * x,
            Self::Srgb => 1.055 * x.powf(1.0 / 2.4) - 0.055,
            Self::Gamma(g) => x.max(0.0).powf(1.0 / g),
        }
    }

    fn invert(self, s: f64) -> f64 {
        match self {
            Self::Linear => s,
            Self::Srgb if s <= 0.04045 => s / 12.92,
            Self::Srgb => ((s + 0.055) / 1.055).powf(2.4),
            Self::Gamma(g) => s.max(0.0).powf(g),
        }
    }
}

impl Curve {
    /// Linear radiance.
    pub const LINEAR: Self = Self { tone: Tone::None, transfer: Transfer::Linear };
    /// The curve of sRGB.
    pub const SRGB: Self = Self { tone: Tone::None, transfer: Transfer::Srgb };

    /// The curves that are tried, the commonest first; all but the linear one.
    pub fn known() -> Vec<Self> {
        let plain =
            [Transfer::Srgb, Transfer::Gamma(2.2), Transfer::Gamma(2.4), Transfer::Gamma(2.0), Transfer::Gamma(1.8)];
        let tones = [
            Tone::Reinhard,
            Tone::ReinhardLuminance,
            Tone::Aces,
            Tone::Filmic,
            Tone::Exponential,
            Tone::ReinhardWhite(2.0),
            Tone::ReinhardWhite(3.0),
            Tone::ReinhardWhite(4.0),
            Tone::ReinhardWhite(8.0),
        ];
        let with = |tone| [Transfer::Srgb, Transfer::Gamma(2.2)].map(|transfer| Self { tone, transfer });
        let toned = tones.into_iter().flat_map(with);
        plain.map(|transfer| Self { tone: Tone::None, transfer }).into_iter().chain(toned).collect()
    }

    /// The stored value of a radiance.
    ///
    /// ```
    /// use fredholm::diagnosis::curve::Curve;
    /// for curve in Curve::known() {
    ///     let back = curve.decode(curve.encode([0.5, 0.2, 0.1]));
    ///     assert!((back[0] - 0.5).abs() < 1e-9 && (back[2] - 0.1).abs() < 1e-9, "{curve}");
    /// }
    /// ```
    pub fn encode(self, radiance: [f64; 3]) -> [f64; 3] {
        let factor = if self.tone == Tone::ReinhardLuminance { 1.0 / (1.0 + luminance(radiance)) } else { 1.0 };
        radiance.map(|v| self.transfer.apply(self.tone.apply(factor * v)))
    }

    /// The radiance of a stored value; NaN if no radiance has this value.
    pub fn decode(self, stored: [f64; 3]) -> [f64; 3] {
        let shown = stored.map(|s| self.transfer.invert(s));
        match self.tone {
            Tone::ReinhardLuminance => {
                let y = luminance(shown);
                shown.map(|v| if y < 1.0 { v / (1.0 - y) } else { f64::NAN })
            }
            tone => shown.map(|v| tone.invert(v)),
        }
    }
}

fn luminance(v: [f64; 3]) -> f64 {
    (0..3).map(|c| LUMINANCE[c] * v[c]).sum()
}

impl std::fmt::Display for Tone {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::None => Ok(()),
            Self::Reinhard => f.write_str("Reinhard"),
            Self::ReinhardWhite(w) => write!(f, "Reinhard with white point {w}"),
            Self::ReinhardLuminance => f.write_str("Reinhard by luminance"),
            Self::Aces => f.write_str("ACES (Narkowicz)"),
            Self::Filmic => f.write_str("filmic (Hable)"),
            Self::Exponential => f.write_str("1 − exp(−x)"),
        }
    }
}

impl std::fmt::Display for Transfer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Linear => f.write_str("linear"),
            Self::Srgb => f.write_str("sRGB"),
            Self::Gamma(g) => write!(f, "gamma {g}"),
        }
    }
}

impl std::fmt::Display for Curve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.tone {
            Tone::None => write!(f, "{}", self.transfer),
            tone => write!(f, "{tone}, then {}", self.transfer),
        }
    }
}

impl Serialize for Curve {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.collect_str(self)
    }
}
