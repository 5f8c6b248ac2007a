//! The same solvers on stored rays, whose T is self-adjoint only within its noise; and expressions that are self-adjoint.

use super::*;
use fredholm::operator::algebra::Expression;
use fredholm::operator::rays::{Half, RayOperator, Rays};
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::scene::description::Description;

/// Rows of few rays, so that T is far from self-adjoint.
fn shoot(description: &Description, patches: &Patches, per_row: usize) -> Rays {
    Rays::new(patches, &Scene::new(description), per_row, 5, Progress::NONE).unwrap()
}

fn ball() -> Description {
    let ball = Geometry::Sphere { center: DVec3::ZERO, radius: 1.0, z: [-1.0, 1.0], inward: true };
    scene(vec![(ball, DVec3::splat(0.8), DVec3::ONE)])
}

/// Name, rays, red albedo, red direct light.
fn sampled() -> Vec<(&'static str, Rays, Vec<f64>, Vec<f64>)> {
    [("cornell", cornell(), 300, 16), ("cornell", cornell(), 300, 128), ("sphere", ball(), 24, 32)]
        .map(|(name, description, n, per_row)| {
            let patches = Patches::new(&description, n).unwrap();
            let rays = shoot(&description, &patches, per_row);
            let rho = patches.iter().map(|p| p.reflectance.x).collect();
            let direct = (0..rays.n).map(|i| rays.direct(i).x).collect();
            (name, rays, rho, direct)
        })
        .into()
}

fn dense(t: &RayOperator<'_>) -> DMatrix<f64> {
    DMatrix::from_fn(t.len(), t.len(), |i, j| t.entry(i, j))
}

#[test]
fn rows_and_columns_of_rays_are_those_of_their_operator() {
    for (name, rays, rho, _) in sampled() {
        for half in [Half::Both, Half::First, Half::Second] {
            let t = rays.operator(rho.clone()).by(half);
            let (n, columns) = (t.len(), t.columns());
            let x = numbers_between(n, -1.0, 1.0, 4);
            let (mut whole, mut image, mut work) = (vec![0.0; n], vec![0.0; n], 0);
            t.apply(&x, &mut whole);
            for j in 0..n {
                let mut unit = vec![0.0; n];
                unit[j] = 1.0;
                t.apply(&unit, &mut image);
                let mut column = vec![0.0; n];
                columns.visit(j, |i, t| column[i] += t);
                work += columns.work(j);
                for i in 0..n {
                    assert!((t.entry(i, j) - image[i]).abs() < 1e-15, "{name}, {half:?}: entry {i}, {j}");
                    assert!((column[i] - image[i]).abs() < 1e-15, "{name}, {half:?}: column {i}, {j}");
                }
                assert_eq!(t.row_times(j, &x), whole[j], "{name}, {half:?}: row {j}");
            }
            assert_eq!(work, columns.whole(), "{name}: all columns are an application");
        }
    }
}

/// Against LU of the entries, which the program does not use here.
#[test]
fn every_solver_finds_what_lu_finds_on_rays() {
    for (name, rays, rho, direct) in sampled() {
        let t = rays.operator(rho);
        let system = System::sampled(&t, direct.clone()).unwrap();
        let lu = (DMatrix::identity(t.len(), t.len()) - dense(&t)).lu();
        let exact = lu.solve(&nalgebra::DVector::from_column_slice(&direct)).unwrap();
        let apart: Vec<f64> = system.light.iter().zip(&exact).map(|(a, b)| a - b).collect();
        assert!(t.norm(&apart) <= 1e-14 * t.norm(exact.as_slice()), "{name}: {:e}", t.norm(&apart));
        assert!(system.residual() < 1e-15, "{name}: {:e}", system.residual());
        assert_eq!(system.solvers().len(), Solver::ALL.len() - 2);
        for solver in Solver::ALL {
            let points = system.history(solver, TIGHT).points;
            if !solver.suits_rays() {
                assert!(points.is_empty(), "{}", solver.name());
                continue;
            }
            let last = points.last().unwrap();
            let what = format!("{name}, {} rays, {}", rays.per_row, solver.name());
            assert!(last.error <= 2e-13, "{what}: error {:e} after {} products", last.error, last.applications);
            assert!(points.windows(2).all(|w| w[0].applications < w[1].applications), "{what}: work only grows");
        }
    }
}

/// Why conjugate gradients are refused: in as many products they stay far behind GMRES where T is noisy.
#[test]
fn conjugate_gradients_fail_on_what_is_not_self_adjoint() {
    for (name, rays, rho, direct) in sampled().into_iter().filter(|s| s.0 == "cornell" && s.1.per_row == 16) {
        let t = rays.operator(rho);
        let system = System::sampled(&t, direct.clone()).unwrap();
        let weight = Weight::new(t.area(), &t.rho);
        let (mut cg, mut gmres) = (ConjugateGradients::new(&t, weight, &direct), Gmres::new(&t, &direct));
        (0..20).for_each(|_| assert!(cg.advance() && gmres.advance()));
        let [cg, gmres] = [cg.iterate(), gmres.iterate()].map(|x| system.error(x));
        assert!(cg > 1e4 * gmres, "{name}: CG {cg:e}, GMRES {gmres:e}");
    }
}

