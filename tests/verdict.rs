//! What `compare` says, case by case.
#![allow(clippy::unwrap_used)]

use fredholm::stats::{Criterion, Outcome, compare, discretisation};
use fredholm::terms::{Cost, Doubt, Estimate, Events, Functional, Series, World};
use glam::DVec3;

const R: u64 = 256;

fn estimate(mean: f64, std_error: f64) -> Estimate {
    Estimate {
        mean: DVec3::splat(mean),
        std_error: DVec3::splat(std_error),
        replicates: if std_error == 0.0 { 0 } else { R },
        events: None,
    }
}

/// Terms ½^k up to k = 3 and the tail, all with the relative error `cv`.
fn functional(name: &str, cv: f64) -> Functional {
    let of = |m: f64| estimate(m, cv * m);
    Functional {
        name: name.into(),
        terms: (0..4).map(|k| of(0.5f64.powi(k))).collect(),
        tail: of(0.125),
        sum: of(1.875),
        total: of(2.0),
    }
}

fn series(cv: f64) -> Series {
    let functionals = vec![functional("image", cv), functional("region 0,0", 4.0 * cv)];
    Series {
        world: World::Terms,
        label: "test".into(),
        functionals,
        cost: Cost::default(),
        unsampled: vec![],
        doubts: vec![],
        undecided: None,
        variance: Default::default(),
    }
}

fn path(cv: f64) -> Series {
    let mut s = series(cv);
    s.world = World::Path;
    s.functionals.iter_mut().for_each(|f| f.terms.clear());
    s
}

fn outcome_of(a: &Series, b: &Series) -> Outcome {
    compare(a, b, &Criterion::default(), &[]).outcome
}

#[test]
fn every_quantity_has_one_row_and_every_scalar_is_in_the_family() {
    let c = compare(&series(1e-3), &series(1e-3), &Criterion::default(), &[]);
    assert_eq!(
        c.rows.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(),
        ["T0", "T1", "T2", "T3", "tail", "sum", "total"]
    );
    assert_eq!(c.family, 2 * 7 * 3);
    assert_eq!(c.outcome, Outcome::Agrees);
    assert!(c.rows.iter().all(|r| r.p == 1.0 && r.needed_factor.is_none() && r.reason.is_none()));
    assert!(c.rows.iter().all(|r| r.functional.starts_with("image, ")));
}

#[test]
fn margins_are_two_percent_of_the_term_and_a_trace_of_the_image() {
    let c = compare(&series(1e-3), &series(1e-3), &Criterion::default(), &[]);
    assert!((c.rows[2].delta - (0.02 * 0.25 + 1e-4 * 2.0)).abs() < 1e-15);
    assert!((c.rows[6].delta - (0.02 * 2.0 + 1e-4 * 2.0)).abs() < 1e-15);
    let wide = Criterion { of_term: 0.1, of_total: 0.0, ..Criterion::default() };
    assert!((compare(&series(1e-3), &series(1e-3), &wide, &[]).rows[2].delta - 0.025).abs() < 1e-15);
}

#[test]
fn the_path_tracer_shares_only_the_total() {
    let c = compare(&series(1e-3), &path(1e-3), &Criterion::default(), &[]);
    assert_eq!(c.rows.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["total"]);
    assert_eq!((c.outcome, c.family), (Outcome::Agrees, 6));
}

#[test]
fn different_truncation_leaves_the_common_terms_and_the_total() {
    let mut short = series(1e-3);
    short.functionals.iter_mut().for_each(|f| f.terms.truncate(2));
    let c = compare(&series(1e-3), &short, &Criterion::default(), &[]);
    assert_eq!(c.rows.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["T0", "T1", "total"]);
}

#[test]
fn nothing_in_common_is_inconclusive() {
    let mut empty = series(1e-3);
    empty.functionals.clear();
    assert_eq!(outcome_of(&empty, &series(1e-3)), Outcome::Inconclusive);
    assert_eq!(outcome_of(&series(1e-3), &empty), Outcome::Inconclusive);
}

#[test]
fn noise_without_rejection_is_not_agreement() {
    let c = compare(&series(0.02), &series(0.02), &Criterion::default(), &[]);
    assert_eq!(c.outcome, Outcome::Inconclusive);
    for row in &c.rows {
        assert!(row.interval.0 < -row.delta && row.delta < row.interval.1);
        assert!(row.needed_factor.unwrap() > 1.0 && row.reason.is_none());
        assert!(row.min_detectable > row.delta);
    }
}

