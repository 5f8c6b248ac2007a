//! States which of the `_se` layers of a run can be trusted for single pixels.
//!
//! The rule is [`Evidence::of_pixels`]. It requires two things: half the pixels have at least 12 events, counting rare
//! events that are expected but have not occurred ([`Doubt`](crate::terms::Doubt)), and the largest contributions have no
//! heavy tail. The rule does not concern image means, because their errors come from replicates of the whole image.

use crate::stats::Evidence;
use crate::terms::Estimate;
use serde::{Deserialize, Serialize};

/// Largest number of layer names in one line.
const AT_ONCE: usize = 8;

/// The assessment of one layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PixelErrors {
    /// Name of the layer, such as `T03`; its errors are in `T03_se`.
    pub layer: String,
    /// True if the errors can be trusted.
    pub trusted: bool,
    /// Median over the pixels of the number of events.
    pub events: f64,
    /// `trusted`, or the reason why not.
    pub why: String,
}

/// Assesses one layer. `image` is its image mean, half of its pixels have fewer than `events` events, and it was made from
/// `replicates` replicates.
pub fn of(layer: &str, image: &Estimate, events: f64, replicates: u64) -> PixelErrors {
    let reason = Evidence::of_pixels(events, image, replicates).no_error;
    let why = reason.map_or("trusted".into(), |why| format!("not trusted, because for single pixels: {why}"));
    PixelErrors { layer: layer.to_owned(), trusted: reason.is_none(), events, why }
}

/// Lists the layers that can be trusted, then those that cannot. Black layers are left out, because they have no errors.
pub fn words(all: &[PixelErrors]) -> String {
    let names = |trusted: bool| {
        let of = |e: &PixelErrors| if trusted { e.layer.clone() } else { format!("{} ({:.0})", e.layer, e.events) };
        all.iter().filter(|e| e.trusted == trusted && e.events > 0.0).map(of).collect::<Vec<_>>()
    };
    let line = |head: &str, names: Vec<String>| {
        let lines: Vec<String> = names.chunks(AT_ONCE).map(|some| some.join(", ")).collect();
        if lines.is_empty() { String::new() } else { format!("{head}:\n  {}\n", lines.join(",\n  ")) }
    };
    let good = line("pixel errors (_se) that can be trusted", names(true));
    let bad = line("pixel errors that cannot be trusted (in brackets: events per pixel)", names(false));
    (good + &bad).trim_end().to_owned()
}
