//! What is wrong on the command line is refused in words, with the exit code that fits, and nothing is written.
//! (What is wrong inside a scene file is in `scene_files.rs`.)
#![allow(clippy::unwrap_used)]

use std::process::Command;
use tempfile::TempDir;

/// Exit code and stderr; stdout must be empty, and so must the folder but for what was there.
#[track_caller]
fn refused(desk: &TempDir, args: &[&str]) -> (i32, String) {
    let before = count(desk);
    let output = Command::new(assert_cmd::cargo::cargo_bin!("fredholm")).args(args).current_dir(desk).output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(!err.contains("panicked"), "{args:?}: {err}");
    assert!(output.stdout.is_empty(), "{args:?}");
    assert_eq!(count(desk), before, "{args:?} left something behind");
    (output.status.code().unwrap(), err)
}

fn count(desk: &TempDir) -> usize {
    std::fs::read_dir(desk).unwrap().count()
}

fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

#[test]
fn usage_errors_name_the_value_and_exit_with_2() {
    let desk = TempDir::new().unwrap();
    for (line, said) in [
        ("series --spp 0", "--spp: 0 is not between 1 and 16777216"),
        ("series --spp -3", "unexpected argument '-3'"),
        ("series --spp many", "--spp: `many` is not a whole number"),
        ("series --technique guess", "`guess` is none of scatter, connect, mis"),
        ("series --sampling best", "`best` is none of uniform, cosine, bsdf"),
        ("series --estimator dark", "`dark` is none of single, prefix, branching, light, bidirectional"),
        ("series --estimator light --strategies", "only the bidirectional estimator has strategies"),
        ("series --worlds terms,moon", "--worlds: `moon` is none of terms, path, radiosity"),
        ("series --roulette constant:1.5", "q = `1.5` is not a probability of termination in [0, 1)"),
        ("series --roulette constant:1", "q = `1` is not a probability of termination"),
        ("series --roulette russian", "unknown roulette `russian`; use none, lecture"),
        ("series --max-bounces 1001", "--max-bounces: 1001 is not between 0 and 1000"),
        ("series --size 16", "`16` is not a size such as 128x128"),
        ("series --size 0x16", "`0x16` is not a size"),
        ("series --patches 0", "0 is not between 1 and 2000000"),
        ("series -t 0", "--threads: 0 is not between 1 and 4096"),
        ("series -t 100000000", "100000000 is not between 1 and 4096"),
        ("series --seed 1 --seed 2", "cannot be used multiple times"),
        ("series a b", "unexpected argument 'b'"),
        ("series --bogus", "unexpected argument '--bogus'"),
        ("--spp 0", "--spp: 0 is not between 1 and 16777216"),
        ("compare a", "<B>"),
        ("compare a b --alpha 0", "`0` is not between 0 and 1"),
        ("compare a b --alpha nan", "`nan` is not between 0 and 1"),
        ("compare a b --of-term=-1", "`-1` is not a number of at least 0"),
        ("compare a b --of-total inf", "`inf` is not a number of at least 0"),
        ("chapter 99", "there is no chapter `99`"),
        ("render --max-bounces 1000 --size 32768x32768", "choose a smaller --size or --max-bounces"),
    ] {
        let (code, err) = refused(&desk, &words(line));
        assert_eq!(code, 2, "{line}: {err}");
        assert!(err.starts_with("error: ") && err.contains(said), "{line}: {err}");
    }
}

