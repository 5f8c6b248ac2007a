//! `fredholm radiosity [SCENE]`: the matrix through the camera; with `--solver` all ways to solve it, with `--modes` its
//! spectrum.

mod args;
mod laboratory;
mod modes;
mod solvers;

use super::base::{Ending, Failure, usage};
use super::solve;
pub use args::Radiosity;

/// Shows the matrix, solves it in every way, or takes it apart.
pub fn run(args: &Radiosity) -> Result<Ending, Failure> {
    match (args.solver, args.modes) {
        (Some(name), _) => solvers::run(args, name),
        (None, Some(count)) => modes::run(args, count.into()),
        (None, None) if args.channel.is_some() => {
            Err(usage("--channel is for --solver and --modes, and neither is given", "add one of them"))
        }
        (None, None) => solve::radiosity(&args.into(), args.export),
    }
}
