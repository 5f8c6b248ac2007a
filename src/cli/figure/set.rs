//! Many figures, each made by a process of its own, so that each carries the command that makes it alone; and a page that shows
//! them.

use super::args::Figure;
use super::named::{Kind, Named};
use crate::cli::base::{Ending, Failure, note, print};
use crate::cli::progress::stop_flag;
use fredholm::report::page::gallery::{self, Exhibit};
use fredholm::report::text::prose::wrapped;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Makes the figures one after the other, then the page.
pub fn run(args: &Figure, name: &str, title: &str, figures: &[Named]) -> Result<Ending, Failure> {
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("fredholm-out").join(name));
    std::fs::create_dir_all(&folder)?;
    let start = Instant::now();
    let (mut made, mut failed) = (vec![], vec![]);
    for (i, figure) in figures.iter().enumerate() {
        if stop_flag().load(Ordering::Relaxed) {
            break;
        }
        let one = Instant::now();
        let words = words(args, figure);
        let output = folder.join(figure.id);
        let ended = Command::new(std::env::current_exe()?)
            .args(&words)
            .arg("--out")
            .arg(&output)
            .args(args.force.then_some("--force"))
            .arg("--quiet")
            .stdout(Stdio::null())
            .status()?;
        let seconds = one.elapsed().as_secs_f64();
        // a comparison that is not decided with few samples is no failure of the figure
        let good = output.join(&figure.picture).exists() && matches!(ended.code(), Some(0 | 1));
        if !args.quiet {
            let mark = if good { '✓' } else { '✗' };
            note(&format!("{mark} {:>2}/{} {} {seconds:.1} s", i + 1, figures.len(), figure.id));
        }
        if good {
            made.push(exhibit(figure, &words));
        } else {
            failed.push(figure.id);
        }
    }
    let sentence = format!(
        "{} figures. Click on one to see it in full size. Each is a file of its own folder, next to this page.",
        made.len()
    );
    gallery::write(&folder.join("index.html"), title, &sentence, &made)?;
    let answer = format!(
        "{title}: {} of {} made in {:.0} s. They are in {}; open index.html there.",
        made.len(),
        figures.len(),
        start.elapsed().as_secs_f64(),
        folder.display()
    );
    print(&wrapped(&answer))?;
    Ok(match (stop_flag().load(Ordering::Relaxed), failed.is_empty()) {
        (true, _) => Ending::Interrupted,
        (_, true) => Ending::Ok,
        _ => return Err(Failure::input(&format!("these figures could not be made: {}", failed.join(", ")))),
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
