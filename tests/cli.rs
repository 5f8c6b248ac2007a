//! The command line as its users meet it: files, texts, exit codes, and what a second run may replace.
#![allow(clippy::unwrap_used)]

use fredholm::report::{image::exr, text::summary};
use fredholm::terms::World;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// What a command left on the screen.
struct Said {
    code: i32,
    out: String,
    err: String,
}

/// A folder of its own for every test: the program writes below the folder it stands in.
struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
        command.args(line.split_whitespace()).current_dir(self.0.path());
        command
    }
    fn run(&self, line: &str) -> Said {
        let output = self.command(line).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let said = Said { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) };
        assert!(!said.err.contains("panicked"), "{line}: {}", said.err);
        assert!(!said.out.contains("\n\n\n"), "{line}: two blank lines in a row\n{}", said.out);
        for line in said.out.lines().filter(|l| !l.starts_with("fredholm ") && !l.trim_start().starts_with('"')) {
            assert!(line.chars().count() <= 100, "{line}");
        }
        said
    }
    /// Runs what must go well.
    fn ok(&self, line: &str) -> Said {
        let said = self.run(line);
        assert_eq!(said.code, 0, "{line}: {}{}", said.out, said.err);
        said
    }
    /// A small run into `dir`; 1 (a verdict inside the run) is as good as 0.
    fn small(&self, dir: &str, line: &str) -> Said {
        let said = self.run(&format!("{line} {SMALL} -q -o {dir}"));
        assert!(said.code <= 1, "{line}: {}{}", said.out, said.err);
        said
    }
    fn summary(&self, dir: &str) -> summary::Summary {
        summary::read(&self.path(dir).join("summary.json")).unwrap()
    }
    fn image(&self, dir: &str) -> exr::Image {
        exr::read(&self.path(dir).join("terms.exr")).unwrap()
    }
}

const SMALL: &str = "--size 16x16 --max-bounces 3 --patches 60";

/// Every file of a folder with its bytes.
fn contents(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(dir).unwrap().map(|f| f.unwrap());
    files.map(|f| (f.file_name().into_string().unwrap(), std::fs::read(f.path()).unwrap())).collect()
}

fn names(dir: &Path) -> Vec<String> {
    contents(dir).into_keys().collect()
}

/// The lines of a table whose first word is `head`.
fn row<'a>(text: &'a str, head: &str) -> Vec<&'a str> {
    text.lines().filter(|l| l.trim_start().starts_with(head)).collect()
}

#[test]
fn a_series_leaves_every_file_and_layer() {
    let desk = Desk::new();
    let said = desk.small("a", "series cornell --spp 32");
    let mut files: Vec<String> =
        "summary.json index.html terms.exr terms.png direct.png three.png path.png radiosity.png z.png \
         decay.png decay.svg variance.png variance.svg"
            .split_whitespace()
            .map(String::from)
            .collect();
    files.extend((0..4).flat_map(|k| [format!("T{k:02}.png"), format!("partial_{k:02}.png")]));
    files.sort();
    assert_eq!(names(&desk.path("a")), files);
    let s = desk.summary("a");
    let mut listed = s.files.clone();
    listed.sort();
    assert_eq!(listed, files, "summary.json lists what is there");
    assert!(said.out.contains(&format!("{} files after", files.len())), "{}", said.out);

    let image = desk.image("a");
    let mut layers = vec![String::new()];
    let stems = (0..4).flat_map(|k| [format!("T{k:02}"), format!("R{k:02}")]);
    for name in stems.chain(["tail", "Tsum", "Tall", "path", "Rsum", "Rfull"].map(String::from)) {
        layers.extend([name.clone(), format!("{name}_se")]);
    }
    layers.sort();
    assert_eq!(image.layers.iter().map(|l| l.0.clone()).collect::<Vec<_>>(), layers);
    assert_eq!((image.width, image.height), (16, 16));
    assert_eq!(image.layer(""), image.layer("path"), "viewers open the path tracer's image");
    let keys: Vec<&str> = image.attributes.iter().map(|a| a.0.as_str()).filter(|k| k.starts_with("fredholm")).collect();
    // how it was made, and of every layer of errors whether it can be trusted
    let own = ["command", "scene_hash", "seed", "spp", "version"].map(String::from).into_iter();
    let flags = layers.iter().filter(|l| l.ends_with("_se")).cloned();
    let mut expected: Vec<String> = own.chain(flags).map(|k| format!("fredholm.{k}")).collect();
    expected.sort();
    assert_eq!(keys, expected);
    let said = |layer: &str| image.attributes.iter().find(|a| a.0 == format!("fredholm.{layer}_se")).unwrap().1.clone();
    let record = summary::read(&desk.path("a/summary.json")).unwrap();
    assert!(
        record.pixel_errors.len() == layers.len() / 2 && record.pixel_errors.iter().all(|e| said(&e.layer) == e.why)
    );
    // Σ_{k≤K} + tail is the whole, pixel by pixel
    let layer = |name: &str| image.layer(name).unwrap();
    for i in 0..256 {
        let sum: f32 = (0..4).map(|k| layer(&format!("T{k:02}"))[i][0]).sum();
        assert!((sum - layer("Tsum")[i][0]).abs() <= 1e-5 * sum.abs(), "pixel {i}");
        let all = layer("Tall")[i][0];
        assert!((sum + layer("tail")[i][0] - all).abs() <= 1e-5 * all.abs(), "pixel {i}");
    }

    assert_eq!((s.scene.as_str(), s.seed, s.spp, s.max_bounces), ("cornell", 0, 32, 3));
    assert_eq!(s.terms.len(), 4);
    assert!(s.path.is_some() && s.radiosity.is_some());
    let worlds: Vec<World> = s.series.iter().map(|s| s.world).collect();
    assert_eq!(worlds, [World::Terms, World::Path, World::Radiosity, World::Radiosity]);
}

