//! The steps that all commands share: threads, scene, output folder, progress and Ctrl-C, and at the end the record of the run,
//! printed as text or as JSON.
//!
//! ```text
//! new → open → make_folder → progress … → sign → show → ending
//! ```

use super::base::{Ending, Failure, note, paragraphs, print, print_json};
use super::claim::Claim;
use super::open::{self, Opened};
use super::options::{Changes, Manner};
use super::output::{self, Owner};
use super::progress::Bar;
use fredholm::progress::Progress;
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::prose::{WIDTH, wrapped_after};
use fredholm::report::text::summary::{self, Summary};
use fredholm::terms::TermFilm;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Tells that there are more numbers; it ends the last line, or follows it.
const MORE: &str = "; more numbers: --verbose";

/// A running command: its options, its output folder, its progress bar, its record.
pub struct Session {
    /// The output folder, once it is [made](Session::make_folder).
    pub folder: PathBuf,
    manner: Manner,
    started: Instant,
    bar: Bar,
    /// The part of the record that is known from the start.
    record: Summary,
    /// Files that the command reads, and folders of results.
    inputs: Vec<PathBuf>,
    /// The folder belongs to this process while it works.
    claim: Option<Claim>,
}

impl Session {
    /// Starts a command and sets the number of threads.
    pub fn new(manner: impl Into<Manner>, seed: u64) -> Result<Self, Failure> {
        Self::of(manner, output::canonical_command(), seed)
    }

    /// The same, for a result that another command line makes again.
    pub fn of(manner: impl Into<Manner>, command: String, seed: u64) -> Result<Self, Failure> {
        let (manner, started) = (manner.into(), Instant::now());
        if let Some(n) = manner.threads {
            rayon::ThreadPoolBuilder::new().num_threads(n.into()).build_global()?;
        }
        let record = Summary { command, seed, ..Summary::default() };
        Ok(Self {
            folder: PathBuf::new(),
            bar: Bar::plain(manner.quiet),
            manner,
            started,
            record,
            inputs: vec![],
            claim: None,
        })
    }

    /// Loads the scene of that name and applies the options that change it. Warnings go to stderr.
    pub fn open(&mut self, name: &str, changes: &Changes, size: Option<[u32; 2]>) -> Result<Opened, Failure> {
        let opened = open::scene(name, changes, size)?;
        self.reads(name);
        self.about(&opened.description.name, &opened.hash);
        self.sized(opened.description.camera.size);
        self.record.threads = rayon::current_num_threads();
        Ok(opened)
    }

    /// Sets the name and the hash of the scene in the record.
    pub fn about(&mut self, scene: &str, hash: &str) {
        (self.record.scene, self.record.scene_hash) = (scene.into(), hash.into());
    }

    /// Sets width and height in the record. A result on a matrix has one row with one pixel for each patch.
    pub fn sized(&mut self, [w, h]: [u32; 2]) {
        (self.record.width, self.record.height) = (w as usize, h as usize);
    }

    /// Makes the output folder: the one of `-o`, or else one of that name in `fredholm-out`.
    pub fn make_folder(&mut self, name: &str) -> Result<(), Failure> {
        self.make_folder_or(name, &|_| false)
    }

    /// The same; a folder for which `resumes` is true is taken whatever it holds.
    pub fn make_folder_or(&mut self, name: &str, resumes: &dyn Fn(&Path) -> bool) -> Result<(), Failure> {
        let Manner { out, force, .. } = &self.manner;
        let owner = Owner { command: self.command(), force: *force, inputs: &self.inputs, resumes };
        let (folder, claim) = output::folder(out.as_deref(), name, &owner)?;
        (self.folder, self.claim) = (folder, Some(claim));
        Ok(())
    }

    /// Calls `show` with the film after every complete pass.
    pub fn preview(&mut self, show: impl Fn(&TermFilm) + Sync + Send + 'static) {
        self.bar = Bar::new(self.manner.quiet, show);
    }

    /// The command line that makes the result again.
    pub fn command(&self) -> &str {
        &self.record.command
    }

