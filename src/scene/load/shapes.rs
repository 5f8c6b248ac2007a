//! Reading of `[[shapes]]`: the geometry, its material and its emission, as radiance or as total power.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L | radiance that leaves the front, W·sr⁻¹·m⁻² | `emission` |
//! | Φ | power that leaves the whole shape, W | `power` |
//! | A | area of the front of the whole shape, m² | [`Primitive::area`](crate::scene::Primitive::area) |
//!
//! A Lambertian emitter has the power Φ = L·A·∫cos θ dω = π A L, hence `L = Φ/(π A)`.

use super::{
    beside,
    cursor::{Cursor, LARGEST_LIGHT, SMALLEST_LENGTH},
    mesh::{FLAT, mesh, transform},
    names, obj,
    tree::Place,
};
use crate::math::names::suggest;
use crate::scene::{
    SceneError,
    description::{Geometry, Material, Shape, Sides},
};
use glam::DVec3;
use std::f64::consts::PI;
use std::mem::take;

/// The kinds of shape, each with the keys of its geometry.
pub(super) const KINDS: [(&str, &[&str]); 6] = [
    ("mesh", &["vertices", "faces", "uvs", "transform"]),
    ("obj", &["file", "transform"]),
    ("quad", &["origin", "edge_u", "edge_v"]),
    ("box", &["min", "max", "rotate_y", "inward"]),
    ("sphere", &["center", "radius", "z", "inward"]),
    ("disk", &["center", "normal", "radius"]),
];
/// The keys that every shape may have.
pub(super) const SHAPE_KEYS: [&str; 5] = ["type", "name", "material", "emission", "power"];

/// The shapes of a file, with the materials and messages that OBJ files add.
pub(super) struct Read {
    pub(super) shapes: Vec<Shape>,
    pub(super) materials: Vec<Material>,
    pub(super) warnings: Vec<String>,
    pub(super) hints: Vec<String>,
    /// The place of each shape in the file, for errors that are found only in the whole scene.
    pub(super) places: Vec<SceneError>,
}

/// Reads every shape. The materials of OBJ files are added after those of the scene file.
pub(super) fn read(list: &Cursor, materials: Vec<Material>) -> Result<Read, SceneError> {
    let mut out = Read { shapes: Vec::new(), materials, warnings: Vec::new(), hints: Vec::new(), places: Vec::new() };
    let named = out.materials.len();
    for c in list.items("an array of tables, [[shapes]]")? {
        let at = c.require("type", "type = \"quad\"; types: mesh, obj, quad, box, sphere, disk")?;
        let kinds: Vec<(&str, (&str, &[&str]))> = KINDS.iter().map(|&(k, keys)| (k, (k, keys))).collect();
        let (kind, keys) = at.choice("type of shape", &kinds)?;
        // the shapes of an OBJ file have the names of its groups
        let common: Vec<&str> = SHAPE_KEYS.iter().copied().filter(|&key| key != "name" || kind != "obj").collect();
        c.only(&[&common, keys].concat())?;
        if kind == "obj" {
            let material = c.get("material").map(|m| material(&m, &out.materials[..named])).transpose()?;
            append_obj(&c, material, &mut out)?;
            out.places.resize(out.shapes.len(), c.error(""));
            continue;
        }
        let at = c.require("material", "material = \"…\", a name from [materials]")?;
        let material = material(&at, &out.materials[..named])?;
        let geometry = geometry(&c, kind)?;
        placed(&at, &out.materials[material], &geometry, kind)?;
        let emission = emission(&c, area(&geometry))?.unwrap_or(DVec3::ZERO);
        let name = c.get("name").map_or(Ok(c.key.clone()), |at| shape_name(&at))?;
        out.shapes.push(Shape { name, geometry, material, emission });
        out.places.push(c.error(""));
    }
    Ok(out)
}

/// The name that a shape is given.
fn shape_name(c: &Cursor) -> Result<String, SceneError> {
    let name = c.text()?;
    names::check(name, "shape").map_err(|f| c.error(f.what).help(f.help))?;
    Ok(name.to_owned())
}

fn material(c: &Cursor, materials: &[Material]) -> Result<usize, SceneError> {
    let name = c.text()?;
    materials.iter().position(|m| m.name == name).ok_or_else(|| {
        let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        c.error(format!("unknown material `{name}`")).help(suggest(name, "materials", &names))
    })
}

