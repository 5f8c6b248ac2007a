//! T_h in one of two forms: a dense matrix of deterministic form factors, or stored rays.
//!
//! | | dense | rays |
//! |---|---|---|
//! | F | [`FormFactors`](crate::operator::form_factor::FormFactors), n² numbers | [`Rays`], N hits a row, let go once everything is solved |
//! | good to | about 10⁴ patches | 10⁶ |
//! | solve | LU | Neumann series |
//! | error beside that of the mesh | visibility samples, not stated | the bar of the two halves, stated |

use crate::math::names::named;
use crate::operator::matrix::Spectral;
use crate::operator::patches::Patches;
use crate::operator::rays::{RayChecks, Rays};
use crate::solver::Radiosity;
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// Which form to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Factors {
    /// The matrix.
    #[default]
    Dense,
    /// So many rays a row.
    Rays(u32),
}

/// Which form is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A matrix of deterministic form factors.
    Dense,
    /// Rows of stored rays, with an error bar.
    Rays,
    /// The matrix, and how far rays on the same patches are from it.
    Both,
}

impl Form {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Dense, Self::Rays, Self::Both];
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Dense => "dense",
            Self::Rays => "rays",
            Self::Both => "both",
        })
    }
}

impl FromStr for Form {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

/// T_h with its mesh.
#[derive(Clone, Debug)]
pub enum Discretisation {
    /// The matrix.
    Dense(Radiosity),
    /// The mesh that rays were traced on, and how many. They are three quarters of the memory, and nothing reads them after
    /// the solve.
    Rays(Patches, u64),
}

/// Stored rays with their mesh, for what applies T once more.
#[derive(Clone, Debug)]
pub struct Stored {
    /// The mesh.
    pub patches: Patches,
    /// Its rows.
    pub rays: Rays,
}

impl From<Radiosity> for Discretisation {
    fn from(matrix: Radiosity) -> Self {
        Self::Dense(matrix)
    }
}

/// Lets the rays go.
impl From<Stored> for Discretisation {
    fn from(Stored { patches, rays }: Stored) -> Self {
        Self::Rays(patches, (rays.n * rays.per_row) as u64)
    }
}

impl Discretisation {
    /// The mesh.
    pub fn patches(&self) -> &Patches {
        match self {
            Self::Dense(r) => &r.patches,
            Self::Rays(patches, _) => patches,
        }
    }

    /// The matrix, if it is one.
    pub fn dense(&self) -> Option<&Radiosity> {
        match self {
            Self::Dense(r) => Some(r),
            Self::Rays(..) => None,
        }
    }

    /// Rays traced: for visibility, or all.
    pub fn rays(&self) -> u64 {
        match self {
            Self::Dense(r) => r.factors.rays,
            Self::Rays(_, rays) => *rays,
        }
    }
}

/// What is known about the sampling of stored rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledRows {
    /// N.
    pub per_row: usize,
    /// Relative L² error bar of the reflected light u, per channel, from the halves of the rows.
    pub noise: DVec3,
    /// What must hold, as measured.
    pub checks: RayChecks,
    /// Applications of T that the solve took.
    pub steps: usize,
}

/// Two realisations on one mesh, apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// ‖u_dense − u_rays‖ / ‖u_dense‖ over the patches by area, per channel.
    pub of_u: DVec3,
    /// Spectral radii of the rays, per channel.
    pub spectral: [Spectral; 3],
    /// The rays.
    pub sampling: SampledRows,
}
