//! The text of a diagnosis. One picture: the verdict, the ratios r_k, the suspects. Many pictures: a table with a line for each.

use super::args::Grouping;
use super::evidence::{self, percent};
use super::found::Diagnosed;
use crate::cli::session::Session;
use fredholm::diagnosis::{Basis, Conclusion, Diagnosis, Slot, Suspicion};
use fredholm::report::figures::diagnosis as figure;
use fredholm::report::text::prose::{WIDTH, counted, wrapped, wrapped_after};
use fredholm::report::text::table::significant;
use fredholm::zoo;

/// Facts about a command that all its texts use.
pub struct Text<'a> {
    /// How several files belong together.
    pub how: Grouping,
    /// The reference: scene, estimator, K, samples.
    pub label: &'a str,
    /// Light that the reference finds only by rare paths.
    pub rare_paths: Option<&'a str>,
}

/// Suspects that are described without `--verbose`.
const SHOWN: usize = 1;

/// The name of a file without its folders.
pub fn short(name: &str) -> String {
    name.rsplit('/').next().unwrap_or(name).to_owned()
}

/// The verdict in a few words, for figures and JSON.
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

/// The verdict on one picture as a sentence.
fn sentence(f: &Diagnosed) -> String {
    let (d, name) = (&f.diagnosis, short(&f.name));
    match (d.verdict, d.suspects.as_slice()) {
        (Conclusion::Correct, _) if d.visible.is_infinite() => {
            format!("{name}: nothing can be told, because too few pixels carry the noise.")
        }
        (Conclusion::Correct, _) => format!(
            "{name} is correct, as far as this data can tell: a uniform bias above {} would have been seen with probability \
             0.99.",
            percent(d.visible)
        ),
        (_, []) => format!("{name} is wrong, and unlike every mistake of the zoo."),
        (_, list) if list.iter().all(|s| s.basis == Basis::Points) => {
            format!("{name} is wrong; the evidence points to {}.", names(list))
        }
        (_, [one]) => match zoo::find(&one.name) {
            Some(bug) => format!("{name} is wrong: {}, {}.", one.name, bug.what),
            None => format!("{name} is wrong: {}.", one.name),
        },
        (_, list) => format!("{name} is wrong: {}; this data cannot tell them apart.", names(list)),
    }
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
                let (answer, mut tables, mut details) = page(one);
                if let Some(ratios) = tables.first_mut() {
                    *ratios = format!("{}\n{below}", ratios.trim_end());
                }
                details.insert(0, session.command().into());
                session.text(&answer, &tables, &details, files)
            }
            all => {
                let wrong = all.iter().filter(|f| f.diagnosis.verdict == Conclusion::Wrong).count();
                let (is, of) = (if wrong == 1 { "is" } else { "are" }, counted(all.len(), "picture"));
                let answer = format!("{wrong} of {of} {is} wrong.");
                let details: Vec<String> = all
                    .iter()
                    .map(|f| format!("The ratios of {}.\n{}", short(&f.name), figure::table(&f.diagnosis, usize::MAX)))
                    .collect();
                let numbers = [format!("diagnosis.json and {} more files", files.len().saturating_sub(1))];
                session.text(&answer, &[table(all), below], &details, &numbers)
            }
        }
    }
}

