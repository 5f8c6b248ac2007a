//! Which of the given schedules is best: in one sentence for each quantity, and in a small table.

use super::rows::{Row, shown};
use crate::report::half_width_95;
use crate::report::text::{
    number::{plus_minus, significant},
    prose::{listed, wrapped},
    ranking::{Candidate, Ranking},
    table::{Side, aligned},
};
use crate::stats::Noise;
use crate::study::roulette::Aim;
use crate::terms::cross_moments::Value;

/// Most lines of a small table.
const MOST: usize = 11;

/// The quantity in words.
pub fn quantity(aim: Aim) -> &'static str {
    match aim {
        Aim::Whole => "the whole image",
        Aim::Indirect => "indirect light (terms k ≥ 2)",
    }
}

/// 1/(V · rays) of a quantity.
pub(super) fn efficiency(noise: &Noise, aim: Aim) -> Value {
    if aim == Aim::Whole { noise.efficiency } else { noise.indirect_efficiency }
}

/// `0.24 ± 0.01`, with the half width of the 95 % interval. A half width below 0.5 % is left out.
pub(super) fn with_half_width(v: Value, replicates: u64) -> String {
    let half = half_width_95(v.std_error, replicates);
    match v.value {
        x if x.is_nan() => "–".into(),
        1.0 if half == 0.0 => "1".into(),
        x if half < 5e-3 * x.abs() => significant(x, 3),
        // one digit of the error; two where the first is a 1, because rounding would hide much
        x => plus_minus(x, half, if half / 10f64.powf(half.log10().floor()) < 2.0 { 2 } else { 1 }),
    }
}

/// The answer: the best of the schedules for each of the quantities, as predicted, or as measured where q depends on the path.
pub fn answer(rows: &[Row], aims: &[Aim]) -> String {
    let one = |&aim: &Aim| {
        let candidate = |r: &Row| {
            let e = efficiency(r.predicted.as_ref().or(r.measured.as_ref())?, aim);
            let relative_error = e.std_error / e.value;
            let (name, replicates) = (r.name.clone(), r.replicates);
            Some(Candidate { name, work: 1.0 / e.value, relative_error, replicates, without: vec![] })
        };
        Ranking::new(rows.iter().filter_map(candidate).collect()).short_sentence(quantity(aim))
    };
    let mut sentences: Vec<String> = aims.iter().map(one).collect();
    let unknown = |r: &&Row| r.predicted.is_none() && r.measured.is_none();
    let unknown: Vec<String> = rows.iter().filter(unknown).map(|r| format!("`{}`", r.name)).collect();
    if !unknown.is_empty() {
        let verb = if unknown.len() == 1 { "depends" } else { "depend" };
        sentences.push(format!("{} {verb} on the path and must be rendered: add --verify.", listed(&unknown)));
    }
    wrapped(&sentences.join(" "))
}

/// The schedules, one line each: cost, and rays for the same error relative to the lecture's schedule; z if they were
/// rendered. `doubtful` names the schedules whose measured variance means nothing: their z is put in parentheses.
pub fn small_table(rows: &[Row], doubtful: &[&str]) -> String {
    // V · rays of the lecture's schedule, which need not be among the rows
    let base = |aim: Aim| {
        rows.iter().find_map(|r| {
            Some(1.0 / (efficiency(r.predicted.as_ref()?, aim).value * r.relative.as_ref()?.of(aim).value))
        })
    };
    let verified = rows.iter().any(|r| r.z().is_some());
    let header = match verified {
        true => vec!["schedule", "rays/path", "whole image", "z", "indirect light", "z"],
        false => vec!["schedule", "rays/path", "whole image", "indirect light"],
    };
    let mut lines = vec![header.into_iter().map(String::from).collect::<Vec<_>>()];
    for r in rows.iter().take(MOST) {
        let mut cells = vec![shown(&r.name)];
        let noise = r.predicted.as_ref().or(r.measured.as_ref());
        cells.push(noise.map_or("–".into(), |n| significant(n.rays.value, 3)));
        let doubted = doubtful.contains(&r.name.as_str());
        let z = |z: f64| if doubted { format!("({z:+.1})") } else { format!("{z:+.1}") };
        for (aim, deviation) in Aim::ALL.into_iter().zip([r.z(), r.indirect_z()]) {
            let measured = || {
                let e = efficiency(r.measured.as_ref()?, aim);
                let value = 1.0 / (e.value * base(aim)?);
                Some(Value { value, std_error: value * e.std_error / e.value })
            };
            let v = r.relative.as_ref().map(|v| v.of(aim)).or_else(measured);
            cells.push(v.map_or("–".into(), |v| with_half_width(v, r.replicates)));
            if verified {
                cells.push(deviation.map_or("–".into(), z));
            }
        }
        lines.push(cells);
    }
    let mut head =
        "Rays per path, and the rays that each schedule needs for the same error, relative to the lecture's \
                    schedule (± 95 %): less than 1 is better."
            .to_owned();
    if verified {
        head += " z: measured minus predicted variance, in standard errors.";
    }
    let mut out =
        format!("{}\n{}", wrapped(&head), aligned(&lines, &[[Side::Left].as_slice(), &[Side::Right; 5]].concat()));
    if rows.len() > MOST {
        out += &format!("{} more schedules are in roulette.csv\n", rows.len() - MOST);
    }
    out
}

/// The sentence that says whether the measured variances agree with the predicted ones; None if nothing was compared.
/// `critical` is the |z| from which on a prediction is contradicted.
pub fn verified<'a>(rows: impl Iterator<Item = &'a Row>, critical: f64) -> Option<String> {
    let all: Vec<f64> = rows.flat_map(|r| [r.z(), r.indirect_z()]).flatten().map(f64::abs).collect();
    let largest = all.iter().copied().fold(f64::NAN, f64::max);
    let beyond = all.iter().filter(|z| **z > critical).count();
    let text = match (all.len(), beyond) {
        (0, _) => return None,
        (n, 0) => format!(
            "The measured variances agree with the predicted ones: the largest |z| of {n} comparisons is {largest:.1}, and \
             {critical:.1} would contradict a prediction."
        ),
        (n, _) => format!(
            "The measured variances contradict the predicted ones in {beyond} of {n} comparisons: the largest |z| is \
             {largest:.1}, and {critical:.1} is the limit."
        ),
    };
    Some(wrapped(&text))
}
