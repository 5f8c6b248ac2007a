//! `--over spp`: one render for every combination of estimator, technique, schedule and points. Variance and squared error
//! against samples per pixel are read from the film while it fills.

use super::args::{Sweep, estimator};
use super::reference;
use crate::cli::base::{Ending, Failure, names, usage};
use crate::cli::choices::{CHECKED, Choices, POINTS, TECHNIQUES, names as names_of};
use crate::cli::options::{number, values};
use crate::cli::session::Session;
use crate::cli::suggest::wrong_value;
use crate::cli::{notes, preflight};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Begins, Estimator};
use fredholm::engine::passes::{Look, Watch};
use fredholm::estimator::Technique;
use fredholm::estimator::render::Amount;
use fredholm::math::Points;
use fredholm::report::figures::sweep::fall::{self, Fall};
use fredholm::report::figures::sweep::fall_answer;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::scene::Scene;
use fredholm::stats::Evidence;
use fredholm::study::convergence::{Recorder, Reference};
use fredholm::study::roulette::{self, Aim, Schedule};
use fredholm::terms::Series;
use std::str::FromStr;

/// Replicates of a film. They are also the first number of samples at which a variance is known.
const REPLICATES: u32 = Amount::REPLICATES;

/// One render.
struct Case {
    label: String,
    /// None: the path tracer.
    estimator: Option<Estimator>,
    settings: Settings,
    /// The quantity for which the best schedule must first be found; None if the schedule is given.
    optimal: Option<Aim>,
}

/// Renders every combination once.
pub fn run(args: &Sweep) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.shared, args.frame.seed)?;
    let at = counts(args)?;
    let spp = args.frame.spp.or(at.last().copied()).unwrap_or(256);
    if spp < 3 {
        return Err(usage(&format!("{spp} samples leave no error of a variance"), "choose at least --spp 32"));
    }
    let mut cases = cases(args, spp)?;
    let opened = session.open(&args.frame.scene, &args.shared.changes, args.frame.size)?;
    let (description, scene) = (opened.description, opened.scene.select_lights(args.lights));
    for case in &cases {
        preflight::can_be_sampled(&scene, case.estimator, &case.settings)?;
    }
    let planned = reference::plan(args, &scene, &description, &cases[0].settings)?;
    session.make_folder(&format!("{}-sweep-spp", description.name))?;
    for case in &mut cases {
        let Some(aim) = case.optimal else { continue };
        if let Some(best) = roulette::optimal(&scene, &case.settings, aim, session.progress()) {
            (case.settings.roulette, case.settings.path_roulette) = (best.roulette.clone(), best.roulette);
        }
    }
    let reference = planned.map(|planned| planned.have(&scene, session.progress()));
    let (falls, series) = render(&session, &scene, &cases, reference.as_ref(), &at);
    if falls.is_empty() {
        return Ok(session.nothing_to_save(""));
    }
    write_atomically(&session.folder.join("sweep.csv"), fall::csv(&falls).as_bytes())?;
    fall::draw(&falls, "How the noise falls", &session.caption())?.write(&session.folder, "variance")?;
    let record = Summary {
        spp: spp.into(),
        max_bounces: cases[0].settings.max_bounces,
        series,
        files: names(["summary.json", "sweep.csv", "variance.png", "variance.svg"]),
        ..session.record()
    };
    session.sign(&record)?;
    session.show(&record, || people(&session, &falls, &record, reference.as_ref()))?;
    Ok(session.ending(false))
}

/// Renders every case and records the noise while its film fills.
fn render(
    session: &Session,
    scene: &Scene,
    cases: &[Case],
    reference: Option<&Reference>,
    at: &[u32],
) -> (Vec<Fall>, Vec<Series>) {
    let pixels = scene.camera.size[0] as usize * scene.camera.size[1] as usize;
    let (mut falls, mut series) = (vec![], vec![]);
    for case in cases {
        if session.stopped() {
            break;
        }
        let mut recorder = Recorder::new(reference, at.to_vec());
        let progress = session.progress().named(&case.label);
        let look: Look<'_> = &mut |film| recorder.look(film);
        let result = by_rays::watched(
            scene,
            case.estimator,
            &case.settings,
            progress,
            Watch { look: Some(look), ..Watch::NONE },
        );
        let tail = !result.series.image().tail.is_none();
        let stands = recorder.stands();
        if !stands.is_empty() {
            falls.push(Fall::new(case.label.clone(), pixels, stands, tail, result.series.variance));
            series.push(result.series);
        }
    }
    (falls, series)
}

