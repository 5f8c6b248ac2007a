//! The text of the book: every command in it runs, in a short form that stands above it; every link leads somewhere; every
//! chapter has its questions, its exercises and their solutions.
//!
//! A block of commands begins with a line `<!-- quick: ARGUMENTS -->`. Each of its commands is run with these arguments, which
//! replace the same options of the command.
#![allow(clippy::unwrap_used)]

mod common;

use common::program::run;
use rayon::prelude::*;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src")
}

/// Name and text of every chapter, in their order.
fn chapters() -> Vec<(String, String)> {
    let mut names: Vec<String> =
        fs::read_dir(source()).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|n| n.ends_with(".md") && n.starts_with(|c: char| c.is_ascii_digit()));
    names.sort();
    names.into_iter().map(|n| (n.clone(), fs::read_to_string(source().join(n)).unwrap())).collect()
}

/// A command of the text, the arguments that make it short, and where it stands.
struct Line {
    place: String,
    command: String,
    quick: String,
}

/// The commands of a text. Every block with a command must say how to make it short.
fn commands(name: &str, text: &str) -> Vec<Line> {
    let (mut found, mut fence, mut quick) = (vec![], None::<Option<String>>, None);
    for (i, line) in text.lines().enumerate() {
        let place = format!("{name}:{}", i + 1);
        if let Some(fenced) = &fence {
            if line.starts_with("```") {
                fence = None;
            } else if line.starts_with("fredholm") {
                let quick = fenced.clone().unwrap_or_else(|| panic!("{place}: no `quick:` above the block"));
                let command = line.split("  #").next().unwrap().trim().to_owned();
                found.push(Line { place, command, quick });
            }
        } else if line.starts_with("```") {
            fence = Some(quick.take());
        } else if let Some(arguments) = line.strip_prefix("<!-- quick:") {
            quick = Some(arguments.strip_suffix("-->").unwrap().trim().to_owned());
        } else if !line.trim().is_empty() {
            assert!(quick.is_none(), "{place}: a `quick:` without a block of commands");
        }
    }
    found
}

/// The words of a command line; quotes hold words together.
fn split(line: &str) -> Vec<String> {
    shlex::split(line).unwrap_or_else(|| panic!("{line}: a quote is missing"))
}

/// The command with the short arguments in place of its own.
fn reduced(command: &str, quick: &str) -> Vec<String> {
    let quick = split(quick);
    let options: HashSet<&String> = quick.iter().filter(|w| w.starts_with("--")).collect();
    let (mut words, mut all) = (vec![], split(command).into_iter().skip(1));
    while let Some(word) = all.next() {
        if options.contains(&word) {
            all.next();
        } else {
            words.push(word);
        }
    }
    words.into_iter().chain(quick).collect()
}

/// Name and text of all pages that are no chapter. The pages of commands are made by the program.
fn other_pages() -> Vec<(String, String)> {
    let files = fs::read_dir(source()).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
    let pages = files.filter(|n| n.ends_with(".md") && !n.starts_with(|c: char| c.is_ascii_digit()));
    pages.map(|n| (n.clone(), fs::read_to_string(source().join(n)).unwrap())).collect()
}

#[test]
fn every_page_is_in_the_table_of_contents() {
    let summary = fs::read_to_string(source().join("SUMMARY.md")).unwrap();
    for (name, _) in chapters().into_iter().chain(other_pages()).filter(|(name, _)| name != "SUMMARY.md") {
        assert!(summary.contains(&format!("]({name})")), "{name}");
    }
}

/// A folder for the commands of one page: the reader stands in the folder of the project.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().unwrap();
    fs::create_dir(desk.path().join("scenes")).unwrap();
    for file in fs::read_dir(source().join("../../scenes")).unwrap().map(|f| f.unwrap()) {
        fs::copy(file.path(), desk.path().join("scenes").join(file.file_name())).unwrap();
    }
    desk
}

/// Runs the commands of one page, one after the other.
fn run_page(name: &str, text: &str) {
    let lines = commands(name, text);
    let chapter = name.starts_with(|c: char| c.is_ascii_digit());
    assert!(!chapter || lines.len() >= 2, "{name}: a command for the chapter, and experiments");
    // tests/chapters.rs runs every chapter; one of them shows here that the command is right
    let run_elsewhere = |l: &Line| l.command.starts_with("fredholm chapter ") && !name.starts_with("01");
    let desk = desk();
    for Line { place, command, quick } in lines.into_iter().filter(|l| !run_elsewhere(l)) {
        let words = reduced(&command, &quick);
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("fredholm"))
            .args(&words)
            .current_dir(desk.path())
            .output()
            .unwrap();
        let err = String::from_utf8_lossy(&output.stderr);
        // a comparison that fails or is not decided is an answer; a wrong argument or file is not
        assert!(matches!(output.status.code(), Some(0 | 1)), "{place}: {}\n{err}", words.join(" "));
    }
}

#[test]
fn every_command_of_the_book_runs() {
    // tests/readme.rs runs the commands by purpose, of which the reference has more
    let others = other_pages().into_iter().filter(|(name, _)| name != "reference.md");
    let pages: Vec<(String, String)> = chapters().into_iter().chain(others).collect();
    pages.par_iter().with_max_len(1).for_each(|(name, text)| run_page(name, text));
}

