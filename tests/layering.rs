//! One direction: nothing upstream imports from downstream, folder by folder; and no circle of imports, file by file.
//!
//! Files are read with `syn`. What a file uses are all paths that begin with `crate`, `self` or `super`, in `use`, in code and in
//! types. A path leads to the file of the module that it names; a name that the module re-exports leads on to where it comes from,
//! and re-exporting is no use by itself.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::Visit;

/// Rank of each module at the root of `src/`; a module may use modules of lower rank, and itself. Equal ranks are siblings that do
/// not know each other. `main.rs`, `lib.rs` and `cli/` tie everything together and are exempt as users; nobody may use `cli`.
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

/// A path from the root of the crate, `engine::by_rays::terms`.
type Names = Vec<String>;

/// What one file says.
#[derive(Default)]
struct Source {
    /// Its module.
    module: Names,
    /// Everything it uses, from the root of the crate.
    uses: BTreeSet<Names>,
    /// Names that it passes on, and where they come from; `*` for all of a module.
    passed_on: Vec<(String, Names)>,
    /// Modules written inside the file, while it is read.
    inner: Names,
}

impl Source {
    fn read(module: Names, text: &str) -> Self {
        let mut source = Self { module, ..Self::default() };
        source.visit_file(&syn::parse_file(text).unwrap());
        source
    }

    /// A path that begins with `crate`, `self` or `super`, from the root; nothing for others.
    fn absolute(&self, path: &[String]) -> Option<Names> {
        let mut base: Names = self.module.iter().chain(&self.inner).cloned().collect();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
                while rest.get(1).is_some_and(|s| s == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            _ => return None,
        }
        base.extend_from_slice(&rest[1..]);
        Some(base)
    }

    /// The paths of a `use`, with the names they get here.
    fn flatten(tree: &syn::UseTree, before: &[String], out: &mut Vec<(String, Names)>) {
        let with = |name: &syn::Ident| -> Names { before.iter().cloned().chain([name.to_string()]).collect() };
        match tree {
            syn::UseTree::Path(p) => Self::flatten(&p.tree, &with(&p.ident), out),
            syn::UseTree::Name(n) if n.ident == "self" => {
                out.push((before.last().cloned().unwrap_or_default(), before.to_vec()));
            }
            syn::UseTree::Name(n) => out.push((n.ident.to_string(), with(&n.ident))),
            syn::UseTree::Rename(r) => out.push((r.rename.to_string(), with(&r.ident))),
            syn::UseTree::Glob(_) => out.push(("*".into(), before.to_vec())),
            syn::UseTree::Group(g) => g.items.iter().for_each(|t| Self::flatten(t, before, out)),
        }
    }
}

impl<'ast> Visit<'ast> for Source {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let mut paths = vec![];
        Self::flatten(&item.tree, &[], &mut paths);
        for (name, path) in paths {
            // `pub use child::Name` names a module below without saying so
            let path = self.absolute(&path).unwrap_or_else(|| self.module.iter().chain(&path).cloned().collect());
            if matches!(item.vis, syn::Visibility::Inherited) || !self.inner.is_empty() {
                self.uses.insert(path);
            } else {
                self.passed_on.push((name, path));
            }
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Names = path.segments.iter().map(|s| s.ident.to_string()).collect();
        self.uses.extend(self.absolute(&names));
        syn::visit::visit_path(self, path);
    }

    /// `pub(super)` is no use of anything.
    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let test = item.attrs.iter().any(|a| a.path().is_ident("cfg") && tokens(&a.meta).contains("test"));
        // a test may look at what is downstream in its folder
        if item.content.is_some() && !test {
            self.inner.push(item.ident.to_string());
            syn::visit::visit_item_mod(self, item);
            self.inner.pop();
        }
    }
}

/// What stands in the brackets of an attribute.
fn tokens(meta: &syn::Meta) -> String {
    match meta {
        syn::Meta::List(list) => list.tokens.to_string(),
        _ => String::new(),
    }
}

/// The files of a crate by module.
struct Crate(BTreeMap<Names, Source>);

impl Crate {
    fn read(src: &Path) -> Self {
        let mut all = Self(BTreeMap::new());
        all.folder(src, &[]);
        all
    }

