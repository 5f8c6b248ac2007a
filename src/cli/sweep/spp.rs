//! `fredholm sweep [SCENE] --over spp`: one render for every combination of estimator, technique, schedule and points; variance
//! and squared error against samples per pixel, read off the film as it fills.

use super::args::{self, EstimatorName, Schedule, WorldName};
use super::progress::Bar;
use super::sweep::{number, usage, values};
use super::{Ending, Failure, output, preflight, solve};
use crate::cli::open::{self, Opened};
use clap::{Args, ValueEnum};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::engine::known::unsampled::unsampled;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::report::sweep::fall::{self, Fall};
use fredholm::report::typeset::Caption;
use fredholm::report::{exr, summary, write_atomically};
use fredholm::scene::{Description, Scene};
use fredholm::stats::Evidence;
use fredholm::study::convergence::{Recorder, Reference};
use fredholm::study::roulette;
use fredholm::study::stages::reference_seed;
use fredholm::terms::TermImage;
use std::path::Path;
use std::time::Instant;

/// Replicates of a film, and the first number of samples that can be looked at.
const REPLICATES: u32 = 16;

/// Options of which a sweep over spp takes lists. They stand in for those of the same name that take one value.
#[derive(Clone, Debug, Args)]
pub struct Several {
    /// Estimator of the terms: prefix, single, light, … [default: prefix]
    ///
    /// With --over spp a list, in which `path` is the full path tracer.
    #[arg(long = "estimator", value_name = "NAME,…", verbatim_doc_comment)]
    pub estimators: Option<String>,
    /// How light is found: scatter, connect, mis, mis-power [default: mis]
    ///
    /// With --over spp a list.
    #[arg(long = "technique", value_name = "NAME,…", verbatim_doc_comment)]
    pub techniques: Option<String>,
    /// Russian roulette: none, lecture, constant:Q@V, … (all: series --help)
    ///
    /// With --over spp a list. [default: none for k ≤ K, then albedo]
    #[arg(long = "roulette", value_name = "SCHEDULE,…", verbatim_doc_comment)]
    pub schedules: Option<String>,
    /// How samples lie in a pixel: independent, sobol [default: independent]
    ///
    /// With --over spp a list.
    #[arg(long = "points", value_name = "NAME,…", verbatim_doc_comment)]
    pub spreads: Option<String>,
}

/// Makes room for the options of [`Several`]: those of every other command with the same name step aside.
pub fn several_values(command: clap::Command) -> clap::Command {
    let aside = [("estimator", "one-estimator"), ("technique", "one-technique"), ("roulette", "one-roulette")];
    let aside = aside.into_iter().chain([("points", "one-points")]);
    aside.fold(command, |c, (id, long)| c.mut_arg(id, |arg| arg.long(long).hide(true)))
}

