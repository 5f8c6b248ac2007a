//! What a release promises: the licences of all that a binary carries are allowed and printed in `NOTICE`, and no dependency needs a newer
//! Rust than `Cargo.toml` states.
//!
//! After a change of the dependencies, write `NOTICE` again: `FREDHOLM_WRITE_NOTICE=1 cargo test --release --test release`.
#![allow(clippy::unwrap_used)]

#[path = "release/crates.rs"]
#[allow(unreachable_pub)]
mod crates;
#[path = "release/notice.rs"]
#[allow(unreachable_pub)]
mod notice;

use crates::{Crate, linked, of_all_targets, package};
use std::path::Path;

/// Licences that a program under MIT or Apache-2.0 may carry. The weak copyleft of MPL-2.0 is for files that are named in `NOTICE`.
const ALLOWED: [&str; 7] = ["Apache-2.0", "MIT", "Zlib", "BSD-3-Clause", "BSD-2-Clause", "Unicode-3.0", "MPL-2.0"];

#[test]
fn every_licence_is_allowed() {
    let linked = linked();
    assert!(linked.len() > 100, "the crates are not found");
    for c in linked {
        for part in c.licences() {
            assert!(part.iter().any(|l| ALLOWED.contains(&l.as_str())), "{} {}: {}", c.name, c.version, c.licence);
        }
    }
}

#[test]
fn the_notice_names_all_that_a_binary_carries() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("NOTICE");
    let text = std::fs::read_to_string(&file).unwrap();
    let (by_hand, listed) = text.split_once(notice::HEADING).expect("NOTICE has no list of crates");
    let wanted = notice::crates(&linked());
    if std::env::var_os("FREDHOLM_WRITE_NOTICE").is_some() {
        std::fs::write(&file, format!("{by_hand}{}{wanted}", notice::HEADING)).unwrap();
        return;
    }
    let differs = listed.lines().zip(wanted.lines()).find(|(a, b)| a != b);
    let help = "write NOTICE again: FREDHOLM_WRITE_NOTICE=1 cargo test --release --test release";
    assert!(differs.is_none() && listed.len() == wanted.len(), "{differs:?}: {help}");
}

/// Each licence needs its own words.
#[test]
fn the_notice_prints_every_licence_in_full() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("NOTICE")).unwrap();
    let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "Bitstream Vera Fonts Copyright",
        "Permission is hereby granted, free of charge, to any person obtaining a copy of this software",
        "Redistributions in binary form must reproduce the above copyright notice",
        "This software is provided 'as-is', without any express or implied warranty",
        "Mozilla Public License Version 2.0",
        "Copyright (c) 2020 Yevhenii Reizner",
    ] {
        assert!(flat.contains(words), "NOTICE lacks: {words}");
    }
}

/// The stated version is the newest that a dependency asks for; `.ci/run nightly` compiles with it.
#[test]
fn the_minimal_rust_version_is_that_of_the_dependencies() {
    let number = |version: &str| -> Vec<u32> { version.split('.').map(|n| n.parse().unwrap()).collect() };
    let stated = number(&package().rust_version.unwrap());
    let all = of_all_targets();
    let needed = |c: &Crate| c.rust_version.as_deref().map(number).unwrap_or_default();
    for c in &all {
        let needed: Vec<u32> = needed(c).into_iter().take(stated.len()).collect();
        assert!(needed <= stated, "{} {} needs Rust {:?}", c.name, c.version, c.rust_version);
    }
    let highest = all.iter().map(needed).max().unwrap();
    assert!(
        highest.starts_with(&stated),
        "the dependencies need only {highest:?}: is {stated:?} needed by our own code?"
    );
}
