//! `fredholm check scene FILE`: compares a scene with the values that its file promises in `[expect]`.
//!
//! The values are known without error. Every estimator renders batches until an anytime-valid test has decided for each value
//! whether it is right, or until the time is over. All comparisons share α.

use super::common::Common;
use crate::cli::base::{Ending, Failure, names, note, usage};
use crate::cli::choices::TECHNIQUES;
use crate::cli::options::{HOW, WHAT, duration, one_of, probability};
use crate::cli::preflight;
use crate::cli::session::Session;
use clap::Args;
use fredholm::engine::Settings;
use fredholm::engine::batches::Side;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::text::grid::Grid;
use fredholm::report::text::number::{outcome, significant};
use fredholm::report::text::prose::{counted, listed, wrapped};
use fredholm::report::text::summary::{self, Summary};
use fredholm::scene::{Expect, Scene};
use fredholm::stats::{Criterion, Detector, Finding, Outcome};
use fredholm::terms::{Estimate, Functional};
use glam::DVec3;
use std::time::Duration;

/// Below `check scene --help`.
pub(super) const HELP: &str = "Examples:
  fredholm check scene scenes/furnace.toml
  fredholm check scene mine.toml --technique scatter

The table [expect] of a scene file holds values that you know, for example from a closed form: `terms`, the image means of T^k E; \
`total`, the image mean of the whole series; `gamma`, the constant ratio of consecutive terms, which gives the terms beyond the last \
one; `tolerance`, the margin δ as a fraction of a value; `source`, where the values come from. scenes/README.md describes the table.

The estimators `single` and `prefix` and the path tracer are tested until every value is decided. A value is confirmed if the \
difference is proved smaller than δ, and wrong if a difference is proved. Exit code 1: a value is wrong, or was not decided in time.";

/// Largest width and height of the image of a batch: a mean needs samples, not pixels.
const SMALL: u32 = 64;

/// Arguments of `check scene`.
#[derive(Clone, Debug, Args)]
pub struct OfScene {
    /// Built-in scene or .toml with a table [expect]
    #[arg(value_name = "SCENE", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    scene: String,
    /// Time for each estimator: 30s, 5m
    ///
    /// A test that has decided ends before.
    #[arg(long, value_name = "TIME", default_value = "20s", value_parser = duration, help_heading = WHAT)]
    time: Duration,
    /// Light: scatter, connect, mis, mis-power
    ///
    /// The technique by which paths find light.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Technique>(TECHNIQUES))]
    technique: Technique,
    /// Probability of a false alarm
    ///
    /// The probability that any value is called wrong although all are right. All estimators share it.
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = probability, help_heading = HOW)]
    alpha: f64,
    #[command(flatten)]
    common: Common,
}

/// One estimator with what was found.
struct Tested {
    name: &'static str,
    batches: u64,
    non_finite: u64,
    findings: Vec<Finding>,
}

