//! `fredholm radiosity --export`: what another program reads is what this one holds.
#![allow(clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;

fn fredholm(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fredholm"));
    command.current_dir(folder).args(args);
    command
}

/// Header, and rows of numbers; columns that are no numbers are NaN.
fn csv(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap().into_iter().map(String::from).collect();
    (header, lines.map(|l| l.iter().map(|x| x.parse().unwrap_or(f64::NAN)).collect()).collect())
}

#[test]
fn the_files_hold_one_consistent_operator() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["radiosity", "cube", "--patches", "96", "--spp", "16", "--size", "8x8", "--max-bounces", "4", "-q"];
    fredholm(folder.path(), &[&args[..], &["--export", "matrix", "-o", "out"]].concat()).assert().success();
    let out = folder.path().join("out");
    let (names, mesh) = csv(&out.join("mesh.csv"));
    let column = |name: &str| names.iter().position(|n| n == name).unwrap();
    let (_, terms) = csv(&out.join("mesh-terms.csv"));
    assert_eq!((mesh.len(), terms.len(), terms[0].len()), (96, 96, 1 + 5 * 3));
    // F as NumPy reads it
    let bytes = std::fs::read(out.join("F.npy")).unwrap();
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert!(bytes.starts_with(b"\x93NUMPY") && start % 64 == 0 && bytes.len() == start + 4 * 96 * 96);
    let f = |i: usize, j: usize| {
        let at = start + 4 * (96 * i + j);
        f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()))
    };
    let [area, front] = ["area", "front"].map(column);
    assert!(mesh.iter().all(|p| (p[area] - 1.0 / 16.0).abs() < 1e-15 && p[front] == 1.0));
    for (c, channel) in ["r", "g", "b"].iter().enumerate() {
        let [rho, e, l] = ["rho", "E", "L"].map(|n| column(&format!("{n}_{channel}")));
        for (i, p) in mesh.iter().enumerate() {
            // L = E + ρ F L, T⁰E = E, T^{k+1}E = ρ F TᵏE
            let bounce = |x: &dyn Fn(usize) -> f64| p[rho] * (0..96).map(|j| f(i, j) * x(j)).sum::<f64>();
            assert!((p[l] - p[e] - bounce(&|j| mesh[j][l])).abs() < 1e-13);
            let term = |k: usize, j: usize| terms[j][1 + 3 * k + c];
            assert_eq!(term(0, i), p[e]);
            (0..4).for_each(|k| assert!((term(k + 1, i) - bounce(&|j| term(k, j))).abs() < 1e-15, "{k}"));
        }
        // norms in both files
        let summary: Value = serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
        let (_, norms) = csv(&out.join("norms.csv"));
        for k in 0..5 {
            let sum = |g: &dyn Fn(&Vec<f64>, f64) -> f64| {
                (0..96).map(|i| mesh[i][area] * g(&mesh[i], terms[i][1 + 3 * k + c])).sum::<f64>()
            };
            let expected = [sum(&|_, x| x.abs()), sum(&|_, x| x * x).sqrt(), sum(&|p, x| x * x / p[rho]).sqrt()];
            for (n, expected) in expected.into_iter().enumerate() {
                let said = summary["radiosity"]["norms"][k][["norm_1", "norm_2", "norm_w"][n]][c].as_f64().unwrap();
                assert!((norms[k][1 + 3 * n + c] - expected).abs() < 1e-13 && (said - expected).abs() < 1e-13);
            }
        }
    }
    // stored rays have patches and terms, but no matrix
    let rays = ["--factors", "rays", "--rays", "64"];
    fredholm(folder.path(), &[&args[..], &rays, &["--export", "mesh", "-o", "rays"]].concat()).assert().success();
    assert!(folder.path().join("rays/norms.csv").is_file() && !folder.path().join("rays/F.npy").exists());
    fredholm(folder.path(), &[&args[..], &rays, &["--export", "matrix", "-o", "no"]].concat()).assert().code(2);
}

#[test]
fn a_sweep_over_patches_shows_eigenvalues_and_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["sweep", "cube", "--over", "patches", "--values", "24,96,384", "--eigenvalues", "3", "--spp", "16"];
    let more = ["--size", "8x8", "--max-bounces", "2", "-q", "-o", "out"];
    let run = fredholm(folder.path(), &[&args[..], &more].concat()).assert().success();
    let printed = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(printed.lines().skip(1).all(|l| l.chars().count() <= 100), "{printed}");
    assert!(
        printed.contains("For h → 0 the spectral radius tends to") && printed.contains("the band of the edges"),
        "{printed}"
    );
    let (names, rows) = csv(&folder.path().join("out/eigenvalues.csv"));
    assert_eq!(names.join(","), "patches,h,channel,eigenvalue,value,residual,band");
    assert_eq!(rows.len(), 3 * 6);
    for row in &rows {
        assert!(row[3].signum() == row[4].signum() && row[5] < 1e-4, "{row:?}");
    }
    assert!(folder.path().join("out/eigenvalues.png").is_file());
    fredholm(folder.path(), &["sweep", "cube", "--over", "technique", "--eigenvalues", "3"]).assert().code(2);
    fredholm(folder.path(), &["radiosity", "cube", "--grading", "0.5"]).assert().code(2);
}
