//! The page of a diagnosis: verdict, evidence, suspects; and the table of many.

use super::args::{Diagnose, Grouping};
use super::found::Diagnosed;
use crate::cli::base::paragraphs;
use fredholm::diagnosis::{Basis, Conclusion, Diagnosis, Slot, Suspicion};
use fredholm::report::text::table::significant;
use fredholm::zoo;
use std::path::Path;

/// What all pages of a command share.
pub struct Text<'a> {
    pub args: &'a Diagnose,
    pub how: Grouping,
    pub label: &'a str,
    pub rare_paths: Option<&'a str>,
    pub folder: &'a Path,
}

const WIDTH: usize = 98;

/// The name of a file without its folders.
pub fn short(name: &str) -> String {
    name.rsplit('/').next().unwrap_or(name).to_owned()
}

/// The verdict in a few words.
pub fn headline(d: &Diagnosis) -> String {
    match (d.verdict, d.suspects.as_slice()) {
        (Conclusion::Correct, _) => "correct, as far as this data can tell".into(),
        (_, []) => "wrong, and unlike anything in the zoo".into(),
        (_, list) if list.iter().all(|s| s.basis == Basis::Points) => {
            format!("wrong; the evidence points to {}", names(list))
        }
        (_, [one]) => format!("wrong: {}", one.name),
        (_, list) => format!("wrong: {}", names(list)),
    }
}

fn names(list: &[Suspicion]) -> String {
    let all: Vec<&str> = list.iter().take(4).map(|s| s.name.as_str()).collect();
    let more = if list.len() > 4 { format!(" or {} more", list.len() - 4) } else { String::new() };
    all.join(" or ") + &more
}

fn wrapped(text: &str, indent: &str) -> String {
    let (mut out, mut line) = (String::new(), String::new());
    for word in text.split_whitespace() {
        if !line.is_empty() && indent.len() + line.chars().count() + 1 + word.chars().count() > WIDTH {
            out += &format!("{indent}{line}\n");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    out + indent + &line
}

fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}

impl Text<'_> {
    /// Everything, for people.
    pub fn people(&self, found: &[Diagnosed], files: &[String]) -> String {
        let how = match self.how {
            Grouping::Bounces => "files taken for the terms of one render (--as)",
            Grouping::Spp => "files taken for one render at growing samples per pixel (--as)",
            _ => "",
        };
        let head = format!("against {}", self.label);
        let mut blocks: Vec<String> = if let [one] = found { vec![self.one(one)] } else { vec![table(found)] };
        blocks.insert(1.min(blocks.len()), wrapped(&head, "") + if how.is_empty() { "" } else { "\n" } + how);
        if let (Some(rare_paths), true) =
            (self.rare_paths, found.iter().any(|f| f.diagnosis.verdict == Conclusion::Wrong))
        {
            blocks.push(wrapped(
                &format!(
                    "warning: of the reference: {rare_paths}. A difference may be light that it has not found yet."
                ),
                "",
            ));
        }
        blocks.push(format!(
            "written to {}: {} files, the numbers in diagnosis.json",
            self.folder.display(),
            files.len()
        ));
        paragraphs(&blocks)
    }

    fn one(&self, f: &Diagnosed) -> String {
        let d = &f.diagnosis;
        let mut out = wrapped(&format!("{}: {}", short(&f.name), headline(d)), "") + "\n";
        out += &match d.verdict {
            Conclusion::Correct => wrapped(
                &format!(
                    "No mean of any region differs by more than its noise (smallest adjusted p = {}). {}",
                    significant(d.p, 2),
                    limits(d)
                ),
                "",
            ),
            Conclusion::Wrong if d.worst.is_empty() => String::new(),
            Conclusion::Wrong => {
                wrapped(&format!("Furthest off: {} (adjusted p = {}).", d.worst, significant(d.p, 2)), "")
            }
        };
        let mut blocks = vec![out, evidence(f)];
        if !d.suspects.is_empty() {
            blocks.push(suspects(&d.suspects));
        }
        if d.verdict == Conclusion::Wrong && d.suspects.is_empty() {
            let n = d.candidates.len();
            let best = d.candidates.first();
            let nearest = best.map_or(String::new(), |c| {
                format!(" The nearest is {}, off by {:.1} standard errors in the mean square.", c.name, c.misfit.sqrt())
            });
            blocks.push(wrapped(
                &format!("None of {n} simulated mistakes and no simple rule for r_k looks like this.{nearest} Are scene, materials and camera the same?"),
                "",
            ));
        }
        if self.args.shared.verbose && !d.candidates.is_empty() {
            blocks.push(candidates(d));
        }
        paragraphs(&blocks)
    }
}

