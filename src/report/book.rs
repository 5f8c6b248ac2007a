//! Programs of the book: what they are given, what they write, and the claims that they check.
//!
//! ```text
//! chapter N  →  figures, tables, numbers and claims in a folder  →  the text of chapter N includes them
//! ```
//!
//! | what | place |
//! |---|---|
//! | a chapter: its number, its title, what to try after it | [`Chapter`] |
//! | a figure of the lecture: its topic and a caption to read aloud | [`Slide`] |
//! | the folder into which a program writes; the seed; short or full length | [`Folder`] |
//! | a statement of the text, with what the program found | [`Claim`] |
//! | exercises that the program judges | [`Exercise`] |
//!
//! No measured number of the book is typed by hand: the text includes tables, and single numbers from `numbers.md`.

use super::exercise::Exercise;
use super::image::{picture::Picture, typeset::Caption};
use super::plot::Figure;
pub use super::text::markdown::Claim;
pub use super::text::measured::Number;
use super::text::{
    markdown,
    prose::{wrapped, wrapped_after},
};
use super::{ReportError, write_atomically};
use crate::progress::Progress;
use std::cell::RefCell;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Result of a program of the book.
pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A chapter of the book.
#[derive(Clone, Copy, Debug)]
pub struct Chapter {
    /// Its number.
    pub number: u32,
    /// Its file name without the ending, such as `01_one_box_three_answers`.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// What its program shows, in one line.
    pub shows: &'static str,
    /// Commands to try after it.
    pub next: &'static [&'static str],
    /// Computes, draws, writes, and returns the claims of the text with what was found.
    pub program: fn(&Folder<'_>) -> Result<Vec<Claim>>,
    /// Exercises that the program judges.
    pub exercises: &'static [Exercise],
}

/// A figure for one topic of the lecture.
#[derive(Clone, Copy, Debug)]
pub struct Slide {
    /// Name of the figure and of its files.
    pub id: &'static str,
    /// The topic of the lecture.
    pub topic: &'static str,
    /// What it shows, in words that a teacher can read aloud.
    pub caption: &'static str,
    /// Name of the scene, or `none`.
    pub scene: &'static str,
    /// Computes, draws and writes.
    pub program: fn(&Folder<'_>) -> Result<()>,
}

/// What a program of the book is given: a folder, a seed, its length, and a listener for its progress.
pub struct Folder<'a> {
    path: PathBuf,
    written: RefCell<Vec<String>>,
    /// True for a short run: fewer samples and smaller pictures.
    pub quick: bool,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The command that runs the program.
    pub command: String,
    /// Progress, and the request to stop.
    pub progress: Progress<'a>,
}

