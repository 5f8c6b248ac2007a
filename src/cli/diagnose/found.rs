//! The result for one picture.

use fredholm::diagnosis::{Code, Diagnosis};

/// The diagnosis of one picture, with facts about its file.
pub struct Diagnosed {
    /// Name of the file, or of the first of several files that belong together.
    pub name: String,
    /// True if the file has terms.
    pub terms: bool,
    /// Number format of the file.
    pub code: Code,
    /// Names of layers that are neither a term nor a whole image.
    pub ignored: Vec<String>,
    /// Samples per pixel according to the file.
    pub told: Option<f64>,
    /// Factor by which width and height were averaged down.
    pub factor: usize,
    /// The verdict, the evidence and the suspects.
    pub diagnosis: Diagnosis,
}