#[test]
fn the_discrete_world_is_offered_by_rays_too() {
    let desk = Desk::new();
    let both = desk.small("both", "radiosity cornell --spp 8 --factors both --rays 256 -v");
    assert!(both.out.contains("stored rays on the same patches: L − E differs by"), "{}", both.out);
    let rays = desk.small("rays", "radiosity cornell --spp 8 --factors rays --rays 256 -v");
    assert!(rays.out.contains("256 rays a row: relative L² error bar"), "{}", rays.out);
    desk.small("again", "radiosity cornell --spp 8 --factors rays --rays 256 -t 1 -v");
    assert_eq!(desk.image("rays").layer("Rfull"), desk.image("again").layer("Rfull"), "threads change no bit");
    let radius = |dir: &str| desk.summary(dir).radiosity.unwrap().spectral_radius;
    let (dense, sampled) = (radius("both"), radius("rays"));
    assert!((sampled / dense - 1.0).abs().max_element() < 0.02, "{dense} {sampled}");
    assert_ne!(dense, sampled);
    // the rays asked for together with the matrix are those asked for alone
    let line = |out: &str| out.lines().find(|l| l.contains("256 rays a row")).map(String::from);
    assert_eq!(line(&both.out), line(&rays.out));
    for bad in ["--rays 64", "--patches 30000 --factors dense", "--factors rays --rays 1"] {
        assert_eq!(desk.run(&format!("radiosity cornell {bad}")).code, 2, "{bad}");
    }
}

#[test]
fn threads_and_place_change_no_bit() {
    let desk = Desk::new();
    desk.small("one", "series cornell --spp 32 -t 1");
    desk.small("two", "series cornell --spp 32 -t 2 --json -v");
    desk.small("other", "series cornell --spp 32 --seed 1");
    let (one, two) = (contents(&desk.path("one")), contents(&desk.path("two")));
    // seconds and threads stand in these two
    for (name, bytes) in one.iter().filter(|(n, _)| !["summary.json", "index.html"].contains(&n.as_str())) {
        assert!(bytes == &two[name], "{name} differs between -t 1 and -t 2");
    }
    for name in ["Tall", "path", "Rfull"] {
        assert_ne!(desk.image("one").layer(name), desk.image("other").layer(name), "{name} of two seeds");
    }
}