/// The arguments of a sweep over anything else: one value of each.
pub fn one_of_each(args: &args::Sweep) -> Result<args::Sweep, Failure> {
    fn one<T>(
        name: &str,
        list: Option<&String>,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, Failure> {
        let Some(list) = list else { return Ok(None) };
        let all = values(list);
        if all.len() > 1 {
            let what = format!("{name} takes one value here, not `{list}`");
            return Err(usage(&what, "lists are for --over spp; elsewhere the list is --values"));
        }
        parse(list).map(Some).map_err(|why| usage(&why, &format!("give {name} one of them")))
    }
    let (several, mut args) = (&args.several, args.clone());
    args.run.estimator = one("--estimator", several.estimators.as_ref(), |s| match name(s)? {
        Some(name) => Ok(name),
        None => Err("`path` has one value for all terms, and is for --over spp".into()),
    })?;
    if let Some(t) = one("--technique", several.techniques.as_ref(), args::technique)? {
        args.run.technique = t;
    }
    args.run.roulette = one("--roulette", several.schedules.as_ref(), args::schedule)?;
    if let Some(p) = one("--points", several.spreads.as_ref(), args::points)? {
        args.run.points = p;
    }
    Ok(args)
}

/// An estimator of the terms, or none for the path tracer.
fn name(text: &str) -> Result<Option<EstimatorName>, String> {
    if text == "path" {
        return Ok(None);
    }
    let wrong = |_| format!("`{text}` is none of prefix, single, branching, light, bidirectional, path");
    EstimatorName::from_str(text, false).map(Some).map_err(wrong)
}

/// One render.
struct Case {
    label: String,
    /// None: the path tracer.
    estimator: Option<Estimator>,
    settings: Settings,
    /// The schedule is yet to be found.
    optimal: bool,
}

/// Every combination of the lists.
fn cases(args: &args::Sweep, spp: u32) -> Result<Vec<Case>, Failure> {
    let (run, several) = (&args.run, &args.several);
    let max_bounces = usize::from(run.max_bounces.unwrap_or(8));
    let list = |given: &Option<String>| given.as_deref().map_or(vec![], values);
    fn parsed<T>(all: Vec<String>, parse: impl Fn(&str) -> Result<T, String>) -> Result<Vec<(String, T)>, Failure> {
        let one =
            |text: String| parse(&text).map(|v| (text, v)).map_err(|why| usage(&why, "separate values by commas"));
        all.into_iter().map(one).collect()
    }
    let mut estimators = parsed(list(&several.estimators), name)?;
    if estimators.is_empty() {
        estimators.push(("prefix".into(), Some(EstimatorName::Prefix)));
    }
    let mut techniques = parsed(list(&several.techniques), args::technique)?;
    if techniques.is_empty() {
        techniques.push((String::new(), Technique::Mis));
    }
    let mut schedules = parsed(list(&several.schedules), |s| args::schedule(s).map(Some))?;
    if schedules.is_empty() {
        schedules.push((String::new(), None));
    }
    let mut points = parsed(list(&several.spreads), args::points)?;
    if points.is_empty() {
        points.push((String::new(), Points::Independent));
    }
    let end = Roulette::Albedo { from: 2 };
    let given = |r: &Option<Schedule>| solve::given(r.as_ref());
    let mut cases: Vec<Case> = vec![];
    for (e, estimator) in &estimators {
        let estimator = estimator.map(|name| solve::estimator(name, run.branching));
        for (t, technique) in &techniques {
            // a walk from the light has no use for a technique
            if estimator == Some(Estimator::Light) && *technique != techniques[0].1 {
                continue;
            }
            for (r, roulette) in &schedules {
                for (p, points) in &points {
                    let words = [(e, true), (t, techniques.len() > 1), (r, schedules.len() > 1), (p, !p.is_empty())];
                    let words: Vec<&str> = words.iter().filter(|w| w.1).map(|w| w.0.as_str()).collect();
                    let settings = Settings {
                        spp,
                        seed: run.seed,
                        points: *points,
                        max_bounces,
                        technique: *technique,
                        sampling: run.sampling,
                        roulette: given(roulette).unwrap_or(end.clone().after(max_bounces)),
                        path_roulette: given(roulette).unwrap_or(end.clone()),
                        ..Settings::default()
                    };
                    let optimal = *roulette == Some(Schedule::Optimal);
                    cases.push(Case { label: words.join(" "), estimator, settings, optimal });
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

/// The numbers of samples to look at; none: after every doubling.
fn counts(args: &args::Sweep) -> Result<Vec<u32>, Failure> {
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
    if let Some(&n) = all.iter().find(|&&n| args.run.spp.is_some_and(|spp| n > spp)) {
        return Err(usage(&format!("{n} samples are more than --spp renders"), "leave --spp out, or raise it"));
    }
    Ok(all)
}

/// Renders every combination once.
pub fn run(args: &args::Sweep) -> Result<Ending, Failure> {
    let (run, started) = (&args.run, Instant::now());
    let at = counts(args)?;
    let spp = run.spp.or(at.last().copied()).unwrap_or(256);
    if spp < 3 {
        return Err(usage(&format!("{spp} samples leave no error of a variance"), "choose at least --spp 32"));
    }
    let mut cases = cases(args, spp)?;
    let Opened { command, description, scene, hash } = open::run(run)?;
    for case in &cases {
        let of_terms: Vec<Estimator> = case.estimator.into_iter().collect();
        let world = if of_terms.is_empty() { WorldName::Path } else { WorldName::Terms };
        of_terms.iter().try_for_each(|&e| preflight::tree_can_be_walked(e, &case.settings, description.camera.size))?;
        preflight::fits_in_memory(&case.settings, description.camera.size)?;
        preflight::light_is_seen(&scene, &of_terms, &case.settings, &[world])?;
        preflight::light_is_lost(&scene, &case.settings, &[world])?;
    }
    let planned = plan_reference(args, &scene, &description, &cases[0].settings)?;
    let folder =
        output::folder(run.shared.out.as_deref(), &format!("{}-spp", description.name), &command, run.shared.force)?;
    let bar = Bar::plain(run.shared.quiet);
    let progress = bar.progress();
    let stopped = || progress.stopped();
    for case in cases.iter_mut().filter(|c| c.optimal) {
        if let Some(best) = roulette::optimal(&scene, &case.settings, progress) {
            (case.settings.roulette, case.settings.path_roulette) = (best.roulette.clone(), best.roulette);
        }
    }
    let reference = match planned {
        Some(Planned::Read(reference)) => Some(*reference),
        Some(Planned::Render(estimator, settings)) => {
            let result = by_rays::terms(&scene, estimator, &settings, progress.named("reference"));
            let mut reference = Reference::from(result);
            reference.label = format!("{}, {} spp, seed {}", reference.label, settings.spp, settings.seed);
            Some(reference)
        }
        None => None,
    };

    let pixels = description.camera.size[0] as usize * description.camera.size[1] as usize;
    let (mut falls, mut series) = (vec![], vec![]);
    for case in &cases {
        if stopped() {
            break;
        }
        let mut recorder = Recorder::new(reference.as_ref(), at.clone());
        let progress = progress.named(&case.label);
        let result =
            by_rays::watched(&scene, case.estimator, &case.settings, progress, Some(&mut |film| recorder.look(film)));
        let tail = !result.series.image().tail.is_none();
        let stands = recorder.stands();
        if !stands.is_empty() {
            falls.push(Fall::new(case.label.clone(), pixels, stands, tail, result.series.variance));
            series.push(result.series);
        }
    }
    bar.finish();
    if falls.is_empty() {
        super::note("nothing to save yet");
        let _ = std::fs::remove_dir(&folder); // only if it is empty
        return Ok(Ending::Interrupted);
    }

    let mut record = summary::Summary {
        command: command.clone(),
        scene: description.name.clone(),
        scene_hash: hash,
        seed: run.seed,
        spp: spp.into(),
        max_bounces: cases[0].settings.max_bounces,
        threads: rayon::current_num_threads(),
        seconds: started.elapsed().as_secs_f64(),
        width: description.camera.size[0] as usize,
        height: description.camera.size[1] as usize,
        series,
        ..summary::Summary::default()
    };
    write(&folder, &falls, &mut record)?;
    if run.shared.json {
        super::print(&serde_json::to_string_pretty(&record)?)?;
    } else {
        super::print(&people(&falls, &record, reference.as_ref(), &folder))?;
    }
    Ok(if stopped() { Ending::Interrupted } else { Ending::Ok })
}

fn write(folder: &Path, falls: &[Fall], record: &mut summary::Summary) -> Result<(), Failure> {
    let caption = Caption { command: record.command.clone(), seed: record.seed, scene: record.scene.clone() };
    write_atomically(&folder.join("sweep.csv"), fall::csv(falls).as_bytes())?;
    fall::draw(falls, "How the noise falls", &caption)?.write(folder, "variance")?;
    record.files = ["summary.json", "sweep.csv", "variance.png", "variance.svg"].map(String::from).into();
    let old = output::left_by_the_last_run(folder);
    summary::write(&folder.join("summary.json"), record)?;
    output::remove_stale(folder, &old, &record.files);
    Ok(())
}

fn people(falls: &[Fall], record: &summary::Summary, reference: Option<&Reference>, folder: &Path) -> String {
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
            head += &format!("\n{}: {reason}; its V(n) of the tail and of all has no meaning", fall.label);
        }
    }
    let broken = record.series.iter().filter(|s| s.cost.non_finite > 0);
    let broken: Vec<_> =
        broken.map(|s| format!("warning: {}: {} samples were not finite", s.label, s.cost.non_finite)).collect();
    let files = format!("written to {}: {}", folder.display(), record.files.join(", "));
    super::paragraphs(&[head, fall::table(falls), broken.join("\n"), files])
}

/// Where a reference comes from.
enum Planned {
    Read(Box<Reference>),
    Render(Estimator, Settings),
}

/// What `--reference` asks for, refused before anything is rendered if it cannot be had.
fn plan_reference(
    args: &args::Sweep,
    scene: &Scene,
    description: &Description,
    settings: &Settings,
) -> Result<Option<Planned>, Failure> {
    let Some(text) = &args.reference else { return Ok(None) };
    if let Ok(spp) = text.parse::<u32>() {
        if !(16..=1 << 24).contains(&spp) {
            return Err(usage(&format!("a reference of {spp} samples has no error of its own"), "give it at least 16"));
        }
        let roulette = Roulette::Albedo { from: 2 }.after(settings.max_bounces);
        let settings = Settings {
            spp,
            seed: reference_seed(settings.seed),
            technique: Technique::Mis,
            points: Points::Independent,
            roulette,
            ..settings.clone()
        };
        preflight::light_is_lost(scene, &settings, &[WorldName::Terms])?;
        let all = [Estimator::Prefix, Estimator::Bidirectional, Estimator::Light];
        let sees = all.into_iter().find(|&e| unsampled(scene, Some(e), settings.technique).is_empty());
        let Some(estimator) = sees else {
            return Err(usage("no estimator sees all light of this scene", "leave --reference out"));
        };
        return Ok(Some(Planned::Render(estimator, settings)));
    }
    let folder = Path::new(text);
    let known = summary::read(&folder.join("summary.json"))?;
    let help = |what: String, help: &str| Failure::Input(format!("error: {what}\n  --> {text}\nhelp: {help}"));
    let [w, h] = description.camera.size.map(|s| s as usize);
    if (known.width, known.height, known.scene.as_str()) != (w, h, description.name.as_str()) {
        let what = format!(
            "the reference is {}, {}×{}; this is {}, {w}×{h}",
            known.scene, known.width, known.height, description.name
        );
        return Err(help(what, "render both with the same scene and --size"));
    }
    if known.max_bounces != settings.max_bounces {
        let what = format!("the reference keeps k ≤ {}, this run k ≤ {}", known.max_bounces, settings.max_bounces);
        return Err(help(what, "render both with the same --max-bounces: their tails differ"));
    }
    if known.seed == settings.seed {
        let what = format!("the reference has seed {}, too: its noise would be this run's own", known.seed);
        return Err(help(what, "give one of them another --seed"));
    }
    let image = exr::read(&folder.join("terms.exr"))?;
    let layer = |name: &str| {
        let mean = image.layer(name)?.to_vec();
        Some(TermImage { mean, std_error: image.layer(&format!("{name}_se"))?.to_vec() })
    };
    let terms: Option<Vec<TermImage>> = (0..=known.max_bounces).map(|k| layer(&format!("T{k:02}"))).collect();
    let (Some(terms), Some(total)) = (terms, layer("Tall").or_else(|| layer("Tsum"))) else {
        return Err(help("terms.exr does not hold the terms".into(), "make it with `fredholm series`"));
    };
    let label = format!("{text}, {} spp, seed {}", known.spp, known.seed);
    Ok(Some(Planned::Read(Box::new(Reference { label, terms, tail: layer("tail"), total }))))
}
