//! How the noise of several renders falls with the samples: in sentences, and in a small table.

use super::fall::{Fall, number, slope_text};
use crate::report::half_width_95;
use crate::report::text::{
    prose::{listed, wrapped},
    ranking::{Candidate, Ranking},
    table::{Side, aligned},
};
use crate::stats::critical;
use crate::study::convergence::NoiseCurve;
use crate::terms::Variance;

/// Most lines of the table.
const MOST: usize = 12;
/// Level of all slopes together: a slope that differs from −1 at this level is called different.
const LEVEL: f64 = 0.05;

/// n · V(n) · rays of the whole image at the last n, where the variance is known to be finite.
fn ranking(falls: &[Fall]) -> Ranking {
    let candidate = |f: &Fall| {
        let (last, all) = (f.stands.last()?, f.parts.last()?);
        let s = last.parts.last().filter(|_| all.variance == Variance::Finite)?;
        let (v, scale) = (s.variance(), f64::from(last.spp) * f.cost(last)[0]);
        Some(Candidate {
            name: f.label.clone(),
            work: scale * v,
            without: (0..s.replicates()).map(|i| scale * s.variance_without(i)).collect(),
            relative_error: s.variance_error() / v,
            replicates: s.replicates() as u64,
        })
    };
    Ranking::new(falls.iter().filter_map(candidate).collect())
}

/// The answer: whether the variance of the whole image falls as 1/n; with several renders also which needs the fewest rays.
pub fn answer(falls: &[Fall]) -> String {
    let slopes: Vec<_> = falls.iter().filter_map(|f| Some((f, f.parts.last()?.slope()?))).collect();
    let t = |f: &Fall| {
        let replicates = f.stands.last().and_then(|s| s.parts.last()).map_or(0, |s| s.replicates());
        critical(LEVEL / slopes.len() as f64, replicates as f64 - 1.0)
    };
    let mut out = vec![];
    for (how, sign) in [("as 1/n", 0), ("faster than 1/n", -1), ("more slowly than 1/n", 1)] {
        let such = slopes.iter().filter(|(f, s)| {
            let off = s.slope + 1.0;
            let side = if off.abs() <= t(f) * s.std_error { 0 } else { off.signum() as i32 };
            side == sign
        });
        let names: Vec<String> = such.clone().map(|(f, _)| format!("`{}`", f.label)).collect();
        let values: Vec<String> = such.map(|(_, s)| slope_text(Some(*s))).collect();
        match values.len() {
            0 => {}
            1 => out.push(format!(
                "The variance of the whole image falls {how} for {}: its slope on logarithmic axes is {} (standard \
                 error), and 1/n has slope −1.",
                names[0], values[0]
            )),
            _ => out.push(format!(
                "The variance of the whole image falls {how} for {}: their slopes on logarithmic axes are {}, and 1/n \
                 has slope −1.",
                listed(&names),
                listed(&values)
            )),
        }
    }
    if slopes.is_empty() {
        let few = falls.iter().all(|f| f.stands.len() < 2);
        let why = if few { "one number of samples has no slope; choose at least --spp 32" } else { UNKNOWN };
        out.push(format!("How the variance of the whole image falls is not known: {why}."));
    }
    if falls.len() > 1 {
        let n = falls.iter().filter_map(|f| Some(f.stands.last()?.spp)).min().unwrap_or(0);
        out.push(ranking(falls).sentence("settings", "the whole image", &format!("{n} samples per pixel")));
    }
    wrapped(&out.join(" "))
}

const UNKNOWN: &str = "it may be infinite, or too few samples found light";

/// Returns true if a render was compared with a reference.
fn referred(f: &Fall) -> bool {
    f.parts.iter().any(|p| p.points.iter().any(|q| q.1.squared_error().is_some()))
}

/// V(n) with the half width of its 95 % interval, its slope, and with a reference RMSE and the slope of the squared error.
fn cells(p: &NoiseCurve, referred: bool) -> Vec<String> {
    let Some((_, s)) = p.points.last() else { return vec!["–".into(); if referred { 5 } else { 3 }] };
    let half = half_width_95(s.variance_error(), s.replicates() as u64);
    let mut out = vec![number(s.variance()), number(half), slope_text(p.slope())];
    if referred {
        let mse = s.squared_error().unwrap_or(f64::NAN);
        out.push(if mse < 0.0 { "≤ noise".into() } else { number(mse.sqrt()) });
        out.push(slope_text(p.error_slope()));
    }
    out
}

/// The table. One render: every term. Several: the whole image of each. `reference` names the reference, if there is one.
pub fn small_table(falls: &[Fall], reference: Option<&str>) -> String {
    let referred = falls.iter().any(referred);
    let last = falls.iter().filter_map(|f| Some(f.stands.last()?.spp)).max().unwrap_or(0);
    let mut header = vec![if falls.len() > 1 { "setting" } else { "k" }, "V(n)", "± 95 %", "slope ± se"];
    if referred {
        header.extend(["RMSE(n)", "slope of MSE"]);
    }
    let mut head = format!("V(n) is the variance of the mean of n = {last} samples");
    let mut lines = vec![];
    if let [f] = falls {
        head += " of each term, of the tail and of the whole image (`all`).";
        lines.extend(f.parts.iter().map(|p| [vec![p.name.clone()], cells(p, referred)].concat()));
    } else {
        head += ", of the whole image. Rays: rays for the same error, relative to the best.";
        header.push("rays (± 95 %)");
        let ranking = ranking(falls);
        for f in falls {
            let Some(all) = f.parts.last() else { continue };
            lines.push([vec![f.label.clone()], cells(all, referred), vec![ranking.cell_with_error(&f.label)]].concat());
        }
    }
    head += " slope: of log V against log n, with its standard error.";
    if let Some(label) = reference {
        head += &format!(" RMSE: root of the mean squared error against {label}; its variance is subtracted.");
    }
    // the last lines hold the tail and the whole image
    let cut = lines.len().saturating_sub(MOST);
    if cut > 0 {
        let keep = MOST - 2;
        lines.drain(keep..keep + cut);
    }
    lines.insert(0, header.into_iter().map(String::from).collect());
    let sides = [[Side::Left].as_slice(), &[Side::Right; 6]].concat();
    let mut out = format!("{}\n{}", wrapped(&head), aligned(&lines, &sides[..lines[0].len()]));
    if cut > 0 {
        out += &format!("{cut} lines are left out: --verbose\n");
    }
    out
}