/// What a verdict of *correct* leaves open.
fn limits(d: &Diagnosis) -> String {
    let seen = if d.visible.is_finite() {
        format!("A uniform bias above {} would have been seen with probability 0.99.", percent(d.visible))
    } else {
        "Too few pixels carry the noise: no bias of any size would have been seen.".into()
    };
    let of = |slot: &Slot| {
        let r = d.evidence.ratio(*slot).map_or(f64::NAN, |r| r.value);
        format!("{slot} (r = {})", significant(r, 3))
    };
    let undecided: Vec<String> = d.undecided.iter().map(of).collect();
    if undecided.is_empty() {
        return seen;
    }
    format!(
        "{seen} Nothing can be said of {}: fewer than ten pixels carry the noise there. More samples per pixel would decide",
        undecided.join(", ")
    ) + "."
}

/// The table of the ratios, and single facts below it.
fn evidence(f: &Diagnosed) -> String {
    let (d, e) = (&f.diagnosis, &f.diagnosis.evidence);
    let mut out = format!("{:<6} {:>10} {:>10} {:>8}  {:>8}   flat in space?\n", "", "mean", "right", "r", "± 95 %");
    out += &format!("{}\n", "─".repeat(66));
    for r in &e.ratios {
        let flat = match r.flat {
            p if p.is_nan() => "–".into(),
            p if p < 1e-3 => {
                let known = || r.regions[1..].iter().copied().filter(|v| v.is_finite());
                let (lo, hi) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
                format!("no, {} to {}", significant(lo, 3), significant(hi, 3))
            }
            p => format!("yes (p = {})", significant(p, 2)),
        };
        let [a, b] = r.means.map(|m| significant(m, 4));
        let (value, half) = if r.value.is_finite() {
            (significant(r.value, 4), significant(r.half_width, 2))
        } else {
            ("–".into(), "–".into())
        };
        out += &format!("{:<6} {a:>10} {b:>10} {value:>8}  {half:>8}   {flat}\n", r.slot.to_string());
    }
    let mut facts = vec![format!("errors of the suspect: from {}", e.errors)];
    let samples = e.samples / (f.factor * f.factor) as f64;
    if samples.is_finite() && d.verdict == Conclusion::Correct {
        let mut line =
            format!("its noise is that of about {} samples per pixel of the reference", significant(samples, 2));
        if let Some(told) = f.told.filter(|told| *told > 2.5 * samples) {
            line += &format!(
                "; the file says {told}: a noisier way of sampling, or the same random numbers again. Two files with different samples per pixel would tell"
            );
        }
        facts.push(line);
    }
    if d.verdict == Conclusion::Correct && d.samples.is_none() {
        facts.push(
            "one file cannot show samples that repeat: two with different samples per pixel can (r_16.exr r_64.exr)"
                .into(),
        );
    }
    if f.any_gain {
        facts.push(
            "exposure unknown: brought to the brightness of the reference, so a uniform factor cannot be seen".into(),
        );
    }
    if !f.terms {
        facts.push("no terms in the file: only the whole image could be compared".into());
    }
    if let Some([sum, half, right]) = e.sum {
        facts.push(format!("whole image over the sum of its own layers: {sum:.4} ± {half:.4}, {right:.4} is right"));
    }
    let c = &e.counts;
    if c.non_finite + c.negative > 0 {
        facts.push(format!("{} values are not finite, {} are negative", c.non_finite, c.negative));
    }
    if c.black > 0.01 {
        facts.push(format!(
            "up to {} of the pixels of a picture are black where the reference is not",
            percent(c.black)
        ));
    }
    if c.clipped > 0.0 {
        facts.push(format!(
            "{} of the pixels are at the end of 8 bits; they and their neighbours are left out",
            percent(c.clipped)
        ));
    }
    if let Some(s) = &d.samples {
        let means: Vec<String> = s.means.iter().map(|m| format!("{:.4} at {}", m[1], m[0])).collect();
        facts.push(format!("mean over the right one by samples per pixel: {}", means.join(", ")));
        if s.slope.is_finite() {
            facts.push(format!("squared error falls as samples^{:.2}", s.slope));
        }
    }
    if !f.ignored.is_empty() {
        facts.push(format!("layers not understood: {}", f.ignored.join(", ")));
    }
    out + &facts.iter().map(|f| wrapped(f, "")).collect::<Vec<_>>().join("\n")
}

