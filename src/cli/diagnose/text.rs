//! The text of a diagnosis. One picture: what is wrong, the evidence and the next step, a line each. Many pictures: a table with a line
//! for each.

use super::args::Grouping;
use super::evidence::{self, percent};
use super::found::Diagnosed;
use crate::cli::session::Session;
use fredholm::diagnosis::hints::first_wrong_term;
use fredholm::diagnosis::{Basis, Conclusion, Diagnosis, Slot, Suspicion};
use fredholm::report::figures::diagnosis as figure;
use fredholm::report::text::prose::{WIDTH, counted, wrapped, wrapped_after};
use fredholm::report::text::table::significant;

/// Facts about a command that all its texts use.
pub struct Text<'a> {
    /// How several files belong together.
    pub how: Grouping,
    /// The reference: scene, estimator, K, samples.
    pub label: &'a str,
    /// Light that the reference finds only by rare paths.
    pub rare_paths: Option<&'a str>,
}

/// The name of a file without its folders.
pub fn short(name: &str) -> String {
    name.rsplit('/').next().unwrap_or(name).to_owned()
}

/// The verdict in a few words, for figures and JSON.
pub fn headline(d: &Diagnosis) -> String {
    match d.verdict {
        Conclusion::Correct => "correct, as far as this data can tell".into(),
        Conclusion::Undecided => {
            let why: Vec<&str> = d.limits.iter().map(|l| l.why.as_str()).collect();
            format!("cannot tell, because {}", why.join("; "))
        }
        Conclusion::Wrong => match what(d) {
            Some(what) => format!("wrong: {what}"),
            None => "wrong, and the cause is not in the list of known mistakes".into(),
        },
    }
}

/// The title of a figure: the file, the verdict, and the names of what is wrong.
pub fn title(f: &Diagnosed) -> String {
    let names: Vec<&str> = f.diagnosis.named().map(|s| s.name.as_str()).take(2).collect();
    let verdict = match f.diagnosis.verdict {
        Conclusion::Correct => "correct",
        Conclusion::Undecided => "cannot tell",
        Conclusion::Wrong if names.is_empty() => "wrong, of unknown cause",
        Conclusion::Wrong => "wrong",
    };
    format!("{}: {}", short(&f.name), [&[verdict], names.as_slice()].concat().join(", "))
}

/// What is wrong: everything that the file shows, and the explanations of the rest.
fn what(d: &Diagnosis) -> Option<String> {
    let found = d.findings.iter().map(|s| s.what.clone());
    let rest: Vec<&str> = d.suspects.iter().map(|s| s.what.as_str()).collect();
    let rest = match rest.as_slice() {
        [] => None,
        [one] => Some((*one).to_owned()),
        many => {
            let each: Vec<String> = many.iter().enumerate().map(|(i, what)| format!("({}) {what}", i + 1)).collect();
            Some(format!("one of these, which this data cannot tell apart: {}", each.join("; ")))
        }
    };
    // a wrong rest without an explanation
    let more = (rest.is_none() && !d.findings.is_empty() && !d.worst.is_empty())
        .then(|| "more is wrong, of unknown cause".to_owned());
    let all: Vec<String> = found.chain(rest).chain(more).collect();
    (!all.is_empty()).then(|| all.join("; and "))
}

/// The verdict on one picture as a sentence.
fn sentence(f: &Diagnosed) -> String {
    let (d, name) = (&f.diagnosis, short(&f.name));
    match d.verdict {
        Conclusion::Correct => format!("{name} is correct, as far as this data can tell."),
        Conclusion::Undecided => format!("{name}: {}.", headline(d)),
        Conclusion::Wrong => match what(d) {
            Some(what) => format!("{name} is wrong: {what}."),
            None => format!("{name} is wrong, and the cause is not in the list of known mistakes."),
        },
    }
}

/// The evidence for the verdict.
fn reasons(f: &Diagnosed) -> String {
    let d = &f.diagnosis;
    let mut all: Vec<String> = evidence::read_as(f).into_iter().collect();
    all.extend(d.findings.iter().map(|s| sentence_of(&s.why)));
    match d.suspects.as_slice() {
        [] => {
            all.extend(d.hints.iter().map(|h| sentence_of(h)));
            if !d.worst.is_empty() {
                all.push(format!("Largest difference: {}.", d.worst));
            }
        }
        [one] => all.push(sentence_of(&one.why)),
        many if many.iter().all(|s| s.basis == Basis::Simulated) => {
            all.push("Simulations of all of them agree with the picture.".into());
        }
        many => all.extend(many.iter().enumerate().map(|(i, s)| format!("({}) {}", i + 1, sentence_of(&s.why)))),
    }
    match d.verdict {
        Conclusion::Correct => all.extend(evidence::power(f)),
        // the limits are the sentence itself
        Conclusion::Undecided if d.worst.is_empty() => all.extend(evidence::power(f)),
        Conclusion::Undecided => {}
        Conclusion::Wrong => all.extend(d.limits.iter().map(|l| sentence_of(&l.why))),
    }
    all.join(" ")
}

