//! How cost grows: panels of time and of peak memory on logarithmic axes, a table of exponents, every run as CSV.
//!
//! | column | meaning |
//! |---|---|
//! | exponent | b of time ≈ c nᵇ over all sizes, ± half its 95 % interval |
//! | promised | the exponent of the algorithm for large n, without logarithms |
//! | last two | the exponent between the last two sizes |
//! | per unit | bytes by which peak memory grows per sample, pixel, …, between the last two sizes |

use crate::report::{
    ReportError, half_width_95,
    image::typeset::Caption,
    plot::{
        Axis, Canvas, Curve as Drawing, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure,
    },
    text::{
        csv::Csv,
        grid::Grid,
        number::{count, plus_minus, significant},
        prose::counted,
    },
};
use crate::stats::power_law::{PowerLaw, Sized, error_of_median, spread};
use crate::study::growth::{Curve, Growth, Subject, Varied};

/// An exponent may exceed the promised one by this much: a factor ln n, or caches that fill up, over the sizes measured here.
pub const SLACK: f64 = 0.2;

/// Where a curve is: its quantity, and what it is the cost of.
fn label(c: &Curve) -> String {
    format!("{}: {}", c.subject.varied().name(), c.name)
}

/// b ± half its 95 % interval.
fn exponent(fit: &PowerLaw) -> String {
    let half = half_width_95(fit.std_error, fit.dof + 1);
    // smaller errors would only make the number long; one that is not known stays unknown
    plus_minus(fit.exponent, if half < 0.001 { 0.001 } else { half }, 1)
}

/// The curves whose exponent is proved to exceed the promised one by more than [`SLACK`]. Two sizes prove nothing, because a step
/// between them is no growth.
pub fn too_fast(growth: &Growth) -> Vec<String> {
    let proved = |c: &Curve| {
        let (fit, promised) = (c.fit().filter(|_| c.sizes.len() > 2)?, c.expected?);
        let least = fit.exponent - half_width_95(fit.std_error, fit.dof + 1);
        (least > promised + SLACK).then(|| format!("{} (exponent {}, promised {})", label(c), exponent(&fit), promised))
    };
    Varied::ALL.into_iter().flat_map(|v| growth.times(v)).filter_map(|c| proved(&c)).collect()
}

/// Median seconds and median peak bytes of one part at the largest size that was measured.
fn largest(growth: &Growth, subject: Subject, part: usize) -> Option<(f64, f64, Option<f64>)> {
    let time = growth.times(subject.varied()).into_iter().filter(|c| c.subject == subject).nth(part)?;
    let memory = growth.memory(subject.varied()).into_iter().find(|c| c.subject == subject);
    let last = time.sizes.last()?;
    let peak = memory.and_then(|m| m.sizes.last().map(Sized::median));
    Some((last.size, last.median(), peak))
}

/// The answer in a few sentences: what grows too fast, the largest scenes, the speed-up.
pub fn answer(growth: &Growth) -> String {
    let fast = too_fast(growth);
    let mut words = match fast.len() {
        0 => "No cost is proved to grow faster than promised.".to_string(),
        _ => format!("Faster than promised: {}.", fast.join("; ")),
    };
    for (subject, what) in [(Subject::Triangles, "triangle"), (Subject::Lights, "light")] {
        if let Some((n, seconds, peak)) = largest(growth, subject, 0) {
            let memory = peak.map_or(String::new(), |peak| format!("; peak memory {}", bytes(peak)));
            let scene = counted(n as usize, what);
            words += &format!(" A scene of {scene} loads in {} CPU seconds{memory}.", significant(seconds, 2));
        }
    }
    let wall = growth.times(Varied::Threads).into_iter().next();
    if let Some([one, .., many]) = wall.as_ref().map(|w| w.sizes.as_slice()) {
        let speed_up = one.median() / many.median();
        words += &format!(
            " By the clock on the wall, {} threads are {} times as fast as one.",
            many.size,
            significant(speed_up, 3)
        );
    }
    words
}

/// A row per time: the sizes, the time at the largest, and the exponents.
pub fn table(growth: &Growth) -> Grid {
    let sentence = "How time grows with each quantity: time ≈ c nᵇ, b ± half a 95 % interval.";
    let mut grid = Grid::new(sentence, ["time", "n", "longest", "b", "promised", "last two n"]);
    for c in Varied::ALL.into_iter().flat_map(|v| growth.times(v)) {
        let [Some(first), Some(last)] = [c.sizes.first(), c.sizes.last()] else { continue };
        let fit = c.fit();
        grid.push([
            label(&c),
            format!("{} … {}", count(first.size as u64), count(last.size as u64)),
            format!("{} s", significant(last.median(), 2)),
            fit.as_ref().map_or("–".into(), exponent),
            c.expected.map_or("–".into(), |e| significant(e, 1).replace('-', "−")),
            fit.as_ref().map_or("–".into(), |f| plus_minus(f.last[0], half_width_95(f.last[1], f.dof + 1), 1)),
        ]);
    }
    grid
}

