//! A run that was killed, stopped, or rendered in parts has the bits of one run.
//!
//! All files are compared byte by byte, except for seconds and threads in `summary.json` and `index.html`.
#![allow(clippy::unwrap_used)]

#[path = "common/program.rs"]
#[allow(dead_code, unreachable_pub)]
mod program;

use fredholm::report::state::{self, State};
use program::{Said, command, run};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Every file of a result, without what may differ between two equal runs.
fn files(desk: &Path, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let all = std::fs::read_dir(desk.join(folder)).unwrap().map(|f| f.unwrap());
    let all = all.filter(|f| f.file_name() != "state.fsh" && f.file_name() != "index.html");
    let file = |f: std::fs::DirEntry| {
        let (name, bytes) = (f.file_name().into_string().unwrap(), std::fs::read(f.path()).unwrap());
        let bytes = if name == "summary.json" { without_seconds(&bytes) } else { bytes };
        (name, bytes)
    };
    all.map(file).collect()
}

fn without_seconds(json: &[u8]) -> Vec<u8> {
    let mut summary: serde_json::Value = serde_json::from_slice(json).unwrap();
    let costs = (0..3).map(|i| format!("/series/{i}/cost/seconds"));
    for place in costs.chain(["/seconds".into(), "/threads".into()]) {
        if let Some(value) = summary.pointer_mut(&place) {
            *value = 0.into();
        }
    }
    serde_json::to_vec_pretty(&summary).unwrap()
}

/// Two results have the same files with the same bytes.
fn assert_same(desk: &Path, [a, b]: [&str; 2], what: &str) {
    let (a, b) = (files(desk, a), files(desk, b));
    assert!(a.contains_key("terms.exr"), "{what}: no result");
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{what}");
    for (name, bytes) in &a {
        assert!(*bytes == b[name], "{what}: {name} differs");
    }
}

fn ok(desk: &Path, line: &str) -> Said {
    let said = run(desk, line);
    assert!(said.code <= 1, "{line}: {}{}", said.out, said.err);
    said
}

fn refused(desk: &Path, line: &str, words: &[&str]) {
    let said = run(desk, line);
    assert!(said.code == 2 || said.code == 3, "{line}: {} {}", said.code, said.err);
    assert!(said.err.contains("help: "), "{line}: {}", said.err);
    for word in words {
        assert!(said.err.contains(word), "{line}: no `{word}` in {}", said.err);
    }
}