/// With the promised samples no effect, of whatever size, stays undecided; with far fewer some do.
#[test]
fn the_needed_factor_decides_every_effect() {
    let noisy = compare(&series(0.02), &series(0.02), &Criterion::default(), &[]);
    let factor = noisy.rows.iter().map(|r| r.needed_factor.unwrap()).fold(0.0, f64::max);
    let undecided = |factor: f64| {
        let cv = 0.02 / factor.sqrt();
        let is_undecided = |i: &i32| {
            let mut b = series(cv);
            b.functionals[0].terms[2].mean *= 1.0 + 0.0002 * f64::from(*i);
            compare(&series(cv), &b, &Criterion::default(), &[]).rows[2].outcome == Outcome::Inconclusive
        };
        (0..400).filter(is_undecided).count()
    };
    assert_eq!(undecided(1.02 * factor), 0);
    assert!(undecided(0.25 * factor) > 10);
}

#[test]
fn a_wrong_term_is_named() {
    let mut b = series(1e-3);
    b.functionals[0].terms[2].mean.y *= 1.03;
    let c = compare(&series(1e-3), &b, &Criterion::default(), &[]);
    assert_eq!(c.outcome, Outcome::Differs);
    let wrong: Vec<_> = c.rows.iter().filter(|r| r.outcome == Outcome::Differs).collect();
    assert_eq!(wrong.len(), 1);
    assert_eq!((wrong[0].name.as_str(), wrong[0].functional.as_str()), ("T2", "image, green"));
    assert!((wrong[0].effect + 0.03 * 0.25).abs() < 1e-15 && wrong[0].p < 1e-3 && wrong[0].interval.1 < 0.0);
}

#[test]
fn a_region_can_reject_but_need_not_agree() {
    // its error of 4 × 0.4 % could never prove 2 %, and need not
    assert_eq!(outcome_of(&series(1e-3), &series(1e-3)), Outcome::Agrees);
    let mut b = series(1e-3);
    b.functionals[1].terms[1].mean.z *= 1.2;
    let c = compare(&series(1e-3), &b, &Criterion::default(), &[]);
    assert_eq!(c.outcome, Outcome::Differs);
    assert_eq!((c.rows[1].outcome, c.rows[1].functional.as_str()), (Outcome::Differs, "region 0,0, blue"));
}

#[test]
fn exact_values_agree_to_rounding_and_differ_beyond() {
    assert_eq!(outcome_of(&series(0.0), &series(0.0)), Outcome::Agrees);
    let shifted = |by: f64| {
        let mut b = series(0.0);
        b.functionals[0].terms[3].mean.x += by * 2.0; // the image is 2
        b
    };
    assert_eq!(outcome_of(&series(0.0), &shifted(0.9e-6)), Outcome::Agrees);
    assert_eq!(outcome_of(&series(0.0), &shifted(1.1e-6)), Outcome::Differs); // far inside δ, but nothing excuses it
}

#[test]
fn an_estimator_without_variance_is_not_convicted_of_rounding() {
    let mut furnace = series(1e-12);
    furnace.functionals[0].terms[1].mean *= 1.0 + 1e-7; // 10⁵ standard errors
    assert_eq!(outcome_of(&furnace, &series(0.0)), Outcome::Agrees);
}

#[test]
fn black_agrees_with_black() {
    let mut a = series(0.0);
    for f in &mut a.functionals {
        f.terms = vec![Estimate::exact(DVec3::ZERO); 4];
        (f.tail, f.sum, f.total) = Default::default();
    }
    assert_eq!(outcome_of(&a, &a), Outcome::Agrees);
}

#[test]
fn one_replicate_decides_nothing_and_says_why() {
    let mut one = series(f64::NAN);
    for f in &mut one.functionals {
        f.terms.iter_mut().chain([&mut f.tail, &mut f.sum, &mut f.total]).for_each(|e| e.replicates = 1);
    }
    let c = compare(&one, &series(0.0), &Criterion::default(), &[]);
    assert_eq!(c.outcome, Outcome::Inconclusive);
    assert!(
        c.rows.iter().all(|r| r.reason.as_deref().unwrap().contains("only one group")
            && r.needed_factor.is_none()
            && r.p.is_nan())
    );
}

#[test]
fn a_value_that_is_not_finite_never_agrees() {
    for (functional, value) in [(0, f64::NAN), (1, f64::NAN), (0, f64::INFINITY)] {
        let mut b = series(1e-3);
        b.functionals[functional].terms[2].mean.x = value;
        let c = compare(&series(1e-3), &b, &Criterion::default(), &[]);
        assert_ne!(c.rows[2].outcome, Outcome::Agrees, "{functional} {value}");
        assert_ne!(c.outcome, Outcome::Agrees);
    }
}

