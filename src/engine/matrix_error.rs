//! Reasons why a scene has no matrix.

use crate::scene::SceneError;

/// Reason why there is no matrix.
#[derive(Debug, thiserror::Error)]
pub enum MatrixError {
    /// The scene cannot be meshed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// `I − T_h` is singular: a channel loses no light.
    #[error(
        "error: one colour channel loses no light, so L = E + T L has no solution\nhelp: lower a reflectance below 1, or compute only the first terms with --worlds terms,path --roulette none"
    )]
    Singular,
    /// The spectral radius r(T_h) is 1 or more, although every reflectance that light meets is below 1.
    #[error(
        "error: the form factors of this mesh are too inaccurate: the spectral radius is {radius:.6}, although no reflectance is above {albedo:.6}\nhelp: raise --patches, or leave out the radiosity world: --worlds terms,path"
    )]
    Coarse {
        /// The spectral radius r(T_h).
        radius: f64,
        /// The largest reflectance that light meets.
        albedo: f64,
    },
    /// The iteration over stored rays did not converge.
    #[error(
        "error: the solution by stored rays has not converged: its residual is {residual:.1e} of the direct light\nhelp: use --factors dense, or leave out the radiosity world: --worlds terms,path"
    )]
    Unsettled {
        /// ‖D − (I − T) u‖ / ‖D‖ of the worst channel.
        residual: f64,
    },
    /// The user interrupted the computation.
    #[error("interrupted")]
    Stopped,
}
