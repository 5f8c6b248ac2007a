//! One member compared with the right estimator: a table, pictures and a plot.

use super::args::Zoo;
use super::folder::{self, MARK, mark, write};
use super::words::{self, brief, whole};
use crate::cli::base::{Ending, Failure, print, usage};
use fredholm::engine::by_rays::Sampled;
use fredholm::math::names::suggest;
use fredholm::report::figures::signature::{self, Signature};
use fredholm::report::image::contact_sheet::{self, Cell};
use fredholm::report::image::picture::auto_gain_beside_lamps;
use fredholm::report::image::typeset::{Caption, superscript};
use fredholm::report::plot::Point;
use fredholm::report::text::csv::Csv;
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::table::{plus_minus, significant};
use fredholm::report::write_atomically;
use fredholm::report::{ReportError, half_width_95};
use fredholm::scene::{Scene, builtin};
use fredholm::terms::Estimate;
use fredholm::zoo::signature::{Ratio, measured};
use fredholm::zoo::{self, Bug, Stage};

/// Renders a member and the right estimator, in the scene that shows the mistake and in one that cannot.
pub fn run(args: &Zoo, bug: &'static Bug) -> Result<Ending, Failure> {
    let settings = args.settings(256);
    let stage = stage(args, bug)?;
    let session = folder::session(args, &format!("zoo-out/{}", bug.name))?;
    let pair = |stage: Stage| -> Result<Pair, Failure> {
        let scene = Scene::new(&stage.load(args.size)?);
        let right = zoo::render_right(bug, &scene, &settings, session.progress());
        Ok(Pair { stage, wrong: zoo::render(bug, &scene, &settings, session.progress()), right })
    };
    let shown = pair(stage)?;
    let blind = bug.blind.map(pair).transpose()?;
    session.clear();

    let (wrong, right) = (&shown.wrong, &shown.right);
    let theory = stage == bug.exposed_by;
    let (folder, caption, n) = (&session.folder, Caption { scene: stage.label.into(), ..session.caption() }, bug.name);
    write(&folder.join(format!("{n}.exr")), args.size, wrong)?;
    write(&folder.join("correct.exr"), args.size, right)?;
    pictures(bug, args.size, wrong, right, &caption)?.picture.write(&folder.join(format!("{n}.png")))?;
    let ratios = measured(wrong.series.image(), right.series.image());
    signature::draw(&plot(&format!("{n}: {}", bug.what), bug, &ratios, theory), &caption)?
        .write(folder, &format!("{n}-ratios"))?;
    let mut csv = Csv::new("k,ratio,std_error");
    ratios.iter().enumerate().for_each(|(k, r)| csv.put(k).put(r.value).put(r.std_error).end());
    write_atomically(&folder.join(MARK), (mark() + &csv.text()).as_bytes())?;

    let files: Vec<String> = ["exr", "png"].map(|e| format!("{n}.{e}")).into();
    let more = ["png", "svg"].map(|e| format!("{n}-ratios.{e}"));
    let files: Vec<String> = files.into_iter().chain(more).chain(["correct.exr".into(), MARK.into()]).collect();
    let tables = [table(bug, &shown, blind.as_ref(), theory), words::signature(bug)];
    print(&session.text(&wrapped(&answer(bug, &shown)), &tables, &[], &files))?;
    Ok(session.ending(false))
}

/// The wrong and the right result in one scene.
struct Pair {
    stage: Stage,
    wrong: Sampled,
    right: Sampled,
}

/// The first sentence of the output: the factor by which the mistake changes the mean of the image, and the p-value of the
/// hypothesis that there is no mistake.
fn answer(bug: &Bug, shown: &Pair) -> String {
    let r = whole(shown.wrong.series.image(), shown.right.series.image());
    let zoo::judge::Judgement { p, what } = zoo::judge::judge(&shown.wrong, &shown.right);
    let scene = shown.stage.label;
    if p > 1e-3 {
        return format!(
            "In {scene} the mistake of {} cannot be told from noise (p = {p:.2}; judged by: {what}), so raise --spp.\n\
             The mistake: {}.",
            bug.name, bug.what
        );
    }
    let half = half_width_95(r.std_error, r.replicates);
    let by = match (r.value.is_finite(), half.is_finite() && half > 0.0) {
        (false, _) => "makes the mean of the whole image no number".into(),
        (true, true) => format!("multiplies the mean of the whole image by {}", plus_minus(r.value, half, 2)),
        (true, false) => format!("multiplies the mean of the whole image by {}", significant(r.value, 4)),
    };
    let sure = if p > 0.0 {
        format!("The right renderer gives this with a probability of {p:.0e}; judged by: {what}.")
    } else {
        format!("The right renderer cannot give this; judged by: {what}.")
    };
    format!("In {scene} the mistake of {} {by}: {}.\n{sure}", bug.name, bug.what)
}

/// The scene of `--scene`, or else the one that shows the mistake.
fn stage(args: &Zoo, bug: &Bug) -> Result<Stage, Failure> {
    let Some(name) = &args.scene else { return Ok(bug.exposed_by) };
    let scene = builtin::find(name).ok_or_else(|| {
        usage(&format!("`{name}` is no built-in scene"), &suggest(name, "built-in scenes", builtin::names()))
    })?;
    Ok(Stage { label: scene.name, scene: scene.name, set: &[] })
}

