//! `fredholm diagnose` on files: what it names, what it cannot see and says so, and bad input.

use super::common::program::{Said, run_tidily};
use super::*;

fn run(desk: &tempfile::TempDir, line: &str) -> Said {
    run_tidily(desk.path(), line)
}

/// What was said, without the ends of lines.
fn unwrapped(said: &Said) -> String {
    said.out.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Writes layers as an EXR.
fn write_exr(desk: &tempfile::TempDir, name: &str, [w, h]: [usize; 2], layers: &[(&str, &[[f32; 3]])]) {
    use fredholm::report::image::exr;
    let layers: Vec<exr::Layer> = layers.iter().map(|&(name, pixels)| exr::Layer { name, pixels }).collect();
    exr::write(&desk.path().join(name), w, h, &layers, &[]).unwrap();
}

const QUICK: &str = "--spp 256 --paths 400000 -q";

#[test]
fn the_command_says_correct_or_names_the_mistake() {
    let desk = tempfile::TempDir::new().unwrap();
    let scene = Scene::new(&Stage::CORNELL.load([16, 16]).unwrap());
    let s = Settings { spp: 256, seed: 9, max_bounces: 3, ..Settings::default() };
    let s = Settings { roulette: Roulette::Albedo { from: 2 }.after(3), ..s };
    let good = by_rays::terms(&scene, Estimator::Prefix, &s, Progress::NONE);
    let bad = zoo::render(zoo::find("missing-pi-connection").unwrap(), &scene, &s, Progress::NONE);
    for (file, render) in [("good.exr", &good), ("bad.exr", &bad)] {
        let names: Vec<String> = (0..4).map(|k| format!("T{k:02}")).collect();
        let mut layers: Vec<(&str, &[[f32; 3]])> = vec![("", &render.total.mean)];
        layers.extend(names.iter().zip(&render.terms).map(|(n, t)| (n.as_str(), t.mean.as_slice())));
        write_exr(&desk, file, [16, 16], &layers);
    }
    let said = run(&desk, &format!("diagnose good.exr --against cornell -o a {QUICK}"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.starts_with("good.exr is correct, as far as this data can tell"), "{}", said.out);
    assert!(
        said.out.contains("a uniform bias above") && unwrapped(&said).contains("To see whether samples repeat"),
        "{}",
        said.out
    );

    let said = run(&desk, &format!("diagnose bad.exr --against cornell -o b {QUICK}"));
    assert_eq!(said.code, 1, "{}{}", said.out, said.err);
    assert!(said.out.starts_with("bad.exr is wrong: all reflected light is 3.1"), "{}", said.out);
    assert!(
        said.out.contains("(π)") && said.out.contains("\nEvidence: ") && said.out.contains("\nNext: "),
        "{}",
        said.out
    );
    // the table is behind --verbose
    assert!(!said.out.contains("same r everywhere?"), "{}", said.out);
    let long = run(&desk, &format!("diagnose bad.exr --against cornell -o b2 {QUICK} -v"));
    assert!(long.out.contains("same r everywhere?") && long.out.contains("missing-pi-connection"), "{}", long.out);
    for file in ["diagnosis.png", "diagnosis.svg", "diagnosis.json", "summary.json"] {
        assert!(desk.path().join("b").join(file).is_file(), "{file}");
    }
    let svg = std::fs::read_to_string(desk.path().join("b/diagnosis.svg")).unwrap();
    assert!(svg.contains("constant-in-the-connection") && svg.contains("scene cornell"));

    // several files: a table, and the same numbers for any number of threads
    let line = format!("diagnose good.exr bad.exr --against cornell {QUICK}");
    let said = run(&desk, &format!("{line} -o c -t 1"));
    assert_eq!(said.code, 1);
    assert!(
        said.out.contains("1 of 2 pictures is wrong") && said.out.contains("data can tell: bias < "),
        "{}",
        said.out
    );
    let json = run(&desk, &format!("{line} --json -o c -t 2"));
    let json: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!(json[1]["diagnosis"]["suspects"][0]["name"], "constant-in-the-connection");
    assert_eq!(json[0]["diagnosis"]["verdict"], "correct");
    let stored = std::fs::read_to_string(desk.path().join("c/diagnosis.json")).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&stored).unwrap(), json);

    // terms in files of their own, and 8 bits of unknown exposure
    for (k, t) in good.terms.iter().enumerate() {
        write_exr(&desk, &format!("T{k:02}.exr"), [16, 16], &[("", t.mean.as_slice())]);
    }
    let said = run(&desk, &format!("diagnose T00.exr T01.exr T02.exr T03.exr --against cornell -o d {QUICK}"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let developed = fredholm::report::image::picture::develop(16, 16, &good.total.mean, 2.0);
    developed.picture.write(&desk.path().join("good.png")).unwrap();
    let said = run(&desk, &format!("diagnose good.png --against cornell -o e {QUICK}"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(
        said.out.contains("Read as 8 bits, sRGB, exposure 2.0") && unwrapped(&said).contains("the exposure is unknown"),
        "{}",
        said.out
    );
}

#[test]
fn growing_samples_show_what_one_picture_cannot() {
    let desk = tempfile::TempDir::new().unwrap();
    let scene = Scene::new(&Stage::CORNELL.load(SIZE).unwrap());
    for (name, bug) in [("same", Some("same-numbers")), ("gamma", Some("gamma-before-mean")), ("right", None)] {
        for spp in [16, 64, 256] {
            let s = settings(spp, 40 + u64::from(spp) * u64::from(bug != Some("same-numbers")));
            let render = match bug {
                Some(bug) => zoo::render(zoo::find(bug).unwrap(), &scene, &s, Progress::NONE),
                None => by_rays::path(&scene, &s, Progress::NONE),
            };
            write_exr(&desk, &format!("{name}_{spp}.exr"), [24, 24], &[("", render.total.mean.as_slice())]);
        }
        let files = [16, 64, 256].map(|n| format!("{name}_{n}.exr")).join(" ");
        let said = run(&desk, &format!("diagnose {files} --against cornell -o {name} {QUICK}"));
        match bug {
            Some(bug) => {
                assert_eq!(said.code, 1, "{}", said.out);
                let words = if bug == "same-numbers" {
                    "repeat the first ones"
                } else {
                    "gamma-encoded before they are averaged"
                };
                assert!(unwrapped(&said).contains(words), "{}", said.out);
            }
            None => assert_eq!(said.code, 0, "{}", said.out),
        }
    }
}

/// Inside a sphere nothing depends on its radius: only what is wrong in its measures does.
#[test]
fn a_larger_scene_shows_mixed_measures() {
    let desk = tempfile::TempDir::new().unwrap();
    let mixed = zoo::find("mixed-measures").unwrap();
    for (radius, stage) in [(1, Stage::SPHERE), (10, Stage::LARGE_SPHERE)] {
        let scene = Scene::new(&stage.load([16, 16]).unwrap());
        let s = Settings { max_bounces: 3, ..settings(256, 20 + radius) };
        let wrong = zoo::render(mixed, &scene, &s, Progress::NONE);
        let right = zoo::render_right(mixed, &scene, &s, Progress::NONE);
        for (name, render) in [("wrong", &wrong), ("right", &right)] {
            write_exr(&desk, &format!("{name}{radius}.exr"), [16, 16], &[("T01", render.terms[1].mean.as_slice())]);
        }
    }
    let lengths = "lengths do not cancel as they must";
    // no candidates: what the two scales say by themselves
    let few = "--spp 256 --paths 1 -q --json";
    let names = |said: &Said| {
        let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
        let list = json[0]["diagnosis"]["findings"].as_array().unwrap().clone();
        list.iter().map(|s| s["members"][0].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let said = run(&desk, &format!("diagnose wrong1.exr --scale 10=wrong10.exr --against sphere -o a {few}"));
    assert_eq!(said.code, 1, "{}", said.err);
    assert!(said.out.contains(lengths) && names(&said).contains(&"mixed-measures".into()), "{}", said.out);
    let said = run(&desk, &format!("diagnose right1.exr --scale 10=right10.exr --against sphere -o b {few}"));
    assert_eq!(said.code, 0, "{}", said.out);
    assert!(!said.out.contains(lengths) && names(&said).is_empty(), "{}", said.out);
    // the right picture, beside a large one that is not
    let said = run(&desk, &format!("diagnose right1.exr --scale 10=wrong10.exr --against sphere -o c {few}"));
    assert_eq!(said.code, 1, "{}", said.err);
    assert_eq!(names(&said), ["mixed-measures"], "{}", said.out);
    assert!(said.out.contains(lengths), "{}", said.out);
}

/// A lamp close below the ceiling that shines upwards, too: its light lies in few pixels, and is in no other renderer.
#[test]
fn too_few_pixels_are_said_to_be_too_few() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let behind = zoo::find("light-from-behind").unwrap();
    let render = |mistake: bool| {
        let s = settings(512, 31);
        let make = if mistake { zoo::render } else { zoo::render_right };
        without_errors(Pictures::of(&make(behind, &bench.scene, &s, Progress::NONE), SIZE))
    };
    // this light comes through few pixels: if that is too few to decide, it is said
    let d = bench.judge(&render(true), None, 1e-6);
    assert!(d.verdict == Conclusion::Wrong || !d.undecided.is_empty(), "{:?}", d.evidence.ratios);
    let d = bench.judge(&render(false), None, 1e-6);
    assert!(d.verdict == Conclusion::Correct || !d.undecided.is_empty(), "{}", d.worst);
    // one firefly, as bright as half of all pixels together, decides nothing, and that is said
    let mut one = render(false).only(|s| s == Slot::Term(1));
    one.layers[0].mean[40] = [10.0; 3];
    let d = bench.judge(&one, None, 1e-6);
    assert_eq!((d.verdict, d.outliers.len(), d.limits.len()), (Conclusion::Undecided, 1, 1), "{}", d.p);
}

/// A lamp of few pixels: it is seen that it is missing, with its term and in the whole image.
#[test]
fn a_small_lamp_is_missed() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let missing = zoo::find("emission-missing").unwrap();
    let render = zoo::render(missing, &bench.scene, &settings(64, 32), Progress::NONE);
    let all = without_errors(Pictures::of(&render, SIZE));
    for part in [all.clone(), all.only(|s| s == Slot::Whole)] {
        let d = bench.judge(&part, None, 1e-6);
        assert_eq!(d.verdict, Conclusion::Wrong, "{:?} {}", d.evidence.ratios, d.p);
    }
}

#[test]
fn bad_input_is_refused_in_words() {
    let desk = tempfile::TempDir::new().unwrap();
    let grey = vec![[0.5f32; 3]; 64];
    write_exr(&desk, "small.exr", [8, 8], &[("", &grey)]);
    write_exr(&desk, "wide.exr", [16, 4], &[("", &grey)]);
    write_exr(&desk, "tiny.exr", [2, 2], &[("", &grey[..4])]);
    write_exr(&desk, "albedo.exr", [8, 8], &[("albedo", &grey), ("normal", &grey)]);
    std::fs::write(desk.path().join("text.png"), "not an image").unwrap();
    std::fs::write(desk.path().join("cut.exr"), [0x76, 0x2f, 0x31, 0x01, 2, 0]).unwrap();
    std::fs::create_dir(desk.path().join("empty")).unwrap();
    for (line, code, said) in [
        ("diagnose --against cornell", 2, "required arguments were not provided"),
        ("diagnose small.exr", 2, "--against"),
        ("diagnose small.exr --against cornell --alpha 2", 2, "`2` is not between 0 and 1"),
        ("diagnose small.exr --against cornell --gain -1", 2, "unexpected argument '-1'"),
        ("diagnose small.exr --against cornell --gain=-1", 2, "`-1` is not a number of at least 0"),
        ("diagnose small.exr --against cornell --scale 10", 2, "`10` is not SCALE=FILE"),
        ("diagnose small.exr wide.exr --as bounces --against cornell", 2, "do not end in numbers"),
        ("diagnose nowhere.exr --against cornell", 3, "check the name, or render the scene first"),
        ("diagnose text.png --against cornell", 3, "not a readable image"),
        ("diagnose cut.exr --against cornell", 3, "not a readable OpenEXR file"),
        ("diagnose albedo.exr --against cornell", 3, "no layer is a term or a whole image: albedo, normal"),
        ("diagnose tiny.exr --against cornell", 3, "too few to tell a bias from noise"),
        ("diagnose wide.exr --against cornell", 3, "their aspect ratios differ"),
        ("diagnose small.exr --scale 10=wide.exr --against cornell", 3, "different sizes, 16×4 and 8×8"),
        ("diagnose small.exr --against corneII", 3, "corneII"),
        ("diagnose small.exr --against empty", 3, "summary.json"),
    ] {
        let answer = run(&desk, line);
        assert_eq!(answer.code, code, "{line}: {}", answer.err);
        assert!(answer.err.contains(said), "{line}: {}", answer.err);
        assert!(answer.out.is_empty() && !desk.path().join("fredholm-out").exists(), "{line}");
        assert!(code == 2 || answer.err.contains("help: "), "{line}: {}", answer.err);
    }
}