/// The next step.
fn next(f: &Diagnosed) -> String {
    let d = &f.diagnosis;
    let steps: Vec<String> = match d.verdict {
        Conclusion::Undecided => d.limits.iter().map(|l| l.next.clone()).collect(),
        Conclusion::Wrong => {
            let mut steps: Vec<String> = d.named().take(2).map(|s| s.next.clone()).collect();
            steps.dedup();
            steps
        }
        Conclusion::Correct => vec![evidence::more(f)],
    };
    let steps = if steps.is_empty() { vec![unknown_cause(f)] } else { steps };
    sentence_of(&steps.join("; "))
}

/// What to do about a picture whose cause is not known.
fn unknown_cause(f: &Diagnosed) -> String {
    match first_wrong_term(&f.diagnosis.evidence) {
        _ if !f.terms => {
            "send the terms as layers (fredholm diagnose --how): the first wrong term tells where to look".into()
        }
        Some(0) => "compare the emission of the lamps and the camera with `fredholm info`".into(),
        Some(1) => {
            "look at direct light: lamps, shadow rays, BSDF and normals (`fredholm info` prints the scene)".into()
        }
        Some(k) => format!(
            "emission, camera and direct light are right, so look at what happens from the {} reflection on: directions, \
             roulette, clamps, the weight of the path",
            ordinal(k)
        ),
        None => "compare the longest paths: their number of bounces, and roulette".into(),
    }
}

fn ordinal(k: usize) -> String {
    match k {
        2 => "second".into(),
        3 => "third".into(),
        k => format!("{k}th"),
    }
}

fn sentence_of(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().map_or(String::new(), |c| c.to_uppercase().collect());
    let rest = letters.as_str().trim_end_matches('.');
    let end = if rest.ends_with('?') { "" } else { "." };
    format!("{first}{rest}{end}")
}

impl Text<'_> {
    /// The whole text, for people.
    pub fn people(&self, session: &Session, found: &[Diagnosed], files: &[String]) -> String {
        let how = match self.how {
            Grouping::Bounces => "The files are taken for the terms of one render (--as).\n",
            Grouping::Spp => "The files are taken for one render at growing samples per pixel (--as).\n",
            _ => "",
        };
        let mut below = format!("{how}reference: {}", self.label);
        let wrong = found.iter().any(|f| f.diagnosis.verdict == Conclusion::Wrong);
        if let (Some(rare_paths), true) = (self.rare_paths, wrong) {
            below += &format!(
                "\nwarning: of the reference: {rare_paths}. A difference may be light that it has not found yet."
            );
        }
        let below = wrapped(&below);
        match found {
            [one] => {
                let lines = [sentence(one), format!("Evidence: {}", reasons(one)), format!("Next: {}", next(one))];
                let mut details = vec![below, session.command().into()];
                details.extend(page(one));
                let warning = self.rare_paths.filter(|_| wrong).map(|r| {
                    format!("Warning: of the reference: {r}. A difference may be light that it has not found yet.")
                });
                let answer: Vec<String> = lines.into_iter().chain(warning).map(|l| wrapped(&l)).collect();
                session.text(&answer.join("\n"), &[], &details, files)
            }
            all => {
                let of = counted(all.len(), "picture");
                let count = |c| all.iter().filter(|f| f.diagnosis.verdict == c).count();
                let (wrong, open) = (count(Conclusion::Wrong), count(Conclusion::Undecided));
                let is = if wrong == 1 { "is" } else { "are" };
                let undecided = if open > 0 { format!(" {open} cannot be judged.") } else { String::new() };
                let answer = format!("{wrong} of {of} {is} wrong.{undecided}");
                let mut details: Vec<String> = vec![below];
                details.extend(all.iter().flat_map(|f| {
                    let lines = [sentence(f), format!("Evidence: {}", reasons(f)), format!("Next: {}", next(f))];
                    [lines.map(|l| wrapped(&l)).join("\n"), figure::table(&f.diagnosis, usize::MAX)]
                }));
                let numbers = [format!("diagnosis.json and {} more files", files.len().saturating_sub(1))];
                session.text(&answer, &[table(all)], &details, &numbers)
            }
        }
    }
}

