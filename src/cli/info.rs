//! `fredholm info [SCENE]`: what a scene holds, and what is known about ‖T‖ before anything is rendered.

use super::{Ending, Failure, args};
use fredholm::report::table;
use fredholm::scene::description::{Description, Geometry, Sides};
use fredholm::scene::{Scene, SurfaceSensor, builtin, load};
use serde_json::json;

/// Prints what is known, or lists the built-in scenes.
pub fn run(args: &args::Info) -> Result<Ending, Failure> {
    let Some(name) = &args.scene else {
        let lines: Vec<String> = builtin::ALL.iter().map(|s| format!("{:15} {}", s.name, s.summary)).collect();
        super::say(&lines.join("\n"))?;
        return Ok(Ending::Ok);
    };
    let loaded = load::scene(name, &load::Options { set: args.set.clone(), emit: args.emit.clone() })?;
    for warning in &loaded.warnings {
        super::note(&format!("warning: {warning}"));
    }
    let d = &loaded.description;
    let scene = Scene::new(d);
    if args.json {
        super::say(&serde_json::to_string_pretty(&machine(d, &scene))?)?;
    } else {
        super::say(&people(d, &scene))?;
    }
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
        let what = match m.lambertian() {
            Some(rho) => format!("diffuse, reflectance {}", rgb(rho)),
            None => m.bsdf.kind().to_owned(),
        };
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
    let rho = scene.max_albedo();
    out += &format!("\noperator\n  surfaces that reflect or emit: {:.4} m²\n", SurfaceSensor::new(scene).area);
    out += &format!(
        "  ‖T‖ ≤ max albedo = ({:.4}, {:.4}, {:.4}), in every Lp norm of the throughput measure\n",
        rho.x, rho.y, rho.z
    );
    let g = f64::from(rho.max_element());
    if g < 1.0 {
        let bounces = (0.01f64 * (1.0 - g)).ln() / g.ln() - 1.0;
        out += &format!(
            "  guaranteed: ‖L − S_K‖₁ ≤ {g:.4}^(K+1)/{:.4} · ‖E‖₁; below 1 % of ‖E‖₁ from K = {:.0}\n",
            1.0 - g,
            bounces.max(0.0).ceil()
        );
    } else {
        out += "  no guaranteed bound: a surface reflects everything\n";
    }
    if let Some(e) = &d.expect {
        let terms: Vec<String> = e.terms.iter().map(|&t| table::significant(t, 5)).collect();
        out += &format!("\nexpected image means, k = 0 to {}\n", terms.len().saturating_sub(1));
        out += &format!("  {}\n  source: {}\n", terms.join(", "), e.source);
    }
    out
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