/// The bracket that Chebyshev uses holds the real part of every eigenvalue of T, most of which are complex.
#[test]
fn ends_of_the_symmetric_part_hold_the_spectrum_of_rays() {
    for (name, rays, rho, direct) in sampled() {
        let t = rays.operator(rho);
        let weight = Weight::new(t.area(), &t.rho);
        let symmetric = Expression::from(&t).symmetric_part(&weight);
        let (x, y) = (numbers_between(t.len(), -1.0, 1.0, 1), numbers_between(t.len(), -1.0, 1.0, 2));
        // T u is 0 where nothing reflects, and so must be what it is weighed with
        let on = |x: Vec<f64>| x.iter().zip(&t.rho).map(|(x, r)| if *r > 0.0 { *x } else { 0.0 }).collect::<Vec<f64>>();
        let (x, y) = (on(x), on(y));
        let both = [weight.inner(&symmetric.of(&x).unwrap(), &y), weight.inner(&x, &symmetric.of(&y).unwrap())];
        let own = [weight.inner(&Expression::from(&t).of(&x).unwrap(), &y), both[0]];
        let size = weight.norm(&x) * weight.norm(&y);
        assert!((both[0] - both[1]).abs() < 1e-14 * size, "{name}: the symmetric part is self-adjoint");
        assert!((own[0] - own[1]).abs() > 1e-6 * size, "{name}: T is not");
        let [low, high] = System::sampled(&t, direct).unwrap().bracket();
        let all = dense(&t).complex_eigenvalues();
        assert!(all.iter().any(|l| l.im.abs() > 1e-6), "{name}: some are complex");
        assert!(all.iter().all(|l| low <= l.re && l.re <= high), "{name}: [{low}, {high}]");
        assert!(all.iter().any(|l| l.re > 0.8 * high), "{name}: and no more than needed");
    }
}

/// T², ½(T + T²) and T itself share a weight; their spectra are those of T through the same polynomial.
#[test]
fn expressions_are_solved_like_matrices() {
    for case in cases() {
        let t = case.operator();
        let (weight, one) = (t.weight(), Expression::from(&t));
        let square = one.power(2);
        let mean = one.plus(&square).unwrap().scaled(0.5);
        let all = eigenvalues(&t);
        type Polynomial<'a, 'b> = (&'static str, &'b Expression<'a>, fn(f64) -> f64);
        let polynomials: [Polynomial<'_, '_>; 3] =
            [("T", &one, |l| l), ("T²", &square, |l| l * l), ("½(T + T²)", &mean, |l| 0.5 * (l + l * l))];
        for (what, expression, p) in polynomials {
            let ends = extremes(expression, &weight, 1e-10, 400);
            let exact = all.iter().map(|l| p(*l));
            let exact = [exact.clone().fold(f64::INFINITY, f64::min), exact.fold(f64::NEG_INFINITY, f64::max)];
            for (found, exact) in [ends.smallest, ends.largest].into_iter().zip(exact) {
                assert!((found - exact).abs() <= SINGLE, "{}, {what}: {found} instead of {exact}", case.name);
            }
            let light = expression.resolvent().unwrap().of(&case.emission).unwrap();
            let mut cg = ConjugateGradients::new(expression, weight.clone(), &case.emission);
            (0..40).take_while(|_| cg.advance()).for_each(drop);
            let apart: Vec<f64> = light.iter().zip(cg.iterate()).map(|(a, b)| a - b).collect();
            let error = t.norm(&apart) / t.norm(&light);
            assert!(error < 1e-7, "{}, {what}: CG is off by {error:e}", case.name);
        }
    }
}

/// One shot at a time, found by the tournament instead of a search: the brightest shoots, and the light only rises.
#[test]
fn southwell_rises_on_rays_too() {
    for (name, rays, rho, direct) in sampled() {
        let t = rays.operator(rho);
        let light = settle(&t, &direct).unwrap().x;
        let (size, n) = (light.iter().copied().fold(0.0, f64::max), light.len());
        let mut shooting = Southwell::with_shots(&t, &direct, 1);
        for shot in 1..=5 * n {
            let (before, unshot) = (shooting.iterate().to_vec(), shooting.unshot().to_vec());
            let power = |i: usize| t.area()[i] * unshot[i];
            let most = (0..n).map(power).fold(0.0, f64::max);
            if !shooting.advance() {
                break;
            }
            let moved: Vec<usize> = (0..n).filter(|&i| shooting.iterate()[i] != before[i]).collect();
            assert!(moved.len() == 1 && power(moved[0]) == most, "{name}, shot {shot}: the brightest shoots");
            assert!(shooting.iterate().iter().zip(&light).all(|(x, l)| *x <= l + 1e-14 * size), "{name}, shot {shot}");
        }
        let fresh = residual(&t, &direct, shooting.iterate());
        let drift = fresh.iter().zip(shooting.unshot()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(drift <= 1e-13 * size, "{name}: {drift:e}");
    }
}
