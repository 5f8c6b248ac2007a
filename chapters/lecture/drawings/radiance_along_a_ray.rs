//! A lamp seen from three distances: radiance stays, solid angle and irradiance fall.
//!
//! ```text
//! L(x, ω) = L(y, −ω)   along a ray           Ω = ∫ L/L_e dω ≈ A/d²           E = ∫ L cos θ dω ≈ L_e A/d²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_e | radiance of the lamp, the same in every direction | [`RADIANCE`] |
//! | A | area of the lamp, a square of side [`SIDE`], m² | |
//! | d | distance of the eye, or of the facing patch, m | [`DISTANCES`] |
//! | L | radiance in the pixel in the middle | [`Seen::radiance`] |
//! | Ω | solid angle of the lamp at the eye: the image, weighted with the solid angles of its pixels | [`Seen::solid_angle`] |
//! | E | irradiance on a patch that faces the lamp: π/ρ times the radiance T E that leaves it | [`Seen::irradiance`] |
//!
//! The power laws are limits: at finite d, Ω d²/A = 1 − a²/(4d²) + … and E d²/(L_e A) = 1 − a²/(3d²) + ….
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), section 3.4.

use super::page::{LEFT, SIZE, WIDTH, centred, heading, maths, paragraph, title, words};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Sampled};
use fredholm::estimator::Technique;
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::picture::{Picture, develop};
use fredholm::report::plot::{
    Axis, BLACK, BLUE, Canvas, Colour, Curve, Drawn, Entry, GREEN, GREY, Look, Mark, ORANGE, Panel, Point, Sample,
    Stroke, VERMILION, figure,
};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::significant;
use fredholm::scene::{Scene, load};
use std::f64::consts::PI;
use std::path::Path;

/// This figure.
pub const SLIDE: Slide = Slide {
    id: "radiance-along-a-ray",
    topic: "Radiance stays constant along a ray",
    caption: "The same lamp from one, two and four metres, at the same exposure: it looks smaller, not darker. The radiance \
              in the pixel stays. The solid angle of the lamp and the irradiance on a patch that faces it fall with the \
              square of the distance.",
    scene: "none",
    program,
};

/// The scene, for the caption.
const SCENE: &str = "a square lamp of 0.3 m and a patch (part of this figure's program)";
/// Distances d, m.
const DISTANCES: [f64; 3] = [1.0, 2.0, 4.0];
/// Side of the lamp, m.
const SIDE: f64 = 0.3;
/// Radiance of the lamp, W·sr⁻¹·m⁻².
const RADIANCE: f64 = 0.6;
/// Albedo of the facing patch.
const ALBEDO: f64 = 0.5;
/// Margin of the power laws at the largest lamp: a²/(3d²) is 3 % at d = 1 m.
const MARGIN: f64 = 0.04;
/// Horizontal field of view of the pictures, degrees.
const FOV: f64 = 28.0;

/// A value with its standard error.
#[derive(Clone, Copy)]
struct Value {
    mean: f64,
    std_error: f64,
}

/// What is measured at one distance.
struct Seen {
    distance: f64,
    radiance: Value,
    solid_angle: Value,
    irradiance: Value,
    picture: Picture,
}

/// The lamp at z = 0 facing +z, and a patch at distance `d` facing it. The camera looks at `target`.
fn scene(distance: f64, [origin, target]: [f64; 2], fov: f64, size: u32) -> Result<Scene> {
    let (h, far) = (0.5 * SIDE, distance);
    let text = format!(
        "name = \"lamp\"\n\
         [camera]\norigin = [0, 0, {origin}]\ntarget = [0, 0, {target}]\nup = [0, 1, 0]\nfov = {fov}\nsize = [{size}, {size}]\n\
         [materials.black]\ntype = \"diffuse\"\nreflectance = [0, 0, 0]\nsides = \"front\"\n\
         [materials.patch]\ntype = \"diffuse\"\nreflectance = [{ALBEDO}, {ALBEDO}, {ALBEDO}]\nsides = \"front\"\n\
         [[shapes]]\nname = \"lamp\"\ntype = \"quad\"\norigin = [-{h}, -{h}, 0]\nedge_u = [{SIDE}, 0, 0]\n\
         edge_v = [0, {SIDE}, 0]\nmaterial = \"black\"\nemission = [{RADIANCE}, {RADIANCE}, {RADIANCE}]\n\
         [[shapes]]\nname = \"patch\"\ntype = \"quad\"\norigin = [-0.01, 0.01, {far}]\nedge_u = [0.02, 0, 0]\n\
         edge_v = [0, -0.02, 0]\nmaterial = \"patch\"\n"
    );
    Ok(Scene::new(&load::toml(&text, Path::new("lamp.toml"), &load::Options::default())?.description))
}

