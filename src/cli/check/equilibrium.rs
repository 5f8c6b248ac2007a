//! `fredholm check equilibrium SCENE`: tests whether L = E + T L holds at points of the scene.

use super::common::Common;
use crate::cli::base::{Ending, Failure, names, note, usage};
use crate::cli::choices::{SAMPLINGS, TECHNIQUES};
use crate::cli::options::{HOW, WHAT, one_of, probability};
use crate::cli::session::Session;
use crate::cli::{notes, preflight, write};
use clap::Args;
use fredholm::engine::Settings;
use fredholm::engine::known::coplanar;
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::figures::equilibrium::{self as figure, Dot};
use fredholm::report::image::contact_sheet::{self, Cell};
use fredholm::report::image::picture;
use fredholm::report::image::zmap;
use fredholm::report::text::prose::{counted, wrapped};
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::table::{self, significant};
use fredholm::report::write_atomically;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::stats::{Evidence, Outcome, estimate, min_detectable};
use fredholm::study::equilibrium::{self, Balance, Group, Judgement, Origin, judge};
use fredholm::terms::{TermImage, World};
use serde_json::json;

/// Below `check equilibrium --help`.
pub(super) const HELP: &str = "Examples:
  fredholm check equilibrium cornell
  fredholm check equilibrium cornell --break 1.02
  fredholm check equilibrium box.toml --points 256 --spp 262144

L is estimated by the path tracer. E + T L is estimated by one explicit step, followed by the path tracer with independent random \
numbers. Half of the points are uniform on all surfaces with cosine-distributed directions; the other half are seen through random \
pixels. Three hypotheses are tested at level α: every point (Holm's correction), the mean over each half, and that the p-values of \
all points are uniform.

--break 1.02 makes the explicit step 2 % too large, and the test must find it.

The test cannot see an error in T that both sides share, because L' = E + 1.02 T L' holds, too.";

/// Width and height of the picture: few pixels with many samples each, so that rare hits of a lamp do not show as a pattern.
const PICTURE: u32 = 32;

/// Arguments of `check equilibrium`.
#[derive(Clone, Debug, Args)]
pub struct Equilibrium {
    /// Built-in scene, .toml or .obj
    #[arg(value_name = "SCENE", default_value = "cornell", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    scene: String,
    /// Number of points
    #[arg(long, value_name = "N", default_value_t = 128, help_heading = WHAT, value_parser = clap::value_parser!(u32).range(2..=65536))]
    points: u32,
    /// Samples of each side at every point
    ///
    /// A pixel of the picture has 1/32 of them.
    #[arg(long, value_name = "N", default_value_t = 131_072, help_heading = WHAT, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    spp: u32,
    /// Weight of the explicit step
    ///
    /// With a FACTOR other than 1 the equation is false on purpose, and the test must reject it.
    #[arg(long = "break", value_name = "FACTOR", default_value_t = 1.0, help_heading = WHAT)]
    factor: f32,
    /// Light: scatter, connect, mis, mis-power
    ///
    /// The technique by which the path tracer for L finds light.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Technique>(TECHNIQUES))]
    technique: Technique,
    /// Roulette for L; it must end paths
    #[arg(long, value_name = "RULE", default_value = "albedo@2", help_heading = HOW)]
    roulette: Roulette,
    /// Directions: uniform, cosine or bsdf
    ///
    /// The density of the sampled directions at a surface.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Sampling>(SAMPLINGS))]
    sampling: Sampling,
    /// Probability of a false alarm
    ///
    /// The probability to reject an equation that holds.
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = probability, help_heading = HOW)]
    alpha: f64,
    /// δ of the means, as a fraction of T L
    ///
    /// Means are taken over points.
    #[arg(long, value_name = "X", default_value_t = 0.02, value_parser = probability, help_heading = HOW)]
    delta: f64,
    #[command(flatten)]
    common: Common,
}

/// The estimates of both sides, and the judgement.
struct Checked<'a> {
    args: &'a Equilibrium,
    groups: [(&'static str, Vec<Balance>); 2],
    judgement: Judgement,
    /// Why there is no verdict, where the scene has no right answer.
    undecided: Option<String>,
    images: [TermImage; 2],
    /// Samples per pixel of the images.
    spp: u32,
}

/// Tests the equation.
pub(super) fn run(args: &Equilibrium) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.common.shared, args.common.seed)?;
    let loaded = args.common.load(&mut session, &args.scene, PICTURE)?;
    let settings = Settings {
        spp: args.spp,
        seed: args.common.seed,
        technique: args.technique,
        sampling: args.sampling,
        path_roulette: args.roulette.clone(),
        ..Settings::default()
    };
    can_be_tested(args, &loaded.scene, &settings)?;
    session.make_folder(&format!("{}-equilibrium", loaded.description.name))?;
    let found = balance(args, &loaded.scene, &settings, &session);
    session.clear();
    let files = write_all(&session, &found)?;
    session.show(&record(&found, session.command()), || people(&session, &found, &files))?;
    if session.stopped() {
        note("interrupted: some points have fewer samples than asked for");
    }
    Ok(session.ending(found.judgement.outcome == Outcome::Differs))
}

