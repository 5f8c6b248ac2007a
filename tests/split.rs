//! Where samples go: separate terms by any split, and one path for all, against closed forms.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::sampling::{Start, Starts, plan};
use common::scenes::{bands, description};
use common::truth::case;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{OneTerm, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::scene::load::{self, Options};
use fredholm::stats::critical;
use fredholm::study::split::{Term, Unit, best, measure, optimal, reuse, work};
use fredholm::terms::covariance::covariance;
use fredholm::terms::scatter::Scatter;

const K: usize = 6;

/// A sphere of two bands: hits are uniform on it, whatever came before. Paths start on the first band.
struct Bands {
    rho: [f64; 2],
    e: [f64; 2],
    f: f64,
}

impl Bands {
    fn scene(&self) -> Scene {
        Scene::new(&description(&bands(1.0, &[1.0, 1.0 - 2.0 * self.f, -1.0], &self.rho, &self.e)))
    }

    fn mean(&self, of: impl Fn(usize) -> f64) -> f64 {
        self.f * of(0) + (1.0 - self.f) * of(1)
    }

    /// Cov(X_j, X_k) of the terms j, k = 1..=6 of one path.
    fn covariance(&self, j: usize, k: usize) -> f64 {
        let (j, k) = (j.min(k) as i32, j.max(k) as i32);
        let (m1, m2) = (self.mean(|i| self.rho[i]), self.mean(|i| self.rho[i].powi(2)));
        let (e1, e2) = (self.mean(|i| self.e[i]), self.mean(|i| self.e[i].powi(2)));
        let (r0, both) = (self.rho[0], self.mean(|i| self.rho[i] * self.e[i]));
        let mean = |k: i32| r0 * m1.powi(k - 1) * e1;
        let product = if j == k { e2 } else { both * m1.powi(k - j - 1) * e1 };
        r0 * r0 * m2.powi(j - 1) * product - mean(j) * mean(k)
    }

    /// 1ᵀC1 and trace C.
    fn sums(&self) -> (f64, f64) {
        let all = (1..=K).flat_map(|a| (1..=K).map(move |b| (a, b)));
        (all.map(|(a, b)| self.covariance(a, b)).sum(), (1..=K).map(|k| self.covariance(k, k)).sum())
    }

    /// The terms as they are, with the rays that this program counts: one that starts the path, and k more.
    fn terms(&self, start: f64) -> Vec<Term> {
        let term = |k: usize| Term {
            spp: 16,
            variance: if k == 0 { 0.0 } else { self.covariance(k, k) },
            std_error: 0.0,
            rays: k as f64 + start,
            seconds: 1.0,
        };
        (0..=K).map(term).collect()
    }
}

/// Light on the bright band, on the dark one, and no dependence at all.
fn cases() -> [(&'static str, Bands); 3] {
    [
        ("light on the bright part", Bands { rho: [0.9, 0.3], e: [1.0, 0.0], f: 0.5 }),
        ("light on the dark part", Bands { rho: [0.9, 0.3], e: [0.0, 1.0], f: 0.5 }),
        ("one albedo", Bands { rho: [0.6, 0.6], e: [1.0, 0.0], f: 0.1 }),
    ]
}

#[test]
fn formulae_are_those_of_the_tables() {
    let [(_, a), (_, dark), (_, c)] = cases();
    for (id, bands) in [("estimator_covariance_a", &a), ("estimator_covariance_c", &c)] {
        let case = case("variance", id);
        let cov = case.table("cov");
        for (j, k) in (1..=K).flat_map(|j| (1..=K).map(move |k| (j, k))) {
            assert!((bands.covariance(j, k) - cov[j - 1][k - 1]).abs() < 1e-14, "{id} {j} {k}");
        }
        let (reuse, separate) = bands.sums();
        assert!((reuse / case.number("var_sum_reuse") - 1.0).abs() < 1e-12);
        // the tables do not count the ray that starts a path
        let terms = &bands.terms(0.0)[1..];
        let close = |x: f64, name: &str| assert!((x / case.number(name) - 1.0).abs() < 1e-12, "{id} {name}: {x}");
        close(separate, "var_sum_separate");
        close(work(terms, &[16; K], Unit::Rays).value, "wnv_separate_equal");
        close(best(terms, Unit::Rays).value, "wnv_separate_optimal");
        close(reuse * K as f64, "wnv_reuse");
        // Cauchy and Schwarz: no split does better, and a fine one comes near
        let counts = optimal(terms, Unit::Rays, 1e6, 16);
        let fine = work(terms, &counts, Unit::Rays).value / best(terms, Unit::Rays).value;
        assert!((1.0..1.001).contains(&fine), "{fine}");
        for shift in 0..K {
            let mut other = counts.clone();
            other[shift] *= 2;
            assert!(work(terms, &other, Unit::Rays).value > best(terms, Unit::Rays).value);
        }
    }
    let ratio = |b: &Bands| b.sums().0 / b.sums().1;
    assert!((2.3..2.5).contains(&ratio(&a)) && (0.1..0.15).contains(&ratio(&dark)), "{} {}", ratio(&a), ratio(&dark));
}

/// A film of one slot holds the very numbers of that slot of the whole estimator: the equal split is `single`.
#[test]
fn one_term_is_that_term_of_single() {
    let mut d = load::scene("cornell", &Options::default()).unwrap().description;
    d.camera.size = [9, 8];
    let scene = Scene::new(&d);
    let t = SceneTransport::new(&scene);
    for technique in [Technique::Scatter, Technique::Connect, Technique::Mis] {
        let single = SingleTerm(plan(3, technique, &Roulette::Albedo { from: 2 }.after(3)));
        let amount = Amount { spp: 48, replicates: 16, key: Key::new(3, "single") };
        let all = render(&t, &scene.camera, &single, amount, Progress::NONE);
        for slot in 0..5 {
            let one = OneTerm { single: single.clone(), slot };
            let film = render(&t, &scene.camera, &one, amount, Progress::NONE);
            assert_eq!(film.rays[0], all.rays[slot], "{technique}, {slot}");
            for (p, r) in (0..72).flat_map(|p| (0..16).map(move |r| (p, r))) {
                assert_eq!(film.sum(p, r, 0), all.sum(p, r, slot), "{technique}, {slot}");
            }
            let (a, b) = (Scatter::of(&film, 0..1, None), Scatter::of(&all, slot..slot + 1, None));
            assert_eq!(a.variance(), b.variance());
        }
    }
}

#[test]
fn splits_cost_what_the_covariance_says() {
    let mut account = common::open("splits_cost_what_the_covariance_says");
    let spp = 64;
    for (name, bands) in cases() {
        let scene = bands.scene();
        let (t, starts) = (SceneTransport::new(&scene), Starts(vec![Start::On(0); 2048]));
        let plan = plan(K, Technique::Scatter, &Roulette::Never);
        let single = SingleTerm(plan.clone());
        let key = |stream: &str| Key::new(account.seed(), &format!("{name}, {stream}"));
        let terms =
            |counts: &[u32], stream| measure(&t, &starts, &single, counts, key(stream), Progress::NONE).unwrap();
        let equal = terms(&[spp; K + 1], "equal");
        let budget = equal.iter().map(|t| t.rays).sum::<f64>() * f64::from(spp);
        // the split is chosen by what a pilot measured, as in the program
        let pilot = terms(&[16; K + 1], "pilot");
        let counts = optimal(&pilot, Unit::Rays, budget, 16);
        let best_terms = terms(&counts, "optimal");
        let shared = reuse(&t, &starts, &Prefix(plan), spp, key("prefix"), Progress::NONE).unwrap();
        for (k, term) in equal.iter().enumerate() {
            assert_eq!(term.rays, k as f64 + 1.0);
            assert!(k > 0 || term.variance < 1e-12, "a path starts where it sees the same light: {}", term.variance);
        }
        assert_eq!(shared.rays, K as f64 + 1.0);

        let exact = bands.terms(1.0);
        let w = |of: &[Term]| work(of, &of.iter().map(|t| t.spp).collect::<Vec<_>>(), Unit::Rays);
        let truth = |of: &[Term]| work(&exact, &of.iter().map(|t| t.spp).collect::<Vec<_>>(), Unit::Rays).value;
        let measured = [w(&equal), w(&best_terms), shared.work(Unit::Rays), best(&pilot, Unit::Rays)];
        let truths =
            [truth(&equal), truth(&best_terms), bands.sums().0 * (K as f64 + 1.0), best(&exact, Unit::Rays).value];
        for ((what, m), truth) in ["equal", "optimal", "prefix", "predicted"].into_iter().zip(measured).zip(truths) {
            let half = critical(account.spend(1), 15.0) * m.std_error;
            let ratio = m.value / truth;
            eprintln!("{name}, {what}: {:.4} of {truth:.4}, ratio {ratio:.4} ± {:.4}", m.value, m.std_error / truth);
            assert!((m.value - truth).abs() + half <= 0.25 * truth, "{name}, {what}: {m:?}, {truth}, ± {half}");
        }
        // the optimum beats the equal split, by measurement and beyond doubt
        let (e, o) = (w(&equal), w(&best_terms));
        let half = critical(account.spend(1), 15.0) * e.std_error.hypot(o.std_error);
        assert!(o.value + half < e.value, "{name}: {o:?} {e:?}");
        // and what is left of the ideal is rounding to whole replicates
        assert!(truths[1] / truths[3] < 1.1, "{name}: {} {}", truths[1], truths[3]);
    }
}

#[test]
fn the_film_knows_the_covariance_of_its_terms() {
    let mut account = common::open("the_film_knows_the_covariance_of_its_terms");
    for (name, bands) in cases() {
        let scene = bands.scene();
        let (t, starts) = (SceneTransport::new(&scene), Starts(vec![Start::On(0); 1024]));
        let prefix = Prefix(plan(K, Technique::Scatter, &Roulette::Never));
        let amount = Amount { spp: 128, replicates: 16, key: Key::new(account.seed(), name) };
        let film = render(&t, &starts, &prefix, amount, Progress::NONE);
        let c = covariance(&film);
        // the sum over all entries is the variance of the sum, and the diagonal that of every term: identities
        let all = Scatter::of(&film, 0..K + 2, None);
        assert!((c.sum().0 / (128.0 * all.variance()) - 1.0).abs() < 1e-10);
        assert!((c.sum().1 / (128.0 * all.variance_error()) - 1.0).abs() < 1e-9);
        for k in 1..=K {
            let one = Scatter::of(&film, k..k + 1, None).variance();
            assert!((c.entry(k, k) / (128.0 * one) - 1.0).abs() < 1e-10);
        }
        for (a, b) in (1..=K).flat_map(|a| (a..=K).map(move |b| (a, b))) {
            let truth = bands.covariance(a, b);
            let half = critical(account.spend(1), 15.0) * c.std_error(a, b);
            assert!((c.entry(a, b) - truth).abs() <= half, "{name}: C({a}, {b}) = {}, not {truth}", c.entry(a, b));
            let scale = (bands.covariance(a, a) * bands.covariance(b, b)).sqrt();
            assert!(half < 0.5 * scale, "{name}: C({a}, {b}) is known to {half} only, of {scale}");
        }
    }
}