    fn folder(&mut self, folder: &Path, module: &[String]) {
        let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        entries.sort();
        for path in entries {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let below = || module.iter().cloned().chain([name.clone()]).collect::<Names>();
            if path.is_dir() {
                self.folder(&path, &below());
            } else if path.extension().is_some_and(|e| e == "rs") && !["lib", "main"].contains(&name.as_str()) {
                let module = if name == "mod" { module.to_vec() } else { below() };
                self.add(module, &fs::read_to_string(&path).unwrap());
            }
        }
    }

    fn add(&mut self, module: Names, text: &str) {
        self.0.insert(module.clone(), Source::read(module, text));
    }

    /// The file that a path leads to.
    fn target(&self, path: &[String], depth: usize) -> Option<Names> {
        let mut known = (0..=path.len()).rev().map(|n| &path[..n]).filter(|m| self.0.contains_key(*m));
        let module = known.next()?;
        let file = &self.0[module];
        let Some(name) = path.get(module.len()) else { return Some(module.to_vec()) };
        let passed_on = file.passed_on.iter().find(|(n, _)| n == name);
        match passed_on {
            Some((_, from)) if depth < 8 => {
                let onward: Names = from.iter().chain(&path[module.len() + 1..]).cloned().collect();
                self.target(&onward, depth + 1)
            }
            _ => Some(module.to_vec()),
        }
    }

    /// What each file uses, as files.
    fn edges(&self) -> BTreeMap<&Names, BTreeSet<Names>> {
        let of = |source: &Source| {
            let targets = source.uses.iter().filter_map(|path| self.target(path, 0));
            targets.filter(|t| *t != source.module).collect()
        };
        self.0.iter().map(|(module, source)| (module, of(source))).collect()
    }

    /// Uses of a folder that is downstream, or beside.
    fn violations(&self) -> Vec<String> {
        let mut found = vec![];
        for source in self.0.values() {
            let own = &source.module[0];
            let Some(rank_of_own) = rank(own) else {
                found.push(format!("module `{own}` has no place in the order"));
                continue;
            };
            if own == "cli" {
                continue;
            }
            for path in source.uses.iter().chain(source.passed_on.iter().map(|p| &p.1)) {
                let Some(target) = path.first().filter(|t| *t != own) else { continue };
                let what = match rank(target) {
                    Some(r) if r < rank_of_own => continue,
                    Some(_) => format!("must not use `{target}`, which is downstream or beside it"),
                    // a name without `crate::` before it
                    None if !path.is_empty() => {
                        format!("uses `{target}` of the crate root: name the module it comes from")
                    }
                    None => continue,
                };
                found.push(format!("{}: `{own}` {what}: {}", source.module.join("::"), path.join("::")));
            }
        }
        found
    }

    /// Files that use each other, in a circle, however long: the strongly connected components of more than one.
    fn circles(&self) -> Vec<Vec<String>> {
        let edges = self.edges();
        let reach = |from: &Names| {
            let (mut seen, mut stack) = (BTreeSet::new(), vec![from.clone()]);
            while let Some(at) = stack.pop() {
                for next in &edges[&at] {
                    if seen.insert(next.clone()) {
                        stack.push(next.clone());
                    }
                }
            }
            seen
        };
        let reach: BTreeMap<&Names, BTreeSet<Names>> = edges.keys().map(|m| (*m, reach(m))).collect();
        let mut circles = BTreeSet::new();
        for (from, to) in &reach {
            let circle: Vec<String> = to.iter().filter(|t| reach[t].contains(*from)).map(|t| t.join("::")).collect();
            if circle.len() > 1 {
                circles.insert(circle);
            }
        }
        circles.into_iter().collect()
    }
}

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

#[test]
fn nothing_upstream_imports_from_downstream() {
    let all = Crate::read(&src());
    assert!(all.0.len() > 100, "the modules of src/ were not found");
    let found = all.violations();
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let all = Crate::read(&src());
    let edges = all.edges();
    let inside = |circle: &Vec<String>| -> String {
        let named = |m: &Names| circle.contains(&m.join("::"));
        let lines = edges.iter().filter(|(m, _)| named(m)).map(|(m, to)| {
            let to: Vec<String> = to.iter().filter(|t| named(t)).map(|t| t.join("::")).collect();
            format!("{} uses {}", m.join("::"), to.join(", "))
        });
        lines.collect::<Vec<_>>().join("\n  ")
    };
    let circles: Vec<String> = all.circles().iter().map(inside).collect();
    assert!(circles.is_empty(), "{} circles:\n  {}\n", circles.len(), circles.join("\n\n  "));
}

