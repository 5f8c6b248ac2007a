//! Solvers of (I − T) L = E side by side: tables, every step as CSV and JSON, a figure of the error against the work, and the
//! extrapolation of the series from its first terms.
//!
//! | column | meaning |
//! |---|---|
//! | to 1e-3 | products with T until the error is below 1e-3; work of another kind is counted as the products it is worth |
//! | s to 1e-3 | seconds until the error is below 1e-3, on this machine and in this run |
//! | error | ‖x − L‖_w/‖L‖_w of the last iterate, in the weight A/ρ; L is found by LU, or by GMRES to rounding |
//! | residual | ‖E − (I − T) x‖ of the last iterate, in the area inner product |

use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Mark, Panel, Point, Sample, Stroke, Words, figure},
    text::{
        csv::Csv,
        number::significant,
        table::{Side, aligned},
    },
};
use crate::solver::accelerate::{self, Accelerated, METHODS};
use crate::solver::comparison::{History, Solver};
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};

/// Relative errors at which work and time are compared.
pub const MILESTONES: [f64; 3] = [1e-3, 1e-6, 1e-10];

/// The small table, a row per solver: products with T to each milestone, seconds to the last one, error at the end.
pub fn table(histories: &[History]) -> String {
    let mut rows = vec![
        std::iter::once("solver".to_string())
            .chain(MILESTONES.map(|m| format!("to {m:.0e}")))
            .chain([format!("seconds to {:.0e}", MILESTONES[2]), "error at the end".into()])
            .collect::<Vec<String>>(),
    ];
    for h in histories {
        let mut row = vec![h.solver.name().to_string()];
        row.extend(MILESTONES.map(|m| h.reaches(m).map_or_else(dash, |p| products(p.applications))));
        row.push(h.reaches(MILESTONES[2]).map_or_else(dash, |p| significant(p.seconds, 2)));
        row.push(last_error(h));
        rows.push(row);
    }
    aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 5]].concat())
}

fn dash() -> String {
    "–".into()
}

/// The error of the last iterate; LU is the reference and has none.
fn last_error(h: &History) -> String {
    match h.solver {
        Solver::Lu => "reference".into(),
        _ => h.points.last().map_or_else(dash, |p| format!("{:.1e}", p.error)),
    }
}

/// The full table, a row per solver: products with T to each milestone, seconds to each, error and residual at the end.
pub fn full_table(histories: &[History]) -> String {
    let mut header = vec!["solver".to_string()];
    header.extend(MILESTONES.map(|m| format!("to {m:.0e}")));
    header.extend(MILESTONES.map(|m| format!("s to {m:.0e}")));
    header.extend(["error", "residual"].map(String::from));
    let mut rows = vec![header];
    for h in histories {
        let at = MILESTONES.map(|m| h.reaches(m));
        let mut row = vec![h.solver.name().to_string()];
        row.extend(at.map(|p| p.map_or_else(dash, |p| products(p.applications))));
        row.extend(at.map(|p| p.map_or_else(dash, |p| significant(p.seconds, 2))));
        row.push(last_error(h));
        row.push(h.points.last().map_or_else(dash, |p| format!("{:.1e}", p.residual)));
        rows.push(row);
    }
    let sides: Vec<Side> = (0..9).map(|i| if i == 0 { Side::Left } else { Side::Right }).collect();
    aligned(&rows, &sides)
}

/// Limits of a series, extrapolated from its first terms by several methods.
#[derive(Clone, Debug, PartialEq)]
pub struct Extrapolated {
    /// Number of terms used, counted from k = 0.
    pub terms: usize,
    /// Relative error and noise gain of every method of [`METHODS`]; none where a method needs more terms.
    pub methods: [Option<[f64; 2]>; 5],
}

impl Extrapolated {
    /// Extrapolates from `terms`, the first terms of a series, and compares with its known `limit`; `radius` is the spectral
    /// radius.
    ///
    /// The noise gain is √(Var(A)/Var(S_n)) for independent terms of equal relative error, where A is the extrapolated value
    /// and S_n the sum of the terms.
    pub fn new(terms: &[f64], limit: f64, radius: f64) -> Self {
        let noise = DMatrix::from_diagonal(&DVector::from_iterator(terms.len(), terms.iter().map(|t| t * t)));
        let judge = |a: Accelerated| [(a.value / limit - 1.0).abs(), a.amplification(&noise)];
        Self { terms: terms.len(), methods: accelerate::all(terms, radius).map(|a| a.map(judge)) }
    }
}

/// A row per number of terms: the error of each method, and how much it amplifies noise.
pub fn extrapolations(rows: &[Extrapolated]) -> String {
    let mut header = vec!["terms".to_string()];
    header.extend(METHODS.map(String::from));
    let mut out = vec![header];
    for r in rows {
        let cell = |m: &Option<[f64; 2]>| m.map_or("–".into(), |[e, g]| format!("{e:.1e} ×{}", significant(g, 2)));
        out.push(std::iter::once(r.terms.to_string()).chain(r.methods.iter().map(cell)).collect());
    }
    aligned(&out, &[Side::Right; 6])
}

