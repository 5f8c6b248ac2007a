//! Strict reading of a scene file. A cursor is one value of the file together with its dotted key. Each method asks the
//! value for exactly one type.
//!
//! Every error names the value, the file and line (or the override) and the key, and says what to do.

use super::tree::{Node, Place, Value};
use crate::math::names::suggest;
use crate::scene::SceneError;
use glam::{DVec2, DVec3};
use std::path::{Path, PathBuf};

/// Positions and lengths must be below 1e12 m in absolute value, so that their squares fit the `f32` of the rays.
pub(super) const LARGEST_LENGTH: f64 = 1e12;
/// Smallest length of an edge or a direction, m, for the same reason as [`LARGEST_LENGTH`].
pub(super) const SMALLEST_LENGTH: f64 = 1e-12;
/// Largest allowed radiance or power. It fits `f32` and leaves room for the weights of a path.
pub(super) const LARGEST_LIGHT: f64 = 1e30;
/// Largest allowed texture coordinate, in repeats of the image. `f32` then still resolves a hundredth of the image.
pub(super) const LARGEST_UV: f64 = 1e5;

/// A value of the scene file with its dotted key.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    pub(super) file: &'a Path,
    pub(super) key: String,
    pub(super) node: &'a Node,
}

impl<'a> Cursor<'a> {
    /// An error at this value.
    pub fn error(&self, what: impl Into<String>) -> SceneError {
        let overridden = matches!(&self.node.value, Value::List(l) if l.iter().any(|n| n.place == Place::Override));
        match self.node.place {
            _ if overridden => SceneError::new(what).key(format!("--set {}", self.key)),
            Place::Line(line) if self.key.is_empty() => SceneError::new(what).at(self.file, line),
            Place::Line(line) => SceneError::new(what).at(self.file, line).key(&self.key),
            Place::Override => SceneError::new(what).key(format!("--set {}", self.key)),
            Place::Program => SceneError::new(what).file(self.file).key(&self.key),
        }
    }

    fn mistyped(&self, wanted: &str) -> SceneError {
        let help = format!("write {wanted}");
        self.error(format!("expected {wanted}, found {}", self.node.value.kind())).help(help)
    }

    fn join(&self, key: &str) -> String {
        if self.key.is_empty() { key.to_owned() } else { format!("{}.{key}", self.key) }
    }

    /// The entries of a table.
    pub fn entries(&self) -> Result<Vec<(&'a str, Cursor<'a>)>, SceneError> {
        let Value::Table(t) = &self.node.value else { return Err(self.mistyped("a table")) };
        Ok(t.iter().map(|(k, node)| (k.as_str(), Cursor { file: self.file, key: self.join(k), node })).collect())
    }

    /// Returns an error for the first key of a table that is not one of `legal`.
    pub fn only(&self, legal: &[&str]) -> Result<(), SceneError> {
        match self.entries()?.iter().find(|(k, _)| !legal.contains(k)) {
            Some((k, c)) => Err(c.error(format!("unknown key `{k}`")).help(suggest(k, "keys here", legal))),
            None => Ok(()),
        }
    }

