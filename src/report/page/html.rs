//! `index.html`: the report of a run as one file that opens from disk, with no network.
//!
//! ```text
//! title, answer → the images, in the hands of the reader → comparisons, tables folded → small tables → plots → numbers, folded → how it was made
//! ```
//!
//! Images are embedded as floats ([`data`](super::data)), plots as inline SVG, so that the page can be mailed or handed in. Scripts
//! ([`script`]) draw both; without them the plots are still there. The colours of the page follow the reader's light
//! or dark setting.

use base64::prelude::{BASE64_STANDARD, Engine};
use std::{fmt::Write, path::Path};

use super::{data::Data, script, tables};
use crate::report::{
    ReportError, files,
    image::typeset::escape,
    text::{
        grid::Grid,
        number::average,
        rows::{Column, Rows},
        summary::VerdictRecord,
    },
    write_atomically,
};
use crate::terms::Functional;

/// Everything on the page.
#[derive(Clone, Debug, Default)]
pub struct Page<'a> {
    /// Heading, usually the scene.
    pub title: String,
    /// The answer: one sentence.
    pub answer: String,
    /// The images and numbers that the scripts draw.
    pub data: Option<&'a Data>,
    /// Plots, and pictures for a page without data.
    pub plates: Vec<Plate<'a>>,
    /// One sentence for each comparison, with the numbers behind it.
    pub comparisons: Vec<(String, Vec<VerdictRecord>)>,
    /// Small tables.
    pub grids: Vec<Grid>,
    /// Label and image means of each result.
    pub series: Vec<(String, &'a Functional)>,
    /// The command that makes the page again.
    pub command: String,
    /// Short facts about the run: seed, samples, size, time.
    pub facts: Vec<(String, String)>,
    /// Names (relative to the page) and meanings of the files beside it.
    pub files: Vec<(String, String)>,
}

/// A picture (`.png`) or plot (`.svg`) with heading and text.
#[derive(Clone, Debug)]
pub struct Plate<'a> {
    /// Heading above it.
    pub heading: &'a str,
    /// One or two sentences on what it shows.
    pub text: &'a str,
    /// A description for readers who cannot see it.
    pub alt: &'a str,
    /// The file to embed.
    pub path: &'a Path,
    /// The name of the plot that replaces it where scripts run; none for a picture.
    pub plot: Option<&'a str>,
}

impl<'a> Plate<'a> {
    /// The contact sheet of all terms, each with its own exposure.
    pub fn terms(path: &'a Path) -> Self {
        Self {
            heading: "The terms, one by one",
            text: "Each picture is the light that has been scattered exactly k times. Every picture has its own \
                   exposure, printed beneath it: without the gain the later terms would be black.",
            alt: "Contact sheet of the terms of the Neumann series",
            path,
            plot: None,
        }
    }

    /// The contact sheet of all terms with one exposure.
    pub fn terms_at_one_exposure(path: &'a Path) -> Self {
        let text = "Each picture is the light that has been scattered exactly k times. All pictures have the same exposure, so \
                    their brightness can be compared.";
        Self { text, ..Self::terms(path) }
    }

    /// Direct beside direct plus indirect light.
    pub fn direct_and_indirect(path: &'a Path) -> Self {
        Self {
            heading: "What indirect light adds",
            text: "Left, lamps and direct light only (k ≤ 1); right, the whole series. Both have the same exposure.",
            alt: "Direct illumination beside full illumination",
            path,
            plot: None,
        }
    }

    /// The decay plot.
    pub fn decay(path: &'a Path) -> Self {
        Self {
            heading: "How fast the series converges",
            text: "The norm of each term against k. On this logarithmic axis a geometric series is a straight line; \
                   the ratio of successive terms approaches the spectral radius. Only the bound by the largest albedo is a guarantee, and \
                   only for the surface norm.",
            alt: "Norms of the terms against the number of bounces, on a logarithmic axis",
            path,
            plot: Some("plot-decay"),
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
            plot: Some("plot-variance"),
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
    let title = escape(&page.title);
    let mut body = format!("<header>\n<h1>{title}</h1>\n<p class=\"equation\">L = E + T L = Σ T<sup>k</sup> E</p>\n");
    body += &format!("<p class=\"answer\">{}</p>\n</header>\n<main>\n", escape(&page.answer));
    if page.data.is_some() {
        body += VIEW;
    }
    body += &comparison_section(&page.comparisons);
    body += &grid_section(&page.grids);
    for plate in &page.plates {
        body += &plate_section(plate, page.data)?;
    }
    body += &series_section(&page.series);
    body += &made_section(page);
    let scripts = match page.data {
        Some(data) => {
            data.elements().map_err(|e| ReportError::new(Path::new("index.html"), e, "report this defect"))?
                + &script::elements()
        }
        None => String::new(),
    };
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title} · fredholm</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n{body}</main>\n{scripts}</body>\n</html>\n"
    ))
}

