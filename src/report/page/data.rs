//! The data of a run that the page draws: numbers as JSON, images as compressed bytes.
//!
//! | element of the page | contents |
//! |---|---|
//! | `<script id="run" type="application/json">` | [`Data`] |
//! | `<script id="px-T03" type="text/plain">` | an image: means ([`Means`]), then standard errors ([`Logarithms`]); its layer says which of them it has |
//! | `<script id="tiles-terms" type="text/plain">` | [`TileSums`] of a world: per tile, slot and channel the mean, then for each replicate the deviation, as half floats |
//!
//! The page derives partial sums and wholes itself; only their errors are stored, because terms of one path are correlated.
//! Radiances are in W sr⁻¹ m⁻². A number that is not finite is `null`.

use super::codes::{Logarithms, Means, text};
use crate::report::{half_width_95, text::pixel_errors::PixelErrors};
use crate::terms::functional::Replicates;
use crate::terms::{TileSums, Variance, World};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;

/// Version of the layout of the data.
pub const VERSION: u32 = 1;

/// Everything that the page draws.
#[derive(Clone, Debug, Default, Serialize)]
#[allow(missing_docs)]
pub struct Data {
    pub version: u32,
    pub scene: String,
    pub command: String,
    pub seed: u64,
    pub spp: u64,
    /// Width and height of the images on the page.
    pub width: usize,
    pub height: usize,
    /// Pixels of the run per pixel of the page, in each direction.
    pub reduced: usize,
    /// Width and height of the images of the run.
    pub full: [usize; 2],
    pub max_bounces: usize,
    /// Exposure at the start: `each` image its own gain, or `one` for all.
    pub gain: &'static str,
    pub layers: Vec<Layer>,
    pub early: Vec<Layer>,
    pub worlds: Vec<Answer>,
    pub bounds: Bounds,
    pub decay: Option<Plot>,
    pub variance: Option<Plot>,
    /// Sentences of the comparisons.
    pub verdicts: Vec<String>,
    /// The compressed bytes, by name of their element.
    #[serde(skip)]
    pub chunks: Vec<(String, String)>,
}

/// What is known of the operator.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Bounds {
    /// Largest albedo of all lobes, per channel: no surface can reflect more than 1/albedo of it.
    pub max_albedo: [f64; 3],
    /// Rate at which the terms fall, per channel.
    pub rate: [Option<f64>; 3],
    /// What this rate is.
    pub rate_is: String,
}

/// Part of a series that an image shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// T^k E.
    Term(usize),
    /// Everything beyond K.
    Rest,
    /// The whole image.
    Whole,
}

impl Serialize for Slot {
    fn serialize<S: serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Term(k) => s.serialize_u64(*k as u64),
            Self::Rest => s.serialize_str("rest"),
            Self::Whole => s.serialize_str("whole"),
        }
    }
}

/// One image.
#[derive(Clone, Debug, Serialize)]
pub struct Layer {
    /// Its name, and that of its element without `px-`.
    pub id: String,
    /// The world that it belongs to.
    pub world: World,
    /// What it shows.
    pub slot: Slot,
    /// Samples per pixel.
    pub spp: u32,
    /// Exponent of its half floats; none if it has no means.
    pub exponent: Option<i32>,
    /// Lowest logarithm and step of its 8-bit codes: of the errors, or for an early image of the image itself.
    pub codes: (f64, f64),
    /// Why the errors of single pixels cannot be trusted; empty if they can.
    pub doubt: String,
}

/// One way to solve the scene.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Which way.
    pub world: World,
    /// Its label in all tables.
    pub label: String,
    /// Mean of each slot over the image, by channel.
    pub mean: Vec<[f64; 3]>,
    /// Deviation of each slot of each replicate; errors and covariances follow from them.
    pub deviation: Vec<Vec<[f64; 3]>>,
    /// Half width of a 95 % interval in units of the standard error; `null` where no error is known.
    pub t95: f64,
    /// Whether the rest and the whole have an error.
    pub variance: Variance,
    /// Exponent of the tile sums.
    pub tiles: i32,
    /// Error of the mesh in the image mean; zero without a mesh.
    pub mesh: [f64; 3],
}

