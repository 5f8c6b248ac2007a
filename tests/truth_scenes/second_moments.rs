//! Second moments in closed form: the variance of roulette, and the covariance of the terms of one path.

use super::*;

/// Mean of (a − μ_a)(b − μ_b), which is the covariance since the means are exact.
fn covariance(a: impl ExactSizeIterator<Item = (f64, f64)>, means: (f64, f64)) -> Estimate {
    mean_of(a.map(|(x, y)| DVec3::splat((x - means.0) * (y - means.1))))
}

/// A sphere as equal to the algebra as one gets: two bands.
fn two_bands(f: f64, rho: [f64; 2], e: [f64; 2]) -> Scene {
    Scene::new(&description(&bands(1.0, &[1.0, 1.0 - 2.0 * f, -1.0], &rho, &e)))
}

#[test]
fn roulette_in_a_furnace_has_its_variance() {
    let mut jury = Jury::open("roulette_in_a_furnace_has_its_variance");
    let n = 1 << 18;
    for id in [
        "rr_furnace_rho0.5_q0.5",
        "rr_furnace_rho0.5_q0.1",
        "rr_furnace_rho0.8_q0.1",
        "rr_furnace_rho0.7_q0.2",
        "rr_furnace_rho0.95_q0.02",
    ] {
        let case = case("variance", id);
        let (rho, q, mean) = (case.number("rho"), case.number("q"), case.number("mean"));
        assert!(rho.powi(4) < (1.0 - q).powi(3), "the variance of this case cannot be measured");
        let cube = room(DVec3::splat(-1.0), DVec3::ONE, 0.0);
        let scene = Scene::new(&description(&[(cube, DVec3::splat(rho), DVec3::ONE)]));
        let starts = Starts(vec![Start::On(0)]);
        let n = if q < 0.05 { n / 8 } else { n };
        let tracer = PathTracer(plan(0, Technique::Scatter, &Roulette::Constant { from: 0, q }));
        let x = collect(&SceneTransport::new(&scene), &starts, &tracer, n, 1024, Key::new(jury.seed(), id));

        let mut judge = |what: &str, e: Estimate, truth: f64| {
            let truth = DVec3::splat(truth);
            let judged = jury.judge(&format!("{id}, {what}"), &e, truth, 0.05 * truth, 0.4 * truth);
            assert_ne!(judged, Judged::TooNoisy, "{id}, {what}: {e:?}, truth {truth}");
        };
        judge("mean", mean_of(x.values.iter().copied()), mean);
        judge("variance", mean_of(x.values.iter().map(|x| (*x - mean).powf(2.0))), case.number("var_collision"));
        judge("second moment", mean_of(x.values.iter().map(|x| x.powf(2.0))), case.number("second_moment_collision"));
        // the number of vertices is geometric: its variance (1 − q)/q² is known
        let vertices = x.rays[0] as f64 / f64::from(n);
        let std_error = DVec3::splat(((1.0 - q) / (q * q) / f64::from(n)).sqrt());
        judge(
            "vertices",
            Estimate { mean: DVec3::splat(vertices), std_error, replicates: 0, events: None },
            case.number("mean_vertices"),
        );
    }
    jury.assert_power(0.6, 0.0);
}

/// The constant q that wins on a sphere whose emission varies: the variance there and at the analog q = 1 − ρ.
#[test]
fn roulette_on_a_sphere_has_its_variance() {
    let mut jury = Jury::open("roulette_on_a_sphere_has_its_variance");
    // a share f of the sphere emits e₀, the rest e₁: mean 1, standard deviation σ
    for (id, f, e) in [
        ("rr_optimal_q_rho0.5_sigma1", 0.5, [2.0, 0.0]),
        ("rr_optimal_q_rho0.8_sigma3", 0.1, [10.0, 0.0]),
        ("rr_optimal_q_rho0.3_sigma0.5", 0.5, [1.5, 0.5]),
    ] {
        let case = case("variance", id);
        let rho = case.number("rho");
        let sigma = (f * (e[0] - 1.0f64).powi(2) + (1.0 - f) * (e[1] - 1.0f64).powi(2)).sqrt();
        assert!((sigma - case.number("sigma")).abs() < 1e-12);
        let scene = two_bands(f, [rho; 2], e);
        for (q, key) in [(case.number("q_star"), "var_at_q_star"), (1.0 - rho, "var_at_analog")] {
            assert!(rho.powi(4) < (1.0 - q).powi(3), "the variance of this case cannot be measured");
            let tracer = PathTracer(plan(0, Technique::Scatter, &Roulette::Constant { from: 0, q }));
            let t = SceneTransport::new(&scene);
            let stream = Key::new(jury.seed(), &format!("{id} {key}"));
            let x = collect(&t, &Starts(vec![Start::On(2)]), &tracer, 1 << 18, 1024, stream);
            // the start counts with the mean emission, as in the closed form
            let mean = rho / (1.0 - rho) + e[1];
            let measured = mean_of(x.values.iter().map(|x| (*x - mean).powf(2.0)));
            let truth = DVec3::splat(case.number(key));
            let judged = jury.judge(&format!("{id}, {key}"), &measured, truth, 0.05 * truth, 0.4 * truth);
            assert_ne!(judged, Judged::TooNoisy, "{id}, {key}: {measured:?}, truth {truth}");
        }
    }
}

