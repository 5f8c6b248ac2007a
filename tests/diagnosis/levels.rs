//! How often what is right is called wrong, and whether a bias of the promised size is seen.

use super::*;

/// Every renderer of this program that is right.
fn right_renderers(scene: &Scene, seed: u64) -> Vec<(String, Pictures)> {
    let base = settings(64, seed);
    let with = |technique, sampling| Settings { technique, sampling, ..base.clone() };
    // whoever does not see all light says so, and is no right renderer of the scene
    let terms = |e, s: &Settings| {
        let render = by_rays::terms(scene, e, s, Progress::NONE);
        render.series.unsampled.is_empty().then(|| Pictures::of(&render, SIZE))
    };
    let mut all: Vec<(String, Option<Pictures>)> = vec![];
    for e in [
        Estimator::Prefix,
        Estimator::Single,
        Estimator::Light,
        Estimator::Bidirectional,
        Estimator::Branching { children: 2 },
    ] {
        let s = if e == (Estimator::Branching { children: 2 }) {
            Settings { spp: 8, ..base.clone() }
        } else {
            base.clone()
        };
        all.push((e.to_string(), terms(e, &s)));
    }
    for t in [Technique::Scatter, Technique::Connect, Technique::Power] {
        all.push((format!("prefix, {t}"), terms(Estimator::Prefix, &with(t, Sampling::Bsdf))));
    }
    all.push(("uniform directions".into(), terms(Estimator::Prefix, &with(Technique::Mis, Sampling::Uniform))));
    let albedo = Settings { roulette: Roulette::Albedo { from: 2 }, ..base.clone() };
    all.push(("roulette".into(), terms(Estimator::Prefix, &albedo)));
    let path = by_rays::path(scene, &base, Progress::NONE);
    all.push(("path tracer".into(), Some(Pictures::of(&path, SIZE))));
    all.into_iter().filter_map(|(name, p)| Some((name, p?))).collect()
}

#[test]
fn right_renderers_are_called_correct() {
    let mut account = ledger::open("right_renderers_are_called_correct", 0);
    for stage in [Stage::CORNELL, Stage::GLASS_BALL] {
        let bench = Bench::new(stage, 1024);
        for (name, pictures) in right_renderers(&bench.scene, account.seed()) {
            for suspect in [pictures.clone(), without_errors(pictures)] {
                let d = bench.judge(&suspect, None, account.spend(1));
                // a term of rare paths may be too noisy for a decision, and then it is said
                let noisy = !d.undecided.is_empty() || d.visible > 0.2;
                let open = d.verdict == Conclusion::Undecided && noisy;
                assert!(
                    d.verdict == Conclusion::Correct || open,
                    "{} by {name}: {} {:?} {:?}",
                    stage.label,
                    d.worst,
                    d.suspects,
                    d.limits
                );
                assert!(d.visible < 0.5, "{}: {}", name, d.visible);
            }
        }
    }
}

/// P(B(n, p) ≥ k).
pub(super) fn upper_tail(n: u64, p: f64, k: u64) -> f64 {
    use statrs::distribution::{Binomial, DiscreteCDF};
    if k == 0 { 1.0 } else { Binomial::new(p, n).unwrap().sf(k - 1) }
}

#[test]
fn false_alarms_keep_their_level() {
    let mut account = ledger::open("false_alarms_keep_their_level", 0);
    let bench = Bench::new(Stage::CORNELL, 1024);
    let (runs, alpha) = (150u64, 0.05);
    for errors in [true, false] {
        let wrong = (0..runs).filter(|i| {
            let seed = account.seed().wrapping_add(*i);
            let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(32, seed), Progress::NONE);
            let suspect = Pictures::of(&render, SIZE);
            let suspect = if errors { suspect } else { without_errors(suspect) };
            bench.judge(&suspect, None, alpha).p < alpha
        });
        let wrong = wrong.count() as u64;
        let p = upper_tail(runs, alpha, wrong);
        assert!(p > account.spend(1), "{wrong} false alarms in {runs} runs at {alpha} (errors {errors})");
    }
}

#[test]
fn a_bias_of_the_size_that_is_promised_is_seen() {
    let mut account = ledger::open("a_bias_of_the_size_that_is_promised_is_seen", 0);
    let bench = Bench::new(Stage::CORNELL, 1024);
    let alpha = account.spend(1);
    let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(256, account.seed()), Progress::NONE);
    let suspect = Pictures::of(&render, SIZE);
    let d = bench.judge(&suspect, None, alpha);
    assert_eq!(d.verdict, Conclusion::Correct, "{}", d.worst);
    // twice the size that is seen with probability 0.99 lies far enough beyond for any run
    let d = bench.judge(&suspect.times(1.0 + 2.0 * d.visible), None, alpha);
    // a factor on all light may be the exposure
    assert_ne!(d.verdict, Conclusion::Correct);
    assert!(d.suspects.iter().any(|s| s.name == "exposure"), "{:?}", d.suspects);
}
