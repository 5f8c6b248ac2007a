//! `index.html`: the report of a run as one file that opens from disk, with no network and no script.
//!
//! Pictures are embedded as data URIs and plots as inline SVG, so the page can be mailed or handed in. Colours follow
//! the reader's light or dark setting; inside the plots, too.

use base64::prelude::{BASE64_STANDARD, Engine};
use std::{fmt::Write, path::Path};

use crate::report::{
    ReportError, files,
    image::typeset::escape,
    text::{
        number::{average, count, dash, error, known, mark, outcome, p_value, percent, signed, significant},
        rows::{Cell, Column, Rows},
        summary::VerdictRecord,
    },
    write_atomically,
};
use crate::stats::Outcome;
use crate::terms::Functional;

/// Everything on the page.
#[derive(Clone, Debug, Default)]
pub struct Page<'a> {
    /// Heading, usually the scene.
    pub title: String,
    /// The command that makes the page again.
    pub command: String,
    /// Short facts beside it: seed, samples, size, time.
    pub facts: Vec<(String, String)>,
    /// What was compared, and the results.
    pub verdicts: &'a [VerdictRecord],
    /// Pictures and plots in the order of the page.
    pub plates: Vec<Plate<'a>>,
    /// Label and image means of each world.
    pub series: Vec<(String, &'a Functional)>,
    /// Names (relative to the page) and meanings of the files beside it.
    pub files: Vec<(String, String)>,
}

/// A picture (`.png`) or plot (`.svg`) with its words.
#[derive(Clone, Debug)]
pub struct Plate<'a> {
    /// Heading above it.
    pub heading: &'a str,
    /// One or two sentences on what it shows.
    pub text: &'a str,
    /// For those who cannot see it.
    pub alt: &'a str,
    /// The file to embed.
    pub path: &'a Path,
}

impl<'a> Plate<'a> {
    /// The contact sheet of all terms.
    pub fn terms(path: &'a Path) -> Self {
        Self {
            heading: "The terms, one by one",
            text: "Each picture is the light that has been scattered exactly k times. Every picture has its own \
                   exposure, printed beneath it: without the gain the later terms would be black.",
            alt: "Contact sheet of the terms of the Neumann series",
            path,
        }
    }

    /// Direct beside direct plus indirect light.
    pub fn direct_and_indirect(path: &'a Path) -> Self {
        Self {
            heading: "What indirect light adds",
            text: "Left, lamps and direct light only (k ≤ 1); right, the whole series. Both have the same exposure.",
            alt: "Direct illumination beside full illumination",
            path,
        }
    }

    /// The decay plot.
    pub fn decay(path: &'a Path) -> Self {
        Self {
            heading: "How fast the series converges",
            text: "The norm of each term against k. On this logarithmic axis a geometric series is a straight line; \
                   its slope settles at the spectral radius. Only the bound by the largest albedo is a guarantee, and \
                   only for the surface norm.",
            alt: "Norms of the terms against the number of bounces, on a logarithmic axis",
            path,
        }
    }

    /// The variance plot.
    pub fn variance(path: &'a Path) -> Self {
        Self {
            heading: "How fast the noise falls",
            text: "Variance of the mean against samples per pixel. Independent samples with finite variance follow \
                   the dashed line of slope −1: four times the work halves the error.",
            alt: "Variance against samples per pixel on doubly logarithmic axes",
            path,
        }
    }
}

/// Writes the page.
///
/// # Errors
/// If a plate cannot be read or is neither `.png` nor `.svg`, or the page cannot be written.
pub fn write(path: &Path, page: &Page) -> Result<(), ReportError> {
    write_atomically(path, render(page)?.as_bytes())
}

