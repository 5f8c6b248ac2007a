//! The `fredholm` program: it parses the command line, calls the library, and prints the report.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
