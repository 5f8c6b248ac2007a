//! Why there is no matrix of a scene.

use crate::scene::SceneError;

/// Why there is no matrix.
#[derive(Debug, thiserror::Error)]
pub enum MatrixError {
    /// The scene cannot be meshed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// `I − T_h` is singular: a channel keeps all its light.
    #[error(
        "error: a channel keeps all its light, so L = E + T L has no solution\nhelp: lower a reflectance below 1, or look at the first terms alone with --worlds terms,path --roulette none"
    )]
    Singular,
    /// r(T_h) is 1 or more, although every reflectance that light meets is below 1.
    #[error(
        "error: the form factors of this mesh are known too poorly: r(T_h) = {radius:.6}, although no reflectance is above {albedo:.6}\nhelp: raise --patches, or leave the radiosity world out: --worlds terms,path"
    )]
    Coarse {
        /// r(T_h).
        radius: f64,
        /// The largest reflectance that light meets.
        albedo: f64,
    },
    /// The iteration over stored rays came to no end.
    #[error(
        "error: the solution by stored rays has not settled: its residual is {residual:.1e} of the direct light\nhelp: use --factors dense, or leave the radiosity world out: --worlds terms,path"
    )]
    Unsettled {
        /// ‖D − (I − T) u‖ / ‖D‖ of the worst channel.
        residual: f64,
    },
    /// Interrupted.
    #[error("interrupted")]
    Stopped,
}
