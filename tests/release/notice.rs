//! The part of `NOTICE` about crates: for each its licence, its copyright lines, and each text once.

use super::ALLOWED;
use super::crates::Crate;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The line in `NOTICE` after which the list of crates begins.
pub const HEADING: &str = "Crates\n======\n";

/// The list of crates and the texts of their licences.
pub fn crates(all: &BTreeSet<Crate>) -> String {
    let mut out = String::from(
        "\nThe program is compiled from the crates below. Their sources are at\n\
         https://crates.io/crates/NAME/VERSION. Where a crate offers several licences,\n\
         the one named here is used. The Rust standard library (copyright The Rust\n\
         Project Developers) is under Apache-2.0 or MIT.\n",
    );
    let mut by_licence: BTreeMap<usize, Vec<(&Crate, String)>> = BTreeMap::new();
    for (c, part) in all.iter().flat_map(|c| c.licences().into_iter().map(move |part| (c, part))) {
        let rank = ALLOWED.iter().position(|l| part.iter().any(|p| p == l)).expect("the licences were checked");
        by_licence.entry(rank).or_default().push((c, ALLOWED[rank].to_owned()));
    }
    for (rank, crates) in &by_licence {
        let title = ALLOWED[*rank];
        write!(out, "\n{title}\n{}\n\n", "-".repeat(title.len())).unwrap();
        if title == "Apache-2.0" {
            out.push_str("The text is in LICENSE-APACHE.\n\n");
            for (c, _) in crates {
                writeln!(out, "    {} {}", c.name, c.version).unwrap();
            }
        } else {
            texts(&mut out, title, crates);
        }
    }
    for (c, name) in all.iter().flat_map(|c| files(c).into_iter().filter(|f| is_extra(f)).map(move |f| (c, f))) {
        let title = format!("In {} {}: {name}", c.name, c.version);
        write!(out, "\n{title}\n{}\n\n", "-".repeat(title.len())).unwrap();
        out.push_str(&indented(&read(c, &name)));
    }
    out
}

/// Names of files at the top of a crate, in order.
fn files(c: &Crate) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(&c.folder)
        .unwrap_or_else(|e| panic!("{}: {e}: run cargo fetch", c.folder.display()))
        .map(|f| f.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Notices about parts of a crate, such as `COPYING.LAPACK.BSD`.
fn is_extra(name: &str) -> bool {
    name.starts_with("COPYING.") || name.to_uppercase().starts_with("NOTICE")
}

fn read(c: &Crate, name: &str) -> String {
    String::from_utf8_lossy(&std::fs::read(c.folder.join(name)).unwrap()).replace('\r', "")
}

/// Words that only the text of this licence has.
fn words(licence: &str) -> &'static str {
    match licence {
        "MIT" => "permission is hereby granted, free of charge, to any",
        "Zlib" => "this software is provided 'as-is'",
        "BSD-2-Clause" | "BSD-3-Clause" => "redistribution and use in source and binary forms",
        "Unicode-3.0" => "unicode license v3",
        other => panic!("no words of {other} are known"),
    }
}

fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase()
}

/// Bytes of a licence that has more to say than its usual text: it is printed as it is.
const LONG: usize = 3000;

/// The copyright lines of each crate, and each text once, after the crates that it belongs to.
fn texts(out: &mut String, licence: &str, crates: &[(&Crate, String)]) {
    // text without its title and its copyright lines → the text as it is printed, and the crates with their lines
    let mut groups: BTreeMap<String, (String, Vec<String>)> = BTreeMap::new();
    let mut without = vec![];
    for (c, _) in crates {
        let candidates = files(c).into_iter().filter(|f| !is_extra(f)).filter(|f| {
            let upper = f.to_uppercase();
            ["LICENSE", "LICENCE", "COPYING"].iter().any(|start| upper.starts_with(start)) && c.folder.join(f).is_file()
        });
        let Some(text) = candidates.map(|f| read(c, &f)).find(|t| flat(t).contains(words(licence))) else {
            without.push(*c);
            continue;
        };
        let (lines, body) = split(&text);
        let line = |l: &String| format!("    {} {}: {l}", c.name, c.version);
        let named = match lines.len() {
            _ if body.len() > LONG => vec![line(&"in its own words".to_owned())],
            0 => vec![line(&holder(c))],
            _ => lines.iter().map(line).collect(),
        };
        let body = if body.len() > LONG { text } else { body };
        groups.entry(flat(&body)).or_insert((body, vec![])).1.extend(named);
    }
    let mut groups: Vec<_> = groups.into_values().collect();
    groups.sort_by_key(|(_, named)| std::cmp::Reverse(named.len()));
    let named = without.iter().map(|c| format!("    {} {}: {}", c.name, c.version, holder(c)));
    // the usual text is that of most crates
    if let Some(first) = groups.first_mut() {
        first.1.extend(named);
        first.1.sort();
    } else {
        panic!("no crate has the text of {licence}");
    }
    for (body, named) in groups {
        write!(out, "{}\n\n{}\n", named.join("\n"), indented(&body)).unwrap();
    }
}

/// Who holds the copyright of a crate that names nobody in its licence.
fn holder(c: &Crate) -> String {
    let names: Vec<&str> = c.authors.iter().map(|a| a.split(" <").next().unwrap_or(a)).collect();
    if names.is_empty() {
        format!("Copyright the authors of {}", c.name)
    } else {
        format!("Copyright {}", names.join(", "))
    }
}

/// The copyright lines of a licence, and the rest without its title.
fn split(text: &str) -> (Vec<String>, String) {
    let is_copyright = |l: &str| {
        let l = l.trim().to_lowercase();
        let rest = l.strip_prefix("copyright").map(str::trim_start).or(l.starts_with("(c)").then_some(l.as_str()));
        rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit() || "(©[".contains(c)))
    };
    let title = |l: &str| {
        let l = l.trim_matches(|c: char| !c.is_alphanumeric()).to_lowercase();
        [
            "mit license",
            "the mit license",
            "the mit license (mit",
            "mit license (mit",
            "zlib license",
            "bsd 3-clause license",
        ]
        .contains(&l.as_str())
    };
    let (lines, rest): (Vec<&str>, Vec<&str>) = text.lines().partition(|l| is_copyright(l));
    let rest: Vec<&str> = rest.into_iter().filter(|l| !title(l)).collect();
    (lines.iter().map(|l| l.trim().to_owned()).collect(), rest.join("\n").trim_matches('\n').to_owned())
}

/// Indented by four columns; empty lines stay empty.
fn indented(text: &str) -> String {
    let line = |l: &str| if l.trim().is_empty() { "\n".into() } else { format!("    {}\n", l.trim_end()) };
    text.trim_matches('\n').lines().map(line).collect()
}
