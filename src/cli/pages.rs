//! `fredholm completions SHELL` and `fredholm man [DIR]`: completions and man pages from the commands' own descriptions.

use super::base::{Ending, Failure, print};
use super::options::{OUTPUT, WHAT};
use clap::{Args, Command, ValueHint};
use clap_complete::Shell;
use fredholm::report::{ReportError, write_atomically};
use std::path::PathBuf;

/// Below `completions --help`.
pub const COMPLETIONS: &str = "Examples:
  fredholm completions bash > ~/.local/share/bash-completion/completions/fredholm
  fredholm completions zsh > ~/.zfunc/_fredholm
  fredholm completions fish > ~/.config/fish/completions/fredholm.fish

For zsh, ~/.zfunc must be in fpath before compinit runs.";

/// Below `man --help`.
pub const MAN: &str = "Examples:
  fredholm man | man -l -
  fredholm man ~/.local/share/man/man1
  fredholm man --markdown > commands.md";

/// Arguments of `completions`.
#[derive(Clone, Debug, Args)]
pub struct Completions {
    /// bash, zsh, fish, elvish or powershell
    #[arg(value_name = "SHELL", value_enum, help_heading = WHAT)]
    pub shell: Shell,
}

/// Arguments of `man`.
#[derive(Clone, Debug, Args)]
pub struct Man {
    /// Folder for the man pages [default: print]
    ///
    /// Writes fredholm.1 and one page for every command. Without DIR, fredholm.1 is printed.
    #[arg(value_name = "DIR", help_heading = OUTPUT, value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
    /// Print all commands and options as Markdown
    ///
    /// The book includes this page.
    #[arg(long, conflicts_with = "folder", help_heading = OUTPUT)]
    pub markdown: bool,
}

/// Prints the script for a shell.
pub fn completions(args: &Completions, all: &Command) -> Result<Ending, Failure> {
    let mut script = vec![];
    clap_complete::generate(args.shell, &mut all.clone(), "fredholm", &mut script);
    print(&String::from_utf8_lossy(&script)).map(|()| Ending::Ok)
}

/// Prints the page of the program, or writes all pages.
pub fn man(args: &Man, all: &Command) -> Result<Ending, Failure> {
    if args.markdown {
        return print(&super::markdown::page(all)).map(|()| Ending::Ok);
    }
    let Some(folder) = &args.folder else {
        print(&String::from_utf8_lossy(&page(all.clone())?))?;
        return Ok(Ending::Ok);
    };
    std::fs::create_dir_all(folder).map_err(|e| ReportError::new(folder, e, "choose another folder"))?;
    let mut names = vec![];
    write(all.clone(), "fredholm", &mut |name, page| {
        names.push(name.to_owned());
        write_atomically(&folder.join(name), page).map_err(Failure::from)
    })?;
    print(&format!("written to {}: {} and {} pages of commands", folder.display(), names[0], names.len() - 1))?;
    Ok(Ending::Ok)
}

/// Writes the page of a command, `fredholm check bias`, then those of its subcommands.
fn write(
    command: Command,
    path: &str,
    out: &mut impl FnMut(&str, &[u8]) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let subcommands: Vec<Command> = command.get_subcommands().cloned().collect();
    let name = path.replace(' ', "-");
    out(&format!("{name}.1"), &page(command.display_name(name).bin_name(path.to_owned()))?)?;
    subcommands.into_iter().try_for_each(|s| {
        let path = format!("{path} {}", s.get_name());
        write(s, &path, out)
    })
}

fn page(command: Command) -> Result<Vec<u8>, Failure> {
    let mut page = vec![];
    let source = format!("fredholm {}", env!("CARGO_PKG_VERSION"));
    clap_mangen::Man::new(command.disable_help_subcommand(true)).source(source).render(&mut page)?;
    Ok(unfilled(&String::from_utf8_lossy(&page)).into_bytes())
}

/// The page with indented lines left as they are: examples, one per line.
fn unfilled(page: &str) -> String {
    let mut lines: Vec<&str> = vec![];
    let mut inside = false;
    for line in page.lines() {
        if line.starts_with("  ") != inside {
            lines.push(if inside { ".fi" } else { ".nf" });
            inside = !inside;
        }
        lines.push(line);
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples_stay_one_per_line() {
        let page = super::unfilled("Examples:\n  a\n  b\n\nText.\n");
        assert_eq!(page, "Examples:\n.nf\n  a\n  b\n.fi\n\nText.\n");
    }
}
