//! The promises of the report layer: what is written can be read back, equal input gives equal bytes, and nothing on a
//! plot or page is where it should not be.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as Parts, Layer as Part, LayerAttributes, WritableImage, f16,
};
use fredholm::{
    report::{
        figures::{
            decay::{self, Decay, RateKind, RateLine, independent_ratios},
            variance::{self, Falling, Variance},
        },
        image::{
            contact_sheet::{self, Cell},
            exr as layers,
            picture::{NON_FINITE, auto_gain, develop, gain_label, srgb},
            typeset::Caption,
            zmap,
        },
        page::html::{self, Plate},
        plot::{Curve, Figure, Look, Point},
        text::{
            summary::{self, Bounds, Radiosity, Summary, VerdictRecord},
            table,
        },
    },
    stats::Outcome,
    terms::{Cost, Estimate, Functional, Series, World},
};
use glam::DVec3;
use proptest::prelude::*;

fn caption() -> Caption {
    Caption { command: "fredholm series cornell --spp 16 --seed 3".into(), seed: 3, scene: "cornell".into() }
}

/// A small image with something different in every pixel and channel.
fn ramp(width: usize, height: usize, scale: f32) -> Vec<[f32; 3]> {
    (0..width * height).map(|i| [0, 1, 2].map(|c| scale * (3 * i + c) as f32 / (3 * width * height) as f32)).collect()
}

// ---------------------------------------------------------------------------------------------------------- EXR

#[test]
fn exr_round_trip_keeps_names_attributes_and_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("terms.exr");
    let beauty = ramp(7, 5, 3.0);
    let mut t00 = ramp(7, 5, 1e-30);
    t00[3] = [f32::NAN, f32::INFINITY, -0.0];
    let attributes = [("fredholm.command", "fredholm series ünï".to_owned()), ("fredholm.seed", "7".into())];
    let written = [("T10", &beauty), ("", &beauty), ("T00", &t00), ("T00_se", &beauty)];
    let written = written.map(|(name, pixels)| layers::Layer { name, pixels });
    layers::write(&path, 7, 5, &written, &attributes).unwrap();

    let image = layers::read(&path).unwrap();
    assert_eq!((image.width, image.height), (7, 5));
    let names: Vec<_> = image.layers.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["", "T00", "T00_se", "T10"]);
    for layer in written {
        let bits = |pixels: &[[f32; 3]]| pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(image.layer(layer.name).unwrap()), bits(layer.pixels), "layer {}", layer.name);
    }
    let wanted = attributes.map(|(name, value)| (name.to_owned(), value));
    assert_eq!(image.attributes, wanted);
}

#[test]
fn exr_bytes_are_equal_for_equal_input() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = ramp(40, 40, 1.0);
    // Many attributes: kept in a hash map by the crate, whose order differs between two maps of one process.
    let values: Vec<(String, String)> = (0..12).map(|i| (format!("fredholm.a{i}"), i.to_string())).collect();
    let attributes: Vec<(&str, String)> = values.iter().map(|(n, v)| (n.as_str(), v.clone())).collect();
    let bytes = |name: &str| {
        let path = folder.path().join(name);
        layers::write(&path, 40, 40, &[layers::Layer { name: "", pixels: &pixels }], &attributes).unwrap();
        std::fs::read(path).unwrap()
    };
    let first = bytes("a.exr");
    for i in 0..5 {
        assert_eq!(first, bytes(&format!("b{i}.exr")));
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(left.iter().all(|n| n.to_string_lossy().ends_with(".exr")), "temporary files left: {left:?}");
}