/// Mean of the values of some pixels with weights, and its standard error. Pixels are independent.
fn weighted(pixels: impl Iterator<Item = ([f32; 3], [f32; 3], f64)>) -> Value {
    let (mut mean, mut square) = (0.0, 0.0);
    for (value, error, weight) in pixels {
        mean += weight * f64::from(value[0]);
        square += (weight * f64::from(error[0])).powi(2);
    }
    Value { mean, std_error: square.sqrt() }
}

fn measure(distance: f64, folder: &Folder<'_>) -> Result<Seen> {
    let size = folder.pick(320, 160);
    let settings = Settings {
        spp: folder.pick(64, 32),
        seed: folder.seed,
        max_bounces: 1,
        technique: Technique::Connect,
        ..Settings::default()
    };
    // the eye is just in front of the patch and looks at the lamp
    let eye = scene(distance, [distance - 1e-3, 0.0], FOV, size)?;
    let image: Sampled = by_rays::path(&eye, &settings, folder.progress);
    let pixels = &image.total;
    let width = 2.0 * (0.5 * FOV).to_radians().tan() / f64::from(size);
    let angle = |i: usize| {
        let place = |n: usize| (n as f64 + 0.5 - 0.5 * f64::from(size)) * width;
        let (x, y) = (place(i % size as usize), place(i / size as usize));
        width * width / (1.0 + x * x + y * y).powf(1.5)
    };
    let all = || pixels.mean.iter().zip(&pixels.std_error).enumerate();
    let middle = (size / 2 * size + size / 2) as usize;
    let radiance = weighted(all().filter(|(i, _)| *i == middle).map(|(_, (&m, &e))| (m, e, 1.0)));
    let solid_angle = weighted(all().map(|(i, (&m, &e))| (m, e, angle(i) / RADIANCE)));
    // the eye turns round: it is between lamp and patch and looks at the middle of the patch
    let settings = Settings { spp: folder.pick(8192, 2048), ..settings };
    let patch = by_rays::path(&scene(distance, [0.5 * distance, distance], 0.1, 4)?, &settings, folder.progress);
    let reflected = patch.total.mean.iter().zip(&patch.total.std_error);
    let irradiance = weighted(reflected.map(|(&m, &e)| (m, e, PI / ALBEDO / 16.0)));
    let developed = develop(size as usize, size as usize, &pixels.mean, 1.0).picture;
    Ok(Seen { distance, radiance, solid_angle, irradiance, picture: developed.enlarged(folder.pick(1, 2)) })
}

/// Returns an error if a law does not hold within its margin and four standard errors.
fn check(all: &[Seen]) -> Result<()> {
    for s in all {
        let law = |name: &str, v: Value, expected: f64, margin: f64| {
            let off = (v.mean - expected).abs();
            let allowed = margin * expected + 4.0 * v.std_error;
            if off <= allowed { Ok(()) } else { Err(format!("{name} at {} m: {} ≠ {expected}", s.distance, v.mean)) }
        };
        let omega = SIDE.powi(2) / s.distance.powi(2);
        law("radiance", s.radiance, RADIANCE, 1e-6)?;
        law("solid angle", s.solid_angle, omega, MARGIN)?;
        law("irradiance", s.irradiance, RADIANCE * omega, MARGIN)?;
    }
    Ok(())
}

fn program(folder: &Folder<'_>) -> Result<()> {
    let seen = DISTANCES.iter().map(|&d| measure(d, folder)).collect::<Result<Vec<Seen>>>()?;
    check(&seen)?;
    let mut csv = Csv::new("distance,radiance,radiance_se,solid_angle,solid_angle_se,irradiance,irradiance_se");
    for s in &seen {
        csv.numbers([s.distance, s.radiance.mean, s.radiance.std_error, s.solid_angle.mean]);
        csv.numbers([s.solid_angle.std_error, s.irradiance.mean, s.irradiance.std_error]).end();
    }
    let mut drawing = figure(SLIDE.id, WIDTH, 552, &folder.caption(SCENE), |page| {
        title(page, SLIDE.topic)?;
        geometry(page)?;
        pictures(page, &seen)?;
        plot(page, &seen)
    })?;
    for (i, s) in seen.iter().enumerate() {
        drawing = drawing.over(s.picture.clone(), [PICTURES[0] + STEP * i as u32, PICTURES[1]], 2)?;
    }
    folder.figure(SLIDE.id, &drawing)?;
    folder.text("radiance-along-a-ray.csv", &csv.text())?;
    Ok(())
}

/// Upper left corner of the first picture and the distance to the next.
const PICTURES: [u32; 2] = [LEFT as u32, 258];
const STEP: u32 = 178;

