//! OBJ (Wavefront Technologies, The Advanced Visualizer, appendix B1): polygons in groups, as triangles, with what their MTL says of light.
//!
//! Every statement that matters is checked here first, because only here its line is known; `tobj` then resolves
//! indices, groups and materials. Texture coordinates, normals, lines and points do not reach it: Lambertian
//! transport needs none. A fourth number of a vertex (a weight) and vertex colours are left out.
//!
//! A polygon p₀ … pₙ becomes the fan (p₀, pᵢ, pᵢ₊₁). That is exact for convex polygons. In others some
//! triangle turns against the polygon's normal N = Σ (pᵢ − p₀) × (pᵢ₊₁ − p₀) (M. Newell, in Sutherland, Sproull and
//! Schumacker 1974): those are counted in a warning.

use super::{
    cursor::LARGEST_LENGTH,
    mesh::flat,
    mtl::{self, Entry, Statement, statements},
    nearest::nearest,
    read_lossy,
};
use crate::scene::SceneError;
use glam::DVec3;
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// Albedo of what has no `Kd`.
const GREY: DVec3 = DVec3::splat(0.5);

/// The triangles of one group with one material.
pub(super) struct Piece {
    pub(super) name: String,
    /// Index into [`Model::materials`].
    pub(super) material: usize,
    pub(super) vertices: Vec<DVec3>,
    pub(super) faces: Vec<[u32; 3]>,
}

/// A two-sided Lambertian surface of an OBJ.
pub(super) struct Surface {
    pub(super) name: String,
    pub(super) reflectance: DVec3,
    pub(super) emission: DVec3,
}

/// An OBJ file as far as light is concerned.
pub(super) struct Model {
    pub(super) pieces: Vec<Piece>,
    pub(super) materials: Vec<Surface>,
    pub(super) warnings: Vec<String>,
    /// What to do if nothing emits.
    pub(super) hints: Vec<String>,
}

