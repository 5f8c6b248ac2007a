//! One image after more and more paths: contact sheet, table and CSV. They give the mean of the samples, and the mean of
//! what a screen shows.
//!
//! Symbols: [`study::stages`](crate::study::stages). All images have the same gain: the one that suits the reference outside
//! the visible lamps.

use crate::report::{
    ReportError, half_width_95,
    image::{
        contact_sheet::shown,
        picture::{Picture, auto_gain, auto_gain_beside_lamps, develop, gain_label, mean, shown_mean},
        sheet::{Tile, slide},
        typeset::Caption,
    },
    text::{
        csv::Csv,
        number::{average, significant},
        table::{Side, aligned},
    },
};
use crate::study::stages::Grown;

/// The values of one image.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of paths: `4`, `8`, …, or `reference`.
    pub name: String,
    /// Mean over pixels and channels, and half width of its 95 % interval.
    pub mean: [f64; 2],
    /// The mean with all values above white cut off.
    pub shown: f64,
    /// Fraction of pixels with a value above white.
    pub clipped: f64,
    /// MSE against the reference, and half width of its 95 % interval; NaN for the reference.
    pub mse: [f64; 2],
    /// Standard deviation estimated from the replicates: root of the variance averaged over pixels.
    pub deviation: f64,
}

/// One row per stage, then one for the reference.
pub fn rows(grown: &Grown, gain: f64) -> Vec<Row> {
    let clipped = |pixels: &[[f32; 3]]| develop(pixels.len(), 1, pixels, gain).clipped as f64 / pixels.len() as f64;
    let mut rows: Vec<Row> = grown
        .stages
        .iter()
        .map(|s| {
            let (mean, half) = average(&s.mean);
            let replicates = s.scatter.replicates() as u64;
            Row {
                name: s.paths.to_string(),
                mean: [mean, half],
                shown: shown_mean(&s.pixels, gain),
                clipped: clipped(&s.pixels),
                mse: [
                    s.scatter.squared_error().unwrap_or(f64::NAN),
                    half_width_95(s.scatter.squared_error_error(), replicates),
                ],
                deviation: s.scatter.variance().sqrt(),
            }
        })
        .collect();
    let (mean, half) = average(&grown.reference_mean);
    let x = &grown.reference.total;
    let square = |p: &[f32; 3]| p.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>();
    let variance = x.std_error.iter().map(square).sum::<f64>() / (3.0 * x.std_error.len() as f64);
    rows.push(Row {
        name: "reference".into(),
        mean: [mean, half],
        shown: shown_mean(&x.mean, gain),
        clipped: clipped(&x.mean),
        mse: [f64::NAN; 2],
        deviation: variance.sqrt(),
    });
    rows
}

/// The gain of all images: chosen for the reference outside the visible lamps.
pub fn gain(grown: &Grown) -> f64 {
    let whole = &grown.reference.total.mean;
    grown.reference.terms.first().map_or_else(|| auto_gain(whole), |lamps| auto_gain_beside_lamps(whole, &lamps.mean))
}

fn number(x: f64, digits: usize) -> String {
    if x.is_nan() { "–".into() } else { significant(x, digits) }
}

/// The root of a mean square error in words; an unbiased estimate of a square may be negative, and then noise hides it.
pub fn rmse(mse: f64) -> String {
    if mse < 0.0 { "≤ noise".into() } else { number(mse.sqrt(), 3) }
}

/// The table of all images.
pub fn table(grown: &Grown) -> String {
    let gain = gain(grown);
    let header = ["paths", "mean", "± 95 %", "mean shown", "lost on screen", "clipped", "RMSE", "noise √V"];
    let mut lines = vec![header.map(String::from).to_vec()];
    lines.extend(rows(grown, gain).iter().map(|r| {
        let lost = format!("{:.1} %", 100.0 * (1.0 - r.shown / r.mean[0]));
        let clipped = format!("{:.2} %", 100.0 * r.clipped);
        let numbers = [number(r.mean[0], 4), number(r.mean[1], 2), number(r.shown, 4), lost, clipped];
        let noise = [rmse(r.mse[0]), number(r.deviation, 3)];
        [r.name.clone()].into_iter().chain(numbers).chain(noise).collect()
    }));
    aligned(&lines, &[[Side::Left].as_slice(), &[Side::Right; 7]].concat())
}

/// The same values as CSV. Values that are not known are left empty.
pub fn csv(grown: &Grown) -> String {
    let mut csv = Csv::new("paths,mean,mean_half_width_95,mean_shown,clipped,mse,mse_half_width_95,noise");
    for r in rows(grown, gain(grown)) {
        csv.put(r.name).numbers(r.mean).numbers([r.shown, r.clipped]).numbers(r.mse).numbers([r.deviation]).end();
    }
    csv.text()
}

/// A slide of every stage and the reference, all with the same gain.
///
/// # Errors
/// If the text cannot be drawn.
pub fn sheet(title: &str, [w, h]: [usize; 2], grown: &Grown, caption: &Caption) -> Result<Picture, ReportError> {
    let g = gain(grown);
    let images = grown.stages.iter().map(|s| s.pixels.as_slice()).chain([grown.reference.total.mean.as_slice()]);
    let mut tiles = vec![];
    for (r, pixels) in rows(grown, g).iter().zip(images) {
        let reference = r.mse[0].is_nan();
        let label = if reference { "reference".into() } else { format!("{} paths per pixel", r.name) };
        let error =
            if reference { format!("noise {}", number(r.deviation, 3)) } else { format!("RMSE {}", rmse(r.mse[0])) };
        let half =
            if r.mean[1].is_nan() { ", error not known".into() } else { format!(" ± {}", number(r.mean[1], 2)) };
        let notes = vec![
            format!("mean {}{half}", number(mean(pixels), 4)),
            format!("mean shown {}", number(r.shown, 4)),
            error,
            format!("clipped {:.2} %", 100.0 * r.clipped),
        ];
        tiles.push(Tile { image: shown(w, h, pixels, g, 384, 440), label, notes });
    }
    slide(&format!("{title} ({})", gain_label(g)), 4, &tiles, None, caption)
}
