//! One path of the path tracer: from above, from the side, in the picture, and as a table of its decisions.
//!
//! ```text
//! pixel ← Σ_v α_v f cos θ/p E(y_v)          over the vertices x_v whose lamp point y_v is seen
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_v, α_v, y_v, p, q | vertex, throughput, lamp point, density, probability of termination | [`walk`] |
//! | the path that is shown | found by a search without chance | [`choose`] |
//! | the sum of the table | must equal [`PathTracer::radiance`] for the same pixel and sample | [`check`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

mod choose;
mod views;
mod walk;

use super::page::{LEFT, View, WIDTH, heading, maths, paragraph, title, words};
use choose::Projection;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{PathTracer, Plan, Prefix, Roulette, Technique};
use fredholm::math::{CHANNELS, Key, Purpose, Rgb};
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::picture::{Picture, auto_gain_beside_lamps, develop};
use fredholm::report::plot::{
    Align, BLACK, Canvas, Colour, Drawn, GREY, ORANGE, Place, Stroke, VERMILION, Words, figure,
};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::significant;
use fredholm::scene::{Description, Scene, load};
use fredholm::terms::TermImage;
use glam::{DVec3, Vec3};
use walk::{Address, Visit};

/// This figure.
pub const SLIDE: Slide = Slide {
    id: "one-path",
    topic: "One path of the path tracer",
    caption: "The same path from above, from the side and in the picture. At every vertex it asks whether a random point of \
              the lamp is seen: orange rays add light, dashed rays are hidden. Then Russian roulette decides whether it \
              goes on. The table lists every decision and what it adds to the pixel.",
    scene: "cornell",
    program,
};

/// Upper left corners of the two views and the picture, and their side.
const LEFTS: [f64; 3] = [LEFT, 338.0, 656.0];
const TOP: f64 = 72.0;
const SIDE: f64 = 284.0;

/// A room with its path.
struct Shown {
    room: Description,
    scene: Scene,
    projection: Projection,
    path: Address,
    visits: Vec<Visit>,
    /// What the library's path tracer returns for this path.
    radiance: Rgb,
}

fn program(folder: &Folder<'_>) -> Result<()> {
    let shown = shown(folder)?;
    check(&shown)?;
    let picture = picture(&shown, folder)?;
    let drawing = figure(SLIDE.id, WIDTH, 552, &folder.caption(SLIDE.scene), |page| {
        title(page, SLIDE.topic)?;
        draw(page, &shown)?;
        table(page, &shown)
    })?;
    let place = [LEFTS[2] as u32, TOP as u32];
    folder.figure(SLIDE.id, &drawing.over(picture, place, folder.pick(2, 1))?)?;
    folder.text("one-path.csv", &csv(&shown.visits))?;
    Ok(())
}

/// The room, and the clearest of its paths.
fn shown(folder: &Folder<'_>) -> Result<Shown> {
    let pixels = folder.pick(2.0, 1.0) * SIDE;
    let size = load::Options { set: vec![format!("camera.size=[{pixels}, {pixels}]")], ..Default::default() };
    let room = load::scene(SLIDE.scene, &size)?.description;
    let scene = Scene::new(&room);
    let projection = Projection::new(&scene.camera, &room.camera);
    let t = SceneTransport::new(&scene);
    let key = Key::new(folder.seed, "one path");
    let found = choose::search(&t, &Roulette::LECTURE, key, &projection, [8, folder.pick(64, 64)]);
    let (path, visits) = found.ok_or("no path shows all decisions: try another seed")?;
    let tracer = PathTracer(Plan { max_bounces: 8, technique: Technique::Connect, roulette: Roulette::LECTURE });
    let eye =
        scene.camera.start(&t, path.pixel, &mut path.numbers(0, Purpose::Start)).ok_or("the pixel sees nothing")?;
    let (radiance, _) = tracer.radiance(&t, eye, path.key, path.pixel, path.sample);
    Ok(Shown { room, scene, projection, path, visits, radiance })
}

/// Sum of what the path adds to the pixel.
fn sum(visits: &[Visit]) -> Rgb {
    visits.iter().filter_map(|v| v.shadow.adds).map(|(adds, ..)| adds).sum()
}