/// Points with intervals.
#[derive(Clone, Debug, Default, Serialize)]
#[allow(missing_docs)]
pub struct Plot {
    pub title: String,
    pub curves: Vec<Curve>,
    pub lines: Vec<Line>,
}

/// One curve.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// Text of the legend.
    pub label: String,
    /// The image that it belongs to, if any: world and slot.
    pub of: Option<(World, Slot)>,
    /// x, value, half width of the 95 % interval (0 if none is known).
    pub points: Vec<[f64; 3]>,
}

/// A geometric line `value · ratio^(x − x0)`.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)]
pub struct Line {
    pub label: String,
    pub x0: f64,
    pub value: f64,
    pub ratio: f64,
}

/// An image for [`Data::push`].
#[derive(Clone, Debug)]
pub struct Image<'a> {
    /// Its name.
    pub id: String,
    /// The world that it belongs to.
    pub world: World,
    /// What it shows.
    pub slot: Slot,
    /// Samples per pixel.
    pub spp: u32,
    /// Its means, unless the page derives them.
    pub mean: Option<&'a [[f32; 3]]>,
    /// Its standard errors.
    pub std_error: &'a [[f32; 3]],
    /// Whether the errors can be trusted.
    pub trust: PixelErrors,
    /// True if the errors of pixels may be added.
    pub apart: bool,
}

/// Standard errors this many powers of two below the largest become equal.
const OCTAVES_OF_ERRORS: f64 = 24.0;
/// Step of the errors: 4 % of rounding at most, where 16 replicates leave an error of 18 % in the error itself.
const STEP_OF_ERRORS: f64 = 0.125;
/// The same for early images, which are rounded by 2 %.
const OCTAVES_OF_IMAGES: f64 = 14.0;
const STEP_OF_IMAGES: f64 = 0.0625;
/// Pixels of a page at most. Larger images are reduced.
pub const PIXELS: usize = 1 << 18;

impl Data {
    /// Data for images of this size. Images with too many pixels will be reduced.
    pub fn new(full: [usize; 2]) -> Self {
        let [width, height] = full;
        let reduced = (1..).find(|n| width.div_ceil(*n) * height.div_ceil(*n) <= PIXELS).unwrap_or(1);
        let [width, height] = [width, height].map(|n| n.div_ceil(reduced));
        Self { version: VERSION, width, height, reduced, full, ..Self::default() }
    }