/// The page as text.
///
/// # Errors
/// If a plate cannot be read or is neither `.png` nor `.svg`.
pub fn render(page: &Page) -> Result<String, ReportError> {
    let mut body = String::new();
    let title = escape(&page.title);
    let command = escape(&page.command);
    body += &format!("<header>\n<h1>{title}</h1>\n<p class=\"equation\">L = E + T L = Σ T<sup>k</sup> E</p>\n");
    body += &format!("<p>Made by</p>\n<pre><code>{command}</code></pre>\n");
    if !page.facts.is_empty() {
        let fact = |(name, value): &(String, String)| {
            format!("<div><dt>{}</dt><dd>{}</dd></div>", escape(name), escape(value))
        };
        body += &format!("<dl>{}</dl>\n", page.facts.iter().map(fact).collect::<String>());
    }
    body += "</header>\n<main>\n";
    body += &verdict_section(page.verdicts);
    for plate in &page.plates {
        body += &plate_section(plate)?;
    }
    body += &series_section(&page.series);
    body += &file_section(&page.files);
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title} · fredholm</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n{body}</main>\n</body>\n</html>\n"
    ))
}

fn verdict_section(verdicts: &[VerdictRecord]) -> String {
    if verdicts.is_empty() {
        return String::new();
    }
    let count = |wanted| verdicts.iter().filter(|v| v.outcome == wanted).count();
    let [agrees, differs, open] = [Outcome::Agrees, Outcome::Differs, Outcome::Inconclusive].map(count);
    let columns = [
        (Column::Difference, "difference"),
        (Column::Interval, "interval"),
        (Column::P, "p"),
        (Column::Detectable, "detectable"),
        (Column::Outcome, "verdict"),
    ];
    let table = table("what", &columns, &Rows::verdicts(verdicts), None);
    format!(
        "<section>\n<h2>Do the worlds agree?</h2>\n<p class=\"tally\"><b>{agrees}</b> agree, <b>{differs}</b> differ, \
         <b>{open}</b> inconclusive.</p>\n<p>Agreement is a claim that has to be earned: the interval of the \
         difference must hold zero <em>and</em> lie within the margin. If it is too wide the verdict is inconclusive, \
         and more samples decide. <em>Detectable</em> is the smallest difference the comparison would have found.</p>\n\
         {table}</section>\n"
    )
}

fn plate_section(plate: &Plate) -> Result<String, ReportError> {
    let unsuitable = |cause: &str| ReportError::new(plate.path, cause, "embed a .png picture or a .svg plot");
    let bytes = files::read(plate.path)?;
    let alt = escape(plate.alt);
    let picture = match plate.path.extension().and_then(|e| e.to_str()) {
        Some("png") => format!("<img alt=\"{alt}\" src=\"data:image/png;base64,{}\">", BASE64_STANDARD.encode(&bytes)),
        Some("svg") => {
            let svg = String::from_utf8(bytes).map_err(|_| unsuitable("the plot is not UTF-8 text"))?;
            // In HTML the name space is understood; the page then holds no address at all.
            let svg = svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
            let rest = svg.strip_prefix("<svg").ok_or_else(|| unsuitable("the plot does not start with <svg"))?;
            format!("<svg role=\"img\" aria-label=\"{alt}\"{rest}")
        }
        _ => return Err(unsuitable("neither .png nor .svg")),
    };
    let (heading, text) = (escape(plate.heading), escape(plate.text));
    Ok(format!("<section>\n<h2>{heading}</h2>\n<p>{text}</p>\n<figure>{picture}</figure>\n</section>\n"))
}

fn series_section(series: &[(String, &Functional)]) -> String {
    if series.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<section>\n<h2>The series in numbers</h2>\n<p>Image means, averaged over the three channels, with 95 % \
         intervals. The dots stand on one logarithmic axis per table, the interval as a line through them; an \
         arrow to the left means that the interval reaches zero.</p>\n",
    );
    let columns = [(Column::World(0), "mean"), (Column::Ratio, "ratio"), (Column::Share, "share")];
    for (label, functional) in series {
        let total = average(&functional.total).0;
        let values = || functional.terms.iter().chain([&functional.tail]).map(|e| average(e).0).filter(|&v| v > 0.0);
        let (lo, hi) = (values().fold(total, f64::min), values().fold(total, f64::max));
        let rows = Rows::series(&[functional], &[]).without_repetition();
        let table = table("k", &columns, &rows, Some((lo / 1.5, hi * 1.5)));
        out += &format!("<h3>{}</h3>\n{table}", escape(label));
    }
    out + "</section>\n"
}

