//! All commands and options as one page in Markdown, from the descriptions that `--help` prints: a page of the book.

use clap::{Arg, Command};
use std::fmt::Write;

/// The page: one section per command, one table per group of options.
pub fn page(all: &Command) -> String {
    let mut text = String::new();
    let mut root = all.clone().disable_help_subcommand(true);
    root.build();
    for command in root.get_subcommands() {
        section(command, &format!("fredholm {}", command.get_name()), 2, &mut text);
    }
    text
}

fn section(command: &Command, path: &str, depth: usize, out: &mut String) {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let _ = writeln!(out, "{} {path}\n\n{}.\n", "#".repeat(depth), plain(&about));
    let mut groups: Vec<&str> = vec![];
    let shown = |a: &&Arg| !a.is_hide_set() && a.get_id() != "help" && a.get_id() != "version";
    for a in command.get_arguments().filter(shown) {
        let group = a.get_help_heading().unwrap_or("Arguments");
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    for group in groups {
        let _ = writeln!(out, "| {} | |\n|:---|:---|", plain(group));
        let of_group = |a: &&Arg| a.get_help_heading().unwrap_or("Arguments") == group;
        for a in command.get_arguments().filter(shown).filter(of_group) {
            let help = a.get_long_help().or(a.get_help()).map(ToString::to_string).unwrap_or_default();
            let default = defaults(a);
            let _ = writeln!(out, "| `{}` | {}{default} |", name(a), lines(&help));
        }
        out.push('\n');
    }
    if let Some(help) = command.get_after_long_help() {
        let text = help.to_string();
        let (examples, rest) = text.split_once("\n\n").unwrap_or((&text, ""));
        match examples.strip_prefix("Examples:\n") {
            Some(lines) => {
                let lines: Vec<&str> = lines.lines().map(str::trim_start).collect();
                let _ = writeln!(out, "```text\n{}\n```\n\n{}\n", lines.join("\n"), paragraphs(rest));
            }
            None => _ = writeln!(out, "{}\n", paragraphs(&text)),
        }
    }
    for child in command.get_subcommands() {
        section(child, &format!("{path} {}", child.get_name()), depth + 1, out);
    }
}

/// `-o, --out DIR`.
fn name(a: &Arg) -> String {
    let values: Vec<&str> = a.get_value_names().unwrap_or_default().iter().map(clap::builder::Str::as_str).collect();
    if a.is_positional() {
        return values.join(" ");
    }
    let short = a.get_short().map(|c| format!("-{c}"));
    let long = a.get_long().map(|l| format!("--{l}"));
    let names: Vec<String> = short.into_iter().chain(long).collect();
    match a.get_action().takes_values() {
        true => format!("{} {}", names.join(", "), values.join(" ")),
        false => names.join(", "),
    }
}

fn defaults(a: &Arg) -> String {
    let all: Vec<String> = a.get_default_values().iter().map(|v| v.to_string_lossy().into_owned()).collect();
    match a.get_action().takes_values() && !all.is_empty() {
        true => format!(" Default: `{}`.", all.join(" ")),
        false => String::new(),
    }
}

/// Text in a cell of a table: on one line, with the marks of Markdown, of HTML and of formulas escaped.
fn plain(text: &str) -> String {
    let escaped = |text: &str| {
        text.replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('|', "\\|")
            .replace('*', "\\*")
            .replace('_', "\\_")
            .replace("--", "\\-\\-")
    };
    // what stands between backticks is code already
    let parts = text.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { escaped(part) } else { part.into() });
    let joined = parts.collect::<Vec<_>>().join("`");
    joined.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Text in a cell of a table, line by line. Each line ends like a sentence.
fn lines(text: &str) -> String {
    let ended = |line: &str| match line.ends_with(['.', ':', ')', ']', '%']) {
        true => line.to_owned(),
        false => format!("{line}."),
    };
    let all = text.lines().map(plain).filter(|line| !line.is_empty());
    all.map(|line| ended(&line)).collect::<Vec<_>>().join("<br>")
}

fn paragraphs(text: &str) -> String {
    text.split("\n\n").map(plain).collect::<Vec<_>>().join("\n\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_every_option_and_reads_as_markdown() {
        let command = Command::new("fredholm").subcommand(
            Command::new("solve")
                .about("Solves it")
                .arg(Arg::new("n").long("spp").short('n').value_name("N").help("a < b | c").default_value("4"))
                .after_long_help("Examples:\n  fredholm solve\n\nExit code 1: no."),
        );
        let wanted = "## fredholm solve\n\nSolves it.\n\n| Arguments | |\n|:---|:---|\n| `-n, --spp N` | a &lt; b \\| c. Default: `4`. \
                      |\n\n```text\nfredholm solve\n```\n\nExit code 1: no.\n\n";
        assert_eq!(page(&command), wanted);
    }
}
