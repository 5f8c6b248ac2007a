//! `fredholm book [CHAPTER]`: opens the built book in the browser, or says how to build it.

use super::base::{Ending, Failure, print, usage};
use super::chapter;
use super::options::{OUTPUT, WHAT};
use clap::Args;
use std::path::{Path, PathBuf};

/// Below `book --help`.
pub const HELP: &str = "Examples:
  fredholm book
  fredholm book 10
  fredholm book --no-open

The built book is looked for in this folder, in the folders above it, and where the program was compiled. `book/build --figures` \
builds it; book/README.md says what that needs.";

/// Arguments of `book`.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// Number of a chapter [default: the first page]
    #[arg(value_name = "CHAPTER", help_heading = WHAT)]
    pub chapter: Option<String>,
    /// Print where the book is, and open nothing
    #[arg(long, help_heading = OUTPUT)]
    pub no_open: bool,
}

/// Opens the book.
pub fn run(args: &Options) -> Result<Ending, Failure> {
    let page = match &args.chapter {
        Some(word) => format!("{}.html", chapter::find(word)?.name),
        None => "index.html".into(),
    };
    let Some(folder) = places().find(|p| p.join("index.html").is_file()) else {
        let help = "run book/build --figures in the folder of the project; book/README.md says what it needs. The text without \
                    figures and formulas is in book/src";
        return Err(Failure::input(&format!("error: the book is not built\nhelp: {help}")));
    };
    let page = folder.join(page);
    if !page.is_file() {
        return Err(usage(
            &format!("the built book has no page {}", page.display()),
            "build it again: book/build --figures",
        ));
    }
    print(&page.display().to_string())?;
    if !args.no_open && open::that_detached(&page).is_err() {
        super::base::note("note: no browser could be started; open this file in a browser");
    }
    Ok(Ending::Ok)
}

/// Where a built book may be.
fn places() -> impl Iterator<Item = PathBuf> {
    let here = std::env::current_dir().unwrap_or_default();
    let above: Vec<PathBuf> = here.ancestors().map(Path::to_owned).collect();
    above.into_iter().chain([PathBuf::from(env!("CARGO_MANIFEST_DIR"))]).map(|p| p.join("book/book"))
}
