//! Sweeps over samples and splits: variance and squared error of one render, and samples shared among the terms.

use super::*;

/// Every number of samples is that of a render of its own, to the last bit; nothing is rendered twice.
#[test]
fn variance_falls_in_one_render() {
    let line =
        "cornell --over spp --estimator prefix,path --technique connect,mis --size 8x8 --max-bounces 2 --seed 4 -q";
    let s = swept(&format!("{line} --values 16,48,64"));
    assert_eq!(s.values(), ["prefix connect", "prefix mis", "path connect", "path mis"]);
    assert!(s.rows.iter().all(|r| ["16", "48", "64"].contains(&r["n"].as_str())));
    assert!(s.rows.iter().all(|r| !r["value"].starts_with("path") || r["k"] == "all"), "a path tracer has one value");
    for n in [16, 48] {
        let short = swept(&format!("{line} --spp {n} --values {n}"));
        for value in s.values() {
            assert_eq!(s.at(value, "all", n, "variance"), short.at(value, "all", n, "variance"), "{value}, {n}");
        }
        for k in ["0", "1", "2", "tail"] {
            assert_eq!(s.at("prefix mis", k, n, "rays"), short.at("prefix mis", k, n, "rays"));
            assert_eq!(s.at("prefix mis", k, n, "variance"), short.at("prefix mis", k, n, "variance"), "{k}, {n}");
        }
    }
    let (v, rays) = (s.at("prefix mis", "2", 64, "variance"), s.at("prefix mis", "2", 64, "rays_per_path"));
    assert!((s.at("prefix mis", "2", 64, "efficiency_per_ray") * 64.0 * v * rays - 1.0).abs() < 1e-9);
    // the slope is that of the line through the three points of the file, and of no other points
    let slope = |n: [u32; 3]| {
        let points = [16, 48, 64].into_iter().zip(n).map(|(of, n)| (n.into(), s.at("prefix mis", "1", of, "variance")));
        variance_slope(&points.collect::<Vec<(f64, f64)>>(), 15.0).unwrap().slope
    };
    let said = s.at("prefix mis", "1", 16, "slope");
    assert!((said - slope([16, 48, 64])).abs() < 1e-9 && s.at("prefix mis", "1", 16, "slope_std_error") > 0.0);
    assert!((said - slope([16, 48, 72])).abs() > 0.01 && (said - slope([20, 48, 64])).abs() > 0.01);
    let mut names: Vec<String> =
        std::fs::read_dir(&s.folder).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["summary.json", "sweep.csv", "variance.png", "variance.svg"]);
    let svg = std::fs::read_to_string(s.folder.join("variance.svg")).unwrap();
    for words in ["The sum of all terms", "prefix connect", "slope −1", "--over spp"] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(s.said.out.contains("slope ± se"), "{}", s.said.out);
}

/// MSE = ⟨(m − X)²⟩ − ⟨se_X²⟩ and V = ⟨se_m²⟩ over pixels and channels, with m the images of `same`, whose samples are those of the
/// sweep, and X the images of `other`: to the rounding of single precision. Without the subtraction it is not.
fn squared_errors_are_those_of_the_files(desk: &Path) {
    let image = |folder: &str| exr::read(&desk.join(folder).join("terms.exr")).unwrap();
    let (same, other) = (image("same"), image("other"));
    let text = std::fs::read_to_string(desk.join("swept/sweep.csv")).unwrap();
    let column = |name: &str| cells(text.lines().next().unwrap()).iter().position(|c| c == name).unwrap();
    let (mse, variance) = (column("mse"), column("variance"));
    for (k, layer) in [("0", "T00"), ("1", "T01"), ("2", "T02"), ("tail", "tail"), ("all", "Tall")] {
        let row = text.lines().map(cells).find(|c| c[1] == k && c[2] == "64").unwrap();
        let of = |image: &exr::Image, name: &str| -> Vec<f64> {
            image.layer(name).unwrap().iter().flatten().map(|x| f64::from(*x)).collect()
        };
        let mean = |f: &dyn Fn(usize) -> f64| (0..3 * 64).map(f).sum::<f64>() / (3.0 * 64.0);
        let errors = format!("{layer}_se");
        let (m, se_m, x, se_x) = (of(&same, layer), of(&same, &errors), of(&other, layer), of(&other, &errors));
        let off = mean(&|i| (m[i] - x[i]).powi(2));
        let noise = mean(&|i| se_x[i].powi(2));
        let said = |column: usize| row[column].parse::<f64>().unwrap();
        assert!((said(mse) - (off - noise)).abs() < 1e-5 * off, "{k}: {} for {}", said(mse), off - noise);
        assert!((said(variance) / mean(&|i| se_m[i].powi(2)) - 1.0).abs() < 1e-5, "{k}");
        assert!((said(mse) - off).abs() > 0.1 * off, "{k}: what is subtracted must be seen");
    }
}

