//! The list of files that a run has written.

use fredholm::report::text::summary::Summary;
use fredholm::study::run::Run;
use std::path::PathBuf;

pub(super) type Pixels = Vec<[f32; 3]>;

/// The output folder, the names of the files in it, and the common part of the record.
pub(super) struct Files {
    pub folder: PathBuf,
    pub names: Vec<String>,
    pub record: Summary,
}

impl Files {
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
    pub fn add(&mut self, name: &str) -> PathBuf {
        self.names.push(name.to_string());
        self.path(name)
    }
    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|n| n == name)
    }
    /// The header of an EXR file: how it was made. Two equal runs write equal headers, so there is no time in it.
    pub fn attributes(&self, run: &Run) -> [(&'static str, String); 5] {
        [
            ("fredholm.command", self.record.command.clone()),
            ("fredholm.seed", run.settings.seed.to_string()),
            ("fredholm.spp", run.spp().to_string()),
            ("fredholm.scene_hash", self.record.scene_hash.clone()),
            ("fredholm.version", env!("CARGO_PKG_VERSION").to_string()),
        ]
    }
}
