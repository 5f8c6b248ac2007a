//! Many figures, each made by a process of its own, so that each carries the command that makes it alone; and a page that shows
//! them.

use super::args::Figure;
use super::named::{Kind, Named};
use crate::cli::base::{Ending, Failure, names, note, print};
use crate::cli::session::Session;
use fredholm::report::page::gallery::{self, Exhibit};
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// How a figure was made.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Made {
    Well,
    /// It is there, and one of its comparisons failed.
    Doubtful,
    NotAtAll,
}

/// Makes the figures one after the other, then the page.
pub fn run(args: &Figure, title: &str, figures: &[Named], mut session: Session, name: &str) -> Result<Ending, Failure> {
    session.about("several", "");
    session.make_folder(name)?;
    let (mut exhibits, mut doubtful, mut failed) = (vec![], vec![], vec![]);
    for (i, figure) in figures.iter().enumerate() {
        if session.stopped() {
            break;
        }
        let begun = Instant::now();
        let words = words(args, figure);
        let made = make(args, figure, &words, &session.folder.join(figure.id))?;
        match made {
            Made::NotAtAll => failed.push(figure.id),
            Made::Doubtful => doubtful.push(figure.id),
            Made::Well => {}
        }
        if made != Made::NotAtAll {
            exhibits.push(exhibit(figure, &words));
        }
        if !args.quiet {
            let (done, elapsed) = (i + 1, session.since().elapsed().as_secs_f64());
            let left = elapsed / done as f64 * (figures.len() - done) as f64;
            let mark = if made == Made::NotAtAll { '✗' } else { '✓' };
            let seconds = begun.elapsed().as_secs_f64();
            note(&format!("{mark} {done:>2}/{} {}: {seconds:.1} s; about {left:.0} s left", figures.len(), figure.id));
        }
    }
    let sentence = format!(
        "{} figures. Click on one to see it in full size. Each is a file of its own folder, next to this page.",
        exhibits.len()
    );
    gallery::write(&session.folder.join("index.html"), title, &sentence, &exhibits)?;
    session.sign(&Summary { files: names(["index.html", "summary.json"]), ..session.record() })?;
    let answer = format!(
        "{title}: {} of {} made in {:.0} s. They are in {}; open index.html there.",
        exhibits.len(),
        figures.len(),
        session.since().elapsed().as_secs_f64(),
        session.folder.display()
    );
    print(&wrapped(&answer))?;
    if !session.stopped() && !failed.is_empty() {
        return Err(Failure::input(&format!("these figures could not be made: {}", failed.join(", "))));
    }
    if !doubtful.is_empty() {
        note(&format!("a comparison failed in {}: run it alone to read which", doubtful.join(", ")));
    }
    Ok(session.ending(!doubtful.is_empty()))
}

/// Makes one figure by a process of its own.
fn make(args: &Figure, figure: &Named, words: &[String], folder: &Path) -> Result<Made, Failure> {
    let ended = Command::new(std::env::current_exe()?)
        .args(words)
        .arg("--out")
        .arg(folder)
        .args(args.force.then_some("--force"))
        .arg("--quiet")
        .stdout(Stdio::null())
        .status()?;
    Ok(match ended.code() {
        _ if !folder.join(&figure.picture).exists() => Made::NotAtAll,
        Some(0) => Made::Well,
        Some(1) => Made::Doubtful,
        _ => Made::NotAtAll,
    })
}

/// The words that make one figure.
fn words(args: &Figure, figure: &Named) -> Vec<String> {
    let mut words = vec!["figure".to_string(), figure.id.into()];
    words.extend(args.quick.then(|| "--quick".into()));
    if let Some([w, h]) = args.size.filter(|_| !matches!(figure.kind, Kind::Slide(_))) {
        words.extend(["--size".into(), format!("{w}x{h}")]);
    }
    if args.seed != 0 {
        words.extend(["--seed".into(), args.seed.to_string()]);
    }
    words
}

fn exhibit(figure: &Named, words: &[String]) -> Exhibit {
    Exhibit {
        id: figure.id.into(),
        topic: figure.topic.into(),
        caption: figure.caption.into(),
        picture: format!("{}/{}", figure.id, figure.picture),
        command: format!("fredholm {}", words.join(" ")),
    }
}