/// Returns an error if a material with an image is used on a shape without texture coordinates.
fn placed(at: &Cursor, material: &Material, geometry: &Geometry, kind: &str) -> Result<(), SceneError> {
    let has_uv = match geometry {
        Geometry::Quad { .. } => true,
        Geometry::Mesh { uvs, .. } => !uvs.is_empty(),
        _ => false,
    };
    if has_uv || !material.bsdf.colour().is_some_and(crate::scene::description::Colour::is_texture) {
        return Ok(());
    }
    let e = at.error(format!("material `{}` has a texture, but this {kind} has no texture coordinates", material.name));
    Err(e.help(match kind {
        "mesh" => "add uvs = [[u, v], …] to the mesh, one pair per vertex",
        "obj" => "every corner needs a vt, as in f 1/1 2/2 3/3; or use a material with reflectance",
        _ => "use a quad, a mesh with uvs or an obj file with vt, or a material with reflectance",
    }))
}

/// Area of the front of a shape, m².
fn area(geometry: &Geometry) -> f64 {
    geometry.each().map(|p| p.area()).sum()
}

/// The radiance L: from `emission`, or Φ/(π A) from `power`; `None` if neither is given.
fn emission(c: &Cursor, area: f64) -> Result<Option<DVec3>, SceneError> {
    match (c.get("emission"), c.get("power")) {
        (Some(_), Some(power)) => {
            Err(power.error("emission and power are both given").help("keep one: emission = power / (pi * area)"))
        }
        (Some(e), None) => e.light("emission").map(Some),
        (None, Some(p)) => {
            let radiance = p.light("power")? / (PI * area);
            let large =
                || p.error(format!("this power makes the radiance {:.3e}, which is too large", radiance.max_element()));
            if radiance.max_element() <= LARGEST_LIGHT {
                Ok(Some(radiance))
            } else {
                Err(large().help("stay below 1e30"))
            }
        }
        (None, None) => Ok(None),
    }
}

fn geometry(c: &Cursor, kind: &str) -> Result<Geometry, SceneError> {
    match kind {
        "mesh" => mesh(c),
        "quad" => quad(c),
        "box" => cuboid(c),
        "sphere" => sphere(c),
        _ => disk(c),
    }
}

fn quad(c: &Cursor) -> Result<Geometry, SceneError> {
    let origin = c.require("origin", "a corner: origin = [0, 0, 0]")?.vector()?;
    let (at_u, at_v) = (c.require("edge_u", "edge_u = [1, 0, 0]")?, c.require("edge_v", "edge_v = [0, 1, 0]")?);
    let edge = |at: &Cursor| {
        let e = at.vector()?;
        let zero = || at.error("the edge has zero length").help("the quad spans origin + u edge_u + v edge_v");
        if e.length() < SMALLEST_LENGTH { Err(zero()) } else { Ok(e) }
    };
    let (edge_u, edge_v) = (edge(&at_u)?, edge(&at_v)?);
    if edge_u.normalize().cross(edge_v.normalize()).length() <= FLAT {
        let e = at_v.error("edge_u and edge_v are parallel, so the quad has no area");
        return Err(e.help("choose edges with different directions"));
    }
    Ok(Geometry::Quad { origin, edge_u, edge_v })
}

fn cuboid(c: &Cursor) -> Result<Geometry, SceneError> {
    let min = c.require("min", "the smallest corner: min = [-1, -1, -1]")?.vector()?;
    let at = c.require("max", "the largest corner: max = [1, 1, 1]")?;
    let max = at.vector()?;
    if let Some(i) = (0..3).find(|&i| max[i] - min[i] < SMALLEST_LENGTH) {
        let axis = ["x", "y", "z"][i];
        let e = at.error(format!("the box has no extent along {axis}: min {}, max {}", min[i], max[i]));
        return Err(e.help("max must exceed min along every axis"));
    }
    let rotate_y = c.get("rotate_y").map_or(Ok(0.0), |r| r.number())?;
    Ok(Geometry::Box { min, max, rotate_y, inward: inward(c)? })
}

