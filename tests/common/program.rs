//! The program itself, run in a folder of its own.

use std::path::Path;
use std::process::Command;

/// What a command left on the screen.
pub struct Said {
    pub code: i32,
    pub out: String,
    pub err: String,
}

/// The command with the words of a line, in a folder.
pub fn command(desk: &Path, line: &str) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
    command.args(line.split_whitespace()).current_dir(desk);
    command
}

/// Runs it. It may fail, and must not panic.
pub fn run(desk: &Path, line: &str) -> Said {
    let output = command(desk, line).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let said = Said { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) };
    assert!(!said.err.contains("panicked"), "{line}: {}", said.err);
    said
}

/// Runs it. What it prints has one blank line between blocks and fits a terminal.
pub fn run_tidily(desk: &Path, line: &str) -> Said {
    let said = run(desk, line);
    assert!(!said.out.contains("\n\n\n"), "{line}: two blank lines in a row\n{}", said.out);
    for l in said.out.lines().filter(|l| !l.starts_with("fredholm ") && !l.trim_start().starts_with('"')) {
        assert!(l.chars().count() <= 100, "{l}");
    }
    said
}
