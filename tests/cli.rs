//! The command line as its users meet it: files, texts, exit codes, and what a second run may replace.
#![allow(clippy::unwrap_used)]

#[path = "cli/comparisons.rs"]
mod comparisons;
#[path = "cli/exercise.rs"]
mod exercise;
#[path = "cli/export.rs"]
mod export;
#[path = "cli/folders.rs"]
mod folders;
#[path = "cli/process.rs"]
mod process;
#[path = "common/program.rs"]
#[allow(dead_code, unreachable_pub)]
mod program;
#[path = "cli/results.rs"]
mod results;
#[path = "cli/schema.rs"]
mod schema;

use fredholm::report::image::exr;
use fredholm::report::image::picture::{auto_gain, develop};
use fredholm::report::text::summary;
use fredholm::terms::World;
use program::{Said, run_tidily};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A folder of its own for every test: the program writes below the folder it stands in.
struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn command(&self, line: &str) -> Command {
        program::command(self.0.path(), line)
    }
    fn run(&self, line: &str) -> Said {
        run_tidily(self.0.path(), line)
    }
    /// The output of what must go well and is no text for a terminal.
    fn run_wide(&self, line: &str) -> String {
        let said = program::run(self.0.path(), line);
        assert_eq!(said.code, 0, "{line}: {}", said.err);
        said.out
    }
    /// Runs what must go well.
    fn ok(&self, line: &str) -> Said {
        let said = self.run(line);
        assert_eq!(said.code, 0, "{line}: {}{}", said.out, said.err);
        said
    }
    /// A small run into `dir`; 1 (a verdict inside the run) is as good as 0.
    fn small(&self, dir: &str, line: &str) -> Said {
        let said = self.run(&format!("{line} {SMALL} -q -o {dir}"));
        assert!(said.code <= 1, "{line}: {}{}", said.out, said.err);
        said
    }
    fn summary(&self, dir: &str) -> summary::Summary {
        summary::read(&self.path(dir).join("summary.json")).unwrap()
    }
    fn image(&self, dir: &str) -> exr::Image {
        exr::read(&self.path(dir).join("terms.exr")).unwrap()
    }
}

const SMALL: &str = "--size 16x16 --max-bounces 3 --patches 60";

/// Every file of a folder with its bytes.
fn contents(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(dir).unwrap().map(|f| f.unwrap());
    files.map(|f| (f.file_name().into_string().unwrap(), std::fs::read(f.path()).unwrap())).collect()
}

fn names(dir: &Path) -> Vec<String> {
    contents(dir).into_keys().collect()
}

/// The lines of a table whose first word is `head`.
fn row<'a>(text: &'a str, head: &str) -> Vec<&'a str> {
    text.lines().filter(|l| l.trim_start().starts_with(head)).collect()
}
