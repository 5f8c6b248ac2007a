//! The members of the zoo and their ratios r_k in words.

use crate::cli::base::{Failure, paragraphs, usage};
use fredholm::math::names::{either, similar};
use fredholm::report::half_width_95;
use fredholm::report::text::prose::{wrapped, wrapped_after};
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

/// All members, with a sentence above the list.
pub fn list() -> String {
    let mut blocks = vec![wrapped(&format!(
        "The zoo has {} estimators, each with one mistake.\n\
         Below each name: the mistake, a scene that shows it, and where it cannot be seen. `fredholm zoo NAME` renders one.",
        zoo::all().len()
    ))];
    for bug in zoo::all() {
        let blind = bug.blind.map_or("the whole image of any scene", |s| s.label);
        blocks.push(format!("{}\n  {}\n  seen in {}; not in {blind}", bug.name, bug.what, bug.exposed_by.label));
    }
    paragraphs(&blocks)
}

/// The name of a member and its mistake as a sentence.
pub fn mistake(bug: &Bug) -> String {
    wrapped(&format!("{}: {}.", bug.name, bug.what))
}

/// Facts about a member: those of [`signature`], and scenes that show and hide the mistake.
pub fn facts(bug: &Bug) -> String {
    let blind = bug.blind.map_or("the whole image of any scene: its sum is right", |s| s.label);
    let seen = format!("{}, from {} samples per pixel at {p}x{p}", bug.exposed_by.label, bug.spp, p = zoo::PIXELS);
    format!("{}\n{}\n{}", signature(bug), fact("seen in", &seen), fact("not in", blind))
}

/// The wrong formula of a member, its result, and its signature.
pub fn signature(bug: &Bug) -> String {
    [("where", bug.place), ("gives", bug.expected), ("signature", bug.signature)]
        .map(|(what, text)| fact(what, text))
        .join("\n")
}

/// A fact in indented lines after its name.
fn fact(what: &str, text: &str) -> String {
    // blanks that wrapping keeps
    wrapped_after(&format!("\u{a0}\u{a0}{what:\u{a0}<10} {text}"), &" ".repeat(13))
}

/// The ratio of the whole images; where the wrong paths are cut at K, its image is compared with the right sum of the terms
/// k ≤ K.
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
    // the error has two digits
    let decimals = (1 - half.log10().floor() as i32).clamp(0, 6) as usize;
    format!("{:.decimals$}({:.0})", r.value, half * 10f64.powi(decimals as i32))
}
