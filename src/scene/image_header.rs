//! The size that the header of an image promises, checked before memory is asked for.
//!
//! ```text
//! pixels ≤ 2²⁶          bits of all pixels ≤ r × bits of the file
//! ```
//!
//! r is the largest ratio that the compression of the format allows. A file whose header promises more is damaged: its decoder would reserve
//! memory for pixels that cannot follow.
//!
//! | file | at most, per byte of the file | because |
//! |---|---|---|
//! | EXR | 2048 samples | the runs of every compression of the format are shorter |
//! | PNG | 1032 bytes | the longest match of deflate, 258 bytes, takes two bits |
//! | JPEG | 512 pixels | a block of 8 × 8 pixels takes a bit |
//! | HDR | 4096 pixels | the format has longer runs, but no program writes rows of that length |
//!
//! Reference: Deutsch (1996), RFC 1951, for deflate; ITU-T T.81 (1992), section F, for JPEG.

use exr::meta::{MetaData, header::Header};
use image::{ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;

/// Pixels of an image at most: 16384 × 4096 as linear floats take 800 MB.
pub const MOST_PIXELS: u64 = 1 << 26;

/// An EXR file that is smaller is decoded by one thread: the crate starts a pool of threads for each file, which takes longer.
pub const FEW_BYTES: usize = 1 << 18;

/// The reason why an image is not decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unfit {
    /// What is wrong; it completes "cannot read the image: …".
    pub what: String,
    /// What to do next.
    pub help: &'static str,
}

/// Checks the header of an EXR, PNG, JPEG or HDR file.
///
/// # Errors
/// If it promises no pixels, more than [`MOST_PIXELS`], or more than the file can hold. A header that cannot be read is no error here: the reader
/// of the format has the words for it.
///
/// ```
/// use fredholm::scene::image_header::suits;
/// let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000000 +X 1000000000\n";
/// assert!(suits(huge).unwrap_err().what.contains("1000000000×1000000000 pixels"));
/// ```
pub fn suits(bytes: &[u8]) -> Result<(), Unfit> {
    if bytes.starts_with(&exr::meta::magic_number::BYTES) { layers(bytes) } else { plain(bytes) }
}

fn layers(bytes: &[u8]) -> Result<(), Unfit> {
    const DENSEST: u64 = 2048;
    let Ok(meta) = MetaData::read_from_buffered(bytes, false) else { return Ok(()) };
    let size = |header: &Header| [header.layer_size.0 as u64, header.layer_size.1 as u64];
    meta.headers.iter().map(size).try_for_each(size_fits)?;
    let samples = |h: &Header| size(h)[0] * size(h)[1] * h.channels.list.len() as u64;
    let all = meta.headers.iter().map(samples).sum();
    if all > DENSEST * bytes.len() as u64 { Err(damaged(all, "samples", bytes)) } else { Ok(()) }
}

fn plain(bytes: &[u8]) -> Result<(), Unfit> {
    let Ok(mut reader) = ImageReader::new(Cursor::new(bytes)).with_guessed_format() else { return Ok(()) };
    // a size beyond the limits of the decoder is no error of the header
    reader.no_limits();
    let Some((format, Ok(decoder))) = reader.format().map(|format| (format, reader.into_decoder())) else {
        return Ok(());
    };
    let size = <[u32; 2]>::from(decoder.dimensions()).map(u64::from);
    size_fits(size)?;
    if let Some(n) = palette(bytes).filter(|n| format == ImageFormat::Png && n % 3 != 0) {
        let what = format!("its palette has {n} bytes, which are not three for each colour");
        return Err(Unfit { what, help: "the file is damaged: write it again" });
    }
    let pixels = size[0] * size[1];
    let length = bytes.len() as u64;
    let fits = match format {
        ImageFormat::Png => pixels * u64::from(decoder.original_color_type().bits_per_pixel()) <= 8 * 1032 * length,
        ImageFormat::Jpeg => pixels <= 512 * length,
        _ => pixels <= 4096 * length,
    };
    if fits { Ok(()) } else { Err(damaged(pixels, "pixels", bytes)) }
}

/// The bytes of the first palette of a PNG file. Its decoder panics if they are not whole colours (png 0.18.1).
fn palette(bytes: &[u8]) -> Option<usize> {
    let mut rest = bytes.get(8..)?;
    loop {
        let length = u32::from_be_bytes(*rest.first_chunk()?) as usize;
        if rest.get(4..8)? == b"PLTE" {
            return Some(length);
        }
        rest = rest.get(length.checked_add(12)?..)?;
    }
}

fn size_fits([w, h]: [u64; 2]) -> Result<(), Unfit> {
    match w.saturating_mul(h) {
        0 => Err(Unfit { what: "it has no pixels".into(), help: "write it again" }),
        1..=MOST_PIXELS => Ok(()),
        _ => {
            let what = format!("it has {w}×{h} pixels; {} million are possible", MOST_PIXELS >> 20);
            Err(Unfit { what, help: "reduce the image; 4096 pixels across are more than a picture of a scene shows" })
        }
    }
}

fn damaged(count: u64, what: &str, bytes: &[u8]) -> Unfit {
    let what = format!("its header promises {count} {what}, more than {} bytes can hold", bytes.len());
    Unfit { what, help: "the file is damaged: write it again" }
}
