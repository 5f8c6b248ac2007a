//! `fredholm info [SCENE]`: materials and lights of a scene, and the bounds on ‖T‖ that hold before anything is rendered.

use super::base::{Ending, Failure, paragraphs, print};
use super::options::{Changes, Manner, OUTPUT, WHAT};
use super::session::Session;
use super::{notes, open};
use clap::Args;
use fredholm::engine::by_matrix;
use fredholm::engine::known::coplanar;
use fredholm::report::text::prose::{counted, listed, wrapped, wrapped_after};
use fredholm::report::text::table;
use fredholm::scene::coplanar::{Kind, Relation};
use fredholm::scene::description::{Description, Geometry, LightDescription, Shape, Sides, Sky};
use fredholm::scene::{Scene, SurfaceSensor, builtin};
use serde_json::json;

/// Below `info --help`.
pub const HELP: &str = "Examples:
  fredholm info
  fredholm info cornell
  fredholm info box.toml

Without SCENE, the built-in scenes are listed. With a file, errors in the file are reported.";

/// Arguments of `info`.
#[derive(Clone, Debug, Args)]
pub struct Info {
    /// Built-in scene, .toml or .obj
    #[arg(help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    pub scene: Option<String>,
    /// Changes to the scene.
    #[command(flatten)]
    pub changes: Changes,
    /// Print JSON instead of text
    #[arg(long, help_heading = OUTPUT)]
    pub json: bool,
}

/// Describes a scene, or lists the built-in ones.
pub fn run(args: &Info) -> Result<Ending, Failure> {
    let Some(name) = &args.scene else {
        let lines: Vec<String> = builtin::ALL.iter().map(|s| format!("{:15} {}", s.name, s.summary)).collect();
        let answer = wrapped(&format!(
            "{} scenes are built in; a command takes one of these names, or the path of a .toml or .obj file.\n\
             `fredholm info NAME` describes a scene.",
            builtin::ALL.len()
        ));
        print(&paragraphs(&[answer, lines.join("\n")]))?;
        return Ok(Ending::Ok);
    };
    let session = Session::new(Manner { json: args.json, ..Manner::default() }, 0)?;
    let (d, _) = open::description(name, &args.changes, None)?;
    let scene = Scene::new(&d);
    open::coplanar(&scene);
    session.show(&machine(&d, &scene), || people(&d, &scene))?;
    Ok(Ending::Ok)
}

/// The description as JSON.
fn machine(d: &Description, scene: &Scene) -> serde_json::Value {
    let lamp = |l: &Lamp| {
        json!({
            "name": l.name, "shape": l.kind, "area": l.area, "radiance": l.radiance.to_array(),
            "power": l.power().to_array(),
        })
    };
    json!({
        "name": d.name,
        "size": d.camera.size,
        "materials": d.materials.iter().map(|m| json!({
            "name": m.name, "type": m.bsdf.kind(), "reflectance": m.lambertian().map(|r| r.to_array()),
            "sides": if m.sides == Sides::Both { "both" } else { "front" },
        })).collect::<Vec<_>>(),
        "shapes": d.shapes.len(),
        "primitives": scene.sides() / 2,
        "lights": scene.lights.len(),
        "area": SurfaceSensor::new(scene).area,
        "max_albedo": scene.max_albedo().to_array(),
        "emissive_shapes": lamps(d).iter().map(lamp).collect::<Vec<_>>(),
        "guaranteed_bounces_below_1_percent": guaranteed(scene),
        "coplanar": coincident(d, scene).iter().map(|(r, meaning)| json!({
            "shapes": r.shapes, "names": r.names, "meaning": meaning,
        })).collect::<Vec<_>>(),
    })
}

/// A shape that emits light.
struct Lamp<'a> {
    name: &'a str,
    kind: &'static str,
    /// In m².
    area: f64,
    /// In W sr⁻¹ m⁻².
    radiance: glam::DVec3,
}

impl<'a> Lamp<'a> {
    fn of(shape: &'a Shape) -> Self {
        Self {
            name: &shape.name,
            kind: kind(&shape.geometry),
            area: shape.geometry.primitives().iter().map(fredholm::scene::Primitive::area).sum(),
            radiance: shape.emission,
        }
    }

    /// In W.
    fn power(&self) -> glam::DVec3 {
        self.radiance * self.area * std::f64::consts::PI
    }
}

/// The shapes that emit light.
fn lamps(d: &Description) -> Vec<Lamp<'_>> {
    d.shapes.iter().filter(|s| s.emission.max_element() > 0.0).map(Lamp::of).collect()
}

