//! The output folder of the zoo. Its EXR files do not tell which mistake they show, so that `diagnose` and other programs can be
//! tested on them.

use super::args::Zoo;
use crate::cli::base::Failure;
use crate::cli::options::Manner;
use crate::cli::output;
use crate::cli::session::Session;
use fredholm::engine::by_rays::Sampled;
use fredholm::report::image::exr;
use std::path::{Path, PathBuf};

/// A session whose folder is new, is empty, or was written by the same command.
pub fn session(args: &Zoo, default: &str) -> Result<Session, Failure> {
    let wanted = args.out.clone().unwrap_or_else(|| PathBuf::from(default));
    let marked = std::fs::read_to_string(wanted.join(MARK)).is_ok_and(|text| text.starts_with(&mark()));
    let manner = Manner { out: Some(wanted), force: args.force || marked, ..args.into() };
    let mut session = Session::new(manner, args.seed)?;
    session.make_folder("zoo")?;
    Ok(session)
}

/// Name of the CSV file with the ratios. Its first line is the command, which marks the folder as the zoo's.
pub const MARK: &str = "ratios.csv";

/// The first line of that file.
pub fn mark() -> String {
    format!("# {}\n", output::canonical_command())
}

/// Writes the image, its terms and their standard errors as another renderer would, without the name of the mistake.
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
