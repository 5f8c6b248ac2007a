//! `fredholm check equilibrium SCENE`: the rendering equation itself as a test.

use super::super::args;
use super::super::progress::Bar;
use super::super::{Ending, Failure, note, notes, output, paragraphs, preflight, print, write};
use super::{Common, fraction, usage};
use crate::cli::open::Opened;
use clap::Args;
use fredholm::engine::Settings;
use fredholm::engine::known::coplanar;
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::figures::equilibrium::{self as figure, Dot};
use fredholm::report::image::contact_sheet::{self, Cell};
use fredholm::report::text::table::significant;
use fredholm::report::{
    image::{picture, typeset::Caption, zmap},
    text::{summary, table},
};
use fredholm::scene::bsdf::Sampling;
use fredholm::stats::{Evidence, Outcome, estimate};
use fredholm::study::equilibrium::{self, Balance, Group, Judgement, Origin, judge};
use fredholm::terms::TermImage;
use serde_json::json;
use std::path::Path;
use std::time::Instant;

pub(super) const EXAMPLES: &str = "Examples:
  fredholm check equilibrium cornell
  fredholm check equilibrium cornell --break 1.02     a step that weighs 2 % too much, and is found
  fredholm check equilibrium box.toml --points 256 --spp 262144

L is estimated by the path tracer; E + T L by one step taken by hand and the path tracer from there,
with numbers of its own. Half of the points are uniform on all surfaces with cosine-distributed
directions, half are what random pixels see. Tested at level α: every point (Holm), the mean over each
half, and whether the p-values of all points are uniform.

Blind to an error in T that both sides share: L' = E + 1.02 T L' holds, too.";

/// Pixels of the picture on each side: few, with many samples each, so that the rare hits of a lamp make no pattern of their own.
const PICTURE: u32 = 32;

/// Arguments of `check equilibrium`.
#[derive(Clone, Debug, Args)]
pub struct Equilibrium {
    /// Built-in scene, .toml, or .obj
    #[arg(value_name = "SCENE", default_value = "cornell")]
    scene: String,
    /// Number of points
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = clap::value_parser!(u32).range(2..=65536))]
    points: u32,
    /// Samples of each side at every point; the picture has 1/32 of them in every pixel
    #[arg(long, value_name = "N", default_value_t = 131_072, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    spp: u32,
    /// How L finds light: scatter, connect, mis, mis-power
    #[arg(long, default_value = "mis", value_parser = args::technique, value_name = "NAME")]
    technique: Technique,
    /// Russian roulette inside L; it must end paths
    #[arg(long, value_name = "SCHEDULE", default_value = "albedo@2")]
    roulette: Roulette,
    /// How directions are drawn: uniform, cosine, bsdf
    #[arg(long, default_value = "bsdf", value_parser = args::sampling, value_name = "NAME")]
    sampling: Sampling,
    /// Chance to reject the equation though it holds
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = fraction)]
    alpha: f64,
    /// δ of the means over points, as a fraction of T L
    #[arg(long, value_name = "FRACTION", default_value_t = 0.02, value_parser = fraction)]
    delta: f64,
    /// Breaks the equation on purpose: the step by hand weighs FACTOR times what it should
    #[arg(long = "break", value_name = "FACTOR", default_value_t = 1.0)]
    factor: f32,
    #[command(flatten)]
    common: Common,
}