/// Returns an error unless the drawing and the library agree about the path.
fn check(shown: &Shown) -> Result<()> {
    let (listed, expected) = (sum(&shown.visits), shown.radiance);
    if (listed - expected).abs().max_element() > 1e-6 * expected.max_element() {
        return Err(format!("the path adds {listed}, but the path tracer returns {expected}").into());
    }
    let [x, y] = shown.projection.at(shown.visits[0].at.p);
    let width = shown.scene.camera.size[0];
    let pixel = [shown.path.pixel % width, shown.path.pixel / width].map(f64::from);
    if (x - pixel[0] - 0.5).abs().max((y - pixel[1] - 0.5).abs()) > 0.51 {
        return Err(format!("the first vertex is drawn at {x}, {y}, outside its pixel {pixel:?}").into());
    }
    Ok(())
}

/// The rendered room.
fn picture(shown: &Shown, folder: &Folder<'_>) -> Result<Picture> {
    let t = SceneTransport::new(&shown.scene);
    let roulette = Roulette::Albedo { from: 2 };
    let prefix = Prefix(Plan { max_bounces: 1, technique: Technique::Mis, roulette });
    let amount = Amount { spp: folder.pick(24, 6), replicates: 1, key: Key::new(folder.seed, "picture") };
    let film = render(&t, &shown.scene.camera, &prefix, amount, folder.progress);
    let [all, emitted] = [0..3, 0..1].map(|slots| TermImage::of(&film, slots).mean);
    let [width, height] = shown.scene.camera.size.map(|n| n as usize);
    Ok(develop(width, height, &all, auto_gain_beside_lamps(&all, &emitted)).picture)
}

/// The two views and the path over the picture.
fn draw(page: &Canvas<'_>, shown: &Shown) -> Drawn {
    let origin = shown.scene.origin();
    let middle = |left: f64| (left + 0.5 * SIDE, TOP + 0.5 * SIDE);
    let scale = SIDE / 2.12;
    let views = [
        ("from above", View { right: DVec3::X, up: DVec3::NEG_Z, scale, origin: middle(LEFTS[0]) }),
        ("from the side", View { right: DVec3::NEG_Z, up: DVec3::Y, scale, origin: middle(LEFTS[1]) }),
    ];
    let first = shown.visits[0].at.p.as_dvec3();
    let eye = shown.scene.camera.origin;
    // the ray of the eye enters the drawing at the open front of the room
    let front = first + (eye - first) * ((1.06 - first.z) / (eye.z - first.z));
    for (name, view) in &views {
        let left = view.origin.0 - 0.5 * SIDE;
        heading(page, name, (left, TOP - 14.0))?;
        views::outline(page, &shown.room, origin, view)?;
        views::path(page, &shown.visits, Some(view.at(front)), &|p| view.at(p.as_dvec3()))?;
    }
    let (x, y) = views[0].1.at(front);
    let (side, align) = if x < views[0].1.origin.0 { (8.0, Align::Left) } else { (-8.0, Align::Right) };
    page.text("from the eye", (x + side, y - 16.0), Words { align, ..words(13.0, VERMILION) })?;
    legend(page)?;
    let lamp = views[1].1.at(DVec3::Y);
    page.text("lamp", (lamp.0 - 64.0, lamp.1 + 12.0), words(13.0, BLACK))?;
    heading(page, "in the picture", (LEFTS[2], TOP - 14.0))?;
    let per_pixel = SIDE / f64::from(shown.scene.camera.size[0]);
    let at = |p: Vec3| -> Place {
        let [x, y] = shown.projection.at(p);
        (LEFTS[2] + x * per_pixel, TOP + y * per_pixel)
    };
    views::path(page, &shown.visits, None, &at)
}

/// The three kinds of lines, beside the title.
fn legend(page: &Canvas<'_>) -> Drawn {
    let solid = |color, width| Stroke::solid(color, width);
    let dashed = Stroke { color: BLACK, width: 2.2, dash: Some((6.0, 4.0)) };
    let entries = [
        (400.0, solid(VERMILION, 3.0), "the path"),
        (520.0, solid(ORANGE, 2.2), "lamp point seen"),
        (706.0, dashed, "lamp point hidden"),
    ];
    for (x, stroke, text) in entries {
        page.line((x, 27.0), (x + 30.0, 27.0), stroke)?;
        page.text(text, (x + 37.0, 27.0), words(13.0, BLACK))?;
    }
    Ok(())
}

