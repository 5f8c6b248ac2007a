//! The list of files that a run has written.

use crate::cli::base::Failure;
use fredholm::report::ReportError;
use fredholm::report::plot::Figure;
use fredholm::report::text::summary::Summary;
use fredholm::study::run::Run;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

pub(super) type Pixels = Vec<[f32; 3]>;

/// Makes a file.
type Job<'a> = Box<dyn FnOnce() -> Result<(), Failure> + Send + 'a>;

/// The output folder, the names of the files in it, and the common part of the record.
pub(super) struct Files<'a> {
    pub folder: PathBuf,
    pub names: Vec<String>,
    pub record: Summary,
    /// The files that are not made yet.
    pub jobs: Vec<Job<'a>>,
}

impl<'a> Files<'a> {
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
    pub fn add(&mut self, name: &str) -> PathBuf {
        self.names.push(name.to_string());
        self.path(name)
    }
    /// Adds a file that `write` will make.
    pub fn later(&mut self, name: &str, write: impl FnOnce(&Path) -> Result<(), Failure> + Send + 'a) {
        let path = self.add(name);
        self.jobs.push(Box::new(move || write(&path)));
    }
    /// Adds the SVG and the PNG of a figure that `draw` will draw.
    pub fn figure(&mut self, stem: &str, draw: impl FnOnce() -> Result<Figure, ReportError> + Send + 'a) {
        self.names.extend(["svg", "png"].map(|ending| format!("{stem}.{ending}")));
        let (folder, stem) = (self.folder.clone(), stem.to_owned());
        self.jobs.push(Box::new(move || {
            draw()?.write(&folder, &stem)?;
            Ok(())
        }));
    }
    /// Makes all files that were added, side by side.
    pub fn make(&mut self) -> Result<(), Failure> {
        std::mem::take(&mut self.jobs).into_par_iter().with_max_len(1).map(|make| make()).collect()
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