    /// The value of a key; `None` if the key is missing.
    pub fn get(&self, key: &str) -> Option<Cursor<'a>> {
        self.node.get(key).map(|node| Cursor { file: self.file, key: self.join(key), node })
    }

    /// The value of a required key; `example` says what to add if it is missing.
    pub fn require(&self, key: &str, example: &str) -> Result<Cursor<'a>, SceneError> {
        self.get(key).ok_or_else(|| {
            let here = Cursor { key: self.join(key), ..self.clone() };
            here.error(format!("missing key `{key}`")).help(format!("add {example}"))
        })
    }

    /// The elements of an array.
    pub fn items(&self, wanted: &str) -> Result<Vec<Cursor<'a>>, SceneError> {
        let Value::List(l) = &self.node.value else { return Err(self.mistyped(wanted)) };
        let item = |(i, node)| Cursor { file: self.file, key: format!("{}[{i}]", self.key), node };
        Ok(l.iter().enumerate().map(item).collect())
    }

    fn several<const N: usize>(&self, wanted: &str) -> Result<[Cursor<'a>; N], SceneError> {
        let items = self.items(wanted)?;
        let found = items.len();
        items.try_into().map_err(|_| {
            self.error(format!("expected {wanted}, found {found}")).help(format!("write {N} values in brackets"))
        })
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64, SceneError> {
        let x = match self.node.value {
            Value::Integer(i) => i as f64,
            Value::Float(x) => x,
            _ => return Err(self.mistyped("a number")),
        };
        if x.is_finite() { Ok(x) } else { Err(self.error(format!("{x} is not finite")).help("write a finite number")) }
    }

    /// A length in metres, at most 1e12 in absolute value.
    pub fn length(&self) -> Result<f64, SceneError> {
        let x = self.number()?;
        if x.abs() <= LARGEST_LENGTH {
            return Ok(x);
        }
        Err(self.error(format!("{x:e} m is too large for single-precision rays")).help("stay within 1e12 m"))
    }

    /// An integer in `[low, high]`.
    pub fn integer(&self, low: i64, high: i64) -> Result<i64, SceneError> {
        let Value::Integer(i) = self.node.value else { return Err(self.mistyped("an integer")) };
        if (low..=high).contains(&i) {
            return Ok(i);
        }
        Err(self
            .error(format!("{i} is outside [{low}, {high}]"))
            .help(format!("write an integer from {low} to {high}")))
    }

    /// `true` or `false`.
    pub fn flag(&self) -> Result<bool, SceneError> {
        if let Value::Flag(b) = self.node.value { Ok(b) } else { Err(self.mistyped("true or false")) }
    }

    /// A string that is not empty.
    pub fn text(&self) -> Result<&'a str, SceneError> {
        match &self.node.value {
            Value::Text(s) if s.trim().is_empty() => Err(self.error("the string is empty").help("write some text")),
            Value::Text(s) => Ok(s),
            _ => Err(self.mistyped("a string")),
        }
    }

    /// The value that belongs to one of a few known words.
    pub fn choice<T: Copy>(&self, kind: &str, known: &[(&str, T)]) -> Result<T, SceneError> {
        let word = self.text()?;
        known.iter().find(|(k, _)| *k == word).map(|&(_, v)| v).ok_or_else(|| {
            let names: Vec<&str> = known.iter().map(|(k, _)| *k).collect();
            self.error(format!("`{word}` is not a {kind}")).help(suggest(word, "known here", &names))
        })
    }

    /// A pair of numbers.
    pub fn pair(&self) -> Result<[f64; 2], SceneError> {
        let [a, b] = self.several("2 numbers")?;
        Ok([a.number()?, b.number()?])
    }

    /// Width and height in pixels.
    pub fn size(&self) -> Result<[u32; 2], SceneError> {
        let [w, h] = self.several("2 integers")?;
        let pixels = |c: Cursor| Ok(c.integer(1, 32768)?.unsigned_abs() as u32);
        Ok([pixels(w)?, pixels(h)?])
    }

    /// A position, an edge or a direction, metres.
    pub fn vector(&self) -> Result<DVec3, SceneError> {
        let [x, y, z] = self.several("3 numbers")?;
        Ok(DVec3::new(x.length()?, y.length()?, z.length()?))
    }

    /// A row of a transform: four numbers.
    pub fn row(&self) -> Result<[f64; 4], SceneError> {
        let [a, b, c, d] = self.several("4 numbers")?;
        Ok([a.length()?, b.length()?, c.length()?, d.length()?])
    }

    /// The three rows of a transform.
    pub fn rows(&self) -> Result<[Cursor<'a>; 3], SceneError> {
        self.several("3 rows of 4 numbers")
    }

    /// The three vertex indices of a face, each below `count`.
    pub fn face(&self, count: usize) -> Result<[u32; 3], SceneError> {
        let corners = self.several::<3>("3 vertex indices")?;
        let mut face = [0; 3];
        for (out, c) in face.iter_mut().zip(corners) {
            let i = c.integer(i64::MIN, i64::MAX)?;
            *out = u32::try_from(i).ok().filter(|&i| (i as usize) < count).ok_or_else(|| {
                self.error(format!("vertex index {i} is out of range, the mesh has {count} vertices"))
                    .help("indices start at 0")
            })?;
        }
        Ok(face)
    }

    /// A number in `[low, high]`.
    pub fn within(&self, name: &str, low: f64, high: f64) -> Result<f64, SceneError> {
        let x = self.number()?;
        if (low..=high).contains(&x) {
            return Ok(x);
        }
        let most = if high < 1e6 { high.to_string() } else { format!("{high:e}") };
        Err(self.error(format!("{name} {x} is outside [{low}, {most}]")).help(format!("stay within {low} and {most}")))
    }

    /// The real or imaginary part of a complex index of refraction, per channel, each in `[low, 100]`.
    pub fn index(&self, name: &str, low: f64) -> Result<DVec3, SceneError> {
        let rgb = self.colour()?;
        match rgb.to_array().into_iter().find(|x| !(low..=100.0).contains(x)) {
            Some(x) => Err(self
                .error(format!("{name} {x} is outside [{low}, 100]"))
                .help("the index of refraction of the metal is eta + i k, measured at red, green and blue")),
            None => Ok(rgb),
        }
    }

    /// A texture coordinate.
    pub fn uv(&self) -> Result<DVec2, SceneError> {
        let uv = DVec2::from(self.pair()?);
        if uv.abs().max_element() <= LARGEST_UV {
            return Ok(uv);
        }
        Err(self
            .error(format!("the texture coordinate {uv} is too large"))
            .help("stay within 1e5 repeats of the image"))
    }

    /// Returns true if the value is a string.
    pub fn is_text(&self) -> bool {
        matches!(self.node.value, Value::Text(_))
    }

    /// Moves an error found in a file that this value names to the place of this value.
    pub fn place(&self, e: SceneError) -> SceneError {
        self.error(e.what).help(e.help.unwrap_or_default())
    }

    /// The albedo of a surface per channel, each in [0, 1].
    pub fn reflectance(&self) -> Result<DVec3, SceneError> {
        self.albedo("reflectance")
    }

    /// An albedo per channel, each in [0, 1].
    pub fn albedo(&self, name: &str) -> Result<DVec3, SceneError> {
        let rgb = self.colour()?;
        match rgb.to_array().into_iter().find(|x| !(0.0..=1.0).contains(x)) {
            Some(x) => Err(self.error(format!("{name} {x} is outside [0, 1]")).help(
                "a surface cannot reflect more light than it receives, otherwise the Neumann series may diverge",
            )),
            None => Ok(rgb),
        }
    }

    /// Radiance or power per channel, none negative.
    pub fn light(&self, name: &str) -> Result<DVec3, SceneError> {
        let rgb = self.colour()?;
        match rgb.to_array().into_iter().find(|x| !(0.0..=LARGEST_LIGHT).contains(x)) {
            Some(x) if x < 0.0 => Err(self.error(format!("{name} {x} is negative")).help("light is at least 0")),
            Some(x) => Err(self.error(format!("{name} {x:e} is too large")).help("stay below 1e30")),
            None => Ok(rgb),
        }
    }

    fn colour(&self) -> Result<DVec3, SceneError> {
        let [r, g, b] = self.several("3 numbers")?;
        Ok(DVec3::new(r.number()?, g.number()?, b.number()?))
    }
}

/// The path `path` as written in `file`, relative to the folder of that file.
pub(super) fn beside(file: &Path, path: &str) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(path)
}
