//! `fredholm radiosity --solver`: what is printed, written and refused.
#![allow(clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;

fn fredholm(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fredholm"));
    command.current_dir(folder).args(args);
    command
}

const ALL: [&str; 9] = ["Neumann", "Jacobi", "Gauss–Seidel", "SOR", "Southwell", "Chebyshev", "CG", "GMRES", "LU"];

#[test]
fn all_solvers_stand_in_one_table_and_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["radiosity", "cornell", "--patches", "150", "--solver", "all", "--history", "h.csv", "-o", "out"];
    let run = fredholm(folder.path(), &args).assert().success();
    let printed = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(printed.lines().all(|l| l.chars().count() <= 80), "{printed}");
    for name in ALL {
        assert!(printed.lines().any(|l| l.starts_with(name)), "{name} in\n{printed}");
    }
    let out = folder.path().join("out");
    for file in ["solvers.json", "solvers.svg", "solvers.png", "summary.json", "h.csv"] {
        assert!(out.join(file).is_file() && printed.contains(file), "{file}");
    }
    let svg = std::fs::read_to_string(out.join("solvers.svg")).unwrap();
    assert!(svg.contains("--solver all") && ALL[..8].iter().all(|name| svg.contains(name)));
    // the same command replaces its own output, another one does not; --json is what is in the file, and the same steps
    let again = fredholm(folder.path(), &[&args[..], &["--json"]].concat()).assert().success();
    let json: Value = serde_json::from_slice(&again.get_output().stdout).unwrap();
    let file: Value = serde_json::from_str(&std::fs::read_to_string(out.join("solvers.json")).unwrap()).unwrap();
    assert_eq!(json, file);
    fredholm(folder.path(), &["radiosity", "cornell", "--patches", "150", "--solver", "cg", "-o", "out"])
        .assert()
        .code(3);
    // table, JSON and CSV hold one set of numbers; all solvers get to 1e-10
    let csv = std::fs::read_to_string(out.join("h.csv")).unwrap();
    assert_eq!(csv.lines().next(), Some("solver,step,products,norm,residual,error,seconds"));
    for (solver, name) in json["solvers"].as_array().unwrap().iter().zip(ALL) {
        assert_eq!(solver["solver"], name);
        let steps = solver["steps"].as_array().unwrap();
        assert_eq!(csv.lines().filter(|l| l.split(',').next() == Some(name)).count(), steps.len());
        let last = solver["reaches"][2]["products"].as_f64().unwrap();
        let whole = if last.fract() == 0.0 { format!("{last:.0}") } else { format!("{last:.1}") };
        let row = printed.lines().rev().find(|l| l.starts_with(name)).unwrap();
        assert!(row.split_whitespace().any(|word| word == whole), "{whole} in {row}");
        let errors: Vec<f64> = steps.iter().map(|s| s["error"].as_f64().unwrap()).collect();
        assert!(errors[errors.len() - 1] <= 1e-12, "{name}: {errors:?}");
    }
}

/// Stored rays: the same files, without what needs a symmetric matrix, and with the residual of the reference.
#[test]
fn stored_rays_are_solved_in_every_way_but_two() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["radiosity", "cornell", "--patches", "200", "--factors", "rays", "--rays", "64", "--solver", "all"];
    let args = [&args[..], &["--history", "h.csv", "-o", "out"]].concat();
    let run = fredholm(folder.path(), &[&args[..], &["--verbose"]].concat()).assert().success();
    let printed = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(printed.lines().all(|l| l.chars().count() <= 100), "{printed}");
    let names: Vec<&str> = ALL.into_iter().filter(|n| !matches!(*n, "CG" | "LU")).collect();
    let again = fredholm(folder.path(), &[&args[..], &["--json", "-t", "1"]].concat()).assert().success();
    let json: Value = serde_json::from_slice(&again.get_output().stdout).unwrap();
    let shown: Vec<&str> = json["solvers"].as_array().unwrap().iter().map(|s| s["solver"].as_str().unwrap()).collect();
    assert_eq!((shown, json["rays"].as_u64(), json["unknown"].as_str()), (names.clone(), Some(64), Some("u")));
    let (reference, residual) = (&json["reference"], json["reference"]["residual"].as_f64().unwrap());
    assert!(reference["solver"] == "GMRES" && residual > 0.0 && residual < 1e-15, "{reference}");
    assert!(printed.contains(&format!("{residual:.1e} of ‖D‖")), "{printed}");
    let csv = std::fs::read_to_string(folder.path().join("out/h.csv")).unwrap();
    for name in names {
        assert!(printed.lines().any(|l| l.starts_with(name)) && csv.contains(&format!("\n{name},")), "{name}");
    }
    let one = [&args[..8], &["--solver", "gmres", "--channel", "blue", "--json", "-o", "one"]].concat();
    let run = fredholm(folder.path(), &one).assert().success();
    let json: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(json["solvers"].as_array().unwrap().len(), 1, "the reference has no row");
    for (solver, why) in [("cg", "self-adjoint"), ("lu", "no matrix")] {
        let args = ["radiosity", "cornell", "--factors", "rays", "--solver", solver];
        let run = fredholm(folder.path(), &args).assert().code(2);
        let text = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(text.contains(why) && text.contains("help: use --solver gmres"), "{text}");
    }
    fredholm(folder.path(), &["radiosity", "cornell", "--factors", "both", "--solver", "all"]).assert().code(2);
}