#[test]
fn scenes_and_files_that_are_not_there_exit_with_3() {
    let desk = TempDir::new().unwrap();
    std::fs::create_dir(desk.path().join("folder.toml")).unwrap();
    std::fs::create_dir(desk.path().join("empty")).unwrap();
    std::fs::write(desk.path().join("file"), "no folder").unwrap();
    let head = fredholm::scene::builtin::find("caustic").unwrap().source;
    let sky = |file: &str| format!("{head}\n[[lights]]\ntype = \"environment\"\nfile = \"{file}\"\n");
    std::fs::write(desk.path().join("no_sky.toml"), sky("none.exr")).unwrap();
    std::fs::write(desk.path().join("text_sky.toml"), sky("text.png")).unwrap();
    std::fs::write(desk.path().join("text.png"), "no picture").unwrap();
    for (line, said) in [
        ("series cornel", "`cornel` is neither a built-in scene nor a .toml or .obj file"),
        ("info cornel", "did you mean `cornell`"),
        ("series .", "`.` is neither a built-in scene"),
        ("series folder.toml", "folder.toml"),
        ("series none.toml", "--> none.toml"),
        ("render none.obj", "--> none.obj"),
        ("info no_sky.toml", "cannot read `none.exr`: No such file"),
        ("render no_sky.toml", "lights[0].file"),
        ("info text_sky.toml", "cannot read `text.png`: "),
        ("info caustic --set lights=[{type=\"sun\"}]", "`sun` is not a type of light"),
        ("info caustic --set materials.glass.ior=0.5", "ior 0.5 is outside [1, 10]"),
        ("info caustic --set materials.floor={type=\"diffuse\",texture=\"none.png\"}", "materials.floor"),
        ("compare none none", "--> none"),
        ("compare empty empty", "--> empty/summary.json"),
        ("compare file file", "not valid JSON"),
        ("render -o file --spp 1 --size 1x1", "the output folder is a file"),
        ("render -o file --spp 1 --size 1x1 --force", "the output folder is a file"),
        ("render -o file/x --spp 1 --size 1x1", "cannot write into the output folder"),
    ] {
        let (code, err) = refused(&desk, &words(line));
        assert_eq!(code, 3, "{line}: {err}");
        assert!(err.starts_with("error: ") && err.contains(said), "{line}: {err}");
    }
}

#[test]
fn a_scene_that_keeps_its_light_is_refused_with_the_remedy() {
    let desk = TempDir::new().unwrap();
    let white = "--set materials.wall.reflectance=[0.5,1,0.5] --size 8x8 --spp 16 --max-bounces 2 -q";
    for worlds in ["terms", "path", "radiosity", "terms,path,radiosity"] {
        let (code, err) = refused(&desk, &words(&format!("series furnace --worlds {worlds} {white}")));
        assert_eq!(code, 3, "{err}");
        insta::allow_duplicates! {
            insta::assert_snapshot!(err, @r"
            error: one colour channel loses no light, so L = E + T L has no solution
            help: lower a reflectance below 1, or compute only the first terms with --worlds terms,path --roulette none
            ");
        }
    }
    // the remedy works: every term of the green channel is the emission
    let line = format!("series furnace --worlds terms,path --roulette none --technique scatter {white} --json -o a");
    let output =
        Command::new(assert_cmd::cargo::cargo_bin!("fredholm")).args(words(&line)).current_dir(&desk).output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["terms"][2]["mean"][1].as_f64(), Some(1.0), "{}", json["terms"]);
    // in an open scene a white surface is fine
    let line = "render cornell --set materials.white.reflectance=[1,1,1] --size 4x4 --spp 1 -q -o b";
    let output =
        Command::new(assert_cmd::cargo::cargo_bin!("fredholm")).args(words(line)).current_dir(&desk).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn the_smallest_of_everything_works() {
    let desk = TempDir::new().unwrap();
    for (i, line) in [
        "series cornell --size 1x1 --spp 1 --max-bounces 0 --patches 1",
        "series sphere --size 1x3 --spp 2 --max-bounces 1 --patches 1 --estimator single",
        "tour furnace --size 2x1 --spp 3 --max-bounces 2 --patches 20",
        "radiosity shells --size 1x1 --spp 1 --patches 20 --read-patches --orders",
    ]
    .iter()
    .enumerate()
    {
        let mut args = words(line);
        let dir = i.to_string();
        args.extend(["-q", "-o", &dir]);
        let output =
            Command::new(assert_cmd::cargo::cargo_bin!("fredholm")).args(args).current_dir(&desk).output().unwrap();
        let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(matches!(output.status.code(), Some(0 | 1)), "{line}: {err}");
        assert!(!out.contains("NaN") && !out.contains("inf "), "{line}: {out}");
    }
}

#[cfg(unix)]
#[test]
fn names_need_not_be_text() {
    use std::os::unix::ffi::OsStrExt;
    let desk = TempDir::new().unwrap();
    let odd = std::ffi::OsStr::from_bytes(b"\xff");
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
    command.args(["render", "--size", "1x1", "--spp", "1", "-q", "-o"]).arg(odd).current_dir(&desk);
    assert_eq!(command.output().unwrap().status.code(), Some(0));
    assert!(desk.path().join(odd).join("terms.exr").exists());
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
    assert_eq!(command.arg("info").arg(odd).current_dir(&desk).output().unwrap().status.code(), Some(2));
}
