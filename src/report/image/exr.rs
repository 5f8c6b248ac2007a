//! Several images in one OpenEXR file: one part, float32, one layer per prefix of the channel names (`T03.R`, `T03.G`,
//! `T03.B`).
//!
//! The unnamed layer `R G B` is the one that a viewer shows first. Compression is lossless (run lengths: noise hardly compresses, and ZIP takes
//! sixteen times as long for files that are 8 % smaller). Equal input gives equal bytes: blocks are written in scan-line order, and header attributes in the order of their names. The crate
//! keeps custom attributes in a hash map, whose order differs from run to run; `sort_attributes` corrects this.
//!
//! Reference: Kainz, Bogart, Stanczyk, Hillman, *Technical Introduction to OpenEXR* (2013), and the file layout page of
//! the OpenEXR documentation.

use std::{
    collections::{BTreeMap, BTreeSet},
    io::Cursor,
    path::Path,
};

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, ImageAttributes,
    IntegerBounds, Layer as Part, LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, Vec2, WritableImage, f16,
};

use crate::report::{ReportError, files, write_atomically};
use crate::scene::Crop;
use crate::scene::image_header::{FEW_BYTES, suits};

/// One image to be written.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// Prefix of its channels. Empty for the unnamed layer, which viewers show first.
    pub name: &'a str,
    /// Linear RGB, row by row from the top.
    pub pixels: &'a [[f32; 3]],
}

/// Contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The pixel of the picture, from the top left, that is the first one here: (0, 0) but for a crop.
    pub from: [i32; 2],
    /// Width and height of the picture.
    pub of: [usize; 2],
    /// Name and pixels of each layer, sorted by name; the unnamed layer has an empty name.
    pub layers: Vec<(String, Vec<[f32; 3]>)>,
    /// Names of the layers that have one channel, `Y`, which stands for all three.
    pub grey: Vec<String>,
    /// Layers that are left out because they lack one of R, G and B, with the channels that they have.
    pub incomplete: Vec<(String, String)>,
    /// Names and values of custom attributes that are texts or numbers, sorted by name.
    pub attributes: Vec<(String, String)>,
}

impl Image {
    /// The pixels of one layer, if it exists.
    pub fn layer(&self, name: &str) -> Option<&[[f32; 3]]> {
        self.layers.iter().find(|(n, _)| n == name).map(|(_, pixels)| pixels.as_slice())
    }
}

/// Writes all layers into one file. Values are stored bit by bit, including NaN and infinity.
///
/// # Errors
/// If a layer has the wrong number of pixels, a name occurs twice, the size is zero, or the file cannot be written.
pub fn write(
    path: &Path,
    width: usize,
    height: usize,
    layers: &[Layer],
    attributes: &[(&str, String)],
) -> Result<(), ReportError> {
    let whole = [width as u32, height as u32];
    write_crop(path, Crop::whole(whole), whole, layers, attributes)
}

