//! Images that are too large, or no files: refused in words, never a wait. (Damaged files are in `fuzz.rs`.)

use super::*;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder,
    WritableImage, f16,
};
use std::time::{Duration, Instant};

/// The header of a PNG file that claims to be that large.
fn claims(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend([width.to_be_bytes(), height.to_be_bytes()].concat());
    chunk.extend([8, 2, 0, 0, 0]);
    let crc = chunk.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { (c >> 1) ^ 0xedb8_8320 } else { c >> 1 })
    });
    let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    file.extend(chunk);
    file.extend((!crc).to_be_bytes());
    file.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    file
}

#[test]
fn what_is_too_large_or_no_file_is_refused_at_once() {
    let dir = gallery();
    std::fs::write(dir.path().join("huge.png"), claims(20_000, 20_000)).unwrap();
    std::fs::write(dir.path().join("huge.hdr"), b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000 +X 20000\n").unwrap();
    std::fs::create_dir(dir.path().join("folder.png")).unwrap();
    let mut names =
        vec![("huge.png", "20000×20000 pixels"), ("huge.hdr", "20000×4000 pixels"), ("folder.png", "is not a file")];
    if std::process::Command::new("mkfifo").arg(dir.path().join("pipe.png")).status().is_ok_and(|s| s.success()) {
        names.push(("pipe.png", "is not a file"));
    }
    for (name, what) in names {
        let begin = Instant::now();
        let text = RICH.replace("wall.png", name);
        let e = toml(&text, &dir.path().join("rich.toml"), &Options::default()).unwrap_err();
        assert!(e.what.contains(what) && e.help.is_some() && e.line.is_some(), "{e}");
        assert!(begin.elapsed() < Duration::from_secs(5), "{name}");
    }
}

/// Black images are the smallest for their size. No writer makes them so small that they look damaged.
#[test]
fn what_is_well_compressed_is_read() {
    use fredholm::scene::image_header::suits;
    use image::codecs::{jpeg::JpegEncoder, png};
    let side = 1024;
    let grey = image::GrayImage::new(side, side);
    let mut files: Vec<(&str, Vec<u8>)> = vec![];
    let mut bytes = vec![];
    let best = png::PngEncoder::new_with_quality(&mut bytes, png::CompressionType::Best, png::FilterType::NoFilter);
    grey.write_with_encoder(best).unwrap();
    files.push(("PNG", std::mem::take(&mut bytes)));
    grey.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, 1)).unwrap();
    files.push(("JPEG", std::mem::take(&mut bytes)));
    image::Rgb32FImage::new(side, side)
        .write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Hdr)
        .unwrap();
    files.push(("HDR", std::mem::take(&mut bytes)));
    for compression in [Compression::ZIP16, Compression::ZIP1, Compression::RLE, Compression::PIZ] {
        let samples = || FlatSamples::F16(vec![f16::ZERO; (side * side) as usize]);
        let channels = ["B", "G", "R"].map(|c| AnyChannel::new(c, samples())).into_iter().collect();
        let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        let size = (side as usize, side as usize);
        let layer = Layer::new(size, LayerAttributes::named("black"), encoding, AnyChannels::sort(channels));
        let mut out = std::io::Cursor::new(vec![]);
        Image::from_layer(layer).write().to_buffered(&mut out).unwrap();
        files.push(("EXR", out.into_inner()));
    }
    for (name, bytes) in files {
        let pixels = u64::from(side) * u64::from(side);
        assert!(pixels > 3 * bytes.len() as u64, "{name}: {} bytes are not well compressed", bytes.len());
        assert_eq!(suits(&bytes), Ok(()), "{name}: {} bytes", bytes.len());
    }
}
