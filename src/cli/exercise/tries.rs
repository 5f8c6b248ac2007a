//! The answers of a student so far: one file per student, to which every answer is added.

use crate::cli::base::Failure;
use fredholm::report::exercise::Student;
use fredholm::report::write_atomically;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// One answer.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Try {
    /// Chapter and exercise: `10.1`.
    pub exercise: String,
    /// The answer as it was typed.
    pub answer: String,
    /// True if it was right.
    pub right: bool,
}

/// The file of a student.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct File {
    student: String,
    tries: Vec<Try>,
}

/// All answers of a student.
pub(super) struct Tries {
    path: PathBuf,
    file: File,
}

impl Tries {
    /// Reads the file of a student; it need not exist.
    pub(super) fn of(student: &Student, folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(format!("{}.json", student.name()));
        let wrong = |what: String| {
            let help = "the file holds the answers so far: repair it, or move it away to start again";
            Failure::input(&format!("error: {what}\n  --> {}\nhelp: {help}", path.display()))
        };
        let file = match std::fs::read_to_string(&path) {
            Ok(text) => serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?,
            Err(e) if e.kind() == ErrorKind::NotFound => File { student: student.name().into(), tries: vec![] },
            Err(e) => return Err(wrong(e.to_string())),
        };
        Ok(Self { path, file })
    }

    /// The number of wrong answers to an exercise.
    pub(super) fn wrong(&self, number: &str) -> usize {
        self.file.tries.iter().filter(|t| t.exercise == number && !t.right).count()
    }

    /// Returns true if an exercise has a right answer.
    pub(super) fn solved(&self, number: &str) -> bool {
        self.file.tries.iter().any(|t| t.exercise == number && t.right)
    }

    /// Adds an answer and writes the file.
    pub(super) fn add(&mut self, one: Try) -> Result<(), Failure> {
        self.file.tries.push(one);
        if let Some(folder) = self.path.parent() {
            let help = "choose another folder with --out";
            let why = |e| Failure::input(&format!("error: {e}\n  --> {}\nhelp: {help}", folder.display()));
            std::fs::create_dir_all(folder).map_err(why)?;
        }
        write_atomically(&self.path, serde_json::to_string_pretty(&self.file)?.as_bytes())?;
        Ok(())
    }
}