#[test]
fn exr_of_others_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.exr");
    let part = |name: &str, channels: Vec<(&str, FlatSamples)>| {
        let channels = channels.into_iter().map(|(n, s)| AnyChannel::new(n, s)).collect();
        Part::new((2, 1), LayerAttributes::named(name), Encoding::UNCOMPRESSED, AnyChannels::sort(channels))
    };
    let half = |v: [f32; 2]| FlatSamples::F16(v.map(f16::from_f32).to_vec());

    // Half floats with alpha and a missing channel; grey; a depth channel that is no colour.
    let single = part(
        "beauty",
        vec![
            ("R", half([0.5, 2.0])),
            ("B", half([0.25, 4.0])),
            ("A", half([1.0, 1.0])),
            ("grey.Y", FlatSamples::F32(vec![3.0, 5.0])),
            ("depth.Z", FlatSamples::F32(vec![9.0, 9.0])),
        ],
    );
    Parts::from_layer(single).write().to_file(&path).unwrap();
    let image = layers::read(&path).unwrap();
    assert_eq!(
        image.layers,
        [("".into(), vec![[0.5, 0.0, 0.25], [2.0, 0.0, 4.0]]), ("grey".into(), vec![[3.0; 3], [5.0; 3]])]
    );

    // No colour at all is an error that names what is there.
    Parts::from_layer(part("x", vec![("Z", half([1.0, 1.0]))])).write().to_file(&path).unwrap();
    let message = layers::read(&path).unwrap_err().to_string();
    assert!(message.contains("among: Z") && message.contains("other.exr"), "{message}");
}

#[test]
fn broken_and_missing_files_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noise.exr");
    std::fs::write(&path, b"this is not an image").unwrap();
    for (result, words) in [
        (layers::read(&path).map(|_| ()), "not a readable OpenEXR file"),
        (layers::read(&folder.path().join("absent.exr")).map(|_| ()), "absent.exr"),
        (summary::read(&path).map(|_| ()), "not valid JSON"),
        (summary::write(&folder.path().join("no/such/folder.json"), &Summary::default()), "help: "),
        (layers::write(&path, 2, 2, &[layers::Layer { name: "T00", pixels: &[[0.0; 3]] }], &[]), "1 pixels"),
    ] {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}

// ----------------------------------------------------------------------------------------------------- pictures

/// Every 8-bit code comes back from the linear value in the middle of its interval, found with the inverse curve of
/// the standard rather than with ours.
#[test]
fn srgb_codes_are_exact() {
    let inverse = |v: f64| if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    for code in 0..=255u8 {
        let linear = inverse(f64::from(code) / 255.0);
        assert!((srgb(linear) - f64::from(code) / 255.0).abs() < 1e-6);
        let developed = develop(1, 1, &[[(linear / 4.0) as f32; 3]], 4.0);
        assert_eq!(developed.picture.pixels, [[code; 3]]);
    }
}

#[test]
fn png_holds_the_codes_and_counts_what_it_cannot_show() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.png");
    let developed = develop(5, 1, &[[0.5; 3], [2.0, 0.0, 0.0], [-0.1, 0.0, 0.0], [f32::NAN; 3], [0.0, 0.0, 1.0]], 1.0);
    assert_eq!((developed.clipped, developed.negative, developed.non_finite), (1, 1, 1));
    developed.picture.write(&path).unwrap();
    let read = image::open(&path).unwrap().to_rgb8();
    let pixels: Vec<[u8; 3]> = read.pixels().map(|p| p.0).collect();
    assert_eq!(pixels, [[188; 3], [255, 0, 0], [0, 0, 0], NON_FINITE, [0, 0, 255]]);
    assert_eq!(std::fs::read(&path).unwrap(), developed.picture.png(&path).unwrap());
}

proptest! {
    /// The gain is one of the nice numbers and brings a constant image within half a step of 0.8.
    #[test]
    fn auto_exposure_is_nice_and_near(log_level in -30.0f32..10.0) {
        let level = log_level.exp();
        let gain = auto_gain(&[[level; 3]; 10]);
        let up = gain.max(1.0 / gain);
        let mantissa = up / up.log2().floor().exp2();
        prop_assert!((mantissa - 1.0).abs() < 1e-9 || (mantissa - 1.5).abs() < 1e-9, "{gain}");
        let shown = gain * f64::from(level) / 0.8;
        prop_assert!((1.5f64.sqrt().recip() - 1e-6..=1.5f64.sqrt() + 1e-6).contains(&shown), "{gain} shows {shown}");
        prop_assert!(gain_label(gain).starts_with(['×', '÷']));
    }
}

