//! The algebra of operators: identities that hold to rounding, and spaces that do not mix.
#![allow(clippy::unwrap_used)]

mod discrete;
#[path = "../chapters/operators.rs"]
#[allow(dead_code, unreachable_pub)] // its `main`; a program, not a library
mod example;
use discrete::*;
use fredholm::operator::algebra::{AlgebraError, Expression};
use fredholm::operator::form_factor::FormFactors;
use fredholm::operator::matrix::*;
use fredholm::solver::{Neumann, Radiosity, direct};

/// Largest difference, relative to the largest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
    let worst = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m });
    worst / scale
}

/// ⟨W, T x⟩ = ⟨T* W, x⟩, relative to ⟨|W|, |T x|⟩, which rounding goes by.
fn assert_adjoint(what: &str, t: &Expression<'_>, seed: u64) {
    let n = t.len();
    let (w, x) = (numbers_between(n, -1.0, 1.0, seed), numbers_between(n, -1.0, 1.0, seed + 1));
    let (tx, tw) = (t.of(&x).unwrap(), t.adjoint().of(&w).unwrap());
    let size: f64 = t.area().iter().zip(&w).zip(&tx).map(|((a, w), y)| (a * w * y).abs()).sum();
    let size = size + t.area().iter().zip(&tw).zip(&x).map(|((a, w), y)| (a * w * y).abs()).sum::<f64>();
    let difference = (t.inner(&w, &tx) - t.inner(&tw, &x)).abs();
    assert!(difference <= 1e-14 * size, "{what}: {difference:e} of {size}");
    // and the trait says the same as the expression
    let mut y = vec![0.0; n];
    t.apply_adjoint(&w, &mut y);
    assert_eq!(y, tw, "{what}");
    t.apply(&x, &mut y);
    assert_eq!(y, tx, "{what}");
}

/// Everything that the algebra can build from two operators.
fn combinations<'a>(s: &Expression<'a>, t: &Expression<'a>) -> Vec<(&'static str, Expression<'a>)> {
    vec![
        ("T", t.clone()),
        ("S + T", s.plus(t).unwrap()),
        ("S − T", s.minus(t).unwrap()),
        ("−1.7 T", t.scaled(-1.7)),
        ("S T", s.times(t).unwrap()),
        ("T³", t.power(3)),
        ("T⁰", t.power(0)),
        ("(I − T)⁻¹", t.resolvent().unwrap()),
        ("T*", t.adjoint()),
        ("T**", t.adjoint().adjoint()),
        ("(S T* + ½ S²)(I − T)⁻¹", {
            let sum = s.times(&t.adjoint()).unwrap().plus(&s.power(2).scaled(0.5)).unwrap();
            sum.times(&t.resolvent().unwrap()).unwrap()
        }),
    ]
}

#[test]
fn measurements_are_the_same_from_both_ends() {
    for seed in 0..20 {
        let n = 1 + (seed as usize * 7) % 40;
        let factors = random_factors(n, f64::from(u8::from(seed % 2 == 0)), seed);
        let s = PatchOperator::new(&factors, numbers_between(n, 0.0, 1.0, seed + 100));
        let t = PatchOperator::new(&factors, numbers_between(n, 0.0, 1.0, seed + 200));
        for (what, expression) in combinations(&Expression::from(&s), &Expression::from(&t)) {
            assert_adjoint(what, &expression, seed + 300);
        }
    }
    let (patches, factors) = discretise(&cornell(), 300);
    let r = Radiosity::new(patches, factors);
    let (red, green) = (r.operator(0), r.operator(1));
    for (what, expression) in combinations(&Expression::from(&red), &Expression::from(&green)) {
        assert_adjoint(what, &expression, 7);
    }
}

#[test]
fn expressions_are_what_they_say() {
    let n = 23;
    let factors = random_factors(n, 1.0, 5);
    let (s, t) = (
        PatchOperator::new(&factors, numbers_between(n, 0.0, 1.0, 6)),
        PatchOperator::new(&factors, numbers_between(n, 0.0, 1.0, 7)),
    );
    let x = numbers_between(n, -1.0, 1.0, 8);
    let entry = |i: usize, j: usize, k: usize| s.entry(i, k) * t.entry(k, j);
    let product: Vec<f64> =
        (0..n).map(|i| (0..n).map(|j| x[j] * (0..n).map(|k| entry(i, j, k)).sum::<f64>()).sum()).collect();
    let (se, te) = (Expression::from(&s), Expression::from(&t));
    assert!(apart(&se.times(&te).unwrap().of(&x).unwrap(), &product) < 1e-14);
    // sums, differences and scalings, entry by entry
    let mixed: Vec<f64> = (0..n).map(|i| (0..n).map(|j| (2.0 * s.entry(i, j) - t.entry(i, j)) * x[j]).sum()).collect();
    assert!(apart(&se.scaled(2.0).minus(&te).unwrap().of(&x).unwrap(), &mixed) < 1e-14);
    // powers are the terms of the series, the resolvent is their sum and what LU finds
    let fifth = Neumann::new(&t, x.clone()).nth(5).unwrap();
    assert_eq!(te.power(5).of(&x).unwrap(), fifth);
    let light = te.resolvent().unwrap().of(&x).unwrap();
    assert!(apart(&light, &direct::solve(&t, &x).unwrap().x) < 1e-13);
    let identity = Expression::identity(&factors.area);
    let back = identity.minus(&te).unwrap().times(&te.resolvent().unwrap()).unwrap();
    assert!(apart(&back.of(&x).unwrap(), &x) < 1e-13);
    // L = S_n + T^{n+1} (I − T)⁻¹ E
    let rest = te.power(4).times(&te.resolvent().unwrap()).unwrap().of(&x).unwrap();
    let sum = Neumann::new(&t, x.clone()).partial_sums().nth(3).unwrap();
    let whole: Vec<f64> = sum.iter().zip(&rest).map(|(a, b)| a + b).collect();
    assert!(apart(&whole, &light) < 1e-13);
}