/// The short list.
fn suspects(list: &[Suspicion]) -> String {
    let one = |(i, s): (usize, &Suspicion)| {
        let bug = zoo::find(&s.name);
        let what = bug.map_or(String::new(), |b| format!(": {}", b.what));
        let basis = match s.basis {
            Basis::Simulated => {
                format!("simulated on this scene it cannot be told from the suspect (p = {})", significant(s.p, 2))
            }
            Basis::Pattern => {
                format!("a rule for r_k that fits every picture and region (p = {})", significant(s.p, 2))
            }
            Basis::Points => "single pieces of evidence, not an explanation of all".into(),
        };
        let mut lines = vec![wrapped(&format!("{}. {}{what}", i + 1, s.name), ""), wrapped(&basis, "   ")];
        if !s.why.is_empty() {
            lines.push(wrapped(&s.why, "   "));
        }
        let next = match bug {
            _ if list.len() == 1 && !s.next.is_empty() => s.next.clone(),
            Some(b) => format!(
                "{}fredholm zoo {} shows it; a scene that shows it well: {}",
                if s.next.is_empty() { String::new() } else { format!("{}; ", s.next) },
                s.name,
                b.exposed_by.label
            ),
            None => s.next.clone(),
        };
        lines.push(wrapped(&format!("next: {next}"), "   "));
        lines.join("\n")
    };
    let head = if list.len() == 1 { "suspect" } else { "suspects: this data cannot tell them apart" };
    let shown: Vec<String> = list.iter().take(6).enumerate().map(one).collect();
    let more =
        if list.len() > 6 { format!("\n… and {} more in diagnosis.json", list.len() - 6) } else { String::new() };
    format!("{head}\n{}{more}", shown.join("\n"))
}

/// Who was simulated.
fn candidates(d: &Diagnosis) -> String {
    let mut out =
        format!("{:<28} {:>6} {:>12} {:>14}\n{}\n", "candidate", "spp", "p, adjusted", "rms deviation", "─".repeat(63));
    for c in &d.candidates {
        let p = if c.rejected { format!("{} ✗", significant(c.p, 2)) } else { significant(c.p, 2) };
        out += &format!("{:<28} {:>6} {p:>12} {:>11.1} se\n", c.name, c.spp, c.misfit.sqrt());
    }
    out
}

/// The verdict in a table: what is called correct says how closely one has looked.
fn brief(d: &Diagnosis) -> String {
    let undecided: Vec<String> = d.undecided.iter().map(ToString::to_string).collect();
    match d.verdict {
        Conclusion::Wrong => headline(d),
        Conclusion::Correct if d.visible.is_infinite() => "nothing can be told: too few pixels carry the noise".into(),
        Conclusion::Correct if undecided.is_empty() => {
            format!("correct, as far as this data can tell: bias < {}", percent(d.visible))
        }
        Conclusion::Correct => {
            let open = undecided.join(", ");
            format!("undecided in {open}; elsewhere correct: bias < {}", percent(d.visible))
        }
    }
}

/// One line per file.
fn table(found: &[Diagnosed]) -> String {
    let width = found.iter().map(|f| short(&f.name).chars().count()).max().unwrap_or(4).min(40);
    let mut out = format!("{:<width$}  verdict\n{}\n", "file", "─".repeat((width + 50).min(WIDTH)));
    for f in found {
        let r = f.diagnosis.evidence.ratio(Slot::Whole).or(f.diagnosis.evidence.ratios.last());
        let ratio = r.map_or(String::new(), |r| format!(" (r = {})", significant(r.value, 3)));
        let line = format!("{:<width$}  {}{ratio}", short(&f.name), brief(&f.diagnosis));
        let cut: String = line.chars().take(WIDTH).collect();
        out += &format!("{cut}\n");
    }
    let wrong = found.iter().filter(|f| f.diagnosis.verdict == Conclusion::Wrong).count();
    out += &format!("\n{wrong} of {} are wrong", found.len());
    if wrong < found.len() {
        out += "\n";
        out += &wrapped(
            "bias < x: a larger uniform one would have been seen with probability 0.99. One file cannot show samples that \
             repeat; two with different samples per pixel can.",
            "",
        );
    }
    out
}

/// Everything, for programs.
pub fn json(found: &[Diagnosed]) -> serde_json::Value {
    let one = |f: &Diagnosed| {
        serde_json::json!({
            "file": f.name,
            "headline": headline(&f.diagnosis),
            "exposure_unknown": f.any_gain,
            "diagnosis": f.diagnosis,
        })
    };
    serde_json::Value::Array(found.iter().map(one).collect())
}