/// The text about one picture: answer, tables, details.
fn page(f: &Diagnosed) -> (String, Vec<String>, Vec<String>) {
    let d = &f.diagnosis;
    let mut answer = vec![sentence(f)];
    match d.verdict {
        Conclusion::Correct => answer.extend(undecided(d)),
        Conclusion::Wrong if d.worst.is_empty() => {}
        Conclusion::Wrong => answer.push(format!("Furthest off: {} (adjusted p = {}).", d.worst, significant(d.p, 2))),
    }
    if d.verdict == Conclusion::Wrong && d.suspects.is_empty() {
        let nearest = d.candidates.first().map_or(String::new(), |c| {
            format!(" The nearest is {}, off by {:.1} standard errors in the mean square.", c.name, c.misfit.sqrt())
        });
        answer.push(format!(
            "None of the {} known mistakes explains the ratios of your terms to the correct ones, and they follow no simple rule.{nearest} Are scene, materials and camera the same?",
            d.candidates.len()
        ));
    }
    let [important, other] = evidence::facts(f).map(|facts| wrapped(&facts.join("\n")));
    let ratios = format!(
        "{}\n{}{important}",
        wrapped(
            "Means of the picture and of the right one for every term, their ratio r, and whether r is the same in all regions \
             of the image; if not, its range."
        ),
        figure::table(d, evidence::ROWS)
    );
    let mut tables = vec![ratios];
    let mut details = vec![other];
    if d.evidence.ratios.len() > evidence::ROWS {
        details.push(format!("The ratios of all terms.\n{}", figure::table(d, usize::MAX)));
    }
    if !d.suspects.is_empty() {
        tables.push(suspects(&d.suspects, SHOWN));
    }
    if d.suspects.len() > SHOWN {
        details.push(suspects(&d.suspects, usize::MAX));
    }
    if !d.candidates.is_empty() {
        details.push(evidence::candidates(d));
    }
    (wrapped(&answer.join("\n")), tables, details)
}

/// The terms about which a verdict of *correct* says nothing, if there are any.
fn undecided(d: &Diagnosis) -> Option<String> {
    let of = |slot: &Slot| {
        let r = d.evidence.ratio(*slot).map_or(f64::NAN, |r| r.value);
        format!("{slot} (r = {})", significant(r, 3))
    };
    let undecided: Vec<String> = d.undecided.iter().map(of).collect();
    (!undecided.is_empty()).then(|| {
        format!(
            "Nothing can be said about {}: fewer than ten pixels carry the noise there. More samples per pixel would decide.",
            undecided.join(", ")
        )
    })
}

/// The first `most` suspects: the mistake, the reason why it is suspected, and the next step.
fn suspects(list: &[Suspicion], most: usize) -> String {
    let one = |(i, s): (usize, &Suspicion)| {
        let bug = zoo::find(&s.name);
        let what = bug.map_or(String::new(), |b| format!(": {}", b.what));
        let basis = match s.basis {
            Basis::Simulated => {
                format!("simulated on this scene, it cannot be told from the picture (p = {})", significant(s.p, 2))
            }
            Basis::Pattern => {
                format!("a rule for r_k that fits every term and region (p = {})", significant(s.p, 2))
            }
            Basis::Points => "single pieces of evidence, which do not explain everything".into(),
        };
        // blanks that wrapping keeps
        let indented = |text: &str| wrapped_after(&format!("\u{a0}\u{a0}\u{a0}{text}"), "   ");
        let mut lines = vec![wrapped_after(&format!("{}. {}{what}", i + 1, s.name), "   "), indented(&basis)];
        if !s.why.is_empty() {
            lines.push(indented(&s.why));
        }
        let next = match bug {
            _ if list.len() == 1 && !s.next.is_empty() => s.next.clone(),
            Some(b) => format!(
                "{}`fredholm zoo {}` shows it; a scene that shows it well: {}",
                if s.next.is_empty() { String::new() } else { format!("{}; ", s.next) },
                s.name,
                b.exposed_by.label
            ),
            None => s.next.clone(),
        };
        lines.push(indented(&format!("next: {next}")));
        lines.join("\n")
    };
    let head = if list.len() == 1 {
        "The mistake that fits:"
    } else {
        "The mistakes that fit; this data cannot tell them apart:"
    };
    let shown: Vec<String> = list.iter().take(most).enumerate().map(one).collect();
    let left = list.len() - shown.len();
    let more = if left > 0 { format!("\n… and {left} more in diagnosis.json") } else { String::new() };
    format!("{head}\n{}{more}", shown.join("\n"))
}

/// The verdict in a table; *correct* comes with the smallest bias that would have been seen.
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

/// One line per picture.
fn table(found: &[Diagnosed]) -> String {
    let width = found.iter().map(|f| short(&f.name).chars().count()).max().unwrap_or(4).clamp(4, 30);
    let above = "The ratio r = mean of the picture/mean of the right one for the whole image, and the verdict; \
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
            "exposure_unknown": f.any_gain,
            "diagnosis": f.diagnosis,
        })
    };
    serde_json::Value::Array(found.iter().map(one).collect())
}
