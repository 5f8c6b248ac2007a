//! Mistyped commands, options and values: what is wrong, and the nearest that exists.

use super::base::{Failure, usage};
use super::suggest::hint;
use clap::Command;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use fredholm::math::names::{either, list, nearest, similar};
use fredholm::scene::{builtin, load::is_scene_file};
use std::ffi::OsString;
use std::path::Path;

/// The command line with a command in it: `fredholm`, `fredholm SCENE` and `fredholm --spp 4` are the tour.
///
/// # Errors
/// If the first word is neither a command nor a scene.
pub fn with_command(mut words: Vec<OsString>, all: &Command) -> Result<Vec<OsString>, Failure> {
    let first = words.get(1).map(|w| w.to_string_lossy().into_owned());
    let tour = match first.as_deref() {
        None => true,
        Some("-h" | "--help" | "-V" | "--version" | "help") => false,
        Some(word) if word.starts_with('-') || is_scene(word) => true,
        Some(word) if all.find_subcommand(word).is_some() => false,
        Some(word) => return Err(neither(word, &words, all)),
    };
    if tour {
        words.insert(1.min(words.len()), "tour".into());
    }
    Ok(words)
}

fn is_scene(word: &str) -> bool {
    let path = Path::new(word);
    is_scene_file(path) || path.exists() && word.contains(['/', '.']) || builtin::find(word).is_some()
}

/// The first word is neither a command nor a scene: suggests the whole line with the nearest of both.
fn neither(word: &str, words: &[OsString], all: &Command) -> Failure {
    let commands: Vec<&str> = all.get_subcommands().map(Command::get_name).collect();
    let rest: Vec<String> = words[2..].iter().map(|w| w.to_string_lossy().into_owned()).collect();
    let line = |first: &str| format!("`{}`", [&["fredholm".into(), first.into()], rest.as_slice()].concat().join(" "));
    let command =
        nearest(word, commands.iter().copied()).or_else(|| similar(word, commands.iter().copied()).first().copied());
    let scene = nearest(word, builtin::names().iter().copied());
    let near: Vec<String> = [command, scene].into_iter().flatten().map(line).collect();
    let question = if near.is_empty() { String::new() } else { format!("did you mean {}?\n      ", near.join(" or ")) };
    let known = format!("commands: {}\n      scenes: {}", list(commands), list(builtin::names()));
    usage(&format!("`{word}` is neither a command nor a scene"), &(question + &known))
}

/// What is wrong with the command line, in the form of all errors: `error: …`, `help: …`.
pub fn explain(e: &clap::Error, all: &Command, words: &[OsString]) -> String {
    let (command, path) = named(all, words);
    let text = |kind| match e.get(kind) {
        Some(ContextValue::String(s)) => s.clone(),
        Some(ContextValue::Strings(s)) => s.join(", "),
        _ => String::new(),
    };
    let help = format!("`{path} --help` lists all options");
    let (what, help) = match e.kind() {
        ErrorKind::InvalidValue if !text(ContextKind::InvalidValue).is_empty() => {
            let (option, word, known) =
                (text(ContextKind::InvalidArg), text(ContextKind::InvalidValue), strings(e, ContextKind::ValidValue));
            let option = plain(&option);
            (format!("{option}: `{word}` is none of {}", list(&known)), hint(option, &word, &known))
        }
        ErrorKind::ValueValidation => {
            let (option, word) = (text(ContextKind::InvalidArg), text(ContextKind::InvalidValue));
            let option = plain(&option);
            let why = std::error::Error::source(e).map_or(String::new(), |s| reason(&s.to_string(), &word));
            let help = if option == "--roulette" { hint(option, &word, &[]) } else { help };
            (format!("{option}: {why}"), help)
        }
        ErrorKind::UnknownArgument => {
            let word = text(ContextKind::InvalidArg);
            if word.starts_with("--") {
                (
                    format!("unexpected argument '{word}': `{path}` has no such option"),
                    option_hint(&word, command, all, &help),
                )
            } else {
                (format!("unexpected argument '{word}' of `{path}`"), help)
            }
        }
        ErrorKind::InvalidSubcommand => {
            let word = text(ContextKind::InvalidSubcommand);
            let known: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
            let near = similar(&word, known.iter().copied());
            let question = near.first().map_or(String::new(), |n| format!("did you mean `{path} {n}`? "));
            (format!("`{path}` has no command `{word}`"), format!("{question}commands: {}", list(known)))
        }
        ErrorKind::MissingSubcommand | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let known: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
            (format!("`{path}` needs a command"), format!("`{path} COMMAND`, where COMMAND is {}", either(&known)))
        }
        _ => {
            // clap appends the usage and a hint, which all errors of this program have in `help:`
            let text = e.to_string();
            let what = ["\n\nUsage:", "\n\nFor more information", "\n\n  tip:"]
                .iter()
                .fold(&*text, |t, end| t.split(end).next().unwrap_or(t));
            let lines: Vec<&str> = what.trim_start_matches("error: ").lines().map(str::trim).collect();
            (lines.join(" "), help)
        }
    };
    format!("error: {what}\nhelp: {help}")
}

