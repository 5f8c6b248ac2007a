//! Unbiased, consistent, neither: three ways to compute one image with growing effort.
//!
//! ```text
//! unbiased:    E[X_n] = L for every n            consistent:   X_n → L as the effort n grows
//! noise ∝ n^(−1/2)                               neither:      X_n → L + b with b ≠ 0
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X_n | mean of n samples per pixel, or the solution on n patches | [`Stage`] |
//! | L | mean of the image by an independent render with many samples | `reference` |
//! | b | bias: of patches it falls with their width h, of clamped samples it stays | [`Stage::error`] |
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), ch. 2.

use super::board::{Board, MARGIN, WIDTH};
use super::measure::{REPLICATES, Shot, built_in};
use fredholm::engine::{Settings, by_matrix};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::report::book::{Folder, Number, Result, Slide};
use fredholm::report::half_width_95;
use fredholm::report::image::picture::{auto_gain, develop, gain_label};
use fredholm::report::plot::{Axis, Canvas, Curve, Drawn, GREY, Look, Panel, Point, Words};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::plus_minus;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::{Description, Scene};
use fredholm::terms::Estimate;
use fredholm::terms::functional::functionals;
use fredholm::zoo::{Walk, bookkeeping::Clamped, walk::Whole};
use glam::DVec3;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "unbiased-and-consistent",
    topic: "Unbiased and consistent",
    caption: "Each row is a method, each column has four times the effort of the one before. Path tracing is noisy, but \
              its mean is right at every effort. Radiosity has no noise; its error falls with the patches, and it is never \
              zero. With clamped samples the noise falls as well, but the error stays: more samples do not help.",
    scene: "cornell",
    program,
};

/// Relative efforts of the columns, in a full and in a short run.
const EFFORT: [[u32; 4]; 2] = [[1, 4, 16, 64], [1, 2, 4, 8]];
/// Samples per pixel, or patches, for the effort 1.
const SAMPLES: u32 = 4;
const PATCHES: u32 = 32;
/// The largest value of a clamped sample.
const CLAMP: f32 = 0.5;
/// Width of a picture.
const SIZE: u32 = 128;
const PITCH: f64 = 136.0;

/// One picture of a row.
struct Stage {
    pixels: Vec<[f32; 3]>,
    amount: String,
    /// Mean of the image minus that of the reference, in percent of it.
    error: Number,
    replicates: u64,
}

impl Stage {
    fn new(pixels: Vec<[f32; 3]>, amount: String, mean: &Estimate, reference: &Estimate) -> Self {
        let grey = |v: DVec3| v.element_sum() / 3.0;
        let right = grey(reference.mean);
        let value = 100.0 * (grey(mean.mean) / right - 1.0);
        let error = 100.0 * grey(mean.std_error).hypot(grey(reference.std_error)) / right;
        Self {
            pixels,
            amount,
            error: Number { value, std_error: error },
            replicates: mean.replicates.min(u64::from(REPLICATES)),
        }
    }

    fn half(&self) -> f64 {
        half_width_95(self.error.std_error, self.replicates)
    }
}

const ROWS: [(&str, &str); 3] = [
    ("Unbiased: path tracing", "The noise falls. The mean is right for every n."),
    ("Biased, consistent: radiosity", "The error falls with the width of the patches."),
    ("Neither: samples clamped at 0.5", "The noise falls, the error stays."),
];

fn room(size: u32) -> Result<Description> {
    let mut room = built_in("cornell", [size, size])?;
    // the lower part of the box, without the lamp
    (room.camera.target, room.camera.fov) = (DVec3::new(0.0, -0.3, 0.0), 26.0);
    Ok(room)
}

fn program(folder: &Folder<'_>) -> Result<()> {
    let description = room(folder.pick(SIZE, SIZE / 2))?;
    let scene = Scene::new(&description);
    let plan = Plan { max_bounces: 2, technique: Technique::Connect, roulette: Roulette::Albedo { from: 2 } };
    let prefix = Prefix(plan.clone());
    let right = Shot::new(&scene, Sampling::Bsdf, &prefix, folder.pick(384, 128), "reference", folder);
    let reference = functionals(&right.film)[0].total;

    let sampled = |shot: &Shot| {
        let pixels = shot.image(0..shot.film.shape.slots).mean;
        Stage::new(pixels, format!("n = {}", shot.spp), &functionals(&shot.film)[0].total, &reference)
    };
    let effort = EFFORT[usize::from(folder.quick)];
    let unbiased = effort
        .map(|n| sampled(&Shot::new(&scene, Sampling::Bsdf, &prefix, n * SAMPLES, &format!("unbiased {n}"), folder)));
    let clamped = effort.map(|n| {
        let walk = Whole(Walk { plan: plan.clone(), mistake: &Clamped(CLAMP) });
        sampled(&Shot::new(&scene, Sampling::Bsdf, &walk, n * SAMPLES, &format!("clamped {n}"), folder))
    });
    let settings = Settings { spp: 32, max_bounces: 1, read_patches: true, seed: folder.seed, ..Settings::default() };
    let mut patches = vec![];
    for n in effort {
        let matrix = by_matrix::matrix(&description, &scene, (n * PATCHES) as usize, &settings, folder.progress)?;
        let seen = matrix.through_camera(&scene, &settings, folder.progress);
        let name = format!("{} patches", matrix.radiosity.patches().len());
        patches.push(Stage::new(seen.total.mean, name, &seen.series.image().total, &reference));
    }
    let rows = [unbiased.into_iter().collect(), patches, clamped.into_iter().collect()];
    let gain = auto_gain(&right.image(0..right.film.shape.slots).mean);
    let found = check(&rows);
    let mut csv = Csv::new("method,effort,amount,error_percent,std_error");
    for ((name, _), row) in ROWS.iter().zip(&rows) {
        for (n, s) in effort.iter().zip(row) {
            csv.put(name).put(n).put(&s.amount).numbers([s.error.value, s.error.std_error]).end();
        }
    }
    folder.text("unbiased-and-consistent.csv", &csv.text())?;
    draw(folder, effort, &rows, gain)?;
    found
}

