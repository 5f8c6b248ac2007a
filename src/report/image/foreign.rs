//! Reads another renderer's pictures: which layers are terms, which is the whole image, and which files belong together.
//!
//! | layer name | taken for |
//! |---|---|
//! | none, `beauty`, `Combined`, `color`, `RGBA`, `image`, `total`, `path` | the whole image |
//! | `T00`, `bounce_1`, `depth3`, `k2`, `order4`, … | the term of that number |
//! | `tail` | everything longer |
//! | the same with `_se`, `_stderr`, `_err` or `_var` | its error |

use super::exr;
use crate::diagnosis::picture::{Code, Layer, Pictures, Slot, is_half};
use crate::engine::MOST_BOUNCES;
use crate::report::{ReportError, files};
use crate::scene::image_header::suits;
use std::collections::BTreeMap;
use std::path::Path;

/// The content of a file.
pub struct File {
    /// Its pictures.
    pub pictures: Pictures,
    /// Text attributes.
    pub attributes: BTreeMap<String, String>,
    /// Names of layers that are neither a term nor a whole image.
    pub ignored: Vec<String>,
}

impl File {
    /// A text attribute by its name, or by that name after `fredholm.`.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let ours = format!("fredholm.{name}");
        self.attributes.get(&ours).or_else(|| self.attributes.get(name)).map(String::as_str)
    }
}

/// Reads an EXR, PNG, JPEG or HDR file.
///
/// # Errors
/// If the file cannot be read, is damaged or too large, has no colours, or holds neither a term nor a whole image.
pub fn read(path: &Path) -> Result<File, ReportError> {
    let bytes = files::read(path)?;
    if bytes.starts_with(&::exr::meta::magic_number::BYTES) { layered(path, &bytes) } else { plain(path, &bytes) }
}

fn wrong(path: &Path, what: &str, help: &str) -> ReportError {
    ReportError::new(path, what, help)
}

/// A diagnosis needs three channels: mistakes differ between them.
fn one_channel_only(path: &Path, channel: String) -> ReportError {
    let what = format!("the picture has one channel, {channel}, and a diagnosis compares red, green and blue");
    wrong(path, &what, "write R, G and B")
}

type Pixels = Vec<[f32; 3]>;

fn layered(path: &Path, bytes: &[u8]) -> Result<File, ReportError> {
    let image = exr::decode(path, bytes)?;
    let (mut means, mut errors, mut ignored) = (BTreeMap::<Slot, Pixels>::new(), BTreeMap::new(), vec![]);
    // the first layer of a kind is taken, and the unnamed one comes first, because it is the one that a viewer shows
    let rank = |name: &str| usize::from(!name.is_empty());
    let mut order: Vec<&(String, Pixels)> = image.layers.iter().collect();
    order.sort_by_key(|l| rank(&l.0));
    for (name, pixels) in order {
        match meaning(name) {
            Some((slot, Part::Mean)) if !means.contains_key(&slot) => {
                means.insert(slot, pixels.clone());
            }
            Some((slot, Part::Error)) => {
                errors.entry(slot).or_insert((name.clone(), pixels.clone()));
            }
            Some((slot, Part::Variance)) => {
                let root = pixels.iter().map(|v| v.map(f32::sqrt)).collect();
                errors.entry(slot).or_insert((name.clone(), root));
            }
            _ => ignored.push(name.clone()),
        }
    }
    // the whole image may be in the file a second time, under a name that has an error layer
    if let Some(whole) = means.get(&Slot::Whole) {
        let twin =
            image.layers.iter().find(|(n, p)| !n.is_empty() && p == whole && image.layer(&format!("{n}_se")).is_some());
        match twin.and_then(|(n, _)| image.layer(&format!("{n}_se"))) {
            Some(error) => {
                errors.insert(Slot::Whole, (String::new(), error.to_vec()));
            }
            // the error of another layer that also shows a whole image
            None if errors.get(&Slot::Whole).is_some_and(|(name, _)| !ALONE.contains(&name.as_str())) => {
                errors.remove(&Slot::Whole);
            }
            None => {}
        }
    }
    let one_channel = means.keys().find_map(|slot| {
        let named = |name: &&String| matches!(meaning(name), Some((s, Part::Mean)) if s == *slot);
        image.grey.iter().find(named)
    });
    if let Some(name) = one_channel {
        return Err(one_channel_only(path, if name.is_empty() { "Y".into() } else { format!("{name}.Y") }));
    }
    ignored.extend(image.incomplete.iter().map(|(name, has)| format!("{name} (only {has})")));
    if means.is_empty() {
        let names: Vec<&str> = image.layers.iter().map(|l| l.0.as_str()).collect();
        let what = format!("no layer is a term or a whole image: {}", names.join(", "));
        return Err(wrong(path, &what, "name the terms T00, T01, …, and leave the whole image unnamed (R G B)"));
    }
    let half = means.values().all(|p| is_half(p) || p.iter().all(|v| *v == [0.0; 3]));
    let layers = means
        .into_iter()
        .map(|(slot, mean)| Layer { slot, mean, std_error: errors.remove(&slot).map(|e: (String, Pixels)| e.1) })
        .collect();
    let code = if half { Code::Half } else { Code::Float };
    Ok(File {
        pictures: Pictures { size: [image.width, image.height], layers, code, step: vec![] },
        attributes: image.attributes.into_iter().collect(),
        ignored,
    })
}

