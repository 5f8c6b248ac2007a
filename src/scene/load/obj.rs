//! Reading of OBJ files (Wavefront Technologies, The Advanced Visualizer, appendix B1): polygons in groups, converted to
//! triangles, with the materials and emission of their MTL files.
//!
//! Every statement that matters is checked first, because only at this stage its line is known. The crate `tobj` then
//! resolves indices, groups and materials. It does not receive normals, lines and points, because surfaces are flat here. A
//! fourth number of a vertex (a weight) and vertex colours are ignored. A corner without `vt` gets a texture coordinate that
//! is NaN, so that all corners of a file have the same form.
//!
//! Polygons become triangles ([`polygon`](super::polygon)).

use super::{
    mesh::flat,
    mtl::{self, Entry, Statement, statements},
    mtl_surface,
    obj_check::{check, number_of},
    polygon, read_lossy,
};
use crate::math::names::nearest;
use crate::scene::{SceneError, description::BsdfDescription};
use glam::{DVec2, DVec3};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// The triangles of one group with one material.
pub(super) struct Piece {
    pub(super) name: String,
    /// Index into [`Model::materials`].
    pub(super) material: usize,
    pub(super) vertices: Vec<DVec3>,
    pub(super) faces: Vec<[u32; 3]>,
    /// Texture coordinates of the corners of each face; empty unless every corner has them.
    pub(super) uvs: Vec<[DVec2; 3]>,
}

/// A two-sided material of an OBJ file, with its emission.
pub(super) struct Surface {
    pub(super) name: String,
    pub(super) bsdf: BsdfDescription,
    pub(super) emission: DVec3,
}

/// The content of an OBJ file that matters for light transport.
pub(super) struct Model {
    pub(super) pieces: Vec<Piece>,
    pub(super) materials: Vec<Surface>,
    pub(super) warnings: Vec<String>,
    /// Help texts that are shown if nothing emits.
    pub(super) hints: Vec<String>,
}

/// Reads an OBJ file, and its MTL files if `with_mtl` is true.
pub(super) fn read(path: &Path, with_mtl: bool) -> Result<Model, SceneError> {
    let file = read_lossy(path)?;
    let list = statements(&file);
    check(&list, path)?;
    let mut warnings = dropped(&list, path);
    let library = if with_mtl { Some(library(&list, path, &mut warnings)?) } else { None };

    let (text, names, first_use) = geometry(&list);
    // a large file is not kept while its geometry is built
    drop(list);
    drop(file);
    let map = || names.iter().enumerate().map(|(i, n)| (n.clone(), i)).collect();
    let (models, _) =
        tobj::load_obj_buf(&mut text.as_bytes(), &tobj::LoadOptions::default(), |_| Ok((Vec::new(), map())))
            .map_err(|e| SceneError::new(format!("not a valid OBJ: {e}")).file(path).help("export it again"))?;
    drop(text);

    let mut model = Model { pieces: Vec::new(), materials: Vec::new(), warnings, hints: Vec::new() };
    // a material with an image counts as another material on polygons without texture coordinates
    let mut numbers: HashMap<(Option<usize>, bool), usize> = HashMap::new();
    let mut flaws = Flaws::default();
    for m in models.iter().filter(|m| !m.mesh.indices.is_empty()) {
        let vertices: Vec<DVec3> = m.mesh.positions.chunks_exact(3).map(|p| DVec3::new(p[0], p[1], p[2])).collect();
        let (faces, uvs) = triangles(&m.mesh, &vertices, &mut flaws);
        if faces.is_empty() {
            continue;
        }
        let name = m.mesh.material_id.map(|i| names[i].as_str());
        let key = (m.mesh.material_id, uvs.is_empty());
        let material = match numbers.get(&key) {
            Some(&material) => material,
            None => {
                let line = name.and_then(|n| first_use.get(n)).copied().unwrap_or(1);
                let at = format!("{}:{line}", path.display());
                let surface = surface(name, &at, library.as_deref(), !uvs.is_empty(), &mut model)?;
                numbers.insert(key, model.materials.len());
                model.materials.push(surface);
                model.materials.len() - 1
            }
        };
        let name = if m.name == "unnamed_object" { stem(path) } else { m.name.clone() };
        model.pieces.push(Piece { name, material, vertices, faces, uvs });
    }
    if model.pieces.is_empty() {
        let what = if flaws.flat > 0 { "no triangle of the file has an area" } else { "the file has no faces" };
        return Err(SceneError::new(what).file(path).help("an OBJ scene needs polygons: f 1 2 3"));
    }
    flaws.report(path, &mut model.warnings);
    let unused = |m: &&Entry| !names.contains(&m.name);
    for m in library.iter().flatten().filter(unused) {
        let fault = m.fault.iter().map(|e| e.to_string().lines().collect::<Vec<_>>().join(" ").replace("error: ", ""));
        model.warnings.extend(fault.map(|what| format!("material `{}`, which nothing uses: {what}", m.name)));
    }
    Ok(model)
}