#[test]
fn terms_of_one_path_have_their_covariance() {
    let mut jury = Jury::open("terms_of_one_path_have_their_covariance");
    for id in ["estimator_covariance_a", "estimator_covariance_c"] {
        let case = case("variance", id);
        let (rho, e, f) = (case.list("rho"), case.list("E"), case.list("f"));
        assert_eq!(case.number("r0"), rho[0], "paths start on the first band");
        let scene = two_bands(f[0], [rho[0], rho[1]], [e[0], e[1]]);
        let (t, start) = (SceneTransport::new(&scene), Starts(vec![Start::On(0)]));
        let (mean, cov) = (case.list("mean"), case.table("cov"));
        let last = case.number("K") as usize;
        let plan = plan(last, Technique::Scatter, &Roulette::Never);
        let n = 1u32 << 18;
        let reuse = collect(&t, &start, &Prefix(plan.clone()), n, 1024, Key::new(jury.seed(), id));
        let separate = collect(&t, &start, &SingleTerm(plan), n / 4, 1024, Key::new(jury.seed(), id));
        for (name, x, shared) in [("prefix", &reuse, true), ("single", &separate, false)] {
            for (a, b) in (1..=last).flat_map(|a| (a..=last).map(move |b| (a, b))) {
                let pairs: Vec<(f64, f64)> = x.paths().map(|p| (p[a].x, p[b].x)).collect();
                let measured = covariance(pairs.into_iter(), (mean[a - 1], mean[b - 1]));
                let truth = if shared || a == b { cov[a - 1][b - 1] } else { 0.0 };
                let scale = DVec3::splat((cov[a - 1][a - 1] * cov[b - 1][b - 1]).sqrt());
                let what = format!("{id}, {name}, Cov(X{a}, X{b})");
                let judged = jury.judge(&what, &measured, DVec3::splat(truth), 0.03 * scale, 0.3 * scale);
                assert_ne!(judged, Judged::TooNoisy, "{what}: {measured:?}");
            }
        }
        // and their price: a path shared, or one for every k, besides the ray that starts each
        let rays = |x: &common::sampling::Collected, n: u32, starts: f64| {
            x.rays.iter().sum::<u64>() as f64 / f64::from(n) - starts
        };
        assert_eq!(rays(&reuse, n, 1.0), case.number("rays_reuse"));
        assert_eq!(rays(&separate, n / 4, last as f64 + 1.0), case.number("rays_separate"));
    }
    jury.assert_power(0.2, 0.0);
}

#[test]
fn roulette_and_uniform_directions_have_their_variance_term_by_term() {
    let mut jury = Jury::open("roulette_and_uniform_directions_have_their_variance_term_by_term");
    let case_of = |id: &str| case("variance", id);
    let furnace = |rho: f64| {
        let cube = room(DVec3::splat(-1.0), DVec3::ONE, 0.0);
        Scene::new(&description(&[(cube, DVec3::splat(rho), DVec3::ONE)]))
    };
    let start = Starts(vec![Start::On(0)]);
    let n = 1 << 18;

    let case = case_of("estimator_furnace_zero_variance");
    let (rho, p, last) = (case.number("rho"), case.number("p"), case.number("K") as usize);
    let scene = furnace(rho);
    let estimator = Prefix(plan(last, Technique::Scatter, &Roulette::Constant { from: 0, q: 1.0 - p }));
    let x = collect(&SceneTransport::new(&scene), &start, &estimator, n, 1024, Key::new(jury.seed(), "roulette"));
    let cov = case.table("cov");
    for (a, b) in (1..=last).flat_map(|a| (a..=last).map(move |b| (a, b))) {
        let pairs: Vec<(f64, f64)> = x.paths().map(|p| (p[a].x, p[b].x)).collect();
        let measured = covariance(pairs.into_iter(), (rho.powi(a as i32), rho.powi(b as i32)));
        let truth = DVec3::splat(cov[a - 1][b - 1]);
        let judged = jury.judge(&format!("Cov(X{a}, X{b}) with roulette"), &measured, truth, 0.05 * truth, 0.2 * truth);
        assert_ne!(judged, Judged::TooNoisy, "{a} {b} {measured:?} {truth}");
    }

    let case = case_of("uniform_hemisphere_var_rho0.8");
    let rho = case.number("rho");
    let scene = furnace(rho);
    let t = SceneTransport { scene: &scene, sampling: Sampling::Uniform };
    let estimator = Prefix(plan(6, Technique::Scatter, &Roulette::Never));
    let x = collect(&t, &start, &estimator, n, 1024, Key::new(jury.seed(), "uniform"));
    for (k, &variance) in (1..).zip(&case.list("var")) {
        let of = |p: &[DVec3]| p[k].x;
        let values: Vec<f64> = x.paths().map(of).collect();
        let mean = rho.powi(k as i32);
        let measured = covariance(values.iter().map(|x| (*x, *x)), (mean, mean));
        let truth = DVec3::splat(variance);
        let judged = jury.judge(&format!("Var X{k}, uniform"), &measured, truth, 0.05 * truth, 0.5 * truth);
        assert_ne!(judged, Judged::TooNoisy, "{k} {measured:?} {truth}");
        let (e, truth) = (mean_of(values.iter().map(|x| DVec3::splat(*x))), DVec3::splat(mean));
        let judged = jury.judge(&format!("X{k}, uniform"), &e, truth, 0.02 * truth, 0.2 * truth);
        assert_ne!(judged, Judged::TooNoisy, "{k} {e:?} {truth}");
    }
    jury.assert_power(0.3, 0.0);
}
