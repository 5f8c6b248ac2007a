//! One member beside the right estimator: table, picture, plot.

use super::args::Zoo;
use super::folder::{self, MARK, mark, write};
use super::words::{brief, introduction};
use crate::cli::base::{Ending, Failure, paragraphs, print, usage};
use fredholm::engine::by_rays::Sampled;
use fredholm::math::names::suggest;
use fredholm::report::ReportError;
use fredholm::report::figures::signature::{self, Signature};
use fredholm::report::image::contact_sheet::{self, Cell};
use fredholm::report::image::picture::auto_gain_beside_lamps;
use fredholm::report::image::typeset::{Caption, superscript};
use fredholm::report::plot::Point;
use fredholm::report::text::csv::Csv;
use fredholm::report::text::table::significant;
use fredholm::report::write_atomically;
use fredholm::scene::{Scene, builtin};
use fredholm::terms::Estimate;
use fredholm::zoo::signature::{Ratio, measured};
use fredholm::zoo::{self, Bug, Stage};

/// One member beside the right estimator, in the scene that shows it and in the one that cannot.
pub fn run(args: &Zoo, bug: &'static Bug) -> Result<Ending, Failure> {
    let settings = args.settings(256);
    let stage = stage(args, bug)?;
    let session = folder::session(args, &format!("zoo-out/{}", bug.name))?;
    let pair = |stage: Stage| -> Result<(Sampled, Sampled), Failure> {
        let scene = Scene::new(&stage.load(args.size)?);
        let right = zoo::render_right(bug, &scene, &settings, session.progress());
        Ok((zoo::render(bug, &scene, &settings, session.progress()), right))
    };
    let (wrong, right) = pair(stage)?;
    let blind = bug.blind.map(|stage| pair(stage).map(|p| (stage, p))).transpose()?;
    session.clear();

    let judgement = zoo::judge::judge(&wrong, &right);
    let theory = stage == bug.exposed_by;
    let mut blocks = vec![introduction(bug), format!("{}\n{}", stage.label, rows(bug, &wrong, &right, theory))];
    blocks.push(format!("p = {:.1e} that the right renderer gives this: judged by {}", judgement.p, judgement.what));
    if let Some((stage, (wrong, right))) = &blind {
        blocks.push(format!("{}, which is blind to it\n{}", stage.label, rows(bug, wrong, right, false)));
    }

    let (folder, caption) = (&session.folder, Caption { scene: stage.label.into(), ..session.caption() });
    write(&folder.join(format!("{}.exr", bug.name)), args.size, &wrong)?;
    write(&folder.join("correct.exr"), args.size, &right)?;
    pictures(bug, args.size, &wrong, &right, &caption)?.picture.write(&folder.join(format!("{}.png", bug.name)))?;
    let ratios = measured(wrong.series.image(), right.series.image());
    signature::draw(&plot(&format!("{}: {}", bug.name, bug.what), bug, &ratios, theory), &caption)?
        .write(folder, &format!("{}-ratios", bug.name))?;
    let mut csv = Csv::new("k,ratio,std_error");
    ratios.iter().enumerate().for_each(|(k, r)| csv.put(k).put(r.value).put(r.std_error).end());
    write_atomically(&folder.join(MARK), (mark() + &csv.text()).as_bytes())?;
    let (folder, n) = (folder.display(), bug.name);
    blocks.push(format!("{folder}: {n}.exr, correct.exr, {n}.png, {n}-ratios.svg and .png, {MARK}"));
    print(&paragraphs(&blocks))?;
    Ok(session.ending(false))
}

/// The scene that shows the mistake, or the one that was asked for.
fn stage(args: &Zoo, bug: &Bug) -> Result<Stage, Failure> {
    let Some(name) = &args.scene else { return Ok(bug.exposed_by) };
    let scene = builtin::find(name).ok_or_else(|| {
        usage(&format!("`{name}` is no built-in scene"), &suggest(name, "built-in scenes", builtin::names()))
    })?;
    Ok(Stage { label: scene.name, scene: scene.name, set: &[] })
}

/// A row per term: right, wrong, r_k measured and predicted.
fn rows(bug: &Bug, wrong: &Sampled, right: &Sampled, theory: bool) -> String {
    let (w, r) = (wrong.series.image(), right.series.image());
    let mean = |e: &Estimate| significant(e.mean.element_sum() / 3.0, 4);
    let line = |name: &str, w: &Estimate, r: &Estimate, predicted: Option<f64>| {
        let predicted = predicted.map_or(String::new(), |r| significant(r, 4));
        let line =
            format!("{name:6} {:>10}  {:>10}  {:>12}  {predicted:>10}", mean(r), mean(w), brief(&Ratio::of(w, r)));
        line.trim_end().to_string()
    };
    let mut lines = vec![format!("{:6} {:>10}  {:>10}  {:>12}  {:>10}", "k", "right", "wrong", "rₖ", "predicted")];
    for (k, (a, b)) in w.terms.iter().zip(&r.terms).enumerate() {
        lines.push(line(&k.to_string(), a, b, if theory { (bug.ratio)(k) } else { None }));
    }
    let last = w.terms.len().saturating_sub(1);
    if !w.tail.is_none() {
        lines.push(line(&format!("k > {last}"), &w.tail, &r.tail, None));
    }
    lines.push(line("whole", &w.total, &r.total, None));
    let bad = wrong.series.cost.non_finite;
    if bad > 0 {
        lines.push(format!("{bad} samples are no number"));
    }
    lines.join("\n")
}

/// r_k as a figure.
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

/// Right, wrong and how they differ, for the whole and for k = 1 to 3: each row at one exposure, the difference signed.
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
    // what is too bright in red, what is too dark in blue
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