/// A table; an estimate takes two columns, its mean and its error. With a `scale`, estimates are also drawn in a last column.
fn table(first: &str, columns: &[(Column, &str)], rows: &Rows, scale: Option<(f64, f64)>) -> String {
    let mut head = format!("<th scope=\"col\">{first}</th>");
    for (column, words) in columns {
        let class = if *column == Column::Outcome { " class=\"word\"" } else { "" };
        head += &format!("<th scope=\"col\"{class}>{words}</th>");
        if matches!(column, Column::World(_)) {
            head += "<th scope=\"col\">± 95 %</th>";
        }
    }
    if scale.is_some() {
        head += "<th scope=\"col\">log scale</th>";
    }
    let mut body = String::new();
    let columns: Vec<Column> = columns.iter().map(|c| c.0).collect();
    for (name, cells) in rows.pick(&columns) {
        let words: String = cells.iter().copied().map(cell).collect();
        let drawn = scale.map_or(String::new(), |scale| {
            format!("<td>{}</td>", cells.iter().map(|c| dot(c, scale)).collect::<String>())
        });
        let _ = writeln!(body, "<tr><th scope=\"row\">{}</th>{words}{drawn}</tr>", escape(&name.to_string()));
    }
    format!("<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n")
}

fn cell(cell: &Cell) -> String {
    let words = match cell {
        Cell::Blank => String::new(),
        Cell::Words(words) => escape(words),
        Cell::Estimate(e) => {
            let mean = if e.is_none() { "not estimated".into() } else { significant(average(e).0, 4) };
            format!("{mean}</td><td>{}", error(e))
        }
        Cell::Ratio(ratio) if ratio.is_finite() => significant(*ratio, 3),
        Cell::Ratio(_) => dash(),
        Cell::Share(share) => percent(*share),
        Cell::Rays(rays) => rays.map_or_else(dash, count),
        Cell::Difference(effect) => signed(*effect),
        Cell::Interval(low, high) => format!("[{}, {}]", signed(*low), signed(*high)),
        Cell::P(p) => p_value(*p),
        Cell::Size(size) => known(*size),
        Cell::Outcome(found) => {
            let word = outcome(*found);
            return format!("<td class=\"word {word}\">{} {word}</td>", mark(*found));
        }
    };
    format!("<td>{words}</td>")
}

/// A dot with its interval on a logarithmic axis from `lo` to `hi`, 180 pixels wide.
fn dot(cell: &Cell, (lo, hi): (f64, f64)) -> String {
    let Cell::Estimate(estimate) = cell else { return String::new() };
    let (mean, half) = average(estimate);
    let half = if half.is_nan() { 0.0 } else { half };
    if !(lo > 0.0 && hi > lo && mean > 0.0) {
        return String::new();
    }
    let place = |v: f64| (180.0 * (v / lo).ln() / (hi / lo).ln()).clamp(0.0, 180.0);
    let (left, right) = (place((mean - half).max(lo)), place(mean + half));
    let arrow = if mean - half <= 0.0 { "<path class=\"dot\" d=\"M0 7l6 -4v8z\"/>" } else { "" };
    format!(
        "<svg class=\"bar\" width=\"180\" height=\"14\" aria-hidden=\"true\"><line x1=\"{left:.1}\" x2=\"{right:.1}\" \
         y1=\"7\" y2=\"7\"/>{arrow}<circle class=\"dot\" cx=\"{:.1}\" cy=\"7\" r=\"3.5\"/></svg>",
        place(mean)
    )
}