/// Everything that was found.
struct Checked<'a> {
    args: &'a Equilibrium,
    loaded: Opened,
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
    let started = Instant::now();
    let loaded = args.common.load(&args.scene, PICTURE)?;
    let settings = Settings {
        spp: args.spp,
        seed: args.common.seed,
        technique: args.technique,
        sampling: args.sampling,
        path_roulette: args.roulette.clone(),
        ..Settings::default()
    };
    if !args.roulette.ends() {
        let help = "use a schedule that ends paths, such as albedo";
        return Err(usage("paths that are cut at K do not solve L = E + T L", help));
    }
    if loaded.scene.lights.any_delta() {
        let help = "give the light an area";
        return Err(usage("a step never hits a point or a direction, and this scene is lit by one", help));
    }
    if !(args.factor.is_finite() && args.factor > 0.0) {
        return Err(usage("--break takes a factor above 0", "1.02 makes the step 2 % too heavy"));
    }
    preflight::light_is_lost(&loaded.scene, &settings, &[args::WorldName::Path])?;
    let name = format!("equilibrium-{}", loaded.description.name);
    let folder = output::folder(args.common.shared.out.as_deref(), &name, &loaded.command, args.common.shared.force)?;

    let bar = Bar::plain(args.common.shared.quiet);
    let progress = bar.progress();
    let half = (args.points / 2).max(1);
    let at = |from| {
        let points = equilibrium::points(&loaded.scene, from, half, args.common.seed);
        // streams of the two halves must not be the same
        let seed = settings.seed ^ ((from as u64) << 63);
        let settings = Settings { seed, ..settings.clone() };
        equilibrium::at_points(&loaded.scene, &points, &settings, args.factor, progress)
    };
    let groups = [("surface", at(Origin::Surface)), ("camera", at(Origin::Camera))];
    let seen = Settings { spp: (args.spp / 32).max(16), ..settings.clone() };
    let images = equilibrium::through_camera(&loaded.scene, &seen, args.factor, progress);
    bar.finish();
    let parts: Vec<(&str, &[Balance])> = groups.iter().map(|(n, b)| (*n, b.as_slice())).collect();
    let mut judgement = judge(&parts, args.alpha, args.delta);
    let undecided = coplanar::undecided(&loaded.scene);
    if undecided.is_some() {
        judgement.outcome = Outcome::Inconclusive;
        judgement.groups.iter_mut().for_each(|g| g.outcome = Outcome::Inconclusive);
    }
    let found = Checked { args, loaded, groups, judgement, undecided, images, spp: seen.spp };
    let files = write_all(&folder, &found, started)?;
    if args.common.shared.json {
        print(&serde_json::to_string_pretty(&record(&found))?)?;
    } else {
        print(&people(&found, &folder, &files))?;
    }
    if progress.stopped() {
        note("interrupted: some points have fewer samples than asked for");
        return Ok(Ending::Interrupted);
    }
    Ok(if found.judgement.outcome == Outcome::Differs { Ending::Failed } else { Ending::Ok })
}

fn people(found: &Checked, folder: &Path, files: &[String]) -> String {
    let (args, j) = (found.args, &found.judgement);
    let all = found.groups.iter().map(|g| g.1.len()).sum::<usize>();
    let mut head = format!(
        "{}\nL: path tracer, {}, roulette {}; E + T L: one step, then the same with other numbers\n\
         {all} points, {} samples of each side at every point, seed {}, α = {}",
        found.loaded.command,
        args.technique,
        args.roulette,
        table::count(args.spp.into()),
        args.common.seed,
        args.alpha
    );
    if args.factor != 1.0 {
        head += &format!("\nbroken on purpose: the step by hand weighs {} times what it should", args.factor);
    }
    let mut lines = vec![];
    for g in &j.groups {
        let c = worst(g);
        let (value, difference, half) = (g.value[c], g.difference.mean[c], g.half[c]);
        let channel = fredholm::math::CHANNELS[c];
        let apart = match g.evidence.no_error {
            None => {
                let (apart, half, delta) = (100.0 * difference / value, 100.0 * half / value, 100.0 * args.delta);
                format!("{apart:+.2} ± {half:.2} % of it (δ {delta} %), p = {}", significant(g.p, 2))
            }
            Some(why) => format!("{}, which has no error ({})", significant(difference, 3), why.short()),
        };
        lines.push(format!(
            "mean over {} {} points: T L {} ({channel}), L − (E + T L) {apart}: {}",
            g.points,
            g.name,
            significant(value, 4),
            table::outcome(g.outcome)
        ));
    }
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
    let endless = found.groups.iter().find_map(|g| Evidence::of_variance(g.1.first()?.variance).no_verdict);
    let verdict = match j.outcome {
        _ if found.undecided.is_some() => "",
        Outcome::Agrees => "The equation holds, as closely as was asked for.",
        Outcome::Differs => "The equation does not hold.",
        Outcome::Inconclusive if j.groups.iter().all(|g| g.value == glam::DVec3::ZERO) => {
            "No light was found at any of the points: nothing was tested."
        }
        Outcome::Inconclusive => {
            "Nothing speaks against the equation; the noise hides differences as large as δ: raise --spp."
        }
    };
    let files = format!("written to {}: {}", folder.display(), files.join(", "));
    let verdict = match (&found.undecided, endless) {
        (Some(why), _) => notes::undecided(why),
        (None, Some(reason)) => format!("Nothing is decided: {reason}."),
        (None, None) => verdict.to_owned(),
    };
    paragraphs(&[head, lines.join("\n"), verdict, files])
}