/// Reads an image without layers. Values are kept as they are stored; the diagnosis finds their curve.
fn plain(path: &Path, bytes: &[u8]) -> Result<File, ReportError> {
    suits(bytes).map_err(|unfit| wrong(path, &unfit.what, unfit.help))?;
    let help = "give an .exr, .png, .jpg or .hdr file";
    let image = image::load_from_memory(bytes).map_err(|e| wrong(path, &format!("not a readable image: {e}"), help))?;
    if !image.color().has_color() {
        return Err(one_channel_only(path, "grey".into()));
    }
    let format = image::guess_format(bytes).ok();
    let code = match image.color() {
        image::ColorType::Rgb32F | image::ColorType::Rgba32F => Code::SharedExponent,
        image::ColorType::Rgb16 | image::ColorType::Rgba16 => Code::SixteenBit,
        _ if format == Some(image::ImageFormat::Jpeg) => Code::Jpeg,
        _ => Code::EightBit,
    };
    let size = [image.width() as usize, image.height() as usize];
    let mean: Pixels = image.to_rgb32f().pixels().map(|p| p.0).collect();
    let layers = vec![Layer { slot: Slot::Whole, mean, std_error: None }];
    let pictures = Pictures { size, layers, code, step: vec![] };
    Ok(File { pictures, attributes: BTreeMap::new(), ignored: vec![] })
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Mean,
    Error,
    Variance,
}

/// Names of the layer that holds the error of the unnamed layer.
const ALONE: [&str; 3] = ["se", "stderr", "std_error"];

/// Which image an EXR layer of that name holds, and which colour channel of it; `None` if the name is unknown.
fn meaning(name: &str) -> Option<(Slot, Part)> {
    // of `ViewLayer.Combined` only the last word counts
    let lower = name.rsplit('.').next()?.to_lowercase();
    if ALONE.contains(&lower.as_str()) {
        return Some((Slot::Whole, Part::Error));
    }
    let suffixes = [("_se", Part::Error), ("_stderr", Part::Error), ("_err", Part::Error), ("_var", Part::Variance)];
    let (stem, part) =
        suffixes.iter().find_map(|(s, p)| Some((lower.strip_suffix(s)?, *p))).unwrap_or((&lower, Part::Mean));
    let slot = match stem {
        "" | "beauty" | "combined" | "color" | "colour" | "rgb" | "rgba" | "image" | "final" | "total" | "whole"
        | "path" => Slot::Whole,
        "tail" => Slot::Tail,
        _ => {
            let digits = stem.len() - stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
            let (word, number) = stem.split_at(stem.len() - digits);
            let word = word.trim_end_matches(['_', '-', ' ']);
            let known = ["t", "term", "bounce", "bounces", "depth", "k", "b", "order", "vertex", "length", "indirect"];
            let term = number.parse().ok().filter(|&k| k <= usize::from(MOST_BOUNCES));
            Slot::Term(term.filter(|_| known.contains(&word))?)
        }
    };
    Some((slot, part))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn layers_are_known_by_many_names() {
        for (name, slot, part) in [
            ("", Slot::Whole, Part::Mean),
            ("ViewLayer.Combined", Slot::Whole, Part::Mean),
            ("T03", Slot::Term(3), Part::Mean),
            ("T03_se", Slot::Term(3), Part::Error),
            ("bounce_12", Slot::Term(12), Part::Mean),
            ("Depth0_var", Slot::Term(0), Part::Variance),
            ("tail_se", Slot::Tail, Part::Error),
            ("se", Slot::Whole, Part::Error),
        ] {
            assert_eq!(meaning(name), Some((slot, part)), "{name}");
        }
        for name in ["R03", "Tsum", "albedo", "normal", "depth", "T03x", "T1001", "T99999999999999999999"] {
            assert_eq!(meaning(name), None, "{name}");
        }
    }
}
