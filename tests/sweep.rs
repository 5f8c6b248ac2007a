//! `fredholm sweep`: a row per value, numbers that programs can read, costs that are known, and refusals.
#![allow(clippy::unwrap_used)]

#[path = "sweep/brief.rs"]
mod brief;
#[path = "sweep/pictures.rs"]
mod pictures;
#[path = "common/program.rs"]
#[allow(dead_code, unreachable_pub)]
mod program;
#[path = "sweep/refusals.rs"]
mod refusals;
#[path = "sweep/samples.rs"]
mod samples;

use fredholm::engine::Settings;
use fredholm::estimator::Roulette;
use fredholm::progress::Progress;
use fredholm::report::image::exr;
use fredholm::report::text::summary;
use fredholm::scene::Scene;
use fredholm::scene::load::{self, Options};
use fredholm::stats::variance_slope;
use fredholm::study::split;
use program::{Said, run_tidily as run};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A sweep that must go well, in a folder of its own; its csv as one map per line.
struct Swept {
    said: Said,
    rows: Vec<std::collections::BTreeMap<String, String>>,
    folder: PathBuf,
    _desk: TempDir,
}

/// Cells of a line: commas inside quotes stay.
fn cells(line: &str) -> Vec<String> {
    let (mut all, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => all.push(String::new()),
            c => all.last_mut().unwrap().push(c),
        }
    }
    all
}

fn swept(line: &str) -> Swept {
    let desk = TempDir::new().unwrap();
    let said = run(desk.path(), &format!("sweep {line} -o out"));
    assert_eq!(said.code, 0, "{line}: {}{}", said.out, said.err);
    let folder = desk.path().join("out");
    let text = std::fs::read_to_string(folder.join("sweep.csv")).unwrap();
    let mut lines = text.lines().map(cells);
    let header = lines.next().unwrap();
    let row = |c: Vec<String>| {
        assert_eq!(c.len(), header.len(), "{c:?}");
        header.iter().cloned().zip(c).collect()
    };
    let rows = lines.map(row).collect();
    Swept { said, rows, folder, _desk: desk }
}

impl Swept {
    fn text(&self, value: &str, k: &str, column: &str) -> &str {
        let row = self.rows.iter().find(|r| r["value"] == value && r["k"] == k);
        &row.unwrap_or_else(|| panic!("no row {value}, {k}"))[column]
    }
    fn number(&self, value: &str, k: &str, column: &str) -> f64 {
        let text = self.text(value, k, column);
        text.parse().unwrap_or_else(|_| panic!("{value}, {k}, {column}: `{text}`"))
    }
    fn values(&self) -> Vec<&str> {
        let mut all: Vec<&str> = self.rows.iter().map(|r| r["value"].as_str()).collect();
        all.dedup();
        all
    }
}

const SMALL: &str = "--size 8x8 --spp 32 --max-bounces 3 -q";

