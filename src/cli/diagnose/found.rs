//! What came out for one suspect.

use fredholm::diagnosis::Diagnosis;

/// What came out for one suspect.
pub struct Diagnosed {
    /// File, or files.
    pub name: String,
    /// Its pictures hold terms.
    pub terms: bool,
    /// Exposure unknown.
    pub any_gain: bool,
    /// Layers that were not understood.
    pub ignored: Vec<String>,
    /// Samples per pixel as the file tells them.
    pub told: Option<f64>,
    /// Factor by which pictures were averaged down.
    pub factor: usize,
    /// The rest.
    pub diagnosis: Diagnosis,
}