/// Tests every value with every estimator.
pub(super) fn run(args: &OfScene) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.common.shared, args.common.seed)?;
    let loaded = args.common.load(&mut session, &args.scene, SMALL)?;
    let Some(expect) = &loaded.description.expect else {
        let what =
            format!("the scene `{}` has no table [expect], so there is nothing to check", loaded.description.name);
        let help = "add the values that you know: [expect] terms = [1, 0.5, 0.25], source = \"…\"; scenes/README.md describes it";
        return Err(Failure::input(&format!("error: {what}\nhelp: {help}")));
    };
    if let Some(option) = args.common.shared.changes.first() {
        let help = format!("leave {option} out, or change the file and its values");
        return Err(usage("the values of [expect] are those of the scene without changes", &help));
    }
    let [w, h] = loaded.description.camera.size;
    let spp = 4096u32.div_ceil(w * h);
    let (sides, paths) = (sides(args, expect, spp), u64::from(spp * w * h));
    for (_, side) in &sides {
        preflight::can_be_sampled(&loaded.scene, side.estimator, &side.settings)?;
    }
    session.make_folder(&format!("{}-check", loaded.description.name))?;
    let tested: Vec<Tested> = sides.iter().map(|s| test(&session, args, &loaded.scene, s, expect)).collect();
    session.clear();
    let all = || tested.iter().flat_map(|t| &t.findings);
    let verdict = |t: &Tested, f: &Finding| summary::VerdictRecord {
        name: format!("{}: {} ({})", t.name, f.name, f.functional),
        effect: f.effect,
        interval: f.interval,
        p: f.p,
        min_detectable: f.min_detectable,
        outcome: f.outcome,
    };
    let record = Summary {
        max_bounces: expect.terms.len().saturating_sub(1),
        verdicts: tested.iter().flat_map(|t| t.findings.iter().map(move |f| verdict(t, f))).collect(),
        files: names(["summary.json"]),
        ..session.record()
    };
    session.sign(&record)?;
    let confirmed = all().all(|f| f.outcome == Outcome::Agrees);
    session.show(&record, || {
        let tables = [table(&tested, expect)];
        let batches: Vec<String> =
            tested.iter().map(|t| format!("{}: {}", t.name, counted((t.batches * paths) as usize, "path"))).collect();
        session.text(&answer(&tested, args, expect), &tables, &[batches.join("\n")], &record.files)
    })?;
    Ok(session.ending(!confirmed))
}

/// The estimators: each term by its own paths, all from one path, and the path tracer for the whole series.
fn sides(args: &OfScene, expect: &Expect, spp: u32) -> Vec<(&'static str, Side)> {
    let last = expect.terms.len().saturating_sub(1);
    let usual = Roulette::Albedo { from: 2 };
    let settings = Settings {
        spp,
        seed: args.common.seed,
        max_bounces: last,
        technique: args.technique,
        roulette: usual.clone().after(last),
        path_roulette: usual,
        ..Settings::default()
    };
    let side = |estimator| Side { estimator, settings: settings.clone() };
    let mut all = vec![("single", side(Some(Estimator::Single))), ("prefix", side(Some(Estimator::Prefix)))];
    if expect.total().is_some() {
        all.push(("path tracer", side(None)));
    }
    all
}

/// The expected values as a result without error. The terms beyond the last one are known if the whole series is.
fn known(expect: &Expect, terms: bool) -> Functional {
    let exact = |x: f64| Estimate::exact(DVec3::splat(x));
    let sum: f64 = expect.terms.iter().sum();
    let total = expect.total();
    Functional {
        name: "image".into(),
        terms: if terms { expect.terms.iter().map(|&x| exact(x)).collect() } else { vec![] },
        tail: total.map_or(Estimate::NONE, |total| exact(total - sum)),
        sum: exact(sum),
        total: total.map_or(Estimate::NONE, exact),
    }
}