#[test]
fn branching_takes_powers_of_its_children() {
    let s = swept(&format!("furnace --over branching --technique scatter --sampling uniform {SMALL}"));
    assert_eq!(s.values(), ["1", "2", "3", "4"]);
    for n in 1..=4u32 {
        let name = n.to_string();
        for k in 0..=3u32 {
            let of = |column| s.number(&name, &k.to_string(), column);
            assert_eq!(of("rays"), 64.0 * 32.0 * f64::from(n.pow(k)), "N = {n}, k = {k}");
            assert_eq!(of("rays_per_path"), f64::from(n.pow(k)));
            let truth = 0.5f64.powi(k as i32);
            assert!((of("mean") - truth).abs() <= 6.0 * of("std_error") + 1e-9, "N = {n}, k = {k}: {}", of("mean"));
            assert_eq!(of("replicates"), 16.0);
        }
        assert_eq!(s.text(&name, "0", "efficiency_per_ray"), "inf", "term 0 of a furnace has no noise");
        let (v, rays) = (s.number(&name, "2", "variance"), s.number(&name, "all", "rays_per_path"));
        assert!((s.number(&name, "2", "efficiency_per_ray") * v * rays - 1.0).abs() < 1e-9);
    }
    // all the noise of term 1 is in the children: N of them leave 1/N of it
    let ratio = s.number("4", "1", "variance") / s.number("1", "1", "variance");
    assert!((0.15..0.4).contains(&ratio), "{ratio}");

    // the small table has a line per value
    for n in ["1", "2", "3", "4"] {
        let line = |l: &&str| l.split_whitespace().next() == Some(n);
        assert_eq!(s.said.out.lines().filter(line).count(), 1, "{}", s.said.out);
    }
    assert!(s.said.out.contains("tail") && s.said.out.contains("whole image"), "{}", s.said.out);
    assert!(s.said.err.is_empty(), "{}", s.said.err);

    let mut names: Vec<String> =
        std::fs::read_dir(&s.folder).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["pictures.png", "summary.json", "sweep.csv", "sweep.png", "sweep.svg"]);
    let summary = summary::read(&s.folder.join("summary.json")).unwrap();
    assert_eq!(summary.files, names);
    assert_eq!(summary.series.len(), 4);
    assert_eq!(summary.series[2].label, "branching 3: branching 3, scatter");
    assert_eq!(summary.series[2].image().terms[1].replicates, 16);
    let svg = std::fs::read_to_string(s.folder.join("sweep.svg")).unwrap();
    for words in ["N = 3", "Cost: rays per path", "--over branching", "scene furnace"] {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn every_setting_has_its_usual_values() {
    for (over, values) in [
        ("technique", vec!["scatter", "connect", "mis", "mis-power"]),
        ("sampling", vec!["uniform", "cosine", "bsdf"]),
        ("estimator", vec!["prefix", "single", "branching", "light", "bidirectional"]),
        ("points", vec!["independent", "sobol"]),
        ("roulette", vec!["none", "lecture", "albedo"]),
    ] {
        let s = swept(&format!("cornell --over {over} {SMALL}"));
        assert_eq!(s.values(), values, "{over}");
        assert!(s.rows.iter().all(|r| r["over"] == over));
        assert!(std::fs::metadata(s.folder.join("sweep.png")).unwrap().len() > 1000);
    }
}

#[test]
fn a_row_is_what_series_gives() {
    let s = swept(&format!("cornell --over technique --values connect {SMALL} --seed 5"));
    let desk = TempDir::new().unwrap();
    let line = "series cornell --technique connect --worlds terms --seed 5 --max-bounces 3 --size 8x8 --spp 32 -q -o a";
    assert_eq!(run(desk.path(), line).code, 0);
    let summary = summary::read(&desk.path().join("a/summary.json")).unwrap();
    for (k, term) in summary.terms.iter().enumerate() {
        let of = |column| s.number("connect", &k.to_string(), column);
        assert_eq!(of("mean_g"), term.mean.y);
        assert_eq!(of("std_error_g"), term.std_error.y);
        assert_eq!(of("rays"), term.rays as f64);
        assert!((of("variance") / (term.variance.element_sum() / 3.0) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn given_values_replace_the_usual_ones() {
    let s = swept(&format!("furnace --over roulette --values table:0,0.5,none {SMALL}"));
    assert_eq!(s.values(), ["table:0,0.5", "none"]);
    assert!(s.said.out.contains("none*") && s.said.out.contains("* paths are cut at K"), "{}", s.said.out);
    assert!(s.rows.iter().all(|r| r["value"] != "none" || r["k"] != "tail"), "paths that are cut have no tail");
}

impl Swept {
    /// A cell of a sweep over spp.
    fn at(&self, value: &str, k: &str, n: u32, column: &str) -> f64 {
        let row = self.rows.iter().find(|r| r["value"] == value && r["k"] == k && r["n"] == n.to_string());
        let text = &row.unwrap_or_else(|| panic!("no row {value}, {k}, {n}"))[column];
        text.parse().unwrap_or_else(|_| panic!("{value}, {k}, {n}, {column}: `{text}`"))
    }
}

#[test]
fn equal_rays_are_shared_out() {
    let s = swept(
        "furnace --over branching --values 1,3 --equal-rays --technique scatter --roulette none --size 8x8 --spp 16 --max-bounces 3 -q",
    );
    // 1 + 1 + 1 + 1 against 1 + 3 + 9 + 27 rays per path
    assert_eq!((s.number("1", "all", "spp"), s.number("3", "all", "spp")), (160.0, 16.0));
    assert_eq!(s.number("1", "all", "rays"), s.number("3", "all", "rays"));
}

#[test]
fn series_branches_and_takes_sobol_points() {
    let desk = TempDir::new().unwrap();
    let line = "series furnace --estimator branching --branching 3 --points sobol --worlds terms --size 8x8 --spp 32 --max-bounces 2 -q -o a";
    let said = run(desk.path(), line);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.contains("branching 3, mis, Sobol points"), "{}", said.out);
    let summary = summary::read(&desk.path().join("a/summary.json")).unwrap();
    assert!(summary.command.contains("--points sobol"));
    let rays: Vec<u64> = summary.terms.iter().map(|t| t.rays).collect();
    assert_eq!(rays, [2048, 2048 * 6, 2048 * 18]);
    let said = run(desk.path(), "render furnace --points halton");
    assert_eq!(said.code, 2);
}

/// Coarse meshes of the box are too dark, finer ones less so.
#[test]
fn finer_meshes_come_nearer() {
    let dir = tempfile::tempdir().unwrap();
    let run = |line: &str| {
        let said = program::run(dir.path(), line);
        (said.code, said.out)
    };
    let (code, out) = run("sweep cornell --over patches --values 40,160 --size 48x48 --spp 64 -q -o p");
    assert_eq!(code, 0, "{out}");
    let csv = std::fs::read_to_string(dir.path().join("p/patches.csv")).unwrap();
    let row = |patches: &str, k: &str| -> Vec<f64> {
        let mut rows = csv.lines().map(|l| l.split(',').collect::<Vec<_>>());
        let found = rows.find(|c| c[0] == patches && c[2] == k).unwrap();
        found[3..5].iter().map(|x| x.parse().unwrap()).collect()
    };
    // all meshes are read along the same rays: what differs is the mesh, and what they read of T¹ does not
    assert!(row("161", "k ≥ 2")[0] > row("40", "k ≥ 2")[0] + 1e-4, "{csv}");
    assert_eq!(row("161", "T1"), row("40", "T1"));
    assert!(dir.path().join("p/places.png").exists() && dir.path().join("p/patches.svg").exists());
    assert_eq!(run("sweep cornell --over patches --values none -q").0, 2);
}
