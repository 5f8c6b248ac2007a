//! Eigenvalues on finer and finer meshes: some converge and belong to the scene, the others belong to the mesh.
//!
//! | quantity | meaning |
//! |---|---|
//! | λ | the largest and the most negative eigenvalues of T_h, by the number of patches |
//! | band | ±0.42361 √(ρ₁ρ₂), the essential spectrum of right-angled edges: every mesh fills it, a finer one more densely |
//! | step | change of λ from the previous mesh: it falls if λ has a limit |
//!
//! Corners where three faces meet widen the band further (not computed), so an eigenvalue just outside the band may drift too.

use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Mark, Panel, Point, Sample, Stroke, Words, figure},
    text::{
        csv::Csv,
        table::{Side, aligned},
    },
};
use crate::study::refinement::{Ends, Mesh, Refinement};
use plotters::style::RGBColor;

/// The meshes whose eigenvalues were computed.
fn known(r: &Refinement) -> Vec<(&Mesh, &Ends)> {
    r.meshes.iter().filter_map(|m| Some((m, m.spectrum.as_ref()?))).collect()
}

/// One eigenvalue on all meshes.
struct Track {
    name: String,
    /// Number of patches and λ, for the meshes that have this eigenvalue.
    values: Vec<(usize, f64)>,
    /// Half width of the band on the finest mesh.
    band: f64,
}

impl Track {
    fn last(&self) -> f64 {
        self.values.last().map_or(f64::NAN, |v| v.1)
    }

    fn outside(&self) -> bool {
        self.last().abs() > self.band
    }
}

fn tracks(r: &Refinement) -> Vec<Track> {
    let known = known(r);
    let Some(band) = known.last().map(|(_, e)| e.band) else { return vec![] };
    let count = |side: usize| known.iter().map(|(_, e)| e.values[side].len()).max().unwrap_or(0);
    let track = |side: usize, i: usize| Track {
        name: if side == 0 { format!("+{}", i + 1) } else { format!("−{}", i + 1) },
        values: known.iter().filter_map(|(m, e)| e.values[side].get(i).map(|r| (m.patches, r.value))).collect(),
        band,
    };
    [0, 1].into_iter().flat_map(|side| (0..count(side)).map(move |i| (side, i))).map(|(s, i)| track(s, i)).collect()
}

/// The number of leading eigenvalues outside the band on the finest mesh, the number of all leading eigenvalues, and the half
/// width of the band.
pub fn outside(r: &Refinement) -> (usize, usize, f64) {
    let all = tracks(r);
    (all.iter().filter(|t| t.outside()).count(), all.len(), all.first().map_or(0.0, |t| t.band))
}

/// A row for each of the `most` largest eigenvalues, a column per mesh, and the last step with its ratio to the one before.
pub fn table(r: &Refinement, most: usize) -> String {
    let known = known(r);
    let mut header = vec!["λ".to_string()];
    header.extend(known.iter().map(|(m, _)| format!("{} patches", m.patches)));
    header.extend(["last step", "step ratio", ""].map(String::from));
    let mut rows = vec![header];
    let all = tracks(r);
    let mut chosen: Vec<usize> = (0..all.len()).collect();
    chosen.sort_by(|&a, &b| all[b].last().abs().total_cmp(&all[a].last().abs()));
    chosen.truncate(most);
    chosen.sort_unstable();
    for t in chosen.iter().map(|&i| &all[i]) {
        let mut row = vec![t.name.clone()];
        row.extend(
            known.iter().map(|(m, _)| {
                t.values.iter().find(|v| v.0 == m.patches).map_or("–".into(), |v| format!("{:+.5}", v.1))
            }),
        );
        let steps: Vec<f64> = t.values.windows(2).map(|w| w[1].1 - w[0].1).collect();
        let step = steps.last().map_or("–".into(), |s| format!("{s:+.5}"));
        let ratio = steps.windows(2).last().map_or("–".into(), |w| format!("{:.2}", w[1] / w[0]));
        row.extend([step, ratio, if t.outside() { String::new() } else { "in the band".into() }]);
        rows.push(row);
    }
    aligned(&rows, &[vec![Side::Left], vec![Side::Right; known.len() + 2], vec![Side::Left]].concat())
}

