//! What a run leaves: its files and layers, the worlds that were asked for, and numbers that are not known.

use super::*;

/// `--fast` is Sobol points in 8 replicates: the same terms with less noise at the same number of samples.
#[test]
fn fast_has_less_noise_and_says_what_it_chose() {
    let desk = Desk::new();
    let run = |name: &str, how: &str| {
        let said = desk.small(name, &format!("series cornell --worlds terms --pictures-only --spp 256 {how}"));
        (said, desk.summary(name), desk.image(name))
    };
    let (usual, fast) = (run("usual", ""), run("fast", "--fast"));
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words(&fast.0.out).contains("Sobol points, 8 replicates"), "{}", fast.0.out);
    assert_eq!([&usual.1, &fast.1].map(|s| s.series[0].functionals[0].terms[1].replicates), [16, 8]);
    // the variance of direct light, averaged over 256 pixels and 3 channels, with errors of about 6 % and 3 %
    let variance = |of: &exr::Image| {
        let se = of.layer("T01_se").unwrap();
        se.iter().flatten().map(|e| f64::from(*e).powi(2)).sum::<f64>()
    };
    let [a, b] = [&usual, &fast].map(|r| variance(&r.2));
    assert!(b < 0.7 * a, "variance {b} with --fast, {a} without");
    let refused = desk.run("series cornell --fast --points sobol");
    assert_eq!(refused.code, 2, "{}", refused.err);
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
    assert!(said.out.contains(&format!("{} files in", files.len())), "{}", said.out);

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
    assert!(both.out.contains("Stored rays on the same patches: L − E differs from the matrix by"), "{}", both.out);
    let rays = desk.small("rays", "radiosity cornell --spp 8 --factors rays --rays 256 -v");
    assert!(rays.out.contains("256 rays per patch: relative L² error"), "{}", rays.out);
    desk.small("again", "radiosity cornell --spp 8 --factors rays --rays 256 -t 1 -v");
    assert_eq!(desk.image("rays").layer("Rfull"), desk.image("again").layer("Rfull"), "threads change no bit");
    let radius = |dir: &str| desk.summary(dir).radiosity.unwrap().spectral_radius;
    let (dense, sampled) = (radius("both"), radius("rays"));
    assert!((sampled / dense - 1.0).abs().max_element() < 0.02, "{dense} {sampled}");
    assert_ne!(dense, sampled);
    // the rays asked for together with the matrix are those asked for alone
    let line = |out: &str| out.lines().find(|l| l.contains("256 rays per patch")).map(String::from);
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
    let file = std::fs::read_to_string(desk.path("fredholm-out/furnace-series/summary.json")).unwrap();
    assert_eq!(said.out, file, "stdout is the file");
    assert_eq!(said.code, 0, "{}", json["verdicts"]);
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
    let reason = "the samples form only one group";
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
    let said = desk.small("none", "series furnace --roulette none --spp 64 --verbose");
    assert_eq!(said.code, 0, "a missing tail differs from nothing: {}", said.out);
    let tails: Vec<_> = row(&said.out, "k > 3").iter().map(|r| r.split_whitespace().nth(3).unwrap()).collect();
    assert_eq!(tails, ["–", "–", "0.1250"], "in short, of the terms and of the matrix\n{}", said.out);
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
fn walks_on_the_matrix_are_held_against_its_powers() {
    let desk = Desk::new();
    let said = desk.ok("walk furnace --patches 24 --spp 64 -q -o walk");
    assert!(said.out.contains("the powers of the matrix") && said.out.contains("✓ agrees"), "{}", said.out);
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

/// The rows of a picture of one term without the strip of text below.
fn shown(path: &Path, [w, h]: [usize; 2]) -> Vec<[u8; 3]> {
    let picture = image::open(path).unwrap().to_rgb8();
    let factor = picture.width() as usize / w;
    let at = |i: usize| picture.get_pixel((i % w * factor) as u32, (i / w * factor) as u32).0;
    (0..w * h).map(at).collect()
}

/// With --exposure all terms have one gain, the given one or the one that suits a term; without it each has its own.
#[test]
fn terms_can_be_compared_at_one_exposure() {
    let desk = Desk::new();
    let line = "series cornell --worlds terms --spp 16";
    desk.small("own", line);
    let image = desk.image("own");
    let layer = |k: usize| image.layer(&format!("T{k:02}")).unwrap();
    let gains: Vec<f64> = (0..4).map(|k| auto_gain(layer(k))).collect();
    assert!(gains[3] >= 4.0 * gains[1], "the terms fall: {gains:?}");
    let as_with = |dir: &str, k: usize, gain: f64| {
        let picture = shown(&desk.path(dir).join(format!("T{k:02}.png")), [16, 16]);
        picture == develop(16, 16, layer(k), gain).picture.pixels
    };
    desk.small("two", &format!("{line} --exposure 2"));
    desk.small("direct", &format!("{line} --exposure T1"));
    for k in 0..4 {
        assert!(as_with("own", k, gains[k]), "T{k} at its own exposure");
        assert!(as_with("two", k, 2.0), "T{k} at the gain 2");
        assert!(as_with("direct", k, gains[1]), "T{k} at the gain of T1");
    }
    assert!(!as_with("two", 3, gains[3]) && !as_with("direct", 3, gains[3]), "the test sees the gain");
    let sheet = |dir: &str| std::fs::read(desk.path(dir).join("terms.png")).unwrap();
    assert!(sheet("own") != sheet("two") && sheet("two") != sheet("direct"), "the contact sheet follows");
    let page = |dir: &str| std::fs::read_to_string(desk.path(dir).join("index.html")).unwrap();
    assert!(page("own").contains("\"gain\":\"each\"") && page("two").contains("\"gain\":\"one\""));
    for (line, says) in [
        ("series cornell --exposure bright", "`bright` is not auto, a gain such as 2, or a term such as T1"),
        ("series cornell --exposure 0", "`0` is not auto"),
        ("series cornell --max-bounces 3 --exposure T4", "the terms end at K = 3"),
        ("series cornell --worlds path --exposure 2", "asks for no terms"),
        ("radiosity cornell --modes 2 --exposure 2", "--exposure is for pictures of terms"),
    ] {
        let said = desk.run(line);
        assert_eq!(said.code, 2, "{line}: {}", said.err);
        assert!(said.err.contains(says), "{line}: {}", said.err);
    }
}
