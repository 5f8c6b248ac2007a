//! Pictures by a path tracer that shares no code with the library: forty mistakes, each as terms in layers, as one image and as 8 bits;
//! and correct pictures in many formats, exposures and curves.
//!
//! | | named right | named wrong |
//! |---|---|---|
//! | explanation | one of the names in [`TRUTH`] is among at most three | there are names, and none of them is |
//! | constant | within five standard errors | |
//!
//! "Wrong, and the cause is not known" and "cannot tell" are never counted as named wrong.

use super::tracer::{BUGS, Bug, Kind, Picture, RIGHT, render};
use super::*;
use fredholm::diagnosis::Suspicion;
use fredholm::diagnosis::curve::{Curve, Tone, Transfer};

const SIDE: usize = 64;
const TERMS: usize = 6;
/// K of the reference of an image alone, as of the command.
const DEEP: usize = 20;

/// The names that are right for each mistake, and the constant that belongs to them. A mistake that is not listed has no name.
const TRUTH: &[(&str, &[&str], Option<f64>)] = &[
    ("no-pi", &["constant-in-the-bsdf"], Some(std::f64::consts::PI)),
    ("no-pi-in-connection", &["constant-in-the-connection"], Some(std::f64::consts::PI)),
    ("connection-3-percent-weak", &["constant-in-the-connection"], Some(0.97)),
    ("connection-half-too-strong", &["constant-in-the-connection"], Some(1.5)),
    ("lamp-twice", &["constant-in-the-connection", "double-emission"], Some(2.0)),
    ("emission-forgotten", &["emission-missing"], None),
    ("roulette-unweighted", &["constant-in-the-bounce"], Some(0.8)),
    ("late-roulette-unweighted", &["constant-in-the-bounce"], Some(0.7)),
    ("roulette-weighted-twice", &["constant-in-the-bounce"], Some(1.25)),
    ("roulette-wrong-divisor", &["constant-in-the-bounce"], Some(1.5)),
    ("term-2-stronger", &["one-term-scaled"], Some(1.2)),
    ("term-3-missing", &["one-term-missing"], None),
    ("ends-after-3", &["truncated"], None),
    ("layers-off-by-one", &["off-by-one"], None),
    ("half-pixel-right", &["shifted"], None),
    ("one-pixel-down", &["shifted"], None),
    ("left-right", &["another-view"], None),
    ("upside-down", &["another-view"], None),
    ("red-blue-swapped", &["another-view"], None),
    ("srgb", &["encoded"], None),
    ("gamma", &["encoded"], None),
    ("paths-encoded", &["gamma-before-mean"], None),
    ("paths-clamped", &["clamped at 1"], None),
    ("pixels-clamped", &["clamped"], None),
    ("no-cosine", &["no-receiver-cosine"], None),
    ("no-lamp-cosine", &["no-light-cosine"], None),
    ("distance-not-squared", &["distance-not-squared"], None),
    ("no-shadows", &["no-shadow-test"], None),
    ("uniform-directions", &["uniform-as-cosine"], None),
    ("uniform-density", &["cosine-as-uniform"], None),
    ("albedo-twice", &["albedo-twice"], None),
    ("darker", &["exposure"], Some(0.95)),
    ("half-lamp", &["half-lamp"], None),
    ("lamp-both-sides", &["light-from-behind"], None),
    ("same-seed", &["same-numbers"], None),
    ("not-a-number", &["not-a-number"], None),
    ("ambient", &["constant-added"], Some(0.02)),
];

/// The correct terms at this size, with terms up to K, and the candidates.
struct Truth {
    bench: Bench,
    deepest: usize,
}

impl Truth {
    fn new(side: usize, last: usize, deepest: usize) -> Self {
        let size = [side as u32; 2];
        let scene = Scene::new(&Stage::CORNELL.load(size).unwrap());
        let spp = 8_000_000 / (side * side) as u32;
        let usual = Settings::default();
        let roulette = usual.path_roulette.clone().after(last);
        let s = Settings { spp, seed: own_seed(0), max_bounces: last, roulette, ..usual };
        let right = Pictures::of(&by_rays::terms(&scene, Estimator::Prefix, &s, Progress::NONE), size);
        Self { bench: Bench { right, seen: regions::seen(&scene), scene }, deepest }
    }

    fn members(&self) -> Members<'_> {
        Members::new(&self.bench.scene, self.deepest, 0, Progress::NONE)
    }
}

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Layers,
    Image,
    EightBits,
}