/// K from which ‖L − S_K‖₁ is guaranteed to be below 1 % of ‖E‖₁; `None` where no K is.
fn guaranteed(scene: &Scene) -> Option<usize> {
    let g = f64::from(scene.max_albedo().max_element());
    let bounces = (0.01f64 * (1.0 - g)).ln() / g.ln() - 1.0;
    (g < 1.0 && !scene.has_environment() && !scene.lights.any_delta()).then(|| bounces.max(0.0).ceil() as usize)
}

/// Lines of a list that are printed at most; `--json` has all.
const SHOWN: usize = 6;

/// The first lines of a list, and how many are left out.
fn some(lines: Vec<String>) -> String {
    let left = lines.len().saturating_sub(SHOWN);
    let more = (left > 0).then(|| format!("  … and {left} more"));
    lines.into_iter().take(SHOWN).chain(more).collect::<Vec<_>>().join("\n")
}

/// The description for people.
fn people(d: &Description, scene: &Scene) -> String {
    let materials = d.materials.iter().map(|m| {
        let sides = if m.sides == Sides::Both { "both sides" } else { "front only" };
        // blanks that wrapping keeps
        let text = format!("\u{a0}\u{a0}{:\u{a0}<16} {}, {sides}", m.name, m.bsdf.words());
        wrapped_after(&text, &" ".repeat(19))
    });
    let lamp = |l: Lamp<'_>| {
        format!(
            "  {:16} {:7} {:>10} m²   {:24} {}",
            l.name,
            l.kind,
            table::significant(l.area, 4),
            rgb(l.radiance),
            rgb(l.power())
        )
    };
    let lamps: Vec<String> = lamps(d).into_iter().map(lamp).collect();
    let head = if lamps.is_empty() {
        "The lights."
    } else {
        "The lights: shape, area, radiance in W sr⁻¹ m⁻² (red, green, blue), power in W."
    };
    let lights: Vec<String> = lamps.into_iter().chain(d.lights.iter().map(|l| format!("  {}", light(l)))).collect();
    let mut blocks = vec![
        answer(d, scene),
        format!("The materials, and the sides of a surface that they are on.\n{}", some(materials.collect())),
        if lights.is_empty() { "The scene has no lights.".into() } else { format!("{head}\n{}", some(lights)) },
        operator(d, scene),
        overlaps(d, scene),
    ];
    if let Some(e) = &d.expect {
        let terms: Vec<String> = e.terms.iter().map(|&t| table::significant(t, 5)).collect();
        blocks.push(format!(
            "Expected image means of the terms, k = 0 to {}, from theory.\n{}\n{}",
            terms.len().saturating_sub(1),
            wrapped_after(&format!("\u{a0}\u{a0}{}", terms.join(", ")), "  "),
            wrapped_after(&format!("\u{a0}\u{a0}source: {}", e.source), "  ")
        ));
    }
    paragraphs(&blocks)
}

/// Red, green and blue with four digits; one number if they are equal.
fn rgb(v: glam::DVec3) -> String {
    let words = v.to_array().map(|x| table::significant(x, 4));
    if words[0] == words[1] && words[1] == words[2] { words[0].clone() } else { format!("({})", words.join(", ")) }
}

/// The answer: what the scene holds, and how many bounces are guaranteed to be enough.
fn answer(d: &Description, scene: &Scene) -> String {
    let mut kinds: Vec<&str> = vec![];
    for m in &d.materials {
        if !kinds.contains(&m.bsdf.kind()) {
            kinds.push(m.bsdf.kind());
        }
    }
    let g = scene.max_albedo().max_element();
    let lights = lamps(d).len() + d.lights.len();
    let holds = format!(
        "{}: {}, {}, {}, {}×{} pixels",
        d.name,
        counted(scene.sides() as usize / 2, "primitive"),
        counted(lights, "light"),
        if kinds.is_empty() { "no materials".into() } else { format!("{} surfaces", listed(&kinds)) },
        d.camera.size[0],
        d.camera.size[1]
    );
    let measure = format!("`fredholm series {}` measures how fast the terms decay.", d.name);
    wrapped(&match guaranteed(scene) {
        Some(bounces) => format!(
            "{holds}; ‖T‖₁ ≤ {g:.4}, so {} enough: all longer paths together are below 1 % of ‖E‖₁.\n\
             This is the guaranteed bound; usually far fewer bounces are enough. {measure}",
            if bounces == 1 { "1 bounce is".into() } else { format!("{bounces} bounces are") }
        ),
        None if g < 1.0 => format!(
            "{holds}; ‖T‖₁ ≤ {g:.4}, so the series converges.\n\
             No number of bounces is guaranteed in units of ‖E‖₁, because E is not only on surfaces: bounds of ‖L − S_K‖₁ \
             start from ‖T E‖₁. {measure}"
        ),
        None => format!(
            "{holds}; no number of bounces is guaranteed to be enough, because a surface reflects everything.\n{measure}"
        ),
    })
}

