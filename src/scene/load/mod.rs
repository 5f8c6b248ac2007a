//! Loading: from a name on the command line to a scene as plain data. The name is a built-in scene, a `.toml` file or a bare
//! `.obj` file.
//!
//! ```text
//! text ─► tree (values with their lines) ─► overrides ─► strict reading ─► Description
//! ```
//!
//! `scenes/README.md` documents every key. Nothing is corrected silently. A scene that makes no sense is a [`SceneError`]
//! with its line and key. A statement of an OBJ or MTL file that this program cannot represent is a warning.

mod camera;
mod cursor;
mod image;
pub mod keys;
mod lights;
mod materials;
mod mesh;
mod missing;
mod mtl;
mod mtl_material;
mod mtl_surface;
mod names;
mod obj;
mod obj_check;
mod overrides;
mod polygon;
mod shapes;
mod toml;
mod tree;

pub use cursor::Cursor;
use cursor::beside;
pub use missing::is_scene_file;
pub use mtl_material::MtlMaterial;

use super::description::Geometry;
use super::wide::MOST_TRIANGLES;
use super::{Description, SceneError, builtin, stand_in};
use crate::math::names::suggest;
use glam::DVec3;
use std::path::Path;
use tree::{Node, Place, Value};

/// Changes to a scene that the command line asks for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// `KEY=VALUE`: replaces a value of the file, as in `materials.white.reflectance=[0.7, 0.7, 0.7]`.
    pub set: Vec<String>,
    /// `MATERIAL=r,g,b`: every shape of that material emits this radiance from its front.
    pub emit: Vec<String>,
    /// True if every surface is replaced by a Lambertian one of one colour ([`stand_in`]).
    pub lambertian: bool,
}

/// A scene that has been read and checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The scene as plain data.
    pub description: Description,
    /// Messages about statements that were ignored or guessed; each is printed as a line on stderr.
    pub warnings: Vec<String>,
    /// The description as text, from which the scene's hash is computed. Equal scenes have equal text, whatever file they
    /// came from.
    pub canonical: String,
}

/// Loads a built-in scene, a `.toml` file or a bare `.obj` file, and applies the options.
///
/// # Errors
/// If the name, the file, an override or the scene itself is wrong.
///
/// ```
/// use fredholm::scene::load::{Options, scene};
/// let options = Options { set: vec!["camera.fov=40".into()], ..Options::default() };
/// let cornell = scene("cornell", &options)?;
/// assert_eq!(cornell.description.camera.fov, 40.0);
/// assert!(scene("cornel", &options).unwrap_err().to_string().contains("did you mean `cornell`?"));
/// # Ok::<(), fredholm::scene::SceneError>(())
/// ```
pub fn scene(name_or_path: &str, options: &Options) -> Result<Loaded, SceneError> {
    if let Some(b) = builtin::find(name_or_path) {
        return toml(b.source, Path::new(&format!("built-in {}.toml", b.name)), options);
    }
    let path = Path::new(name_or_path);
    match path.extension().and_then(|e| e.to_str()).map(str::to_lowercase).as_deref() {
        Some("toml" | "obj") if !path.exists() => Err(missing::file(path)),
        Some("toml") => toml(&read(path)?, path, options),
        Some("obj") => bare_obj(path, options),
        _ => Err(missing::name(name_or_path)),
    }
}

/// Loads a scene from TOML text. Messages name `file`, and paths in the text are relative to its folder.
///
/// # Errors
/// If the text, a file that it names or an override is wrong.
pub fn toml(text: &str, file: &Path, options: &Options) -> Result<Loaded, SceneError> {
    let mut root = tree::parse(text, file)?;
    options.set.iter().try_for_each(|s| overrides::apply(&mut root, s))?;
    finish(toml::read(&root, file, false)?, file, options)
}

/// Loads an OBJ file without a scene file, as if there were a scene file with this one shape. The camera is placed so that
/// the shape fills the frame.
fn bare_obj(path: &Path, options: &Options) -> Result<Loaded, SceneError> {
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let shape = Node::table(vec![("type", Value::Text("obj".into())), ("file", Value::Text(file))]);
    let number = |value| Node { value, place: Place::Program };
    let size = Value::List(vec![number(Value::Integer(256)), number(Value::Integer(256))]);
    let root = Node::table(vec![
        ("camera", Node::table(vec![("fov", Value::Float(camera::FRAMED_FOV)), ("size", size)])),
        ("materials", Node::table(Vec::new())),
        ("shapes", Value::List(vec![Node { value: shape, place: Place::Program }])),
    ]);
    let mut root = Node { value: root, place: Place::Program };
    options.set.iter().try_for_each(|s| overrides::apply(&mut root, s))?;
    finish(toml::read(&root, path, true)?, path, options)
}

/// Result of reading a file: the scene, warnings, and hints that are shown if no light is found.
struct Draft {
    description: Description,
    warnings: Vec<String>,
    hints: Vec<String>,
}

