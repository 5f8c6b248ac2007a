//! What a student sees first: the answer as a sentence, then small tables that are explained, then the folder.
#![allow(clippy::unwrap_used)]

#[path = "common/program.rs"]
#[allow(dead_code, unreachable_pub)]
mod program;

use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::progress::Progress;
use fredholm::report::image::exr;
use fredholm::scene::Scene;
use fredholm::zoo::Stage;
use program::{Said, run};
use std::path::Path;
use tempfile::TempDir;

/// Lines that a command may print without `--verbose`.
const MOST: usize = 30;

/// Runs a command. Its first block must be sentences, every table must have a sentence above it, and no line may be wide.
fn told(desk: &Path, line: &str) -> Said {
    let said = run(desk, line);
    assert!(said.code <= 1, "{line}: {}{}", said.out, said.err);
    let blocks: Vec<&str> = said.out.trim_end().split("\n\n").collect();
    let answer = blocks[0];
    assert!(answer.ends_with('.') && !answer.contains("  "), "{line}: the answer is no sentence\n{}", said.out);
    for block in &blocks {
        let lines: Vec<&str> = block.lines().collect();
        for rule in (0..lines.len()).filter(|&i| lines[i].starts_with('─')) {
            let above = rule.checked_sub(2).map(|i| lines[i]);
            assert!(above.is_some_and(|l| l.ends_with('.')), "{line}: no sentence above the table\n{block}");
        }
    }
    assert!(said.out.lines().all(|l| l.chars().count() <= 100), "{line}: too wide\n{}", said.out);
    said
}

/// The same for a command that writes a folder: it prints few lines, and the folder in the last block.
fn told_with_folder(desk: &Path, line: &str, folder: &str) -> Said {
    let said = told(desk, &format!("{line} -o {folder}"));
    let lines = said.out.lines().count();
    assert!(lines <= MOST, "{line}: {lines} lines\n{}", said.out);
    names_its_folder_last(&said, folder);
    said
}

fn names_its_folder_last(said: &Said, folder: &str) {
    let last = said.out.trim_end().rsplit("\n\n").next().unwrap();
    assert!(last.starts_with(&format!("written to {folder}: ")), "{}", said.out);
}

#[test]
fn the_matrix_answers_first() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let said = told_with_folder(desk, "radiosity cornell --patches 100 --solver all -q", "a");
    assert!(said.out.contains("products with T"), "{}", said.out);
    told_with_folder(desk, "radiosity cornell --patches 100 --solver lu -q", "b");
    told_with_folder(desk, "radiosity cornell --patches 100 --factors rays --rays 64 --solver all -q", "c");
    let modes = "radiosity cornell --patches 100 --size 8x8 --spp 2 -q --modes";
    let said = told_with_folder(desk, &format!("{modes} 12"), "d");
    assert!(said.out.starts_with("The spectral radius of the red channel is 0.6"), "{}", said.out);
    // all that is left out is there when it is asked for
    let all = told(desk, &format!("{modes} 12 -v -o d"));
    assert!(all.out.contains("Ratios ‖Tᵏ⁺¹E‖/‖TᵏE‖") && all.out.lines().count() > MOST, "{}", all.out);
    let said = told_with_folder(desk, "walk cornell --patches 40 --spp 64 -q", "e");
    assert!(said.out.contains("the powers of the matrix"), "{}", said.out);
    told_with_folder(desk, "walk furnace --patches 24 --spp 64 --max-bounces 20 -q", "f");
    let said = told_with_folder(desk, "walk furnace --patches 24 --estimator zero-variance --spp 16 -q", "g");
    assert!(said.out.contains("zero to rounding"), "{}", said.out);
    let sweep = "sweep cornell --over patches --values 40,150 --size 8x8 --spp 4 --max-bounces 9 -q";
    told_with_folder(desk, sweep, "h");
    told_with_folder(desk, &format!("{sweep} --eigenvalues 4"), "i");
}

#[test]
fn comparisons_and_checks_answer_first() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let series = "series furnace --worlds terms --size 8x8 --spp 64 --max-bounces 16 -q";
    for (folder, more) in [("a", ""), ("b", "--seed 1"), ("c", "--set materials.wall.reflectance=[0.6,0.5,0.5]")] {
        run(desk, &format!("{series} {more} -o {folder}"));
    }
    told_with_folder(desk, "compare a b", "ab");
    let said = told_with_folder(desk, "compare a c", "ac");
    assert!(said.out.starts_with("The two results differ in T1, "), "{}", said.out);
    let bias = "check bias --scene furnace --against single --size 8x8 --spp 1024 -q";
    told_with_folder(desk, bias, "d");
    told_with_folder(desk, &format!("{bias} --max-bounces 20"), "e");
    let balance = "check equilibrium cornell --points 16 --spp 512 --size 8x8 -q";
    told_with_folder(desk, balance, "f");
    let said = told_with_folder(desk, &format!("{balance} --break 3"), "g");
    assert!(said.out.contains("broken on purpose"), "{}", said.out);
}

#[test]
fn pictures_and_the_zoo_answer_first() {
    let desk = TempDir::new().unwrap();
    let desk = desk.path();
    let said = told_with_folder(desk, "zoo double-emission --size 16x16 --spp 64 -q", "a");
    assert!(said.out.contains("glass-furnace"), "{}", said.out);
    told_with_folder(desk, "zoo roulette-divides-by-q --size 8x8 --spp 16 -q", "b");
    // the members of the zoo are a list
    let said = told(desk, "zoo --size 8x8 --spp 2 -q -o all");
    names_its_folder_last(&said, "all");
    told(desk, "zoo --list");

    let scene = Scene::new(&Stage::CORNELL.load([16, 16]).unwrap());
    let settings = Settings { spp: 64, seed: 3, max_bounces: 3, ..Settings::default() };
    let right = by_rays::terms(&scene, Estimator::Prefix, &settings, Progress::NONE);
    let layers = [exr::Layer { name: "", pixels: &right.total.mean }];
    for name in ["right.exr", "again.exr"] {
        exr::write(&desk.join(name), 16, 16, &layers, &[]).unwrap();
    }
    for (files, folder) in [("right.exr", "r"), ("a/double-emission.exr", "w"), ("right.exr again.exr", "two")] {
        told_with_folder(desk, &format!("diagnose {files} --against cornell --spp 64 --paths 20000 -q"), folder);
    }
    let said = told_with_folder(desk, "figure kajiya-series --size 8x8 -q", "k");
    assert!(said.out.starts_with("With 4 paths per pixel"), "{}", said.out);
    told(desk, "figure --list");
}

#[test]
fn scenes_are_described_in_a_sentence() {
    let desk = TempDir::new().unwrap();
    told(desk.path(), "info");
    for scene in fredholm::scene::builtin::ALL {
        let said = told(desk.path(), &format!("info {}", scene.name));
        assert!(said.out.starts_with(scene.name) && said.out.lines().count() <= MOST, "{}", said.out);
    }
    let said = told(desk.path(), "info cornell");
    assert!(said.out.contains("55 bounces are enough") && said.out.contains("guaranteed bound"), "{}", said.out);
}
