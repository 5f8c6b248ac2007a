//! The `fredholm` program: parses, calls the library, reports.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