#[test]
fn an_allowance_excuses_what_refinement_explains() {
    let mut coarse = series(0.0);
    coarse.functionals.iter_mut().for_each(|f| f.terms[2].mean *= 1.01);
    let allowance = discretisation(&series(0.0), &coarse);
    assert!((allowance[1].terms[2].mean.x - 0.0025).abs() < 1e-15 && allowance[1].terms[1].mean.x == 0.0);

    let mut mc = series(2e-4);
    mc.functionals[0].terms[2].mean *= 1.005; // 25 standard errors, half the discretisation error
    assert_eq!(outcome_of(&mc, &series(0.0)), Outcome::Differs);
    let c = compare(&mc, &series(0.0), &Criterion::default(), &allowance);
    assert_eq!(c.outcome, Outcome::Agrees);
    assert!(c.rows[2].interval.1 - c.rows[2].interval.0 > 2.0 * 0.0025);

    // the same allowance under one name serves every functional
    mc.functionals[1].terms[2].mean *= 1.008;
    assert_eq!(compare(&mc, &series(0.0), &Criterion::default(), &allowance[..1]).outcome, Outcome::Agrees);
}

#[test]
fn an_allowance_beyond_delta_proves_nothing() {
    let mut coarse = series(0.0);
    coarse.functionals.iter_mut().for_each(|f| f.terms[2].mean *= 1.5);
    for cv in [0.0, 1e-4] {
        let c = compare(&series(cv), &series(0.0), &Criterion::default(), &discretisation(&series(0.0), &coarse));
        assert_eq!(c.rows[2].outcome, Outcome::Inconclusive);
        assert!(c.rows[2].reason.as_deref().unwrap().contains("refine the mesh") && c.rows[2].needed_factor.is_none());
    }
}

/// A mesh whose T2 still halves tells nothing of T2, and sums are judged without it; what it does resolve is judged as before.
#[test]
fn a_term_that_no_mesh_resolves_rejects_nothing() {
    let of_mesh = |factor: f64| {
        let mut s = Series { world: World::Radiosity, ..series(0.0) };
        for f in &mut s.functionals {
            let lost = (1.0 - factor) * f.terms[2].mean;
            f.terms[2].mean -= lost;
            (f.sum.mean, f.total.mean) = (f.sum.mean - lost, f.total.mean - lost);
        }
        s
    };
    let (fine, coarse) = (of_mesh(0.1), of_mesh(0.05));
    let allowance = discretisation(&fine, &coarse);
    let c = compare(&series(1e-4), &fine, &Criterion::default(), &allowance);
    assert_eq!(c.outcome, Outcome::Inconclusive);
    assert!(c.rows[2].reason.as_deref().unwrap().contains("differ by more than a quarter"), "{:?}", c.rows[2]);
    assert!(c.rows.iter().all(|r| r.outcome != Outcome::Differs));
    // where meshes agree on a wrong T2, it is found
    assert_eq!(
        compare(&series(1e-4), &fine, &Criterion::default(), &discretisation(&fine, &fine)).outcome,
        Outcome::Differs
    );
    // and so is a wrong T1 beside what is not resolved, by itself and in the sum
    let mut wrong = series(1e-4);
    for f in &mut wrong.functionals {
        let more = 0.5 * f.terms[1].mean;
        f.terms[1].mean += more;
        (f.sum.mean, f.total.mean) = (f.sum.mean + more, f.total.mean + more);
    }
    let c = compare(&wrong, &fine, &Criterion::default(), &allowance);
    let names: Vec<_> = c.rows.iter().filter(|r| r.outcome == Outcome::Differs).map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["T1", "sum", "total"]);
}

#[test]
fn the_order_of_the_worlds_only_turns_the_sign() {
    let mut b = series(2e-3);
    b.functionals[0].terms[1].mean *= 1.01;
    let (ab, ba) = (
        compare(&series(1e-3), &b, &Criterion::default(), &[]),
        compare(&b, &series(1e-3), &Criterion::default(), &[]),
    );
    for (x, y) in ab.rows.iter().zip(&ba.rows) {
        assert_eq!((x.effect, x.outcome, x.p, x.interval.0), (-y.effect, y.outcome, y.p, -y.interval.1));
    }
}

