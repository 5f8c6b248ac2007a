//! MTL (Wavefront Technologies, The Advanced Visualizer): of each material the diffuse albedo `Kd` and the emitted radiance `Ke`, with their lines.
//!
//! `Ka` is kept only to explain a dark scene; what else would change the picture is remembered as ignored.

use crate::scene::SceneError;
use glam::DVec3;
use std::path::Path;

/// One statement of an OBJ or MTL file.
pub(super) struct Statement {
    /// 1-based line it starts on.
    pub(super) line: usize,
    /// First word.
    pub(super) key: String,
    /// The rest, trimmed.
    pub(super) rest: String,
}

impl Statement {
    /// The words up to a comment.
    pub(super) fn words(&self) -> impl Iterator<Item = &str> {
        self.rest.split('#').next().unwrap_or("").split_whitespace()
    }
}

/// The statements of a file; a backslash at the end of a line continues it.
pub(super) fn statements(text: &str) -> Vec<Statement> {
    let mut out = Vec::new();
    let mut pending: Option<(usize, String)> = None;
    for (i, line) in text.lines().enumerate() {
        let (start, mut joined) = pending.take().unwrap_or((i + 1, String::new()));
        if let Some(head) = line.trim_end().strip_suffix('\\') {
            joined.push_str(head);
            joined.push(' ');
            pending = Some((start, joined));
            continue;
        }
        joined.push_str(line);
        push(&mut out, start, &joined);
    }
    if let Some((start, joined)) = pending {
        push(&mut out, start, &joined);
    }
    out
}

fn push(out: &mut Vec<Statement>, line: usize, text: &str) {
    let text = text.trim();
    let (key, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    if !key.is_empty() && !key.starts_with('#') {
        out.push(Statement { line, key: key.to_owned(), rest: rest.trim().to_owned() });
    }
}

/// What an MTL file says of one material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) diffuse: Option<DVec3>,
    pub(super) emission: Option<DVec3>,
    pub(super) ambient: Option<DVec3>,
    /// Statements that would change the picture if they could be transported.
    pub(super) ignored: Vec<String>,
}

/// Parses MTL text; `file` is only named in messages.
pub(super) fn parse(text: &str, file: &Path) -> Result<Vec<Entry>, SceneError> {
    let mut entries: Vec<Entry> = Vec::new();
    for s in statements(text) {
        let at = |e: SceneError| e.at(file, s.line).key(s.key.clone());
        if s.key == "newmtl" {
            if s.rest.is_empty() {
                return Err(at(SceneError::new("newmtl needs a name").help("write newmtl NAME")));
            }
            entries.push(Entry { name: s.rest.clone(), ..Entry::default() });
            continue;
        }
        if !["Kd", "Ke", "Ka", "Ks", "d", "Tr", "map_Kd", "map_Ke", "map_d"].contains(&s.key.as_str()) {
            continue;
        }
        let Some(m) = entries.last_mut() else {
            return Err(at(
                SceneError::new(format!("{} before the first newmtl", s.key)).help("start with newmtl NAME")
            ));
        };
        let at = |e: SceneError| e.at(file, s.line).key(format!("{}.{}", m.name, s.key));
        match s.key.as_str() {
            "Kd" => {
                let rgb = rgb(&s).map_err(at)?;
                if let Some(x) = rgb.to_array().into_iter().find(|x| !(0.0..=1.0).contains(x)) {
                    let e = SceneError::new(format!("reflectance {x} is outside [0, 1]"));
                    return Err(at(e.help("a surface returns at most what it receives: lower Kd")));
                }
                m.diffuse = Some(rgb);
            }
            "Ke" => {
                let rgb = rgb(&s).map_err(at)?;
                if let Some(x) = rgb.to_array().into_iter().find(|x| !(0.0..=1e30).contains(x)) {
                    let e = SceneError::new(format!("emission {x} is outside [0, 1e30]"));
                    return Err(at(e.help("Ke is the radiance leaving the front")));
                }
                m.emission = Some(rgb);
            }
            "Ka" => m.ambient = rgb(&s).ok(),
            "Ks" if rgb(&s).is_ok_and(|x| x == DVec3::ZERO) => {}
            "d" if first(&s) == Some(1.0) => {}
            "Tr" if first(&s) == Some(0.0) => {}
            _ => m.ignored.push(format!("{} {}", s.key, s.rest)),
        }
    }
    Ok(entries)
}

fn first(s: &Statement) -> Option<f64> {
    s.words().next()?.parse().ok()
}

/// Three finite numbers; one stands for three.
fn rgb(s: &Statement) -> Result<DVec3, SceneError> {
    let fail = || SceneError::new(format!("`{} {}` is not a colour", s.key, s.rest)).help("write three finite numbers");
    let numbers = s.words().map(str::parse).collect::<Result<Vec<f64>, _>>().map_err(|_| fail())?;
    match numbers[..] {
        [x] if x.is_finite() => Ok(DVec3::splat(x)),
        [r, g, b] if r.is_finite() && g.is_finite() && b.is_finite() => Ok(DVec3::new(r, g, b)),
        _ => Err(fail()),
    }
}