/// Writes some pixels of a picture of size `whole`: they are the data window of the file, and the picture is its display window.
///
/// # Errors
/// As of [`write()`].
pub fn write_crop(
    path: &Path,
    crop: Crop,
    whole: [u32; 2],
    layers: &[Layer],
    attributes: &[(&str, String)],
) -> Result<(), ReportError> {
    let [width, height] = crop.size.map(|n| n as usize);
    let wrong = |cause: String| ReportError::new(path, cause, "this is a defect of the program: please report it");
    if width == 0 || height == 0 || layers.is_empty() {
        return Err(wrong(format!("an image of {width}×{height} pixels with {} layers is empty", layers.len())));
    }
    let mut names = BTreeSet::new();
    for layer in layers {
        if layer.pixels.len() != width * height {
            let (n, name) = (layer.pixels.len(), layer.name);
            return Err(wrong(format!("layer `{name}` has {n} pixels instead of {width}×{height}")));
        }
        if !names.insert(layer.name) {
            return Err(wrong(format!("two layers are called `{}`", layer.name)));
        }
    }

    // One channel per layer and colour component, sorted as the format requires.
    let channel = |layer: &Layer, component: usize| {
        let letter = ["R", "G", "B"][component];
        let name = if layer.name.is_empty() { letter.to_owned() } else { format!("{}.{letter}", layer.name) };
        let samples = layer.pixels.iter().map(|p| p[component]).collect();
        AnyChannel::new(text(&name), FlatSamples::F32(samples))
    };
    let channels = layers.iter().flat_map(|layer| (0..3).map(move |c| channel(layer, c))).collect();

    let mut own = LayerAttributes::named("fredholm");
    let [x, y] = crop.from.map(|n| n as i32);
    own.layer_position = Vec2(x, y);
    for (name, value) in attributes {
        own.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let encoding =
        Encoding { compression: Compression::RLE, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut image =
        exr::prelude::Image::from_layer(Part::new((width, height), own, encoding, AnyChannels::sort(channels)));
    let [width, height] = whole.map(|n| n as usize);
    image.attributes.display_window = IntegerBounds::new(Vec2(0, 0), Vec2(width, height));
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).map_err(|e| wrong(e.to_string()))?;
    let bytes = sort_attributes(&bytes.into_inner()).ok_or_else(|| wrong("the header cannot be parsed".into()))?;
    write_atomically(path, &bytes)
}

/// Reads every RGB layer of a file, written by this or another program. The file may have one or several parts, with half,
/// float or integer samples. A grey layer (`Y`) is read as RGB. Channels that are not colours (alpha, depth, normals) are
/// left out, and so are layers that lack one of `R G B`. If a file has several parts, the part's name replaces a missing prefix.
///
/// # Errors
/// If the file cannot be read, its parts differ in size, two layers share a name, no colour is found, or the file holds only a part of
/// the picture (crop) or more than it (overscan).
pub fn read(path: &Path) -> Result<Image, ReportError> {
    decode(path, &files::read(path)?)
}

/// The same for a file that may hold only a part of the picture (crop).
///
/// # Errors
/// As of [`read`], but for crops.
pub fn read_crop(path: &Path) -> Result<Image, ReportError> {
    Ok(decode_any(path, &files::read(path)?)?.0)
}

/// The layers of a file that was read into memory; errors name `path`.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Image, ReportError> {
    const HELP: &str = "write the whole picture and nothing else (fredholm: without --crop): data window and display window must be equal";
    match decode_any(path, bytes)? {
        (_, Some(cause)) => Err(ReportError::new(path, cause, HELP)),
        (image, None) => Ok(image),
    }
}

/// The layers of a file, and in which way its pixels are not those of the picture, if they are not.
fn decode_any(path: &Path, bytes: &[u8]) -> Result<(Image, Option<String>), ReportError> {
    let wrong = |cause: String, help: &str| ReportError::new(path, cause, help);
    suits(bytes).map_err(|unfit| wrong(unfit.what, unfit.help))?;
    let reader =
        exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let reader = if bytes.len() < FEW_BYTES { reader.non_parallel() } else { reader };
    let found = reader
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| wrong(format!("not a readable OpenEXR file: {e}"), "give a flat (not deep) OpenEXR image"))?;

    let display = found.attributes.display_window;
    let of = [display.size.0, display.size.1];
    let (mut size, mut unlike, mut from) = (None, None, [0; 2]);
    let mut planes: BTreeMap<String, BTreeMap<char, Vec<f32>>> = BTreeMap::new();
    let mut seen = Vec::new();
    let several = found.layer_data.len() > 1;
    for part in &found.layer_data {
        let here = (part.size.0, part.size.1);
        if *size.get_or_insert(here) != here {
            return Err(wrong("its parts differ in size".into(), "give parts of one size, or one part"));
        }
        unlike = unlike.or(whole(part, &found.attributes).err());
        let own = part.absolute_bounds().position;
        from = [own.0 - display.position.0, own.1 - display.position.1];
        let part_name = part.attributes.layer_name.as_ref().filter(|_| several).map(plain).unwrap_or_default();
        for channel in &part.channel_data.list {
            let name = plain(&channel.name);
            let (prefix, component) = name.rsplit_once('.').unwrap_or(("", &name));
            let prefix = if prefix.is_empty() { &part_name } else { prefix };
            seen.push(name.clone());
            let Some(letter @ ('R' | 'G' | 'B' | 'Y')) = single_letter(component) else { continue };
            let samples = floats(&channel.sample_data);
            if samples.len() != here.0 * here.1 {
                let cause = format!("channel `{name}` is subsampled");
                return Err(wrong(cause, "store every channel at full resolution"));
            }
            if planes.entry(prefix.to_owned()).or_default().insert(letter, samples).is_some() {
                return Err(wrong(format!("two layers are called `{prefix}`"), "give each part its own name"));
            }
        }
    }
    if planes.is_empty() {
        let cause = format!("no colour channel among: {}", seen.join(", "));
        return Err(wrong(cause, "name the channels R G B, or LAYER.R LAYER.G LAYER.B"));
    }

    let (width, height) = size.unwrap_or((0, 0));
    let (mut layers, mut grey, mut incomplete) = (vec![], vec![], vec![]);
    for (name, plane) in planes {
        let one = |c: char, i: usize| plane.get(&c).map_or(0.0, |samples| samples[i]);
        let channels: Vec<char> = if plane.keys().all(|&c| c == 'Y') { vec!['Y'; 3] } else { vec!['R', 'G', 'B'] };
        if !channels.iter().all(|c| plane.contains_key(c)) {
            let has: Vec<String> = plane.keys().map(char::to_string).collect();
            incomplete.push((name, has.join(" ")));
            continue;
        }
        if channels[0] == 'Y' {
            grey.push(name.clone());
        }
        let pixels = (0..width * height).map(|i| [0, 1, 2].map(|c| one(channels[c], i))).collect();
        layers.push((name, pixels));
    }
    if let (true, Some((name, has))) = (layers.is_empty(), incomplete.first()) {
        let layer = if name.is_empty() { "the picture".into() } else { format!("the layer `{name}`") };
        let help = "write all three, or a grey picture as Y";
        return Err(wrong(format!("{layer} has only the channel {has}, not R, G and B"), help));
    }
    let mut attributes: Vec<_> = (found.layer_data.iter().flat_map(|part| &part.attributes.other))
        .chain(&found.attributes.other)
        .filter_map(|(name, value)| Some((plain(name), readable(value)?)))
        .collect();
    attributes.sort();
    attributes.dedup();
    Ok((Image { width, height, from, of, layers, grey, incomplete, attributes }, unlike))
}