/// Starts a command and kills it after some time, so that it cannot clean up.
fn killed(desk: &Path, line: &str, after: Duration) {
    let mut child = command(desk, line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(after);
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Runs with several ways of sampling, all with states that are kept all the time.
const RUNS: [&str; 6] = [
    "series cornell-spheres --worlds terms,path --size 48x40 --spp 512",
    "series cornell --worlds terms,path --size 45x37 --spp 512 --fast",
    "render cornell --size 61x47 --spp 1000",
    "series cornell --worlds terms --estimator light --size 40x40 --spp 512 --pictures-only",
    "series cornell --worlds terms --estimator bidirectional --size 24x24 --spp 256 --pictures-only",
    "series cornell --worlds terms,path --guide radiosity --roulette window --patches 300 --size 40x40 --spp 256",
];

/// Stops a run with a signal, so that it keeps what it has.
fn stopped(desk: &Path, line: &str, after: Duration) {
    let mut child = command(desk, line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(after);
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < Duration::from_secs(30), "{line}: it does not end");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Kills each run at `moments` moments, which are spread over its time, and goes on.
fn killed_at(moments: u32) {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    for (i, line) in RUNS.into_iter().enumerate() {
        let (whole, started) = (format!("whole{i}"), Instant::now());
        ok(desk, &format!("{line} -q -o {whole}"));
        let time = started.elapsed();
        for moment in 0..moments {
            let (folder, begun) = (format!("killed{i}-{moment}"), format!("{line} -q --checkpoint 10ms -t 2"));
            // moments that lie between those of other runs
            let share = (f64::from(moment) + (i as f64 + 0.5) / RUNS.len() as f64) / f64::from(moments);
            killed(desk, &format!("{begun} -o {folder}"), time.mul_f64(share));
            ok(desk, &format!("{line} -q --resume -t 1 -o {folder}"));
            assert_same(desk, [&whole, &folder], &format!("{line}, killed after {share:.2} of {time:?}"));
        }
    }
}

#[test]
fn a_killed_run_goes_on_to_the_same_bits() {
    killed_at(2);
}

#[test]
#[ignore = "nightly: 54 moments"]
fn a_run_killed_at_54_moments_goes_on_to_the_same_bits() {
    killed_at(9);
}

#[test]
fn a_run_that_is_killed_again_and_again_ends_with_the_same_bits() {
    let (desk, line) = (TempDir::new().unwrap(), RUNS[0]);
    let desk = desk.path();
    ok(desk, &format!("{line} -q -o whole"));
    killed(desk, &format!("{line} -q --checkpoint 10ms -o often"), Duration::from_millis(250));
    for _ in 0..5 {
        killed(desk, &format!("{line} -q --checkpoint 10ms --resume -o often"), Duration::from_millis(250));
    }
    ok(desk, &format!("{line} -q --resume -o often"));
    assert_same(desk, ["whole", "often"], line);
}

#[test]
fn a_finished_run_grows_to_the_bits_of_a_longer_one() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let line = |spp: u32| format!("series cornell-spheres --worlds terms,path --size 48x40 --spp {spp} -q");
    ok(desk, &format!("{} -o whole", line(640)));
    for (i, steps) in [&[16, 640][..], &[48, 96, 640], &[64, 512, 640]].into_iter().enumerate() {
        let folder = format!("grown{i}");
        ok(desk, &format!("{} --checkpoint 10ms -o {folder}", line(steps[0])));
        for &spp in &steps[1..] {
            ok(desk, &format!("{} --resume -o {folder}", line(spp)));
        }
        assert_same(desk, ["whole", &folder], &format!("{steps:?}"));
    }
}

#[test]
fn a_run_that_was_stopped_in_its_last_pass_grows_as_well() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let line = |spp: u32| format!("series cornell --worlds terms --size 96x96 --spp {spp} -q -t 1 --pictures-only");
    ok(desk, &format!("{} -o whole", line(1024)));
    for (i, after) in [400, 900, 1300].into_iter().enumerate() {
        let folder = format!("stopped{i}");
        stopped(desk, &format!("{} --checkpoint 10ms -o {folder}", line(784)), Duration::from_millis(after));
        ok(desk, &format!("{} --resume -o {folder}", line(1024)));
        assert_same(desk, ["whole", &folder], &format!("stopped after {after} ms"));
    }
}

#[test]
fn a_signal_in_the_first_pass_ends_the_run() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let line = "series cornell --worlds terms --size 400x400 --spp 32 -q -t 1 --pictures-only --checkpoint 300ms";
    ok(desk, &format!("{line} -o whole"));
    stopped(desk, &format!("{line} -o run"), Duration::from_millis(120));
    ok(desk, &format!("{line} --resume -o run"));
    assert_same(desk, ["whole", "run"], line);
    for n in 1..=2 {
        stopped(desk, &format!("{line} --shard {n}/2 -o {n}.fsh"), Duration::from_millis(120));
        ok(desk, &format!("{line} --shard {n}/2 -o {n}.fsh"));
    }
    ok(desk, "merge 1.fsh 2.fsh -q -o merged");
    assert_same(desk, ["whole", "merged"], line);
}

#[test]
fn a_part_is_written_by_one_run_at_a_time() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let line =
        "series cornell --worlds terms,path --size 32x32 --spp 10000000 -q --shard 1/2 --checkpoint 10ms -o 1.fsh";
    let mut first = command(desk, line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while !desk.join("1.fsh").exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
    refused(desk, line, &["another run is writing this part", "1.fsh"]);
    first.kill().unwrap();
    first.wait().unwrap();
}