/// One sentence for each comparison; its table is folded.
fn comparison_section(comparisons: &[(String, Vec<VerdictRecord>)]) -> String {
    if comparisons.is_empty() {
        return String::new();
    }
    let columns = [
        (Column::Difference, "difference"),
        (Column::Interval, "interval"),
        (Column::P, "p"),
        (Column::Detectable, "detectable"),
        (Column::Outcome, "verdict"),
    ];
    let one = |(sentence, verdicts): &(String, Vec<VerdictRecord>)| {
        let table = tables::table("what", &columns, &Rows::verdicts(verdicts), None);
        format!("<details>\n<summary>{}</summary>\n{table}</details>\n", escape(sentence))
    };
    let all: String = comparisons.iter().map(one).collect();
    format!(
        "<section>\n<h2>Do the answers agree?</h2>\n{all}<p><em>Agrees</em> means that the whole interval of the difference \
         lies inside a margin of 2 % of the term. <em>Differs</em> means that the difference is proved not to be zero, \
         however small. Otherwise the comparison is <em>inconclusive</em>, and more samples would decide. Each row shows the channel \
         in which the answers may be furthest apart, with a 99.9 % interval that includes the error of the mesh. <em>p</em> is the \
         probability of such a difference by chance, corrected for the number of comparisons: 1 is no sign of a difference. \
         <em>Detectable</em> is the smallest difference that would have been found.</p>\n</section>\n"
    )
}

fn grid_section(grids: &[Grid]) -> String {
    let all: String = grids.iter().map(tables::grid).collect();
    if all.is_empty() { all } else { format!("<section>\n<h2>Which bounce matters</h2>\n{all}</section>\n") }
}

/// The command, the settings and the files.
fn made_section(page: &Page) -> String {
    let mut out =
        format!("<section>\n<h2>How this page was made</h2>\n<pre><code>{}</code></pre>\n", escape(&page.command));
    let fact =
        |(name, value): &(String, String)| format!("<div><dt>{}</dt><dd>{}</dd></div>", escape(name), escape(value));
    if !page.facts.is_empty() {
        out += &format!("<dl>{}</dl>\n", page.facts.iter().map(fact).collect::<String>());
    }
    out + &file_list(&page.files) + "</section>\n"
}

fn plate_section(plate: &Plate, data: Option<&Data>) -> Result<String, ReportError> {
    let unsuitable = |cause: &str| ReportError::new(plate.path, cause, "embed a .png picture or a .svg plot");
    let bytes = files::read(plate.path)?;
    let alt = escape(plate.alt);
    let picture = match plate.path.extension().and_then(|e| e.to_str()) {
        Some("png") => format!("<img alt=\"{alt}\" src=\"data:image/png;base64,{}\">", BASE64_STANDARD.encode(&bytes)),
        Some("svg") => {
            let svg = String::from_utf8(bytes).map_err(|_| unsuitable("the plot is not UTF-8 text"))?;
            // HTML knows the name space of SVG; without the attribute the page contains no address
            let svg = svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
            let rest = svg.strip_prefix("<svg").ok_or_else(|| unsuitable("the plot does not start with <svg"))?;
            format!("<svg role=\"img\" aria-label=\"{alt}\"{rest}")
        }
        _ => return Err(unsuitable("neither .png nor .svg")),
    };
    let (heading, text) = (escape(plate.heading), escape(plate.text));
    // where scripts run, a plot that answers replaces the still one
    let (still, plot) = match (plate.plot, data) {
        (Some(id), Some(data)) => (" data-still", answering(id, &data.command)),
        _ => ("", String::new()),
    };
    Ok(format!("<section>\n<h2>{heading}</h2>\n<p>{text}</p>\n<figure{still}>{picture}</figure>\n{plot}</section>\n"))
}

/// The place of a plot that a script draws, and the command that makes it.
fn answering(id: &str, command: &str) -> String {
    let command = escape(command);
    format!(
        "<div class=\"plot\" id=\"{id}\"></div>\n<p class=\"made\"><code>{command}</code> \
         <button type=\"button\" data-save-svg=\"{id}\">Save plot (SVG)</button></p>\n"
    )
}

fn series_section(series: &[(String, &Functional)]) -> String {
    if series.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<section>\n<h2>All terms in numbers</h2>\n<p>Means of the picture, averaged over the three channels, with 95 % \
         intervals. The dots show the same on one logarithmic axis per table, with the interval as a line; an \
         arrow to the left means that the interval reaches zero.</p>\n",
    );
    let columns = [(Column::World(0), "mean"), (Column::Ratio, "ratio"), (Column::Share, "share")];
    for (label, functional) in series {
        let total = average(&functional.total).0;
        let values = || functional.terms.iter().chain([&functional.tail]).map(|e| average(e).0).filter(|&v| v > 0.0);
        let (lo, hi) = (values().fold(total, f64::min), values().fold(total, f64::max));
        let rows = Rows::series(&[functional], &[]).without_repetition();
        let table = tables::table("k", &columns, &rows, Some((lo / 1.5, hi * 1.5)));
        out += &format!("<details>\n<summary>{}</summary>\n{table}</details>\n", escape(label));
    }
    out + "</section>\n"
}

fn file_list(files: &[(String, String)]) -> String {
    if files.is_empty() {
        return String::new();
    }
    let item = |(name, meaning): &(String, String)| {
        let meaning = escape(meaning);
        format!("<li><a href=\"{}\"><code>{}</code></a> {meaning}</li>\n", address(name), escape(name))
    };
    let items: String = files.iter().map(item).collect();
    format!("<details>\n<summary>{} files in this folder</summary>\n<ul>\n{items}</ul>\n</details>\n", files.len())
}

/// A relative file name as an address. All bytes but letters, digits and `-._~/` are percent-encoded. The leading `./` prevents
/// a colon in the name from being read as a scheme.
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

const STYLE: &str = include_str!("page.css");
const VIEW: &str = include_str!("view.html");
