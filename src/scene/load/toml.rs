//! Reading of the scene file as a whole: its tables, and the closed-form values in `[expect]`.

use super::{Draft, camera, cursor::Cursor, lights, materials, names, shapes, tree::Node};
use crate::scene::centre::{Centred, TOO_COARSE};
use crate::scene::{Description, SceneError, description::Expect};
use glam::DVec3;
use std::path::Path;

pub(super) const ROOT_KEYS: [&str; 6] = ["name", "camera", "materials", "shapes", "lights", "expect"];
pub(super) const EXPECT_KEYS: [&str; 5] = ["terms", "gamma", "total", "tolerance", "source"];

/// Reads a whole scene. With `framed`, the file may omit the camera's position, and the camera is placed so that the shapes
/// fill the frame.
pub(super) fn read(root: &Node, file: &Path, framed: bool) -> Result<Draft, SceneError> {
    let c = Cursor { file, key: String::new(), node: root };
    c.only(&ROOT_KEYS)?;
    let name = name(&c, file)?;
    let camera = c.require("camera", "a [camera] table with origin, target, up, fov and size")?;
    let materials = match c.get("materials") {
        Some(table) => table.entries()?.iter().map(|(k, c)| materials::read(k, c)).collect::<Result<_, _>>()?,
        None => Vec::new(),
    };
    let example = "a [[shapes]] table with type and material";
    let list = c.require("shapes", example)?;
    let read = shapes::read(&list, materials)?;
    if read.shapes.is_empty() {
        return Err(list.error("the scene has no shapes").help(format!("add {example}")));
    }
    let bounds = framed.then(|| bounds(&read.shapes));
    let camera = camera::read(&camera, bounds)?;
    let lights = c.get("lights").map_or(Ok(Vec::new()), |c| lights::read(&c))?;
    let expect = c.get("expect").map(|c| expect(&c)).transpose()?;
    let shapes::Read { shapes, materials, warnings, hints, places } = read;
    let description = Description { name, camera, materials, shapes, lights, expect };
    precise(&description, &places)?;
    Ok(Draft { description, warnings, hints })
}

/// Returns an error if single precision would deform a shape too much.
fn precise(scene: &Description, places: &[SceneError]) -> Result<(), SceneError> {
    let Centred { scene: centred, .. } = scene.centred();
    let Some(worst) = centred.coarsest(DVec3::ZERO).filter(|w| w.share() > TOO_COARSE) else { return Ok(()) };
    let name = &scene.shapes[worst.shape].name;
    let what = format!(
        "{name} is too small for its distance from the middle of the scene: single precision moves its points by {:.1e} m, and its smallest height is {:.1e} m",
        worst.moved, worst.height
    );
    let help =
        "move the scene's parts closer together or enlarge this one: points may move by a ten-thousandth of its height";
    Err(SceneError { what, ..places[worst.shape].clone() }.help(help))
}

/// The name of the scene, which is also the name of a folder: it has no separators and is not `.` or `..`. Without `name`,
/// it is the name of the file.
fn name(c: &Cursor, file: &Path) -> Result<String, SceneError> {
    let Some(at) = c.get("name") else {
        let stem = file.file_stem().map_or("scene".into(), |s| s.to_string_lossy().into_owned());
        let unfit =
            |f: names::Fault| SceneError::new(f.what).file(file).help("give the scene a name of its own: name = \"…\"");
        return names::check_scene(&stem).map_err(unfit).map(|()| stem);
    };
    let name = at.text()?;
    names::check_scene(name).map_err(|f| at.error(f.what).help(f.help))?;
    if [".", ".."].contains(&name) || name.contains(|c: char| "/\\:".contains(c) || c.is_control()) {
        let e = at.error(format!("the scene name `{}` cannot be used for the output folder", name.escape_debug()));
        return Err(e.help("use letters, digits, spaces, - and _"));
    }
    Ok(name.to_owned())
}

fn expect(c: &Cursor) -> Result<Expect, SceneError> {
    c.only(&EXPECT_KEYS)?;
    let at = c.require("terms", "the image means of T^k E: terms = [1, 0.5, 0.25]")?;
    let items = at.items("an array of numbers")?;
    if items.is_empty() {
        return Err(at.error("terms is empty").help("write at least the image mean of E"));
    }
    let nonnegative = |c: &Cursor| {
        let x = c.number()?;
        if x < 0.0 { Err(c.error(format!("{x} is negative")).help("light is at least 0")) } else { Ok(x) }
    };
    let terms = items.iter().map(nonnegative).collect::<Result<Vec<f64>, _>>()?;
    let gamma = c.get("gamma").map(|c| nonnegative(&c)).transpose()?;
    let total = c.get("total").map(|c| nonnegative(&c)).transpose()?;
    let (sum, last) = (terms.iter().sum::<f64>(), terms.last().copied().unwrap_or(0.0));
    if let Some(at) = c.get("gamma") {
        match (gamma, total) {
            (_, Some(_)) => {
                let e = at.error("gamma and total both give the terms beyond the last one");
                return Err(e.help("leave one of them out"));
            }
            (Some(g), None) if g >= 1.0 && last > 0.0 => {
                return Err(at
                    .error(format!("with gamma = {g} the series diverges"))
                    .help("a ratio of terms is below 1"));
            }
            _ => {}
        }
    }
    if let (Some(at), Some(total)) = (c.get("total"), total)
        && total < sum * (1.0 - 1e-9)
    {
        let e = at.error(format!("the whole series, {total}, is smaller than the sum of the given terms, {sum}"));
        return Err(e.help("no term is negative; correct terms or total"));
    }
    let tolerance = match c.get("tolerance") {
        None => Expect::TOLERANCE,
        Some(at) => match at.number()? {
            x if x > 0.0 && x < 1.0 => x,
            x => return Err(at.error(format!("a tolerance of {x}")).help("a fraction between 0 and 1, such as 0.01")),
        },
    };
    let source = c.require("source", "the reference for the numbers: source = \"…\"")?.text()?.to_owned();
    Ok(Expect { terms, gamma, total, tolerance, source })
}

fn bounds(shapes: &[crate::scene::description::Shape]) -> [DVec3; 2] {
    let all = shapes.iter().flat_map(|s| s.geometry.each()).map(|p| p.bounds());
    all.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], [c, d]| [a.min(c), b.max(d)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::bsdf::register::KINDS;

    #[test]
    fn the_schema_documents_every_key() {
        let readme = include_str!("../../../scenes/README.md");
        let kinds = shapes::KINDS.iter().chain(&lights::KINDS).copied();
        let kinds = kinds.chain(KINDS.iter().map(|k| (k.name, k.keys))).chain([("type", &materials::KEYS[..])]);
        let keys: Vec<&str> = kinds.flat_map(|(kind, keys)| keys.iter().copied().chain([kind])).collect();
        let all = ROOT_KEYS.iter().chain(&EXPECT_KEYS).chain(&camera::KEYS).chain(&shapes::SHAPE_KEYS);
        for key in all.copied().chain(keys) {
            assert!(readme.contains(&format!("`{key}`")), "scenes/README.md says nothing about `{key}`");
        }
    }
}
