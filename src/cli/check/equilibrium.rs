//! `fredholm check equilibrium SCENE`: the rendering equation itself as a test.

use super::common::Common;
use crate::cli::base::{Ending, Failure, names, note, paragraphs, usage};
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
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::table::{self, significant};
use fredholm::report::write_atomically;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::stats::{Evidence, Outcome, estimate, min_detectable};
use fredholm::study::equilibrium::{self, Balance, Group, Judgement, Origin, judge};
use fredholm::terms::{Channel, TermImage, World};
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

/// Pixels of the picture on each side: few, with many samples each, so that the rare hits of a lamp make no pattern of their own.
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

/// Everything that was found.
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

/// Refuses what is no solution of the equation, or cannot be found by a step.
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

/// Both sides at points and through the camera, and what they say.
fn balance<'a>(args: &'a Equilibrium, scene: &Scene, settings: &Settings, session: &Session) -> Checked<'a> {
    let half = (args.points / 2).max(1);
    let at = |from| {
        let points = equilibrium::points(scene, from, half, args.common.seed);
        // streams of the two halves must not be the same
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

fn people(session: &Session, found: &Checked<'_>, files: &[String]) -> String {
    let (args, j) = (found.args, &found.judgement);
    let all = found.groups.iter().map(|g| g.1.len()).sum::<usize>();
    let mut head = format!(
        "{}\nL: path tracer, {}, roulette {}; E + T L: one step, then the same with other numbers\n\
         {all} points, {} samples of each side at every point, seed {}, α = {}",
        session.command(),
        args.technique,
        args.roulette,
        table::count(args.spp.into()),
        args.common.seed,
        args.alpha
    );
    if args.factor != 1.0 {
        head += &format!("\nbroken on purpose: the step by hand weighs {} times what it should", args.factor);
    }
    let mut lines: Vec<String> = j.groups.iter().map(|g| mean_of(g, args.delta)).collect();
    lines.push(format!(
        "point by point: {} of {all} have events enough to be judged, {} rejected; smallest p = {} (Holm)",
        j.judged,
        j.rejected.len(),
        significant(j.smallest, 2)
    ));
    lines.push(format!(
        "their p-values: at most {} away from uniform ones, p = {}",
        significant(j.uniformity.distance, 2),
        significant(j.uniformity.p, 2)
    ));
    paragraphs(&[head, lines.join("\n"), verdict(found), session.written(files)])
}

/// One line: how far both sides are apart in the mean over a group of points.
fn mean_of(g: &Group, delta: f64) -> String {
    let c = worst(g);
    let (value, difference, half) = (g.value[c], g.difference.mean[c], g.half[c]);
    let apart = match g.evidence.no_error {
        None => {
            let (apart, half, delta) = (100.0 * difference / value, 100.0 * half / value, 100.0 * delta);
            format!("{apart:+.2} ± {half:.2} % of it (δ {delta} %), p = {}", significant(g.p, 2))
        }
        Some(why) => format!("{}, which has no error ({})", significant(difference, 3), why.short()),
    };
    format!(
        "mean over {} {} points: T L {} ({}), L − (E + T L) {apart}: {}",
        g.points,
        g.name,
        significant(value, 4),
        Channel::ALL[c],
        table::outcome(g.outcome)
    )
}

/// The verdict in words.
fn verdict(found: &Checked<'_>) -> String {
    if let Some(why) = &found.undecided {
        return notes::undecided(why);
    }
    if let Some(why) = found.groups.iter().find_map(|g| Evidence::of_variance(g.1.first()?.variance).no_verdict) {
        return format!("Nothing is decided: {why}.");
    }
    let words = match found.judgement.outcome {
        Outcome::Agrees => "The equation holds, as closely as was asked for.",
        Outcome::Differs => "The equation does not hold.",
        Outcome::Inconclusive if found.judgement.groups.iter().all(|g| g.value == glam::DVec3::ZERO) => {
            "No light was found at any of the points: nothing was tested."
        }
        Outcome::Inconclusive => {
            "Nothing speaks against the equation; the noise hides differences as large as δ: raise --spp."
        }
    };
    words.into()
}

/// The channel whose difference is bounded worst.
fn worst(g: &Group) -> usize {
    let reach = (g.difference.mean.abs() + g.half) / g.value;
    (0..3).filter(|&c| reach[c].is_finite()).max_by(|&a, &b| reach[a].total_cmp(&reach[b])).unwrap_or(0)
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

/// The points as they are drawn.
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

/// Writes plot, pictures, points and the record; the names of the files.
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

/// A group as a row of the record.
fn verdict_of(g: &Group, alpha: f64) -> summary::VerdictRecord {
    let c = worst(g);
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