    /// The progress value for library calls: it moves the progress bar, and a signal stops it.
    pub fn progress(&self) -> Progress<'_> {
        self.bar.progress()
    }

    /// Returns true if a signal has asked the command to end.
    pub fn stopped(&self) -> bool {
        self.progress().stopped()
    }

    /// Returns true if no progress is to be shown.
    pub fn quiet(&self) -> bool {
        self.manner.quiet
    }

    /// The time at which the command started.
    pub fn since(&self) -> Instant {
        self.started
    }

    /// Removes the progress bar before something is printed.
    pub fn clear(&self) {
        self.bar.finish();
    }

    /// Ends an interrupted command that has no result yet, and says why.
    pub fn nothing_to_save(&mut self, why: &str) -> Ending {
        self.clear();
        note(&format!("nothing to save yet{why}"));
        self.abandon();
        Ending::Interrupted
    }

    /// Tells that the command reads a file, or the folder of a result: it will not be written into.
    pub fn reads(&mut self, input: impl Into<PathBuf>) {
        self.inputs.push(input.into());
    }

    /// Removes the output folder if it is empty.
    pub fn abandon(&mut self) {
        self.claim = None;
        let _ = std::fs::remove_dir(&self.folder);
    }

    /// The caption below every picture: command, seed and scene.
    pub fn caption(&self) -> Caption {
        let Summary { command, seed, scene, .. } = &self.record;
        Caption { command: command.clone(), seed: *seed, scene: scene.clone() }
    }

    /// The common part of every record: command, scene, seed, threads, seconds, size.
    pub fn record(&self) -> Summary {
        Summary { seconds: self.started.elapsed().as_secs_f64(), ..self.record.clone() }
    }

    /// Writes `summary.json`, and removes the files of the previous run that this run did not replace.
    pub fn sign(&self, record: &Summary) -> Result<(), Failure> {
        self.clear();
        let old = output::left_by_the_last_run(&self.folder);
        summary::write(&self.folder.join("summary.json"), record)?;
        output::remove_stale(&self.folder, &old, &record.files);
        Ok(())
    }

    /// Prints a result: with `--json` the value `machine`, otherwise the text `people`.
    pub fn show(&self, machine: &impl Serialize, people: impl FnOnce() -> String) -> Result<(), Failure> {
        self.clear();
        if self.manner.json { print_json(machine) } else { print(&people()) }
    }

    /// With `--json`, prints warnings to stderr. In text they are part of the result.
    pub fn warn(&self, warnings: &[String]) {
        if self.manner.json {
            warnings.iter().for_each(|w| note(&format!("warning: {w}")));
        }
    }

    /// The text that a person reads: the answer in one sentence, small tables, with `--verbose` also the details, and last
    /// where the files are. Blocks may be empty.
    pub fn text(&self, answer: &str, tables: &[String], details: &[String], files: &[String]) -> String {
        self.text_ending(answer, tables, details, &self.written(files))
    }

    /// The same as [`text`](Self::text), with another last line.
    pub fn text_ending(&self, answer: &str, tables: &[String], details: &[String], last: &str) -> String {
        let verbose = self.manner.verbose;
        let known = verbose || details.iter().all(String::is_empty);
        let length = last.lines().last().map_or(0, |line| line.chars().count());
        let more = match known {
            true => "",
            false if length + MORE.len() <= WIDTH => MORE,
            false => &MORE.replace("; ", "\n"),
        };
        let mut blocks = vec![answer.to_owned()];
        blocks.extend_from_slice(tables);
        blocks.extend_from_slice(if verbose { details } else { &[] });
        blocks.push(format!("{last}{more}"));
        paragraphs(&blocks)
    }

    /// The last line of a result: the folder and the names of its files.
    pub fn written(&self, files: &[String]) -> String {
        wrapped_after(&format!("written to {}: {}", self.folder.display(), files.join(", ")), "  ")
    }

    /// The ending of the command: interrupted, failed or well.
    pub fn ending(&self, failed: bool) -> Ending {
        match (self.stopped(), failed) {
            (true, _) => Ending::Interrupted,
            (_, true) => Ending::Failed,
            _ => Ending::Ok,
        }
    }
}
