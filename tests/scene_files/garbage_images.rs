//! Images that are damaged, too large, or no files: refused in words, never a panic, never a wait.

use super::garbage::{counted, runner};
use super::*;
use fredholm::report::image::exr as layers;
use std::time::{Duration, Instant};

/// Changes to the bytes of a file: other values, and an end that is missing.
type Damage = (Vec<(prop::sample::Index, u8)>, Option<prop::sample::Index>);

fn damage() -> impl Strategy<Value = Damage> {
    let byte = prop_oneof![Just(0u8), Just(255), Just(127), any::<u8>()];
    let bytes = prop::collection::vec((any::<prop::sample::Index>(), byte), 0..6);
    (bytes, prop::option::weighted(0.2, any::<prop::sample::Index>()))
}

fn damaged(bytes: &[u8], (changes, end): &Damage) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for (at, value) in changes {
        let at = at.index(out.len());
        out[at] = *value;
    }
    out.truncate(end.map_or(out.len(), |end| end.index(out.len() + 1)));
    out
}

/// Reads damaged copies of each kind of image, as a texture and as a picture to diagnose.
fn images(cases: u32) {
    let dir = gallery();
    let names = ["wall.png", "deep.png", "flat.jpg", "sky.hdr", "sky.exr", "solid.png"];
    let whole: Vec<Vec<u8>> = names.iter().map(|n| std::fs::read(dir.path().join(n)).unwrap()).collect();
    let (good, refused) = (Cell::new(0), Cell::new(0));
    runner(cases)
        .run(&(0..names.len(), damage()), |(which, damage)| {
            let ending = names[which].rsplit_once('.').unwrap().1;
            let file = dir.path().join(format!("damaged.{ending}"));
            std::fs::write(&file, damaged(&whole[which], &damage)).unwrap();
            let text = RICH.replace("wall.png", &format!("damaged.{ending}"));
            counted(toml(&text, &dir.path().join("rich.toml"), &Options::default()), &good, &refused);
            if ending == "exr" {
                let _ = layers::read(&file);
            }
            Ok(())
        })
        .unwrap();
    let (good, refused) = (good.get(), refused.get());
    assert!(good > cases / 50 && refused > cases / 4, "{good} read, {refused} refused: the damage tests nothing");
}

#[test]
fn damaged_images_never_panic() {
    images(1500);
}

#[test]
#[ignore = "nightly: 10⁵ damaged images"]
fn damaged_images_never_panic_in_100_000_cases() {
    images(100_000);
}

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
        vec![("huge.png", "20000×20000 texels"), ("huge.hdr", "20000×4000 texels"), ("folder.png", "is not a file")];
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
