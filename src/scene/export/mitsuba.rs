//! Scenes for Mitsuba 3.
//!
//! | here | there |
//! |---|---|
//! | parallelogram with right angles | `rectangle` with the matrix (edge_u/2, edge_v/2, n, centre) |
//! | box, other parallelograms, meshes | triangles in an OBJ file |
//! | sphere, disk | `sphere`, `disk` |
//! | both sides reflect | `twosided` |
//! | diffuse, mirror, conductor, dielectric, plastic | `diffuse`, `conductor`, `roughconductor`, `dielectric`, `plastic`, … |
//! | at most K reflections | `max_depth` = K + 1 |
//!
//! Reference: Jakob et al., *Mitsuba 3* (2022), documentation of its plugins.

use super::{Exported, Settings, Unsupported, alpha, named, triangles, uniform, words};
use crate::scene::description::{
    BsdfDescription, Choice, ConductorSurface, Description, DielectricSurface, DiffuseSurface, Geometry, Ggx,
    LightDescription, Masking, Material, Metal, MirrorSurface, PlasticSurface, Shape, Sky,
};
use glam::DVec3;
use std::fmt::Write;

/// Writes a scene for Mitsuba 3.
///
/// # Errors
/// If a part of the scene has no counterpart.
pub fn export(d: &Description, settings: &Settings) -> Result<Exported, Unsupported> {
    let (mut text, mut beside) = (head(d, settings), vec![]);
    let used = |m: &&Material| d.shapes.iter().any(|s| d.materials[s.material].name == m.name);
    for material in d.materials.iter().filter(used) {
        writeln!(text, "\n{}", surface(material)?).ok();
    }
    for (i, shape) in d.shapes.iter().enumerate() {
        writeln!(text, "\n{}", self::shape(i, shape, d, settings, &mut beside)?).ok();
    }
    for (i, light) in d.lights.iter().enumerate() {
        writeln!(text, "\n{}", emitter(i, light)?).ok();
    }
    text += "</scene>\n";
    let rough_plastic = |m: &&Material| matches!(&m.bsdf, BsdfDescription::Plastic(p) if p.rough.is_some());
    let note = |m: &Material| {
        format!("the rough plastic of Mitsuba, material `{}`, differs by about 1 %: its coat is tabulated", m.name)
    };
    Ok(Exported { text, beside, notes: d.materials.iter().filter(used).filter(rough_plastic).map(note).collect() })
}

fn head(d: &Description, settings: &Settings) -> String {
    let c = &d.camera;
    let list = |v: DVec3| format!("{}, {}, {}", v.x, v.y, v.z);
    let (depth, roulette) = settings.max_bounces.map_or((-1, 5), |k| (k as i64 + 1, 1_000_000));
    format!(
        r#"<?xml version="1.0" encoding="utf-8"?>
<!-- {name}, exported by fredholm {version} for Mitsuba 3 -->
<scene version="3.0.0">
    <integrator type="path">
        <integer name="max_depth" value="{depth}"/>
        <integer name="rr_depth" value="{roulette}"/>
    </integrator>

    <sensor type="perspective">
        <float name="fov" value="{fov}"/>
        <string name="fov_axis" value="x"/>
        <transform name="to_world">
            <lookat origin="{origin}" target="{target}" up="{up}"/>
        </transform>
        <sampler type="independent">
            <integer name="sample_count" value="{spp}"/>
        </sampler>
        <film type="hdrfilm">
            <integer name="width" value="{width}"/>
            <integer name="height" value="{height}"/>
            <string name="pixel_format" value="rgb"/>
            <string name="component_format" value="float32"/>
            <rfilter type="box"/>
        </film>
    </sensor>
"#,
        name = escaped(&d.name),
        version = env!("CARGO_PKG_VERSION"),
        fov = c.fov,
        origin = list(c.origin),
        target = list(c.target),
        up = list(c.up),
        spp = settings.spp,
        width = c.size[0],
        height = c.size[1],
    )
}