/// Everything behind the three lines: facts, ratios, explanations, families and simulations.
fn page(f: &Diagnosed) -> Vec<String> {
    let d = &f.diagnosis;
    let above = "Means of the picture and of the correct one for every term, their ratio r, and whether r is the same in all regions of \
                 the image; if not, its range.";
    let mut details =
        vec![wrapped(&evidence::facts(f).join("\n")), format!("{}\n{}", wrapped(above), figure::table(d, usize::MAX))];
    if d.named().next().is_some() {
        details.push(explanations(d));
    }
    if !d.families.is_empty() {
        details.push(evidence::families(d));
    }
    if !d.candidates.is_empty() {
        details.push(evidence::candidates(d));
    }
    details
}

/// Every finding and explanation: its name, the kind of reason, the evidence and the next step.
fn explanations(d: &Diagnosis) -> String {
    let one = |(i, s): (usize, &Suspicion)| {
        let basis = match s.basis {
            Basis::Found => "the file itself shows it".into(),
            Basis::Simulated => {
                format!("simulated on this scene, it cannot be told from the picture (p = {})", significant(s.p, 2))
            }
            Basis::Family => format!("it describes every term and region (p = {})", significant(s.p, 2)),
        };
        // blanks that wrapping keeps
        let indented = |text: &str| wrapped_after(&format!("\u{a0}\u{a0}\u{a0}{text}"), "   ");
        let members = if s.members.is_empty() {
            String::new()
        } else {
            format!("looks like: fredholm zoo {}", s.members.join(", "))
        };
        let lines = [s.what.clone(), basis, s.why.clone(), format!("next: {}", s.next), members];
        let head = wrapped_after(&format!("{}. {}", i + 1, s.name), "   ");
        let rest = lines.iter().filter(|l| !l.is_empty()).map(|l| indented(l));
        std::iter::once(head).chain(rest).collect::<Vec<_>>().join("\n")
    };
    let all: Vec<String> = d.named().enumerate().map(one).collect();
    format!("What is wrong, or could be:\n{}", all.join("\n"))
}

/// The verdict in a table; *correct* comes with the smallest bias that would have been seen.
fn brief(d: &Diagnosis) -> String {
    match d.verdict {
        Conclusion::Wrong | Conclusion::Undecided => headline(d),
        Conclusion::Correct => format!("correct, as far as this data can tell: bias < {}", percent(d.visible)),
    }
}

/// One line per picture.
fn table(found: &[Diagnosed]) -> String {
    let width = found.iter().map(|f| short(&f.name).chars().count()).max().unwrap_or(4).clamp(4, 30);
    let above = "The ratio r = mean of the picture/mean of the correct one for the whole image, and the verdict; \
                 bias < x: a larger uniform bias would have been seen with probability 0.99.";
    let mut out = format!("{}\n{:<width$}  {:>8}  verdict\n{}\n", wrapped(above), "file", "r", "─".repeat(WIDTH));
    for f in found {
        let r = f.diagnosis.evidence.ratio(Slot::Whole).or(f.diagnosis.evidence.ratios.last());
        let ratio = r.map_or(String::new(), |r| significant(r.value, 3));
        let line = format!("{:<width$}  {ratio:>8}  {}", short(&f.name), brief(&f.diagnosis));
        if line.chars().count() <= WIDTH {
            out += &format!("{line}\n");
        } else {
            out += &format!("{}…\n", line.chars().take(WIDTH - 1).collect::<String>());
        }
    }
    out += "Give one file, or --verbose, for the evidence and the next step.\n";
    if found.iter().any(|f| f.diagnosis.verdict == Conclusion::Correct) {
        out +=
            &wrapped("One file cannot show samples that repeat; two with different samples per pixel can (--as spp).");
    }
    out
}

/// All diagnoses as JSON.
pub fn json(found: &[Diagnosed]) -> serde_json::Value {
    let one = |f: &Diagnosed| {
        serde_json::json!({
            "file": f.name,
            "headline": headline(&f.diagnosis),
            "evidence": reasons(f),
            "next": next(f),
            "diagnosis": f.diagnosis,
        })
    };
    serde_json::Value::Array(found.iter().map(one).collect())
}
