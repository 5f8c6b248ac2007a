//! The readers of `tests/fuzz/targets.rs` for libFuzzer.
#![allow(clippy::unwrap_used)]

#[path = "../tests/fuzz/targets.rs"]
mod targets;

use std::sync::OnceLock;
use targets::{Desk, Target};

/// Reads one case.
pub fn run(name: &str, bytes: &[u8]) {
    static DESK: OnceLock<Desk> = OnceLock::new();
    let folder = || std::env::temp_dir().join(format!("fredholm-fuzz-{name}-{}", std::process::id()));
    Target::named(name).check(DESK.get_or_init(|| Desk::new(&folder())), bytes);
}