/// The numbers of [`extrapolations`] for programs.
pub fn machine_extrapolations(rows: &[Extrapolated]) -> Value {
    let row = |r: &Extrapolated| {
        let methods = METHODS.iter().zip(&r.methods).map(|(name, m)| {
            let [error, gain] = [m.map(|m| m[0]), m.map(|m| m[1])];
            json!({ "method": name, "error": error, "noise_gain": gain })
        });
        json!({ "terms": r.terms, "methods": methods.collect::<Vec<_>>() })
    };
    Value::Array(rows.iter().map(row).collect())
}

/// A number of products with T: whole numbers without decimals, others with one.
fn products(n: f64) -> String {
    if n.fract() == 0.0 { format!("{n:.0}") } else { format!("{n:.1}") }
}

/// Every step of every solver as CSV.
pub fn csv(histories: &[History]) -> String {
    let mut csv = Csv::new("solver,step,products,norm,residual,error,seconds");
    for h in histories {
        for p in &h.points {
            csv.put(h.solver.name()).put(p.step).put(p.applications);
            [p.norm, p.residual, p.error].into_iter().for_each(|x| _ = csv.put(format_args!("{x:e}")));
            csv.put(format_args!("{:.6}", p.seconds)).end();
        }
    }
    csv.text()
}

/// The numbers of [`full_table()`] and [`csv()`] for programs.
pub fn machine(histories: &[History]) -> Value {
    let solver = |h: &History| {
        let at = MILESTONES.map(|m| {
            let p = h.reaches(m);
            json!({ "error": m, "products": p.map(|p| p.applications), "seconds": p.map(|p| p.seconds) })
        });
        let steps = h.points.iter().map(|p| {
            json!({
                "step": p.step, "products": p.applications, "norm": p.norm, "residual": p.residual,
                "error": p.error, "seconds": p.seconds,
            })
        });
        json!({ "solver": h.solver.name(), "reaches": at, "steps": steps.collect::<Vec<_>>() })
    };
    Value::Array(histories.iter().map(solver).collect())
}

const GUIDE: Stroke = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };

/// Draws the error of every solver against its products with T, and the decay r(T)ⁿ for comparison.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(histories: &[History], radius: f64, title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    figure("solvers", 960, 560, caption, |page| panels(page, histories, radius, title))
}

/// Colour and mark of a solver: the same ones whichever other solvers are drawn.
fn look(solver: Solver) -> Look {
    match Solver::ALL.iter().position(|s| *s == solver).unwrap_or(0) {
        7 => Look { color: GREY, mark: Mark::Ring },
        i => Look::nth(i),
    }
}

fn panels(page: &Canvas, histories: &[History], radius: f64, title: &str) -> Drawn {
    page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    // LU has no steps to draw
    let drawn: Vec<(usize, &History)> = histories.iter().enumerate().filter(|(_, h)| h.points.len() > 1).collect();
    let points = || drawn.iter().flat_map(|(_, h)| &h.points).filter(|p| p.error > 0.0);
    let last = points().map(|p| p.applications).fold(1.0, f64::max).ceil() as usize;
    let y = Axis::log("relative error of x", points().map(|p| p.error));
    let x = Axis::counts("products with T", last, 12);
    let panel = Panel::draw(page, "Error against work", [84.0, 72.0, 600.0, 420.0], x, y)?;
    let end = last as f64 + 0.5;
    panel.line((0.0, 1.0), (end, radius.powf(end)), GUIDE)?;
    let mut entries = vec![];
    for (i, h) in &drawn {
        let look = look(h.solver);
        let path: Vec<_> = h.points.iter().filter(|p| p.error > 0.0).collect();
        for pair in path.windows(2) {
            let end = |i: usize| (pair[i].applications, pair[i].error);
            panel.line(end(0), end(1), Stroke::solid(look.color, 1.4))?;
        }
        // a mark now and then tells curves apart without hiding them; each solver begins at another step
        let every = path.len().div_ceil(8);
        let marks = path.iter().skip(i % every).step_by(every).map(|p| Point::exact(p.applications, p.error)).collect();
        let label = h.solver.name().to_string();
        panel.curve(&Curve { label: label.clone(), points: marks, look }, 0.0, false)?;
        entries.push(Entry::new(Sample::Mark(look), label));
    }
    entries.push(Entry::new(Sample::Line(GUIDE), format!("r(T)ⁿ, r(T) = {radius:.4}")));
    if drawn.iter().any(|(_, h)| matches!(h.solver, Solver::Chebyshev | Solver::Sor)) {
        entries.push(Entry::new(Sample::Heading, "Chebyshev and SOR pay for the spectrum first"));
    }
    page.legend((704.0, 68.0), 240.0, &entries)?;
    Ok(())
}
