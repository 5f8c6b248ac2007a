//! The folder of a run of the zoo, and what it writes there: nothing that tells a stranger's program what is wrong.

use super::args::Zoo;
use crate::cli::base::Failure;
use crate::cli::options::Manner;
use crate::cli::output;
use crate::cli::session::Session;
use fredholm::engine::by_rays::Sampled;
use fredholm::report::image::exr;
use std::path::{Path, PathBuf};

/// A session in a folder that is absent, empty, or holds what this very command left.
pub fn session(args: &Zoo, default: &str) -> Result<Session, Failure> {
    let wanted = args.out.clone().unwrap_or_else(|| PathBuf::from(default));
    let marked = std::fs::read_to_string(wanted.join(MARK)).is_ok_and(|text| text.starts_with(&mark()));
    let manner = Manner { out: Some(wanted), force: args.force || marked, ..args.into() };
    let mut session = Session::new(manner, args.seed)?;
    session.make_folder("zoo")?;
    Ok(session)
}

/// The numbers of a run, under a line that says whose folder this is.
pub const MARK: &str = "ratios.csv";

/// That line.
pub fn mark() -> String {
    format!("# {}\n", output::canonical_command())
}

/// What a stranger's renderer would leave: the image, its terms, their standard errors; nothing that tells what is wrong.
pub fn write(path: &Path, [w, h]: [u32; 2], result: &Sampled) -> Result<(), Failure> {
    let names: Vec<[String; 2]> = (0..result.terms.len()).map(|k| ["", "_se"].map(|e| format!("T{k:02}{e}"))).collect();
    let layer = |name, pixels| exr::Layer { name, pixels };
    let mut layers = vec![layer("", &result.total.mean), layer("se", &result.total.std_error)];
    for (image, [mean, error]) in result.terms.iter().zip(&names) {
        layers.extend([layer(mean, &image.mean), layer(error, &image.std_error)]);
    }
    let attributes =
        [("spp", result.spp.to_string()), ("replicates", result.series.image().total.replicates.to_string())];
    exr::write(path, w as usize, h as usize, &layers, &attributes)?;
    Ok(())
}