/// The lamp and the three eyes from the side.
fn geometry(page: &Canvas<'_>) -> Drawn {
    heading(page, "One lamp, three distances", (LEFT, 62.0))?;
    let (x, y, metre) = (LEFT + 24.0, 126.0, 112.0);
    let half = 0.5 * SIDE * metre;
    for (distance, color) in DISTANCES.into_iter().zip(COLORS) {
        let eye = (x + metre * distance, y);
        for end in [y - half, y + half] {
            page.line(eye, (x, end), Stroke::solid(color, 1.8))?;
        }
        page.disk(eye, 6.0, color)?;
        page.line((eye.0 + 11.0, y - 11.0), (eye.0 + 11.0, y + 11.0), Stroke::solid(color, 4.0))?;
        maths(page, &format!("d = {distance} m"), (eye.0, y + 34.0), centred(SIZE, color))?;
    }
    page.line((x, y - half), (x, y + half), Stroke::solid(ORANGE, 8.0))?;
    maths(page, "lamp, radiance L_e", (x - 20.0, y - half - 16.0), words(SIZE, BLACK))?;
    let text = "Dot: the eye. Bar: a patch that faces the lamp. L = L_e at all three eyes, only the angle changes.";
    paragraph(page, text, (LEFT, 182.0), 530.0, words(13.5, BLACK))?;
    Ok(())
}

const COLORS: [Colour; 3] = [BLUE, GREEN, VERMILION];

/// The text around the pictures.
fn pictures(page: &Canvas<'_>, seen: &[Seen]) -> Drawn {
    let [left, top] = PICTURES.map(f64::from);
    heading(page, "What the eye sees, one exposure", (left, top - 30.0))?;
    for (i, (s, color)) in seen.iter().zip(COLORS).enumerate() {
        let x = left + f64::from(STEP) * i as f64;
        page.text(&format!("d = {} m", s.distance), (x, top - 11.0), words(SIZE, color))?;
        let lines = [
            format!("L = {} W sr⁻¹ m⁻²", significant(s.radiance.mean, 4)),
            format!("Ω = {} · 10⁻³ sr", significant(1e3 * s.solid_angle.mean, 4)),
            format!("E = {} · 10⁻³ W m⁻²", significant(1e3 * s.irradiance.mean, 4)),
        ];
        for (j, line) in lines.iter().enumerate() {
            page.text(line, (x, top + 176.0 + 21.0 * j as f64), words(SIZE, BLACK))?;
        }
    }
    let errors = seen.iter().flat_map(|s| [s.radiance, s.solid_angle, s.irradiance]).map(|v| v.std_error / v.mean);
    let text = format!(
        "L: middle pixel. Ω: of the lamp. E: on the facing patch. Standard errors: at most {} %. Because the lamp is not \
         small, 1/d² holds to {} % only.",
        significant(100.0 * errors.fold(0.0, f64::max), 1),
        100.0 * MARGIN
    );
    paragraph(page, &text, (left, top + 246.0), 530.0, words(13.0, GREY))?;
    Ok(())
}

/// The three quantities relative to the smallest distance, with the lines 1 and 1/d².
fn plot(page: &Canvas<'_>, seen: &[Seen]) -> Drawn {
    let x = Axis::powers_of_two("distance d, m", DISTANCES.into_iter(), 4);
    let y = Axis::log("relative to d = 1 m", [1.0 / 24.0, 1.6].into_iter());
    let frame = [626.0, 92.0, 308.0, 300.0];
    let panel = Panel::draw(page, "Measured, relative to d = 1 m", frame, x, y)?;
    let grey = |dash| Stroke { color: GREY, width: 1.6, dash };
    panel.line((1.0, 1.0), (4.0, 1.0), grey(None))?;
    panel.line((1.0, 1.0), (4.0, 1.0 / 16.0), grey(Some((6.0, 4.0))))?;
    type Pick = fn(&Seen) -> Value;
    let curves: [(&str, Look, Pick, f64); 3] = [
        ("radiance L of a pixel", Look { color: BLACK, mark: Mark::Square }, |s| s.radiance, 0.0),
        ("solid angle Ω of the lamp", Look { color: BLUE, mark: Mark::Disk }, |s| s.solid_angle, -5.0),
        ("irradiance E on a facing patch", Look { color: VERMILION, mark: Mark::Diamond }, |s| s.irradiance, 5.0),
    ];
    let mut legend = vec![];
    for (label, look, pick, shift) in curves {
        let first = pick(&seen[0]).mean;
        let point = |s: &Seen| Point {
            x: s.distance,
            value: pick(s).mean / first,
            std_error: pick(s).std_error / first,
            replicates: 16,
        };
        panel.curve(&Curve { label: label.into(), points: seen.iter().map(point).collect(), look }, shift, false)?;
        legend.push(Entry::new(Sample::Mark(look), label));
    }
    let dashed = Sample::Line(grey(Some((6.0, 4.0))));
    legend.push(Entry::new(dashed, "the law 1/d²"));
    page.legend((626.0, 450.0), 300.0, &legend)?;
    Ok(())
}
