//! The scene, its mesh with T, and the output folder: what `--solver` and `--modes` start from.

use super::args::Radiosity;
use crate::cli::base::{Failure, note};
use crate::cli::open::Opened;
use crate::cli::session::Session;
use crate::cli::{notes, preflight};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::{self, Matrix, MatrixError};
use fredholm::engine::discretisation::{Factors, Stored};
use fredholm::progress::Progress;
use fredholm::report::text::summary::Summary;
use fredholm::solver;
use fredholm::terms::Channel;
use glam::DVec3;

/// A scene, its mesh with T, and the session with the output folder.
pub struct Laboratory<R = solver::Radiosity> {
    pub session: Session,
    pub opened: Opened,
    pub matrix: Matrix<R>,
    /// Number of patches of the mesh, whether T is a matrix or stored rays.
    pub patches: usize,
}

impl Laboratory {
    /// Loads, meshes and computes form factors as a matrix; `None` if interrupted.
    pub fn new(args: &Radiosity, what: &str) -> Result<Option<Self>, Failure> {
        Laboratory::prepare(args, what, Factors::Dense, |opened, s, progress| {
            let Opened { description, scene, .. } = opened;
            let matrix = by_matrix::dense_matrix(description, scene, s.patches, s.grading, 0, progress)?;
            Ok((matrix.radiosity.patches.len(), matrix))
        })
    }
}

impl Laboratory<Stored> {
    /// The same as stored rays.
    pub fn sampled(args: &Radiosity, what: &str, per_row: u32) -> Result<Option<Self>, Failure> {
        Laboratory::prepare(args, what, Factors::Rays(per_row), |opened, s, progress| {
            let Opened { description, scene, .. } = opened;
            let matrix = by_matrix::sampled_matrix(description, scene, s.patches, per_row, s, progress)?;
            Ok((matrix.radiosity.patches.len(), matrix))
        })
    }
}

impl<R> Laboratory<R> {
    fn prepare(
        args: &Radiosity,
        what: &str,
        factors: Factors,
        make: impl FnOnce(&Opened, &Settings, Progress<'_>) -> Result<(usize, Matrix<R>), MatrixError>,
    ) -> Result<Option<Self>, Failure> {
        let mut session = Session::new(&args.shared, args.frame.seed)?;
        let opened = session.open(&args.frame.scene, &args.shared.changes, args.frame.size)?;
        let opened = Opened { scene: opened.scene.select_lights(args.pixels.lights), ..opened };
        preflight::has_a_matrix(&opened.description, &opened.scene, factors)?;
        let (patches, grading, seed) = (args.mesh.patches.unwrap_or(600) as usize, args.mesh.grading, args.frame.seed);
        let settings = Settings { patches, factors, grading, max_bounces: 0, seed, ..Settings::default() };
        preflight::rows_fit_in_memory(&opened.scene, &settings, 1)?;
        session.make_folder(&format!("{}-{what}", opened.description.name))?;
        let made = make(&opened, &settings, session.progress());
        session.clear();
        match made {
            Ok((patches, matrix)) => {
                if let Some(what) = notes::unlit(&matrix.unlit, &opened.description) {
                    note(&format!("note: {what}"));
                }
                Ok(Some(Self { session, opened, matrix, patches }))
            }
            Err(MatrixError::Stopped) => {
                session.nothing_to_save("");
                Ok(None)
            }
            Err(e) => {
                session.abandon();
                Err(e.into())
            }
        }
    }

    /// The channel asked for, or else the one with the largest spectral radius, which converges slowest.
    pub fn channel(&self, asked: Option<Channel>) -> Channel {
        let radii = DVec3::from_array(self.matrix.spectral.each_ref().map(|s| s.radius));
        asked.unwrap_or(Channel::ALL[radii.max_position()])
    }

    /// Writes `summary.json`. It has no width and height, because there is no image.
    pub fn sign(&self, files: &[String]) -> Result<(), Failure> {
        let record = Summary { width: 0, height: 0, files: files.to_vec(), ..self.session.record() };
        self.session.sign(&record)
    }
}
