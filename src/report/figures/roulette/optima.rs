//! The optimal schedules for the whole image and for indirect light next to each other, and why they differ.
//!
//! "Best" means best of all schedules whose q depends only on the vertex. Roulette by albedo depends on the path, too.

use super::answer::{efficiency, quantity, with_half_width};
use super::rows::Row;
use crate::report::half_width_95;
use crate::report::text::{
    number::significant,
    prose::wrapped,
    table::{Side, aligned},
};
use crate::study::roulette::Aim;
use crate::terms::cross_moments::Value;

/// From this share of T0 on, T0 is given as the reason why the two optima differ.
const DOMINANT: f64 = 0.5;
/// q of this many vertices is printed.
const VERTICES: usize = 10;

/// Shares of the variance of the whole image without roulette. They add up to 1 if the terms are uncorrelated.
#[derive(Clone, Debug, PartialEq)]
pub struct Shares {
    /// Of each term, k = 0, 1, ….
    pub terms: Vec<Value>,
    /// Of indirect light, k ≥ 2.
    pub indirect: Value,
}

fn row(rows: &[Row], aim: Aim) -> Option<&Row> {
    rows.iter().find(|r| r.name == aim.schedule_name())
}

/// The answer, the table of what each optimum does to each term with the probabilities q, and what rendering found.
/// Empty if no optimum is among the rows.
pub fn optima(rows: &[Row], shares: &Shares, aims: &[Aim]) -> (String, Vec<String>) {
    let found: Vec<(Aim, &Row)> = aims.iter().filter_map(|&a| Some((a, row(rows, a)?))).collect();
    let tables = vec![per_term(&found, shares) + &probabilities(&found), measured(rows, &found)];
    (wrapped(&(gains(&found) + &reason(&found, shares))), tables)
}

/// How many rays each optimum needs for the quantity that it is optimal for.
fn gains(found: &[(Aim, &Row)]) -> String {
    let one = |(i, (aim, r)): (usize, &(Aim, &Row))| {
        let needs = r.relative.as_ref().map_or("–".into(), |v| with_half_width(v.of(*aim), r.replicates));
        let needs = if needs == "1" { "1.00".into() } else { needs };
        let (quantity, name) = (quantity(*aim), &r.name);
        match i {
            0 => format!(
                "For {quantity}, the best schedule (`{name}`) needs {needs} times the rays of the lecture's schedule for the \
                 same error."
            ),
            _ => format!("For {quantity}, the best one (`{name}`) needs {needs} times."),
        }
    };
    found.iter().enumerate().map(one).collect::<Vec<_>>().join(" ")
}

/// A sentence on the two optima: why the one for the whole image makes indirect light noisy, or, where it does not, which part
/// of the variance each of T0, T1 and indirect light has.
fn reason(found: &[(Aim, &Row)], shares: &Shares) -> String {
    let share = |v: Option<&Value>| v.map_or("–".into(), |v| format!("{} %", significant(100.0 * v.value, 2)));
    let t0 = shares.terms.first();
    let whole = found.iter().find(|f| f.0 == Aim::Whole).map(|f| f.1);
    if let (Some(whole), Some(v)) = (whole, t0)
        && v.value > DOMINANT
    {
        let differ = if found.len() > 1 { "They differ because T0" } else { "T0" };
        let mut text = format!(
            " {differ}, emission seen directly, has {} of the variance of the whole image, and roulette cannot reduce it.",
            share(t0)
        );
        // the vertex near the camera where the schedule ends most paths
        let most = whole.q.iter().take(3).copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let terms = whole.relative.iter().flat_map(|r| &r.terms).map(|v| v.value).enumerate().skip(1);
        let hurt = terms.filter(|t| t.1 > 1.0).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((v, q)) = most {
            text += &format!(
                " So `optimal` ends {:.0} % of the paths at vertex {v} and spends the rays on new camera paths",
                100.0 * q
            );
            text += &hurt.map_or(".".into(), |(k, times)| {
                format!("; T{k} then needs {} times the rays.", significant(times, 2))
            });
        }
        return text;
    }
    format!(
        " Without roulette, T0 (emission seen directly) has {}, T1 (direct light) {} and indirect light {} of the variance \
         of the whole image.",
        share(t0),
        share(shares.terms.get(1)),
        share(Some(&shares.indirect))
    )
}