/// All eigenvalues as CSV, a line per eigenvalue and mesh.
pub fn csv(r: &Refinement) -> String {
    let mut csv = Csv::new("patches,h,channel,eigenvalue,value,residual,band");
    for (m, e) in known(r) {
        for (side, values) in e.values.iter().enumerate() {
            for (i, v) in values.iter().enumerate() {
                let number = (i + 1) as i64 * if side == 0 { 1 } else { -1 };
                csv.put(m.patches).put(m.h).put(e.channel).put(number).put(v.value).put(v.residual).put(e.band).end();
            }
        }
    }
    csv.text()
}

const BAND: Stroke = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
/// Mark of the eigenvalues inside the band.
const INSIDE: Look = Look { color: RGBColor(165, 165, 165), mark: Mark::Ring };

/// Draws the eigenvalues, and their steps from mesh to mesh, against the number of patches.
///
/// # Errors
/// If the plot crate fails, which is a defect of the program.
pub fn draw(r: &Refinement, title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    figure("eigenvalues", 1240, 620, caption, |page| panels(page, r, title))
}

fn panels(page: &Canvas, r: &Refinement, title: &str) -> Drawn {
    page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    let all = tracks(r);
    let band = all.first().map_or(0.0, |t| t.band);
    let outside: Vec<&Track> = all.iter().filter(|t| t.outside()).collect();
    let inside: Vec<&Track> = all.iter().filter(|t| !t.outside()).collect();
    let looks = || inside.iter().map(|t| (t, INSIDE)).chain(outside.iter().enumerate().map(|(i, t)| (t, Look::nth(i))));
    let label = |t: &Track| format!("{}: λ = {:+.4}", t.name, t.last());
    let curves = |points: &dyn Fn(&Track) -> Vec<Point>| -> Vec<Curve> {
        looks().map(|(t, look)| Curve { label: label(t), points: points(t), look }).collect()
    };
    let values = curves(&|t| t.values.iter().map(|v| Point::exact(v.0 as f64, v.1)).collect());
    let steps = curves(&|t| {
        t.values
            .windows(2)
            .map(|w| Point::exact(w[1].0 as f64, (w[1].1 - w[0].1).abs()))
            .filter(|p| p.value > 0.0)
            .collect()
    });
    let of = |curves: &[Curve]| curves.iter().flat_map(|c| &c.points).copied().collect::<Vec<_>>();
    let patches = || Axis::log("patches", all.iter().flat_map(|t| &t.values).map(|v| v.0 as f64));

    let high = of(&values).iter().map(|p| p.value).fold(band, f64::max);
    let low = of(&values).iter().map(|p| p.value).fold(-band, f64::min);
    let air = 0.06 * (high - low);
    let y = Axis::linear("λ", low - air, high + air, 9);
    let panel = Panel::draw(page, "Leading eigenvalues of T", [84.0, 72.0, 400.0, 470.0], patches(), y)?;
    for level in [band, -band] {
        panel.line((1e-3, level), (1e12, level), BAND)?;
    }
    values.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;

    let y = Axis::log("|change from the previous mesh|", of(&steps).iter().map(|p| p.value));
    let panel = Panel::draw(page, "Steps", [580.0, 72.0, 380.0, 470.0], patches(), y)?;
    steps.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;

    let mut entries = vec![Entry::new(Sample::Heading, "Outside the band, finest mesh")];
    entries.extend(outside.iter().enumerate().map(|(i, t)| Entry::new(Sample::Mark(Look::nth(i)), label(t))));
    if !inside.is_empty() {
        entries.push(Entry::new(Sample::Heading, "Inside"));
        entries.push(Entry::new(Sample::Mark(INSIDE), "they change with the mesh"));
    }
    entries.push(Entry::new(Sample::Line(BAND), format!("±0.42361 √(ρ₁ρ₂) = ±{band:.4}")));
    page.legend((984.0, 68.0), 240.0, &entries)?;
    Ok(())
}
