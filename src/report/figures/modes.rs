//! The spectrum of T: tables, a figure, and a sheet of painted modes.
//!
//! | shown | meaning |
//! |---|---|
//! | λ | eigenvalues, by falling magnitude; those inside the band of the edges get no number |
//! | band | ±0.42361 √(ρ₁ρ₂): eigenvalues inside it come from edges where two faces meet, and change with every mesh |
//! | share | ⟨u, T E⟩_w² / ‖T E‖_w²: the part of the first bounce that mode u carries |
//! | decay | \|⟨u, T^k E⟩_w\| = λ^{k−1} \|⟨u, T E⟩_w\|: each mode decays at its own rate |
//! | ratio | ‖T^{k+1} E‖ / ‖T^k E‖: in the weight A/ρ it never falls and stays below r(T); in another norm it may rise and fall |

use crate::report::{
    ReportError,
    image::{
        picture::{Picture, magnification},
        sheet::{Layout, READABLE, SLIDE, Tile, columns_in, in_rows},
        typeset::Caption,
        zmap,
    },
    plot::{Axis, BLACK, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure},
    text::{
        number::significant,
        table::{Side, aligned},
    },
};
use serde_json::{Value, json};

/// One eigenvalue of T with its mode u.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// λ.
    pub value: f64,
    /// ‖T u − λ u‖_w.
    pub residual: f64,
    /// |⟨u, T^k E⟩_w| for k = 1, 2, ….
    pub decay: Vec<f64>,
}

/// Eigenvalues, bounds and norms of T in one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// red, green or blue.
    pub channel: String,
    /// All eigenvalues, by falling magnitude.
    pub values: Vec<f64>,
    /// Half width of the band of the edges; 0 if no two faces meet at an edge.
    pub band: f64,
    /// Lower and upper bound of r(T).
    pub radius: [f64; 2],
    /// ‖T‖₁, ‖T‖₂, ‖T‖∞.
    pub norms: [f64; 3],
    /// The modes of the leading eigenvalues.
    pub modes: Vec<Row>,
    /// ‖T^k E‖_w for k = 1, 2, ….
    pub weighted: Vec<f64>,
    /// ‖T^k E‖_A, unweighted, for k = 1, 2, ….
    pub unweighted: Vec<f64>,
}

/// An eigenvalue smaller than this cannot be told from zero, because form factors are stored in single precision.
pub const ROUNDING: f64 = 1e-6;

impl Spectrum {
    /// Returns true if an eigenvalue lies outside the band, and so belongs to the scene rather than to the mesh.
    pub fn outside(&self, value: f64) -> bool {
        value.abs() > self.band.max(ROUNDING)
    }

    fn share(&self, row: &Row) -> f64 {
        (row.decay.first().copied().unwrap_or(0.0) / self.weighted.first().copied().unwrap_or(f64::NAN)).powi(2)
    }
}

/// Ratios of consecutive values.
fn ratios(norms: &[f64]) -> Vec<f64> {
    norms.windows(2).map(|w| w[1] / w[0]).collect()
}

/// A row per channel: bounds of r(T), norms, the band, and how many of the eigenvalues lie outside it.
pub fn norms(all: &[Spectrum]) -> String {
    let header = ["channel", "r(T) ≥", "r(T) ≤", "‖T‖₁", "‖T‖₂", "‖T‖∞", "band ±", "outside", "of"];
    let mut rows = vec![header.map(String::from).to_vec()];
    for s in all {
        let mut row = vec![s.channel.clone()];
        row.extend(s.radius.iter().chain(&s.norms).chain([&s.band]).map(|v| format!("{v:.5}")));
        row.push(s.values.iter().filter(|v| s.outside(**v)).count().to_string());
        row.push(s.values.len().to_string());
        rows.push(row);
    }
    aligned(&rows, &[Side::Left].into_iter().chain([Side::Right; 8]).collect::<Vec<_>>())
}

/// A row for each of the first `most` leading modes of a channel.
pub fn table(s: &Spectrum, most: usize) -> String {
    let header = ["mode", "λ", "residual", "share of TE", "k = 4", "k = 8", ""];
    let mut rows = vec![header.map(String::from).to_vec()];
    let first = s.weighted.first().copied().unwrap_or(f64::NAN);
    for (i, m) in s.modes.iter().take(most).enumerate() {
        let at = |k: usize| m.decay.get(k - 1).map_or("–".into(), |d| significant(d / first, 3));
        let outside = s.outside(m.value);
        rows.push(vec![
            if outside { (i + 1).to_string() } else { "–".into() },
            format!("{:+.5}", m.value),
            format!("{:.0e}", m.residual),
            format!("{:.2} %", 100.0 * s.share(m)),
            at(4),
            at(8),
            match outside {
                true => String::new(),
                false if m.value.abs() <= ROUNDING => "zero to rounding".into(),
                false => "in the band".into(),
            },
        ]);
    }
    let sides = [Side::Right, Side::Right, Side::Right, Side::Right, Side::Right, Side::Right, Side::Left];
    aligned(&rows, &sides)
}

