//! `fredholm info [SCENE]`: what a scene holds, and what is known about ‖T‖ before anything is rendered.

use super::base::{Ending, Failure, print};
use super::options::{Changes, Manner, OUTPUT, WHAT};
use super::session::Session;
use super::{notes, open};
use clap::Args;
use fredholm::engine::by_matrix;
use fredholm::engine::known::coplanar;
use fredholm::report::text::table;
use fredholm::scene::coplanar::{Kind, Relation};
use fredholm::scene::description::{Description, Geometry, LightDescription, Sides, Sky};
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

/// Prints what is known, or lists the built-in scenes.
pub fn run(args: &Info) -> Result<Ending, Failure> {
    let Some(name) = &args.scene else {
        let lines: Vec<String> = builtin::ALL.iter().map(|s| format!("{:15} {}", s.name, s.summary)).collect();
        print(&lines.join("\n"))?;
        return Ok(Ending::Ok);
    };
    let session = Session::new(Manner { json: args.json, ..Manner::default() }, 0)?;
    let (d, _) = open::description(name, &args.changes, None)?;
    let scene = Scene::new(&d);
    open::coplanar(&scene);
    session.show(&machine(&d, &scene), || people(&d, &scene))?;
    Ok(Ending::Ok)
}

fn machine(d: &Description, scene: &Scene) -> serde_json::Value {
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
        "coplanar": coincident(d, scene).iter().map(|(r, meaning)| json!({
            "shapes": r.shapes, "names": r.names, "meaning": meaning,
        })).collect::<Vec<_>>(),
    })
}

fn people(d: &Description, scene: &Scene) -> String {
    let rgb = |v: glam::DVec3| format!("({:.4}, {:.4}, {:.4})", v.x, v.y, v.z);
    let mut out = format!(
        "{}: {}, {}, {}×{} pixels\n",
        d.name,
        counted(d.shapes.len(), "shape"),
        counted(scene.sides() as usize / 2, "primitive"),
        d.camera.size[0],
        d.camera.size[1]
    );
    out += "\nmaterials\n";
    for m in &d.materials {
        let sides = if m.sides == Sides::Both { "both sides" } else { "front only" };
        let what = m.bsdf.words();
        out += &format!("  {:16} {what}, {sides}\n", m.name);
    }
    out += "\nlights\n";
    for s in d.shapes.iter().filter(|s| s.emission.max_element() > 0.0) {
        let area: f64 = s.geometry.primitives().iter().map(fredholm::scene::Primitive::area).sum();
        let power = s.emission * area * std::f64::consts::PI;
        out += &format!(
            "  {:16} {}, radiance {}\n                   area {area:.4} m², power {} W\n",
            s.name,
            kind(&s.geometry),
            rgb(s.emission),
            rgb(power)
        );
    }
    d.lights.iter().for_each(|l| out += &format!("  {}\n", light(l)));
    out += &operator(d, scene);
    out += &overlaps(d, scene);
    if let Some(e) = &d.expect {
        let terms: Vec<String> = e.terms.iter().map(|&t| table::significant(t, 5)).collect();
        out += &format!("\nexpected image means, k = 0 to {}\n", terms.len().saturating_sub(1));
        out += &format!("  {}\n  source: {}\n", terms.join(", "), e.source);
    }
    out
}

