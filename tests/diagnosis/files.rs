//! Files that are not what they should be: each is named for what it is.

use super::common::program::run_tidily;
use super::*;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, IntegerBounds, Layer, LayerAttributes, WritableImage,
};

const SIDE: usize = 16;

/// An EXR file with these channels, whose pixels start at `from` of a picture of `display` pixels.
fn write(path: &std::path::Path, channels: &[(&str, Vec<f32>)], from: (i32, i32), display: (usize, usize)) {
    let list = channels.iter().map(|(name, v)| AnyChannel::new(*name, FlatSamples::F32(v.clone()))).collect();
    let attributes = LayerAttributes { layer_position: from.into(), ..LayerAttributes::named("main") };
    let layer = Layer::new((SIDE, SIDE), attributes, Encoding::UNCOMPRESSED, AnyChannels::sort(list));
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new((0, 0), display);
    image.write().to_file(path).unwrap();
}

#[test]
fn pictures_that_are_something_else_are_named() {
    let desk = tempfile::TempDir::new().unwrap();
    let scene = Scene::new(&Stage::CORNELL.load([SIDE as u32; 2]).unwrap());
    let s = Settings { spp: 256, seed: 9, max_bounces: 3, ..Settings::default() };
    let s = Settings { roulette: Roulette::Albedo { from: 2 }.after(3), ..s };
    let good = by_rays::terms(&scene, Estimator::Prefix, &s, Progress::NONE).total.mean;
    let plane = |c: usize, f: &dyn Fn(f32) -> f32| good.iter().map(|p| f(p[c])).collect::<Vec<f32>>();
    let rgb =
        |f: &dyn Fn(f32) -> f32| ["R", "G", "B"].iter().enumerate().map(|(c, n)| (*n, plane(c, f))).collect::<Vec<_>>();
    let same = |v: f32| v;
    let srgb = |v: f32| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    let whole = (SIDE, SIDE);
    let path = |name: &str| desk.path().join(name);
    write(&path("right.exr"), &rgb(&same), (0, 0), whole);
    write(&path("grey.exr"), &[("Y", plane(1, &same))], (0, 0), whole);
    write(&path("red.exr"), &[("R", plane(0, &same))], (0, 0), whole);
    write(&path("crop.exr"), &rgb(&same), (8, 8), (64, 64));
    write(&path("overscan.exr"), &rgb(&same), (-4, -4), (8, 8));
    write(&path("srgb.exr"), &rgb(&srgb), (0, 0), whole);
    write(&path("gamma.exr"), &rgb(&|v| (0.5 * v).powf(1.0 / 2.2)), (0, 0), whole);
    image::GrayImage::from_pixel(16, 16, image::Luma([90])).save(path("grey.png")).unwrap();
    std::fs::create_dir(path("folder.exr")).unwrap();
    for (file, what) in [
        ("grey.exr", "has one channel, Y"),
        ("red.exr", "has only the channel R"),
        ("crop.exr", "a crop: the pixels (8, 8) to (23, 23) of a picture of 64×64"),
        ("overscan.exr", "a picture with overscan"),
        ("grey.png", "has one channel, grey"),
        ("folder.exr", "not a file"),
    ] {
        let said = run_tidily(
            desk.path(),
            &format!("diagnose {file} --against cornell --spp 64 --paths 100000 -q -o {file}.out"),
        );
        assert_eq!(said.code, 3, "{file}: {}{}", said.out, said.err);
        assert!(
            said.err.contains(what) && said.err.contains(file) && said.err.contains("help: "),
            "{file}: {}",
            said.err
        );
    }
    for (file, what) in [("srgb.exr", "display (sRGB)"), ("gamma.exr", "display (gamma 2.2)")] {
        let line = format!("diagnose {file} --against cornell --spp 256 --paths 100000 -q -o {file}.out");
        let said = run_tidily(desk.path(), &line);
        assert_eq!(said.code, 1, "{file}: {}{}", said.out, said.err);
        let words = said.out.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(what) && !words.contains("more is wrong"), "{file}: {}", said.out);
    }
    let said = run_tidily(desk.path(), "diagnose right.exr --against cornell --spp 256 --paths 400000 -q -o right");
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    // pictures of another size
    let said = run_tidily(desk.path(), "series cornell --worlds terms --size 20x16 --spp 16 -q -o other");
    assert_eq!(said.code, 0, "{}", said.err);
    let said = run_tidily(desk.path(), "diagnose right.exr --against other -q -o size");
    assert_eq!(said.code, 3, "{}", said.out);
    assert!(said.err.contains("16×16") && said.err.contains("20×16"), "{}", said.err);
    // the layered file of fredholm itself
    let said = run_tidily(
        desk.path(),
        "diagnose other/terms.exr --against cornell --set camera.size=[20,16] --spp 256 --paths 400000 -q -o own",
    );
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
}
