//! Solvers step by step: each against LU, and the theorems that hold for it at every step.
#![allow(clippy::unwrap_used)]

mod discrete;
#[path = "solvers/rays.rs"]
mod rays;
use discrete::*;
use fredholm::operator::form_factor::FormFactors;
use fredholm::operator::matrix::*;
use fredholm::operator::patches::Patches;
use fredholm::scene::description::Geometry;
use fredholm::solver::comparison::{History, Limits, Solver, System};
use fredholm::solver::*;
use glam::DVec3;
use nalgebra::{DMatrix, SymmetricEigen};

/// A matrix with albedos and emission.
struct Case {
    name: String,
    factors: FormFactors,
    rho: Vec<f64>,
    emission: Vec<f64>,
}

impl Case {
    fn operator(&self) -> PatchOperator<'_> {
        PatchOperator::new(&self.factors, self.rho.clone())
    }
}

/// Two plates, random matrices with and without a diagonal, the Cornell box (with its black lamp), a sphere of bands.
fn cases() -> Vec<Case> {
    let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
    let mut all = vec![Case { name: "plates".into(), factors: plates, rho: vec![0.9, 0.4], emission: vec![1.0, 0.0] }];
    for (seed, n, own) in [(1, 5, 0.0), (2, 30, 1.0), (3, 31, 20.0)] {
        let factors = random_factors(n, own, seed);
        let (rho, emission) = (numbers_between(n, 0.1, 1.0, seed + 10), numbers_between(n, 0.0, 2.0, seed + 20));
        all.push(Case { name: format!("random {n}, {own}"), factors, rho, emission });
    }
    let (patches, factors) = discretise(&cornell(), 300);
    let r = Radiosity::new(patches, factors);
    for channel in [0, 1] {
        let (rho, emission) = (r.reflectance(channel), r.emission(channel));
        all.push(Case { name: format!("cornell {channel}"), factors: r.factors.clone(), rho, emission });
    }
    all.push(sphere());
    all
}

/// The inside of a sphere: every patch sees itself.
fn sphere() -> Case {
    let ball = Geometry::Sphere { center: DVec3::ZERO, radius: 1.0, z: [-1.0, 1.0], inward: true };
    let description = scene(vec![(ball, DVec3::splat(0.8), DVec3::ONE)]);
    let patches = Patches::new(&description, 24).unwrap();
    let factors = factors(&description, &patches);
    let emission = numbers_between(factors.n, 0.0, 1.0, 3);
    Case { name: "sphere".into(), rho: vec![0.8; factors.n], emission, factors }
}

const TIGHT: Limits<'_> = Limits { error: 1e-13, applications: 2000.0, stopped: &|| false };

fn histories(case: &Case, solvers: &[Solver]) -> Vec<History> {
    let t = case.operator();
    let system = System::new(&t, case.emission.clone()).unwrap();
    solvers.iter().map(|s| system.history(*s, TIGHT)).collect()
}

#[test]
fn every_solver_finds_what_lu_finds() {
    for case in cases() {
        let size = case.operator().norm(&case.emission);
        for h in histories(&case, &Solver::ALL) {
            let what = format!("{}, {}", case.name, h.solver.name());
            let last = h.points.last().unwrap();
            assert!(last.error <= 2e-13, "{what}: error {:e} after {} products", last.error, last.applications);
            assert!(last.residual <= 1e-11 * size, "{what}: residual {:e}", last.residual);
            let order =
                h.points.windows(2).all(|w| w[0].applications < w[1].applications && w[0].seconds <= w[1].seconds);
            assert!(order, "{what}: work only grows");
        }
    }
}

/// E − (I − T) S_n = T^{n+1} E: the first inspection that any solver gets.
#[test]
fn the_residual_of_a_partial_sum_is_the_next_term() {
    for case in cases() {
        let t = case.operator();
        let watched = Watched::new(&t, &case.emission, || PartialSums::new(&t, &case.emission));
        let size = t.norm(&case.emission);
        let terms: Vec<Vec<f64>> = Neumann::new(&t, case.emission.clone()).take(31).collect();
        for (n, step) in watched.take(30).enumerate() {
            assert_eq!((step.step, step.applications), (n, n as f64));
            let next = t.norm(&terms[n + 1]);
            assert!((step.residual - next).abs() <= 1e-14 * size, "{}, n = {n}: {step:?}, {next:e}", case.name);
        }
    }
}

