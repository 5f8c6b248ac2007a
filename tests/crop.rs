//! `--crop`: the pixels of a rectangle have the bits that they have in the whole picture.
#![allow(clippy::unwrap_used)]

#[path = "common/program.rs"]
#[allow(dead_code, unreachable_pub)]
mod program;

use exr::prelude::{FlatSamples, Vec2, read_first_flat_layer_from_file};
use program::{Said, run};
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

fn ok(desk: &Path, line: &str) -> Said {
    let said = run(desk, line);
    assert!(said.code <= 1, "{line}: {}{}", said.out, said.err);
    said
}

/// The channels of `terms.exr`, and where its pixels are in the picture: x0, y0, width, height.
fn pixels(folder: &Path) -> (BTreeMap<String, Vec<u32>>, [usize; 4]) {
    let image = read_first_flat_layer_from_file(folder.join("terms.exr")).unwrap();
    let (layer, Vec2(x, y)) = (&image.layer_data, image.layer_data.attributes.layer_position);
    let bits = |samples: &FlatSamples| {
        let FlatSamples::F32(samples) = samples else { panic!("not 32 bits") };
        samples.iter().map(|x| x.to_bits()).collect()
    };
    let channels = layer.channel_data.list.iter().map(|c| (c.name.to_string(), bits(&c.sample_data))).collect();
    (channels, [x as usize, y as usize, layer.size.0, layer.size.1])
}

/// Number of pixels that have another value than in the whole picture, over all channels; and of all values.
fn different(desk: &Path, crop: &str, whole: &str) -> [usize; 2] {
    let ((some, [x0, y0, w, h]), (all, [.., width, _])) = (pixels(&desk.join(crop)), pixels(&desk.join(whole)));
    assert_eq!(some.keys().collect::<Vec<_>>(), all.keys().collect::<Vec<_>>());
    let mut count = [0; 2];
    for (name, values) in &some {
        assert_eq!(values.len(), w * h);
        for (i, value) in values.iter().enumerate() {
            let (x, y) = (x0 + i % w, y0 + i / w);
            count[0] += usize::from(*value != all[name][y * width + x]);
            count[1] += 1;
        }
    }
    count
}

/// Several ways of sampling, with pictures whose last block of 64 pixels is not full.
const RUNS: [&str; 6] = [
    "series cornell --worlds terms,path --size 45x37 --spp 40",
    "series cornell-spheres --worlds terms,path --size 45x37 --spp 64 --fast",
    "series cornell --worlds terms --estimator single --size 45x37 --spp 16",
    "series cornell --worlds terms,path --guide radiosity --roulette window --patches 300 --size 45x37 --spp 32",
    "series cornell --worlds terms,radiosity --roulette optimal --patches 200 --size 45x37 --spp 32",
    "render veach-mis --size 45x37 --spp 33",
];

#[test]
fn a_crop_has_the_bits_of_the_whole() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    for (i, line) in RUNS.into_iter().enumerate() {
        ok(desk, &format!("{line} -q -o whole{i}"));
        // a part of some rows, a single pixel, whole rows up to the end, the whole
        for (k, crop) in ["5,3,40,20", "44,36,45,37", "0,30,45,37", "0,0,45,37"].into_iter().enumerate() {
            let folder = format!("crop{i}-{k}");
            ok(desk, &format!("{line} --crop {crop} -q -o {folder} -t {}", k % 2 + 1));
            let [wrong, all] = different(desk, &folder, &format!("whole{i}"));
            assert_eq!(wrong, 0, "{line} --crop {crop}: {wrong} of {all} values differ");
            let corners: Vec<usize> = crop.split(',').map(|n| n.parse().unwrap()).collect();
            let place = [corners[0], corners[1], corners[2] - corners[0], corners[3] - corners[1]];
            assert_eq!(pixels(&desk.join(folder)).1, place);
        }
    }
    // a picture that is smaller than a block
    let small = "series cornell --worlds terms,path --size 7x5 --spp 300 -q";
    ok(desk, &format!("{small} -o small"));
    ok(desk, &format!("{small} --crop 2,1,6,4 -o small-crop"));
    assert_eq!(different(desk, "small-crop", "small")[0], 0);
    // another seed is found
    ok(desk, &format!("{} --seed 1 --crop 5,3,40,20 -q -o seed", RUNS[0]));
    let [wrong, all] = different(desk, "seed", "whole0");
    assert!(wrong > all / 3, "{wrong} of {all}");
}