    /// Adds images. They are packed side by side.
    pub fn push(&mut self, images: &[Image<'_>]) {
        let packed: Vec<_> = images.par_iter().map(|image| self.packed(image)).collect();
        for (layer, bytes) in packed {
            self.chunks.push((format!("px-{}", layer.id), bytes));
            self.layers.push(layer);
        }
    }

    /// An image and its bytes as text.
    fn packed(&self, image: &Image<'_>) -> (Layer, String) {
        let mean = image.mean.map(|pixels| Means::of(&self.mean_of_blocks(pixels)));
        let errors = self.errors_of_blocks(image.std_error, image.apart);
        let errors = Logarithms::of(&errors, OCTAVES_OF_ERRORS, STEP_OF_ERRORS);
        let bytes = [mean.as_ref().map_or(&[][..], |m| &m.bytes), &errors.bytes].concat();
        let layer = Layer {
            id: image.id.clone(),
            world: image.world,
            slot: image.slot,
            spp: image.spp,
            exponent: mean.map(|m| m.exponent),
            codes: (errors.lowest, errors.step),
            doubt: if image.trust.trusted { String::new() } else { image.trust.why.clone() },
        };
        (layer, text(&bytes))
    }

    /// Adds early images of the terms: what they show, samples per pixel, pixels.
    pub fn push_early(&mut self, images: &[(Slot, u32, &[[f32; 3]])]) {
        let pack = |&(slot, spp, pixels): &(Slot, u32, &[[f32; 3]])| {
            let codes = Logarithms::of(&self.mean_of_blocks(pixels), OCTAVES_OF_IMAGES, STEP_OF_IMAGES);
            (slot, spp, (codes.lowest, codes.step), text(&codes.bytes))
        };
        let packed: Vec<_> = images.par_iter().map(pack).collect();
        for (slot, spp, codes, bytes) in packed {
            let name = match slot {
                Slot::Term(k) => format!("T{k:02}"),
                _ => "whole".into(),
            };
            let id = format!("{name}-{spp}");
            self.chunks.push((format!("px-{id}"), bytes));
            self.early.push(Layer { id, world: World::Terms, slot, spp, exponent: None, codes, doubt: String::new() });
        }
    }

    /// Adds the numbers of a world.
    pub fn answer(
        &mut self,
        (world, label): (World, &str),
        replicates: &Replicates,
        tiles: &TileSums,
        variance: Variance,
        mesh: [f64; 3],
    ) {
        let codes = Means::of(&rows_of_tiles(tiles));
        self.chunks.push((format!("tiles-{world}"), text(&codes.bytes)));
        let count = replicates.deviation.len() as u64;
        self.worlds.push(Answer {
            world,
            label: label.to_owned(),
            mean: replicates.mean.iter().map(|m| m.to_array()).collect(),
            deviation: replicates.deviation.iter().map(|d| d.iter().map(|v| v.to_array()).collect()).collect(),
            t95: half_width_95(1.0, count),
            variance,
            tiles: codes.exponent,
            mesh,
        });
    }

    /// Means of blocks of pixels, one for each pixel of the page.
    fn mean_of_blocks(&self, pixels: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.blocks(pixels, |sum, v| sum + f64::from(v), |sum, n| sum / n)
    }

    /// Standard errors of these means, or NaN where pixels share their noise.
    fn errors_of_blocks(&self, errors: &[[f32; 3]], apart: bool) -> Vec<[f32; 3]> {
        let unknown = self.reduced > 1 && !apart;
        let add = |sum: f64, v: f32| sum + f64::from(v) * f64::from(v);
        self.blocks(errors, add, |sum, n| if unknown { f64::NAN } else { sum.sqrt() / n })
    }

    fn blocks(
        &self,
        pixels: &[[f32; 3]],
        add: impl Fn(f64, f32) -> f64,
        end: impl Fn(f64, f64) -> f64,
    ) -> Vec<[f32; 3]> {
        let (n, [w, h]) = (self.reduced, self.full);
        if n == 1 {
            // a pixel is the mean of itself, and an error the root of its square
            return pixels.to_vec();
        }
        let block = |x: usize, y: usize| {
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for (v, u) in (y * n..((y + 1) * n).min(h)).flat_map(|v| (x * n..((x + 1) * n).min(w)).map(move |u| (v, u)))
            {
                let pixel = pixels[v * w + u];
                (0..3).for_each(|c| sum[c] = add(sum[c], pixel[c]));
                count += 1.0;
            }
            sum.map(|s| end(s, count) as f32)
        };
        (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y))).map(|(x, y)| block(x, y)).collect()
    }

    /// The elements of the page that hold the data.
    ///
    /// # Errors
    /// If the numbers cannot be written as JSON, which is a defect of the program.
    pub fn elements(&self) -> Result<String, serde_json::Error> {
        // in a script element only `</` and `<!--` must not occur
        let json = serde_json::to_string(self)?.replace('<', "\\u003c");
        let mut out = format!("<script id=\"run\" type=\"application/json\">{json}</script>\n");
        for (id, bytes) in &self.chunks {
            // writing to a string cannot fail
            let _ = writeln!(out, "<script id=\"{id}\" type=\"text/plain\">{bytes}</script>");
        }
        Ok(out)
    }
}

/// For each tile and slot the mean, then the deviations of the replicates.
fn rows_of_tiles(tiles: &TileSums) -> Vec<[f32; 3]> {
    let each = tiles.mean.iter().enumerate();
    each.flat_map(|(i, mean)| {
        let deviations = &tiles.deviation[i * tiles.replicates..][..tiles.replicates];
        [mean].into_iter().chain(deviations).copied()
    })
    .collect()
}

#[cfg(test)]
#[path = "data_tests.rs"]
#[allow(clippy::unwrap_used)]
mod tests;
