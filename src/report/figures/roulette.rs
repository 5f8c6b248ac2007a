//! Roulette schedules side by side: what was predicted, and what was measured.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample of the whole image, averaged over pixels and channels | [`Noise::all`] |
//! | rays | per path | [`Noise::rays`] |
//! | 1/(V rays) | efficiency | [`Noise::efficiency`] |
//! | z | (measured − predicted) over the error of both | [`Row::z`] |

use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, Look, Panel, Point, Sample, Words, figure},
    text::{
        csv::Csv,
        number::significant,
        table::{Side, aligned},
    },
};
use crate::stats::Noise;
use crate::terms::cross_moments::Value;

/// One schedule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// As it was typed.
    pub name: String,
    /// As a table; what was typed where it depends on the path.
    pub schedule: String,
    /// q\[v\], v = 0..K, where it does not depend on the path.
    pub q: Vec<f64>,
    /// From the cross moments; none where it depends on the path.
    pub predicted: Option<Noise>,
    /// From rendering it.
    pub measured: Option<Noise>,
    /// Seconds per path, where they were taken.
    pub seconds: Option<f64>,
    /// Replicates behind the errors.
    pub replicates: u64,
}

impl Row {
    /// How far the measured variance of the whole image lies from the predicted one, in standard errors of the difference.
    pub fn z(&self) -> Option<f64> {
        let (p, m) = (self.predicted.as_ref()?.all, self.measured.as_ref()?.all);
        Some(deviation(p, m))
    }
}

fn deviation(p: Value, m: Value) -> f64 {
    (m.value - p.value) / p.std_error.hypot(m.std_error)
}

/// The schedules, a line each; where they were rendered also what was measured, and how far the two lie apart.
pub fn table(rows: &[Row]) -> String {
    let mut lines = vec![
        ["schedule", "rays/path", "V predicted", "1/(V rays)", "V of T1", "T2", "T4", "T8", "tail"]
            .map(String::from)
            .to_vec(),
    ];
    for r in rows {
        let mut cells = vec![shown(&r.name)];
        match &r.predicted {
            Some(p) => {
                cells.extend([significant(p.rays.value, 3), with_error(p.all), with_error(p.efficiency)]);
                let term = |k: usize| p.terms.get(k).map_or("–".into(), |v| significant(v.value, 2));
                cells.extend([1, 2, 4, 8].map(term));
                cells.push(significant(p.tail.value, 2));
            }
            None => cells.extend(std::iter::repeat_n("–".to_owned(), 8)),
        }
        lines.push(cells);
    }
    let mut out = aligned(&lines, &[[Side::Left].as_slice(), &[Side::Right; 8]].concat());
    if rows.iter().any(|r| r.measured.is_some()) {
        let header = ["schedule", "rays/path", "V measured", "to predicted", "z", "1/(V rays)", "µs/path", "1/(V s)"];
        let mut lines = vec![header.map(String::from).to_vec()];
        for r in rows {
            let Some(m) = &r.measured else { continue };
            let ratio = r.predicted.as_ref().map_or("–".into(), |p| significant(m.all.value / p.all.value, 4));
            let z = r.z().map_or("–".into(), |z| format!("{z:+.1}"));
            let seconds = |f: &dyn Fn(f64) -> f64| r.seconds.map_or("–".into(), |s| significant(f(s), 3));
            lines.push(vec![
                shown(&r.name),
                significant(m.rays.value, 3),
                with_error(m.all),
                ratio,
                z,
                with_error(m.efficiency),
                seconds(&|s| 1e6 * s),
                seconds(&|s| 1.0 / (m.all.value * s)),
            ]);
        }
        out += "\nmeasured\n";
        out += &aligned(&lines, &[[Side::Left].as_slice(), &[Side::Right; 7]].concat());
    }
    out
}

/// Long tables are cut: the whole of them stands in the file.
fn shown(name: &str) -> String {
    const MOST: usize = 24;
    if name.chars().count() <= MOST { name.into() } else { name.chars().take(MOST - 1).chain(['…']).collect() }
}

fn with_error(v: Value) -> String {
    if v.std_error.is_nan() {
        return significant(v.value, 3);
    }
    format!("{} ± {}", significant(v.value, 3), significant(v.std_error, 1))
}

/// Everything: a line per schedule and part of the image (`0`, `1`, …, `tail`, `all`); what is not known is left empty.
pub fn csv(rows: &[Row]) -> String {
    // schedules are lists: they stand in quotes, whether they need them or not
    let mut csv = Csv::bare(
        "schedule,table,part,predicted_variance,predicted_std_error,measured_variance,measured_std_error,z,\
         predicted_rays,measured_rays,predicted_efficiency,predicted_efficiency_std_error,measured_efficiency,\
         measured_efficiency_std_error,seconds_per_path",
    );
    for r in rows {
        let parts = r.predicted.as_ref().or(r.measured.as_ref()).map_or(0, |n| n.terms.len()) + 2;
        for part in 0..parts {
            let terms = parts - 2;
            let name = if part < terms { part.to_string() } else { ["tail", "all"][part - terms].to_owned() };
            let of = |n: &Noise| if part < terms { n.terms[part] } else { [n.tail, n.all][part - terms] };
            let (p, m) = (r.predicted.as_ref().map(of), r.measured.as_ref().map(of));
            let whole = part + 1 == parts;
            let only = |n: &Option<Noise>, f: &dyn Fn(&Noise) -> f64| n.as_ref().filter(|_| whole).map(f);
            let numbers = [
                p.map(|v| v.value),
                p.map(|v| v.std_error),
                m.map(|v| v.value),
                m.map(|v| v.std_error),
                p.zip(m).map(|(p, m)| deviation(p, m)),
                only(&r.predicted, &|n| n.rays.value),
                only(&r.measured, &|n| n.rays.value),
                only(&r.predicted, &|n| n.efficiency.value),
                only(&r.predicted, &|n| n.efficiency.std_error),
                only(&r.measured, &|n| n.efficiency.value),
                only(&r.measured, &|n| n.efficiency.std_error),
                r.seconds.filter(|_| whole),
            ];
            csv.put(format_args!("\"{}\"", r.name)).put(format_args!("\"{}\"", r.schedule)).put(name);
            csv.numbers(numbers.map(|x| x.unwrap_or(f64::NAN))).end();
        }
    }
    csv.text()
}

