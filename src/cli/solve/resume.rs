//! `--resume`: the folder of the earlier run, its state, and what to say about it.

use super::Request;
use crate::cli::base::{Failure, note};
use crate::cli::keep::{Interval, Keeper, NAME, kept_in};
use crate::cli::output::{but_for_samples, kept_words};
use crate::cli::session::Session;
use fredholm::report::state::Header;
use fredholm::study::run::Run;
use std::path::Path;

/// True if a folder holds the state of this run, perhaps with fewer samples. A folder that the user has named may hold any state:
/// what does not fit is then an error that says so.
pub fn is_of_this_run(folder: &Path, named: bool) -> bool {
    let but = |words: &[String]| but_for_samples(words);
    match kept_in(folder) {
        Some(Ok(state)) => named || but(&state.header.words) == but(&kept_words()),
        Some(Err(_)) => named,
        None => false,
    }
}

/// Keeps the state of this run in its folder. With `--resume` it goes on from the state there; without, a state of unfinished work
/// is refused.
pub fn keeper(args: &Request, run: &Run, session: &Session, header: Header) -> Result<Keeper, Failure> {
    let interval = args.keeping.checkpoint.unwrap_or(Interval::USUAL);
    let spp = header.spp;
    let mut keeper = Keeper::new(session.folder.join(NAME), header, interval);
    match kept_in(&session.folder) {
        Some(state) if args.keeping.resume => {
            keeper.go_on(state?, run)?;
            if !session.quiet() {
                note(&keeper.stand(run, spp));
            }
        }
        None if args.keeping.resume && !session.quiet() => {
            note(&format!("nothing was kept in {}: starting at the first sample", session.folder.display()));
        }
        Some(Ok(state)) if !args.shared.force && state.header.films.iter().any(|f| f.samples[0] < state.header.spp) => {
            let path = session.folder.join(NAME);
            return Err(Failure::Input(format!(
                "error: the output folder holds the state of this run, which was stopped\n  --> {}\nhelp: go on with --resume, or begin \
                 anew with --force",
                path.display()
            )));
        }
        _ => {}
    }
    Ok(keeper)
}

/// Says how a stopped run goes on.
pub fn tell(session: &Session) {
    note(&format!("to go on: {} --resume -o {}", session.command(), session.folder.display()));
}