/// Refuses settings under which L does not solve the equation, and lights that one step cannot hit.
fn can_be_tested(args: &Equilibrium, scene: &Scene, settings: &Settings) -> Result<(), Failure> {
    if !args.roulette.ends() {
        let help = "use a schedule that ends paths, such as albedo";
        return Err(usage("paths that are cut at K do not solve L = E + T L", help));
    }
    if scene.lights.any_delta() {
        let help = "give the light an area";
        return Err(usage("a step never hits a point or a direction, and this scene is lit by one", help));
    }
    if !(args.factor.is_finite() && args.factor > 0.0) {
        return Err(usage("--break takes a factor above 0", "1.02 makes the step 2 % too heavy"));
    }
    preflight::light_is_lost(scene, settings, &[World::Path])
}

/// Estimates both sides at points and through the camera, and judges their difference.
fn balance<'a>(args: &'a Equilibrium, scene: &Scene, settings: &Settings, session: &Session) -> Checked<'a> {
    let half = (args.points / 2).max(1);
    let at = |from| {
        let points = equilibrium::points(scene, from, half, args.common.seed);
        // the two halves must not use the same random numbers
        let seed = settings.seed ^ ((from as u64) << 63);
        let settings = Settings { seed, ..settings.clone() };
        equilibrium::at_points(scene, &points, &settings, args.factor, session.progress())
    };
    let groups = [("surface", at(Origin::Surface)), ("camera", at(Origin::Camera))];
    let seen = Settings { spp: (args.spp / 32).max(16), ..settings.clone() };
    let images = equilibrium::through_camera(scene, &seen, args.factor, session.progress());
    let parts: Vec<(&str, &[Balance])> = groups.iter().map(|(n, b)| (*n, b.as_slice())).collect();
    let mut judgement = judge(&parts, args.alpha, args.delta);
    let undecided = coplanar::undecided(scene);
    if undecided.is_some() {
        judgement.outcome = Outcome::Inconclusive;
        judgement.groups.iter_mut().for_each(|g| g.outcome = Outcome::Inconclusive);
    }
    Checked { args, groups, judgement, undecided, images, spp: seen.spp }
}

/// The text: the verdict, the two groups of points, and with `--verbose` the settings and the p-values.
fn people(session: &Session, found: &Checked<'_>, files: &[String]) -> String {
    let (args, j) = (found.args, &found.judgement);
    let all = found.groups.iter().map(|g| g.1.len()).sum::<usize>();
    let mut answer = verdict(found);
    if args.factor != 1.0 {
        answer += &format!("\nIt was broken on purpose: the step by hand weighs {} times what it should.", args.factor);
    }
    let above = format!(
        "Means over points, in the channel with the widest bound: T L, then the difference of both sides in percent of it \
         ({} samples of each side at every point). ✓ means proved smaller than δ = {} % of T L.",
        table::count(args.spp.into()),
        100.0 * args.delta
    );
    let below = match j.judged {
        0 => format!("None of the {all} points has enough events to be judged by itself."),
        n => format!(
            "Of {all} points {n} have enough events to be judged by themselves; {} rejected.",
            if j.rejected.len() == 1 { "1 is".into() } else { format!("{} are", j.rejected.len()) }
        ),
    };
    let head = format!(
        "{}\nL: path tracer, {}, roulette {}; E + T L: one step, then the same with other random numbers\n\
         {}, seed {}, α = {}",
        session.command(),
        args.technique,
        args.roulette,
        counted(all, "point"),
        args.common.seed,
        args.alpha
    );
    let p_values = format!(
        "smallest p-value of a point: {} (Holm)\ndistance of all p-values from uniform ones: {}, p = {}",
        significant(j.smallest, 2),
        significant(j.uniformity.distance, 2),
        significant(j.uniformity.p, 2)
    );
    let tables = [format!("{}\n{}{}", wrapped(&above), figure::table(&j.groups), wrapped(&below))];
    session.text(&wrapped(&answer), &tables, &[head, p_values], files)
}

/// The verdict in one sentence, with the reason or the remedy where nothing is decided.
fn verdict(found: &Checked<'_>) -> String {
    if let Some(why) = &found.undecided {
        return notes::undecided(why);
    }
    if let Some(why) = found.groups.iter().find_map(|g| Evidence::of_variance(g.1.first()?.variance).no_verdict) {
        return format!("Nothing is decided about L = E + T L.\nThe reason: {why}.");
    }
    let (j, delta) = (&found.judgement, 100.0 * found.args.delta);
    match j.outcome {
        Outcome::Agrees => {
            format!(
                "The equation L = E + T L holds: the mean difference of its sides is proved smaller than {delta} % of T L."
            )
        }
        Outcome::Differs => format!(
            "The equation L = E + T L does not hold: if it did, this would happen with a probability of at most {}.",
            found.args.alpha
        ),
        Outcome::Inconclusive if j.groups.iter().all(|g| g.value == glam::DVec3::ZERO) => {
            "Nothing was tested: no light was found at any of the points.".into()
        }
        Outcome::Inconclusive => format!(
            "Nothing contradicts L = E + T L, but the noise hides differences as large as {delta} % of T L.\n\
             A larger --spp than {} lowers the noise.",
            found.args.spp
        ),
    }
}