fn file_section(files: &[(String, String)]) -> String {
    if files.is_empty() {
        return String::new();
    }
    let item = |(name, meaning): &(String, String)| {
        let meaning = escape(meaning);
        format!("<li><a href=\"{}\"><code>{}</code></a> {meaning}</li>\n", address(name), escape(name))
    };
    let items: String = files.iter().map(item).collect();
    format!("<section>\n<h2>Files</h2>\n<ul>\n{items}</ul>\n</section>\n")
}

/// A relative file name as an address: everything but letters, digits and `-._~/` in percent form. The leading `./`
/// keeps a colon in the name from being read as a scheme.
fn address(name: &str) -> String {
    name.bytes().fold(String::from("./"), |mut out, b| {
        if b.is_ascii_alphanumeric() || b"-._~/".contains(&b) {
            out.push(char::from(b));
        } else {
            let _ = write!(out, "%{b:02X}");
        }
        out
    })
}

const STYLE: &str = "
:root { --paper: #ffffff; --ink: #1b1b1b; --soft: #5c5c5c; --line: #dcdcdc; --card: #f6f6f4; --blue: #0072b2;
  --good: #00734f; --bad: #b33c00; --open: #7a5c00; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #17181a; --ink: #e8e8e6; --soft: #a9a9a6; --line: #3a3b3e; --card: #202124; --blue: #6cb8e6;
    --good: #4cc9a0; --bad: #ff8f57; --open: #e6b84c; }
  figure svg [fill=\"#FFFFFF\"] { fill: var(--paper); }
  figure svg [fill=\"#000000\"] { fill: var(--ink); }
  figure svg [stroke=\"#000000\"] { stroke: var(--ink); }
  figure svg [fill=\"#555555\"] { fill: var(--soft); }
  figure svg [stroke=\"#555555\"] { stroke: var(--soft); }
  figure svg [stroke=\"#DEDEDE\"] { stroke: #3a3b3e; }
  figure svg [stroke=\"#F0F0F0\"] { stroke: #26272a; }
  figure svg [stroke=\"#0072B2\"] { stroke: #4aa8e0; }
  figure svg [fill=\"#0072B2\"] { fill: #4aa8e0; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 66rem; padding: 1.5rem 1.25rem 4rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.55 system-ui, sans-serif; }
h1 { margin: 0; font-size: 2rem; line-height: 1.2; }
h2 { margin: 3rem 0 .4rem; font-size: 1.35rem; }
h3 { margin: 1.6rem 0 .4rem; font-size: 1.05rem; }
p { max-width: 46rem; }
.equation { margin: .3rem 0 1.2rem; color: var(--soft); font-family: Georgia, serif; font-style: italic;
  font-size: 1.15rem; }
pre { margin: 0; padding: .7rem .9rem; background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  white-space: pre-wrap; overflow-wrap: anywhere; }
code { font-family: ui-monospace, \"DejaVu Sans Mono\", monospace; font-size: .92em; }
dl { display: flex; flex-wrap: wrap; gap: .5rem 2rem; margin: 1rem 0 0; }
dt { color: var(--soft); font-size: .82rem; }
dd { margin: 0; font-variant-numeric: tabular-nums; }
figure { margin: 1rem 0 0; }
figure img, figure svg { display: block; max-width: 100%; height: auto; border: 1px solid var(--line);
  border-radius: 6px; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .28rem .8rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
thead th { color: var(--soft); font-weight: 600; font-size: .88rem; }
tbody th { font-weight: 400; text-align: left; }
thead th:first-child { text-align: left; }
.word, thead th.word { text-align: left; font-weight: 600; }
.agrees { color: var(--good); } .differs { color: var(--bad); } .inconclusive { color: var(--open); }
.bar { display: block; } .bar line { stroke: var(--blue); stroke-width: 2; } .dot { fill: var(--blue); }
a { color: var(--blue); }
@media print { body { max-width: none; } section { break-inside: avoid; } }
";