#[test]
fn the_furnace_is_exact_and_json_is_alone_on_stdout() {
    let desk = Desk::new();
    let line = "series furnace --technique scatter --sampling cosine --spp 64 --json --size 16x16 --patches 60";
    let said = desk.run(line); // the exit code is that of the verdict against the matrix
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let terms = json["terms"].as_array().unwrap();
    assert_eq!(terms.len(), 9);
    for (k, term) in terms.iter().enumerate() {
        for c in 0..3 {
            let of = |key: &str| term[key][c].as_f64().unwrap();
            assert!((of("mean") / 0.5f64.powi(k as i32) - 1.0).abs() < 1e-6, "k = {k}: {}", of("mean"));
            assert_eq!((of("std_error"), of("variance")), (0.0, 0.0), "k = {k}");
        }
    }
    let file = std::fs::read_to_string(desk.path("fredholm-out/furnace/summary.json")).unwrap();
    assert_eq!(said.out, file, "stdout is the file");
    assert_eq!(said.code, 0, "{}", json["verdicts"]);
}

#[test]
fn two_seeds_agree_and_another_albedo_differs() {
    let desk = Desk::new();
    let series = "series furnace --worlds terms,path --spp 1024";
    desk.small("a", &format!("{series} --seed 1"));
    desk.small("b", &format!("{series} --seed 2"));
    desk.small("c", &format!("{series} --seed 2 --set materials.wall.reflectance=[0.55,0.5,0.5]"));
    let said = desk.run("compare a b --of-term 0.1");
    assert_eq!(said.code, 0, "{}", said.out);
    assert!(said.out.contains("Agrees: every difference is proved smaller than δ"), "{}", said.out);
    let said = desk.run("compare a/summary.json c -o verdict");
    assert_eq!(said.code, 1, "{}", said.out);
    assert!(said.out.contains("Differs: at least one of"), "{}", said.out);
    assert!(row(&said.out, "T1 (").concat().ends_with("✗ differs"), "{}", said.out);
    assert!(row(&said.out, "T0 (").concat().ends_with("✓ agrees"), "{}", said.out);
    assert_eq!(names(&desk.path("verdict")), ["summary.json", "z.png"]);
    // a comparison is no result
    let said = desk.run("compare a verdict");
    assert_eq!(said.code, 3);
    assert!(said.err.contains("holds no world"), "{}", said.err);
}

#[test]
fn results_of_different_kinds_are_compared_in_what_they_share() {
    let desk = Desk::new();
    desk.small("terms", "series cornell --worlds terms --spp 32");
    desk.small("path", "render cornell --spp 32 --seed 1");
    desk.small("matrix", "radiosity cornell --spp 32");
    let lines = |said: &Said| said.out.lines().filter(|l| l.contains(" (")).count();
    let said = desk.run("compare path terms");
    assert!(said.out.contains("path tracer, mis, roulette lecture"), "{}", said.out);
    assert_eq!(row(&said.out, "total (").len(), 1, "{}", said.out);
    assert!(row(&said.out, "T0 (").is_empty() && lines(&said) > 0, "the path tracer has no terms\n{}", said.out);

    // the interval against a matrix is widened by |R_h − R_2h|
    let said = desk.run("compare terms matrix --json -o x");
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let rows = json["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|r| r["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["T0", "T1", "T2", "T3", "tail", "sum", "total"]);
    let s = desk.summary("matrix");
    let (fine, coarse) = (s.series[0].image(), s.series[1].image());
    let allowance = |k: usize| (fine.terms[k].mean - coarse.terms[k].mean).abs().min_element();
    for k in [2, 3] {
        let of = |i: usize| rows[k]["interval"][i].as_f64().unwrap();
        assert!(allowance(k) > 0.0, "the mesh matters from k = 2 on");
        assert!(of(1) - of(0) > 2.0 * allowance(k), "k = {k}");
    }
}