/// Extrapolation shows its error and its noise: the plain sum is not amplified, and a known rate helps most at first.
#[test]
fn the_series_is_extrapolated_beside_the_solvers() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["radiosity", "cornell", "--patches", "150", "--solver", "neumann", "--json", "-q"];
    let run = fredholm(folder.path(), &args).assert().success();
    let json: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    let rows = json["extrapolations"].as_array().unwrap();
    assert_eq!(rows.iter().map(|r| r["terms"].as_u64().unwrap()).collect::<Vec<_>>(), [3, 5, 7, 9, 13]);
    for row in rows {
        let number = |i: usize, key: &str| row["methods"][i][key].as_f64();
        assert!((number(0, "noise_gain").unwrap() - 1.0).abs() < 1e-12);
        assert!((1..5).all(|i| number(i, "error").is_none_or(|e| e < number(0, "error").unwrap())), "{row}");
    }
    assert!(rows[0]["methods"][2]["error"].is_null(), "two steps need five terms");
}

/// Values, bounds, ratios and pictures of the modes.
#[test]
fn modes_are_named_outside_the_band_only() {
    let folder = tempfile::tempdir().unwrap();
    let args =
        ["radiosity", "cornell", "--patches", "150", "--modes", "10", "--size", "16x16", "--spp", "4", "-o", "out"];
    let run = fredholm(folder.path(), &[&args[..], &["--verbose"]].concat()).assert().success();
    let printed = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(printed.lines().all(|l| l.chars().count() <= 100 || l.starts_with("fredholm ")), "{printed}");
    let out = folder.path().join("out");
    for file in ["modes.json", "modes.svg", "modes.png", "modes-painted.png", "summary.json"] {
        assert!(out.join(file).is_file() && printed.contains(file), "{file}");
    }
    let again = fredholm(folder.path(), &[&args[..], &["--json", "-t", "1"]].concat()).assert().success();
    let json: Value = serde_json::from_slice(&again.get_output().stdout).unwrap();
    for channel in json["channels"].as_array().unwrap() {
        let band = channel["band"].as_f64().unwrap();
        let radius = ["at_least", "at_most"].map(|k| channel["spectral_radius"][k].as_f64().unwrap());
        let modes = channel["modes"].as_array().unwrap();
        assert_eq!(modes.len(), 10);
        for m in modes {
            let value = m["value"].as_f64().unwrap();
            assert_eq!(m["outside_band"].as_bool().unwrap(), value.abs() > band);
            assert!(printed.contains(&format!("{value:+.5}")), "{value} in\n{printed}");
        }
        let first = modes[0]["value"].as_f64().unwrap();
        assert!(radius[0] - 1e-7 <= first && first <= radius[1] + 1e-7, "{first} and {radius:?}");
        let ratios: Vec<f64> =
            channel["weighted_ratios"].as_array().unwrap().iter().map(|r| r.as_f64().unwrap()).collect();
        assert!(ratios.windows(2).all(|w| w[1] >= w[0] - 1e-7) && ratios.iter().all(|r| *r <= radius[1] + 1e-7));
        let norms = ["norm_1", "norm_2", "norm_inf"].map(|k| channel[k].as_f64().unwrap());
        assert!(norms.iter().all(|n| *n >= radius[0] - 1e-7));
    }
    assert!(printed.contains("in the band"));
}

#[test]
fn one_solver_and_a_channel_can_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let base = ["radiosity", "cornell", "--patches", "100", "--json", "-q", "--solver"];
    for (name, shown, channel) in [("gauss-seidel", "Gauss–Seidel", "green"), ("southwell", "Southwell", "blue")] {
        let run = fredholm(folder.path(), &[&base[..], &[name, "--channel", channel]].concat()).assert().success();
        let json: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
        let names: Vec<&str> =
            json["solvers"].as_array().unwrap().iter().map(|s| s["solver"].as_str().unwrap()).collect();
        assert_eq!((names, json["channel"].as_str()), (vec![shown, "LU"], Some(channel)));
    }
    assert!(folder.path().join("fredholm-out/cornell-solvers-2/solvers.json").is_file());
    // LU alone has no steps to draw
    fredholm(folder.path(), &[&base[..], &["lu", "-o", "lu"]].concat()).assert().success();
    assert!(!folder.path().join("lu/solvers.svg").exists());
}

#[test]
fn what_cannot_be_solved_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let code = |args: &[&str]| {
        let run = fredholm(folder.path(), args).assert();
        let output = run.get_output();
        (output.status.code(), String::from_utf8(output.stderr.clone()).unwrap())
    };
    let (status, text) = code(&["radiosity", "cornell", "--history", "h.csv"]);
    assert!(status == Some(2) && text.contains("--solver"), "{text}");
    let (status, text) = code(&["radiosity", "cornell", "--solver", "newton"]);
    assert!(status == Some(2) && text.contains("newton"), "{text}");
    for name in ["summary.json", "../h.csv", "folder/"] {
        let (status, text) = code(&["radiosity", "cornell", "--solver", "cg", "--history", name]);
        assert!(status == Some(2) && text.contains("not the name of a file"), "{text}");
    }
    let (status, text) = code(&["radiosity", "cornell", "--channel", "red"]);
    assert!(status == Some(2) && text.contains("--modes"), "{text}");
    let (status, text) = code(&["radiosity", "cornell", "--solver", "cg", "--modes", "4"]);
    assert!(status == Some(2) && text.contains("cannot be used with"), "{text}");
    let (status, text) = code(&["radiosity", "veach-mis", "--solver", "all"]);
    assert!(status == Some(2) && text.contains("no radiosity matrix can hold this scene"), "{text}");
    let white =
        ["radiosity", "furnace", "--set", "materials.wall.reflectance=[1,1,1]", "--solver", "all", "--patches", "50"];
    let (status, text) = code(&white);
    assert!(status == Some(3) && text.contains("loses no light"), "{text}");
}
