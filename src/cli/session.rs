//! What every command does alike: threads and scene, the output folder, progress and Ctrl-C, and at the end the record, as
//! text or as JSON.
//!
//! ```text
//! new → open → make_folder → progress … → sign → show → ending
//! ```

use super::base::{Ending, Failure, note, paragraphs, print};
use super::open::{self, Opened};
use super::options::{Changes, Manner};
use super::output;
use super::progress::Bar;
use fredholm::progress::Progress;
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::summary::{self, Summary};
use fredholm::terms::TermFilm;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// A command at work.
pub struct Session {
    /// Where its results go, once [made](Session::make_folder).
    pub folder: PathBuf,
    manner: Manner,
    started: Instant,
    bar: Bar,
    /// What its record says in any case.
    record: Summary,
}

impl Session {
    /// Begins: sets the number of threads.
    pub fn new(manner: impl Into<Manner>, seed: u64) -> Result<Self, Failure> {
        let (manner, started) = (manner.into(), Instant::now());
        if let Some(n) = manner.threads {
            rayon::ThreadPoolBuilder::new().num_threads(n.into()).build_global()?;
        }
        let record = Summary { command: output::canonical_command(), seed, ..Summary::default() };
        Ok(Self { folder: PathBuf::new(), bar: Bar::plain(manner.quiet), manner, started, record })
    }

    /// The scene of that name, changed by the options; warnings go to stderr.
    pub fn open(&mut self, name: &str, changes: &Changes, size: Option<[u32; 2]>) -> Result<Opened, Failure> {
        let opened = open::scene(name, changes, size)?;
        self.about(&opened.description.name, &opened.hash);
        self.sized(opened.description.camera.size);
        self.record.threads = rayon::current_num_threads();
        Ok(opened)
    }

    /// What the record says of the scene.
    pub fn about(&mut self, scene: &str, hash: &str) {
        (self.record.scene, self.record.scene_hash) = (scene.into(), hash.into());
    }

    /// Width and height in the record; a matrix has one pixel for every patch, in one row.
    pub fn sized(&mut self, [w, h]: [u32; 2]) {
        (self.record.width, self.record.height) = (w as usize, h as usize);
    }

    /// Makes the output folder: `-o`, or one of that name.
    pub fn make_folder(&mut self, name: &str) -> Result<(), Failure> {
        let Manner { out, force, .. } = &self.manner;
        self.folder = output::folder(out.as_deref(), name, self.command(), *force)?;
        Ok(())
    }

    /// The film is shown after every complete pass.
    pub fn preview(&mut self, show: impl Fn(&TermFilm) + Sync + Send + 'static) {
        self.bar = Bar::new(self.manner.quiet, show);
    }

    /// The command, as anyone would type it again.
    pub fn command(&self) -> &str {
        &self.record.command
    }

    /// What the library is given: work that is shown, and that Ctrl-C ends.
    pub fn progress(&self) -> Progress<'_> {
        self.bar.progress()
    }

    /// Whether Ctrl-C was pressed.
    pub fn stopped(&self) -> bool {
        self.progress().stopped()
    }

    /// Whether no progress is to be shown.
    pub fn quiet(&self) -> bool {
        self.manner.quiet
    }

    /// Returns true if every number behind the answer is to be printed.
    pub fn verbose(&self) -> bool {
        self.manner.verbose
    }

    /// When it began.
    pub fn since(&self) -> Instant {
        self.started
    }

    /// Takes the progress bar away, before something is printed.
    pub fn clear(&self) {
        self.bar.finish();
    }

    /// Interrupted before anything was found.
    pub fn nothing_to_save(&self, why: &str) -> Ending {
        self.clear();
        note(&format!("nothing to save yet{why}"));
        self.abandon();
        Ending::Interrupted
    }

    /// Leaves no folder behind, if it is empty.
    pub fn abandon(&self) {
        let _ = std::fs::remove_dir(&self.folder);
    }

    /// What stands below every picture.
    pub fn caption(&self) -> Caption {
        let Summary { command, seed, scene, .. } = &self.record;
        Caption { command: command.clone(), seed: *seed, scene: scene.clone() }
    }

    /// What every record says: command, scene, seed, threads, seconds, size.
    pub fn record(&self) -> Summary {
        Summary { seconds: self.started.elapsed().as_secs_f64(), ..self.record.clone() }
    }

    /// Writes the record that owns the folder, and removes what the last run left and this one did not write.
    pub fn sign(&self, record: &Summary) -> Result<(), Failure> {
        self.clear();
        let old = output::left_by_the_last_run(&self.folder);
        summary::write(&self.folder.join("summary.json"), record)?;
        output::remove_stale(&self.folder, &old, &record.files);
        Ok(())
    }

    /// Prints a result, for programs or for people.
    pub fn show(&self, machine: &impl Serialize, people: impl FnOnce() -> String) -> Result<(), Failure> {
        self.clear();
        if self.manner.json { print(&serde_json::to_string_pretty(machine)?) } else { print(&people()) }
    }

    /// Warnings for those who read JSON; text has them in its place.
    pub fn warn(&self, warnings: &[String]) {
        if self.manner.json {
            warnings.iter().for_each(|w| note(&format!("warning: {w}")));
        }
    }

    /// The text that a person reads: the answer in one sentence, small tables, with `--verbose` also the details, and last
    /// where the files are. Blocks may be empty.
    pub fn text(&self, answer: &str, tables: &[String], details: &[String], files: &[String]) -> String {
        let mut blocks = vec![answer.to_owned()];
        blocks.extend_from_slice(tables);
        blocks.extend_from_slice(if self.manner.verbose { details } else { &[] });
        let more =
            if self.manner.verbose || details.iter().all(String::is_empty) { "" } else { "\nmore numbers: --verbose" };
        blocks.push(self.written(files) + more);
        paragraphs(&blocks)
    }

    /// The folder and the names of the files. The names begin a new line if the line would be longer than 80 columns.
    pub fn written(&self, files: &[String]) -> String {
        let (folder, files) = (format!("written to {}:", self.folder.display()), files.join(", "));
        let long = folder.chars().count() + 1 + files.chars().count() > 80;
        folder + if long { "\n" } else { " " } + &files
    }

    /// How it ends.
    pub fn ending(&self, failed: bool) -> Ending {
        match (self.stopped(), failed) {
            (true, _) => Ending::Interrupted,
            (_, true) => Ending::Failed,
            _ => Ending::Ok,
        }
    }
}
