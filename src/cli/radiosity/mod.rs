//! `fredholm radiosity [SCENE]`: the radiosity solution through the camera; with `--solver` a comparison of the solvers, with
//! `--modes` the spectrum of T.

mod args;
mod laboratory;
mod modes;
mod solvers;

use super::base::{Ending, Failure, usage};
use super::solve;
pub use args::Radiosity;
use fredholm::report::image::exposure::Exposure;

/// Renders the radiosity solution, compares solvers, or finds the spectrum of T.
pub fn run(args: &Radiosity) -> Result<Ending, Failure> {
    let picture_only = [
        (
            args.pictures.exposure != Exposure::Auto,
            "--exposure is for pictures of terms, and --solver and --modes make none",
        ),
        (
            args.sharding.shard.is_some(),
            "--shard divides the stored rays of a picture, and --solver and --modes need all of them",
        ),
        (args.pixels.crop.is_some(), "--crop is for the picture, and --solver and --modes make none of the scene"),
    ];
    if (args.solver.is_some() || args.modes.is_some())
        && let Some((_, what)) = picture_only.into_iter().find(|(given, _)| *given)
    {
        return Err(usage(what, "leave it out"));
    }
    match (args.solver, args.modes) {
        (Some(name), _) => solvers::run(args, name),
        (None, Some(count)) => modes::run(args, count.into()),
        (None, None) if args.channel.is_some() => {
            Err(usage("--channel is for --solver and --modes, and neither is given", "add one of them"))
        }
        (None, None) => solve::radiosity(&args.into(), args.export),
    }
}