/// The error of a mean that rests on few events is not known: neither Differs nor Agrees, however the numbers look. No event at
/// all is no exception.
#[test]
fn few_events_decide_nothing() {
    let set = |s: &mut Series, events: f64| {
        let all = s.functionals.iter_mut().flat_map(|f| f.made_of(0));
        all.for_each(|e| e.events = Some(Events::equal(events)));
    };
    let whole = |cv: f64, events: f64| {
        let mut s = series(cv);
        set(&mut s, events);
        s
    };
    let (criterion, mut dim) = (Criterion::default(), whole(1e-4, 1e6));
    dim.functionals.iter_mut().for_each(|f| f.terms.iter_mut().for_each(|t| t.mean *= 0.9));
    assert_eq!(compare(&whole(1e-4, 1e6), &dim, &criterion, &[]).outcome, Outcome::Differs);
    assert_eq!(compare(&whole(1e-4, 1e6), &whole(1e-4, 1e6), &criterion, &[]).outcome, Outcome::Agrees);
    for (a, b) in [(399.0, 1e6), (1e6, 399.0), (2.0, 1e6), (0.0, 1e6)] {
        set(&mut dim, b);
        let found = compare(&whole(1e-4, a), &dim, &criterion, &[]);
        assert_eq!(found.outcome, Outcome::Inconclusive);
        let undecided = found.rows.iter().filter(|r| r.outcome == Outcome::Inconclusive);
        assert!(undecided.clone().count() >= 4, "every term that was dimmed");
        let why = if a == 0.0 { "no event" } else { "rests on" };
        assert!(undecided.clone().all(|r| r.reason.as_deref().is_some_and(|r| r.contains(why))));
        // an error that is not known is not shown
        assert!(undecided.clone().all(|r| r.interval.0.is_nan() && r.min_detectable.is_nan()));
        // equal means agree only where even ten times the error would not matter
        let pair = |cv: f64| compare(&whole(cv, a), &whole(cv, b), &criterion, &[]).outcome;
        assert_eq!((pair(1e-4), pair(2e-3)), (Outcome::Agrees, Outcome::Inconclusive));
    }
    // nothing has hit a region, or the whole term: neither proves that there is no light
    let nothing = Estimate { events: Some(Events::equal(0.0)), replicates: R, ..Estimate::default() };
    let mut dark = whole(1e-4, 1e6);
    dark.functionals[1].terms[2] = nothing;
    assert_eq!(compare(&whole(1e-4, 1e6), &dark, &criterion, &[]).outcome, Outcome::Agrees);
    dark.functionals[0].terms[2] = nothing;
    assert_eq!(compare(&whole(1e-4, 1e6), &dark, &criterion, &[]).rows[2].outcome, Outcome::Inconclusive);
}

/// What is met only by chance, too rarely to be expected, is neither told apart nor called equal, though the samples look alike.
#[test]
fn a_doubt_forbids_both_verdicts_of_the_terms_it_concerns() {
    let doubted = |per_path: f64| {
        let mut s = series(1e-4);
        s.cost.paths = 1_000_000;
        s.doubted(vec![Doubt { what: "lamps".into(), from: 2, per_path }])
    };
    let mut dim = series(1e-4);
    dim.functionals.iter_mut().for_each(|f| f.terms.iter_mut().for_each(|t| t.mean *= 0.9));
    let outcomes = |a: &Series, b: &Series| {
        compare(a, b, &Criterion::default(), &[]).rows.iter().map(|r| r.outcome).collect::<Vec<_>>()
    };
    use Outcome::{Agrees, Differs, Inconclusive};
    let open = Inconclusive;
    assert_eq!(outcomes(&doubted(1e-5), &series(1e-4)), [Agrees, Agrees, open, open, open, open, open]);
    assert_eq!(outcomes(&dim, &doubted(1e-5))[..4], [Differs, Differs, open, open]);
    // with events enough to be expected it is no longer in doubt
    assert_eq!(outcomes(&dim, &doubted(1e-3))[..4], [Differs; 4]);
    let why = compare(&doubted(1e-5), &dim, &Criterion::default(), &[]).rows[2].reason.clone().unwrap();
    assert!(why.contains("lamps") && why.contains("10 events"), "{why}");
    // a doubt that no number of paths dispels speaks for itself
    let said = compare(&doubted(0.0), &dim, &Criterion::default(), &[]).rows[3].reason.clone().unwrap();
    assert!(said.ends_with(": lamps"), "{said}");
}

/// Two or three replicates that agree bit for bit may do so by chance; equal values still agree.
#[test]
fn few_replicates_that_agree_prove_nothing() {
    let tied = |value: f64, replicates: u64| {
        let mut s = series(0.0);
        let all = s.functionals.iter_mut().flat_map(|f| f.made_of(0));
        all.for_each(|e| *e = Estimate { mean: e.mean * value, replicates, ..*e });
        s
    };
    for replicates in [2, 3, 8, 15] {
        assert_eq!(outcome_of(&tied(1.0, replicates), &tied(1.1, replicates)), Outcome::Inconclusive);
        assert_eq!(outcome_of(&tied(1.0, replicates), &series(0.0)), Outcome::Agrees);
    }
    assert_eq!(outcome_of(&tied(1.0, 16), &tied(1.1, 16)), Outcome::Differs);
}