/// What is known about T before anything is rendered.
fn operator(d: &Description, scene: &Scene) -> String {
    let rho = scene.max_albedo();
    let mut out = format!("\noperator\n  surfaces that reflect or emit: {:.4} m²\n", SurfaceSensor::new(scene).area);
    out += &format!(
        "  ‖T‖ ≤ max albedo = ({:.4}, {:.4}, {:.4}), in every Lp norm of the throughput measure\n",
        rho.x, rho.y, rho.z
    );
    if scene.any_delta_surface() {
        out += "  mirrors or glass: T is not compact, and no connection finds what they show\n";
    }
    if d.materials.iter().any(|m| m.bsdf.lets_through()) {
        out += "  glass: the norm is that of L/η²; for radiance itself, squeezed by η², ‖T‖∞ can exceed 1\n";
    }
    if scene.has_environment() {
        out += "  T is not closed: a ray that leaves the scene meets the sky, and the light it brings is E\n";
    }
    if let Some(matrix) = by_matrix::coarse(d, scene)
        && let Some(what) = notes::unlit(&matrix.unlit, d)
    {
        let radius = matrix.spectral.each_ref().map(|s| format!("{:.3}", s.radius)).join(", ");
        out += &format!(
            "  {what};\n  r(T) of what light reaches, on {} patches: ({radius})\n",
            matrix.radiosity.patches.len()
        );
    }
    let g = f64::from(rho.max_element());
    if scene.has_environment() || scene.lights.any_delta() {
        out += "  E is not all on surfaces: bounds of ‖L − S_K‖₁ start from ‖T E‖₁, and need ‖T‖₁ < 1\n";
    } else if g < 1.0 {
        let bounces = (0.01f64 * (1.0 - g)).ln() / g.ln() - 1.0;
        out += &format!(
            "  guaranteed: ‖L − S_K‖₁ ≤ {g:.4}^(K+1)/{:.4} · ‖E‖₁; below 1 % of ‖E‖₁ from K = {:.0}\n",
            1.0 - g,
            bounces.max(0.0).ceil()
        );
    } else {
        out += "  no guaranteed bound: a surface reflects everything\n";
    }
    out
}

/// Pairs of shapes that lie in one surface and overlap, the most troublesome first, and what that means.
fn coincident(d: &Description, scene: &Scene) -> Vec<(Relation, &'static str)> {
    let mut all = d.centred().scene.surfaces().relations(d);
    all.sort_by_key(|r| std::cmp::Reverse(r.kind));
    let seen: Vec<[usize; 2]> = coplanar::seen(scene).iter().map(|r| r.shapes).collect();
    let meaning = |r: &Relation| match r.kind {
        Kind::Alike => "alike; the same in images, counted twice in areas",
        Kind::InFront => "what emits lies in front",
        Kind::Differ if seen.contains(&r.shapes) => "they differ, and nothing says which is seen",
        Kind::Differ => "they touch out of sight",
    };
    let with_meaning = |r: Relation| {
        let meaning = meaning(&r);
        (r, meaning)
    };
    all.into_iter().map(with_meaning).collect()
}

fn overlaps(d: &Description, scene: &Scene) -> String {
    const SHOWN: usize = 6;
    let all = coincident(d, scene);
    if all.is_empty() {
        return String::new();
    }
    let mut out = format!("\ncoplanar overlaps: {}\n", all.len());
    for (r, meaning) in all.iter().take(SHOWN) {
        out += &format!("  {} and {}: {meaning}\n", r.names[0], r.names[1]);
    }
    if all.len() > SHOWN {
        out += &format!("  … and {} more pairs of shapes\n", all.len() - SHOWN);
    }
    out
}

/// A light without a surface in words.
fn light(light: &LightDescription) -> String {
    let rgb = |v: &glam::DVec3| format!("({:.3}, {:.3}, {:.3})", v.x, v.y, v.z);
    match light {
        LightDescription::Point { position, intensity } => {
            format!("point at {}, intensity {} W/sr", rgb(position), rgb(intensity))
        }
        LightDescription::Directional { direction, irradiance } => {
            format!("directional along {}, irradiance {} W/m²", rgb(direction), rgb(irradiance))
        }
        LightDescription::Environment { sky, rotate, scale } => match sky {
            Sky::Constant(radiance) => format!("environment, radiance {}", rgb(&(*radiance * *scale))),
            Sky::LatLong(image) | Sky::MirrorBall(image) => {
                let what = if matches!(sky, Sky::LatLong(_)) { "latitude–longitude" } else { "mirror ball" };
                let [w, h] = image.size;
                format!("environment, {what} image {w}×{h}, rotated {rotate}°, times {scale}")
            }
        },
    }
}

fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
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
