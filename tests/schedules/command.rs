//! `fredholm roulette`, and schedules wherever a command takes roulette.

fn fredholm(desk: &std::path::Path, line: &str) -> (i32, String, String) {
    let said = super::common::program::run(desk, line);
    (said.code, said.out, said.err)
}

#[test]
fn the_command_predicts_verifies_and_optimises() {
    let desk = tempfile::TempDir::new().unwrap();
    let line = "roulette sphere --size 16x16 --spp 64 --max-bounces 6 --schedules none,table:0,0.2,0.1,albedo --verify --optimise -o out";
    let (code, out, err) = fredholm(desk.path(), line);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.lines().all(|l| l.starts_with("fredholm ") || l.chars().count() <= 100), "{out}");
    for word in [
        "For the whole image,",
        "For indirect light (terms k ≥ 2)",
        "Measured: for the whole image",
        "times the rays of `albedo`",
    ] {
        assert!(out.replace('\n', " ").contains(word), "{word}: {out}");
    }
    let folder = desk.path().join("out");
    let csv = std::fs::read_to_string(folder.join("roulette.csv")).unwrap();
    // six schedules of seven terms, tail, all, and indirect light
    assert_eq!(csv.lines().count(), 1 + 6 * 10);
    let indirect = csv.lines().filter(|l| l.contains(",indirect,"));
    assert_eq!(indirect.filter(|l| l.starts_with("\"optimal-indirect\"")).count(), 1, "{csv}");
    let summary = fredholm::report::text::summary::read(&folder.join("summary.json")).unwrap();
    let moments = summary.cross_moments.unwrap();
    assert_eq!(moments["slots"].as_array().unwrap().len(), 14);
    assert_eq!(moments["slots"][13]["kind"], "tail");
    assert_eq!(moments["second"][2][13].as_array().unwrap().len(), 14);
    assert!(summary.files.iter().all(|f| folder.join(f).exists()));
    let (code, _, err) = fredholm(desk.path(), "roulette sphere --schedules half");
    assert!(code == 2 && err.contains("unknown roulette `half`") && err.contains("help:"), "{err}");
}

#[test]
fn the_best_schedule_can_be_asked_for_wherever_there_is_roulette() {
    let desk = tempfile::TempDir::new().unwrap();
    let common = "--size 16x16 --spp 64 --max-bounces 3 -q";
    let (code, out, err) = fredholm(
        desk.path(),
        &format!("sweep sphere --over roulette --schedules lecture,albedo,optimal {common} -o a"),
    );
    assert!(code == 0 && out.contains("optimal") && err.contains("optimal is table:"), "{out}{err}");
    let (code, _, err) =
        fredholm(desk.path(), &format!("sweep sphere --over roulette --values optimal-indirect {common} -o i"));
    assert!(code == 0 && err.contains("optimal-indirect is table:"), "{err}");
    let (code, out, err) = fredholm(desk.path(), &format!("render sphere --roulette optimal {common} -o b"));
    let words = out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(code == 0 && words.contains("roulette table:"), "{out}{err}");
    let (code, _, err) = fredholm(desk.path(), &format!("series sphere --worlds terms {common} -o c"));
    assert_eq!(code, 0, "{err}");
    let summary = fredholm::report::text::summary::read(&desk.path().join("c/summary.json")).unwrap();
    let moments = summary.cross_moments.unwrap();
    // two samples per pixel of 64; the moments of what is seen directly are those of the image
    assert_eq!((moments["paths"].as_u64(), moments["max_bounces"].as_u64()), (Some(512), Some(3)));
    // the eye is a slot of its own: its ray is the only one before vertex 1 but for a connection
    assert_eq!(moments["rays"][0], 1.0);
}

/// `--for` chooses the quantity: only its optimum is found and measured, and the numbers do not depend on it.
#[test]
fn the_optimum_is_that_of_the_quantity_that_was_asked_for() {
    let desk = tempfile::TempDir::new().unwrap();
    let small = "roulette cornell --size 16x16 --spp 64 --max-bounces 6 --schedules none --optimise -q";
    let column = |folder: &str, name: &str| {
        let csv = std::fs::read_to_string(desk.path().join(folder).join("roulette.csv")).unwrap();
        csv.lines().filter(|l| l.starts_with(&format!("\"{name}\""))).map(String::from).collect::<Vec<_>>()
    };
    for (folder, more) in [("both", ""), ("whole", "--for whole"), ("indirect", "--for indirect")] {
        let (code, out, err) = fredholm(desk.path(), &format!("{small} {more} -o {folder}"));
        assert_eq!(code, 0, "{out}{err}");
        assert_eq!(out.contains("For the whole image"), folder != "indirect", "{out}");
        assert_eq!(out.contains("For indirect light"), folder != "whole", "{out}");
    }
    assert!(column("whole", "optimal-indirect").is_empty() && column("indirect", "optimal").is_empty());
    // all but the seconds
    let without = |lines: Vec<String>| -> Vec<String> {
        lines.iter().map(|l| l.rsplit_once(',').unwrap().0.to_owned()).collect()
    };
    for (folder, name) in [("whole", "optimal"), ("indirect", "optimal-indirect")] {
        assert_eq!(without(column(folder, name)), without(column("both", name)));
    }
    assert_ne!(column("both", "optimal")[0], column("both", "optimal-indirect")[0]);
    let (code, _, err) = fredholm(desk.path(), "roulette cornell --for everything");
    assert!(code == 2 && err.contains("whole"), "{err}");
}

#[test]
fn the_enumeration_shows_that_no_schedule_changes_a_term() {
    let desk = tempfile::TempDir::new().unwrap();
    let line = "roulette cornell --size 16x16 --enumerate -q --schedules lecture,albedo,constant:0.9@0 -o out";
    let (code, out, err) = fredholm(desk.path(), line);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.starts_with("Roulette changes no term of any of "), "{out}");
    // the products of the example add up to what the path adds without roulette
    let csv = std::fs::read_to_string(desk.path().join("out/enumeration.csv")).unwrap();
    let column = |i: usize| csv.lines().skip(1).map(move |l| l.split(',').nth(i).unwrap().parse::<f64>().unwrap());
    let (probability, product): (f64, f64) = (column(1).sum(), column(3).sum());
    assert!((probability - 1.0).abs() < 1e-9, "{csv}");
    let said = out.split("Without roulette the path adds ").nth(1).unwrap().split('\n').next().unwrap();
    let without: f64 = said.trim_end_matches('.').parse().unwrap();
    assert!((product / without - 1.0).abs() < 1e-4, "{product} {without}");
    let (code, _, err) = fredholm(desk.path(), "roulette cornell --size 8x8 --enumerate -q --schedules optimal");
    assert!(code == 2 && err.contains("cannot be enumerated"), "{err}");
}