/// A crate of a few files.
fn small(files: &[(&str, &str)]) -> Crate {
    let mut all = Crate(BTreeMap::new());
    for (module, text) in files {
        all.add(module.split("::").map(str::to_owned).collect(), text);
    }
    all
}

#[test]
fn the_check_sees_every_form_of_import() {
    let bad = [
        "use crate::report::Plot;",
        "use crate::{math::Frame, report::{svg, png}};",
        "use crate::{\n    math::Frame,\n    stats::compare,\n};",
        "fn f() { crate::cli::run() }",
        "use super::super::estimator::Prefix;",
        "use crate::solver::lu;",
        "use crate::Everything;",
        "pub use crate::report::Plot;",
        "fn f(p: crate::report::Plot) {}",
        "mod tests { use super::super::super::report::Plot; }",
    ];
    for source in bad {
        assert!(!small(&[("operator::x", source)]).violations().is_empty(), "{source}");
    }
    let good = [
        "use crate::{math::Frame, scene::Scene, terms::Series};",
        "// use crate::report::Plot;\n/* crate::cli::run() */",
        "/// use crate::stats::compare;\nuse super::matrix::Matrix;",
        "const S: &str = \"crate::report::Plot\";",
        "const Q: char = '\"'; // crate::report",
        "mod tests { use super::super::matrix::Matrix; }",
        "use crate::operator::patches;",
    ];
    for source in good {
        assert_eq!(small(&[("operator::x", source)]).violations(), Vec::<String>::new(), "{source}");
    }
    assert_eq!(small(&[("solver::x", "use crate::estimator::x;")]).violations().len(), 1);
    assert_eq!(small(&[("novel", "")]).violations().len(), 1);
}

#[test]
fn the_check_sees_circles_and_only_circles() {
    // a re-export is no use by itself, and a name leads to where it comes from
    let tree = [
        ("scene", "pub use shape::Shape; pub struct Scene;"),
        ("scene::shape", "pub struct Shape;"),
        ("scene::load", "use super::{Scene, Shape};"),
    ];
    assert!(small(&tree).circles().is_empty());
    let two = [("scene::a", "use super::b::B; pub struct A;"), ("scene::b", "fn f(_: crate::scene::a::A) {}")];
    assert_eq!(small(&two).circles(), [["scene::a", "scene::b"]]);
    let three = [
        ("scene", "pub use c::C; fn f() { self::a::g() }"),
        ("scene::a", "use super::C;"),
        ("scene::c", "use super::h;"),
    ];
    assert_eq!(small(&three).circles(), [["scene", "scene::a", "scene::c"]]);
}

/// The lecture's table names files that exist.
#[test]
fn the_table_of_symbols_names_files() {
    let lib = fs::read_to_string(src().join("lib.rs")).unwrap();
    let rows = lib.lines().filter(|l| l.starts_with("//! |") && l.ends_with("` |"));
    let files: Vec<&str> = rows.flat_map(|l| l.rsplit('|').nth(1).unwrap().split('`').skip(1).step_by(2)).collect();
    assert!(files.len() > 20, "{files:?}");
    let missing: Vec<&&str> = files.iter().filter(|f| !src().join(f).exists()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// So does `CONTRIBUTING.md`; NAME stands for a file that is to be added.
#[test]
fn contributing_names_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap();
    let prose = text.split("```").step_by(2).flat_map(|t| t.split('`').skip(1).step_by(2));
    let is_file = |word: &&str| word.starts_with("src/") || word.starts_with("tests/") || word.ends_with(".md");
    let named: Vec<&str> = prose.filter(is_file).filter(|w| !w.contains("NAME") && !w.contains('*')).collect();
    assert!(named.len() > 20, "{named:?}");
    let missing: Vec<&&str> = named.iter().filter(|w| !root.join(w).exists()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