/// A row per way to work: peak memory at the smallest and at the largest size, and its growth per unit there.
pub fn memory_table(growth: &Growth) -> Grid {
    let mut grid =
        Grid::new("Peak memory of the whole process.", ["memory", "n", "least", "most", "per unit at the end"]);
    for c in Varied::ALL.into_iter().flat_map(|v| growth.memory(v)) {
        let [Some(first), Some(last)] = [c.sizes.first(), c.sizes.last()] else { continue };
        grid.push([
            label(&c),
            format!("{} … {}", count(first.size as u64), count(last.size as u64)),
            bytes(first.median()),
            bytes(last.median()),
            per_unit(&c).map_or("–".into(), |x| if x < 0.5 { "0 B".into() } else { bytes(x) }),
        ]);
    }
    grid
}

/// Bytes with their unit: `470 B`, `1.2 MB`.
fn bytes(x: f64) -> String {
    let text = count(x.round() as u64);
    if text.contains(' ') { text + "B" } else { text + " B" }
}

/// Bytes by which a memory curve grows per unit between its last two sizes; 0 if it grows by less than a hundredth, which may be
/// chance.
fn per_unit(c: &Curve) -> Option<f64> {
    let [.., a, b] = c.sizes.as_slice() else { return None };
    let (before, after) = (a.median(), b.median());
    Some(if after < 1.01 * before { 0.0 } else { (after - before) / (b.size - a.size) })
}

/// Every run: a line per part that was timed.
pub fn csv(growth: &Growth) -> String {
    let mut csv = Csv::new("quantity,way,part,size,repeat,seconds,peak_bytes");
    for p in &growth.points {
        for (repeat, run) in p.runs.iter().enumerate() {
            for (part, seconds) in p.subject.parts().iter().zip(&run.seconds) {
                csv.put(p.subject.varied().name()).put(p.subject.id()).put(part.name).put(p.size).put(repeat);
                csv.put(seconds).numbers([run.peak.map_or(f64::NAN, |b| b as f64)]).end();
            }
        }
    }
    csv.text()
}

/// Every fit: a line per curve.
pub fn fits_csv(growth: &Growth) -> String {
    let mut csv =
        Csv::new("quantity,way,cost,sizes,exponent,std_error,dof,promised,last_exponent,last_std_error,misfit,spread");
    for v in Varied::ALL {
        let times = growth.times(v).into_iter().map(|c| (c, false));
        for (c, memory) in times.chain(growth.memory(v).into_iter().map(|c| (c, true))) {
            let Some(f) = c.fit() else { continue };
            csv.put(v.name()).put(c.subject.id()).put(if memory { "memory" } else { c.name }).put(c.sizes.len());
            csv.numbers([f.exponent, f.std_error]).put(f.dof).numbers([c.expected.unwrap_or(f64::NAN)]);
            csv.numbers([f.last[0], f.last[1], f.misfit, f.spread]).end();
        }
    }
    csv.text()
}

const PROMISED: Stroke = Stroke { color: GREY, width: 1.2, dash: Some((5.0, 4.0)) };
/// Place and size of the panels.
const COLUMNS: usize = 4;
const PITCH: [f64; 2] = [306.0, 384.0];
const FRAME: [f64; 4] = [84.0, 84.0, 206.0, 190.0];

/// Draws the times against the sizes.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(growth: &Growth, caption: &Caption) -> Result<Figure, ReportError> {
    let legend = |c: &Curve| {
        let b = c.fit().map_or(String::new(), |f| format!(": b = {}", exponent(&f)));
        format!("{}{}", c.name, b.replacen(' ', "\n", 1).replace(' ', "\u{a0}").replace('\n', " "))
    };
    let panels: Vec<(Varied, Vec<Curve>)> = Varied::ALL.map(|v| (v, growth.times(v))).into();
    let notes = [
        Entry::new(Sample::Heading, "time ≈ c nᵇ"),
        Entry::new(
            Sample::Plain,
            "Medians of processes; bars and ± are 95\u{a0}%. CPU time of one thread, except for threads.",
        ),
        Entry::new(Sample::Line(PROMISED), "the exponent that the algorithm promises, through the last point"),
    ];
    let title = "How time grows";
    figure("growth", 1240, 842, caption, |page| draw_panels(page, title, "seconds", &panels, 1.0, &notes, &legend))
}