#[test]
fn a_short_argument_replaces_the_same_option() {
    assert_eq!(
        reduced("fredholm series cornell --spp 64", "--spp 4 --size 8x8").join(" "),
        "series cornell --spp 4 --size 8x8"
    );
    assert_eq!(reduced("fredholm chapter 2", "--quick").join(" "), "chapter 2 --quick");
    assert_eq!(reduced("fredholm series --set 'a=[1, 2]'", "").last().unwrap(), "a=[1, 2]");
    let text = "<!-- quick: --spp 4 -->\n```sh\nfredholm info  # lists\n```\n";
    assert_eq!(commands("x", text)[0].command, "fredholm info");
}

/// The files and headings to which a text leads: targets of links and sources of pictures.
fn targets(text: &str) -> Vec<String> {
    let links = text.split("](").skip(1).map(|rest| rest.split(')').next().unwrap());
    let pictures = text.split("src=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    links.chain(pictures).map(String::from).collect()
}

/// The names that mdBook gives to the headings of a text.
fn headings(text: &str) -> HashSet<String> {
    let name = |heading: &str| {
        let kept = heading.to_lowercase().replace(' ', "-");
        kept.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect()
    };
    text.lines().filter(|l| l.starts_with('#')).map(|l| name(l.trim_start_matches('#').trim())).collect()
}

#[test]
fn every_link_leads_somewhere() {
    let texts: Vec<(String, String)> = chapters().into_iter().chain(other_pages()).collect();
    for (name, text) in &texts {
        for target in targets(text) {
            if target.is_empty() || target.starts_with("http") {
                continue; // the network is not asked
            }
            let (file, heading) = target.split_once('#').unwrap_or((&target, ""));
            // figures are made by the chapters; tests/chapters.rs checks them
            if file.starts_with("figures/") {
                continue;
            }
            let path = if file.is_empty() { source().join(name) } else { source().join(file) };
            assert!(path.exists(), "{name}: the link to {target} leads nowhere");
            if !heading.is_empty() {
                let found = headings(&fs::read_to_string(&path).unwrap());
                assert!(found.contains(heading), "{name}: {file} has no heading `{heading}`: {found:?}");
            }
        }
    }
}

#[test]
fn every_figure_of_the_lecture_that_the_text_shows_exists() {
    let listed = run(&std::env::temp_dir(), "figure --list").out;
    for (name, text) in chapters() {
        for target in targets(&text).iter().filter_map(|t| t.strip_prefix("figures/lecture/")) {
            let (id, file) = target.split_once('/').unwrap();
            assert!(listed.lines().any(|l| l.split_whitespace().next() == Some(id)), "{name}: no figure `{id}`");
            // the commands behind some figures name their pictures themselves
            let others = ["modes-painted.png", "three.png", "decay.svg", "equilibrium.svg", "variance.svg"];
            let known = file == format!("{id}.svg") || file == format!("{id}.png") || others.contains(&file);
            assert!(known, "{name}: {target}");
        }
    }
}

#[test]
fn every_chapter_asks_and_answers() {
    for (name, text) in chapters() {
        let count = |what: &str| text.matches(what).count();
        assert_eq!(count("<details>"), count("</details>"), "{name}: a fold is not closed");
        let exercises = text.split("## Exercises").nth(1).unwrap_or_else(|| panic!("{name}: no exercises"));
        let number: u32 = name[..2].parse().unwrap();
        let asked = (1..10).take_while(|i| exercises.contains(&format!("**{number}.{i}**"))).count();
        let solved = exercises.matches("<summary>Solution</summary>").count();
        assert!(asked >= 3 && solved == asked, "{name}: {asked} exercises, {solved} solutions");
        let (questions, answers) = (count("**Question.**"), count("<summary>Answer</summary>"));
        assert!(questions >= 3 && questions == answers, "{name}: {questions} questions, {answers} answers");
        assert!(text.contains("## Predict") && text.contains("## Experiment"), "{name}");
        // Markdown inside a fold needs an empty line around it
        for fold in text.split("</summary>").skip(1) {
            assert!(
                fold.starts_with("\n\n"),
                "{name}: no empty line after `</summary>`: {}",
                &fold[..fold.len().min(60)]
            );
        }
        for inside in text.split("</details>").collect::<Vec<_>>().split_last().unwrap().1 {
            assert!(inside.ends_with("\n\n"), "{name}: no empty line before `</details>`");
        }
    }
}

/// A reader who does not see a figure hears its description; one who prints the book needs the caption.
#[test]
fn every_figure_is_described() {
    for (name, text) in chapters().into_iter().chain(other_pages()) {
        for image in text.split("<img ").skip(1).map(|rest| rest.split('>').next().unwrap()) {
            let alt = image.split("alt=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap_or("");
            assert!(alt.len() >= 10, "{name}: no description: <img {image}>");
        }
        let count = |what: &str| text.matches(what).count();
        assert_eq!(count("<figure>"), count("<figcaption>"), "{name}: a figure without a caption");
    }
}
