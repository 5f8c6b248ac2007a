//! Parser of MTL files (Wavefront Technologies, The Advanced Visualizer): the statements about each material.
//!
//! [`mtl_surface`](super::mtl_surface) converts them to a surface. `Ka` is kept only to explain a dark scene. Other
//! statements that would change the image are remembered as ignored.

use super::names;
use crate::scene::SceneError;
use glam::DVec3;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// One statement of an OBJ or MTL file. Its text is that of the file, so that a file of a million lines is not copied line by line.
pub(super) struct Statement<'a> {
    /// 1-based line on which it starts.
    pub(super) line: usize,
    /// The first word.
    pub(super) key: Cow<'a, str>,
    /// The rest of the line, trimmed.
    pub(super) rest: Cow<'a, str>,
}

impl<'a> Statement<'a> {
    /// The statement of a line; none if the line is empty or a comment.
    fn of(line: usize, text: &'a str) -> Option<Self> {
        let text = text.trim();
        let (key, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        if key.is_empty() || key.starts_with('#') {
            return None;
        }
        let rest = rest.trim();
        let rest = if rest.contains('\t') { rest.replace('\t', " ").into() } else { rest.into() };
        Some(Self { line, key: key.into(), rest })
    }

    /// The same with a text of its own.
    fn owned<'b>(self) -> Statement<'b> {
        let own = |text: Cow<'_, str>| Cow::Owned(text.into_owned());
        Statement { line: self.line, key: own(self.key), rest: own(self.rest) }
    }

    /// The words before a comment.
    pub(super) fn words(&self) -> impl Iterator<Item = &str> {
        self.rest.split('#').next().unwrap_or("").split_whitespace()
    }
}

/// The statements of a file. A backslash at the end of a line continues the statement on the next line.
pub(super) fn statements(text: &str) -> Vec<Statement<'_>> {
    let mut out = Vec::new();
    let mut pending: Option<(usize, String)> = None;
    for (i, line) in text.lines().enumerate() {
        match (line.trim_end().strip_suffix('\\'), pending.take()) {
            (Some(head), before) => {
                let (start, joined) = before.unwrap_or((i + 1, String::new()));
                pending = Some((start, joined + head + " "));
            }
            (None, Some((start, joined))) => out.extend(Statement::of(start, &(joined + line)).map(Statement::owned)),
            (None, None) => out.extend(Statement::of(i + 1, line)),
        }
    }
    if let Some((start, joined)) = pending {
        out.extend(Statement::of(start, &joined).map(Statement::owned));
    }
    out
}

/// The statements of an MTL file about one material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::scene) struct Entry {
    pub(super) name: String,
    /// `Kd`
    pub(super) diffuse: Option<DVec3>,
    /// `Ke`
    pub(super) emission: Option<DVec3>,
    /// `Ka`
    pub(super) ambient: Option<DVec3>,
    /// `Ks`
    pub(super) specular: Option<DVec3>,
    /// `Tf`
    pub(super) filter: Option<DVec3>,
    /// `Ns`
    pub(in crate::scene) exponent: Option<f64>,
    /// `Ni`
    pub(in crate::scene) ior: Option<f64>,
    /// `d`
    pub(super) opacity: Option<f64>,
    /// `Tr`
    pub(super) transparency: Option<f64>,
    /// `illum`
    pub(super) illum: Option<u32>,
    /// `map_Kd`
    pub(super) texture: Option<Texture>,
    /// Statements that would change the image but are ignored.
    pub(super) ignored: Vec<String>,
    /// The first statement that cannot be read: an error where the material is used.
    pub(super) fault: Option<SceneError>,
}

/// A `map_Kd` and the place of its statement.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct Texture {
    pub(super) path: PathBuf,
    pub(super) options: String,
    pub(super) mtl: PathBuf,
    pub(super) line: usize,
}

/// Statements that are read.
const READ: [&str; 11] = ["Kd", "Ke", "Ka", "Ks", "Tf", "Ns", "Ni", "d", "Tr", "illum", "map_Kd"];
/// Statements that change no image: `Km` and `sharpness` concern reflected images of other programs, and `map_aat` their filter.
const HARMLESS: [&str; 4] = ["Km", "sharpness", "map_aat", "map_Ka"];

/// Parses MTL text. Messages name `file`, and paths of images are relative to its folder.
pub(super) fn parse(text: &str, file: &Path) -> Result<Vec<Entry>, SceneError> {
    let mut entries: Vec<Entry> = Vec::new();
    for s in statements(text) {
        let at = |e: SceneError| e.at(file, s.line).key(s.key.clone());
        if s.key == "newmtl" {
            if s.rest.is_empty() {
                return Err(at(SceneError::new("newmtl needs a name").help("write newmtl NAME")));
            }
            names::check(&s.rest, "material").map_err(|f| at(SceneError::new(f.what).help(f.help)))?;
            entries.push(Entry { name: s.rest.to_string(), ..Entry::default() });
            continue;
        }
        if HARMLESS.contains(&&*s.key) {
            continue;
        }
        if entries.is_empty() && !READ.contains(&&*s.key) {
            continue;
        }
        let Some(m) = entries.last_mut() else {
            return Err(at(
                SceneError::new(format!("{} comes before the first newmtl", s.key)).help("start with newmtl NAME")
            ));
        };
        let key = format!("{}.{}", m.name, s.key);
        if let Err(e) = state(m, &s, file) {
            m.fault.get_or_insert(e.at(file, s.line).key(key));
        }
    }
    Ok(entries)
}

