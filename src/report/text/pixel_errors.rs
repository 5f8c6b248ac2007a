//! Which of the `_se` layers of a run can be trusted, pixel by pixel.
//!
//! The rule is that of [`Evidence::of_pixels`]: half the pixels must rest on 12 events, also of those that are met only by chance
//! ([`Doubt`](crate::terms::Doubt)), and the largest contributions must have no heavy tail. Image means are another matter: their errors
//! come from replicates of the whole image.

use crate::stats::Evidence;
use crate::terms::Estimate;
use serde::{Deserialize, Serialize};

/// Names in a line.
const AT_ONCE: usize = 8;

/// What is said of one layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PixelErrors {
    /// `T03`: the errors are in `T03_se`.
    pub layer: String,
    /// Whether they can be trusted.
    pub trusted: bool,
    /// Half the pixels rest on fewer events.
    pub events: f64,
    /// In words: `trusted`, or why not.
    pub why: String,
}

/// Of one layer whose image mean is `image`, half of whose pixels rest on fewer than `events`, made from so many replicates.
pub fn of(layer: &str, image: &Estimate, events: f64, replicates: u64) -> PixelErrors {
    let reason = Evidence::of_pixels(events, image, replicates).no_error;
    let why = reason.map_or("trusted".into(), |why| format!("not trusted: of a pixel, {why}"));
    PixelErrors { layer: layer.to_owned(), trusted: reason.is_none(), events, why }
}

/// One line for those that are trusted, one for those that are not; black layers have no errors to be trusted.
pub fn words(all: &[PixelErrors]) -> String {
    let names = |trusted: bool| {
        let of = |e: &PixelErrors| if trusted { e.layer.clone() } else { format!("{} ({:.0})", e.layer, e.events) };
        all.iter().filter(|e| e.trusted == trusted && e.events > 0.0).map(of).collect::<Vec<_>>()
    };
    let line = |head: &str, names: Vec<String>| {
        let lines: Vec<String> = names.chunks(AT_ONCE).map(|some| some.join(", ")).collect();
        if lines.is_empty() { String::new() } else { format!("{head}:\n  {}\n", lines.join(",\n  ")) }
    };
    let good = line("errors of pixels (_se) to be trusted", names(true));
    let bad = line("not to be trusted (events of a pixel)", names(false));
    (good + &bad).trim_end().to_owned()
}