/// Predicted rays for the same error of every part, for each optimum.
fn per_term(found: &[(Aim, &Row)], shares: &Shares) -> String {
    let mut header = vec!["part of the image", "share"];
    header.extend(found.iter().map(|f| f.0.schedule_name()));
    let mut lines = vec![header.into_iter().map(String::from).collect::<Vec<_>>()];
    let mut line = |name: String, share: Option<f64>, of: &dyn Fn(&Row) -> Option<Value>| {
        let share = share.map_or("–".into(), |s| format!("{} %", significant(100.0 * s, 2)));
        let cell = |(_, r): &(Aim, &Row)| of(r).map_or("–".into(), |v| with_half_width(v, r.replicates));
        lines.push([name, share].into_iter().chain(found.iter().map(cell)).collect());
    };
    line("whole image".into(), Some(1.0), &|r| Some(r.relative.as_ref()?.whole));
    line("indirect, k ≥ 2".into(), Some(shares.indirect.value), &|r| Some(r.relative.as_ref()?.indirect));
    let terms = found.iter().filter_map(|f| Some(f.1.relative.as_ref()?.terms.len())).max().unwrap_or(0);
    for k in 0..terms {
        let share = shares.terms.get(k).map(|v| v.value);
        line(format!("T{k}"), share, &|r| r.relative.as_ref()?.terms.get(k).copied());
    }
    let head = "Predicted rays for the same error, relative to the lecture's schedule; share of the variance without \
                roulette; q[v], probability that a path ends at vertex v.";
    let sides = [[Side::Left].as_slice(), &[Side::Right; 3]].concat();
    format!("{}\n{}", wrapped(head), aligned(&lines, &sides))
}

/// q of the first vertices, one line for each optimum.
fn probabilities(found: &[(Aim, &Row)]) -> String {
    let mut out = String::new();
    for (aim, r) in found {
        let q: Vec<String> = r.q.iter().take(VERTICES).map(|q| format!("{q:.2}")).collect();
        let more = if r.q.len() > VERTICES { "  …" } else { "" };
        out += &format!("q[v], {:<16}  {}{more}\n", aim.schedule_name(), q.join("  "));
    }
    out
}

/// What rendering found: each optimum against the lecture's schedule and against roulette by albedo, for its own quantity.
fn measured(rows: &[Row], found: &[(Aim, &Row)]) -> String {
    let of = |name: &str, aim: Aim| {
        let r = rows.iter().find(|r| r.name == name)?;
        Some(efficiency(r.measured.as_ref()?, aim))
    };
    let (mut parts, mut beaten) = (vec![], false);
    for (aim, r) in found {
        let Some(own) = of(aim.schedule_name(), *aim) else { continue };
        let mut against = |rival: &str| {
            let other = of(rival, *aim)?;
            let value = other.value / own.value;
            let std_error = value * (own.std_error / own.value).hypot(other.std_error / other.value);
            beaten |= rival == "albedo" && value - half_width_95(std_error, r.replicates) > 1.0;
            Some((with_half_width(Value { value, std_error }, r.replicates), format!("`{rival}`")))
        };
        let all: Vec<(String, String)> = ["lecture", "albedo"].into_iter().filter_map(&mut against).collect();
        // what is compared is said once
        let rays = if parts.is_empty() { " times the rays" } else { " times those" };
        let all: Vec<String> = all.iter().map(|(times, rival)| format!("{times}{rays} of {rival}")).collect();
        if !all.is_empty() {
            let of = if *aim == Aim::Whole { "the whole image" } else { "indirect light" };
            parts.push(format!("for {of} `{}` needs {}", r.name, all.join(" and ")));
        }
    }
    if parts.is_empty() {
        return String::new();
    }
    let mut text = format!("Measured: {}.", parts.join("; "));
    if beaten {
        text += " Roulette by albedo adapts to the path, so it can do better.";
    }
    wrapped(&text)
}
