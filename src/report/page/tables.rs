//! Tables of the page. On a narrow screen a wide table becomes one block for each row (`page.css`), so no column is lost.

use crate::report::image::typeset::escape;
use crate::report::text::{
    grid::Grid,
    number::{average, count, dash, error, known, mark, outcome, p_value, percent, signed, significant},
    rows::{Cell, Column, Rows},
};
use std::fmt::Write;

/// A small table with its sentence as the caption.
pub(super) fn grid(grid: &Grid) -> String {
    let head: String = grid.head.iter().map(|name| format!("<th scope=\"col\">{}</th>", escape(name))).collect();
    let row = |cells: &Vec<String>| {
        let mut cells = cells.iter();
        let name = cells.next().map_or(String::new(), |name| format!("<th scope=\"row\">{}</th>", escape(name)));
        let values: String = cells.map(|cell| format!("<td>{}</td>", escape(cell))).collect();
        format!("<tr>{name}{values}</tr>\n")
    };
    let body: String = grid.rows.iter().map(row).collect();
    let sentence = escape(&grid.sentence);
    format!(
        "<table class=\"grid\">\n<caption>{sentence}</caption>\n<thead><tr>{head}</tr></thead>\n\
         <tbody>\n{body}</tbody>\n</table>\n"
    )
}

/// A table of rows; an estimate takes two columns, its mean and its error. With a `scale`, estimates are also drawn in a last
/// column.
pub(super) fn table(first: &str, columns: &[(Column, &str)], rows: &Rows, scale: Option<(f64, f64)>) -> String {
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
    let picked: Vec<Column> = columns.iter().map(|c| c.0).collect();
    for (name, cells) in rows.pick(&picked) {
        let words: String = cells.iter().zip(columns).map(|(found, (_, label))| cell(found, label)).collect();
        let drawn = scale.map_or(String::new(), |scale| {
            let dots: String = cells.iter().map(|c| dot(c, scale)).collect();
            format!("<td data-label=\"\">{dots}</td>")
        });
        let _ = writeln!(body, "<tr><th scope=\"row\">{}</th>{words}{drawn}</tr>", escape(&name.to_string()));
    }
    format!("<table class=\"stack\">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table>\n")
}

fn cell(cell: &Cell, label: &str) -> String {
    let td = |words: &str| format!("<td data-label=\"{label}\">{words}</td>");
    let words = match cell {
        Cell::Blank => return "<td></td>".into(),
        Cell::Words(words) => escape(words),
        Cell::Estimate(e) => {
            let mean = if e.is_none() { "not estimated".into() } else { significant(average(e).0, 4) };
            return format!("{}<td data-label=\"± 95 %\">{}</td>", td(&mean), error(e));
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
            return format!("<td class=\"word {word}\" data-label=\"{label}\">{} {word}</td>", mark(*found));
        }
    };
    td(&words)
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