#[test]
fn a_crop_goes_on_and_is_divided() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let line = "series cornell --worlds terms,path --size 100x60 --crop 10,10,70,50 -q";
    ok(desk, "series cornell --worlds terms,path --size 100x60 --spp 64 -q -o whole");
    ok(desk, &format!("{line} --spp 16 --checkpoint 10ms -o grown"));
    let other = run(desk, &format!("{} --spp 64 --resume -o grown", line.replace("10,10", "11,10")));
    assert!(
        other.code != 0 && other.err.contains("--crop: 10,10,70,50 in the state, 11,10,70,50 now"),
        "{}",
        other.err
    );
    ok(desk, &format!("{line} --spp 64 --resume -o grown"));
    assert_eq!(different(desk, "grown", "whole")[0], 0);
    for n in 1..=3 {
        ok(desk, &format!("{line} --spp 64 --shard {n}/3 -o {n}.fsh"));
    }
    ok(desk, "merge 1.fsh 2.fsh 3.fsh -q -o merged");
    assert_eq!(different(desk, "merged", "whole")[0], 0);
    let same = |name: &str| std::fs::read(desk.join("merged").join(name)).unwrap();
    assert!(same("terms.exr") == std::fs::read(desk.join("grown/terms.exr")).unwrap());
}

#[test]
fn means_are_those_of_the_rectangle() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    ok(desk, "series cornell --worlds terms --size 48x48 --crop 8,16,40,48 --spp 16 -q -o crop");
    let json = std::fs::read(desk.join("crop/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!([&summary["width"], &summary["height"]], [32, 32]);
    let (channels, _) = pixels(&desk.join("crop"));
    let red: f64 = channels["T01.R"].iter().map(|x| f64::from(f32::from_bits(*x))).sum::<f64>() / 1024.0;
    let told = summary["terms"][1]["mean"][0].as_f64().unwrap();
    // the pixels of the file are rounded to 24 bits
    assert!((red / told - 1.0).abs() < 1e-6, "{red} and {told}");
}

#[test]
fn equal_rectangles_can_be_compared() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    for (folder, options) in
        [("a", "--seed 1 --crop 8,8,24,24"), ("b", "--seed 2 --crop 8,8,24,24"), ("c", "--crop 9,8,25,24")]
    {
        ok(desk, &format!("series cornell --worlds terms --size 32x32 --spp 64 {options} -q -o {folder}"));
    }
    let said = run(desk, "compare a b -o ab");
    assert!(said.code <= 1 && desk.join("ab/z.png").exists(), "{}{}", said.out, said.err);
    ok(desk, "series cornell --worlds terms --size 16x16 --spp 64 -q -o small");
    ok(desk, "series cornell --worlds terms --size 32x32 --crop 0,0,16,16 --spp 64 -q -o corner");
    assert_eq!(run(desk, "compare small corner -o sc").code, 3, "a picture and a crop of its size");
    let said = run(desk, "compare a c -o ac");
    assert!(
        said.code == 3 && said.err.contains("begin at pixel (8, 8) of 32×32 and (9, 8) of 32×32"),
        "{} {}",
        said.code,
        said.err
    );
}

#[test]
fn what_cannot_be_cropped_is_refused() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let size = "--size 32x32 --spp 1 -o x";
    for (line, words) in [
        ("series cornell --crop 0,0,33,8", &["33,8", "32×32"][..]),
        ("series cornell --crop 8,0,8,8", &["x0 < x1"]),
        ("series cornell --crop 8,0,9", &["x0,y0,x1,y1"]),
        ("series cornell --crop=-1,0,9,9", &["x0,y0,x1,y1"]),
        ("series cornell --crop 0,0,8,8 --estimator light --worlds terms", &["whole picture", "--estimator prefix"]),
        ("series cornell --crop 0,0,8,8 --estimator bidirectional --worlds terms", &["whole picture"]),
        ("radiosity cornell --crop 0,0,8,8 --modes 2", &["--crop", "--modes"]),
    ] {
        let said = run(desk, &format!("{line} {size}"));
        assert_eq!(said.code, 2, "{line}: {}{}", said.out, said.err);
        for word in words {
            assert!(said.err.contains(word), "{line}: no `{word}` in {}", said.err);
        }
        assert!(!desk.join("x").exists());
    }
}
