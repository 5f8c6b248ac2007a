//! Own paths for every term, against the prefixes of one path.
//!
//! ```text
//! own paths:   Var = Σ_k σ_k²     = trace C        rays = Σ_k (k + 1)      X_k independent
//! prefixes:    Var = Σ_{j,k} C_jk = 1ᵀC1           rays = 2 K              X_k correlated
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X_k | sample of T^k E: k rays of a path, then one connection to the lamp | |
//! | C | covariance of X_1, …, X_K of one path, averaged over pixels and channels | [`Reuse`](fredholm::study::split::Reuse) |
//! | K | number of terms | [`TERMS`] |
//! | correlation | C_jk/√(C_jj C_kk), for k = j + 1 | [`Measured::correlation`] |
//!
//! Every number is the mean over independent repetitions, and its standard error comes from their scatter.
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

use super::page::{LEFT, SIZE, WIDTH, centred, heading, paragraph, title, words};
use fredholm::estimator::{Plan, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::progress::Progress;
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::typeset::superscript;
use fredholm::report::plot::{
    Align, Axis, BLACK, BLUE, Canvas, Colour, Curve, Drawn, GREEN, GREY, Look, ORANGE, PURPLE, Panel, Place, Point,
    Stroke, VERMILION, Words, figure,
};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::{plus_minus, significant};
use fredholm::scene::{Scene, load};
use fredholm::study::split;

/// This figure.
pub const SLIDE: Slide = Slide {
    id: "prefix-reuse",
    topic: "One path estimates all terms: prefix reuse",
    caption: "Left: every term has its own path. Right: the prefixes of one path estimate all terms, so the rays grow with \
              the number of terms and not with its square. The terms of one path share vertices, therefore they are \
              correlated. The table compares variance times rays.",
    scene: "cornell",
    program,
};

/// K: the terms 1, …, K are measured.
const TERMS: usize = 8;
/// Terms in the drawing.
const DRAWN: usize = 4;
/// Colours of the drawn terms.
const COLORS: [Colour; DRAWN] = [BLUE, GREEN, PURPLE, VERMILION];

/// A mean over repetitions with its standard error.
#[derive(Clone, Copy)]
struct Mean {
    value: f64,
    std_error: f64,
}

impl Mean {
    fn of(samples: &[f64]) -> Self {
        let n = samples.len() as f64;
        let value = samples.iter().sum::<f64>() / n;
        let squares = samples.iter().map(|s| (s - value).powi(2)).sum::<f64>();
        Self { value, std_error: (squares / (n * (n - 1.0))).sqrt() }
    }

    fn text(self) -> String {
        plus_minus(self.value, self.std_error, 1)
    }
}

/// What the repetitions found.
struct Measured {
    /// Variance of one sample of the sum over k = 1, …, K: own paths, prefixes.
    variance: [Mean; 2],
    /// Rays of one sample of the sum.
    rays: [f64; 2],
    /// Variance × rays.
    work: [Mean; 2],
    /// Work of own paths over work of prefixes.
    gain: Mean,
    /// Correlation of X_k and X_{k+1}, k = 1, ….
    correlation: Vec<Mean>,
    repetitions: u64,
}

fn measure(scene: &Scene, spp: u32, repetitions: u64, folder: &Folder<'_>) -> Result<Measured> {
    let t = SceneTransport::new(scene);
    let plan = Plan { max_bounces: TERMS, technique: Technique::Connect, roulette: Roulette::Never };
    let (single, prefix) = (SingleTerm(plan.clone()), Prefix(plan));
    let (mut variance, mut rays) = ([vec![], vec![]], [0.0; 2]);
    let mut correlation = vec![vec![]; TERMS - 1];
    for i in 0..repetitions {
        if folder.progress.stopped() {
            return Err("interrupted".into());
        }
        let key = |name: &str| Key::new(folder.seed, &format!("{name} {i}"));
        let counts = [spp; TERMS + 1];
        let own = split::measure(&t, &scene.camera, &single, &counts, key("own paths"), Progress::NONE);
        let reuse = split::reuse(&t, &scene.camera, &prefix, spp, key("prefixes"), Progress::NONE);
        let (own, reuse) = own.zip(reuse).ok_or("interrupted")?;
        // term 0, the lamp seen directly, is left out on both sides: its ray is the first ray of every path
        variance[0].push(own[1..].iter().map(|term| term.variance).sum());
        let pairs = (1..=TERMS).flat_map(|a| (1..=TERMS).map(move |b| (a, b)));
        variance[1].push(pairs.map(|(a, b)| reuse.covariance.entry(a, b)).sum());
        rays = [own[1..].iter().map(|term| term.rays).sum(), reuse.rays];
        for (k, of) in correlation.iter_mut().enumerate() {
            of.push(reuse.covariance.correlation(k + 1, k + 2));
        }
    }
    let works = [0, 1].map(|i| variance[i].iter().map(|v| v * rays[i]).collect::<Vec<f64>>());
    let [own, reuse] = works.each_ref().map(|w| Mean::of(w));
    let value = own.value / reuse.value;
    let std_error = value * (own.std_error / own.value).hypot(reuse.std_error / reuse.value);
    Ok(Measured {
        variance: variance.each_ref().map(|v| Mean::of(v)),
        rays,
        work: [own, reuse],
        gain: Mean { value, std_error },
        correlation: correlation.iter().map(|c| Mean::of(c)).collect(),
        repetitions,
    })
}

fn program(folder: &Folder<'_>) -> Result<()> {
    let size = load::Options { set: vec!["camera.size=[32, 32]".into()], ..Default::default() };
    let scene = Scene::new(&load::scene(SLIDE.scene, &size)?.description);
    let found = measure(&scene, folder.pick(64, 16), folder.pick(16, 6), folder)?;
    let Mean { value, std_error } = found.gain;
    if value - 4.0 * std_error < 1.0 {
        return Err(format!("prefix reuse wins by {value} ± {std_error}, which is not clearly above 1").into());
    }
    let [own, reuse] = found.variance;
    if reuse.value - own.value < 4.0 * own.std_error.hypot(reuse.std_error) {
        return Err("the terms of one path do not add variance by their correlation".into());
    }
    let drawing = figure(SLIDE.id, WIDTH, 552, &folder.caption(SLIDE.scene), |page| {
        title(page, SLIDE.topic)?;
        own_paths(page, (LEFT, 62.0))?;
        prefixes(page, (500.0, 62.0))?;
        table(page, &found, (LEFT, 318.0))?;
        correlations(page, &found)
    })?;
    folder.figure(SLIDE.id, &drawing)?;
    folder.text("prefix-reuse.csv", &csv(&found))?;
    Ok(())
}

fn csv(found: &Measured) -> String {
    let mut csv = Csv::new("quantity,value,std_error");
    for (i, way) in ["own paths", "prefixes"].into_iter().enumerate() {
        csv.put(format!("rays per sample {way}")).numbers([found.rays[i], 0.0]).end();
        let [v, w] = [found.variance[i], found.work[i]];
        csv.put(format!("variance {way}")).numbers([v.value, v.std_error]).end();
        csv.put(format!("variance times rays {way}")).numbers([w.value, w.std_error]).end();
    }
    for (k, c) in found.correlation.iter().enumerate() {
        csv.put(format!("correlation of terms {} and {}", k + 1, k + 2)).numbers([c.value, c.std_error]).end();
    }
    csv.text()
}

/// The symbol of a lamp.
fn lamp(page: &Canvas<'_>, (x, y): Place, half: f64) -> Drawn {
    page.polygon(&[(x - half, y - 5.0), (x + half, y - 5.0), (x + half, y + 5.0), (x - half, y + 5.0)], ORANGE)
}

/// A connection from a vertex to a lamp.
fn connection(page: &Canvas<'_>, from: Place, to: Place) -> Drawn {
    page.line(from, to, Stroke { color: ORANGE, width: 2.4, dash: Some((6.0, 4.0)) })
}

/// One row per term: its own path with k rays, and the connection.
fn own_paths(page: &Canvas<'_>, (left, top): Place) -> Drawn {
    heading(page, "Each term from its own paths", (left, top))?;
    for k in 1..=DRAWN {
        let (y, color) = (top + -2.0 + 43.0 * k as f64, COLORS[k - 1]);
        let at = |i: usize| (left + 62.0 + 54.0 * i as f64, y - if i % 2 == 1 { 14.0 } else { 0.0 });
        let name = format!("T{}E", superscript(k));
        page.text(&name, (left, y), Words { bold: true, ..words(16.0, color) })?;
        page.path(&(0..=k).map(at).collect::<Vec<_>>(), Stroke::solid(color, 2.6))?;
        (1..=k).try_for_each(|i| page.disk(at(i), 5.0, color))?;
        page.disk(at(0), 6.5, BLACK)?;
        let end = (at(k).0 + 44.0, y - 8.0);
        connection(page, at(k), end)?;
        lamp(page, end, 13.0)?;
        let rays = format!("{k} + 1 rays");
        page.text(&rays, (left + 440.0, y - 6.0), Words { align: Align::Right, ..words(SIZE, BLACK) })?;
    }
    let total = (1..=DRAWN).map(|k| k + 1).sum::<usize>();
    let text = format!("Black dot: the eye. Together {total} rays.");
    page.text(&text, (left, top + 212.0), words(SIZE, BLACK))
}

/// One path; the connection of vertex k − 1 gives the estimate of T^k E.
fn prefixes(page: &Canvas<'_>, (left, top): Place) -> Drawn {
    heading(page, "All terms from the prefixes of one path", (left, top))?;
    let at = |i: usize| (left + 20.0 + 92.0 * i as f64, top + if i % 2 == 1 { 138.0 } else { 166.0 });
    let light = top + 50.0;
    for k in 1..=DRAWN {
        page.line(at(k - 1), at(k), Stroke::solid(GREY, 2.6))?;
        connection(page, at(k), (at(k).0 + 6.0, light))?;
        let name = format!("T{}E", superscript(k));
        let place = (at(k).0 + 12.0, 0.5 * (at(k).1 + light));
        page.text(&name, place, Words { bold: true, ..words(16.0, COLORS[k - 1]) })?;
    }
    page.polygon(
        &[
            (at(1).0 - 30.0, light - 6.0),
            (at(DRAWN).0 + 36.0, light - 6.0),
            (at(DRAWN).0 + 36.0, light + 6.0),
            (at(1).0 - 30.0, light + 6.0),
        ],
        ORANGE,
    )?;
    page.text("lamp", (at(1).0 - 38.0, light), Words { align: Align::Right, ..words(SIZE, BLACK) })?;
    for k in 1..=DRAWN {
        page.disk(at(k), 7.0, COLORS[k - 1])?;
        let sub = ["x₀", "x₁", "x₂", "x₃"][k - 1];
        page.text(sub, (at(k).0, at(k).1 + 20.0), centred(15.0, BLACK))?;
    }
    page.disk(at(0), 6.5, BLACK)?;
    page.text("eye", (at(0).0, at(0).1 + 20.0), centred(SIZE, BLACK))?;
    let text = format!("Together {} rays: {DRAWN} along the path, {DRAWN} to the lamp.", 2 * DRAWN);
    page.text(&text, (left, top + 212.0), words(SIZE, BLACK))
}

/// Rays, variance, and their product for both ways.
fn table(page: &Canvas<'_>, found: &Measured, (left, top): Place) -> Drawn {
    heading(page, &format!("Measured for the sum of T¹E, …, T{}E", superscript(TERMS)), (left, top))?;
    let columns = [left, left + 270.0, left + 390.0, left + 500.0];
    let right = |x: f64| (x, Align::Right);
    let head = ["one sample per term", "own paths", "prefixes", "ratio"];
    let ratio = |a: Mean, b: Mean| {
        let value = a.value / b.value;
        Mean { value, std_error: value * (a.std_error / a.value).hypot(b.std_error / b.value) }.text()
    };
    // in units of 10⁻³
    let milli = |m: Mean| Mean { value: 1e3 * m.value, std_error: 1e3 * m.std_error };
    let [v, w] = [found.variance.map(milli), found.work.map(milli)];
    let rays = found.rays.map(|r| significant(r, 3));
    let rows = [
        head.map(String::from),
        ["rays".into(), rays[0].clone(), rays[1].clone(), significant(found.rays[0] / found.rays[1], 3)],
        ["variance, 10⁻³".into(), v[0].text(), v[1].text(), ratio(v[0], v[1])],
        ["variance × rays, 10⁻³".into(), w[0].text(), w[1].text(), found.gain.text()],
    ];
    for (i, row) in rows.iter().enumerate() {
        let y = top + 28.0 + 26.0 * i as f64;
        for (j, cell) in row.iter().enumerate() {
            let (x, align) = if j == 0 { (columns[0], Align::Left) } else { right(columns[j]) };
            let color = [BLACK, BLACK, VERMILION, BLACK][j];
            page.text(cell, (x, y), Words { align, bold: i == 0, ..words(SIZE, color) })?;
        }
        if i == 0 {
            page.line((left, y + 13.0), (columns[3], y + 13.0), Stroke::solid(GREY, 1.0))?;
        }
    }
    let style = words(SIZE, BLACK);
    let text = format!(
        "± is one standard error of {} repetitions. Prefixes share vertices, so the terms are correlated, and their sum has \
         more variance per sample. With equally many rays the prefixes have less variance, by a factor of {}. Some paths leave the \
         open box, therefore fewer than {} and {} rays.",
        found.repetitions,
        significant(found.gain.value, 2),
        (1..=TERMS).map(|k| k + 1).sum::<usize>(),
        2 * TERMS
    );
    paragraph(page, &text, (left, top + 142.0), 530.0, style)?;
    Ok(())
}

/// Correlation of neighbouring terms of one path, against k.
fn correlations(page: &Canvas<'_>, found: &Measured) -> Drawn {
    let most = found.correlation.iter().map(|c| c.value + 3.0 * c.std_error).fold(0.1, f64::max);
    let least = found.correlation.iter().map(|c| c.value - 3.0 * c.std_error).fold(0.0, f64::min);
    let x = Axis::counts("k (bars: 95 %)", TERMS, 9);
    let y = Axis::linear("correlation", least, 1.15 * most, 5);
    let frame = [640.0, 344.0, 296.0, 148.0];
    let panel = Panel::draw(page, "Correlation of TᵏE and Tᵏ⁺¹E", frame, x, y)?;
    let point = |(k, c): (usize, &Mean)| Point {
        x: (k + 1) as f64,
        value: c.value,
        std_error: c.std_error,
        replicates: found.repetitions,
    };
    let points: Vec<Point> = found.correlation.iter().enumerate().map(point).collect();
    panel.curve(&Curve { label: String::new(), points, look: Look::PREFIX }, 0.0, true)
}