fn stored(picture: &Picture, form: Form) -> Pictures {
    let layer = |slot, mean: &Vec<[f32; 3]>| Layer { slot, mean: mean.clone(), std_error: None };
    let whole = layer(Slot::Whole, &picture.whole);
    let (layers, code) = match form {
        Form::Layers => {
            let terms = picture.terms.iter().enumerate().map(|(k, t)| layer(Slot::Term(k), t));
            (terms.chain([whole]).collect(), Code::Float)
        }
        Form::Image => (vec![whole], Code::Float),
        Form::EightBits => {
            // values that are encoded already are written as they are
            let curve = if picture.encoded { Curve::LINEAR } else { Curve::SRGB };
            (vec![Layer { mean: in_steps(&picture.whole, curve, 1.0, 255.0), ..whole }], Code::EightBit)
        }
    };
    Pictures { size: [picture.size; 2], layers, code, step: vec![] }
}

/// Values for a display, rounded to steps.
fn in_steps(radiance: &[[f32; 3]], curve: Curve, exposure: f64, steps: f64) -> Vec<[f32; 3]> {
    let value = |v: f64| if v.is_nan() { 0.0 } else { ((v.clamp(0.0, 1.0) * steps).round() / steps) as f32 };
    radiance.iter().map(|v| curve.encode(v.map(|x| exposure * f64::from(x))).map(value)).collect()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Grade {
    Right,
    Wrong,
    Open,
}

fn grade(bug: &Bug, form: Form, d: &Diagnosis) -> Grade {
    if matches!(bug.kind, Kind::Firefly(_)) {
        return if d.verdict == Conclusion::Undecided && !d.outliers.is_empty() { Grade::Right } else { Grade::Open };
    }
    let truth = TRUTH.iter().find(|t| t.0 == bug.name);
    let named: Vec<_> = d.named().collect();
    // without a known exposure, a factor on every reflection is one on every later bounce; and the sum of layers that begin with T1 lacks
    // the emission
    let also = |s: &Suspicion| match bug.kind {
        Kind::NoPi => form == Form::EightBits && s.is("constant-in-the-bounce"),
        Kind::LayersOffByOne => form != Form::Layers && s.is("emission-missing"),
        _ => false,
    };
    let Some((_, names, constant)) = truth else {
        return if named.is_empty() { Grade::Open } else { Grade::Wrong };
    };
    let right = named.iter().find(|s| names.iter().any(|n| s.is(n)) || also(s));
    let Some(right) = right else { return if named.is_empty() { Grade::Open } else { Grade::Wrong } };
    let close = |c: &fredholm::diagnosis::fit::Constant| {
        constant.is_none_or(|truth| (c.value - truth).abs() < 5.0 * c.std_error.max(1e-4 * truth))
    };
    // clipped noise moves the constants of 8 bits
    let close = form == Form::EightBits || right.constants.first().is_none_or(close);
    if close && named.len() <= 3 { Grade::Right } else { Grade::Wrong }
}

/// Hands in mistakes in all forms. Returns how many were named right in each form, and the table.
fn hand_in_all(bugs: &[&Bug], forms: &[Form], spp: u32, seed: u64) -> ([usize; 3], String) {
    let (layers, image) = (Truth::new(SIDE, TERMS, TERMS), Truth::new(SIDE, DEEP, 8));
    let members = [layers.members(), image.members()];
    let (mut right, mut table) = ([0; 3], String::new());
    for bug in bugs {
        let picture = render(bug, SIDE, spp, TERMS, seed);
        for &form in forms {
            let which = usize::from(form != Form::Layers);
            let truth = [&layers, &image][which];
            let d = truth.bench.judge_at_length(
                &stored(&picture, form),
                Some(&members[which]),
                1e-3,
                Effort::default().paths,
            );
            let grade = grade(bug, form, &d);
            right[form as usize] += usize::from(grade == Grade::Right);
            let what: Vec<&str> = d.named().map(|s| s.what.as_str()).collect();
            writeln!(table, "{grade:?} {:<26} {form:?} {:?} {}", bug.name, d.verdict, what.join(" | ")).unwrap();
        }
    }
    assert!(!table.lines().any(|l| l.starts_with("Wrong")), "a wrong name:\n{table}");
    (right, table)
}

fn bugs(names: &[&str]) -> Vec<&'static Bug> {
    names.iter().map(|n| BUGS.iter().find(|b| b.name == *n).unwrap()).collect()
}

/// One mistake of each kind of explanation; those of families and of the file take no simulation.
#[test]
fn strangers_are_named_from_layers() {
    let account = ledger::open("strangers_are_named_from_layers", 0);
    let names = [
        "connection-3-percent-weak",
        "late-roulette-unweighted",
        "term-3-missing",
        "layers-off-by-one",
        "half-pixel-right",
        "upside-down",
        "srgb",
        "pixels-clamped",
        "no-lamp-cosine",
        "ambient",
        "firefly",
    ];
    let (right, table) = hand_in_all(&bugs(&names), &[Form::Layers], 256, account.seed());
    assert_eq!(right[0], names.len(), "\n{table}");
}

