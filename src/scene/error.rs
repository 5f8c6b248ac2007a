//! The error type for wrong scenes: the problem, its place, and what to do next.

use std::{fmt, path::PathBuf};

/// An error in the user's input: `error: what`, the place, `help: what to do next`. The program prints it and exits with
/// code 3.
///
/// ```
/// use fredholm::scene::SceneError;
/// let e = SceneError::new("reflectance 1.2 is outside [0, 1]")
///     .at("box.toml", 14).key("materials.left.reflectance").help("keep it in [0, 1]");
/// assert_eq!(e.to_string(), "error: reflectance 1.2 is outside [0, 1]\n  --> box.toml:14  materials.left.reflectance\nhelp: keep it in [0, 1]");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The problem, with the wrong value.
    pub what: String,
    /// The file with the problem, if it came from one.
    pub file: Option<PathBuf>,
    /// 1-based line in that file.
    pub line: Option<usize>,
    /// Dotted key, such as `materials.left.reflectance` or `shapes[2].radius`.
    pub key: Option<String>,
    /// What to do next.
    pub help: Option<String>,
}

impl SceneError {
    /// An error that consists only of its message.
    pub fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), file: None, line: None, key: None, help: None }
    }
    /// Adds file and line.
    #[must_use]
    pub fn at(mut self, file: impl Into<PathBuf>, line: usize) -> Self {
        self.file = Some(file.into());
        self.line = Some(line);
        self
    }
    /// Adds the file only.
    #[must_use]
    pub fn file(mut self, file: impl Into<PathBuf>) -> Self {
        self.file = Some(file.into());
        self
    }
    /// Adds the dotted key.
    #[must_use]
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into());
        self
    }
    /// Adds what to do next.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.what)?;
        let file = self.file.as_ref().map(|p| p.display().to_string());
        let place = match (file, self.line) {
            (Some(f), Some(l)) => Some(format!("{f}:{l}")),
            (Some(f), None) => Some(f),
            _ => None,
        };
        match (place, &self.key) {
            (Some(p), Some(k)) => write!(f, "\n  --> {p}  {k}")?,
            (Some(p), None) => write!(f, "\n  --> {p}")?,
            (None, Some(k)) => write!(f, "\n  --> {k}")?,
            (None, None) => {}
        }
        if let Some(help) = &self.help {
            write!(f, "\nhelp: {help}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}
