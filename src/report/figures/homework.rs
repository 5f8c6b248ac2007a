//! Sheets and numbers of the homework: every bounce alone and added up, roulette, and more and more samples.
//!
//! Symbols: [`study::homework`](crate::study::homework). The bounces alone are shown twice: at one exposure, where they get
//! darker, and each at its own. All other pictures have one exposure: the one that suits the whole image outside the lamps.

use crate::report::{
    ReportError,
    image::{
        contact_sheet::shown,
        picture::{Picture, auto_gain, auto_gain_beside_lamps, gain_label, mean},
        sheet::{Layout, READABLE, Tile, in_rows},
        typeset::{Caption, superscript},
    },
    text::{
        csv::Csv,
        number::{average, percent, plus_minus, significant},
    },
};
use crate::study::homework::{Homework, LAST, ROULETTE};

/// Narrowest and widest panel in pixels.
const PANEL: [usize; 2] = [256, 580];

/// One picture: its file name without the ending, what it shows, and its pixels.
pub struct Single {
    /// The file name.
    pub name: String,
    /// Linear radiance.
    pub pixels: Vec<[f32; 3]>,
    /// Its exposure.
    pub gain: f64,
}

/// A sheet: its file name without the ending, a heading, what to look at, and the picture.
pub struct Sheet {
    /// The file name.
    pub name: &'static str,
    /// Heading.
    pub heading: &'static str,
    /// What to look at.
    pub text: &'static str,
    /// The picture.
    pub picture: Picture,
}

/// The exposure of all pictures that are compared with each other.
pub fn gain(done: &Homework) -> f64 {
    let whole = &done.roulette.total.mean;
    done.terms.terms.first().map_or_else(|| auto_gain(whole), |lamps| auto_gain_beside_lamps(whole, &lamps.mean))
}

/// The depths m that the homework asks for: 0 to 4, and 100, which holds everything.
fn depths() -> impl Iterator<Item = (String, Option<usize>)> {
    (0..LAST).map(|m| (m.to_string(), Some(m))).chain([("100".into(), None)])
}

fn to_depth(done: &Homework, m: Option<usize>) -> Vec<[f32; 3]> {
    m.map_or_else(|| done.roulette.total.mean.clone(), |m| Homework::partial_sum(&done.roulette, m))
}

/// Every picture that is handed in, in full size.
pub fn singles(done: &Homework) -> Vec<Single> {
    let g = gain(done);
    let single = |name: String, pixels: Vec<[f32; 3]>, gain: f64| Single { name, pixels, gain };
    let bounces = (0..=LAST).map(|m| {
        let pixels = done.terms.terms[m].mean.clone();
        let gain = auto_gain(&pixels);
        single(format!("bounce-{m}"), pixels, gain)
    });
    let sums = (0..=LAST).map(|m| single(format!("accumulated-{m}"), Homework::partial_sum(&done.terms, m), g));
    let direct = Homework::partial_sum(&done.terms, 1);
    let indirect = minus(&done.roulette.total.mean, &Homework::partial_sum(&done.roulette, 1));
    let halves = [single("direct".into(), direct, g), single("indirect".into(), indirect, g)];
    let ended = depths().map(|(m, depth)| single(format!("roulette-{m}"), to_depth(done, depth), g));
    let grown = done.grown.iter().map(|s| single(format!("spp-{:04}", s.spp), s.pixels.clone(), g));
    bounces.chain(sums).chain(halves).chain(ended).chain(grown).collect()
}

fn minus(a: &[[f32; 3]], b: &[[f32; 3]]) -> Vec<[f32; 3]> {
    a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|c| a[c] - b[c])).collect()
}

