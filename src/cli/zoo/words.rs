//! The members and their ratios in words.

use crate::cli::base::{Failure, paragraphs, usage};
use fredholm::math::names::{either, similar};
use fredholm::report::half_width_95;
use fredholm::report::text::table::significant;
use fredholm::terms::Functional;
use fredholm::zoo::signature::Ratio;
use fredholm::zoo::{self, Bug};

/// There is no member of that name: the error names the nearest ones.
pub fn unknown(name: &str) -> Failure {
    let near = match similar(name, zoo::all().into_iter().map(|b| b.name).collect::<Vec<_>>()).as_slice() {
        [] => String::new(),
        near => format!("did you mean {}? ", either(near)),
    };
    usage(&format!("the zoo has no member `{name}`"), &format!("{near}`fredholm zoo --list` lists all members"))
}

/// Who lives there.
pub fn list() -> String {
    let mut blocks = vec![format!("{} estimators, each wrong in one place", zoo::all().len())];
    for bug in zoo::all() {
        let blind = bug.blind.map_or("the whole image of every scene", |s| s.label);
        blocks.push(format!("{}\n  {}\n  seen in {}; not in {blind}", bug.name, bug.what, bug.exposed_by.label));
    }
    paragraphs(&blocks)
}

/// A member in words.
pub fn introduction(bug: &Bug) -> String {
    let blind = bug.blind.map_or("the whole image of every scene: its sum is right", |s| s.label);
    let mut lines = vec![format!("{}: {}", bug.name, bug.what)];
    let seen = format!("{}, from {} samples per pixel at {p}x{p}", bug.exposed_by.label, bug.spp, p = zoo::PIXELS);
    for (what, text) in [
        ("where", bug.place),
        ("gives", bug.expected),
        ("signature", bug.signature),
        ("seen in", &seen),
        ("not in", blind),
    ] {
        lines.extend(wrapped(&format!("  {what:10} "), text));
    }
    lines.join("\n")
}

/// Text in lines of at most 96 characters, the later ones indented.
fn wrapped(head: &str, text: &str) -> Vec<String> {
    let mut lines = vec![head.to_string()];
    for word in text.split(' ') {
        let last = lines.last().map_or(0, |l| l.chars().count());
        if last + word.chars().count() > 96 {
            lines.push(format!("  {:10} ", ""));
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(word);
            line.push(' ');
        }
    }
    lines.into_iter().map(|l| l.trim_end().to_string()).collect()
}

/// The whole against the whole, or the sum where paths are cut at K.
pub fn whole(wrong: &Functional, right: &Functional) -> Ratio {
    Ratio::of(&wrong.total, if wrong.tail.is_none() { &right.sum } else { &right.total })
}

/// `2.001(12)`: a value with the half width of its 95 % interval in units of the last digit.
pub fn brief(r: &Ratio) -> String {
    if r.value.is_nan() {
        return "–".into();
    }
    let half = half_width_95(r.std_error, r.replicates);
    if !(half > 0.0 && half.is_finite()) || half < 1e-4 * r.value.abs() {
        return significant(r.value, 4);
    }
    // two digits of the error
    let decimals = (1 - half.log10().floor() as i32).clamp(0, 6) as usize;
    format!("{:.decimals$}({:.0})", r.value, half * 10f64.powi(decimals as i32))
}
