//! `fredholm zoo`: what it lists, writes and asks.
#![allow(clippy::unwrap_used)]

use fredholm::report::image::exr;
use fredholm::zoo;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

struct Said {
    code: i32,
    out: String,
    err: String,
}

fn run(desk: &Path, line: &str, input: &str) -> Said {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
    let command = command.args(line.split_whitespace()).current_dir(desk);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let said = Said { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) };
    assert!(!said.err.contains("panicked"), "{line}: {}", said.err);
    said
}

#[test]
fn the_list_has_every_member_and_renders_nothing() {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), "zoo --list", "");
    assert_eq!(said.code, 0);
    for bug in zoo::all() {
        assert!(said.out.contains(bug.name) && said.out.contains(bug.what), "{}", bug.name);
    }
    let one = run(desk.path(), "zoo truncated --list", "");
    assert!(one.out.contains("1 up to k = 3, then 0"), "{}", one.out);
    assert!(one.out.lines().all(|l| l.chars().count() <= 100));
    assert_eq!(std::fs::read_dir(desk.path()).unwrap().count(), 0);
}

#[test]
fn a_name_that_is_not_there_is_a_usage_error_with_the_nearest() {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), "zoo doble-emission", "");
    assert_eq!(said.code, 2);
    assert!(said.err.contains("`double-emission`"), "{}", said.err);
    assert_eq!(run(desk.path(), "zoo truncated --scene nowhere", "").code, 2);
}

/// Cornell's renders lie where the glob finds them, the others beside; no file tells what is wrong with it.
#[test]
fn every_member_leaves_a_file_that_does_not_tell() {
    let desk = TempDir::new().unwrap();
    let line = "zoo --size 16x16 --spp 4 -q -o out";
    let said = run(desk.path(), line, "");
    assert_eq!(said.code, 0, "{}", said.err);
    let out = desk.path().join("out");
    for bug in zoo::all() {
        assert!(said.out.contains(bug.name), "{}", bug.name);
        let here = if bug.exposed_by.label == "cornell" { out.clone() } else { out.join(bug.exposed_by.label) };
        let file = exr::read(&here.join(format!("{}.exr", bug.name))).unwrap();
        assert_eq!((file.width, file.height), (16, 16));
        for layer in ["", "T00", "T06", "T00_se", "T06_se"] {
            assert!(file.layer(layer).is_some(), "{}: no layer `{layer}`", bug.name);
        }
        for (name, value) in &file.attributes {
            assert!(!value.contains(bug.name) && !value.contains("zoo"), "{name} = {value}");
        }
        assert!(here.join("correct.exr").exists());
    }
    // the terms of a right renderer sum to its image, but for what is longer
    let file = exr::read(&out.join("correct.exr")).unwrap();
    let sum = |layer: &str| file.layer(layer).unwrap().iter().flatten().map(|&v| f64::from(v)).sum::<f64>();
    let terms: f64 = (0..=6).map(|k| sum(&format!("T{k:02}"))).sum();
    assert!((0.9..=1.0).contains(&(terms / sum(""))), "{terms} of {}", sum(""));
    // the same command again gives the same bytes, and another's folder is left alone
    let bytes = std::fs::read(out.join("clamped.exr")).unwrap();
    assert_eq!(run(desk.path(), line, "").code, 0);
    assert_eq!(std::fs::read(out.join("clamped.exr")).unwrap(), bytes);
    std::fs::create_dir(desk.path().join("mine")).unwrap();
    std::fs::write(desk.path().join("mine/notes.txt"), "mine").unwrap();
    assert_eq!(run(desk.path(), "zoo --size 16x16 --spp 4 -q -o mine", "").code, 3);
}

#[test]
fn one_member_stands_beside_the_right_estimator() {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), "zoo missing-pi --size 16x16 --spp 64 -q", "");
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.out.contains("predicted") && said.out.contains("3.142") && said.out.contains("blind"), "{}", said.out);
    for name in ["missing-pi.exr", "correct.exr", "missing-pi.png", "missing-pi-ratios.svg", "missing-pi-ratios.png"] {
        assert!(desk.path().join("zoo-out/missing-pi").join(name).exists(), "{name}");
    }
}

/// Answers are lines; a wrong line is asked for again, the end of the input reveals the rest, and the score is kept.
#[test]
fn the_quiz_can_be_played_through_a_pipe() {
    let desk = TempDir::new().unwrap();
    let line = "zoo --quiz --rounds 3 --seed 5 --size 16x16 --spp 8 -q";
    let silent = run(desk.path(), line, "");
    assert_eq!(silent.code, 0, "{}", silent.err);
    assert_eq!(silent.out.matches("not answered: it is").count(), 3);
    assert!(silent.out.contains("0 of 0 right, 3 asked"), "{}", silent.out);
    // read the answers off, and give them
    let revealed: Vec<&str> =
        silent.out.split("not answered: it is\n").skip(1).map(|t| t.split(':').next().unwrap()).collect();
    let rounds: Vec<&str> = silent.out.split("not answered").collect();
    let mut answers = String::from("nonsense\n");
    for (round, name) in rounds.iter().zip(&revealed) {
        let choice = round.lines().find(|l| l.contains(&format!("  {name}: "))).unwrap();
        answers += &format!("{}\n", choice.split_whitespace().next().unwrap());
    }
    let played = run(desk.path(), line, &answers);
    assert!(played.out.contains("3 of 3 right, 3 asked"), "{}", played.out);
    assert!(played.err.contains("a number from 1 to 4"));
    // the name is not told before it is asked for
    let before = played.out.split("right: it is").next().unwrap();
    assert_eq!(before.matches(revealed[0]).count(), 1, "{before}");
}