#[test]
fn a_state_keeps_the_films_of_other_ways_to_solve() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let line = |worlds: &str| format!("series cornell --size 128x128 --spp 64 -q --checkpoint 10ms --worlds {worlds}");
    ok(desk, &format!("{} -o run", line("terms,path")));
    ok(desk, &format!("{} --estimator single --resume -o run", line("terms")));
    let said = ok(desk, "series cornell --size 128x128 --spp 64 --worlds terms,path --resume -o run");
    assert!(said.err.contains("going on with prefix 64, path 64 of 64"), "{}", said.err);
}

#[test]
fn what_cannot_go_on_is_refused_by_name() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let base = "series cornell --worlds terms --size 32x32 -q";
    // so large that a state is kept
    let large = base.replace("32x32", "256x256");
    let kept = |spp: u32, folder: &str| {
        ok(desk, &format!("{large} --pictures-only --spp {spp} --checkpoint 10ms -o {folder}"))
    };
    ok(desk, &format!("{base} --spp 1024 --checkpoint 10ms -o a"));
    let on = |more: &str| format!("{base} {more} --resume -o a");
    refused(desk, &on("--spp 2048 --seed 1"), &["--seed: 0 in the state, 1 now"]);
    refused(desk, &on("--spp 2048 --set materials.white.reflectance=[0.1,0.1,0.1]"), &["contents of the scene"]);
    refused(desk, &on("--spp 2048 --roulette lecture"), &["--roulette"]);
    refused(desk, &on("--spp 2048 --max-bounces 3"), &["--max-bounces: 8 in the state, 3 now"]);
    refused(desk, &on("--spp 32"), &["1024 samples per pixel already", "--spp 1024 or more"]);
    // a state of fewer replicates, and one in the middle of a group of paths
    kept(8, "few");
    refused(desk, &format!("{large} --pictures-only --spp 64 --resume -o few"), &["8 replicates", "16"]);
    kept(20, "odd");
    refused(desk, &format!("{large} --pictures-only --spp 64 --resume -o odd"), &["after 20 samples", "16, 32, 64"]);
    // a damaged state
    let path = desk.join("a/state.fsh");
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[1000] ^= 1;
    std::fs::write(&path, &bytes).unwrap();
    refused(desk, &on("--spp 2048"), &["damaged", "state.fsh"]);
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    refused(desk, &on("--spp 2048"), &["damaged", "state.fsh"]);
    // without a state, it starts at the first sample
    let said = ok(desk, "series cornell --worlds terms --size 16x16 --spp 16 --resume -o empty");
    assert!(said.err.contains("nothing was kept"), "{}", said.err);
}

#[test]
fn a_stopped_run_is_not_begun_anew_by_mistake_and_says_how_it_goes_on() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let line = "series cornell --worlds terms --size 32x32 --spp 1024 --seed 7";
    let mut child =
        command(desk, &format!("{line} -o run")).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(200));
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let stopped = child.wait().unwrap().code() == Some(143);
    let mut err = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut err).unwrap();
    if stopped && desk.join("run/state.fsh").exists() {
        let hint = err.lines().find_map(|l| l.strip_prefix("to go on: fredholm ")).unwrap().to_owned();
        refused(desk, &format!("{line} -o run"), &["was stopped", "--resume", "--force"]);
        ok(desk, &hint);
    } else {
        ok(desk, &format!("{line} -o run --resume"));
    }
    ok(desk, &format!("{line} -q -o whole"));
    assert_same(desk, ["whole", "run"], line);
}

