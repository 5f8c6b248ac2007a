//! From a name on the command line to plain data: a built-in scene, a `.toml`, or a bare `.obj`.
//!
//! ```text
//! text ─► tree (values with their lines) ─► overrides ─► strict reading ─► Description
//! ```
//!
//! `scenes/README.md` documents every key. Nothing is repaired in silence: what a scene cannot mean is a
//! [`SceneError`] with its line and key, what a file of other origin says beyond that is a warning.

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
mod obj;
mod obj_check;
mod overrides;
mod shapes;
mod toml;
mod tree;

pub use cursor::Cursor;
use cursor::beside;
pub use mtl_material::MtlMaterial;

use super::{Description, SceneError, builtin, stand_in};
use crate::math::names::suggest;
use glam::DVec3;
use std::path::Path;
use tree::{Node, Place, Value};

/// What the command line changes in a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// `KEY=VALUE`: replaces a value of the file, as in `materials.white.reflectance=[0.7, 0.7, 0.7]`.
    pub set: Vec<String>,
    /// `MATERIAL=r,g,b`: every shape of that material emits this radiance from its front.
    pub emit: Vec<String>,
    /// Every surface Lambertian, of one colour ([`stand_in`]).
    pub lambertian: bool,
}

/// A scene that has been read and found sound.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The scene as plain data.
    pub description: Description,
    /// What was left out or guessed; each worth a line on stderr.
    pub warnings: Vec<String>,
    /// The description as text: equal scenes have equal text whatever file they came from. Made to be hashed.
    pub canonical: String,
}

/// Loads a built-in scene, a `.toml` or a bare `.obj`, with overrides.
///
/// # Errors
/// Whatever is wrong with the name, the file, the overrides or the scene.
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

/// A scene from TOML text. `file` stands in messages, and paths in the text are relative to its folder.
///
/// # Errors
/// Whatever is wrong with the text, the files it names or the overrides.
pub fn toml(text: &str, file: &Path, options: &Options) -> Result<Loaded, SceneError> {
    let mut root = tree::parse(text, file)?;
    options.set.iter().try_for_each(|s| overrides::apply(&mut root, s))?;
    finish(toml::read(&root, file, false)?, file, options)
}

/// A bare OBJ is the scene file someone did not have to write; the camera frames what it shows.
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

/// What reading a file yields: the scene, warnings, and hints for whoever finds it dark.
struct Draft {
    description: Description,
    warnings: Vec<String>,
    hints: Vec<String>,
}

fn finish(mut draft: Draft, file: &Path, options: &Options) -> Result<Loaded, SceneError> {
    let scene = &mut draft.description;
    options.emit.iter().try_for_each(|e| emit(scene, e))?;
    if scene.shapes.iter().all(|s| s.emission == DVec3::ZERO) && scene.lights.iter().all(lights::dark) {
        let names = in_use(scene);
        let lamp = names.iter().find(|n| n.to_lowercase().contains("light")).or(names.first()).copied();
        let general = format!(
            "write `emission` on a shape, a light in [[lights]], Ke in an MTL, or pass --emit {}=1,1,1",
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

/// Names of the materials that some shape has.
fn in_use(scene: &Description) -> Vec<&str> {
    let mut names: Vec<&str> = scene.shapes.iter().map(|s| scene.materials[s.material].name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// `MATERIAL=r,g,b`
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
        return Err(fail(format!("no shape has a material `{name}`"), &help));
    }
    lit.for_each(|s| s.emission = radiance);
    Ok(())
}

/// The text of a file.
fn read(path: &Path) -> Result<String, SceneError> {
    let bytes = bytes(path)?;
    String::from_utf8(bytes).map_err(|e| {
        let line = 1 + e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        SceneError::new("the file is not UTF-8 text").at(path, line).help("save it as UTF-8")
    })
}

/// The text of a file whose comments may be in any old encoding.
fn read_lossy(path: &Path) -> Result<String, SceneError> {
    bytes(path).map(|b| String::from_utf8_lossy(&b).trim_start_matches('\u{feff}').to_owned())
}

fn bytes(path: &Path) -> Result<Vec<u8>, SceneError> {
    std::fs::read(path).map_err(|e| {
        SceneError::new(format!("cannot read the file: {e}")).file(path).help("check the path and its permissions")
    })
}