/// GMRES minimises over a space that holds the partial sums.
#[test]
fn gmres_never_has_more_residual_than_the_series() {
    for case in cases() {
        let t = case.operator();
        let terms = Neumann::new(&t, case.emission.clone()).skip(1).take(25);
        let mut watched = Watched::new(&t, &case.emission, || Gmres::new(&t, &case.emission));
        let size = t.norm(&case.emission);
        let mut strictly = 0;
        for (n, term) in terms.enumerate() {
            let Some(step) = watched.next() else { break };
            let bound = t.norm(&term);
            assert!(step.residual <= bound + 1e-13 * size, "{}, n = {n}: {:e} > {bound:e}", case.name, step.residual);
            strictly += usize::from(step.residual < 0.9 * bound);
            let known = watched.iteration().recurrence();
            assert!((known - step.residual).abs() <= 1e-13 * size, "{}, n = {n}: recurrence {known:e}", case.name);
        }
        assert!(strictly > 0, "{}: and it is better somewhere", case.name);
    }
}

/// With T ≥ 0 and E ≥ 0: Jacobi ≤ Gauss–Seidel ≤ L, patch by patch, and both only rise.
#[test]
fn gauss_seidel_is_never_behind_jacobi() {
    for case in cases() {
        let t = case.operator();
        let light = direct::solve(&t, &case.emission).unwrap().x;
        let most = light.iter().copied().fold(0.0, f64::max);
        let (mut j, mut g) = (Jacobi::new(&t, &case.emission), Sor::gauss_seidel(&t, &case.emission));
        for step in 1..=20 {
            let before = [j.iterate().to_vec(), g.iterate().to_vec()];
            assert!(j.advance() && g.advance());
            for i in 0..light.len() {
                let [a, b] = [j.iterate()[i], g.iterate()[i]];
                let slack = 1e-14 * most;
                assert!(a <= b + slack && b <= light[i] + slack, "{}, step {step}, patch {i}", case.name);
                assert!(a >= before[0][i] - slack && b >= before[1][i] - slack, "{}: both rise", case.name);
            }
        }
        let [j, g] = [Solver::Jacobi, Solver::GaussSeidel].map(|s| histories(&case, &[s]).remove(0).points.len());
        assert!(g < j, "{}: {g} steps instead of {j}", case.name);
    }
}

/// Jacobi is the Neumann series on flat patches, and no longer where a patch sees itself.
#[test]
fn jacobi_differs_from_the_series_on_curved_patches() {
    for case in cases() {
        let t = case.operator();
        let own = (0..t.len()).map(|i| t.entry(i, i)).fold(0.0, f64::max);
        let (mut jacobi, mut sums) = (Jacobi::new(&t, &case.emission), PartialSums::new(&t, &case.emission));
        let mut apart = 0.0f64;
        for _ in 0..5 {
            assert!(jacobi.advance() && sums.advance());
            let pairs = jacobi.iterate().iter().zip(sums.iterate());
            apart = pairs.map(|(a, b)| (a - b).abs()).fold(apart, f64::max);
        }
        let flat = own == 0.0;
        let size = case.emission.iter().copied().fold(0.0, f64::max);
        if flat {
            assert!(apart <= 1e-14 * size, "{}: {apart:e}", case.name);
        } else {
            assert!(apart > 1e-3 * size, "{}: {apart:e} with Tᵢᵢ up to {own}", case.name);
        }
        assert_eq!(flat, !(case.name.contains("sphere") || case.name.starts_with("random 3")), "{}", case.name);
    }
    // on the sphere Fᵢⱼ = Aⱼ/A, so a single step can be written down: E = 1 gives (1 + ρ − ρ Aᵢ/A)/(1 − ρ Aᵢ/A)
    let mut case = sphere();
    case.emission = vec![1.0; case.factors.n];
    let t = case.operator();
    let mut jacobi = Jacobi::new(&t, &case.emission);
    jacobi.advance();
    let whole: f64 = case.factors.area.iter().sum();
    for (x, area) in jacobi.iterate().iter().zip(&case.factors.area) {
        let own = 0.8 * area / whole;
        assert!((x - (1.8 - own) / (1.0 - own)).abs() < 1e-6, "{x}: (entries of F are in single precision)");
    }
}