fn record(found: &Checked<'_>, command: &str) -> serde_json::Value {
    let j = &found.judgement;
    let group = |g: &Group| {
        json!({
            "name": g.name, "points": g.points, "value": g.value, "difference": g.difference, "half_width": g.half,
            "delta": g.delta, "p": g.p, "outcome": g.outcome,
        })
    };
    let point = |(from, b): (&str, &Balance)| {
        json!({
            "from": from, "position": b.at.p, "normal": b.at.n, "direction": b.at.omega, "left": b.left,
            "right": b.right, "p": b.p,
        })
    };
    let points = found.groups.iter().flat_map(|(from, b)| b.iter().map(move |b| (*from, b)));
    json!({
        "command": command, "alpha": found.args.alpha, "outcome": j.outcome,
        "groups": j.groups.iter().map(group).collect::<Vec<_>>(),
        "judged": j.judged, "rejected": j.rejected, "smallest_p": j.smallest,
        "uniformity": { "points": j.uniformity.count, "distance": j.uniformity.distance, "p": j.uniformity.p },
        "points": points.map(point).collect::<Vec<_>>(),
    })
}

/// The points of both groups as the figure draws them.
fn dots(found: &Checked<'_>) -> Vec<(String, Vec<Dot>)> {
    let mut number = 0..;
    let mut dot = |b: &Balance| {
        let i = number.next().unwrap_or(0);
        let grey: Vec<_> = b.differences.iter().map(|d| glam::DVec3::splat(d.element_sum() / 3.0)).collect();
        let mean = estimate(&grey);
        Dot {
            left: b.left.mean.element_sum() / 3.0,
            right: b.right.mean.element_sum() / 3.0,
            std_error: mean.std_error.x,
            replicates: mean.replicates,
            p: if b.judged() { b.p } else { f64::NAN },
            rejected: found.judgement.rejected.contains(&i),
        }
    };
    let words = |name: &str| if name == "camera" { "seen by pixels" } else { "on all surfaces" };
    found.groups.iter().map(|(name, b)| (words(name).to_owned(), b.iter().map(&mut dot).collect())).collect()
}

/// Writes plot, pictures, points and the record; returns the names of the files.
fn write_all(session: &Session, found: &Checked<'_>) -> Result<Vec<String>, Failure> {
    let (folder, caption, common) = (&session.folder, session.caption(), session.record());
    figure::draw(&dots(found), &caption)?.write(folder, "equilibrium")?;
    let (w, h) = (common.width, common.height);
    let [l, r] = &found.images;
    let gain = Some(picture::auto_gain(&l.mean));
    let cells = [("L", l), ("E + T L", r)].map(|(label, i)| Cell { label: label.into(), pixels: &i.mean, gain });
    let title = format!("Both sides of the equation, {} spp", found.spp);
    contact_sheet::grid(&title, w, h, &cells, &caption)?.picture.write(&folder.join("sides.png"))?;
    let z = write::z_values((&l.mean, &l.std_error), (&r.mean, &r.std_error));
    zmap::draw("z of L − (E + T L)", w, h, &z, &caption)?.picture.write(&folder.join("z.png"))?;
    let text = serde_json::to_string_pretty(&record(found, session.command()))?;
    write_atomically(&folder.join("points.json"), text.as_bytes())?;
    let files = names(["equilibrium.png", "equilibrium.svg", "sides.png", "z.png", "points.json", "summary.json"]);
    let verdicts = found.judgement.groups.iter().map(|g| verdict_of(g, found.args.alpha)).collect();
    session.sign(&Summary { spp: found.args.spp.into(), verdicts, files: files.clone(), ..common })?;
    Ok(files)
}

/// A group as a verdict of `summary.json`.
fn verdict_of(g: &Group, alpha: f64) -> summary::VerdictRecord {
    let c = g.worst_channel();
    let (effect, half) = (g.difference.mean[c], g.half[c]);
    let (error, freedom) = (g.difference.std_error[c], g.difference.replicates as f64 - 1.0);
    summary::VerdictRecord {
        name: format!("L − (E + T L), mean over {} points", g.name),
        effect,
        interval: (effect - half, effect + half),
        p: g.p,
        min_detectable: min_detectable(error, freedom, alpha / 18.0, 1e-3),
        outcome: g.outcome,
    }
}