/// Ratios ‖T^{k+1} E‖ / ‖T^k E‖ for growing k, in the weight A/ρ and in the area norm.
pub fn ratio_table(s: &Spectrum) -> String {
    let mut rows = vec![["k", "weight A/ρ", "area"].map(String::from).to_vec()];
    for (k, (w, a)) in ratios(&s.weighted).into_iter().zip(ratios(&s.unweighted)).enumerate() {
        rows.push(vec![format!("{} / {}", k + 2, k + 1), format!("{w:.5}"), format!("{a:.5}")]);
    }
    aligned(&rows, &[Side::Right; 3])
}

/// All numbers of the tables as a JSON value, for `--json`.
pub fn machine(all: &[Spectrum]) -> Value {
    let one = |s: &Spectrum| {
        let modes = s.modes.iter().map(|m| {
            json!({
                "value": m.value, "residual": m.residual, "outside_band": s.outside(m.value),
                "share": s.share(m), "decay": m.decay,
            })
        });
        json!({
            "channel": s.channel, "spectral_radius": { "at_least": s.radius[0], "at_most": s.radius[1] },
            "norm_1": s.norms[0], "norm_2": s.norms[1], "norm_inf": s.norms[2], "band": s.band,
            "eigenvalues": s.values, "modes": modes.collect::<Vec<_>>(),
            "weighted_norms": s.weighted, "area_norms": s.unweighted,
            "weighted_ratios": ratios(&s.weighted), "area_ratios": ratios(&s.unweighted),
        })
    };
    Value::Array(all.iter().map(one).collect())
}

const GUIDE: Stroke = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
const LIMIT: Stroke = Stroke { color: BLACK, width: 1.6, dash: Some((2.0, 4.0)) };

/// Draws the eigenvalues with the band, the decay of the modes, and the ratios in both norms.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(s: &Spectrum, title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    figure("modes", 1120, 860, caption, |page| panels(page, s, title))
}