/// Renders batches until every value is decided, the time is over, or Ctrl-C is pressed.
fn test(
    session: &Session,
    args: &OfScene,
    scene: &Scene,
    (name, side): &(&'static str, Side),
    expect: &Expect,
) -> Tested {
    let count = 2.0 + f64::from(u8::from(expect.total().is_some()));
    let criterion = Criterion { of_term: expect.tolerance, alpha: args.alpha / count, ..Criterion::default() };
    let mut detector = Detector::against_finished(criterion).doubting(&side.limits(scene));
    let second = [known(expect, side.estimator.is_some())];
    if !session.quiet() {
        note(&format!("{name}: at most {} s", args.time.as_secs()));
    }
    let started = std::time::Instant::now();
    let mut non_finite = 0;
    for i in 0.. {
        let mut batch = side.batch(scene, name, i);
        non_finite += batch.non_finite;
        batch.functionals.truncate(1);
        detector.push(&batch.functionals, &second);
        let decided = i >= 7 && detector.findings().iter().all(|f| judged(f) != Outcome::Inconclusive);
        if decided || session.stopped() || started.elapsed() >= args.time {
            break;
        }
    }
    // when the time is over, a proved difference of unknown size counts as one
    let last = |f: Finding| match judged(&f) {
        Outcome::Inconclusive => f,
        outcome => Finding { outcome, ..f },
    };
    Tested {
        name,
        batches: detector.batches(),
        non_finite,
        findings: detector.findings().into_iter().map(last).collect(),
    }
}

/// Confirmed if the difference is proved smaller than δ, wrong if it is proved larger.
fn judged(f: &Finding) -> Outcome {
    let (low, high) = f.interval;
    match () {
        () if f.reason.is_some() => Outcome::Inconclusive,
        () if -f.delta <= low && high <= f.delta => Outcome::Agrees,
        () if f.outcome == Outcome::Differs && (low > f.delta || high < -f.delta) => Outcome::Differs,
        () => Outcome::Inconclusive,
    }
}

fn answer(tested: &[Tested], args: &OfScene, expect: &Expect) -> String {
    let all = || tested.iter().flat_map(|t| t.findings.iter().map(move |f| (t, f)));
    let with = |o: Outcome| {
        let named: Vec<String> =
            all().filter(|(_, f)| f.outcome == o).map(|(t, f)| format!("{} ({})", f.name, t.name)).collect();
        named
    };
    let (wrong, open) = (with(Outcome::Differs), with(Outcome::Inconclusive));
    let margin = significant(100.0 * expect.tolerance, 2);
    let mut lines = vec![];
    if !wrong.is_empty() {
        let what = if wrong.len() == 1 { "is not what [expect] says" } else { "are not what [expect] says" };
        lines.push(format!(
            "{} {what}. If all values were right, this would happen with a probability of at most {}.",
            listed(&wrong),
            args.alpha
        ));
    }
    if !open.is_empty() {
        lines.push(format!("Not decided in time: {}. Give more --time, or a larger tolerance.", listed(&open)));
    }
    if wrong.is_empty() && open.is_empty() {
        lines.push(format!(
            "All {} of [expect] are confirmed: every difference is proved smaller than {margin} % of the value.",
            counted(expect.terms.len() + usize::from(expect.total().is_some()), "value")
        ));
    }
    let lost: u64 = tested.iter().map(|t| t.non_finite).sum();
    if lost > 0 {
        lines.push(format!("Warning: {} not finite; they are left in the sums.", counted(lost as usize, "sample is")));
    }
    if let Some(reason) = all().find_map(|(_, f)| f.reason.as_deref().filter(|_| f.outcome == Outcome::Inconclusive)) {
        lines.push(format!("The reason: {reason}."));
    }
    wrapped(&lines.join("\n"))
}

/// One line per value and estimator: expected, the difference found with its interval, the verdict.
fn table(tested: &[Tested], expect: &Expect) -> String {
    let sentence = format!(
        "Expected image means ({}), and the difference found: the interval holds for all values at once with a probability of at \
         least 1 − α.",
        expect.source
    );
    let mut grid =
        Grid::new(wrapped(&sentence), ["value", "estimator", "expected", "difference", "interval", "verdict"]);
    for t in tested {
        for f in &t.findings {
            let number = |x: f64| significant(x, 2);
            grid.push([
                f.name.clone(),
                t.name.into(),
                expected(&f.name, expect).map_or("–".into(), |x| significant(x, 5)),
                number(f.effect),
                format!("[{}, {}]", number(f.interval.0), number(f.interval.1)),
                outcome(f.outcome).into(),
            ]);
        }
    }
    grid.to_string()
}

/// The expected value by the name of a finding.
fn expected(name: &str, expect: &Expect) -> Option<f64> {
    let sum: f64 = expect.terms.iter().sum();
    match name {
        "sum" => Some(sum),
        "total" => expect.total(),
        "tail" => Some(expect.total()? - sum),
        term => expect.terms.get(term.strip_prefix('T')?.parse::<usize>().ok()?).copied(),
    }
}
