//! A figure of the lecture: its program, compiled in, and its record.

use super::args::Figure;
use crate::cli::base::{Ending, Failure};
use crate::cli::session::Session;
use fredholm::report::book::{Folder, Slide};
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;

#[path = "../../../chapters/lecture/drawings/mod.rs"]
pub mod drawings;
#[path = "../../../chapters/lecture/renders/mod.rs"]
pub mod renders;

/// Makes the figure.
pub fn run(args: &Figure, slide: &Slide, mut session: Session) -> Result<Ending, Failure> {
    session.about(slide.scene, "");
    session.make_folder(slide.id)?;
    let folder =
        Folder::new(&session.folder, session.command())?.quick(args.quick).seed(args.seed).progress(session.progress());
    let made = (slide.program)(&folder);
    let mut files = folder.written();
    if session.stopped() {
        folder.clear();
        return Ok(session.nothing_to_save(""));
    }
    made.map_err(|e| Failure::input(&e.to_string()))?;
    files.push("summary.json".into());
    let record = Summary { files, ..session.record() };
    session.sign(&record)?;
    session.show(&record, || session.text(&wrapped(slide.caption), &[], &[], &record.files))?;
    Ok(session.ending(false))
}