#[test]
fn strangers_are_named_from_images() {
    let account = ledger::open("strangers_are_named_from_images", 0);
    let names = ["no-pi-in-connection", "roulette-unweighted", "gamma", "emission-forgotten", "darker"];
    let (right, table) = hand_in_all(&bugs(&names), &[Form::Image], 256, account.seed());
    assert_eq!(right[1], names.len(), "\n{table}");
    let names = ["ends-after-3", "red-blue-swapped", "no-shadows", "one-pixel-down"];
    let (right, table) = hand_in_all(&bugs(&names), &[Form::EightBits], 256, account.seed());
    assert_eq!(right[2], names.len(), "\n{table}");
}

/// All forty, in all forms.
#[test]
#[ignore = "nightly"]
fn all_strangers_are_named_or_honestly_unnamed() {
    let account = ledger::open("all_strangers_are_named_or_honestly_unnamed", 0);
    let all: Vec<&Bug> = BUGS.iter().collect();
    let (right, table) = hand_in_all(&all, &[Form::Layers, Form::Image, Form::EightBits], 256, account.seed());
    println!("{table}\nnamed right of {}: layers {}, image {}, 8 bits {}", all.len(), right[0], right[1], right[2]);
    assert!(right[0] >= 34 && right[1] >= 28 && right[2] >= 16, "\n{table}");
}

/// Correct pictures: the form, exposure and curve of each.
fn correct_pictures(n: usize, seed: u64) -> Vec<(String, Pictures, usize)> {
    let curves = Curve::known();
    let sizes = [(64, 64), (64, 256), (96, 128), (48, 512)];
    let renders: Vec<Picture> =
        sizes.iter().enumerate().map(|(i, (side, spp))| render(&RIGHT, *side, *spp, TERMS, seed + i as u64)).collect();
    (0..n)
        .map(|i| {
            let picture = &renders[i % renders.len()];
            let exposure = [1.0, 0.25, 0.5, 2.0, 0.1, 1.3][(i / 4) % 6];
            let curve = curves[(7 * i) % curves.len()];
            // several exposures of the same render are as many pictures of a student's folder
            let form = ["layers", "image", "half", "png", "png", "png16", "jpeg", "jpeg"][(i / 3) % 8];
            let layer = |mean| vec![Layer { slot: Slot::Whole, mean, std_error: None }];
            let size = [picture.size; 2];
            let with = |layers, code| Pictures { size, layers, code, step: vec![] };
            let half = |v: f32| half::f16::from_f32(v).to_f32();
            let pictures = match form {
                "layers" => stored(picture, Form::Layers),
                "image" => stored(picture, Form::Image),
                "half" => with(layer(picture.whole.iter().map(|v| v.map(half)).collect()), Code::Half),
                "png" => with(layer(in_steps(&picture.whole, curve, exposure, 255.0)), Code::EightBit),
                "png16" => with(layer(in_steps(&picture.whole, curve, exposure, 65535.0)), Code::SixteenBit),
                _ => with(layer(through_jpeg(picture, curve, exposure, 75 + (i % 20) as u8)), Code::Jpeg),
            };
            let words = if ["layers", "image", "half"].contains(&form) {
                String::new()
            } else {
                format!(", {curve}, exposure {exposure}")
            };
            (format!("{form} {}{words}", picture.size), pictures, picture.size)
        })
        .collect()
}

fn through_jpeg(picture: &Picture, curve: Curve, exposure: f64, quality: u8) -> Vec<[f32; 3]> {
    let bytes =
        in_steps(&picture.whole, curve, exposure, 255.0).into_iter().flatten().map(|v| (255.0 * v).round() as u8);
    let side = picture.size as u32;
    let image = image::RgbImage::from_raw(side, side, bytes.collect()).unwrap();
    let mut file = std::io::Cursor::new(vec![]);
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, quality).encode_image(&image).unwrap();
    let read = image::load_from_memory_with_format(file.get_ref(), image::ImageFormat::Jpeg).unwrap();
    read.to_rgb32f().pixels().map(|p| p.0).collect()
}

