//! Rows of stored rays: traced as one, or as parts on several machines.
//!
//! | what | place |
//! |---|---|
//! | the meshes of a run, and the names of their rows | [`meshes`], [`mesh`] |
//! | the rows of one part, for [`Keep`] | [`keep_rows`] |

use super::Settings;
use super::discretisation::Factors;
use super::matrix_error::MatrixError;
use super::passes::Keep;
use crate::operator::patches::Patches;
use crate::operator::rays::{Hit, Rays, Rows};
use crate::progress::Progress;
use crate::scene::{Description, Scene, SceneError};

/// The meshes on which the discrete world traces rays: their numbers of patches, as asked for, the finest one last.
pub fn meshes(settings: &Settings) -> Vec<usize> {
    match settings.factors {
        Factors::Dense => vec![],
        Factors::Rays(_) => {
            let mut all = vec![(settings.patches / 4).max(1), settings.patches];
            all.dedup();
            all
        }
    }
}

/// The name of the rows of rays on a mesh of so many patches. Rows of equal name, scene and seed are equal.
pub fn mesh(settings: &Settings, patches: usize) -> String {
    let per_row = if let Factors::Rays(n) = settings.factors { n } else { 0 };
    let graded = if settings.grading == 1.0 { String::new() } else { format!(" (grading {})", settings.grading) };
    format!("{per_row} rays from each of {patches} patches{graded}")
}

/// Traces the rows of the part of `keep` on all [`meshes`], except those that are kept already.
///
/// # Errors
/// See [`MatrixError`].
pub fn keep_rows(
    description: &Description,
    scene: &Scene,
    settings: &Settings,
    progress: Progress<'_>,
    keep: &dyn Keep,
) -> Result<(), MatrixError> {
    let Factors::Rays(per_row) = settings.factors else { return Ok(()) };
    for n in meshes(settings) {
        let mesh = mesh(settings, n);
        if keep.has_rows(&mesh) {
            continue;
        }
        let (patches, part) = (Patches::graded(description, n, settings.grading)?, keep.part());
        let own = Rows::count(part, patches.len());
        begin_rays(&patches, per_row, own, progress)?;
        let per_row = Rays::rounded(per_row as usize);
        let rows = Rows::trace(&patches, scene, per_row, settings.seed, part, progress);
        keep.keep_rows(&mesh, &rows.map_err(|_| MatrixError::Stopped)?);
    }
    Ok(())
}

/// Traces all rows of a mesh.
pub(super) fn trace(
    patches: &Patches,
    scene: &Scene,
    per_row: u32,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Rays, MatrixError> {
    begin_rays(patches, per_row, patches.len(), progress)?;
    Rays::new(patches, scene, per_row as usize, seed, progress).map_err(|_| MatrixError::Stopped)
}

/// Announces rays from so many patches of a mesh; an error if the mesh has more than a ray can name.
fn begin_rays(patches: &Patches, per_row: u32, count: usize, progress: Progress<'_>) -> Result<(), MatrixError> {
    if patches.len() > Hit::MOST {
        let e = SceneError::new(format!(
            "{} patches are too many: stored rays can hold {} at most",
            patches.len(),
            Hit::MOST
        ));
        return Err(e.help("use fewer --patches, or a scene with fewer triangles: each face of a triangle (front, back) needs one patch").into());
    }
    progress.begin(&format!("{per_row} rays from each of {count} patches"), count as u64);
    Ok(())
}