/// Statements that matter nothing to light: points, lines, groups of smoothing, and how other programs show the model.
const HARMLESS: [&str; 22] = [
    "v",
    "vt",
    "vn",
    "vp",
    "p",
    "l",
    "f",
    "g",
    "o",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "end",
];

/// A warning for each kind of statement that is dropped, with its first line: free-form surfaces, `fo`, and what is not OBJ.
fn dropped(list: &[Statement], path: &Path) -> Vec<String> {
    let mut kinds: Vec<(&str, usize, usize)> = vec![];
    for s in list.iter().filter(|s| !HARMLESS.contains(&&*s.key)) {
        match kinds.iter_mut().find(|k| k.0 == s.key) {
            Some(kind) => kind.2 += 1,
            None => kinds.push((&s.key, s.line, 1)),
        }
    }
    let words = |(key, line, count): &(&str, usize, usize)| {
        let times = if *count == 1 { String::new() } else { format!(" ({count} times)") };
        let hint = if *key == "fo" { "; write f for faces" } else { "" };
        format!("{}:{line}: the statement `{key}` is ignored{times}{hint}", path.display())
    };
    kinds.iter().map(words).collect()
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Every material of every MTL file that the OBJ names.
fn library(list: &[Statement], path: &Path, warnings: &mut Vec<String>) -> Result<Vec<Entry>, SceneError> {
    let mut entries = Vec::new();
    for s in list.iter().filter(|s| s.key == "mtllib") {
        let folder = path.parent().unwrap_or(Path::new(""));
        // either one name with spaces, or several names in which a backslash marks a space that belongs to a name
        let whole = folder.join(&*s.rest);
        let files: Vec<PathBuf> = if whole.is_file() {
            vec![whole]
        } else {
            // names written on Windows use backslashes
            let slashed = folder.join(s.rest.replace('\\', "/"));
            let each = |n: &String| [n.clone(), n.replace('\\', "/")].map(|n| folder.join(n));
            let exists = |pair: [PathBuf; 2]| if pair[1].is_file() { pair[1].clone() } else { pair[0].clone() };
            let names = split_names(&s.rest);
            if slashed.is_file() { vec![slashed] } else { names.iter().map(each).map(exists).collect() }
        };
        let looked_for = files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", ");
        let (found, missing): (Vec<_>, Vec<_>) = files.into_iter().partition(|f| f.is_file());
        if found.is_empty() {
            let e =
                SceneError::new(format!("cannot find the material file `{}`", s.rest)).at(path, s.line).key("mtllib");
            let help =
                "put it next to the OBJ and write its name only, or remove the line, so that everything is grey 0.5";
            return Err(e.help(format!("looked for {looked_for}; {help}")));
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

/// The geometry statements for `tobj`, the names of the materials in order of first use, and the line of each first use.
fn geometry(list: &[Statement<'_>]) -> (String, Vec<String>, HashMap<String, usize>) {
    let mut names: Vec<String> = Vec::new();
    let mut first_use: HashMap<String, usize> = HashMap::new();
    let mut text = String::from("mtllib names\nvt nan nan\n");
    for s in list.iter().filter(|s| s.key == "vt") {
        let mut numbers = s.words();
        text.push_str(&format!("vt {} {}\n", numbers.next().unwrap_or("0"), numbers.next().unwrap_or("0")));
    }
    let mut seen = 0;
    for s in list {
        match &*s.key {
            "vt" => {
                seen += 1;
                continue;
            }
            "v" => text.extend(["v"].into_iter().chain(s.words().take(3).flat_map(|w| [" ", w]))),
            "f" => {
                text.push('f');
                s.words().for_each(|w| corner(w, seen, &mut text));
            }
            "g" | "o" | "usemtl" => text.extend([&*s.key, " ", &*s.rest]),
            _ => continue,
        }
        text.push('\n');
        if s.key == "usemtl" && !first_use.contains_key(&*s.rest) {
            first_use.insert(s.rest.to_string(), s.line);
            names.push(s.rest.to_string());
        }
    }
    (text, names, first_use)
}

/// Writes `v`, `v/vt/vn`, … as ` v/vt` with a positive vt. A missing vt becomes number 1, whose coordinates are NaN.
fn corner(word: &str, seen: i64, text: &mut String) {
    let mut parts = word.split('/');
    let v = parts.next().unwrap_or("");
    text.extend([" ", v, "/"]);
    match parts.next().and_then(number_of) {
        None => text.push('1'),
        Some(i) => text.push_str(&(if i > 0 { i + 1 } else { seen + i + 2 }).to_string()),
    }
}

/// The surface of a material name. If the MTL files define the name several times, the last definition is used.
fn surface(
    name: Option<&str>,
    at: &str,
    library: Option<&[Entry]>,
    placed: bool,
    model: &mut Model,
) -> Result<Surface, SceneError> {
    let grey = |name: &str| Surface { name: name.to_owned(), bsdf: mtl_surface::grey(), emission: DVec3::ZERO };
    let (Some(name), Some(library)) = (name, library) else { return Ok(grey(name.unwrap_or("default"))) };
    let warnings = &mut model.warnings;
    let mut warn = |what: String| {
        let line = format!("{at}: material `{name}` {what}");
        if !warnings.contains(&line) {
            warnings.push(line);
        }
    };
    let Some(m) = library.iter().rev().find(|m| m.name == name) else {
        let close = nearest(name, library.iter().map(|m| m.name.as_str()));
        let close = close.map_or(String::new(), |k| format!("; did you mean `{k}`?"));
        warn(format!("is not defined; grey 0.5 is used{close}"));
        return Ok(grey(name));
    };
    let bsdf = mtl_surface::surface(m, placed, &mut warn)?;
    let emission = m.emission.unwrap_or(DVec3::ZERO);
    if let (Some(a), DVec3::ZERO) = (m.ambient.filter(|a| a.max_element() > 0.0), emission) {
        let lamp = ["light", "lamp", "lumi", "emit", "emis"].iter().any(|w| name.to_lowercase().contains(w));
        if lamp || a.max_element() > 1.0 {
            model.hints.push(format!(
                "material `{name}` has Ka {} {} {} but no Ke: Ka is ambient reflection, not emission; pass --emit {name}={},{},{}",
                a.x, a.y, a.z, a.x, a.y, a.z
            ));
        }
    }
    Ok(Surface { name: name.to_owned(), bsdf, emission })
}

/// Numbers of triangles and polygons that triangles do not represent exactly.
#[derive(Default)]
struct Flaws {
    flat: usize,
    crossed: usize,
}

impl Flaws {
    fn report(&self, path: &Path, warnings: &mut Vec<String>) {
        if self.flat > 0 {
            warnings.push(format!("{}: triangles without area that are ignored: {}", path.display(), self.flat));
        }
        if self.crossed > 0 {
            let help = "their triangles overlap: triangulate these polygons in the program that exported them";
            warnings.push(format!("{}: polygons that cross themselves: {} ({help})", path.display(), self.crossed));
        }
    }
}

/// The triangles of all polygons with their texture coordinates, except triangles that have no area.
fn triangles(mesh: &tobj::Mesh, vertices: &[DVec3], flaws: &mut Flaws) -> (Vec<[u32; 3]>, Vec<[DVec2; 3]>) {
    let (mut out, mut uvs) = (Vec::new(), Vec::new());
    let mut rest = mesh.indices.as_slice();
    let mut places = mesh.texcoord_indices.as_slice();
    let uv = |i: u32| DVec2::new(mesh.texcoords[2 * i as usize], mesh.texcoords[2 * i as usize + 1]);
    // one corner without coordinates, and the mesh has none
    let mut placed = true;
    // if there are no arities at all, every face is a triangle
    let mut arities = mesh.face_arities.iter().map(|&n| n as usize);
    let mut corners: Vec<DVec3> = vec![];
    while !rest.is_empty() {
        let (polygon, tail) = rest.split_at(arities.next().unwrap_or(3).min(rest.len()));
        rest = tail;
        let (place, tail) = places.split_at(polygon.len());
        places = tail;
        corners.clear();
        corners.extend(polygon.iter().map(|&i| vertices[i as usize]));
        let mut add = |t: [usize; 3]| {
            if flat(t.map(|i| corners[i])) {
                flaws.flat += 1;
                return;
            }
            out.push(t.map(|i| polygon[i]));
            if placed {
                let new = t.map(|i| uv(place[i]));
                placed = !new.iter().any(|uv| uv.is_nan());
                uvs.push(new);
            }
        };
        if polygon.len() == 3 {
            add([0, 1, 2]);
            continue;
        }
        let cut = polygon::cut(&corners);
        cut.triangles.into_iter().for_each(add);
        flaws.crossed += usize::from(cut.crossed);
    }
    (out, if placed { uvs } else { Vec::new() })
}