/// Draws the peak memory against the sizes.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw_memory(growth: &Growth, caption: &Caption) -> Result<Figure, ReportError> {
    let legend = |c: &Curve| {
        let unit = per_unit(c).filter(|x| *x >= 0.5);
        let words = unit.map_or("constant".into(), |x| format!("{} each", bytes(x)));
        format!("{}: {}", c.name, words.replace(' ', "\u{a0}"))
    };
    let panels: Vec<(Varied, Vec<Curve>)> = Varied::ALL.map(|v| (v, growth.memory(v))).into();
    let notes = [
        Entry::new(Sample::Heading, "Peak memory of the process"),
        Entry::new(
            Sample::Plain,
            "It includes the program itself, its scene and its film; the smallest sizes show little else.",
        ),
        Entry::new(Sample::Plain, "Below each panel: growth per sample, pixel, …, between the last two sizes."),
    ];
    let (title, mib) = ("How peak memory grows", f64::from(1 << 20));
    figure("growth-memory", 1240, 842, caption, |page| draw_panels(page, title, "MiB", &panels, mib, &notes, &legend))
}

/// All panels, each with its legend below; the notes are where another panel would be.
fn draw_panels(
    page: &Canvas,
    title: &str,
    unit: &str,
    panels: &[(Varied, Vec<Curve>)],
    scale: f64,
    notes: &[Entry],
    legend: &dyn Fn(&Curve) -> String,
) -> Drawn {
    page.text(title, (24.0, 28.0), Words { size: 18.0, ..Words::default() })?;
    let place = |i: usize| [(i % COLUMNS) as f64 * PITCH[0], (i / COLUMNS) as f64 * PITCH[1]];
    let [left, top, width, height] = FRAME;
    for (i, (varied, curves)) in panels.iter().enumerate() {
        let [dx, dy] = place(i);
        let known: Vec<&Curve> = curves.iter().filter(|c| !c.sizes.is_empty()).collect();
        let entries = draw_panel(page, *varied, unit, [left + dx, top + dy, width, height], &known, scale, legend)?;
        page.legend((left + dx - 40.0, top + dy + height + 58.0), width + 60.0, &entries)?;
    }
    let [dx, dy] = place(panels.len());
    page.legend((left + dx - 40.0, top + dy), width + 60.0, notes)?;
    Ok(())
}

fn draw_panel(
    page: &Canvas,
    varied: Varied,
    unit: &str,
    frame: [f64; 4],
    curves: &[&Curve],
    scale: f64,
    legend: &dyn Fn(&Curve) -> String,
) -> Result<Vec<Entry>, Box<dyn std::error::Error>> {
    let points: Vec<Vec<Point>> = curves.iter().map(|c| points(c, scale)).collect();
    let all = || points.iter().flatten();
    let sizes = all().map(|p| p.x);
    let x = match varied {
        Varied::Threads => Axis::powers_of_two("threads", sizes, 6),
        _ => Axis::log(varied.name(), sizes),
    };
    let y = Axis::log(unit, all().flat_map(|p| [p.value, p.value + p.half_width(), p.value - p.half_width()]));
    let panel = Panel::draw(page, &format!("against {}", varied.name()), frame, x, y)?;
    let mut entries = vec![];
    for (i, (c, points)) in curves.iter().zip(points).enumerate() {
        let look = Look::nth(i);
        if let (Some(promised), [first, .., last]) = (c.expected, points.as_slice()) {
            panel.line((first.x, last.value * (first.x / last.x).powf(promised)), (last.x, last.value), PROMISED)?;
        }
        if let (Some(fit), Some(_)) = (c.fit(), c.expected) {
            let at = |x: f64| (x, (fit.intercept + fit.exponent * x.ln()).exp() / scale);
            let [first, last] = [points[0].x, points[points.len() - 1].x];
            panel.line(at(first), at(last), Stroke::solid(look.color, 1.2))?;
        }
        panel.curve(&Drawing { label: String::new(), points, look }, 0.0, c.expected.is_none())?;
        entries.push(Entry::new(Sample::Mark(look), legend(c)));
    }
    Ok(entries)
}

/// The medians with their errors.
fn points(c: &Curve, scale: f64) -> Vec<Point> {
    let (s, dof) = spread(&c.sizes);
    let point = |p: &Sized| {
        let value = p.median() / scale;
        Point { x: p.size, value, std_error: value * error_of_median(p, s), replicates: dof + 1 }
    };
    c.sizes.iter().map(point).collect()
}