/// Facts about T that are known before anything is rendered.
fn operator(d: &Description, scene: &Scene) -> String {
    let rho = scene.max_albedo();
    let mut lines = vec![
        format!("surfaces that reflect or emit: {:.4} m²", SurfaceSensor::new(scene).area),
        format!("‖T‖ ≤ largest albedo = {}, in every Lp norm of the throughput measure", rgb(rho.as_dvec3())),
    ];
    if scene.any_delta_surface() {
        lines.push(
            "mirrors or glass: T is not compact, and no connection finds the light they reflect or transmit".into(),
        );
    }
    if d.materials.iter().any(|m| m.bsdf.lets_through()) {
        lines.push(
            "glass: the norm is that of L/η²; for radiance itself, which glass scales by η², ‖T‖∞ can exceed 1".into(),
        );
    }
    if scene.has_environment() {
        lines.push("a ray that leaves the scene meets the sky, and its light belongs to E".into());
    }
    if let Some(matrix) = by_matrix::coarse(d, scene)
        && let Some(what) = notes::unlit(&matrix.unlit, d)
    {
        let radius = matrix.spectral.each_ref().map(|s| format!("{:.3}", s.radius)).join(", ");
        lines.push(format!("{what}; r(T) of the lit part, on {} patches: ({radius})", matrix.radiosity.patches.len()));
    }
    if guaranteed(scene).is_some() {
        let g = rho.max_element();
        lines.push(format!("guaranteed: ‖L − S_K‖₁ ≤ {g:.4}^(K+1)/{:.4} · ‖E‖₁", 1.0 - g));
    }
    let lines: Vec<String> = lines.iter().map(|l| wrapped_after(&format!("\u{a0}\u{a0}{l}"), "    ")).collect();
    format!("The operator T, before anything is rendered.\n{}", lines.join("\n"))
}

/// Pairs of shapes that lie in one surface and overlap, those that make the scene undecided first, each with its meaning.
fn coincident(d: &Description, scene: &Scene) -> Vec<(Relation, &'static str)> {
    let mut all = d.centred().scene.surfaces().relations(d);
    all.sort_by_key(|r| std::cmp::Reverse(r.kind));
    let seen: Vec<[usize; 2]> = coplanar::seen(scene).iter().map(|r| r.shapes).collect();
    let meaning = |r: &Relation| match r.kind {
        Kind::Alike => "alike; the same in images, counted twice in areas",
        Kind::InFront => "what emits lies in front",
        Kind::Differ if seen.contains(&r.shapes) => "they differ, so the renderer cannot decide which one is visible",
        Kind::Differ => "they touch out of sight",
    };
    let with_meaning = |r: Relation| {
        let meaning = meaning(&r);
        (r, meaning)
    };
    all.into_iter().map(with_meaning).collect()
}

/// The pairs of [`coincident`] shapes as a list.
fn overlaps(d: &Description, scene: &Scene) -> String {
    let all = coincident(d, scene);
    if all.is_empty() {
        return String::new();
    }
    let lines = all.iter().map(|(r, meaning)| format!("  {} and {}: {meaning}", r.names[0], r.names[1]));
    format!("Shapes that lie in one surface and overlap; coplanar overlaps: {}.\n{}", all.len(), some(lines.collect()))
}

/// A light that is no shape, in words.
fn light(light: &LightDescription) -> String {
    let xyz = |v: &glam::DVec3| format!("({:.3}, {:.3}, {:.3})", v.x, v.y, v.z);
    match light {
        LightDescription::Point { position, intensity } => {
            format!("point at {}, intensity {} W/sr", xyz(position), rgb(*intensity))
        }
        LightDescription::Directional { direction, irradiance } => {
            format!("directional along {}, irradiance {} W/m²", xyz(direction), rgb(*irradiance))
        }
        LightDescription::Environment { sky, rotate, scale } => match sky {
            Sky::Constant(radiance) => format!("environment, radiance {}", rgb(*radiance * *scale)),
            Sky::LatLong(image) | Sky::MirrorBall(image) => {
                let what = if matches!(sky, Sky::LatLong(_)) { "latitude–longitude" } else { "mirror ball" };
                let [w, h] = image.size;
                format!("environment, {what} image {w}×{h}, rotated {rotate}°, times {scale}")
            }
        },
    }
}

fn kind(g: &Geometry) -> &'static str {
    match g {
        Geometry::Mesh { .. } => "mesh",
        Geometry::Quad { .. } => "quad",
        Geometry::Box { .. } => "box",
        Geometry::Sphere { .. } => "sphere",
        Geometry::Disk { .. } => "disk",
    }
}
