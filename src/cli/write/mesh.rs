//! `--export`: files with which another program can check or use the matrix.

use super::files::Files;
use crate::cli::base::Failure;
use clap::ValueEnum;
use fredholm::engine::by_matrix::Discrete;
use fredholm::report::figures::patches as mesh;
use fredholm::report::text::summary;
use fredholm::report::write_atomically;

/// The files to write for other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Export {
    #[value(help = "patches, terms and norms")]
    Mesh,
    #[value(help = "F as well")]
    Matrix,
}

pub(super) fn write_mesh(r: &Discrete, what: Export, out: &mut Files) -> Result<(), Failure> {
    let m = &r.matrix;
    let patches = m.radiosity.patches();
    write_atomically(&out.add("mesh.csv"), mesh::mesh(patches, &m.solution.radiance).as_bytes())?;
    write_atomically(&out.add("mesh-terms.csv"), mesh::terms(&m.terms).as_bytes())?;
    let norms = summary::bounce_norms(patches, &m.terms);
    write_atomically(&out.add("norms.csv"), mesh::norms(&norms).as_bytes())?;
    if let (Export::Matrix, Some(dense)) = (what, m.radiosity.dense()) {
        write_atomically(&out.add("F.npy"), &mesh::npy(&dense.factors))?;
    }
    Ok(())
}