#[test]
fn parts_have_the_bits_of_one_run() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    for (i, line) in RUNS.into_iter().enumerate() {
        ok(desk, &format!("{line} -q -o whole{i}"));
        let part = |n: u32| format!("{line} -q --shard {n}/3 -t {} -o parts{i}/{n}.fsh", n % 2 + 1);
        // the second one is killed and repeated, the third one repeated when it is finished
        killed(desk, &format!("{} --checkpoint 10ms", part(2)), Duration::from_millis(150));
        [1, 2, 3, 3].into_iter().for_each(|n| drop(ok(desk, &part(n))));
        ok(desk, &format!("merge parts{i}/3.fsh parts{i}/1.fsh parts{i}/2.fsh -q -o merged{i}"));
        let (mut whole, mut merged) = (files(desk, &format!("whole{i}")), files(desk, &format!("merged{i}")));
        if line.contains("light") || line.contains("bidirectional") {
            // their variance is known for all samples only
            for name in ["variance.svg", "variance.png"] {
                [&mut whole, &mut merged].into_iter().for_each(|files| drop(files.remove(name)));
            }
        }
        assert!(whole.contains_key("terms.exr") && whole.len() > 2, "{line}");
        let names = whole.iter().filter(|(name, bytes)| merged.get(*name) != Some(*bytes)).map(|(name, _)| name);
        assert_eq!(names.collect::<Vec<_>>(), Vec::<&String>::new(), "{line}");
        assert_eq!(whole.len(), merged.len(), "{line}");
    }
}

#[test]
fn rows_of_stored_rays_are_traced_in_parts() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let lines = [
        "radiosity cornell --factors rays --rays 64 --patches 500 --size 32x24 --spp 16 --grading 2 --export mesh",
        "series cornell --worlds terms,radiosity --factors rays --rays 64 --patches 300 --size 24x24 --spp 32 --seed 5",
    ];
    for (i, line) in lines.into_iter().enumerate() {
        ok(desk, &format!("{line} -q -o whole{i}"));
        for n in [1, 2, 3, 3, 4] {
            ok(desk, &format!("{line} -q --shard {n}/4 -t {} -o parts{i}/{n}.fsh", n % 2 + 1));
        }
        let files = [4, 1, 3, 2].map(|n| format!("parts{i}/{n}.fsh")).join(" ");
        ok(desk, &format!("merge {files} -q -o merged{i}"));
        assert_same(desk, [&format!("whole{i}"), &format!("merged{i}")], line);
    }
    // the rows of the files are used: with other light in some of them, the result is another one
    let path = desk.join("parts0/4.fsh");
    let mut part = State::open(&path).unwrap();
    let [coarse, fine] = [0, 1].map(|i| part.header.rows[i].clone());
    let mut rows = part.rows(&fine.mesh, fine.patches, fine.per_row).unwrap().unwrap();
    rows.direct.fill([[1.0; 3]; 2]);
    state::write_rows(&path, &part.header, (&fine.mesh, &rows)).unwrap();
    let merge = "merge parts0/1.fsh parts0/2.fsh parts0/3.fsh parts0/4.fsh -q -o";
    ok(desk, &format!("{merge} other"));
    assert!(files(desk, "other")["mesh.csv"] != files(desk, "whole0")["mesh.csv"]);
    // a part that was stopped before its second mesh goes on with it
    let rows = State::open(&path).unwrap().rows(&coarse.mesh, coarse.patches, coarse.per_row).unwrap().unwrap();
    part.header.rows.pop();
    state::write_rows(&path, &part.header, (&coarse.mesh, &rows)).unwrap();
    refused(desk, &format!("{merge} x"), &["part 4/4 is not finished", "64 rays from each of 500 patches", "4.fsh"]);
    ok(desk, &format!("{} -q --shard 4/4 -o parts0/4.fsh", lines[0]));
    ok(desk, &format!("{merge} again"));
    assert_same(desk, ["whole0", "again"], lines[0]);
    // another number of samples needs no other rows, but another mesh does
    let fewer = lines[0].replace("--spp 16", "--spp 8");
    ok(desk, &format!("{fewer} -q -o whole8"));
    for n in 1..=4 {
        ok(desk, &format!("{fewer} -q --shard {n}/4 -o parts0/{n}.fsh"));
    }
    ok(desk, &format!("{merge} merged8"));
    assert_same(desk, ["whole8", "merged8"], &fewer);
    let other = lines[0].replace("--patches 500", "--patches 400");
    refused(desk, &format!("{other} --shard 1/4 -o parts0/1.fsh"), &["another command", "--patches 500", "--force"]);
    refused(desk, "radiosity cornell --patches 300 --shard 1/2", &["dense matrix", "--factors rays"]);
    refused(desk, "radiosity cornell --factors rays --patches 300 --modes 2 --shard 1/2", &["--shard", "--modes"]);
    refused(desk, "radiosity cornell --factors rays --patches 300 --shard 1/301", &["too many", "300"]);
}