/// Returns an error if the pixels of a part are not those of the picture: its data window is not its display window.
fn whole(part: &Part<AnyChannels<FlatSamples>>, image: &ImageAttributes) -> Result<(), String> {
    let (data, display) = (part.absolute_bounds(), image.display_window);
    if data == display {
        return Ok(());
    }
    let [from, to] = [(data.position.0, data.position.1), (data.end().0 - 1, data.end().1 - 1)];
    let [x, y] = [display.position.0, display.position.1];
    let (w, h) = (display.size.0, display.size.1);
    let inside = data.position.0 >= x
        && data.position.1 >= y
        && data.end().0 <= display.end().0
        && data.end().1 <= display.end().1;
    let what = if inside { "a crop" } else { "a picture with overscan" };
    Err(format!(
        "the file holds {what}: the pixels {from:?} to {to:?} of a picture of {w}×{h} pixels that starts at {:?}",
        (x, y)
    ))
}

/// UTF-8 bytes unchanged; the crate's own conversion accepts only Latin-1.
fn text(s: &str) -> Text {
    Text::from_slice_unchecked(s.as_bytes())
}

fn plain(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

fn single_letter(s: &str) -> Option<char> {
    let mut chars = s.chars();
    chars.next().filter(|_| chars.next().is_none())
}

fn floats(samples: &FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F32(v) => v.clone(),
        FlatSamples::F16(v) => v.iter().copied().map(f16::to_f32).collect(),
        FlatSamples::U32(v) => v.iter().map(|&u| u as f32).collect(),
    }
}

fn readable(value: &AttributeValue) -> Option<String> {
    match value {
        AttributeValue::Text(t) => Some(plain(t)),
        AttributeValue::I32(v) => Some(v.to_string()),
        AttributeValue::F32(v) => Some(v.to_string()),
        AttributeValue::F64(v) => Some(v.to_string()),
        _ => None,
    }
}

/// Sorts the header attributes of a single-part file by name. An attribute is stored as `name 0 type 0 size data`, and the
/// header ends with an empty name. Offsets in the file do not change.
fn sort_attributes(file: &[u8]) -> Option<Vec<u8>> {
    const MAGIC_AND_VERSION: usize = 8;
    let mut attributes = Vec::new();
    let mut at = MAGIC_AND_VERSION;
    while *file.get(at)? != 0 {
        let start = at;
        for _ in 0..2 {
            at += file.get(at..)?.iter().position(|&b| b == 0)? + 1;
        }
        let size = u32::from_le_bytes(file.get(at..at + 4)?.try_into().ok()?) as usize;
        at += 4 + size;
        attributes.push(file.get(start..at)?);
    }
    // No two attributes share a name, so comparing whole records compares names first.
    attributes.sort_unstable();
    Some([&file[..MAGIC_AND_VERSION], &attributes.concat(), &file[at..]].concat())
}
