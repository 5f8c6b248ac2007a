//! Every figure by its name, the figures of the lecture with their page, and the homework.
#![allow(clippy::unwrap_used)]

mod common;

use common::program::run;
use fredholm::report::text::summary;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The names of all figures.
fn names(desk: &Path) -> Vec<String> {
    let listed = run(desk, "figure --list").out;
    // the list comes after the first blank line
    let list = listed.lines().skip_while(|l| !l.is_empty());
    list.filter_map(|l| l.split_whitespace().next()).map(String::from).collect()
}

fn size(path: &Path) -> [u32; 2] {
    let (w, h) = image::image_dimensions(path).unwrap();
    [w, h]
}

#[test]
fn every_figure_is_made() {
    let desk = TempDir::new().unwrap();
    let ids = names(desk.path());
    let some = ["one-path", "mis", "roulette", "kajiya-series", "noise-paths", "variance-cornell", "cs184-part4"];
    assert!(some.iter().all(|id| ids.iter().any(|i| i == id)), "{ids:?}");
    let said = run(desk.path(), "figure --all --quick --size 16x16 -q -o all");
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let all = desk.path().join("all");
    let page = fs::read_to_string(all.join("index.html")).unwrap();
    for id in &ids {
        let summary = summary::read(&all.join(id).join("summary.json")).unwrap();
        assert!(summary.files.iter().any(|f| f.ends_with(".png")), "{id}: {:?}", summary.files);
        assert!(summary.files.iter().all(|f| all.join(id).join(f).exists()), "{id}: {:?}", summary.files);
        // the command that makes this figure alone
        assert!(summary.command.starts_with(&format!("fredholm figure {id} --quick")), "{}", summary.command);
        assert!(page.contains(&format!("<section id=\"{id}\">")), "the page does not show {id}");
    }
    for picture in page.split("<img src=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(all.join(picture).exists(), "{picture}");
    }
    assert!(!page.contains("http"), "the page asks the network");
    // the numbers of the sheet: what a screen shows is less than what the samples say, and the mean is the same
    let csv = fs::read_to_string(all.join("kajiya-series/kajiya-series.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(rows[0][..4], ["paths", "mean", "mean_half_width_95", "mean_shown"]);
    let stages: Vec<&str> = rows[1..].iter().map(|r| r[0]).collect();
    assert_eq!(stages, ["4", "8", "16", "32", "64", "128", "reference"]);
    for r in &rows[1..] {
        let (mean, shown): (f64, f64) = (r[1].parse().unwrap(), r[3].parse().unwrap());
        assert!(shown > 0.0 && shown < mean, "{r:?}");
    }
    // one render: the same bits with one thread
    assert_eq!(run(desk.path(), "figure kajiya-series --size 16x16 -q -o one").code, 0);
    assert_eq!(fs::read_to_string(desk.path().join("one/kajiya-series.csv")).unwrap(), csv);
}

#[test]
fn a_wrong_name_is_answered() {
    let desk = TempDir::new().unwrap();
    for (line, says) in [("figure", "--list"), ("figure mona-lisa", "no figure is called `mona-lisa`")] {
        let said = run(desk.path(), line);
        assert_eq!(said.code, 2, "{line}: {}", said.err);
        assert!(said.err.contains(says), "{}", said.err);
    }
}

/// A slide is 1920 pixels wide and not higher than the page of a projector allows.
#[test]
fn figures_of_the_lecture_have_the_size_of_a_slide() {
    let desk = TempDir::new().unwrap();
    for id in ["one-path", "emission-rules", "area-to-solid-angle", "kajiya-series"] {
        assert_eq!(run(desk.path(), &format!("figure {id} --quick -q -o {id}")).code, 0, "{id}");
        let [w, h] = size(&desk.path().join(id).join(format!("{id}.png")));
        assert!(w == 1920 && h <= 1400, "{id}: {w}×{h}");
    }
}

#[test]
fn the_homework_is_complete_and_roulette_is_not_biased() {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), "figure cs184-part4 --quick -q -o work");
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let folder = desk.path().join("work");
    let record = summary::read(&folder.join("summary.json")).unwrap();
    let numbered = |name: &str, all: &[u32]| all.iter().map(|n| format!("{name}-{n}.png")).collect::<Vec<_>>();
    let asked = [
        numbered("bounce", &[0, 1, 2, 3, 4, 5]),
        numbered("accumulated", &[0, 1, 2, 3, 4, 5]),
        numbered("roulette", &[0, 1, 2, 3, 4, 100]),
        [1, 2, 4, 8, 16, 32, 64].iter().map(|n| format!("spp-{n:04}.png")).collect(),
        vec!["direct.png".into(), "indirect.png".into(), "decay.svg".into(), "index.html".into()],
    ];
    for file in asked.concat() {
        assert!(record.files.contains(&file) && folder.join(&file).exists(), "{file}");
    }
    // every term is compared, without and with roulette, and none differs
    assert!((0..=5).all(|k| record.verdicts.iter().any(|v| v.name.starts_with(&format!("T{k}:")))));
    assert!(said.out.contains("agree") || said.out.contains("do not contradict"), "{}", said.out);

    let csv = fs::read_to_string(folder.join("homework.csv")).unwrap();
    let mut mean: HashMap<(String, usize), f64> = HashMap::new();
    let mut error = vec![];
    for row in csv.lines().skip(1).map(|l| l.split(',').collect::<Vec<_>>()) {
        match row[0] {
            "spp" => error.push(row[4].parse::<f64>().unwrap()),
            name => drop(mean.insert((name.into(), row[1].parse().unwrap()), row[2].parse().unwrap())),
        }
    }
    // the terms fall from k = 1 on, and more samples have less noise
    assert!((1..5).all(|k| mean[&("bounce".to_string(), k)] > mean[&("bounce".to_string(), k + 1)]));
    assert!(error[0] > 3.0 * error[6] && error[6] > 0.0, "{error:?}");
}
