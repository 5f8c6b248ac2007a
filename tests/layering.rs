//! One direction: nothing upstream imports from downstream. The order of the modules is the order of the data.
#![allow(clippy::unwrap_used)]

use std::{fs, path::Path};

/// Rank of each folder of `src/`; a module may use modules of lower rank, and itself. Equal ranks are siblings that do
/// not know each other. `main.rs`, `lib.rs` and `cli/` tie everything together and are exempt as users; nobody may use
/// `cli`.
const ORDER: [(&str, u32); 15] = [
    ("math", 0),
    ("scene", 1),
    ("terms", 2),
    ("progress", 3),
    ("operator", 4),
    ("estimator", 5),
    ("solver", 5),
    ("guide", 6),
    ("stats", 7),
    ("engine", 8),
    ("study", 9),
    ("zoo", 10),
    ("diagnosis", 11),
    ("report", 12),
    ("cli", 13),
];

fn rank(module: &str) -> Option<u32> {
    ORDER.iter().find(|(name, _)| *name == module).map(|(_, r)| *r)
}

/// The source with the contents of comments and string literals blanked out; line breaks stay.
fn code_only(source: &str) -> String {
    let (mut out, mut rest) = (String::new(), source);
    while let Some(c) = rest.chars().next() {
        let skip = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |i| i + 2)
        } else if rest.starts_with("'\"'") {
            3
        } else if c == '"' {
            let mut escaped = false;
            let end = rest[1..].find(|c| {
                let closes = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                closes
            });
            end.map_or(rest.len(), |i| i + 2)
        } else {
            0
        };
        if skip > 0 {
            out.extend(rest[..skip].chars().filter(|&c| c == '\n'));
            rest = &rest[skip..];
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
        }
    }
    out
}

/// First identifiers of a path tail: of `a::b` it is `a`, of `{a::b, c::{d, e}}` they are `a` and `c`.
fn heads(tail: &str) -> Vec<String> {
    let word = |s: &str| s.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(group) = tail.trim_start().strip_prefix('{') else { return vec![word(tail)] };
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            '}' | ',' if depth == 0 => {
                parts.push(word(&group[start..i]));
                start = i + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    parts.retain(|p| !p.is_empty());
    parts
}

/// Every path of `source` from the root of the crate: (line number, first identifier). `depth` is the number of modules
/// between the root and the file (2 for `src/stats/slope.rs`), to follow chains of `super`.
fn imports(source: &str, depth: usize) -> Vec<(usize, String)> {
    let code = code_only(source);
    let mut found = Vec::new();
    for (at, _) in code.match_indices("::") {
        let (before, tail) = (&code[..at], &code[at + 2..]);
        let path: Vec<&str> = before
            .rsplit("::")
            .map(|p| p.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or(""))
            .collect();
        let supers = path.iter().take_while(|p| **p == "super").count();
        let from_root = path[0] == "crate" || (supers >= depth && !tail.starts_with("super"));
        if from_root {
            let line = before.matches('\n').count() + 1;
            found.extend(heads(tail).into_iter().map(|h| (line, h)));
        }
    }
    // a chain of supers inside `mod tests { … }` ends one level lower: only names of modules can be meant
    found.retain(|(_, h)| rank(h).is_some() || code.contains(&format!("crate::{h}")));
    found
}

/// What is wrong with one file.
fn violations(module: &str, depth: usize, name: &str, source: &str) -> Vec<String> {
    let Some(own) = rank(module) else { return vec![format!("{name}: module `{module}` has no place in the order")] };
    let lines: Vec<&str> = source.lines().collect();
    let complaint = |(line, target): (usize, String)| {
        let why = match rank(&target) {
            _ if target == module => return None,
            Some(r) if r < own => return None,
            Some(_) => format!("`{module}` must not use `{target}`, which is downstream or beside it"),
            None => format!("`{module}` uses `{target}` of the crate root: name the module it comes from"),
        };
        Some(format!("{name}:{line}: {why}\n    {}", lines.get(line - 1).map_or("", |l| l.trim())))
    };
    imports(source, depth).into_iter().filter_map(complaint).collect()
}

fn walk(folder: &Path, module: &str, depth: usize, out: &mut Vec<String>) {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            walk(&path, module, depth + 1, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let is_mod = path.file_name().is_some_and(|n| n == "mod.rs");
            let source = fs::read_to_string(&path).unwrap();
            let name = path.strip_prefix(env!("CARGO_MANIFEST_DIR")).unwrap_or(&path).display().to_string();
            out.extend(violations(module, depth + usize::from(!is_mod), &name, &source));
        }
    }
}

#[test]
fn nothing_upstream_imports_from_downstream() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    let mut folders: Vec<_> = fs::read_dir(&src).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()).collect();
    folders.sort();
    assert!(folders.len() >= 5, "the modules of src/ were not found");
    for folder in folders {
        let module = folder.file_name().unwrap().to_str().unwrap().to_owned();
        if module != "cli" {
            walk(&folder, &module, 1, &mut found);
        }
    }
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn the_check_sees_every_form_of_import() {
    let bad = [
        "use crate::report::Plot;",
        "use crate::{math::Frame, report::{svg, png}};",
        "use crate::{\n    math::Frame,\n    stats::compare,\n};",
        "fn f() { crate::cli::run() }",
        "use super::super::estimator::Prefix;",
        "let s = \"//\"; use crate::solver::lu;",
        "use crate::Everything;",
    ];
    for source in bad {
        assert_eq!(violations("operator", 2, "x.rs", source).len(), 1, "{source}");
    }
    let good = [
        "use crate::{math::Frame, scene::Scene, terms::Series};",
        "// use crate::report::Plot;\n/* crate::cli::run() */",
        "/// use crate::stats::compare;\nuse super::matrix::Matrix;",
        "let s = \"crate::report::Plot\";",
        "let quote = '\"'; // crate::report",
        "mod tests { use super::super::matrix::Matrix; }",
        "use crate::operator::patches;",
    ];
    for source in good {
        assert!(violations("operator", 2, "x.rs", source).is_empty(), "{source}");
    }
    let shown = violations("scene", 1, "src/scene/mod.rs", "use std::fs;\n  use crate::report::Plot;");
    assert_eq!(
        shown,
        [
            "src/scene/mod.rs:2: `scene` must not use `report`, which is downstream or beside it\n    use crate::report::Plot;"
        ]
    );
    assert_eq!(violations("solver", 1, "x", "use crate::estimator::x;").len(), 1);
    assert_eq!(violations("novel", 1, "x", "").len(), 1);
}