/// The command that the first words name, and its name with all parents.
fn named<'a>(all: &'a Command, words: &[OsString]) -> (&'a Command, String) {
    let (mut command, mut path) = (all, "fredholm".to_owned());
    for word in words.iter().skip(1).filter(|w| *w != "help") {
        let Some(found) = word.to_str().and_then(|w| command.find_subcommand(w)) else { break };
        path = format!("{path} {}", found.get_name());
        command = found;
    }
    (command, path)
}

/// `--technique` of `--technique <NAME>`; the name of a positional argument as it is.
fn plain(option: &str) -> &str {
    option.split([' ', '=']).next().unwrap_or(option)
}

/// Why a value is wrong, in plain words.
fn reason(why: &str, word: &str) -> String {
    match why {
        "invalid digit found in string" | "cannot parse integer from empty string" => {
            format!("`{word}` is not a whole number")
        }
        "invalid float literal" => format!("`{word}` is not a number"),
        why if why.starts_with("number too ") => format!("`{word}` is out of range"),
        why => match why.split_once(" is not in ").and_then(|(n, range)| Some((n, range.split_once("..")?))) {
            Some((n, (low, high))) => {
                let (last, open) = (high.trim_start_matches('='), !high.starts_with('='));
                let most = last.parse::<u64>().map_or(last.to_owned(), |n| (n - u64::from(open)).to_string());
                format!("{n} is not between {low} and {most}")
            }
            None => why.to_owned(),
        },
    }
}

/// Where a mistyped or misplaced option exists.
fn option_hint(option: &str, command: &Command, all: &Command, otherwise: &str) -> String {
    let long = |c: &Command| c.get_arguments().filter_map(|a| a.get_long().map(ToOwned::to_owned)).collect::<Vec<_>>();
    let word = option.trim_start_matches('-');
    let elsewhere: Vec<&str> =
        all.get_subcommands().filter(|c| long(c).iter().any(|l| l == word)).map(Command::get_name).collect();
    let known = long(command);
    match similar(word, known.iter().map(String::as_str).collect::<Vec<_>>()).as_slice() {
        _ if !elsewhere.is_empty() => {
            format!("{option} is an option of {}\n      {otherwise}", either(&elsewhere))
        }
        [] => otherwise.to_owned(),
        near => {
            let near: Vec<String> = near.iter().map(|n| format!("--{n}")).collect();
            format!("did you mean {}?\n      {otherwise}", either(&near.iter().map(String::as_str).collect::<Vec<_>>()))
        }
    }
}

fn strings(e: &clap::Error, kind: ContextKind) -> Vec<&str> {
    match e.get(kind) {
        Some(ContextValue::Strings(s)) => s.iter().map(String::as_str).collect(),
        _ => vec![],
    }
}
