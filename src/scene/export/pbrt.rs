//! Scenes for pbrt-v4.
//!
//! | here | there |
//! |---|---|
//! | parallelogram, box, mesh | `trianglemesh` |
//! | sphere and its bands, disk | `sphere`, `disk` |
//! | fov, horizontal | `fov`, of the shorter side |
//! | diffuse, mirror, conductor, dielectric, plastic | `diffuse`, `conductor`, `dielectric`, `coateddiffuse` |
//! | at most K reflections | `maxdepth` = K |
//!
//! pbrt-v4 traces wavelengths: colours become spectra that have these colours, and products of them differ slightly from products of three
//! numbers. Its surfaces reflect on both sides. Both are noted. Reference: Pharr, Jakob, Humphreys, *Physically Based Rendering* (4th ed.
//! 2023), file format.

use super::{Exported, Settings, Unsupported, alpha, named, triangles, uniform, words};
use crate::scene::description::{
    BsdfDescription, CameraDescription, ConductorSurface, Description, DielectricSurface, DiffuseSurface, Geometry,
    Ggx, LightDescription, Masking, Material, Metal, MirrorSurface, PlasticSurface, Shape, Sky,
};
use glam::DVec3;
use std::fmt::Write;

/// Writes a scene for pbrt-v4.
///
/// # Errors
/// If a part of the scene has no counterpart.
pub fn export(d: &Description, settings: &Settings) -> Result<Exported, Unsupported> {
    let mut text = head(d, settings);
    for (i, light) in d.lights.iter().enumerate() {
        writeln!(text, "{}", self::light(i, light)?).ok();
    }
    for (i, shape) in d.shapes.iter().enumerate() {
        writeln!(text, "\n{}", self::shape(i, shape, &d.materials[shape.material])?).ok();
    }
    let mut notes =
        vec!["pbrt-v4 traces wavelengths; its colours differ slightly from those of three channels".to_owned()];
    let used = |m: &&Material| d.shapes.iter().any(|s| d.materials[s.material].name == m.name);
    let one_sided: Vec<&str> =
        d.materials.iter().filter(used).filter(|m| !m.both_sides()).map(|m| m.name.as_str()).collect();
    if !one_sided.is_empty() {
        notes.push(format!(
            "surfaces of pbrt reflect on both sides, and {} on the front only: the pictures differ where light reaches the back",
            one_sided.join(", ")
        ));
    }
    Ok(Exported { text, beside: vec![], notes })
}

fn head(d: &Description, settings: &Settings) -> String {
    let c = &d.camera;
    let [width, height] = c.size;
    // pbrt limits paths by default
    let depth = settings.max_bounces.unwrap_or(1000);
    format!(
        r#"# {name}, exported by fredholm {version} for pbrt-v4
Integrator "path" "integer maxdepth" [{depth}]
Sampler "independent" "integer pixelsamples" [{spp}]
PixelFilter "box" "float xradius" [0.5] "float yradius" [0.5]
Film "rgb" "integer xresolution" [{width}] "integer yresolution" [{height}] "string filename" "{stem}.exr"
    "float iso" [100] "float exposuretime" [1] "float maxcomponentvalue" [1e30]
# pbrt's camera looks along +z with +x to the right, in a left-handed system
Scale -1 1 1
LookAt {origin}  {target}  {up}
Camera "perspective" "float fov" [{fov}]

WorldBegin
"#,
        name = d.name.replace('\n', " "),
        version = env!("CARGO_PKG_VERSION"),
        spp = settings.spp,
        stem = settings.stem,
        origin = words(c.origin),
        target = words(c.target),
        up = words(c.up),
        fov = shorter_fov(c),
    )
}

/// Field of view of the shorter side of the image, in degrees.
fn shorter_fov(c: &CameraDescription) -> f64 {
    let [w, h] = c.size.map(f64::from);
    let half = (0.5 * c.fov.to_radians()).tan();
    2.0 * (half * (h / w).min(1.0)).atan().to_degrees()
}