/// Reads one statement about the material `m`.
fn state(m: &mut Entry, s: &Statement, file: &Path) -> Result<(), SceneError> {
    match &*s.key {
        "Kd" => {
            m.diffuse =
                Some(rgb(s, "reflectance", 1.0, "a surface cannot reflect more light than it receives: lower Kd")?)
        }
        "Ke" => m.emission = Some(rgb(s, "emission", 1e30, "Ke is the radiance leaving the front")?),
        "Ka" => m.ambient = rgb(s, "Ka", f64::MAX, "").ok(),
        "Ks" => m.specular = Some(rgb(s, "Ks", 1e30, "write Ks as an albedo of at least 0")?),
        "Tf" => m.filter = rgb(s, "Tf", f64::MAX, "").ok(),
        "Ns" => m.exponent = Some(number(s, f64::MAX)?),
        "Ni" => m.ior = Some(number(s, f64::MAX)?),
        "d" => m.opacity = Some(number(s, 1.0)?),
        "Tr" => m.transparency = Some(number(s, 1.0)?),
        "illum" => m.illum = Some(number(s, 10.0)? as u32),
        "map_Kd" => m.texture = texture(s, file),
        _ => {
            let known = READ.iter().find(|k| k.eq_ignore_ascii_case(&s.key));
            let hint = known.map_or(String::new(), |k| format!(" (did you mean {k}?)"));
            m.ignored.push(format!("{} {}{hint}", s.key, s.rest));
        }
    }
    Ok(())
}

/// A number in [0, most].
fn number(s: &Statement, most: f64) -> Result<f64, SceneError> {
    let word = s.words().find(|w| *w != "-halo");
    let x = word.and_then(|w| w.parse().ok()).filter(|x| (0.0..=most).contains(x));
    let upper = if most < 1e6 { format!(" to {most}") } else { " on".into() };
    let help = format!("write a number from 0{upper}");
    x.ok_or_else(|| SceneError::new(format!("`{} {}` is not a number from 0{upper}", s.key, s.rest)).help(help))
}

/// Three numbers in [0, most]; a single number is used for all three.
fn rgb(s: &Statement, name: &str, most: f64, help: &str) -> Result<DVec3, SceneError> {
    let fail = || SceneError::new(format!("`{} {}` is not a colour", s.key, s.rest)).help("write three finite numbers");
    let numbers = s.words().map(str::parse).collect::<Result<Vec<f64>, _>>().map_err(|_| fail())?;
    let rgb = match numbers[..] {
        [x] if x.is_finite() => DVec3::splat(x),
        [r, g, b] if r.is_finite() && g.is_finite() && b.is_finite() => DVec3::new(r, g, b),
        _ => return Err(fail()),
    };
    match rgb.to_array().into_iter().find(|x| !(0.0..=most).contains(x)) {
        Some(x) if most < 1e6 => Err(SceneError::new(format!("{name} {x} is outside [0, {most}]")).help(help)),
        Some(x) => Err(SceneError::new(format!("{name} {x} is outside [0, {most:e}]")).help(help)),
        None => Ok(rgb),
    }
}

/// The options of `map_Kd` with the number of words that follow each. Those with 3 take one to three numbers.
const OPTIONS: [(&str, usize); 14] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-bm", 1),
    ("-boost", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-colorspace", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-texres", 1),
    ("-type", 1),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
];

/// Parses `map_Kd [options] name`; the name may contain spaces.
fn texture(s: &Statement, file: &Path) -> Option<Texture> {
    let (mut rest, mut options) = (s.rest.split(" #").next().unwrap_or("").trim(), Vec::new());
    while let Some(&(_, words)) = OPTIONS.iter().find(|(o, _)| rest.split_whitespace().next() == Some(o)) {
        for i in 0..=words {
            let (word, tail) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            if i > 1 && words == 3 && word.parse::<f64>().is_err() {
                break;
            }
            options.push(word);
            rest = tail.trim_start();
        }
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    // names written on Windows use backslashes
    let path = [rest.to_owned(), rest.replace('\\', "/")].map(|name| folder.join(name));
    let [written, slashed] = path;
    let path = if written.is_file() { written } else { slashed };
    (!rest.is_empty()).then(|| Texture { path, options: options.join(" "), mtl: file.to_owned(), line: s.line })
}