#[test]
fn sheets_show_every_pixel_of_every_image() {
    let (w, h) = (130, 20);
    let images: Vec<_> = (0..7).map(|i| ramp(w, h, 1.0 + i as f32)).collect();
    let cells: Vec<_> =
        images.iter().enumerate().map(|(i, pixels)| Cell { label: format!("T{i}"), pixels, gain: Some(0.1) }).collect();
    let sheet = contact_sheet::grid("seven", w, h, &cells, &caption()).unwrap();
    assert_eq!(sheet.clipped, [0; 7]);
    // Two rows of four: more than three images wide, less than five.
    assert!((4 * w..5 * w).contains(&sheet.picture.width), "{}", sheet.picture.width);
    assert!((2 * h..12 * h).contains(&sheet.picture.height), "{}", sheet.picture.height);
    for pixels in &images {
        let wanted = develop(w, h, pixels, 0.1).picture;
        let page = &sheet.picture;
        let found = (0..page.height - h).any(|y| {
            (0..page.width - w)
                .any(|x| (0..h).all(|r| page.pixels[(y + r) * page.width + x..][..w] == wanted.pixels[r * w..][..w]))
        });
        assert!(found, "an image is covered or missing");
    }

    // A small image is enlarged by a whole factor, and the strip lies below it.
    let (single, gain) = contact_sheet::single("T3", 16, 16, &ramp(16, 16, 0.05), None).unwrap();
    assert_eq!((single.picture.width, gain), (48, 16.0));
    assert!(single.picture.height > 48);
    let codes = develop(16, 16, &ramp(16, 16, 0.05), gain).picture;
    for (i, pixel) in single.picture.pixels[..48 * 48].iter().enumerate() {
        assert_eq!(*pixel, codes.pixels[i / 48 / 3 * 16 + i % 48 / 3]);
    }
    assert!(contact_sheet::grid("none", w, h, &[], &caption()).is_err());
    assert!(contact_sheet::single("T0", 3, 3, &ramp(2, 2, 1.0), None).is_err());
}

#[test]
fn z_map_counts_and_colours() {
    let mut z = vec![0.0; 400];
    z[..4].copy_from_slice(&[f64::NAN, 2.5, -3.5, f64::INFINITY]);
    let map = zmap::draw("T1", 20, 20, &z, &caption()).unwrap();
    assert_eq!(map.defined, 399);
    assert!((map.beyond_2 - 3.0 / 399.0).abs() < 1e-12 && (map.beyond_3 - 2.0 / 399.0).abs() < 1e-12);
    let [r, _, b] = zmap::color(-3.0);
    let [r2, _, b2] = zmap::color(3.0);
    assert!(b > r && r2 > b2, "negative is blue, positive is red");
}

// -------------------------------------------------------------------------------------------------------- plots

/// Numbers of an attribute in every element of one kind.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = element.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

/// Places (in CSS pixels) of everything drawn in the colours of data.
fn data_places(figure: &Figure, colors: &[&str]) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    for element in figure.svg.split('<').filter(|e| colors.iter().any(|c| e.contains(c))) {
        let number = |name| attribute(element, name).and_then(|v| v.parse::<f64>().ok());
        if let (Some(x), Some(y)) = (number("cx"), number("cy")) {
            places.push((x / 10.0, y / 10.0));
        }
        for (x, y) in [("x1", "y1"), ("x2", "y2")] {
            places.extend(number(x).zip(number(y)).map(|(x, y)| (x / 10.0, y / 10.0)));
        }
        let points = attribute(element, "points").unwrap_or_default();
        places.extend(points.split_whitespace().filter_map(|pair| {
            let (x, y) = pair.split_once(',')?;
            Some((x.parse::<f64>().ok()? / 10.0, y.parse::<f64>().ok()? / 10.0))
        }));
    }
    places
}

fn curve(points: Vec<Point>) -> Curve {
    Curve { label: "curve".into(), points, look: Look::SINGLE }
}

const BLUE: &str = "#0072B2";
const GREEN: &str = "#009E73";

