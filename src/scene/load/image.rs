//! Reading of image files as linear radiance or albedo.
//!
//! ```text
//! linear = s/12.92                    for s ≤ 0.04045
//!          ((s + 0.055)/1.055)^2.4    for s above          (IEC 61966-2-1, 1999)
//! ```
//!
//! s is the encoded value in [0, 1], n the stored integer.
//!
//! | file | numbers | decoding |
//! |---|---|---|
//! | `.exr` | float; the `R`, `G`, `B` of the first layer that has them | none: already linear |
//! | `.hdr` | RGBE (Ward 1991) | none: already linear |
//! | `.png`, `.jpg` | 8 or 16 bits, s = n/(2^bits − 1) | by the curve above |
//!
//! No value is repaired: an image with a texel that is not a finite number of at least 0 is an error.

use crate::{
    math::Rgb,
    scene::{
        SceneError,
        image_header::{FEW_BYTES, suits},
        raster::Raster,
    },
};
use image::{DynamicImage, ImageReader};
use std::{io::Cursor, path::Path};

const FORMATS: &str = "images are .exr, .hdr, .png or .jpg";

/// Returns true if the file name ends like an image that [`read`] can read.
pub(super) fn is_image(path: &Path) -> bool {
    matches!(extension(path).as_str(), "exr" | "hdr" | "png" | "jpg" | "jpeg")
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Reads an image. The caller adds the place where the file is named to the error.
pub(super) fn read(path: &Path) -> Result<Raster, SceneError> {
    let shown = path.display();
    if !is_image(path) {
        return Err(SceneError::new(format!("`{shown}` is not an image that this program can read")).help(FORMATS));
    }
    // a pipe would be waited for, and a device never ends
    if path.exists() && !path.is_file() {
        return Err(SceneError::new(format!("`{shown}` is not a file")).help(FORMATS));
    }
    let fail = |e: &dyn std::fmt::Display| {
        let reason = e.to_string().lines().collect::<Vec<_>>().join(", ");
        let help = if path.is_file() { FORMATS } else { "paths are relative to the file that names them" };
        SceneError::new(format!("cannot read `{shown}`: {reason}")).help(help)
    };
    let bytes = std::fs::read(path).map_err(|e| fail(&e))?;
    suits(&bytes)
        .map_err(|unfit| SceneError::new(format!("cannot read `{shown}`: {}", unfit.what)).help(unfit.help))?;
    let raster = if extension(path) == "exr" { exr(&bytes).map_err(|e| fail(&e)) } else { other(&bytes, &fail) }?;
    let wrong = raster.texels.iter().position(|t| t.to_array().iter().any(|x| !(x.is_finite() && *x >= 0.0)));
    match wrong {
        Some(i) => {
            let what = format!("{} of `{shown}` is {}", texel(&raster, i), raster.texels[i]);
            Err(SceneError::new(what).help("every channel must be a finite number of at least 0: repair the image"))
        }
        None => Ok(raster),
    }
}

/// The position of the `i`-th texel, for messages.
pub(super) fn texel(raster: &Raster, i: usize) -> String {
    let width = raster.size[0] as usize;
    format!("the texel in column {}, row {}", i % width, i / width)
}

/// The largest value of each channel.
pub(super) fn largest(raster: &Raster) -> Rgb {
    raster.texels.iter().fold(Rgb::ZERO, |a, &t| a.max(t))
}

fn exr(bytes: &[u8]) -> exr::error::Result<Raster> {
    use exr::prelude::{ReadChannels, ReadLayers, Vec2, read};
    let reader = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size: Vec2<usize>, _| (size, vec![Rgb::ZERO; size.area()]),
            |(size, texels): &mut (Vec2<usize>, Vec<Rgb>), at: Vec2<usize>, (r, g, b): (f32, f32, f32)| {
                texels[at.y() * size.x() + at.x()] = Rgb::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes();
    let reader = if bytes.len() < FEW_BYTES { reader.non_parallel() } else { reader };
    let image = reader.from_buffered(Cursor::new(bytes))?;
    let (size, texels) = image.layer_data.channel_data.pixels;
    Ok(Raster::new([size.x() as u32, size.y() as u32], texels))
}

fn other(bytes: &[u8], fail: &dyn Fn(&dyn std::fmt::Display) -> SceneError) -> Result<Raster, SceneError> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| fail(&e))?;
    if reader.format().is_none() {
        return Err(fail(&"it is no image of a known format"));
    }
    // the size was checked
    reader.no_limits();
    let image = reader.decode().map_err(|e| fail(&e))?;
    let size = [image.width(), image.height()];
    if let DynamicImage::ImageRgb32F(linear) = &image {
        return Ok(Raster::new(size, linear.pixels().map(|p| Rgb::from_array(p.0)).collect()));
    }
    if image.color().has_alpha() && image.to_rgba16().pixels().any(|p| p.0[3] != u16::MAX) {
        return Err(fail(&"it has transparent texels"));
    }
    let linear = |n: u16| decode(f64::from(n) / f64::from(u16::MAX)) as f32;
    Ok(Raster::new(size, image.to_rgb16().pixels().map(|p| Rgb::from_array(p.0.map(linear))).collect()))
}

/// Converts sRGB to linear, on [0, 1].
fn decode(s: f64) -> f64 {
    if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}
