//! The spectrum of T: against closed forms and dense algebra, and the laws of the decay.
#![allow(clippy::unwrap_used)]

mod discrete;
use discrete::*;
use fredholm::operator::edges::{KAPPA, essential_band};
use fredholm::operator::form_factor::FormFactors;
use fredholm::operator::matrix::*;
use fredholm::operator::modes::{Modes, norm_2, radius_bounds};
use fredholm::solver::{Neumann, Radiosity};
use glam::DVec3;
use serde_json::Value;

/// Entries of F are in single precision.
const SINGLE: f64 = 4e-7;

fn truth_case(id: &str) -> Value {
    let all: Value = serde_json::from_str(include_str!("truth/spectrum.json")).unwrap();
    all.as_array().unwrap().iter().find(|c| c["id"] == id).unwrap().clone()
}

fn list(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn close(what: &str, got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "{what}: {got} instead of {expected}, off by {:e}", got - expected);
}

fn cube(m: usize, rho: [f64; 6], e: [f64; 6]) -> Radiosity {
    let (patches, factors) = discretise(&room(DVec3::ONE, rho, e), 6 * m * m);
    assert_eq!(patches.len(), 6 * m * m, "a mesh of {m} × {m} per face");
    Radiosity::new(patches, factors)
}

/// The second eigenvalue of a closed cube keeps rising with the mesh, far beyond the band of its edges: no number to report.
#[test]
fn the_second_eigenvalue_of_a_cube_drifts() {
    let expected = &truth_case("cube_second_eigenvalue_drift")["expected"];
    close("κ", KAPPA, expected["edge_symbol_L2"].as_f64().unwrap(), 1e-15);
    let mut before = -1.0;
    let meshes = list(&expected["m"]).into_iter().zip(expected["eig"].as_array().unwrap());
    // the mesher halves faces: powers of two are the meshes of the case
    for (m, row) in meshes.filter(|(m, _)| [1.0, 2.0, 4.0, 8.0].contains(m)) {
        let r = cube(m as usize, [1.0; 6], [1.0; 6]);
        let mut values = Modes::of(&r.operator(0), 0).values;
        values.sort_by(|a, b| b.total_cmp(a));
        let row = list(row);
        close("first", values[0], row[0], SINGLE);
        close("second", values[1], row[1], SINGLE);
        close("smallest", values[values.len() - 1], row[2], SINGLE);
        assert!(values[1] > before, "m = {m}");
        before = values[1];
    }
    assert!(before > KAPPA + 0.05);
}

/// ‖T^k E‖_w has ratios that never fall and never exceed r(T).
#[test]
fn weighted_ratios_rise_to_the_spectral_radius() {
    let case = &truth()["cube6_cornell_theory"];
    let array = |key: &str| list(&case["inputs"][key]).try_into().unwrap();
    let r = cube(1, array("rho"), array("E"));
    let t = r.operator(0);
    let norms: Vec<f64> = Neumann::new(&t, r.emission(0)).take(12).map(|x| t.weighted_norm(&x)).collect();
    for (k, (got, expected)) in norms.iter().zip(list(&case["expected"]["weighted_norms"])).enumerate() {
        close(&format!("‖T^{k} E‖_w"), *got, expected, SINGLE);
    }
    let radius = case["expected"]["spectral_radius"].as_f64().unwrap();
    close("r(T)", Modes::of(&t, 1).values[0], radius, SINGLE);
    close("‖T‖∞", t.norm_inf(), case["expected"]["Linf_norm_T"].as_f64().unwrap(), SINGLE);
    let (patches, factors) = discretise(&cornell(), 300);
    for r in [r, Radiosity::new(patches, factors)] {
        let t = r.operator(0);
        let [low, high] = radius_bounds(&t, 60);
        let norms: Vec<f64> = Neumann::new(&t, r.emission(0)).skip(1).take(25).map(|x| t.weighted_norm(&x)).collect();
        let ratios: Vec<f64> = norms.windows(2).map(|w| w[1] / w[0]).collect();
        assert!(ratios.windows(2).all(|w| w[1] >= w[0] - SINGLE), "{ratios:?}");
        assert!(ratios.iter().all(|g| *g <= high + SINGLE), "{ratios:?} and {high}");
        assert!(low - ratios[ratios.len() - 1] < 1e-3 * low, "and reach it: {ratios:?}");
    }
}

