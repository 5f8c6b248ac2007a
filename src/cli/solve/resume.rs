//! `--resume`: the folder of the earlier run, its state, and what to say about it.

use super::Request;
use crate::cli::base::{Failure, note};
use crate::cli::keep::{Interval, Keeper, NAME, kept_in};
use crate::cli::output::{but_for_samples, command_of, kept_words, with_options};
use crate::cli::session::Session;
use fredholm::report::state::Header;
use fredholm::report::text::summary;
use fredholm::study::run::Run;
use std::path::Path;

/// True if a folder holds the state of this run, perhaps with fewer samples. A folder that the user has named may hold any state:
/// what does not fit is then an error that says so.
pub fn is_of_this_run(folder: &Path, named: bool) -> bool {
    match kept_in(folder) {
        // a folder that another command has written since then is not taken
        Some(Ok(state)) => {
            let of_state = but_for_samples(&state.header.words);
            let written = summary::read(&folder.join("summary.json")).ok().and_then(|s| shlex::split(&s.command));
            let same = written.is_none_or(|words| but_for_samples(words.get(1..).unwrap_or_default()) == of_state);
            same && named || of_state == but_for_samples(&kept_words())
        }
        Some(Err(_)) => named,
        None => false,
    }
}

/// Keeps the state of this run in its folder. With `--resume` it goes on from the state there; without, a state of unfinished work
/// is refused.
pub fn keeper(args: &Request, run: &Run, session: &Session, header: Header) -> Result<Keeper, Failure> {
    let interval = args.keeping.checkpoint.unwrap_or(Interval::USUAL);
    let mut keeper = Keeper::new(session.folder.join(NAME), header, interval);
    match kept_in(&session.folder) {
        Some(state) if args.keeping.resume => {
            keeper.go_on(state?, run)?;
            if !session.quiet() {
                note(&keeper.stand(run));
            }
        }
        None if args.keeping.resume && !session.quiet() => {
            note(&format!("nothing was kept in {}: starting at the first sample", session.folder.display()));
        }
        // a run by the clock has no number of samples that it lacks
        Some(Ok(state))
            if run.settings.time.is_none()
                && !args.shared.force
                && state.header.films.iter().any(|f| f.samples[0] < state.header.spp) =>
        {
            let path = session.folder.join(NAME);
            let what = "the output folder holds the state of this run, which was stopped";
            return Err(Failure::at(&path, what, "go on with --resume, or begin anew with --force"));
        }
        _ => {}
    }
    Ok(keeper)
}

/// Says how a stopped run goes on.
pub fn tell(session: &Session) {
    let folder = session.folder.display().to_string();
    note(&format!("to go on: {}", command_of(&with_options(&kept_words(), &["--resume", "-o", &folder]))));
}