/// The values of a list, each with its text. Without a list: the default value and its label.
fn listed<T>(
    (option, known): (&str, Choices),
    given: Option<&String>,
    usual: (&str, T),
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<Vec<(String, T)>, Failure> {
    let Some(list) = given else { return Ok(vec![(usual.0.into(), usual.1)]) };
    let one = |text: String| match parse(&text) {
        Ok(value) => Ok((text, value)),
        Err(why) => Err(wrong_value(option, &text, &why, &names_of(known))),
    };
    values(list).into_iter().map(one).collect()
}

/// Every combination of the lists.
fn cases(args: &Sweep, spp: u32) -> Result<Vec<Case>, Failure> {
    let by_name = |s: &str| estimator(s, args.branching);
    let estimators =
        listed(("--estimator", CHECKED), args.estimators.as_ref(), ("prefix", Some(Estimator::Prefix)), by_name)?;
    let techniques =
        listed(("--technique", TECHNIQUES), args.techniques.as_ref(), ("", Technique::Mis), Technique::from_str)?;
    let schedules = listed(("--roulette", &[]), args.schedules.as_ref(), ("", None), |s| s.parse().map(Some))?;
    let points = listed(("--points", POINTS), args.spreads.as_ref(), ("", Points::Independent), Points::from_str)?;
    let mut cases: Vec<Case> = vec![];
    for (e, estimator) in &estimators {
        for (t, technique) in &techniques {
            // a walk from the light does not use a technique
            if estimator.is_some_and(|e| e.begins() == Begins::AtLight) && *technique != techniques[0].1 {
                continue;
            }
            for (r, schedule) in &schedules {
                for (p, points) in &points {
                    let words = [(e, true), (t, techniques.len() > 1), (r, schedules.len() > 1), (p, !p.is_empty())];
                    let words: Vec<&str> = words.iter().filter(|w| w.1).map(|w| w.0.as_str()).collect();
                    let mut settings = Settings { spp, points: *points, technique: *technique, ..args.settings(spp) };
                    preflight::needs_no_guide(schedule.as_ref())?;
                    if let Some(given) = schedule.as_ref().and_then(Schedule::given) {
                        (settings.roulette, settings.path_roulette) = (given.clone(), given);
                    }
                    let optimal = schedule.as_ref().and_then(Schedule::aim);
                    cases.push(Case { label: words.join(" "), estimator: *estimator, settings, optimal });
                }
            }
        }
    }
    for (i, case) in cases.iter().enumerate() {
        if cases[..i].iter().any(|c| c.label == case.label) {
            return Err(usage(&format!("`{}` stands twice in the lists", case.label), "name every value once"));
        }
    }
    Ok(cases)
}

/// The numbers of samples at which the noise is recorded. Empty: after every doubling.
fn counts(args: &Sweep) -> Result<Vec<u32>, Failure> {
    let Some(list) = &args.values else { return Ok(vec![]) };
    let of =
        |text: &String| number(text, 1 << 24).map_err(|why| usage(&why, "values of --over spp are such as 16,64,256"));
    let mut all: Vec<u32> = values(list).iter().map(of).collect::<Result<_, _>>()?;
    all.sort_unstable();
    all.dedup();
    if let Some(n) = all.iter().find(|&&n| n % REPLICATES != 0) {
        let what = format!("{n} samples are not the same number for each of the {REPLICATES} replicates");
        return Err(usage(&what, "values of --over spp are multiples of 16, such as 16,64,256"));
    }
    if let Some(&n) = all.iter().find(|&&n| args.frame.spp.is_some_and(|spp| n > spp)) {
        return Err(usage(&format!("{n} samples are more than --spp renders"), "leave --spp out, or raise it"));
    }
    Ok(all)
}

fn people(session: &Session, falls: &[Fall], record: &Summary, reference: Option<&Reference>) -> String {
    let mut head = format!(
        "{}\nseed {}, {}×{} pixels, k ≤ {}, {} replicates; V: variance of the mean of n samples",
        record.command,
        record.seed,
        record.width,
        record.height,
        record.max_bounces,
        record.spp.min(REPLICATES.into())
    );
    if let Some(r) = reference {
        head += &format!("\nreference: {}; its variance is subtracted", r.label);
    }
    if falls.iter().all(|f| f.stands.len() < 2) {
        head += "\nnote: one number of samples has no slope; choose at least --spp 32";
    }
    for (fall, series) in falls.iter().zip(&record.series) {
        if let Some(reason) = Evidence::of_variance(series.variance).no_error {
            head += &format!("\n{}: {reason};\n  its V(n) of the tail and of all has no meaning", fall.label);
        }
    }
    let table = fall_answer::small_table(falls, reference.map(|r| r.label.as_str()));
    let tables = [table, notes::not_finite(&record.series)];
    session.text(&fall_answer::answer(falls), &tables, &[head, fall::table(falls)], &record.files)
}