/// Variance, rays and their product against the schedules, predicted and measured, and q of some of them vertex by vertex.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(rows: &[Row], title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    figure("roulette", 1120, 880, caption, |page| panels(page, rows, title))
}

/// A number of a schedule.
type Reading = fn(&Noise) -> Value;

fn panels(page: &Canvas, rows: &[Row], title: &str) -> Drawn {
    page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    let curves = |of: Reading| -> [Curve; 2] {
        let points = |noise: &dyn Fn(&Row) -> Option<Noise>| -> Vec<Point> {
            let point = |(i, r): (usize, &Row)| {
                let v = of(&noise(r)?);
                Some(Point { x: (i + 1) as f64, value: v.value, std_error: v.std_error, replicates: r.replicates })
            };
            rows.iter().enumerate().filter_map(point).filter(|p| p.value > 0.0 && p.value.is_finite()).collect()
        };
        [
            Curve { label: "predicted".into(), points: points(&|r| r.predicted.clone()), look: Look::MATRIX },
            Curve { label: "measured".into(), points: points(&|r| r.measured.clone()), look: Look::SINGLE },
        ]
    };
    let numbered = || {
        let mut axis = Axis::linear("schedule", 0.4, rows.len() as f64 + 0.6, rows.len());
        axis.ticks = (1..=rows.len()).map(|i| (i as f64, i.to_string())).collect();
        axis
    };
    let work: Reading = |n| {
        let (value, e) = (1.0 / n.efficiency.value, n.efficiency);
        Value { value, std_error: value * e.std_error / e.value }
    };
    let of_all: [(&str, &str, [f64; 4], Reading); 3] =
        [
            ("Variance V of one sample of the whole image", "V   (W² sr⁻² m⁻⁴)", [84.0, 72.0, 372.0, 320.0], |n| n.all),
            ("Cost", "rays per path", [552.0, 72.0, 372.0, 320.0], |n| n.rays),
            ("V · rays: lower is better", "V · rays", [84.0, 486.0, 372.0, 320.0], work),
        ];
    let mut drawn = [false; 2];
    for (heading, unit, frame, of) in of_all {
        let curves = curves(of);
        let values = curves.iter().flat_map(|c| &c.points).flat_map(|p| [p.value, p.value + p.half_width()]);
        let panel = Panel::draw(page, heading, frame, numbered(), Axis::log(unit, values))?;
        for (i, c) in curves.iter().enumerate().filter(|(_, c)| !c.points.is_empty()) {
            panel.curve(c, 0.0, i == 0)?;
            drawn[i] = true;
        }
    }

    // q vertex by vertex
    let last = rows.iter().map(|r| r.q.len()).max().unwrap_or(1).max(2) - 1;
    let vertices = Axis::counts("vertex v", last, 10);
    let q = Axis::linear("q, probability of termination", -0.03, 1.0, 6);
    let panel = Panel::draw(page, "q at each vertex", [552.0, 486.0, 372.0, 320.0], vertices, q)?;
    let known: Vec<_> = rows.iter().filter(|r| !r.q.is_empty()).collect();
    let shown = |name: &str| known.iter().find(|r| r.name == name).copied();
    let steps: Vec<Curve> = ["optimal", "lecture"]
        .iter()
        .filter_map(|name| shown(name))
        .enumerate()
        .map(|(i, r)| Curve {
            label: r.name.clone(),
            points: r.q.iter().enumerate().map(|(v, q)| Point::exact(v as f64, *q)).collect(),
            look: Look::nth(i + 1),
        })
        .collect();
    steps.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;

    let labels = curves(|n| n.all);
    let mut entries: Vec<Entry> =
        labels.iter().zip(drawn).filter(|(_, d)| *d).map(|(c, _)| Entry::new(Sample::Mark(c.look), &c.label)).collect();
    entries.push(Entry::new(Sample::Heading, "bars: 95 %"));
    entries.push(Entry::new(Sample::Heading, "schedules"));
    entries.extend(rows.iter().enumerate().map(|(i, r)| Entry::new(Sample::Plain, format!("{}  {}", i + 1, r.name))));
    page.legend((944.0, 72.0), 160.0, &entries)?;
    if !steps.is_empty() {
        let entries: Vec<Entry> = steps.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)).collect();
        page.legend((944.0, 500.0), 160.0, &entries)?;
    }
    Ok(())
}