fn finish(mut draft: Draft, file: &Path, options: &Options) -> Result<Loaded, SceneError> {
    let scene = &mut draft.description;
    let triangles =
        scene.shapes.iter().map(|s| if let Geometry::Mesh { faces, .. } = &s.geometry { faces.len() } else { 0 });
    few_enough(triangles.sum()).map_err(|e| e.file(file))?;
    options.emit.iter().try_for_each(|e| emit(scene, e))?;
    if scene.shapes.iter().all(|s| s.emission == DVec3::ZERO) && scene.lights.iter().all(lights::dark) {
        let names = in_use(scene);
        let lamp = names.iter().find(|n| n.to_lowercase().contains("light")).or(names.first()).copied();
        let general = format!(
            "add `emission` to a shape, a light in [[lights]] or Ke in an MTL file, or pass --emit {}=1,1,1",
            lamp.unwrap_or("MATERIAL")
        );
        let hint = draft.hints.first().unwrap_or(&general);
        let help = format!("{hint}; materials in use: {}", names.join(", "));
        return Err(SceneError::new("nothing in the scene emits light").file(file).help(help));
    }
    if options.lambertian {
        draft.description = stand_in(&draft.description);
    }
    let canonical = format!("{:?}", draft.description);
    Ok(Loaded { description: draft.description, warnings: draft.warnings, canonical })
}

/// Refuses more triangles than the tree of a scene can number.
fn few_enough(triangles: usize) -> Result<(), SceneError> {
    if triangles <= MOST_TRIANGLES {
        return Ok(());
    }
    let what = format!("the scene has {triangles} triangles; {MOST_TRIANGLES} are possible");
    Err(SceneError::new(what).help("simplify its meshes"))
}

/// Names of the materials that at least one shape uses.
fn in_use(scene: &Description) -> Vec<&str> {
    let mut names: Vec<&str> = scene.shapes.iter().map(|s| scene.materials[s.material].name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Applies `--emit MATERIAL=r,g,b`: all shapes of that material emit this radiance.
fn emit(scene: &mut Description, setting: &str) -> Result<(), SceneError> {
    let fail = |what: String, help: &str| SceneError::new(what).key(format!("--emit {setting}")).help(help);
    let form = "write MATERIAL=r,g,b with radiances of at least 0, for example --emit light=17,12,4";
    let (name, text) = setting.rsplit_once('=').ok_or_else(|| fail("no radiance is given".into(), form))?;
    let (name, text) = (name.trim(), text.trim());
    let numbers = text.split(',').map(|t| t.trim().parse()).collect::<Result<Vec<f64>, _>>().unwrap_or_default();
    let radiance = match numbers[..] {
        [r, g, b] if numbers.iter().all(|x| (0.0..=1e30).contains(x)) => DVec3::new(r, g, b),
        _ => return Err(fail(format!("`{text}` is not a radiance of three channels"), form)),
    };
    let help = suggest(name, "materials in use", &in_use(scene));
    let (shapes, materials) = (&mut scene.shapes, &scene.materials);
    let mut lit = shapes.iter_mut().filter(|s| materials[s.material].name == name).peekable();
    if lit.peek().is_none() {
        return Err(fail(format!("no shape uses a material `{name}`"), &help));
    }
    lit.for_each(|s| s.emission = radiance);
    Ok(())
}

/// The text of a UTF-8 file.
fn read(path: &Path) -> Result<String, SceneError> {
    let bytes = bytes(path)?;
    String::from_utf8(bytes).map_err(|e| {
        let line = 1 + e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        SceneError::new("the file is not UTF-8 text").at(path, line).help("save it as UTF-8")
    })
}

/// The text of a file that may not be UTF-8, as in old files with accented comments. Invalid bytes become replacement characters.
/// UTF-16 is known by its byte order mark. Lines may end with LF, CR LF, or CR alone as on old Macintosh computers.
fn read_lossy(path: &Path) -> Result<String, SceneError> {
    let bytes = bytes(path)?;
    let wide = |order: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes[2..].as_chunks().0.iter().map(|&pair| order(pair)).collect();
        String::from_utf16_lossy(&units)
    };
    let text = match bytes.get(..2) {
        Some([0xff, 0xfe]) => wide(u16::from_le_bytes),
        Some([0xfe, 0xff]) => wide(u16::from_be_bytes),
        // the usual file is not copied
        _ => String::from_utf8(bytes).unwrap_or_else(|e| String::from_utf8_lossy(e.as_bytes()).into_owned()),
    };
    let mark = text.len() - text.trim_start_matches('\u{feff}').len();
    let text = if mark > 0 { text[mark..].to_owned() } else { text };
    Ok(if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n") } else { text })
}

fn bytes(path: &Path) -> Result<Vec<u8>, SceneError> {
    if path.exists() && !path.is_file() {
        return Err(SceneError::new("this is not a file")
            .file(path)
            .help("give a file, not a folder, a pipe or a device"));
    }
    std::fs::read(path).map_err(|e| {
        SceneError::new(format!("cannot read the file: {e}")).file(path).help("check the path and its permissions")
    })
}

#[cfg(test)]
mod tests {
    use super::{MOST_TRIANGLES, few_enough};

    #[test]
    fn more_triangles_than_have_numbers_are_refused() {
        assert!(few_enough(MOST_TRIANGLES).is_ok());
        let e = few_enough(MOST_TRIANGLES + 1).expect_err("one too many").to_string();
        assert!(e.contains("134217729 triangles; 134217728 are possible"), "{e}");
    }
}