/// A row per term: the right and the wrong mean, r_k measured and predicted, and r_k in the scene that cannot show the mistake.
fn table(bug: &Bug, shown: &Pair, blind: Option<&Pair>, theory: bool) -> String {
    let [w, r] = [&shown.wrong, &shown.right].map(|s| s.series.image());
    let other = blind.map(|b| [&b.wrong, &b.right].map(|s| s.series.image()));
    let mean = |e: &Estimate| significant(e.mean.element_sum() / 3.0, 4);
    let column = |text: String| if blind.is_some() { text } else { String::new() };
    let line = |name: &str, w: &Estimate, r: &Estimate, predicted: Option<f64>, blind: Option<[&Estimate; 2]>| {
        let predicted = predicted.map_or(String::new(), |r| significant(r, 4));
        let (ratio, elsewhere) =
            (brief(&Ratio::of(w, r)), blind.map_or(String::new(), |[w, r]| brief(&Ratio::of(w, r))));
        let line =
            format!("{name:6} {:>10} {:>10} {ratio:>12} {predicted:>10} {:>16}", mean(r), mean(w), column(elsewhere));
        line.trim_end().to_string()
    };
    let mut above = format!(
        "Means of the terms in {}, right and wrong, and the ratio rₖ, measured (in brackets the 95 % interval of the last \
         digits) and predicted by theory",
        shown.stage.label
    );
    above += &blind.map_or(".".into(), |b| format!("; {} is blind to the mistake.", b.stage.label));
    let elsewhere = blind.map_or(String::new(), |b| b.stage.label.to_owned());
    let head = format!("{:6} {:>10} {:>10} {:>12} {:>10} {elsewhere:>16}", "k", "right", "wrong", "rₖ", "predicted");
    let mut lines = vec![wrapped(&above), head.trim_end().to_owned(), "─".repeat(head.trim_end().chars().count())];
    for (k, (a, b)) in w.terms.iter().zip(&r.terms).enumerate() {
        let there = other.and_then(|o| Some([o[0].terms.get(k)?, o[1].terms.get(k)?]));
        lines.push(line(&k.to_string(), a, b, if theory { (bug.ratio)(k) } else { None }, there));
    }
    let last = w.terms.len().saturating_sub(1);
    if !w.tail.is_none() {
        lines.push(line(&format!("k > {last}"), &w.tail, &r.tail, None, other.map(|o| [&o[0].tail, &o[1].tail])));
    }
    lines.push(line("whole", &w.total, &r.total, None, other.map(|o| [&o[0].total, &o[1].total])));
    let bad = shown.wrong.series.cost.non_finite;
    if bad > 0 {
        lines.push(format!("{bad} samples of the wrong estimator are no number."));
    }
    lines.join("\n")
}

/// The data of the figure: r_k measured and, in the scene that shows the mistake, predicted.
fn plot(title: &str, bug: &Bug, ratios: &[Ratio], theory: bool) -> Signature {
    let point = |(k, r): (usize, &Ratio)| Point {
        x: k as f64,
        value: r.value,
        std_error: r.std_error,
        replicates: r.replicates,
    };
    let predicted = (0..ratios.len()).filter_map(|k| Some(Point::exact(k as f64, (bug.ratio)(k)?)));
    Signature {
        title: title.into(),
        measured: ratios.iter().enumerate().map(point).collect(),
        predicted: if theory { predicted.collect() } else { vec![] },
    }
}

/// A sheet with the right image, the wrong one and their signed difference, for the whole and for k = 1 to 3; each row has one
/// exposure.
fn pictures(
    bug: &Bug,
    [w, h]: [u32; 2],
    wrong: &Sampled,
    right: &Sampled,
    caption: &Caption,
) -> Result<contact_sheet::Sheet, ReportError> {
    let black = vec![[0.0; 3]; (w * h) as usize];
    let emitted = right.terms.first().map_or(&black, |t| &t.mean);
    let mut shown = vec![("whole".to_string(), &right.total.mean, &wrong.total.mean)];
    for k in 1..4.min(right.terms.len()) {
        shown.push((format!("T{}E", superscript(k)), &right.terms[k].mean, &wrong.terms[k].mean));
    }
    // red where the wrong image is too bright, blue where it is too dark
    let signed = |a: &[[f32; 3]], b: &[[f32; 3]]| -> Vec<[f32; 3]> {
        let mean = |p: &[f32; 3]| (p[0] + p[1] + p[2]) / 3.0;
        let differ = |(a, b): (&[f32; 3], &[f32; 3])| {
            let d = mean(b) - mean(a);
            if d.is_nan() { [f32::NAN; 3] } else { [d.max(0.0), 0.0, (-d).max(0.0)] }
        };
        a.iter().zip(b).map(differ).collect()
    };
    let differences: Vec<Vec<[f32; 3]>> = shown.iter().map(|(_, a, b)| signed(a, b)).collect();
    let mut cells = vec![];
    for ((name, a, b), difference) in shown.iter().zip(&differences) {
        let gain = Some(auto_gain_beside_lamps(a, emitted));
        cells.push(Cell { label: format!("{name}, right"), pixels: a, gain });
        cells.push(Cell { label: format!("{name}, wrong"), pixels: b, gain });
        cells.push(Cell { label: "difference: + red, − blue".into(), pixels: difference, gain });
    }
    contact_sheet::grid_of(3, &format!("{}: {}", bug.name, bug.what), w as usize, h as usize, &cells, caption)
}