/// A curve with values an axis cannot hold: zero, negative, NaN, infinite, an upper limit, a huge error bar, and lines
/// that leave the panel on every side.
#[test]
fn nothing_is_drawn_outside_a_frame() {
    let at = |x: f64, value: f64, std_error: f64| Point { x, value, std_error, replicates: 16 };
    let points = vec![
        at(0.0, 1.0, 0.01),
        at(1.0, 0.5, 0.01),
        at(2.0, 0.25, 0.117),
        at(3.0, -0.01, 0.02),
        at(4.0, 0.0, 0.0),
        at(5.0, f64::NAN, 0.1),
        at(6.0, f64::INFINITY, 0.1),
        at(7.0, 0.1, f64::INFINITY),
        at(8.0, 0.02, 0.001),
    ];
    let line = |value, ratio| RateLine { label: "line".into(), k0: 0.0, value, ratio, kind: RateKind::Guaranteed };
    let decay = Decay {
        title: "hard".into(),
        ratios: vec![curve(independent_ratios(&points))],
        image: vec![curve(points.clone())],
        surface: vec![curve(points)],
        lines: vec![line(1.0, 3.0), line(1.0, 0.01), line(1.0, 0.0), line(1.0, f64::NAN)],
    };
    let figure = decay::draw(&decay, &caption()).unwrap();
    // Frames of the three panels and the column of the legend, in CSS pixels, with the width of a mark.
    let boxes = [[84.0, 72.0, 540.0, 350.0], [84.0, 504.0, 372.0, 220.0], [552.0, 504.0, 372.0, 220.0]];
    let inside = |(x, y): (f64, f64)| {
        let within = |[left, top, w, h]: [f64; 4]| {
            (left - 6.0..=left + w + 6.0).contains(&x) && (top - 0.1..=top + h + 0.1).contains(&y)
        };
        boxes.into_iter().any(within) || x > 640.0 && y < 460.0
    };
    let places = data_places(&figure, &[BLUE, GREEN]);
    assert!(places.len() > 40, "only {} places: the test sees nothing", places.len());
    for place in places {
        assert!(inside(place), "{place:?} is outside every frame");
    }
    // Marks of the surface panel: k = 0, 1, 2, 8 (2 still reaches above zero); 3 and 7 have no finite or positive place.
    let disks = figure.svg.split('<').filter(|e| e.starts_with("circle") && e.contains(BLUE));
    let upper =
        disks.filter_map(|e| Some((attribute(e, "cx")?.parse::<f64>().ok()?, attribute(e, "cy")?.parse().ok()?)));
    let upper: Vec<(f64, f64)> = upper.filter(|&(x, y): &(f64, f64)| x < 6300.0 && y < 4300.0).collect();
    assert_eq!(upper.len(), 4, "{upper:?}");
}

#[test]
fn figures_are_reproducible_and_drawn_at_twice_the_size() {
    let folder = tempfile::tempdir().unwrap();
    let points = (0..8).map(|e| Point { x: 2f64.powi(e), value: 0.5f64.powi(e), std_error: 0.01, replicates: 16 });
    let falling = Falling { curve: curve(points.collect()), slope: Some((-1.0, 0.02)) };
    let variance = Variance { title: "a < b & c".into(), curves: vec![falling] };
    let figure = variance::draw(&variance, &caption()).unwrap();
    assert_eq!(figure, variance::draw(&variance, &caption()).unwrap());
    let [svg, png] = figure.write(folder.path(), "variance").unwrap();
    let read = image::open(png).unwrap();
    assert_eq!((read.width(), read.height()), (2 * figure.width, 2 * figure.height));
    let text = std::fs::read_to_string(svg).unwrap();
    assert!(text.contains(&format!("width=\"{}\" height=\"{}\"", figure.width, figure.height)));
    assert!(text.contains("a &lt; b &amp; c") && text.contains("slope\u{a0}−1.000\u{a0}±\u{a0}0.020"));
    assert!(text.contains("fredholm series cornell --spp 16 --seed 3"));
    assert!(!text.contains("font-family=\"DejaVu Sans\""), "every family has a fallback");
}

// ------------------------------------------------------------------------------------------------------ summary

fn estimate(v: f64, replicates: u64) -> Estimate {
    let std_error = if replicates == 1 { DVec3::NAN } else { DVec3::splat(0.01 * v) };
    Estimate { mean: DVec3::new(v, v / 3.0, v / 7.0), std_error, replicates, events: None }
}