fn rgb(name: &str, value: DVec3) -> String {
    format!(r#"<rgb name="{name}" value="{} {} {}"/>"#, value.x, value.y, value.z)
}

fn float(name: &str, value: f64) -> String {
    format!(r#"<float name="{name}" value="{value}"/>"#)
}

fn facets(rough: Option<&Ggx>, material: &Material) -> Result<Vec<String>, Unsupported> {
    let Some(rough) = rough else { return Ok(vec![]) };
    let alpha = alpha(rough, Masking::Separable, material)?;
    Ok(vec![r#"<string name="distribution" value="ggx"/>"#.into(), float("alpha", alpha)])
}

/// A `<bsdf>` with its id.
fn surface(material: &Material) -> Result<String, Unsupported> {
    let kind =
        |smooth: &str, rough: Option<&Ggx>| if rough.is_some() { format!("rough{smooth}") } else { smooth.to_owned() };
    let (kind, mut lines) = match &material.bsdf {
        BsdfDescription::Diffuse(DiffuseSurface { reflectance }) => {
            ("diffuse".into(), vec![rgb("reflectance", uniform(reflectance, material)?)])
        }
        BsdfDescription::Mirror(MirrorSurface { reflectance }) => (
            "conductor".into(),
            vec![r#"<string name="material" value="none"/>"#.into(), rgb("specular_reflectance", *reflectance)],
        ),
        BsdfDescription::Conductor(ConductorSurface { metal, rough }) => {
            let lines = match metal {
                Metal::Fresnel { eta, k } => vec![rgb("eta", *eta), rgb("k", *k)],
                Metal::Reflectance(f) => {
                    vec![r#"<string name="material" value="none"/>"#.into(), rgb("specular_reflectance", *f)]
                }
            };
            (kind("conductor", rough.as_ref()), [lines, facets(rough.as_ref(), material)?].concat())
        }
        BsdfDescription::Dielectric(DielectricSurface {
            ior,
            ior_outside,
            rough,
            choice: Choice::Fresnel | Choice::Constant(_),
        }) => {
            let lines = vec![float("int_ior", *ior), float("ext_ior", *ior_outside)];
            (kind("dielectric", rough.as_ref()), [lines, facets(rough.as_ref(), material)?].concat())
        }
        BsdfDescription::Plastic(PlasticSurface { reflectance, ior, rough }) => {
            let lines = vec![
                rgb("diffuse_reflectance", uniform(reflectance, material)?),
                float("int_ior", *ior),
                float("ext_ior", 1.0),
                r#"<boolean name="nonlinear" value="true"/>"#.into(),
            ];
            (kind("plastic", rough.as_ref()), [lines, facets(rough.as_ref(), material)?].concat())
        }
        BsdfDescription::Phong(_) => {
            return Err(Unsupported::new(
                format!("the Phong lobe of material `{}`: Mitsuba 3 has none", material.name),
                "give it another kind: --set materials.NAME.type=\"diffuse\"",
            ));
        }
    };
    let id = format!(r#" id="{}""#, escaped(&material.name));
    let two = material.both_sides() && !material.bsdf.lets_through();
    let inner = if two { "" } else { &id };
    lines = lines.into_iter().map(|l| format!("        {l}")).collect();
    let bsdf = format!("<bsdf type=\"{kind}\"{inner}>\n{}\n    </bsdf>", lines.join("\n"));
    Ok(if two { format!("    <bsdf type=\"twosided\"{id}>{bsdf}</bsdf>") } else { format!("    {bsdf}") })
}

/// A `<shape>` with its material and emission.
fn shape(
    i: usize,
    shape: &Shape,
    d: &Description,
    settings: &Settings,
    beside: &mut Vec<(String, String)>,
) -> Result<String, Unsupported> {
    let flip = r#"<boolean name="flip_normals" value="true"/>"#;
    let (kind, mut lines) = match &shape.geometry {
        Geometry::Quad { origin, edge_u, edge_v }
            if edge_u.dot(*edge_v).abs() <= 1e-9 * edge_u.length() * edge_v.length() =>
        {
            let (u, v) = (0.5 * *edge_u, 0.5 * *edge_v);
            ("rectangle", vec![matrix([u, v, edge_u.cross(*edge_v).normalize()], *origin + u + v)])
        }
        Geometry::Sphere { center, radius, z, inward } => {
            if *z != [-1.0, 1.0] {
                return Err(Unsupported::new(
                    format!("the band of {}: Mitsuba has whole spheres only", named(i, shape)),
                    "export it for pbrt",
                ));
            }
            let [x, y, z] = center.to_array();
            let mut lines =
                vec![format!(r#"<point name="center" x="{x}" y="{y}" z="{z}"/>"#), float("radius", *radius)];
            lines.extend(inward.then(|| flip.to_owned()));
            ("sphere", lines)
        }
        Geometry::Disk { center, normal, radius } => {
            let n = normal.normalize();
            let (a, b) = n.any_orthonormal_pair();
            let (a, b) = if a.cross(b).dot(n) > 0.0 { (a, b) } else { (b, a) };
            ("disk", vec![matrix([*radius * a, *radius * b, n], *center)])
        }
        geometry => {
            let Some((vertices, faces)) = triangles(geometry) else { unreachable!("curved shapes come before") };
            let name = format!("{}-{i}.obj", settings.stem);
            beside.push((name.clone(), obj(&vertices, &faces)));
            let name = escaped(&name);
            (
                "obj",
                vec![
                    format!(r#"<string name="filename" value="{name}"/>"#),
                    r#"<boolean name="face_normals" value="true"/>"#.into(),
                ],
            )
        }
    };
    lines.push(format!(r#"<ref id="{}"/>"#, escaped(&d.materials[shape.material].name)));
    if shape.emission != DVec3::ZERO {
        lines.push(format!(r#"<emitter type="area">{}</emitter>"#, rgb("radiance", shape.emission)));
    }
    let lines: Vec<String> = lines.into_iter().map(|l| format!("        {l}")).collect();
    Ok(format!(
        "    <!-- {i}, {} -->\n    <shape type=\"{kind}\">\n{}\n    </shape>",
        escaped(&shape.name),
        lines.join("\n")
    ))
}

/// A transform with three columns and a translation.
fn matrix([x, y, z]: [DVec3; 3], at: DVec3) -> String {
    let row = |i: usize| format!("{} {} {} {}", x[i], y[i], z[i], at[i]);
    format!(r#"<transform name="to_world"><matrix value="{} {} {} 0 0 0 1"/></transform>"#, row(0), row(1), row(2))
}

fn obj(vertices: &[DVec3], faces: &[[u32; 3]]) -> String {
    let mut text = String::new();
    vertices.iter().for_each(|v| writeln!(text, "v {}", words(*v)).unwrap_or_default());
    faces.iter().for_each(|f| writeln!(text, "f {} {} {}", f[0] + 1, f[1] + 1, f[2] + 1).unwrap_or_default());
    text
}

/// A light without a surface.
fn emitter(i: usize, light: &LightDescription) -> Result<String, Unsupported> {
    let point = |name: &str, p: DVec3| format!(r#"<point name="{name}" x="{}" y="{}" z="{}"/>"#, p.x, p.y, p.z);
    let vector = |name: &str, p: DVec3| format!(r#"<vector name="{name}" x="{}" y="{}" z="{}"/>"#, p.x, p.y, p.z);
    let (kind, lines) = match light {
        LightDescription::Point { position, intensity } => {
            ("point", vec![point("position", *position), rgb("intensity", *intensity)])
        }
        LightDescription::Directional { direction, irradiance } => {
            ("directional", vec![vector("direction", *direction), rgb("irradiance", *irradiance)])
        }
        LightDescription::Environment { sky: Sky::Constant(radiance), scale, .. } => {
            ("constant", vec![rgb("radiance", *radiance * *scale)])
        }
        LightDescription::Environment { .. } => {
            return Err(Unsupported::new(
                format!("the sky of light {i}: skies from images are not exported"),
                "give it one colour, and remove the image",
            ));
        }
    };
    let lines: Vec<String> = lines.into_iter().map(|l| format!("        {l}")).collect();
    Ok(format!("    <emitter type=\"{kind}\">\n{}\n    </emitter>", lines.join("\n")))
}

/// Text inside an attribute or a comment of XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace("--", "- -")
}
