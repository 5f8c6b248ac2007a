//! `fredholm check` as its users meet it: verdicts, exit codes, files.
#![allow(clippy::unwrap_used)]

#[path = "common/program.rs"]
#[allow(dead_code, unreachable_pub)]
mod program;

use fredholm::report::text::summary;
use program::{Said, run};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }
    fn command(&self, line: &str) -> Command {
        program::command(self.0.path(), line)
    }
    fn run(&self, line: &str) -> Said {
        run(self.0.path(), line)
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn equal_estimators_have_no_bias_for_any_number_of_threads() {
    let desk = Desk::new();
    let line = "check bias --scene furnace --against single --max-bounces 3 --size 8x8 --spp 4096 -q";
    let said = desk.run(&format!("{line} -v -o a"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.contains("comparisons share α") && said.out.contains("could have missed"), "{}", said.out);
    for file in ["bias.png", "bias.svg", "summary.json"] {
        assert!(desk.path("a").join(file).exists(), "{file}");
    }
    let record = summary::read(&desk.path("a/summary.json")).unwrap();
    assert!(record.verdicts.iter().any(|v| v.name.starts_with("T2")) && record.spp <= 4096);
    let [one, two] = [1, 2].map(|t| json(&desk.run(&format!("{line} --json -t {t} -o b{t}")).out));
    assert_eq!(one["findings"], two["findings"]);
}

/// A finished run of a scene that is a little brighter is told apart; one of the scene itself is not.
#[test]
fn a_finished_run_of_another_scene_is_told_apart() {
    let desk = Desk::new();
    let series = "series furnace --size 16x16 --spp 64 --max-bounces 3 --worlds terms -q";
    assert_eq!(desk.run(&format!("{series} -o right")).code, 0);
    assert_eq!(desk.run(&format!("{series} --set materials.wall.reflectance=[0.7,0.7,0.7] -o wrong")).code, 0);
    // pixels of batches are those of the run, whose regions they are compared with
    let said = desk.run("check bias --scene furnace --size 8x8 --against right");
    assert!(said.code == 2 && said.err.contains("16×16"), "{}", said.err);
    let bias = "check bias --scene furnace --max-bounces 3 --spp 4096 -q --against";
    let said = desk.run(&format!("{bias} right -o a"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let said = desk.run(&format!("{bias} wrong -o b"));
    assert_eq!(said.code, 1, "{}{}", said.out, said.err);
    assert!(said.out.contains("Biased: ") && said.out.contains("T1"), "{}", said.out);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let desk = Desk::new();
    for (line, code, word) in [
        ("check bias --estimator nonsense", 2, "`nonsense` is none of single"),
        ("check bias --against no-such-folder", 2, "folder"),
        ("check bias --alpha 2", 2, "between 0 and 1"),
        ("check bias --time soon", 2, "30s"),
        ("check bias --scene nowhere.toml", 3, "nowhere"),
        ("check equilibrium cornell --roulette none", 2, "cut at K"),
        ("check equilibrium cornell --break 0", 2, "above 0"),
    ] {
        let said = desk.run(line);
        assert_eq!(said.code, code, "{line}: {}{}", said.out, said.err);
        assert!(said.err.contains(word), "{line}: {}", said.err);
    }
}

#[test]
fn equilibrium_holds_and_breaks() {
    let desk = Desk::new();
    let line = "check equilibrium sphere --points 16 --spp 4096 --size 16x16 -q";
    let said = desk.run(&format!("{line} -o right"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    for file in ["equilibrium.png", "equilibrium.svg", "sides.png", "z.png", "points.json", "summary.json"] {
        assert!(desk.path("right").join(file).exists(), "{file}");
    }
    let said = desk.run(&format!("{line} --break 1.5 --json -o wrong"));
    assert_eq!((said.code, json(&said.out)["outcome"].as_str()), (1, Some("differs")), "{}{}", said.out, said.err);
    assert_eq!(json(&said.out)["points"].as_array().unwrap().len(), 16);
}

/// Ctrl-C is one of the ways to end a watch: what is known by then is said and saved.
#[cfg(unix)]
#[test]
fn a_watch_may_be_interrupted() {
    let desk = Desk::new();
    let line = "check bias --size 16x16 --delta 1e-6 --time 10m -o stopped";
    let child = desk.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    std::thread::sleep(Duration::from_secs(3));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert!(started.elapsed() < Duration::from_secs(60));
    let out = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(130), "{out}");
    assert!(out.contains("No bias found") && desk.path("stopped/summary.json").exists(), "{out}");
    assert!(String::from_utf8(output.stderr).unwrap().contains("batches"));
}

/// The furnace with other expected values: the scene of the program, with one line of its file changed.
fn furnace(desk: &Desk, from: &str, to: &str) {
    let text = include_str!("../scenes/furnace.toml");
    assert!(text.contains(from), "{from}");
    std::fs::write(desk.path("mine.toml"), text.replace(from, to)).unwrap();
}

#[test]
fn a_scene_keeps_what_its_file_promises() {
    let desk = Desk::new();
    furnace(&desk, "gamma = 0.5", "gamma = 0.5");
    let said = desk.run("check scene mine.toml -q -o right");
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.starts_with("All 10 values of [expect] are confirmed"), "{}", said.out);
    let record = summary::read(&desk.path("right/summary.json")).unwrap();
    assert!(record.verdicts.iter().any(|v| v.name.starts_with("path tracer: total")), "{:?}", record.verdicts);
    let again = desk.run("check scene mine.toml -q -o right -t 1");
    assert_eq!(said.out, again.out, "the same bits for any number of threads");
}

#[test]
fn a_wrong_promise_is_found() {
    // one term 2 % too small; a ratio that a slip of the pen changes; a total that forgets the tail; and a rounded value
    let desk = Desk::new();
    let sum = "gamma = 0.5";
    for (from, to, wrong) in [
        ("terms = [1, 0.5, 0.25,", "terms = [1, 0.5, 0.245,", Some("T2")),
        (sum, "gamma = 0.05", Some("tail")),
        (sum, "total = 2.05", Some("total")),
        (sum, "total = 2.00002", None),
    ] {
        furnace(&desk, from, to);
        let said = desk.run("check scene mine.toml -q --force -o wrong");
        assert_eq!(said.code, i32::from(wrong.is_some()), "{to}: {}{}", said.out, said.err);
        if let Some(name) = wrong {
            let answer = said.out.split("\n\n").next().unwrap().replace('\n', " ");
            assert!(answer.contains(name) && answer.contains("not what [expect] says"), "{to}: {answer}");
        }
    }
}

#[test]
fn only_promises_of_the_file_itself_are_checked() {
    let desk = Desk::new();
    let said = desk.run("check scene cornell -q");
    assert_eq!(said.code, 3);
    assert!(said.err.contains("no table [expect]") && said.err.contains("\nhelp: "), "{}", said.err);
    let said = desk.run("check scene furnace --set materials.wall.reflectance=[0.4,0.4,0.4] -q");
    assert_eq!(said.code, 2, "{}", said.err);
}