/// What the slide says about the errors must hold.
fn check(rows: &[Vec<Stage>; 3]) -> Result<()> {
    let [unbiased, patches, clamped] = rows;
    let certain = |s: &Stage| s.error.value.abs() > 3.0 * s.error.std_error;
    if unbiased.iter().any(|s| s.error.value.abs() > 4.0 * s.error.std_error) {
        return Err("path tracing has a bias".into());
    }
    if patches.windows(2).any(|s| s[1].error.value.abs() >= s[0].error.value.abs()) {
        return Err("the error of the patches does not fall".into());
    }
    let [.., before, last] = clamped.as_slice() else { return Err("four stages are expected".into()) };
    let change = last.error.minus(before.error);
    if !certain(last) || change.value.abs() > 0.1 * last.error.value.abs() + 3.0 * change.std_error {
        return Err("the error of clamped samples is not constant".into());
    }
    Ok(())
}

fn draw(folder: &Folder<'_>, effort: [u32; 4], rows: &[Vec<Stage>; 3], gain: f64) -> Result<()> {
    let mut board = Board::new("More effort: does the error go to zero?", "");
    board.y -= 2.0;
    let right = MARGIN + 4.0 * PITCH + 16.0;
    let room = WIDTH - MARGIN - right;
    let y = board.paragraph(
        &format!(
            "Effort 1: {SAMPLES} samples per pixel, or {PATCHES} patches. The plot shows the error of the mean of the \
             image, ±\u{a0}95\u{a0}%. Arrow: an upper limit, because the error may be\u{a0}0. Pictures: gain {}.",
            gain_label(gain)
        ),
        (right, board.y + 4.0),
        room,
        14.0,
    );
    let mut marks = vec![];
    for (i, ((name, says), row)) in ROWS.iter().zip(rows).enumerate() {
        let words = Words { size: 14.0, ..Words::default() };
        marks.push(((MARGIN + 6.0, board.y + 6.0), Look::nth(i)));
        board.text(&format!("{name}. {says}"), (MARGIN + 18.0, board.y + 6.0), 4.0 * PITCH - 8.0, words);
        let top = (board.y + 16.0).round();
        for (column, s) in row.iter().enumerate() {
            let x = MARGIN + column as f64 * PITCH;
            let width = (s.pixels.len() as f64).sqrt() as usize;
            let picture = develop(width, width, &s.pixels, gain).picture.enlarged(SIZE as usize / width);
            board.picture(picture, [x as u32, top as u32], 1);
            let note = Words { size: 12.5, color: GREY, ..Words::default() };
            board.text(&s.amount, (x, top + f64::from(SIZE) + 9.0), PITCH, note);
        }
        board.y = top + f64::from(SIZE) + 20.0;
    }
    let frame = [right + 62.0, y + 24.0, room - 66.0, 230.0];
    let table = y + 24.0 + 230.0 + 66.0;
    let columns = [0.09, 0.40, 0.71].map(|part| right + part * room);
    let words = Words { size: 13.0, ..Words::default() };
    board.text("effort, and error of the mean in %", (right, table - 18.0), room, words);
    for (line, n) in effort.iter().enumerate() {
        let y = table + 18.0 * (line as f64 + 1.0);
        board.text(&n.to_string(), (right, y), room, words);
        for (x, row) in columns.iter().zip(rows) {
            let s = &row[line];
            board.text(&plus_minus(s.error.value, s.half(), 2), (*x, y), 0.3 * room, words);
        }
    }
    marks.extend(columns.iter().enumerate().map(|(i, x)| ((x + 6.0, table), Look::nth(i))));
    board.finish(folder, &SLIDE, |canvas| {
        marks.iter().try_for_each(|&(place, look)| canvas.mark(place, look))?;
        plot(canvas, frame, effort, rows)
    })
}

/// |error of the mean| against effort, with 95 % intervals.
fn plot(canvas: &Canvas<'_>, frame: [f64; 4], effort: [u32; 4], rows: &[Vec<Stage>; 3]) -> Drawn {
    let all = || rows.iter().flatten().map(|s| s.error.value.abs());
    let x = Axis::powers_of_two("effort", effort.iter().map(|&n| f64::from(n)), 7);
    let y = Axis::log("|error of the mean| in %", all().filter(|v| *v > 0.05).chain([0.05]));
    let panel = Panel::draw(canvas, "", frame, x, y)?;
    for (i, row) in rows.iter().enumerate() {
        let point = |(n, s): (&u32, &Stage)| Point {
            x: f64::from(*n),
            value: s.error.value.abs(),
            std_error: s.error.std_error,
            replicates: s.replicates,
        };
        let points = effort.iter().zip(row).map(point).collect();
        panel.curve(&Curve { label: ROWS[i].0.into(), points, look: Look::nth(i) }, 4.0 * (i as f64 - 1.0), true)?;
    }
    Ok(())
}
