//! A scene file as a tree of values. Each value stores its place: a line of the file, or an override.

use crate::scene::SceneError;
use std::{ops::Range, path::Path};
use toml_edit::{Document, Item, Value as Toml};

/// A value and its place.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) place: Place,
}

/// The place where a value was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// A line of the file, counted from 1.
    Line(usize),
    /// An override `--set` on the command line.
    Override,
    /// No place: the program itself created the value.
    Program,
}

/// The values of TOML that a scene can use.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Table(Vec<(String, Node)>),
    List(Vec<Node>),
    Text(String),
    Integer(i64),
    Float(f64),
    Flag(bool),
    Time,
}

impl Value {
    /// The name of this kind of value in messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Table(_) => "a table",
            Self::List(_) => "an array",
            Self::Text(_) => "a string",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a number",
            Self::Flag(_) => "a boolean",
            Self::Time => "a date",
        }
    }
}

impl Node {
    /// The value of a key; `None` if this is not a table or the key is missing.
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(t) => t.iter().find(|(k, _)| k == key).map(|(_, n)| n),
            _ => None,
        }
    }

    /// A table created by the program.
    pub(super) fn table(entries: Vec<(&str, Value)>) -> Value {
        let node = |value| Node { value, place: Place::Program };
        Value::Table(entries.into_iter().map(|(k, v)| (k.to_owned(), node(v))).collect())
    }
}

/// Parses TOML text; `file` is used only in messages.
pub(super) fn parse(text: &str, file: &Path) -> Result<Node, SceneError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = Lines::of(text);
    let document = Document::parse(text).map_err(|e| {
        let what = format!("not valid TOML: {}", e.message().lines().collect::<Vec<_>>().join(", "));
        let help = "strings need quotes, arrays brackets; scenes/README.md shows every key";
        match e.span() {
            Some(s) => SceneError::new(what).at(file, lines.number(s.start)),
            None => SceneError::new(what).file(file),
        }
        .help(help)
    })?;
    let entries = document.as_table().iter().map(|(k, v)| (k.to_owned(), item(v, &lines, 1))).collect();
    Ok(Node { value: Value::Table(entries), place: Place::Line(1) })
}

/// Parses the right-hand side of an override. A bare word is read as a string.
pub(super) fn parse_override(text: &str) -> Result<Node, String> {
    let mut node = match text.trim().parse::<Toml>() {
        Ok(v) => value(&v, &Lines::of(text), 1),
        Err(_) if is_word(text.trim()) => Node { value: Value::Text(text.trim().to_owned()), place: Place::Override },
        Err(e) => return Err(e.message().lines().collect::<Vec<_>>().join(", ")),
    };
    mark_override(&mut node);
    Ok(node)
}

fn is_word(s: &str) -> bool {
    s.starts_with(|c: char| c.is_ascii_alphabetic()) && s.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c))
}

fn mark_override(node: &mut Node) {
    node.place = Place::Override;
    match &mut node.value {
        Value::Table(t) => t.iter_mut().for_each(|(_, n)| mark_override(n)),
        Value::List(l) => l.iter_mut().for_each(mark_override),
        _ => {}
    }
}

/// Byte offset of the start of each line.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect())
    }
    fn number(&self, offset: usize) -> usize {
        self.0.partition_point(|&start| start <= offset)
    }
    fn place(&self, span: Option<Range<usize>>, parent: usize) -> usize {
        span.map_or(parent, |s| self.number(s.start))
    }
}

fn item(item: &Item, lines: &Lines, parent: usize) -> Node {
    match item {
        Item::Value(v) => value(v, lines, parent),
        Item::Table(t) => {
            let line = lines.place(t.span(), parent);
            let entries = t.iter().map(|(k, v)| (k.to_owned(), self::item(v, lines, line)));
            Node { value: Value::Table(entries.collect()), place: Place::Line(line) }
        }
        Item::ArrayOfTables(a) => {
            let line = lines.place(a.span(), parent);
            let tables = a.iter().map(|t| self::item(&Item::Table(t.clone()), lines, line));
            Node { value: Value::List(tables.collect()), place: Place::Line(line) }
        }
        Item::None => Node { value: Value::Table(Vec::new()), place: Place::Line(parent) },
    }
}

fn value(v: &Toml, lines: &Lines, parent: usize) -> Node {
    let line = lines.place(v.span(), parent);
    let value = match v {
        Toml::String(s) => Value::Text(s.value().clone()),
        Toml::Integer(i) => Value::Integer(*i.value()),
        Toml::Float(x) => Value::Float(*x.value()),
        Toml::Boolean(b) => Value::Flag(*b.value()),
        Toml::Datetime(_) => Value::Time,
        Toml::Array(a) => Value::List(a.iter().map(|v| self::value(v, lines, line)).collect()),
        Toml::InlineTable(t) => {
            Value::Table(t.iter().map(|(k, v)| (k.to_owned(), self::value(v, lines, line))).collect())
        }
    };
    Node { value, place: Place::Line(line) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_value_knows_its_line() {
        let text = "\u{feff}name = 'x'\n\n[a.b]\nc = [\n  1,\n  [2.5,\n 3]]\n[[s]]\nt = true\n[[s]]\nu = {v = 1}\n";
        let root = parse(text, Path::new("x.toml")).unwrap();
        let at = |path: &[&str]| {
            let node = path.iter().fold(&root, |n, k| match (&n.value, k.parse::<usize>()) {
                (Value::List(l), Ok(i)) => &l[i],
                _ => n.get(k).unwrap(),
            });
            node.place
        };
        for (path, line) in [
            (&["name"][..], 1),
            (&["a", "b"], 3),
            (&["a", "b", "c"], 4),
            (&["a", "b", "c", "0"], 5),
            (&["a", "b", "c", "1", "1"], 7),
            (&["s", "0"], 8),
            (&["s", "0", "t"], 9),
            (&["s", "1"], 10),
            (&["s", "1", "u", "v"], 11),
        ] {
            assert_eq!(at(path), Place::Line(line), "{path:?}");
        }
    }
}
