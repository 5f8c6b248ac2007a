//! `fredholm zoo`: a collection of estimators with one deliberate mistake each, compared with the right one.

mod args;
mod everyone;
mod folder;
mod one;
mod quiz;
mod words;

use super::base::{Ending, Failure, print};
pub use args::{HELP, Zoo};
use fredholm::zoo;

/// Lists the members, renders all or one of them, or plays the quiz.
pub fn run(args: &Zoo) -> Result<Ending, Failure> {
    if args.quiz {
        return quiz::run(args);
    }
    let bug = args.name.as_ref().map(|name| zoo::find(name).ok_or_else(|| words::unknown(name))).transpose()?;
    match bug {
        None if args.list => print(&words::list()).map(|()| Ending::Ok),
        Some(bug) if args.list => {
            print(&format!("{}\n{}", words::mistake(bug), words::facts(bug))).map(|()| Ending::Ok)
        }
        None => everyone::run(args),
        Some(bug) => one::run(args, bug),
    }
}