fn full_summary() -> Summary {
    let terms: Vec<_> = (0..3).map(|k| estimate(0.5f64.powi(k), 16)).collect();
    let functional = Functional {
        name: "image".into(),
        terms: terms.clone(),
        tail: estimate(0.1, 1),
        sum: estimate(1.7, 16),
        total: estimate(1.8, 16),
    };
    let cost = Cost { paths: 10, rays: u64::MAX, non_finite: 0, seconds: 0.1 + 0.2 };
    let series = Series {
        world: World::Terms,
        label: "prefix, mis".into(),
        functionals: vec![functional],
        cost,
        unsampled: vec![],
        doubts: vec![],
        undecided: None,
        variance: Default::default(),
    };
    let verdict = VerdictRecord {
        name: "T1: terms − radiosity".into(),
        effect: 1e-300,
        interval: (f64::NEG_INFINITY, 0.1),
        p: f64::NAN,
        min_detectable: 0.3,
        outcome: Outcome::Inconclusive,
    };
    Summary {
        command: "fredholm series \"a b\"".into(),
        seed: u64::MAX,
        seconds: std::f64::consts::PI,
        terms: summary::terms(&terms, &[DVec3::ONE], &[7, 8]),
        tail: estimate(0.1, 1),
        radiosity: Some(Radiosity {
            patches: 600,
            terms: vec![DVec3::X],
            sum: DVec3::Y,
            full: DVec3::Z,
            spectral_radius: DVec3::splat(0.58),
            spectral_radius_limit: DVec3::splat(0.59),
            spectral_radius_limit_error: DVec3::NAN,
            unlit_sides: 0,
            norms: vec![],
            discretisation: DVec3::NAN,
        }),
        bounds: Bounds { max_albedo: DVec3::splat(0.76), ..Bounds::default() },
        verdicts: vec![verdict],
        files: vec!["terms.exr".into()],
        series: vec![series],
        ..Summary::default()
    }
}

/// Equality through the text: NaN differs from itself, its name does not.
#[test]
fn summary_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    let wanted = full_summary();
    summary::write(&path, &wanted).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let found = summary::read(&path).unwrap();
    assert!(found.verdicts[0].interval.0.is_nan(), "infinity is null, and null is NaN");
    let mut expected = wanted.clone();
    expected.verdicts[0].interval.0 = f64::NAN;
    assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    assert!(found.tail.std_error.is_nan() && found.terms[0].ratio.is_nan() && found.path.is_none());
    assert_eq!(found.series[0].cost, wanted.series[0].cost);

    // The keys of the design, in the file.
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    for key in [
        "schema",
        "version",
        "command",
        "scene",
        "scene_hash",
        "seed",
        "spp",
        "max_bounces",
        "threads",
        "seconds",
        "terms",
        "tail",
        "sum",
        "path",
        "radiosity",
        "bounds",
        "cross_moments",
        "verdicts",
        "files",
        "width",
        "height",
        "series",
    ] {
        assert!(value.get(key).is_some(), "no key {key}");
    }
    for key in ["k", "mean", "std_error", "variance", "ratio", "rays"] {
        assert!(value["terms"][0].get(key).is_some(), "no key terms[0].{key}");
    }
    assert!(value["tail"]["std_error"][0].is_null() && value["cross_moments"].is_null());
}

#[test]
fn summaries_of_others_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    let good = serde_json::to_string(&full_summary()).unwrap();
    for (text, words) in [
        (good.replace("fredholm-summary", "other"), "the schema is `other`"),
        (good.replace("\"version\":1", "\"version\":2"), "version 2"),
        (good.replace("\"spp\"", "\"ssp\""), "missing field `spp`"),
        (good.replace("inconclusive", "perhaps"), "perhaps"),
        ("{}".into(), "no key `schema`"),
        ("[1,".into(), "not valid JSON"),
        // A null is NaN only where a floating-point number belongs.
        (good.replace("\"threads\":0", "\"threads\":null"), "null"),
    ] {
        std::fs::write(&path, text).unwrap();
        let message = summary::read(&path).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("help: "), "{words}: {message}");
    }
}

