//! Errors for scenes that do not exist: the nearest scene, and a list of those that do exist.

use crate::math::names::{list, similar};
use crate::scene::{SceneError, builtin};
use std::path::{Path, PathBuf};

/// The error for a name that is neither a built-in scene nor the name of a scene file.
pub(super) fn name(name: &str) -> SceneError {
    let what = format!("`{name}` is neither a built-in scene nor a .toml or .obj file");
    let file = ["toml", "obj"].map(|e| format!("{name}.{e}")).into_iter().find(|f| Path::new(f).is_file());
    let near = file.or_else(|| similar(name, builtin::names().iter().copied()).first().map(ToString::to_string));
    SceneError::new(what).help(question(near) + &scenes())
}

/// The error for a scene file that does not exist: says which folder was searched.
pub(super) fn file(path: &Path) -> SceneError {
    let name = |p: &Path| p.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let error = SceneError::new(format!("the file `{}` does not exist", name(path))).file(path);
    let Ok(searched) = folder.canonicalize() else {
        return error.help(format!("there is no folder `{}`; {}", folder.display(), scenes()));
    };
    let stem = path.file_stem().map_or(String::new(), |s| s.to_string_lossy().into_owned());
    let files: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_or(vec![], |all| all.flatten().map(|f| f.path()).filter(|f| is_scene_file(f)).collect());
    let files: Vec<String> = files.iter().map(|f| name(f)).collect();
    let near = similar(&name(path), files.iter().map(String::as_str)).first().map(|f| folder.join(f));
    let near = near.map(|f| f.strip_prefix(".").unwrap_or(&f).display().to_string());
    let near = near.or_else(|| similar(&stem, builtin::names().iter().copied()).first().map(ToString::to_string));
    error.help(format!("{}the folder searched is {}; {}", question(near), searched.display(), scenes()))
}

/// Returns true if the path has the extension of a scene file: `.toml` or `.obj`.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml") || e.eq_ignore_ascii_case("obj"))
}

fn question(near: Option<String>) -> String {
    near.map_or(String::new(), |n| format!("did you mean `{n}`? "))
}

fn scenes() -> String {
    format!("built-in scenes: {}", list(builtin::names()))
}