/// Shot by shot: what is unshot stays ≥ 0 and is the residual; x rises and is never too bright.
#[test]
fn southwell_rises_to_the_solution_from_below() {
    for case in cases() {
        let t = case.operator();
        let light = direct::solve(&t, &case.emission).unwrap().x;
        let size = light.iter().copied().fold(0.0, f64::max);
        let mut shooting = Southwell::with_shots(&t, &case.emission, 1);
        let n = light.len();
        for shot in 1..=5 * n {
            let (before, unshot) = (shooting.iterate().to_vec(), shooting.unshot().to_vec());
            let power = |i: usize| t.area()[i] * unshot[i];
            if !shooting.advance() {
                break;
            }
            let moved: Vec<usize> = (0..n).filter(|&i| shooting.iterate()[i] != before[i]).collect();
            let most = (0..n).map(power).fold(0.0, f64::max);
            assert!(moved.len() == 1 && power(moved[0]) == most, "{}, shot {shot}: the brightest shoots", case.name);
            assert!(shooting.iterate()[moved[0]] > before[moved[0]]);
            assert!(shooting.unshot().iter().all(|r| *r >= 0.0), "{}, shot {shot}", case.name);
            assert!(shooting.iterate().iter().zip(&light).all(|(x, l)| *x <= l + 1e-14 * size));
        }
        let fresh = residual(&t, &case.emission, shooting.iterate());
        let drift = fresh.iter().zip(shooting.unshot()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(drift <= 1e-13 * size, "{}: {drift:e}", case.name);
    }
}

/// All eigenvalues of T on the patches that reflect, rising: those of D^½ A^½ F A^−½ D^½.
fn eigenvalues(t: &PatchOperator<'_>) -> Vec<f64> {
    let on: Vec<usize> = (0..t.len()).filter(|&i| t.rho[i] > 0.0).collect();
    let s = |a: usize, b: usize| {
        let (i, j) = (on[a], on[b]);
        let weight = (t.area()[i] / t.rho[i]).sqrt() / (t.area()[j] / t.rho[j]).sqrt();
        t.entry(i, j) * weight
    };
    let matrix = DMatrix::from_fn(on.len(), on.len(), |a, b| 0.5 * (s(a, b) + s(b, a)));
    let mut all: Vec<f64> = SymmetricEigen::new(matrix).eigenvalues.iter().copied().collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Entries in single precision are symmetric to 6e-8 only, and so are the eigenvalues known.
const SINGLE: f64 = 1e-7;

#[test]
fn the_ends_of_the_spectrum_are_those_of_the_dense_matrix() {
    for case in cases() {
        let t = case.operator();
        let all = eigenvalues(&t);
        let ends = extremes(&t, &t.weight(), 1e-10, 400);
        let exact = [all[0], all[all.len() - 1]];
        for (found, exact) in [ends.smallest, ends.largest].into_iter().zip(exact) {
            assert!((found - exact).abs() <= SINGLE, "{}: {found} instead of {exact}", case.name);
        }
        assert!(ends.residual.iter().all(|r| *r <= 1e-10 + SINGLE), "{}: {ends:?}", case.name);
        // stopped early, the bracket is honest about what it does not know
        let early = extremes(&t, &t.weight(), 0.0, 5.min(t.len()));
        assert!(early.largest <= exact[1] + SINGLE && early.smallest >= exact[0] - SINGLE);
        assert!((early.largest - exact[1]).abs() <= early.residual[1] + SINGLE, "{}: {early:?}", case.name);
    }
}

/// ‖L − xₙ‖_w ≤ 2 qⁿ/(1 + q²ⁿ) ‖L − x₀‖_w for Chebyshev with the exact ends; the same in the energy norm for CG.
#[test]
fn chebyshev_and_cg_keep_their_bounds() {
    for case in cases() {
        let t = case.operator();
        let light = direct::solve(&t, &case.emission).unwrap().x;
        let all = eigenvalues(&t);
        let ends = [all[0] - SINGLE, all[all.len() - 1] + SINGLE];
        let error = |x: &[f64]| light.iter().zip(x).map(|(l, x)| l - x).collect::<Vec<f64>>();
        let energy = |x: &[f64]| {
            let e = error(x);
            let mut y = vec![0.0; e.len()];
            t.apply(&e, &mut y);
            y.iter_mut().zip(&e).for_each(|(y, e)| *y = e - *y);
            t.weighted_inner(&e, &y).max(0.0).sqrt()
        };
        let start = (t.weighted_norm(&error(&case.emission)), energy(&case.emission));
        let mut chebyshev = Chebyshev::new(&t, &case.emission, ends);
        let mut cg = ConjugateGradients::new(&t, t.weight(), &case.emission);
        for n in 1..=25 {
            let bound = Chebyshev::<PatchOperator<'_>>::bound(ends, n);
            chebyshev.advance();
            let got = t.weighted_norm(&error(chebyshev.iterate())) / start.0;
            assert!(got <= bound * (1.0 + 1e-6) + 1e-13, "{}, Chebyshev {n}: {got:e} > {bound:e}", case.name);
            // (the square root of a difference is good to half the digits)
            cg.advance();
            let got = energy(cg.iterate()) / start.1;
            assert!(got <= bound * (1.0 + 1e-6) + 1e-13, "{}, CG {n}: {got:e} > {bound:e}", case.name);
        }
    }
}

/// An upper end that is too low breaks the bound, and the iteration falls behind the plain series.
#[test]
fn chebyshev_with_too_low_an_end_is_slower_than_the_series() {
    let case = cases().into_iter().find(|c| c.name == "cornell 0").unwrap();
    let t = case.operator();
    let light = direct::solve(&t, &case.emission).unwrap().x;
    let all = eigenvalues(&t);
    let error = |x: &[f64]| t.weighted_norm(&light.iter().zip(x).map(|(l, x)| l - x).collect::<Vec<f64>>());
    let run = |end: f64| {
        let mut c = Chebyshev::new(&t, &case.emission, [all[0], end]);
        (0..20).for_each(|_| assert!(c.advance()));
        error(c.iterate()) / error(&case.emission)
    };
    let mut sums = PartialSums::new(&t, &case.emission);
    (0..20).for_each(|_| assert!(sums.advance()));
    let series = error(sums.iterate()) / error(&case.emission);
    let top = all[all.len() - 1];
    let (right, low) = (run(top), run(0.5 * top));
    let bound = Chebyshev::<PatchOperator<'_>>::bound([all[0], 0.5 * top], 20);
    assert!(low > 100.0 * bound, "{low:e}, promised {bound:e}");
    assert!(right < 1e-2 * series && low > right, "right {right:e}, too low {low:e}, series {series:e}");
}

#[test]
fn iterations_end_when_nothing_is_left() {
    let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
    let t = PatchOperator::new(&plates, vec![0.9, 0.4]);
    // two eigenvalues: two steps
    let mut gmres = Gmres::new(&t, &[1.0, 0.0]);
    assert!(gmres.advance() && gmres.advance() && !gmres.advance());
    assert!((gmres.iterate()[0] - 1.5625).abs() < 1e-14);
    // no light, no steps
    let dark = [0.0, 0.0];
    assert!(!Gmres::new(&t, &dark).advance());
    assert!(!ConjugateGradients::new(&t, t.weight(), &dark).advance());
    assert!(!Southwell::new(&t, &dark).advance());
    assert_eq!(Gmres::new(&t, &dark).iterate(), dark);
}