fn sphere(c: &Cursor) -> Result<Geometry, SceneError> {
    let center = c.require("center", "center = [0, 0, 0]")?.vector()?;
    let radius = radius(c)?;
    let z = match c.get("z") {
        None => [-1.0, 1.0],
        Some(at) => {
            let [low, high] = at.pair()?;
            let help = "z = [low, high] in radii from the centre, -1 <= low < high <= 1";
            if low < -1.0 || high > 1.0 {
                return Err(at.error(format!("the band [{low}, {high}] reaches beyond the sphere")).help(help));
            }
            if high - low <= FLAT {
                return Err(at.error(format!("the band [{low}, {high}] is empty")).help(help));
            }
            [low, high]
        }
    };
    Ok(Geometry::Sphere { center, radius, z, inward: inward(c)? })
}

fn disk(c: &Cursor) -> Result<Geometry, SceneError> {
    let center = c.require("center", "center = [0, 0, 0]")?.vector()?;
    let at = c.require("normal", "the direction of the front: normal = [0, 1, 0]")?;
    let normal = at.vector()?;
    if normal.length() < SMALLEST_LENGTH {
        return Err(at.error("the normal has zero length").help("write a direction of any length"));
    }
    Ok(Geometry::Disk { center, normal, radius: radius(c)? })
}

fn radius(c: &Cursor) -> Result<f64, SceneError> {
    let at = c.require("radius", "radius = 1")?;
    let radius = at.length()?;
    if radius >= SMALLEST_LENGTH {
        return Ok(radius);
    }
    Err(at.error(format!("radius {radius} is not positive")).help("write a length in metres above 0"))
}

fn inward(c: &Cursor) -> Result<bool, SceneError> {
    c.get("inward").map_or(Ok(false), |i| i.flag())
}

/// Adds the shapes of an OBJ file: one per group and material. They have the materials of the MTL files, unless the scene
/// names one material for all.
fn append_obj(c: &Cursor, material: Option<usize>, out: &mut Read) -> Result<(), SceneError> {
    let at = c.require("file", "file = \"model.obj\", relative to the scene file")?;
    let path = beside(c.file, at.text()?);
    let mut model = obj::read(&path, material.is_none()).map_err(|e| match at.node.place {
        // the file exists but has an error: its own line is more useful than the line that names it
        _ if e.line.is_some() || path.is_file() => e,
        Place::Program => e,
        _ => at.error(format!("cannot read `{}`", path.display())).help("paths are relative to the scene file"),
    })?;
    if let Some(t) = transform(c)? {
        model.pieces.iter_mut().try_for_each(|p| t.apply(&mut p.vertices, &mut p.faces, &mut p.uvs))?;
    }
    let mesh = |p: &mut obj::Piece| Geometry::Mesh {
        vertices: take(&mut p.vertices),
        faces: take(&mut p.faces),
        uvs: take(&mut p.uvs),
    };
    let meshes: Vec<Geometry> = model.pieces.iter_mut().map(mesh).collect();
    let total = meshes.iter().map(area).sum();
    let given = emission(c, total)?;
    if let (Some(_), None) = (given, material) {
        let at = c.get("emission").or(c.get("power")).unwrap_or(c.clone());
        let help = "add a material for the whole file, write Ke in its MTL, or pass --emit MATERIAL=r,g,b";
        return Err(at.error("an OBJ without `material` takes its emission from its MTL").help(help));
    }
    for (p, geometry) in model.pieces.iter().zip(meshes) {
        let (material, emission) = match material {
            Some(m) => {
                let at = c.get("material").unwrap_or(c.clone());
                placed(&at, &out.materials[m], &geometry, "obj")?;
                (m, given.unwrap_or(DVec3::ZERO))
            }
            None => (intern(&model.materials[p.material], &mut out.materials), model.materials[p.material].emission),
        };
        out.shapes.push(Shape { name: p.name.clone(), geometry, material, emission });
    }
    out.warnings.append(&mut model.warnings);
    out.hints.append(&mut model.hints);
    Ok(())
}

/// The index of an MTL material among all materials. Equal materials of several files become one.
fn intern(m: &obj::Surface, materials: &mut Vec<Material>) -> usize {
    let material = Material { name: m.name.clone(), bsdf: m.bsdf.clone(), sides: Sides::Both };
    materials.iter().position(|o| *o == material).unwrap_or_else(|| {
        materials.push(material);
        materials.len() - 1
    })
}