/// The channel whose difference is bounded worst.
fn worst(g: &Group) -> usize {
    let reach = (g.difference.mean.abs() + g.half) / g.value;
    (0..3).filter(|&c| reach[c].is_finite()).max_by(|&a, &b| reach[a].total_cmp(&reach[b])).unwrap_or(0)
}

fn record(found: &Checked) -> serde_json::Value {
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
        "command": found.loaded.command, "alpha": found.args.alpha, "outcome": j.outcome,
        "groups": j.groups.iter().map(group).collect::<Vec<_>>(),
        "judged": j.judged, "rejected": j.rejected, "smallest_p": j.smallest,
        "uniformity": { "points": j.uniformity.count, "distance": j.uniformity.distance, "p": j.uniformity.p },
        "points": points.map(point).collect::<Vec<_>>(),
    })
}

fn write_all(folder: &Path, found: &Checked, started: Instant) -> Result<Vec<String>, Failure> {
    let (args, loaded) = (found.args, &found.loaded);
    let caption =
        Caption { command: loaded.command.clone(), seed: args.common.seed, scene: loaded.description.name.clone() };
    // the plot
    let mut number = 0..;
    let mut dot = |b: &Balance| {
        let i = number.next().unwrap_or(0);
        let mean =
            estimate(&b.differences.iter().map(|d| glam::DVec3::splat(d.element_sum() / 3.0)).collect::<Vec<_>>());
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
    let groups: Vec<(String, Vec<Dot>)> =
        found.groups.iter().map(|(name, b)| (words(name).to_owned(), b.iter().map(&mut dot).collect())).collect();
    figure::draw(&groups, &caption)?.write(folder, "equilibrium")?;
    // the pictures
    let [w, h] = loaded.description.camera.size.map(|s| s as usize);
    let [l, r] = &found.images;
    let gain = Some(picture::auto_gain(&l.mean));
    let cells = [("L", l), ("E + T L", r)].map(|(label, i)| Cell { label: label.into(), pixels: &i.mean, gain });
    let title = format!("Both sides of the equation, {} spp", found.spp);
    contact_sheet::grid(&title, w, h, &cells, &caption)?.picture.write(&folder.join("sides.png"))?;
    let z = write::z_values((&l.mean, &l.std_error), (&r.mean, &r.std_error));
    zmap::draw("z of L − (E + T L)", w, h, &z, &caption)?.picture.write(&folder.join("z.png"))?;

    let names = ["equilibrium.png", "equilibrium.svg", "sides.png", "z.png", "points.json", "summary.json"];
    let files: Vec<String> = names.map(String::from).to_vec();
    let text = serde_json::to_string_pretty(&record(found))?;
    fredholm::report::write_atomically(&folder.join("points.json"), text.as_bytes())?;
    let verdict = |g: &Group| {
        let c = worst(g);
        let (effect, half) = (g.difference.mean[c], g.half[c]);
        summary::VerdictRecord {
            name: format!("L − (E + T L), mean over {} points", g.name),
            effect,
            interval: (effect - half, effect + half),
            p: g.p,
            min_detectable: fredholm::stats::min_detectable(
                g.difference.std_error[c],
                g.difference.replicates as f64 - 1.0,
                args.alpha / 18.0,
                1e-3,
            ),
            outcome: g.outcome,
        }
    };
    let record = summary::Summary {
        command: loaded.command.clone(),
        scene: loaded.description.name.clone(),
        scene_hash: loaded.hash.clone(),
        seed: args.common.seed,
        spp: args.spp.into(),
        threads: rayon::current_num_threads(),
        seconds: started.elapsed().as_secs_f64(),
        width: w,
        height: h,
        verdicts: found.judgement.groups.iter().map(verdict).collect(),
        files: files.clone(),
        ..summary::Summary::default()
    };
    let old = output::left_by_the_last_run(folder);
    summary::write(&folder.join("summary.json"), &record)?;
    output::remove_stale(folder, &old, &files);
    Ok(files)
}