/// Reads an OBJ, and its MTL files if `with_mtl`.
pub(super) fn read(path: &Path, with_mtl: bool) -> Result<Model, SceneError> {
    let list = statements(&read_lossy(path)?);
    check(&list, path)?;
    let mut warnings = Vec::new();
    let library = if with_mtl { library(&list, path, &mut warnings)? } else { Vec::new() };

    // the statements of geometry, with every material known by name
    let mut names: Vec<String> = Vec::new();
    let mut first_use: HashMap<String, usize> = HashMap::new();
    let mut text = String::from("mtllib names\n");
    for s in list.iter().filter(|s| ["v", "f", "g", "o", "usemtl"].contains(&s.key.as_str())) {
        let rest = match s.key.as_str() {
            "v" => s.words().take(3).collect::<Vec<_>>().join(" "),
            "f" => s.words().collect::<Vec<_>>().join(" "),
            _ => s.rest.clone(),
        };
        text.push_str(&format!("{} {rest}\n", s.key));
        if s.key == "usemtl" && !first_use.contains_key(&s.rest) {
            first_use.insert(s.rest.clone(), s.line);
            names.push(s.rest.clone());
        }
    }
    let map = || names.iter().enumerate().map(|(i, n)| (n.clone(), i)).collect();
    let (models, _) =
        tobj::load_obj_buf(&mut text.as_bytes(), &tobj::LoadOptions::default(), |_| Ok((Vec::new(), map())))
            .map_err(|e| SceneError::new(format!("not a valid OBJ: {e}")).file(path).help("export it again"))?;

    // material 0 is what has none
    let mut model = Model { pieces: Vec::new(), materials: Vec::new(), warnings, hints: Vec::new() };
    let mut numbers: HashMap<Option<usize>, usize> = HashMap::new();
    let mut flaws = Flaws::default();
    for m in models.iter().filter(|m| !m.mesh.indices.is_empty()) {
        let vertices: Vec<DVec3> = m.mesh.positions.chunks_exact(3).map(|p| DVec3::new(p[0], p[1], p[2])).collect();
        let faces = triangles(&m.mesh, &vertices, &mut flaws);
        if faces.is_empty() {
            continue;
        }
        let material = *numbers.entry(m.mesh.material_id).or_insert_with(|| {
            let name = m.mesh.material_id.map(|i| names[i].as_str());
            let line = name.and_then(|n| first_use.get(n)).copied().unwrap_or(1);
            let surface = surface(name, line, &library, path, with_mtl, &mut model.warnings, &mut model.hints);
            model.materials.push(surface);
            model.materials.len() - 1
        });
        let name = if m.name == "unnamed_object" { stem(path) } else { m.name.clone() };
        model.pieces.push(Piece { name, material, vertices, faces });
    }
    if model.pieces.is_empty() {
        let what = if flaws.flat > 0 { "every triangle of the file is without area" } else { "the file has no faces" };
        return Err(SceneError::new(what).file(path).help("an OBJ scene needs polygons: f 1 2 3"));
    }
    flaws.report(path, &mut model.warnings);
    Ok(model)
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Refuses the first statement that is not geometry, with its line.
fn check(list: &[Statement], path: &Path) -> Result<(), SceneError> {
    let total = list.iter().filter(|s| s.key == "v").count() as i64;
    let mut seen = 0;
    for s in list {
        let fail = |what: String, help: &str| Err(SceneError::new(what).at(path, s.line).key(s.key.clone()).help(help));
        match s.key.as_str() {
            "v" => {
                seen += 1;
                let numbers = s.words().take(3).map(str::parse).collect::<Result<Vec<f64>, _>>().unwrap_or_default();
                if numbers.len() != 3 {
                    return fail(format!("`{}` is not a position", s.rest), "a vertex is three numbers");
                }
                if numbers.iter().any(|x| x.is_nan() || x.abs() > LARGEST_LENGTH) {
                    return fail(
                        format!("the vertex {} is not finite, or beyond 1e12", s.rest),
                        "repair the exporter's numbers",
                    );
                }
            }
            "f" => {
                if s.words().count() < 3 {
                    return fail(
                        format!("the face `{}` has fewer than 3 corners", s.rest),
                        "a face is three indices or more",
                    );
                }
                for word in s.words() {
                    let parts: Vec<&str> = word.split('/').collect();
                    let number = |p: &str| p.parse::<i64>().ok();
                    let rest_valid = parts.len() <= 3 && parts[1..].iter().all(|p| p.is_empty() || number(p).is_some());
                    let Some(i) = number(parts[0]).filter(|_| rest_valid) else {
                        return fail(format!("`{word}` is not a corner"), "write v, v/vt, v//vn or v/vt/vn");
                    };
                    if i == 0 || i > total || (i < 0 && seen < i.saturating_neg()) {
                        let what = format!("vertex index {i} is out of range, the file has {total} vertices");
                        return fail(what, "indices start at 1; negative ones count back from the last vertex");
                    }
                }
            }
            "usemtl" if s.rest.is_empty() => return fail("usemtl needs a name".into(), "write usemtl NAME"),
            _ => {}
        }
    }
    Ok(())
}

/// Every material of every MTL file the OBJ names.
fn library(list: &[Statement], path: &Path, warnings: &mut Vec<String>) -> Result<Vec<Entry>, SceneError> {
    let mut entries = Vec::new();
    for s in list.iter().filter(|s| s.key == "mtllib") {
        let folder = path.parent().unwrap_or(Path::new(""));
        // one name with spaces, or several names in which a backslash keeps a space
        let whole = folder.join(&s.rest);
        let files: Vec<PathBuf> =
            if whole.is_file() { vec![whole] } else { split_names(&s.rest).iter().map(|n| folder.join(n)).collect() };
        let (found, missing): (Vec<_>, Vec<_>) = files.into_iter().partition(|f| f.is_file());
        if found.is_empty() {
            let e =
                SceneError::new(format!("cannot find the material file `{}`", s.rest)).at(path, s.line).key("mtllib");
            return Err(e.help("put it beside the OBJ, or remove the line: everything is grey 0.5 then"));
        }
        for m in missing {
            warnings.push(format!("{}:{}: material file {} is missing", path.display(), s.line, m.display()));
        }
        for f in found {
            entries.extend(mtl::parse(&read_lossy(&f)?, &f)?);
        }
    }
    Ok(entries)
}

fn split_names(rest: &str) -> Vec<String> {
    let marked = rest.replace("\\ ", "\0");
    marked.split_whitespace().map(|n| n.replace('\0', " ")).collect()
}

/// What to make of a material name; the last definition in the MTL counts.
fn surface(
    name: Option<&str>,
    line: usize,
    library: &[Entry],
    path: &Path,
    with_mtl: bool,
    warnings: &mut Vec<String>,
    hints: &mut Vec<String>,
) -> Surface {
    let Some(name) = name else {
        return Surface { name: "default".into(), reflectance: GREY, emission: DVec3::ZERO };
    };
    let grey = Surface { name: name.to_owned(), reflectance: GREY, emission: DVec3::ZERO };
    let mut warn = |what: String| warnings.push(format!("{}:{line}: material `{name}` {what}", path.display()));
    if !with_mtl {
        return grey;
    }
    let Some(m) = library.iter().rev().find(|m| m.name == name) else {
        let close = nearest(name, library.iter().map(|m| m.name.as_str()));
        let close = close.map_or(String::new(), |k| format!("; did you mean `{k}`?"));
        warn(format!("is not defined, it is grey 0.5{close}"));
        return grey;
    };
    if m.diffuse.is_none() {
        warn("has no Kd, it is grey 0.5".into());
    }
    if !m.ignored.is_empty() {
        warn(format!("has {} ignored, only Kd and Ke are read", m.ignored.join(", ")));
    }
    let emission = m.emission.unwrap_or(DVec3::ZERO);
    if let (Some(a), DVec3::ZERO) = (m.ambient.filter(|a| a.max_element() > 0.0), emission) {
        let lamp = ["light", "lamp", "lumi", "emit", "emis"].iter().any(|w| name.to_lowercase().contains(w));
        if lamp || a.max_element() > 1.0 {
            hints.push(format!(
                "material `{name}` has Ka {} {} {} but no Ke: Ka is ambient reflection, not emission; pass --emit {name}={},{},{}",
                a.x, a.y, a.z, a.x, a.y, a.z
            ));
        }
    }
    Surface { name: name.to_owned(), reflectance: m.diffuse.unwrap_or(GREY), emission }
}

/// What fans could not represent.
#[derive(Default)]
struct Flaws {
    flat: usize,
    concave: usize,
}

impl Flaws {
    fn report(&self, path: &Path, warnings: &mut Vec<String>) {
        if self.flat > 0 {
            warnings.push(format!("{}: triangles without area, left out: {}", path.display(), self.flat));
        }
        if self.concave > 0 {
            let help = "their fans overlap, triangulate them in the program that made them";
            warnings.push(format!("{}: polygons that are not convex: {} ({help})", path.display(), self.concave));
        }
    }
}

/// The fans of all polygons, without triangles that have no area.
fn triangles(mesh: &tobj::Mesh, vertices: &[DVec3], flaws: &mut Flaws) -> Vec<[u32; 3]> {
    let mut out = Vec::new();
    let mut rest = mesh.indices.as_slice();
    // no arities at all means triangles only
    let mut arities = mesh.face_arities.iter().map(|&n| n as usize);
    while !rest.is_empty() {
        let (polygon, tail) = rest.split_at(arities.next().unwrap_or(3).min(rest.len()));
        rest = tail;
        let p = |i: usize| vertices[polygon[i] as usize];
        let newell: DVec3 = (1..polygon.len().saturating_sub(1)).map(|i| (p(i) - p(0)).cross(p(i + 1) - p(0))).sum();
        let mut concave = false;
        for i in 1..polygon.len().saturating_sub(1) {
            let corners = [p(0), p(i), p(i + 1)];
            if flat(corners) {
                flaws.flat += 1;
                continue;
            }
            concave |= (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(newell) < 0.0;
            out.push([polygon[0], polygon[i], polygon[i + 1]]);
        }
        flaws.concave += usize::from(concave);
    }
    out
}