fn rgb(name: &str, v: DVec3) -> String {
    format!(r#""rgb {name}" [{}]"#, words(v))
}

fn roughness(rough: Option<&Ggx>, material: &Material) -> Result<String, Unsupported> {
    let alpha = rough.map_or(Ok(0.0), |r| alpha(r, Masking::HeightCorrelated, material))?;
    Ok(format!(r#""float roughness" [{alpha}] "bool remaproughness" false"#))
}

/// A `Material`.
fn surface(material: &Material) -> Result<String, Unsupported> {
    Ok(match &material.bsdf {
        BsdfDescription::Diffuse(DiffuseSurface { reflectance }) => {
            format!(r#"Material "diffuse" {}"#, rgb("reflectance", uniform(reflectance, material)?))
        }
        BsdfDescription::Mirror(MirrorSurface { reflectance }) => {
            format!(r#"Material "conductor" {} {}"#, rgb("reflectance", *reflectance), roughness(None, material)?)
        }
        BsdfDescription::Conductor(ConductorSurface { metal, rough }) => {
            let metal = match metal {
                Metal::Fresnel { eta, k } => format!("{} {}", rgb("eta", *eta), rgb("k", *k)),
                Metal::Reflectance(f) if rough.is_none() => rgb("reflectance", *f),
                Metal::Reflectance(_) => {
                    return Err(Unsupported::new(
                        format!(
                            "the reflectance of material `{}`: pbrt turns it into an index of refraction",
                            material.name
                        ),
                        "give eta and k",
                    ));
                }
            };
            format!(r#"Material "conductor" {metal} {}"#, roughness(rough.as_ref(), material)?)
        }
        BsdfDescription::Dielectric(DielectricSurface { ior, ior_outside, rough, .. }) => {
            if *ior_outside != 1.0 {
                return Err(Unsupported::new(
                    format!("the medium around material `{}`: pbrt has air outside", material.name),
                    "divide both indices by ior_outside",
                ));
            }
            format!(r#"Material "dielectric" "float eta" [{ior}] {}"#, roughness(rough.as_ref(), material)?)
        }
        BsdfDescription::Plastic(PlasticSurface { reflectance, ior, rough }) => format!(
            r#"Material "coateddiffuse" {} "float eta" [{ior}] "float thickness" [0] "integer maxdepth" [100] {}"#,
            rgb("reflectance", uniform(reflectance, material)?),
            roughness(rough.as_ref(), material)?
        ),
        BsdfDescription::Phong(_) => {
            return Err(Unsupported::new(
                format!("the Phong lobe of material `{}`: pbrt has none", material.name),
                "give it another kind: --set materials.NAME.type=\"diffuse\"",
            ));
        }
    })
}

/// A shape with its material and emission, inside an attribute block.
fn shape(i: usize, shape: &Shape, material: &Material) -> Result<String, Unsupported> {
    let mut lines = vec![surface(material)?];
    if shape.emission != DVec3::ZERO {
        lines.push(format!(r#"AreaLightSource "diffuse" {}"#, rgb("L", shape.emission)));
    }
    match &shape.geometry {
        Geometry::Sphere { center, radius, z, inward } => {
            if *inward {
                lines.push("ReverseOrientation".into());
            }
            lines.push(format!("Translate {}", words(*center)));
            let band = if *z == [-1.0, 1.0] {
                String::new()
            } else {
                format!(r#" "float zmin" [{}] "float zmax" [{}]"#, z[0] * radius, z[1] * radius)
            };
            lines.push(format!(r#"Shape "sphere" "float radius" [{radius}]{band}"#));
        }
        Geometry::Disk { center, normal, radius } => {
            let n = normal.normalize();
            let (a, b) = n.any_orthonormal_pair();
            let (a, b) = if a.cross(b).dot(n) > 0.0 { (a, b) } else { (b, a) };
            // pbrt's matrices are written by columns
            lines.push(format!("ConcatTransform [{} 0 {} 0 {} 0 {} 1]", words(a), words(b), words(n), words(*center)));
            lines.push(format!(r#"Shape "disk" "float radius" [{radius}]"#));
        }
        geometry => {
            let Some((vertices, faces)) = triangles(geometry) else { unreachable!("curved shapes come before") };
            let points: Vec<String> = vertices.iter().map(|v| words(*v)).collect();
            let indices: Vec<String> = faces.iter().map(|f| format!("{} {} {}", f[0], f[1], f[2])).collect();
            let (points, indices) = (points.join("  "), indices.join("  "));
            lines.push(format!(r#"Shape "trianglemesh" "point3 P" [{points}] "integer indices" [{indices}]"#));
        }
    }
    let lines: Vec<String> = lines.into_iter().map(|l| format!("    {l}")).collect();
    Ok(format!("# {}\nAttributeBegin\n{}\nAttributeEnd", named(i, shape).replace('\n', " "), lines.join("\n")))
}

/// A light without a surface.
fn light(i: usize, light: &LightDescription) -> Result<String, Unsupported> {
    Ok(match light {
        LightDescription::Point { position, intensity } => {
            format!(r#"LightSource "point" "point3 from" [{}] {}"#, words(*position), rgb("I", *intensity))
        }
        LightDescription::Directional { direction, irradiance } => {
            let to = words(*direction);
            format!(r#"LightSource "distant" "point3 from" [0 0 0] "point3 to" [{to}] {}"#, rgb("L", *irradiance))
        }
        LightDescription::Environment { sky: Sky::Constant(radiance), scale, .. } => {
            format!(r#"LightSource "infinite" {}"#, rgb("L", *radiance * *scale))
        }
        LightDescription::Environment { .. } => {
            return Err(Unsupported::new(
                format!("the sky of light {i}: skies from images are not exported"),
                "give it one colour, and remove the image",
            ));
        }
    })
}
