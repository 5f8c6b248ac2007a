//! The crates of the lock file, from `cargo metadata`.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::Command;

/// One target for each system; a crate counts if any of them needs it.
const TARGETS: [&str; 3] = ["x86_64-unknown-linux-gnu", "aarch64-apple-darwin", "x86_64-pc-windows-msvc"];

/// A package.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crate {
    pub name: String,
    pub version: String,
    /// Its SPDX expression.
    pub licence: String,
    pub authors: Vec<String>,
    pub rust_version: Option<String>,
    /// The folder of its sources.
    pub folder: PathBuf,
}

impl Crate {
    fn of(package: &Value) -> Self {
        let text = |key: &str| package[key].as_str().map(str::to_owned);
        let authors = package["authors"].as_array().unwrap();
        Self {
            name: text("name").unwrap(),
            version: text("version").unwrap(),
            licence: text("license").unwrap_or_default(),
            authors: authors.iter().map(|a| a.as_str().unwrap().to_owned()).collect(),
            rust_version: text("rust_version"),
            folder: PathBuf::from(text("manifest_path").unwrap()).parent().unwrap().to_owned(),
        }
    }

    /// The alternatives of each part of the licence: `(A OR B) AND C` is `[[A, B], [C]]`. An exception (`A WITH E`) is left out, because it only
    /// permits more.
    pub fn licences(&self) -> Vec<Vec<String>> {
        let words = |part: &str| {
            let alternatives = part.split(" OR ").flat_map(|p| p.split('/'));
            alternatives.map(|l| l.trim_matches([' ', '(', ')']).split(" WITH ").next().unwrap().to_owned()).collect()
        };
        self.licence.split(" AND ").map(words).collect()
    }
}

/// What cargo says about the packages of one target.
fn metadata(target: &str) -> Value {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let arguments = ["metadata", "--locked", "--format-version", "1", "--filter-platform", target];
    let output = Command::new(cargo).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// This package.
pub fn package() -> Crate {
    let all = metadata(TARGETS[0]);
    let own = all["packages"].as_array().unwrap().iter().find(|p| p["id"] == all["resolve"]["root"]);
    Crate::of(own.unwrap())
}

/// Every package that any target needs, also to compile and to test.
pub fn of_all_targets() -> BTreeSet<Crate> {
    TARGETS.iter().flat_map(|target| packages(&metadata(target), |_| true)).collect()
}

/// The packages whose code is in the binary of any target: normal dependencies, except macros, which run in the compiler.
pub fn linked() -> BTreeSet<Crate> {
    let normal = |dep: &Value| dep["dep_kinds"].as_array().unwrap().iter().any(|k| k["kind"].is_null());
    TARGETS.iter().flat_map(|target| packages(&metadata(target), normal)).collect()
}

/// The packages that are reached from this one through some dependencies.
fn packages(all: &Value, follow: fn(&Value) -> bool) -> BTreeSet<Crate> {
    let list = |value: &Value| value.as_array().unwrap().clone();
    let by_id = |list: Vec<Value>| -> BTreeMap<String, Value> {
        list.into_iter().map(|v| (v["id"].as_str().unwrap().to_owned(), v)).collect()
    };
    let (described, nodes) = (by_id(list(&all["packages"])), by_id(list(&all["resolve"]["nodes"])));
    let is_macro =
        |id: &str| list(&described[id]["targets"]).iter().any(|t| list(&t["kind"]).contains(&"proc-macro".into()));
    let root = all["resolve"]["root"].as_str().unwrap().to_owned();
    let (mut found, mut next) = (BTreeSet::new(), vec![root.clone()]);
    while let Some(id) = next.pop() {
        let deps = list(&nodes[&id]["deps"]).into_iter().filter(follow);
        let ids: Vec<String> = deps.map(|d| d["pkg"].as_str().unwrap().to_owned()).filter(|d| !is_macro(d)).collect();
        if found.insert(id) {
            next.extend(ids);
        }
    }
    found.remove(&root);
    found.iter().map(|id| Crate::of(&described[id])).collect()
}