impl<'a> Folder<'a> {
    /// Creates the folder, if it does not exist.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn new(path: &Path, command: &str) -> std::result::Result<Self, ReportError> {
        std::fs::create_dir_all(path)
            .map_err(|e| ReportError::new(path, e, "choose a folder that can be written, with --out"))?;
        let (path, command) = (path.to_owned(), command.to_owned());
        Ok(Self { path, written: RefCell::default(), quick: false, seed: 0, command, progress: Progress::NONE })
    }

    /// The same folder for a short or a full run.
    #[must_use]
    pub fn quick(self, quick: bool) -> Self {
        Self { quick, ..self }
    }

    /// The same folder with another seed.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// The same folder with a listener for the progress.
    #[must_use]
    pub fn progress<'b>(self, progress: Progress<'b>) -> Folder<'b> {
        let Folder { path, written, quick, seed, command, .. } = self;
        Folder { path, written, quick, seed, command, progress }
    }

    /// The full value, or the one for a short run.
    pub fn pick<T>(&self, full: T, quick: T) -> T {
        if self.quick { quick } else { full }
    }

    /// The text below a picture of a scene.
    pub fn caption(&self, scene: &str) -> Caption {
        Caption { command: self.command.clone(), seed: self.seed, scene: scene.into() }
    }

    /// Writes text.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn text(&self, name: &str, text: &str) -> std::result::Result<(), ReportError> {
        self.written.borrow_mut().push(name.into());
        write_atomically(&self.path.join(name), text.as_bytes())
    }

    /// Writes a picture.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn picture(&self, name: &str, picture: &Picture) -> std::result::Result<(), ReportError> {
        self.written.borrow_mut().push(name.into());
        picture.write(&self.path.join(name))
    }

    /// Writes `STEM.svg` and `STEM.png`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn figure(&self, stem: &str, figure: &Figure) -> std::result::Result<(), ReportError> {
        self.written.borrow_mut().extend(["svg", "png"].map(|ending| format!("{stem}.{ending}")));
        figure.write(&self.path, stem).map(|_| ())
    }

    /// Writes `numbers.md`. The text of the book includes one number as `{{#include figures/CHAPTER/numbers.md:NAME}}`.
    ///
    /// ```
    /// use fredholm::report::book::Folder;
    /// let place = std::env::temp_dir().join("fredholm-numbers-example");
    /// let folder = Folder::new(&place, "example")?;
    /// folder.numbers(&[("rate", "0.67".to_string())])?;
    /// assert_eq!(std::fs::read_to_string(place.join("numbers.md"))?, "ANCHOR: rate\n0.67\nANCHOR_END: rate\n");
    /// # std::fs::remove_dir_all(place)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn numbers(&self, numbers: &[(&str, String)]) -> std::result::Result<(), ReportError> {
        let text = numbers.iter().fold(String::new(), |mut text, (name, value)| {
            let _ = writeln!(text, "ANCHOR: {name}\n{value}\nANCHOR_END: {name}");
            text
        });
        self.text("numbers.md", &text)
    }

    /// Removes the files written so far, because the program was stopped: half of a figure would look like a whole one.
    pub fn clear(&self) {
        // a file that cannot be removed does no harm: the next run of the same command replaces it
        self.written.take().iter().for_each(|name| _ = std::fs::remove_file(self.path.join(name)));
    }

    /// The names of the files written so far.
    pub fn written(&self) -> Vec<String> {
        self.written.borrow().clone()
    }
}

/// What the program of a chapter found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// The claims.
    pub claims: Vec<Claim>,
    /// The result as text: every claim, the folder, and what to try next.
    pub text: String,
}

impl Found {
    /// Returns true if every claim holds.
    pub fn holds(&self) -> bool {
        self.claims.iter().all(|c| c.holds)
    }

    /// 0 if every claim holds, otherwise 1.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(u8::from(!self.holds()))
    }
}

impl Chapter {
    /// Runs the program and writes its claims into `claims.md`.
    ///
    /// # Errors
    /// Those of the program, and if the folder cannot be written.
    pub fn run(&self, folder: &Folder<'_>) -> Result<Found> {
        let claims = (self.program)(folder)?;
        folder.text("claims.md", &markdown::claims(&claims))?;
        let failed = claims.iter().filter(|c| !c.holds).count();
        let mut text = wrapped(&match failed {
            0 => format!("Chapter {}, {}: all {} claims hold.", self.number, self.title, claims.len()),
            _ => format!("Chapter {}, {}: {failed} of {} claims do not hold.", self.number, self.title, claims.len()),
        });
        text.push('\n');
        for Claim { says, found, holds } in &claims {
            let statement = format!("{} {says}", if *holds { '✓' } else { '✗' });
            let _ = writeln!(text, "\n{}", wrapped_after(&statement, "  "));
            let _ = writeln!(text, "{}", format_args!("    {}", wrapped_after(found, "    ")));
        }
        let _ = writeln!(text, "\nFigures and tables: {}", folder.path.display());
        if !self.next.is_empty() {
            let _ = writeln!(text, "\nTry next:");
            self.next.iter().for_each(|command| text += &format!("  {command}\n"));
        }
        Ok(Found { claims, text })
    }

    /// Runs the program as a Cargo example, with the arguments `[--out DIR] [--quick]`.
    ///
    /// # Errors
    /// For any other argument, and those of [`run`](Self::run).
    pub fn example(&self, mut arguments: impl Iterator<Item = String>) -> Result<Found> {
        let (mut out, mut quick) = (format!("fredholm-out/chapter-{:02}", self.number), false);
        while let Some(word) = arguments.next() {
            match word.as_str() {
                "--quick" => quick = true,
                "--out" => out = arguments.next().ok_or("--out needs a folder")?,
                other => {
                    return Err(
                        format!("unknown argument `{other}`; usage: {} [--out DIR] [--quick]", self.name).into()
                    );
                }
            }
        }
        self.run(&Folder::new(Path::new(&out), &format!("fredholm chapter {}", self.number))?.quick(quick))
    }
}
