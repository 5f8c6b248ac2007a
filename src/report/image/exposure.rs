//! Exposure of the pictures of the terms: each its own, or one gain for all.
//!
//! ```text
//! code_k = round(255 · s(gain_k · T^k E))      auto: gain_k suits term k      otherwise: gain_k is the same for all k
//! ```
//!
//! The terms fall like a geometric series. With its own gain each can be seen; with one gain they can be compared.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | s | transfer curve of sRGB | [`super::picture`] |
//! | gain_k | gain of the picture of term k | [`Exposure::gain`] |
//!
//! Reference: IEC 61966-2-1 (1999), for the transfer curve.

use super::picture::auto_gain;
use std::fmt;
use std::str::FromStr;

/// How pictures of terms are exposed.
///
/// ```
/// use fredholm::report::image::exposure::Exposure;
/// let terms: [&[[f32; 3]]; 2] = [&[[0.4; 3]], &[[0.05; 3]]];
/// let gain = |text: &str| text.parse::<Exposure>().map(|e| e.gain(&terms));
/// assert_eq!(gain("auto"), Ok(None));
/// assert_eq!(gain("0.5"), Ok(Some(0.5)));
/// assert_eq!((gain("T0"), gain("T1")), (Ok(Some(2.0)), Ok(Some(16.0))));
/// assert!(gain("bright").is_err() && gain("0").is_err() && gain("-1").is_err() && gain("inf").is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// Each term has the gain that suits it.
    #[default]
    Auto,
    /// All terms have this gain.
    Gain(f64),
    /// All terms have the gain that suits this one.
    Term(usize),
}

impl Exposure {
    /// The common gain of all pictures; none if each has its own. A term that does not exist has no gain either.
    pub fn gain(self, terms: &[&[[f32; 3]]]) -> Option<f64> {
        match self {
            Self::Auto => None,
            Self::Gain(gain) => Some(gain),
            Self::Term(k) => terms.get(k).map(|pixels| auto_gain(pixels)),
        }
    }
}

impl fmt::Display for Exposure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Gain(gain) => write!(f, "{gain}"),
            Self::Term(k) => write!(f, "T{k}"),
        }
    }
}

impl FromStr for Exposure {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        if let Some(k) = text.strip_prefix('T').and_then(|k| k.parse().ok()) {
            return Ok(Self::Term(k));
        }
        let gain = text.parse().ok().filter(|g: &f64| g.is_finite() && *g > 0.0);
        gain.map(Self::Gain).ok_or(format!("`{text}` is not auto, a gain such as 2, or a term such as T1"))
    }
}
