//! The numbers of roulette schedules: every number in tables, and as CSV.

use crate::report::text::{
    csv::Csv,
    number::significant,
    table::{Side, aligned},
};
use crate::stats::Noise;
use crate::study::roulette::Relative;
use crate::terms::cross_moments::Value;

/// Predicted and measured numbers of one schedule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// The schedule as it was typed.
    pub name: String,
    /// The schedule as a table; as it was typed if it depends on the path.
    pub schedule: String,
    /// q\[v\] for v = 0..K; empty if q depends on the path.
    pub q: Vec<f64>,
    /// Noise and cost predicted from the cross moments; None if q depends on the path.
    pub predicted: Option<Noise>,
    /// Rays for the same error, predicted, relative to the lecture's schedule; None if q depends on the path.
    pub relative: Option<Relative>,
    /// Noise and cost measured by rendering with this schedule; None if it was not rendered.
    pub measured: Option<Noise>,
    /// Seconds per path; None if they were not measured.
    pub seconds: Option<f64>,
    /// Independent replicates behind the errors.
    pub replicates: u64,
}

impl Row {
    /// How far the measured variance of the whole image lies from the predicted one, in standard errors of the difference.
    pub fn z(&self) -> Option<f64> {
        let (p, m) = (self.predicted.as_ref()?.all, self.measured.as_ref()?.all);
        Some(deviation(p, m))
    }

    /// The same for the variance of indirect light.
    pub fn indirect_z(&self) -> Option<f64> {
        let (p, m) = (self.predicted.as_ref()?.indirect, self.measured.as_ref()?.indirect);
        Some(deviation(p, m))
    }
}

fn deviation(p: Value, m: Value) -> f64 {
    (m.value - p.value) / p.std_error.hypot(m.std_error)
}

/// Every number: one line per schedule with its prediction. If schedules were rendered, a second table has the measured
/// numbers and z.
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
        out += "\nmeasured: the variance V of the whole image\n";
        out += &aligned(&lines, &[[Side::Left].as_slice(), &[Side::Right; 7]].concat());
    }
    out
}

/// A name, cut if it is long; the CSV file has it in full.
pub(super) fn shown(name: &str) -> String {
    const MOST: usize = 24;
    if name.chars().count() <= MOST { name.into() } else { name.chars().take(MOST - 1).chain(['…']).collect() }
}

fn with_error(v: Value) -> String {
    if v.std_error.is_nan() {
        return significant(v.value, 3);
    }
    format!("{} ± {}", significant(v.value, 3), significant(v.std_error, 1))
}

/// Every number as CSV: one line per schedule and part of the image (`0`, `1`, …, `tail`, `all`, `indirect`). Numbers that
/// are not known are left empty.
pub fn csv(rows: &[Row]) -> String {
    // schedules are lists: they stand in quotes, whether they need them or not
    let mut csv = Csv::bare(
        "schedule,table,part,predicted_variance,predicted_std_error,measured_variance,measured_std_error,z,\
         predicted_rays,measured_rays,predicted_efficiency,predicted_efficiency_std_error,measured_efficiency,\
         measured_efficiency_std_error,seconds_per_path",
    );
    for r in rows {
        let terms = r.predicted.as_ref().or(r.measured.as_ref()).map_or(0, |n| n.terms.len());
        let names = (0..terms).map(|k| k.to_string()).chain(["tail", "all", "indirect"].map(String::from));
        for (part, name) in names.enumerate() {
            let of = |n: &Noise| if part < terms { n.terms[part] } else { [n.tail, n.all, n.indirect][part - terms] };
            let (p, m) = (r.predicted.as_ref().map(of), r.measured.as_ref().map(of));
            // a sum has an efficiency; a term is sampled together with the others
            let sum = part > terms;
            let efficiency = |n: &Noise| if name == "all" { n.efficiency } else { n.indirect_efficiency };
            let only = |n: &Option<Noise>, f: &dyn Fn(&Noise) -> f64| n.as_ref().filter(|_| sum).map(f);
            let numbers = [
                p.map(|v| v.value),
                p.map(|v| v.std_error),
                m.map(|v| v.value),
                m.map(|v| v.std_error),
                p.zip(m).map(|(p, m)| deviation(p, m)),
                only(&r.predicted, &|n| n.rays.value),
                only(&r.measured, &|n| n.rays.value),
                only(&r.predicted, &|n| efficiency(n).value),
                only(&r.predicted, &|n| efficiency(n).std_error),
                only(&r.measured, &|n| efficiency(n).value),
                only(&r.measured, &|n| efficiency(n).std_error),
                r.seconds.filter(|_| sum),
            ];
            csv.put(format_args!("\"{}\"", r.name)).put(format_args!("\"{}\"", r.schedule)).put(&name);
            csv.numbers(numbers.map(|x| x.unwrap_or(f64::NAN))).end();
        }
    }
    csv.text()
}
