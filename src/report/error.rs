//! Errors when a result is written, read or drawn: the file, the cause, and what to do next.

use std::path::PathBuf;

/// A file that could not be written, read or drawn.
///
/// ```
/// use fredholm::report::ReportError;
/// let e = ReportError::new("out/terms.exr", "no space left on device", "free some space, or choose another folder with -o");
/// assert_eq!(e.to_string(), "error: no space left on device\n  --> out/terms.exr\nhelp: free some space, or choose another folder with -o");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("error: {cause}\n  --> {}\nhelp: {help}", path.display())]
pub struct ReportError {
    /// The file (or the name of the figure) concerned.
    pub path: PathBuf,
    /// Cause of the error.
    pub cause: String,
    /// What to do next.
    pub help: String,
}

impl ReportError {
    /// An error about `path`; `cause` is usually the error of the layer below.
    pub fn new(path: impl Into<PathBuf>, cause: impl ToString, help: impl Into<String>) -> Self {
        Self { path: path.into(), cause: cause.to_string(), help: help.into() }
    }
}