/// Right or left end of every column, and its title.
const COLUMNS: [(&str, f64, Align); 11] = [
    ("v", 36.0, Align::Right),
    ("α", 100.0, Align::Right),
    ("y is", 128.0, Align::Left),
    ("cos θ", 238.0, Align::Right),
    ("p, sr⁻¹", 316.0, Align::Right),
    ("adds", 396.0, Align::Right),
    ("q", 470.0, Align::Right),
    ("drawn", 548.0, Align::Right),
    ("the path", 580.0, Align::Left),
    ("cos θ", 764.0, Align::Right),
    ("p, sr⁻¹", 850.0, Align::Right),
];
/// Title, left and right end of every group of columns.
const GROUPS: [(&str, f64, f64, Colour); 4] = [
    ("throughput", LEFT, 100.0, GREY),
    ("connection to the lamp point y", 128.0, 396.0, ORANGE),
    ("Russian roulette", 440.0, 650.0, BLACK),
    ("next direction", 716.0, 850.0, VERMILION),
];

/// The decisions at every vertex, for the red channel, and the sum.
fn table(page: &Canvas<'_>, shown: &Shown) -> Drawn {
    let top = TOP + SIDE + 26.0;
    for (name, left, right, color) in GROUPS {
        page.text(name, (left, top), Words { bold: true, ..words(13.0, BLACK) })?;
        page.line((left, top + 11.0), (right, top + 11.0), Stroke::solid(color, 2.5))?;
    }
    let row = |cells: &[String], y: f64, color: Colour| {
        let places = COLUMNS.iter().zip(cells);
        places
            .into_iter()
            .try_for_each(|(&(_, x, align), cell)| maths(page, cell, (x, y), Words { align, ..words(13.5, color) }))
    };
    row(&COLUMNS.map(|(title, ..)| title.to_string()), top + 24.0, GREY)?;
    for (v, visit) in shown.visits.iter().enumerate() {
        row(&cells(v, visit), top + 46.0 + 21.0 * v as f64, BLACK)?;
    }
    let y = top + 50.0 + 21.0 * shown.visits.len() as f64;
    let [r, g, b] = sum(&shown.visits).to_array().map(|x| significant(f64::from(x), 4));
    page.line((LEFT, y - 10.0), (940.0, y - 10.0), Stroke::solid(GREY, 1.0))?;
    let text = format!(
        "Sum: red {r}, green {g}, blue {b}, as the path tracer of the library returns it. The table shows the red channel."
    );
    paragraph(page, &text, (LEFT, y + 6.0), 920.0, words(13.0, BLACK))?;
    Ok(())
}

/// One row of the table.
fn cells(v: usize, visit: &Visit) -> [String; 11] {
    let number = |x: f32| significant(f64::from(x), 3);
    let [seen, cos, pdf, adds] = match visit.shadow.adds {
        Some((adds, cos, pdf)) => ["seen".into(), number(cos), number(pdf), number(adds.x)],
        None => ["hidden".into(), "–".into(), "–".into(), "0".into()],
    };
    let (drawn, fate) = match visit.coin.drawn {
        None => ("–".into(), "goes on (q = 0)"),
        Some(u) if visit.coin.ends() => (number(u), "ends (drawn < q)"),
        Some(u) => (number(u), "goes on, α/(1 − q)"),
    };
    let [next_cos, next_pdf] = visit.direction.map_or(["–".into(), "–".into()], |(c, p)| [number(c), number(p)]);
    let (alpha, q) = (number(visit.throughput.x), number(visit.coin.q));
    [v.to_string(), alpha, seen, cos, pdf, adds, q, drawn, fate.into(), next_cos, next_pdf]
}

/// All numbers, in all channels.
fn csv(visits: &[Visit]) -> String {
    let of = |name: &str| CHANNELS.map(|c| format!("{name}_{c}")).join(",");
    let mut csv = Csv::new(&format!(
        "vertex,x,y,z,{},seen,connection_cos,connection_density,{},q,drawn,direction_cos,direction_density",
        of("throughput"),
        of("adds")
    ));
    let wide = |v: Vec3| v.as_dvec3().to_array();
    for (v, visit) in visits.iter().enumerate() {
        let (adds, cos, pdf) = visit.shadow.adds.unwrap_or((Rgb::ZERO, f32::NAN, f32::NAN));
        csv.put(v).numbers(wide(visit.at.p)).numbers(wide(visit.throughput)).put(visit.shadow.adds.is_some());
        csv.numbers([cos, pdf].map(f64::from)).numbers(wide(adds));
        let (next_cos, next_pdf) = visit.direction.unwrap_or((f32::NAN, f32::NAN));
        let rest = [visit.coin.q, visit.coin.drawn.unwrap_or(f32::NAN), next_cos, next_pdf];
        csv.numbers(rest.map(f64::from)).end();
    }
    csv.text()
}