/// The sheets, in the order in which they are shown.
///
/// # Errors
/// If the text cannot be drawn.
pub fn sheets(done: &Homework, [w, h]: [usize; 2], caption: &Caption) -> Result<Vec<Sheet>, ReportError> {
    let g = gain(done);
    let tile = |label: String, pixels: &[[f32; 3]], gain: f64, notes: Vec<String>| Tile {
        image: shown(w, h, pixels, gain, PANEL[0], PANEL[1]),
        label,
        notes,
    };
    let sheet = |title: &str, tiles: &[Tile]| {
        let places = in_rows(tiles.len(), 3);
        Layout { title, tiles, places: &places, heads: &[], foot: None, scale: READABLE }.draw(caption)
    };
    let image = done.terms.series.image();
    let whole = average(&done.roulette.series.image().total).0;
    let term = |m: usize, gain: f64| {
        let (value, half) = average(&image.terms[m]);
        let note = format!("mean {} · {}", plus_minus(value, half, 1), percent(value / whole));
        tile(
            format!("bounce {m}, T{}E {}", superscript(m), gain_label(gain)),
            &done.terms.terms[m].mean,
            gain,
            vec![note],
        )
    };
    let own: Vec<Tile> = (0..=LAST).map(|m| term(m, auto_gain(&done.terms.terms[m].mean))).collect();
    let one: Vec<Tile> = (0..=LAST).map(|m| term(m, g)).collect();
    let sum = |pixels: Vec<[f32; 3]>, label: String| {
        let share = percent(mean(&pixels) / whole);
        tile(label, &pixels, g, vec![format!("{share} of all light")])
    };
    let sums: Vec<Tile> =
        (0..=LAST).map(|m| sum(Homework::partial_sum(&done.terms, m), format!("bounces 0 to {m}"))).collect();
    let direct = Homework::partial_sum(&done.terms, 1);
    let indirect = minus(&done.roulette.total.mean, &Homework::partial_sum(&done.roulette, 1));
    let halves = [
        sum(direct, "direct: k ≤ 1".into()),
        sum(indirect, "indirect: k ≥ 2".into()),
        sum(done.roulette.total.mean.clone(), "direct + indirect".into()),
    ];
    let ended: Vec<Tile> = depths()
        .map(|(m, depth)| {
            let label = if depth.is_some() { format!("depth {m}") } else { format!("depth {m}: all bounces") };
            sum(to_depth(done, depth), label)
        })
        .collect();
    let grown = done.grown.iter().map(|s| {
        let error = if s.squared_error < 0.0 { "≤ noise".into() } else { significant(s.squared_error.sqrt(), 2) };
        tile(format!("{} spp", s.spp), &s.pixels, g, vec![format!("RMSE {error}")])
    });
    let grown: Vec<Tile> = grown.collect();
    let shared = gain_label(g);
    let named = |name, heading, text, picture| Sheet { name, heading, text, picture };
    Ok(vec![
        named(
            "bounces-own-exposure",
            "Each bounce alone, each at its own exposure",
            "Bounce 0 is the lamp seen directly, bounce 1 direct light, bounce 2 the first indirect light. Each picture has its \
             own exposure; the gain is printed above it.",
            sheet("Each bounce alone, each at its own exposure", &own)?,
        ),
        named(
            "bounces-one-exposure",
            "Each bounce alone, all at one exposure",
            "At one exposure the later bounces are darker and darker. The numbers say how much of all light each one holds.",
            sheet(&format!("Each bounce alone, all at the exposure {shared}"), &one)?,
        ),
        named(
            "accumulated",
            "The bounces added up",
            "All bounces up to m. After a few bounces the picture hardly changes: what is left out is the rest of the series.",
            sheet(&format!("Bounces added up, no roulette ({shared})"), &sums)?,
        ),
        named(
            "direct-indirect",
            "Direct and indirect light",
            "The two parts and their sum, at one exposure.",
            sheet(&format!("Direct and indirect light ({shared})"), &halves)?,
        ),
        named(
            "roulette",
            "Russian roulette",
            "The same sums with roulette, which ends every path after a finite number of bounces. The means are those without \
             roulette; only the noise differs.",
            sheet(&format!("Russian roulette, {ROULETTE} ({shared})"), &ended)?,
        ),
        named(
            "spp",
            "More and more samples per pixel",
            "With four times the samples the error is halved. RMSE: root-mean-square error of bounces 0 to 5.",
            sheet(&format!("More and more samples per pixel ({shared})"), &grown)?,
        ),
    ])
}

/// Every mean as CSV: of each bounce without and with roulette, and the error after each number of samples.
pub fn csv(done: &Homework) -> String {
    let mut csv = Csv::new("quantity,n,mean,mean_half_width_95,rmse");
    for (name, side) in [("bounce", &done.terms), ("bounce_with_roulette", &done.roulette)] {
        for (k, e) in side.series.image().terms.iter().enumerate() {
            let (value, half) = average(e);
            csv.put(name).put(k).numbers([value, half, f64::NAN]).end();
        }
    }
    for s in &done.grown {
        csv.put("spp").put(s.spp).numbers([mean(&s.pixels), f64::NAN, s.squared_error.max(0.0).sqrt()]).end();
    }
    csv.text()
}