fn panels(page: &Canvas, s: &Spectrum, title: &str) -> Drawn {
    page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    // every eigenvalue: one outside the band is a mark, those inside are small change
    let last = s.values.len().min(60);
    let top = s.values.iter().fold(0.0, |m: f64, v| m.max(v.abs())) * 1.08;
    let x = Axis::counts("eigenvalues by magnitude", last, 12);
    let panel = Panel::draw(page, "Spectrum of T", [84.0, 72.0, 760.0, 300.0], x, Axis::linear("λ", -top, top, 8))?;
    let end = last as f64 + 0.5;
    for level in [s.band, -s.band] {
        panel.line((-0.5, level), (end, level), GUIDE)?;
    }
    let of = |outside: bool| {
        let all = s.values.iter().take(last).enumerate().filter(|(_, v)| s.outside(**v) == outside);
        all.map(|(i, v)| Point::exact(i as f64 + 1.0, *v)).collect::<Vec<_>>()
    };
    let curves = [
        Curve { label: "outside the band: the scene's".into(), points: of(true), look: Look::nth(0) },
        Curve { label: "inside: the mesh's".into(), points: of(false), look: Look::nth(4) },
    ];
    let mut entries = vec![];
    for c in curves.iter().filter(|c| !c.points.is_empty()) {
        panel.curve(c, 0.0, false)?;
        entries.push(Entry::new(Sample::Mark(c.look), &c.label));
    }
    if s.band > 0.0 {
        entries.push(Entry::new(Sample::Line(GUIDE), format!("±0.42361 √(ρ₁ρ₂) = ±{:.4}", s.band)));
    }
    entries.push(Entry::new(Sample::Heading, format!("{} of {} shown", last, s.values.len())));
    page.legend((864.0, 68.0), 240.0, &entries)?;

    // each mode dies at its rate
    let bounces = s.weighted.len();
    let points = |v: &[f64]| v.iter().enumerate().map(|(k, v)| Point::exact(k as f64 + 1.0, *v)).collect::<Vec<_>>();
    let floor = s.weighted.iter().copied().fold(f64::INFINITY, f64::min) * 1e-4;
    let decays: Vec<Curve> = s
        .modes
        .iter()
        .enumerate()
        .filter(|(_, m)| s.outside(m.value))
        .take(6)
        .map(|(i, m)| Curve {
            label: format!("mode {}, λ = {:+.4}", i + 1, m.value),
            points: points(&m.decay).into_iter().filter(|p| p.value > floor).collect(),
            look: Look::nth(i),
        })
        .collect();
    let whole = Curve { label: "‖TᵏE‖, all modes".into(), points: points(&s.weighted), look: Look::MATRIX };
    let shown = || decays.iter().chain([&whole]);
    let y = Axis::log("part of TᵏE", shown().flat_map(|c| &c.points).map(|p| p.value));
    let x = Axis::counts("bounce k", bounces, 10);
    let panel = Panel::draw(page, "Decay of the modes", [84.0, 460.0, 320.0, 320.0], x, y)?;
    shown().try_for_each(|c| panel.curve(c, 0.0, true))?;

    // the ratios
    let [weighted, area] = [ratios(&s.weighted), ratios(&s.unweighted)];
    let values = || weighted.iter().chain(&area).copied().chain([s.radius[1]]);
    let low = values().fold(f64::INFINITY, f64::min);
    let high = values().fold(0.0, f64::max);
    let air = 0.08 * (high - low).max(0.01);
    let y = Axis::linear("ratio", low - air, high + air, 6);
    let x = Axis::counts("bounce k", bounces - 1, 10);
    let title = "‖Tᵏ⁺¹E‖ / ‖TᵏE‖";
    let panel = Panel::draw(page, title, [520.0, 460.0, 324.0, 320.0], x, y)?;
    let end = bounces as f64;
    panel.line((0.0, s.radius[1]), (end, s.radius[1]), LIMIT)?;
    let rise = [
        Curve { label: "ratio, weight A/ρ: never falls".into(), points: points(&weighted), look: Look::nth(1) },
        Curve { label: "ratio, area norm".into(), points: points(&area), look: Look::nth(2) },
    ];
    rise.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
    let mut entries: Vec<Entry> = shown().map(|c| Entry::new(Sample::Mark(c.look), &c.label)).collect();
    entries.insert(0, Entry::new(Sample::Heading, "Decay"));
    entries.push(Entry::new(Sample::Heading, "Ratio"));
    entries.extend(rise.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)));
    entries.push(Entry::new(Sample::Line(LIMIT), format!("r(T) ≤ {:.5}", s.radius[1])));
    page.legend((864.0, 456.0), 240.0, &entries)?;
    Ok(())
}

/// A mode as an image seen by the camera.
#[derive(Clone, Debug)]
pub struct Painted {
    /// Line above the image.
    pub label: String,
    /// u at every pixel, with sign.
    pub values: Vec<f64>,
}

/// A sheet of painted modes: red where positive, blue where negative, white at zero. Each is scaled by its own 99th percentile.
///
/// # Errors
/// If there is no mode, the values do not match the size, or the text cannot be drawn.
pub fn sheet(
    title: &str,
    [width, height]: [usize; 2],
    modes: &[Painted],
    caption: &Caption,
) -> Result<Picture, ReportError> {
    if modes.is_empty() || modes.iter().any(|m| m.values.len() != width * height) {
        let cause = format!("modes that do not fill {width}×{height} pixels");
        return Err(ReportError::new("(modes)", cause, "paint modes of one size"));
    }
    let tile = |m: &Painted| {
        let mut sizes: Vec<f64> = m.values.iter().map(|v| v.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let scale = sizes[(sizes.len() - 1) * 99 / 100].max(f64::MIN_POSITIVE);
        // the map goes from −4 to 4
        let pixels = m.values.iter().map(|v| zmap::color(4.0 * v / scale)).collect();
        let image = Picture { width, height, pixels }.enlarged(magnification(width, height, 256));
        Tile { image, label: m.label.clone(), notes: vec![] }
    };
    let tiles: Vec<Tile> = modes.iter().map(tile).collect();
    let places = in_rows(tiles.len(), columns_in(SLIDE as f64, &tiles, READABLE).min(4));
    let foot = Some("red: positive, blue: negative, white: zero; each at its own scale (99th percentile)");
    Layout { title, tiles: &tiles, places: &places, heads: &[], foot, scale: READABLE }.draw(caption)
}