/// Judges correct pictures; returns the false accusations and the number of pictures that could not be judged.
fn accusations(n: usize, seed: u64) -> (Vec<String>, usize) {
    let mut truths: Vec<(usize, bool, Truth)> = vec![];
    let (mut accused, mut open) = (vec![], 0);
    for (name, pictures, side) in correct_pictures(n, seed) {
        let terms = pictures.last_term().is_some();
        if !truths.iter().any(|t| (t.0, t.1) == (side, terms)) {
            truths.push((side, terms, Truth::new(side, if terms { TERMS } else { DEEP }, 8)));
        }
        let truth = truths.iter().find(|t| (t.0, t.1) == (side, terms)).unwrap();
        let d = truth.2.bench.judge(&pictures, None, 1e-3);
        open += usize::from(d.verdict == Conclusion::Undecided);
        if d.verdict == Conclusion::Wrong {
            accused.push(format!("{name}: {} {:?}", d.worst, d.named().map(|s| &s.what).collect::<Vec<_>>()));
        }
    }
    (accused, open)
}

#[test]
fn correct_strangers_are_not_accused() {
    let mut account = ledger::open("correct_strangers_are_not_accused", 0);
    let (accused, open) = accusations(24, account.seed());
    assert!(levels::upper_tail(24, 1e-3, accused.len() as u64) > account.spend(1), "{accused:#?}");
    assert!(open <= 6, "{open}");
}

/// At a level of 1e-3 each, one false accusation is expected in a thousand pictures.
#[test]
#[ignore = "nightly"]
fn two_hundred_correct_strangers_are_not_accused() {
    let mut account = ledger::open("two_hundred_correct_strangers_are_not_accused", 0);
    let (accused, open) = accusations(240, account.seed());
    println!("{} of 240 accused, {open} cannot be judged\n{accused:#?}", accused.len());
    assert!(levels::upper_tail(240, 1e-3, accused.len() as u64) > account.spend(1), "{accused:#?}");
    assert!(open <= 60, "{open}");
}

/// Values that follow a curve that nobody knows are not judged, and a curve that is known is named.
#[test]
fn an_unknown_curve_is_said_to_be_unknown() {
    let account = ledger::open("an_unknown_curve_is_said_to_be_unknown", 0);
    let picture = render(&RIGHT, SIDE, 256, TERMS, account.seed());
    let truth = Truth::new(SIDE, DEEP, 8);
    let judge = |mean: Vec<[f32; 3]>| {
        let layers = vec![Layer { slot: Slot::Whole, mean, std_error: None }];
        truth.bench.judge(&Pictures { size: [SIDE; 2], layers, code: Code::SixteenBit, step: vec![] }, None, 1e-3)
    };
    let strange = |v: f32| (2.0 * v / (0.3 + 2.0 * v)).powf(0.3);
    let d = judge(picture.whole.iter().map(|v| v.map(strange)).collect());
    assert_eq!((d.verdict, d.display.known), (Conclusion::Undecided, false), "{:?}", d.limits);
    let curve = Curve { tone: Tone::Aces, transfer: Transfer::Gamma(2.2) };
    let d = judge(in_steps(&picture.whole, curve, 0.7, 65535.0));
    assert_eq!((d.verdict, d.display.curve), (Conclusion::Correct, curve), "{}", d.worst);
    assert!((d.display.exposure - 0.7).abs() < 3.0 * d.display.half_width.max(2e-3), "{:?}", d.display);
}

/// A picture that shows nothing is never called correct: all white, all black, one grey, noise, and values of every size.
#[test]
fn pictures_that_show_nothing_are_not_called_correct() {
    let truth = Truth::new(32, DEEP, 8);
    let n = 32 * 32;
    let random =
        |p: usize| (0..3).map(move |c| fredholm::math::fnv1a([p as u8, (p >> 8) as u8, c]) as f32 / u64::MAX as f32);
    let noise = |p: usize| -> [f32; 3] { random(p).collect::<Vec<f32>>().try_into().unwrap() };
    let flat = |v: f32| vec![[v; 3]; n];
    let pictures = [
        ("white", flat(1.0)),
        ("black", flat(0.0)),
        ("grey", flat(0.4)),
        ("noise", (0..n).map(noise).collect()),
        ("tiny", flat(1e-30)),
        ("huge", flat(1e30)),
        ("negative", flat(-1.0)),
        ("not finite", flat(f32::NAN)),
        ("infinite", flat(f32::INFINITY)),
    ];
    for (name, mean) in pictures {
        for code in [Code::Float, Code::Half, Code::SharedExponent, Code::SixteenBit, Code::EightBit, Code::Jpeg] {
            let layers = vec![Layer { slot: Slot::Whole, mean: mean.clone(), std_error: None }];
            let d = truth.bench.judge(&Pictures { size: [32, 32], layers, code, step: vec![] }, None, 1e-3);
            assert_ne!(d.verdict, Conclusion::Correct, "{name} as {code:?}");
        }
    }
}