#[test]
fn squared_errors_need_a_reference_of_its_own_stream() {
    let line = "--size 8x8 --max-bounces 2 --spp 64 -q";
    let s = swept(&format!("cornell --over spp {line} --reference 256"));
    assert!(s.said.out.contains("its variance is subtracted") && s.said.out.contains("RMSE"), "{}", s.said.out);

    let desk = TempDir::new().unwrap();
    for (seed, out) in [(0, "same"), (9, "other")] {
        let line = format!("series cornell --worlds terms {line} --seed {seed} -o {out}");
        assert_eq!(run(desk.path(), &line).code, 0);
    }
    let against = |folder: &str, more: &str| {
        run(desk.path(), &format!("sweep cornell --over spp {line} --reference {folder} {more} -o swept --force"))
    };
    assert_eq!(against("other", "").code, 0);
    squared_errors_are_those_of_the_files(desk.path());
    for (folder, more, says) in [
        ("same", "", "the reference has seed 0, too"),
        ("other", "--max-bounces 3", "this run k ≤ 3"),
        ("other", "--size 4x4", "render both with the same scene and --size"),
        ("nowhere", "", "nowhere"),
    ] {
        let line = line.replace("--max-bounces 2", if more.contains("bounces") { more } else { "--max-bounces 2" });
        let line = line.replace("--size 8x8", if more.contains("size") { more } else { "--size 8x8" });
        let said = run(desk.path(), &format!("sweep cornell --over spp {line} --reference {folder}"));
        assert_eq!(said.code, 3, "{folder} {more}: {}", said.err);
        assert!(said.err.contains(says), "{}", said.err);
    }
}

#[test]
fn a_split_is_predicted_and_measured() {
    let desk = TempDir::new().unwrap();
    let line = "sweep cornell --over split --size 8x8 --max-bounces 2 --spp 64 -q -o s --verbose";
    let said = run(desk.path(), line);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.starts_with("Among the ways to spend rays, `optimal`"), "{}", said.out);
    for words in ["equal", "optimal", "prefix", "least of any split", "1ᵀC1"] {
        assert!(said.out.contains(words), "{words}\n{}", said.out);
    }
    for file in ["split.csv", "covariance.csv", "covariance.png", "covariance.svg", "summary.json"] {
        assert!(std::fs::metadata(desk.path().join("s").join(file)).unwrap().len() > 100, "{file}");
    }
    let csv = std::fs::read_to_string(desk.path().join("s/split.csv")).unwrap();
    let columns = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().all(|l| l.split(',').count() == columns), "{csv}");
    let number = |way: &str, k: &str, column: usize| -> f64 {
        let row = csv.lines().map(|l| l.split(',').collect::<Vec<_>>()).find(|c| c[0] == way && c[1] == k);
        row.unwrap()[column].parse().unwrap()
    };
    let (n, variance, rays) = (2, 3, 5);
    // what is spent is Σ n_k c_k
    let ks = ["0", "1", "2", "3"];
    let sum = |way: &str, f: &dyn Fn(&str) -> f64| ks.iter().map(|k| f(k) * number(way, k, rays)).sum::<f64>();
    for way in ["equal", "optimal"] {
        let spent = sum(way, &|k| number(way, k, n));
        assert!((number(way, "all", rays) / spent - 1.0).abs() < 1e-9, "{way}: {csv}");
    }
    // n_k is the multiple of 16 nearest to B σ_k/√c_k / Σ σ√c of the pilot, at least 16, with B what 64 samples of every term cost
    let budget = sum("pilot", &|_| 64.0);
    let of = |k: &str| (number("pilot", k, variance), number("pilot", k, rays));
    let root: f64 = ks.iter().map(|k| (of(k).0 * of(k).1).sqrt()).sum();
    let off = |k: &str, b: f64| number("optimal", k, n) - b * (of(k).0 / of(k).1).sqrt() / root;
    let nearest = |k: &str, b: f64| off(k, b).abs() <= 8.0 || (off(k, b) > 0.0 && number("optimal", k, n) == 16.0);
    assert!(ks.iter().all(|k| number("equal", k, n) == 64.0 && nearest(k, budget)), "{csv}");
    assert!(!ks.iter().all(|k| nearest(k, 1.05 * budget)), "5 % more rays are another split\n{csv}");
    // of whole paths so many as the budget pays for, by the rays of a path that the pilot found
    let settings =
        Settings { spp: 64, max_bounces: 2, roulette: Roulette::Albedo { from: 2 }.after(2), ..Settings::default() };
    let options = Options { set: vec!["camera.size=[8,8]".into()], ..Options::default() };
    let scene = Scene::new(&load::scene("cornell", &options).unwrap().description);
    let pilot = split::study(&scene, &settings, 16, Progress::NONE).unwrap();
    assert!(ks.iter().zip(&pilot.pilot).all(|(k, t)| of(k) == (t.variance, t.rays)), "the same pilot");
    let paths = number("prefix", "0", n);
    assert!((paths - budget / pilot.pilot_reuse.rays).abs() <= 8.0, "{paths} paths, {:?}", pilot.pilot_reuse.rays);
}