#[test]
fn modes_are_eigenvectors_and_each_dies_at_its_rate() {
    let (patches, factors) = discretise(&cornell(), 300);
    let r = Radiosity::new(patches, factors);
    for channel in 0..3 {
        let t = r.operator(channel);
        let modes = Modes::of(&t, 8);
        assert_eq!(modes.leading.len(), 8);
        assert_eq!(modes.values.len(), t.rho.iter().filter(|r| **r > 0.0).count());
        assert!(modes.values.windows(2).all(|w| w[0].abs() >= w[1].abs()));
        // an eigenvector of the symmetric part: off by what single precision takes from the symmetry
        assert!(modes.leading.iter().all(|m| m.residual < 1e-7), "{:?}", modes.leading[0].residual);
        for (i, a) in modes.leading.iter().enumerate() {
            for (j, b) in modes.leading.iter().enumerate() {
                let product = t.weighted_inner(&a.vector, &b.vector);
                close("⟨u_i, u_j⟩_w", product, f64::from(u8::from(i == j)), 1e-12);
            }
        }
        // the first is the spectral radius, between its bounds, and of one sign
        let [low, high] = radius_bounds(&t, 100);
        close("power iteration", modes.values[0], r.spectral_radius()[channel].radius, 1e-7);
        let upper = high + SINGLE;
        assert!(low - SINGLE <= modes.values[0] && modes.values[0] <= upper && high - low < 0.02, "{low}, {high}");
        assert!(modes.leading[0].vector.iter().all(|v| *v >= 0.0));
        // ⟨u_j, T^k E⟩ = λ_j^{k−1} ⟨u_j, T E⟩
        let terms: Vec<Vec<f64>> = Neumann::new(&t, r.emission(channel)).take(10).collect();
        let size = t.weighted_norm(&terms[1]);
        for m in &modes.leading {
            let first = t.weighted_inner(&m.vector, &terms[1]);
            for (k, term) in terms.iter().enumerate().skip(1) {
                let predicted = first * m.value.powi(k as i32 - 1);
                close(&format!("k = {k}"), t.weighted_inner(&m.vector, term), predicted, 2e-7 * size);
            }
        }
        // the norms of one bounce lie above the rate at which it decays at last
        let two = norm_2(&t, 1e-12, 500);
        assert!(low <= two && two * two <= t.norm_1() * t.norm_inf() * (1.0 + 1e-12));
    }
}

/// Lanczos finds the ends that the dense solver finds, and says how far off it may be.
#[test]
fn the_ends_of_the_spectrum_by_lanczos() {
    let (patches, factors) = discretise(&cornell(), 300);
    let r = Radiosity::new(patches, factors);
    let t = r.operator(0);
    let mut all = Modes::of(&t, 0).values;
    all.sort_by(|a, b| b.total_cmp(a));
    let [above, below] = leading(&t, &t.weight(), 6, 1e-9, 200);
    assert_eq!((above.len(), below.len()), (6, 6));
    for (i, (a, b)) in above.iter().zip(&below).enumerate() {
        close("largest", a.value, all[i], a.residual + SINGLE);
        close("smallest", b.value, all[all.len() - 1 - i], b.residual + SINGLE);
    }
    // too few steps are said to be too few
    let [early, _] = leading(&t, &t.weight(), 2, 1e-9, 5);
    assert!(early[1].residual > 1e-4 && (early[0].value - all[0]).abs() <= early[0].residual);
}

/// Inside of a sphere: T is of rank one, r = ‖T‖₁ = ρ̄ < ‖T‖₂ = √(mean ρ²) < ‖T‖∞ = max ρ.
#[test]
fn the_norms_of_a_rank_one_operator() {
    let area = numbers_between(12, 0.5, 1.5, 4);
    let whole: f64 = area.iter().sum();
    let f = (0..144).map(|k| (area[k % 12] / whole) as f32).collect();
    let factors = FormFactors { n: 12, f, area: area.clone(), rays: 0 };
    let rho = numbers_between(12, 0.1, 0.9, 5);
    let mean = |p: i32| area.iter().zip(&rho).map(|(a, r)| a * r.powi(p)).sum::<f64>() / whole;
    let t = PatchOperator::new(&factors, rho.clone());
    let modes = Modes::of(&t, 12);
    close("r", modes.values[0], mean(1), SINGLE);
    assert!(modes.values[1..].iter().all(|v| v.abs() < SINGLE));
    close("‖T‖₁", t.norm_1(), mean(1), SINGLE);
    close("‖T‖₂", norm_2(&t, 1e-14, 100), mean(2).sqrt(), SINGLE);
    close("‖T‖∞", t.norm_inf(), rho.iter().copied().fold(0.0, f64::max), SINGLE);
    let [low, high] = radius_bounds(&t, 5);
    close("bounds", low, high, SINGLE);
}

/// White floor against white walls: 0.42361 ρ; the band of a cube is that of its two brightest faces that meet.
#[test]
fn the_band_is_that_of_the_brightest_edge() {
    let (patches, factors) = discretise(&cornell(), 300);
    for (channel, rho) in WHITE.to_array().into_iter().enumerate() {
        let r: Vec<f64> = patches.iter().map(|p| p.reflectance[channel]).collect();
        let band = essential_band(&patches, &factors, &r);
        close("white edges", band.half_width, KAPPA * rho, 1e-15);
        assert!(band.right > 30 && band.other == 0, "{band:?}");
    }
    // −x and +x face each other; of −x (0.9) only edges with y and z faces count
    let r = cube(2, [0.9, 0.8, 0.1, 0.2, 0.3, 0.0], [1.0; 6]);
    let band = essential_band(&r.patches, &r.factors, &r.reflectance(0));
    close("cube", band.half_width, KAPPA * (0.9f64 * 0.3).sqrt(), 1e-15);
    // 12 edges, 4 of them at the black face, 2 pairs of patches along each; corners add none
    assert_eq!((band.right, band.other), (8 * 2, 0));
    // plates face to face have no edge
    let up = quad(v(0., 0., 0.), v(0., 0., 1.), v(1., 0., 0.));
    let down = quad(v(0., 1., 0.), v(1., 0., 0.), v(0., 0., 1.));
    let (patches, factors) = discretise(&scene([up, down].map(|g| (g, DVec3::splat(0.9), DVec3::ONE)).into()), 8);
    assert_eq!(essential_band(&patches, &factors, &vec![0.9; patches.len()]).right, 0);
}