#[test]
fn sizes_must_match() {
    let desk = Desk::new();
    desk.ok("render cornell --spp 4 --size 8x8 -q -o a");
    desk.ok("render cornell --spp 4 --size 8x9 -q -o b");
    let said = desk.run("compare a b");
    assert_eq!(said.code, 3);
    insta::assert_snapshot!(said.err, @r"
    error: the images have different sizes, 8×8 and 8×9
    help: render both with the same --size
    ");
    assert!(!desk.path("fredholm-out").exists(), "nothing was written");
}

#[test]
fn another_runs_output_is_never_touched() {
    let desk = Desk::new();
    let line = |spp: u32| format!("series cornell --worlds terms --spp {spp} --size 8x8 -q");
    let out = desk.path("fredholm-out");
    let folders = || {
        let mut all: Vec<_> = std::fs::read_dir(&out).unwrap().map(|f| f.unwrap().file_name()).collect();
        all.sort();
        all
    };
    desk.ok(&line(4));
    let first = contents(&out.join("cornell"));
    // the same command, also when typed with what does not matter, replaces its own
    desk.ok(&format!("{} -vt 1 --json", line(4)));
    assert_eq!(folders(), ["cornell"]);
    assert_eq!(contents(&out.join("cornell"))["terms.exr"], first["terms.exr"]);
    // another command goes next to it, and finds its own place again
    let first = contents(&out.join("cornell"));
    for _ in 0..2 {
        desk.ok(&line(5));
        assert_eq!(folders(), ["cornell", "cornell-2"]);
        assert!(contents(&out.join("cornell")) == first, "nothing in the first folder changed");
    }
    // -o with another run's content is refused
    let said = desk.run(&format!("{} -o fredholm-out/cornell", line(6)));
    assert_eq!(said.code, 3);
    insta::assert_snapshot!(said.err, @r"
    error: the output folder holds something else
      --> fredholm-out/cornell
    help: choose another with -o, or replace it with --force
    ");
    assert!(contents(&out.join("cornell")) == first, "nothing in the refused folder changed");
    // --force replaces it, and leaves nothing of the old run and everything of anybody else's
    std::fs::write(out.join("cornell/notes.txt"), "mine").unwrap();
    desk.ok("render cornell --spp 4 --size 8x8 -q -o fredholm-out/cornell --force");
    let mut now = desk.summary("fredholm-out/cornell").files;
    assert!(!now.contains(&"T00.png".into()));
    now.push("notes.txt".into());
    now.sort();
    assert_eq!(names(&out.join("cornell")), now);
}

#[test]
fn commands_end_as_they_say() {
    let desk = Desk::new();
    let said = desk.ok("info");
    insta::assert_snapshot!(said.out, @r#"
    cornell         a Cornell box of quads and two blocks, colours bleeding
    furnace         a closed box where every surface glows and reflects half: T^k E = 0.5^k everywhere
    sphere          an integrating sphere lit by its own cap: every term from k = 1 on is constant
    shells          two concentric spheres: pointwise exact terms of a 2 by 2 operator, with occlusion
    cornell-spheres a Cornell box with a mirror and a glass sphere: caustics from k = 2 and k = 3 on
    veach-mis       glossy plates under lamps of equal power and unequal size: combined techniques
    veach-ajar      a room lit only through a door ajar: a long series, the lamp out of sight
    env-ggx         gold, copper and plastic under a sky and a point light: GGX at four widths
    caustic         a glass sphere focuses a small lamp: easy from the light, hard from the eye
    glass-furnace   a glass ball in a sky of radiance 1: every pixel sums to 1, terms known
    mirror-corridor two parallel mirrors of 0.9: T^k E decays slowly
    sky-bowl        part of a sphere open to a sky of radiance 1: every term is constant
    many-lights     96 lamps from 0.01 to 10 W: choosing lights by power or uniformly
    cube            a closed cube under a glowing ceiling: means of L and r(T) known without patches
    "#);
    let said = desk.ok("info furnace");
    insta::assert_snapshot!(said.out, @r#"
    furnace: 1 shape, 6 primitives, 64×64 pixels

    materials
      wall             diffuse, reflectance (0.500, 0.500, 0.500), front only

    lights
      shapes[0]        box, radiance (1.0000, 1.0000, 1.0000)
                       area 24.0000 m², power (75.3982, 75.3982, 75.3982) W

    operator
      surfaces that reflect or emit: 24.0000 m²
      ‖T‖ ≤ max albedo = (0.5000, 0.5000, 0.5000), in every Lp norm of the throughput measure
      guaranteed: ‖L − S_K‖₁ ≤ 0.5000^(K+1)/0.5000 · ‖E‖₁; below 1 % of ‖E‖₁ from K = 7

    expected image means, k = 0 to 8
      1.0000, 0.50000, 0.25000, 0.12500, 0.062500, 0.031250, 0.015625, 0.0078125, 0.0039062
      source: T 1 = rho 1 in a closed scene of uniform albedo, so T^k E = rho^k E
    "#);
    let said = desk.ok("info cornell --json");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&said.out).unwrap()["name"], "cornell");
    let furnace = fredholm::scene::builtin::find("furnace").unwrap().source;
    std::fs::write(desk.path("bad.toml"), format!("bogus = 1\n{furnace}")).unwrap();
    for line in ["info bad.toml", "series bad.toml", "render bad.toml"] {
        let said = desk.run(line);
        assert_eq!((said.code, said.out.as_str()), (3, ""), "{line}");
        assert!(said.err.starts_with("error: ") && said.err.contains("--> bad.toml:1"), "{}", said.err);
    }
    let said = desk.ok("render cornell --spp 8 --size 8x8 -q");
    assert!(said.out.contains("roulette: path tracer lecture (q ends a path"), "{}", said.out);
    assert!(row(&said.out, "all").len() == 1 && row(&said.out, "Σ").is_empty(), "{}", said.out);
    let said = desk.ok("radiosity cornell --spp 8 --size 8x8 --patches 60 -q -v");
    assert!(said.out.contains("spectral radius (0."), "{}", said.out);
    assert!(!said.out.contains("roulette"), "no walk, no roulette: {}", said.out);
    let said = desk.ok("chapter");
    assert!(said.out.starts_with(" 1  "), "{}", said.out);
    assert_eq!(desk.run("chapter 99").code, 2);
}

#[test]
fn worlds_can_be_chosen() {
    let desk = Desk::new();
    for (world, layer, others) in [("terms", "Tall", ["path", "Rfull"]), ("path", "path", ["Tall", "Rfull"])] {
        desk.small(world, &format!("series cornell --worlds {world} --spp 8"));
        let image = desk.image(world);
        assert_eq!(image.layer(""), image.layer(layer));
        assert!(others.iter().all(|o| image.layer(o).is_none()), "{world}");
        assert!(desk.summary(world).verdicts.is_empty());
    }
    desk.small("radiosity", "series cornell --worlds radiosity --spp 8");
    let image = desk.image("radiosity");
    assert_eq!(image.layer(""), image.layer("Rfull"));
    assert!(image.layer("Tall").is_none() && image.layer("path").is_none());
    let s = desk.summary("path");
    assert!(s.terms.is_empty() && s.tail.is_none() && s.sum.is_none() && s.path.is_some());
}

#[test]
fn one_sample_has_no_known_error() {
    let desk = Desk::new();
    let said = desk.small("a", "series cornell --spp 1");
    desk.small("b", "series cornell --spp 1 --seed 1");
    assert_eq!(said.code, 0, "nothing can be rejected");
    assert!(!said.out.contains("NaN") && !said.out.contains("inf"), "{}", said.out);
    for k in ["0 ", "1 ", "k > 3", "all"] {
        let line = row(&said.out, k).concat();
        assert!(line.contains('–'), "{line}");
    }
    let s = desk.summary("a");
    assert!(s.terms.iter().all(|t| t.std_error.is_nan() && t.mean.is_finite()));
    let said = desk.run("compare a b");
    assert_eq!(said.code, 1);
    assert!(!said.out.contains("NaN"), "{}", said.out);
    let reason = "Inconclusive: the standard error is unknown: one replicate only (raise the samples per pixel).";
    assert!(said.out.contains(reason), "{}", said.out);
    assert!(said.out.contains("z map: no pixel has a known error"), "{}", said.out);
}

#[test]
fn emission_alone() {
    let desk = Desk::new();
    let said = desk.run("series furnace --max-bounces 0 --size 16x16 --patches 60 --spp 64 -q -o a");
    assert!(said.code <= 1, "{}", said.err);
    let s = desk.summary("a");
    assert_eq!((s.max_bounces, s.terms.len()), (0, 1));
    // in the furnace of ρ = 1/2 everything longer is as much as emission
    let matrix = s.series.iter().find(|s| s.world == World::Radiosity).unwrap().image();
    for tail in [s.tail, matrix.tail] {
        let off = (tail.mean - 1.0).abs() / tail.std_error.max(glam::DVec3::splat(1e-7));
        assert!(off.max_element() < 6.0, "{tail:?}");
    }
    assert!(!desk.path("a/partial_01.png").exists() && desk.path("a/partial_00.png").exists());
}

#[test]
fn a_tail_that_is_not_estimated_is_not_zero() {
    let desk = Desk::new();
    let said = desk.small("none", "series furnace --roulette none --spp 64");
    assert_eq!(said.code, 0, "a missing tail differs from nothing: {}", said.out);
    let tails: Vec<_> = row(&said.out, "k > 3").iter().map(|r| r.split_whitespace().nth(3).unwrap()).collect();
    assert_eq!(tails, ["–", "0.1250"], "of the terms and of the matrix\n{}", said.out);
    assert!(said.out.contains("prefix, mis, k ≤ 3 only"), "{}", said.out);
    let s = desk.summary("none");
    assert!(s.tail.is_none() && !s.sum.is_none(), "{:?}", s.tail);
    assert!(s.verdicts.iter().all(|v| !v.name.starts_with("tail")));
    assert!(s.verdicts.iter().all(|v| v.name != "total: terms − radiosity"), "{:?}", s.verdicts);
    assert!(s.verdicts.iter().any(|v| v.name == "total: terms − path"), "both are cut at K");
    let image = desk.image("none");
    assert!(image.layer("tail").is_none() && image.layer("Tall").is_none() && image.layer("Tsum").is_some());
    // one cut, one whole: nothing to compare but the terms
    desk.small("whole", "series furnace --spp 64 --seed 1");
    let said = desk.run("compare none whole");
    assert!(row(&said.out, "total (").is_empty() && row(&said.out, "sum (").len() == 1, "{}", said.out);
}

#[test]
fn a_second_ctrl_c_is_not_needed() {
    let desk = Desk::new();
    let line = format!("series cornell --spp 100000 {SMALL} -o long");
    let mut child = desk.command(&line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    while !desk.path("long/terms.png").exists() {
        assert!(started.elapsed() < Duration::from_secs(20), "no preview");
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let (out, err) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(err.contains("interrupted: saving what exists") && !err.contains("panicked"), "{err}");
    let s = desk.summary("long");
    assert!((16..100_000).contains(&s.spp), "{}", s.spp);
    assert!(out.contains(&format!("{} of 100000 spp", s.spp)), "{out}");
    let image = desk.image("long");
    for name in ["", "T00", "T03_se", "tail", "Tall_se"] {
        let finite = image.layer(name).unwrap().iter().flatten().all(|v| v.is_finite());
        assert!(finite, "{name}");
    }
    assert!(s.terms.iter().all(|t| t.mean.is_finite() && t.std_error.is_finite()));
    let mut listed = s.files;
    listed.sort();
    assert_eq!(names(&desk.path("long")), listed, "no temporary file is left");
}

#[test]
fn a_closed_pipe_is_no_crash() {
    let desk = Desk::new();
    let line = "series furnace --spp 4 --size 4x4 --json -q";
    let mut child = desk.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_ne!(output.status.code(), Some(101));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[test]
fn help_fits_the_screen_and_says_how_k_counts() {
    let desk = Desk::new();
    let picture = ["", "tour", "series", "render", "radiosity", "sweep", "compare", "info", "chapter", "figure"];
    let study = ["walk", "roulette", "zoo", "diagnose", "check", "check bias", "check equilibrium"];
    for command in picture.into_iter().chain(study) {
        for flag in ["-h", "--help"] {
            let said = desk.ok(&format!("{command} {flag}"));
            for line in said.out.lines() {
                assert!(line.chars().count() <= 100, "{command} {flag}: {line}");
            }
        }
    }
    let said = desk.ok("series --help");
    assert!(said.out.contains("k = 0 is emission seen directly"), "{}", said.out);
    assert!(said.out.contains("max_depth = K + 1") && said.out.contains("TERMINATION"), "{}", said.out);
    insta::assert_snapshot!(desk.ok("--help").out, @r#"
    The operator view of global illumination: L = E + T L = Σ T^k E, measured.

    With no arguments: the tour. A Cornell box is solved three ways (each bounce by its own estimator,
    the full path tracer, the radiosity matrix), compared with error bars, and written to
    fredholm-out/cornell with pictures, plots and a report.

    Usage: fredholm
           fredholm <COMMAND>

    Commands:
      tour       One scene solved three ways and compared: what happens with no arguments
      series     Each T^k E and the sum, beside the path tracer and the radiosity matrix
      render     The full path tracer alone
      radiosity  The matrix alone: form factors, terms, solve
      compare    Two results: verdict per term, z map
      diagnose   Somebody else's pictures: correct, or what is wrong with them
      sweep      The terms for every value of one setting: cost beside gain
      walk       The same estimators on the radiosity matrix, beside its powers
      check      Is an estimator biased? Does the equation hold?
      figure     Rebuilds a figure: data, pictures, and the command that makes them
      roulette   Roulette schedules: predicted without rendering, verified, optimised
      zoo        Estimators that are wrong on purpose, each beside the right one
      info       Scenes, materials, lights, bounds on the norm of T
      chapter    Runs a chapter of the book
      help       Print this message or the help of the given subcommand(s)

    Options:
      -h, --help     Print help
      -V, --version  Print version

    Examples:
      fredholm                                        the tour
      fredholm series cornell --spp 64                each bounce, and their sum
      fredholm series box.toml --set materials.white.reflectance=[0.6,0.6,0.6]
      fredholm compare fredholm-out/cornell other     verdict per term
      fredholm sweep cornell --over technique         one setting, several values: cost and gain
      fredholm roulette cornell --optimise            how paths should end, predicted and measured
      fredholm info                                   the built-in scenes
      fredholm info cornell                           materials, lights, bounds

    Options: `fredholm tour --help`, `fredholm series --help`, …

    Exit codes: 0 ok, 1 a comparison failed, 2 usage, 3 scene or file,
    130 interrupted (what exists is saved).
    "#);
}

/// What one side cannot see is named and not compared; what both see is.
#[test]
fn terms_that_one_side_does_not_see_are_not_compared() {
    let desk = Desk::new();
    desk.small("p", "series cornell-spheres --worlds terms");
    let said = desk.small("l", "series cornell-spheres --worlds terms --estimator light");
    let missing = "not supported by light, from k = 1 on: what the eye sees in mirrors or glass";
    assert!(said.err.contains(missing), "{}", said.err);
    let said = desk.run("compare p l -o c");
    assert_eq!(said.code, 1, "{}", said.out);
    assert!(said.out.contains("T1 and everything longer: not supported, light does not see"), "{}", said.out);
    let rows = desk.summary("c").verdicts;
    assert!(rows.iter().all(|v| v.name.contains("T0")) && rows.len() == 1, "{rows:?}");
    // a light that no ray hits is refused where rays must hit it
    let lamp = "[[lights]]\ntype = \"point\"\nposition = [0, 0.5, 0]\nintensity = [1, 1, 1]\n";
    let furnace = fredholm::scene::builtin::find("furnace").unwrap().source;
    let dark: Vec<&str> = furnace.lines().filter(|l| !l.starts_with("emission")).collect();
    std::fs::write(desk.path("point.toml"), format!("{}\n{lamp}", dark.join("\n"))).unwrap();
    let said = desk.run("series point.toml --technique scatter");
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("help: use --technique connect or mis"), "{}", said.err);
    assert_eq!(desk.run("render cornell --estimator light").code, 2);
}

#[test]
fn walks_on_the_matrix_are_held_against_its_powers() {
    let desk = Desk::new();
    let said = desk.ok("walk furnace --patches 24 --spp 64 -q -o walk");
    assert!(said.out.contains("power of the matrix") && said.out.contains("agrees"), "{}", said.out);
    let s = desk.summary("walk");
    assert_eq!((s.series.len(), s.series[1].world), (2, World::Radiosity));
    let said = desk.ok("walk furnace --patches 96 --estimator zero-variance --spp 16 -q -o led");
    assert!(said.out.contains("B itself") && desk.path("led/walk.png").exists(), "{}", said.out);
    assert_eq!(desk.summary("led").files, ["walk.csv", "walk.png", "walk.svg", "summary.json"]);
    // the same bits for any number of threads
    let csv = std::fs::read(desk.path("led/walk.csv")).unwrap();
    desk.ok("walk furnace --patches 96 --estimator zero-variance --spp 16 -q -o one -t 1");
    assert_eq!(std::fs::read(desk.path("one/walk.csv")).unwrap(), csv);
    let said = desk.run("walk cornell-spheres -q -o x");
    assert!(said.code == 2 && said.err.contains("help: "), "{}", said.err);
}