/// T = diag(ρ) F has ρ on the left: F diag(ρ) is its adjoint, and another operator.
#[test]
fn albedo_stands_on_the_left() {
    let (patches, factors) = discretise(&cornell(), 300);
    let r = Radiosity::new(patches, factors);
    let n = r.factors.n;
    let f = PatchOperator::new(&r.factors, vec![1.0; n]);
    let t = r.operator(0);
    let (fe, te) = (Expression::from(&f), Expression::from(&t));
    let rho = Expression::diagonal(&r.factors.area, r.reflectance(0)).unwrap();
    let x = numbers_between(n, 0.0, 1.0, 1);
    let left = rho.times(&fe).unwrap().of(&x).unwrap();
    let right = fe.times(&rho).unwrap().of(&x).unwrap();
    assert!(apart(&left, &te.of(&x).unwrap()) < 1e-15);
    // F is self-adjoint to the precision of its entries: each is rounded to single precision
    assert!(apart(&right, &te.adjoint().of(&x).unwrap()) < 1.2e-7);
    assert!(apart(&right, &left) > 0.1, "ρ on the right is another operator");
}

#[test]
fn operators_of_different_meshes_do_not_mix() {
    let (a, b, c) = (random_factors(5, 1.0, 1), random_factors(6, 1.0, 1), random_factors(5, 1.0, 2));
    let of = |f: &'static FormFactors| PatchOperator::new(f, vec![0.5; f.n]);
    let leak = |f: FormFactors| &*Box::leak(Box::new(f));
    let (a, b, c) = (of(leak(a)), of(leak(b)), of(leak(c)));
    let (ea, eb, ec) = (Expression::from(&a), Expression::from(&b), Expression::from(&c));
    let sizes = AlgebraError::Sizes { left: 5, right: 6 };
    assert_eq!(ea.plus(&eb).err(), Some(sizes.clone()));
    assert_eq!(ea.times(&eb).err(), Some(sizes.clone()));
    assert_eq!(ea.of(&[1.0; 6]).err(), Some(sizes.clone()));
    assert_eq!(Expression::diagonal(a.area(), vec![1.0; 6]).err(), Some(AlgebraError::Sizes { left: 6, right: 5 }));
    assert_eq!(sizes.to_string(), "one side has 5 patches, the other 6: they act on different meshes");
    let error = ea.minus(&ec).err().unwrap();
    assert_eq!(error, AlgebraError::Areas { patch: 0, left: a.area()[0], right: c.area()[0] });
    assert!(error.to_string().contains("patch 0 has area"));
}

#[test]
fn a_series_without_a_sum_is_refused() {
    let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
    // r = √(ρ₁ρ₂): 0.99 < 1 although ‖T‖ > 1; 1 and 1.01 diverge
    for (rho, converges) in [([1.5, 0.6534], true), ([1.0, 1.0], false), ([1.7, 0.6001], false)] {
        let t = PatchOperator::new(&plates, rho.to_vec());
        let resolvent = Expression::from(&t).resolvent();
        assert_eq!(resolvent.is_ok(), converges, "{rho:?}");
        assert!(converges || matches!(resolvent.err(), Some(AlgebraError::Diverges { .. })));
    }
    // signs may alternate
    let t = PatchOperator::new(&plates, vec![0.5, 0.5]);
    let alternating = Expression::from(&t).scaled(-1.0).resolvent().unwrap();
    assert!(apart(&alternating.of(&[1.0, 0.0]).unwrap(), &[4.0 / 3.0, -2.0 / 3.0]) < 1e-15);
}

/// `cargo run --example operators`: what it prints as equal is equal, and what it prints as different is not.
#[test]
fn the_example_says_what_holds() {
    let room = example::room().unwrap();
    let equations = example::equations(&room).unwrap();
    for e in &equations {
        assert!(e.is_right(), "{}: {:?}, {:e} apart", e.says, e.sides, e.apart());
        assert!(e.sides.iter().all(|x| x.is_finite() && *x > 0.0), "{}: {:?}", e.says, e.sides);
    }
    assert_eq!(equations.iter().filter(|e| e.but.is_none()).count(), 7);
}