#[test]
fn parts_that_do_not_belong_together_are_refused_by_name() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    std::fs::write(desk.join("room.toml"), fredholm::scene::builtin::find("cornell").unwrap().source).unwrap();
    let line = "series room.toml --worlds terms --size 24x24 --spp 64 -q";
    for n in 1..=3 {
        ok(desk, &format!("{line} --shard {n}/3 -o {n}.fsh"));
    }
    ok(desk, &format!("{line} --seed 9 --shard 2/3 -o seed.fsh"));
    ok(desk, "series room.toml --worlds terms --size 24x24 --spp 128 -q --shard 2/3 -o spp.fsh");
    ok(desk, &format!("{line} --shard 2/4 -o four.fsh"));
    refused(desk, "merge 1.fsh 3.fsh -o x", &["parts are missing: 2/3"]);
    refused(desk, "merge 1.fsh 2.fsh 2.fsh 3.fsh -o x", &["part 2/3 is given twice", "2.fsh"]);
    refused(desk, "merge 1.fsh seed.fsh 3.fsh -o x", &["--seed is 0 in 1.fsh, 9 here", "seed.fsh"]);
    refused(desk, "merge 1.fsh spp.fsh 3.fsh -o x", &["--spp is 64 in 1.fsh, 128 here", "spp.fsh"]);
    refused(desk, "merge 1.fsh four.fsh 3.fsh -o x", &["number of parts is 3", "four.fsh"]);
    refused(desk, "merge room.toml -o x", &["not a state", "room.toml"]);
    ok(desk, &format!("{line} --patches 60 --shard 2/3 -o other.fsh"));
    refused(desk, "merge 1.fsh other.fsh 3.fsh -o x", &["the command is", "--patches 60"]);
    // the file of another part is not replaced
    refused(desk, &format!("{line} --shard 1/3 -o 2.fsh"), &["this is part 2/3, not 1/3", "--force"]);
    refused(desk, &format!("{line} --seed 1 --shard 2/3 -o 2.fsh"), &["--seed"]);
    // a part that was stopped
    let long = "series room.toml --worlds terms --size 24x24 --spp 10000000 -q";
    killed(desk, &format!("{long} --shard 1/2 --checkpoint 10ms -o long1.fsh"), Duration::from_millis(500));
    ok(desk, &format!("{} --shard 2/2 -o long2.fsh", long.replace("10000000", "64")));
    refused(desk, "merge long1.fsh long2.fsh -o x", &["--spp"]);
    let damage = |name: &str| {
        let mut bytes = std::fs::read(desk.join(name)).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
        std::fs::write(desk.join("damaged.fsh"), bytes).unwrap();
    };
    damage("2.fsh");
    refused(desk, "merge 1.fsh damaged.fsh 3.fsh -o x", &["damaged", "damaged.fsh"]);
    // the scene is another one now
    let text = std::fs::read_to_string(desk.join("room.toml")).unwrap();
    std::fs::write(desk.join("room.toml"), text.replace("fov = ", "fov = 1")).unwrap();
    refused(desk, "merge 1.fsh 2.fsh 3.fsh -o x", &["contents of the scene"]);
    assert!(!desk.join("x").exists());
}
