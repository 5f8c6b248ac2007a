//! The output folder: the same command replaces its own output, another run's is never overwritten without `--force`.

use super::Failure;
use fredholm::report::summary;
use std::path::{Path, PathBuf};

/// The folder for this command: created, and safe to write into.
pub fn folder(asked: Option<&Path>, name: &str, command: &str, force: bool) -> Result<PathBuf, Failure> {
    let folder = match asked {
        Some(dir) => {
            if !force && !ours(dir, command) {
                return Err(Failure::Input(format!(
                    "error: the output folder holds something else\n  --> {}\nhelp: choose another with -o, or replace it with --force",
                    dir.display()
                )));
            }
            dir.to_path_buf()
        }
        None => {
            let base = PathBuf::from("fredholm-out");
            let numbered = (2..).map(|i| base.join(format!("{name}-{i}")));
            let free = |dir: &PathBuf| force || ours(dir, command);
            std::iter::once(base.join(name)).chain(numbered).find(free).unwrap_or(base)
        }
    };
    std::fs::create_dir_all(&folder).map_err(|e| {
        Failure::Input(format!(
            "error: cannot make the output folder: {e}\n  --> {}\nhelp: choose another with -o",
            folder.display()
        ))
    })?;
    Ok(folder)
}

/// Whether a folder is empty, absent, or the output of this very command.
fn ours(dir: &Path, command: &str) -> bool {
    if std::fs::read_dir(dir).map_or(!dir.exists(), |mut files| files.next().is_none()) {
        return true;
    }
    summary::read(&dir.join("summary.json")).is_ok_and(|s| s.command == command)
}

/// The command line as anyone would type it again: without what does not change the result.
pub fn canonical_command() -> String {
    const WITH_VALUE: [&str; 4] = ["-o", "--out", "-t", "--threads"];
    const ALONE: [&str; 6] = ["--force", "--json", "-q", "--quiet", "-v", "--verbose"];
    let mut words = vec!["fredholm".to_string()];
    let mut skip = false;
    for arg in std::env::args().skip(1) {
        let name = arg.split('=').next().unwrap_or_default();
        if std::mem::take(&mut skip) || ALONE.contains(&arg.as_str()) {
            continue;
        }
        if WITH_VALUE.contains(&name) {
            skip = !arg.contains('=');
        } else if !(arg.starts_with("-o") || arg.starts_with("-t")) || arg.starts_with("--") {
            words.push(quoted(&arg));
        }
    }
    words.join(" ")
}

fn quoted(arg: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=.,:@/+".contains(c);
    if arg.chars().all(plain) { arg.to_string() } else { format!("'{}'", arg.replace('\'', "'\\''")) }
}