proptest! {
    /// Every number survives the file bit by bit.
    #[test]
    fn numbers_survive(bits in prop::array::uniform3(any::<u64>())) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.json");
        let numbers = bits.map(f64::from_bits);
        let mean = DVec3::from_array(numbers);
        summary::write(&path, &Summary { sum: Estimate::exact(mean), ..Summary::default() }).unwrap();
        for (found, wanted) in summary::read(&path).unwrap().sum.mean.to_array().into_iter().zip(numbers) {
            if wanted.is_finite() {
                prop_assert_eq!(found.to_bits(), wanted.to_bits());
            } else {
                prop_assert!(found.is_nan());
            }
        }
    }
}

// ----------------------------------------------------------------------------------------------- tables and page

#[test]
fn tables_are_aligned_and_narrow() {
    let series = &full_summary().series[0];
    let rays = [123_456_789_012, 5, 999_999];
    let text = table::series("terms", series.image(), &rays);
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 1 + 2 + 3 + 3, "{text}");
    let verdict = VerdictRecord {
        name: "a very long name of a comparison, longer than any".into(),
        ..full_summary().verdicts[0].clone()
    };
    let verdicts = table::verdicts(&[verdict]);
    for line in text.lines().chain(verdicts.lines()) {
        assert!(line.chars().count() <= 100, "{line}");
    }
    // Numbers of a column end in the same place.
    let ends = |row: &str| row.chars().count();
    assert!(lines[3..6].iter().all(|row| ends(row) == ends(lines[3])), "{text}");
    // Average of (v, v/3, v/7); the interval is that of 15 degrees of freedom.
    let mean = (1.0 + 1.0 / 3.0 + 1.0 / 7.0) / 3.0;
    assert!(lines[3].contains(&table::significant(mean, 4)), "{text}");
    assert!(lines[3].contains(&table::significant(2.131_449_5 * 0.01, 2)), "{text}");
    assert!(lines[6].contains('–'), "an unknown error is a dash: {text}");
}

#[test]
fn page_is_self_contained_and_escapes() {
    let folder = tempfile::tempdir().unwrap();
    let (png, svg) = (folder.path().join("terms.png"), folder.path().join("decay.svg"));
    contact_sheet::single("T0", 20, 20, &ramp(20, 20, 1.0), None).unwrap().0.picture.write(&png).unwrap();
    let points = (0..4).map(|k| Point::exact(f64::from(k), 0.5f64.powi(k))).collect();
    let decay = Decay { surface: vec![curve(points)], ..Decay::default() };
    decay::draw(&decay, &caption()).unwrap().write(folder.path(), "decay").unwrap();
    let summary = full_summary();
    let page = html::Page {
        title: "<script>alert(1)</script>".into(),
        command: "fredholm series 'a&b.toml' --set x=\"<b>\"".into(),
        facts: vec![("se<ed".into(), "1 > 0".into())],
        verdicts: &summary.verdicts,
        plates: vec![Plate::terms(&png), Plate::decay(&svg)],
        series: vec![("<i>".into(), summary.series[0].image())],
        files: vec![("a \"b\".exr".into(), "all <terms>".into()), ("javascript:x".into(), String::new())],
    };
    let path = folder.path().join("index.html");
    html::write(&path, &page).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();

    assert!(!text.contains("http"), "the page refers to the network");
    for raw in ["<script", "<b>\"", "<i>", "se<ed", "<terms>", "a \"b\"", "href=\"javascript"] {
        assert!(!text.contains(raw), "{raw} is not escaped");
    }
    assert!(text.contains("&lt;script&gt;") && text.contains("href=\"./a%20%22b%22.exr\""));
    assert!(text.contains("data:image/png;base64,iVBOR") && text.contains("<svg role=\"img\""));
    // Every element that is opened is closed.
    for tag in ["section", "table", "tbody", "tr", "td", "figure", "svg", "main", "header", "dl", "ul"] {
        let opened = text.matches(&format!("<{tag}>")).count() + text.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, text.matches(&format!("</{tag}>")).count(), "<{tag}>");
    }
    let missing = Plate::terms(Path::new("absent.png"));
    assert!(html::render(&html::Page { plates: vec![missing], ..html::Page::default() }).is_err());
}
