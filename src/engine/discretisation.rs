//! T_h in one of two forms: a dense matrix of deterministic form factors, or stored rays.
//!
//! | | dense | rays |
//! |---|---|---|
//! | F | [`FormFactors`](crate::operator::form_factor::FormFactors), n² numbers | [`Rays`], N hits per row, freed after the solution |
//! | practical up to | about 10⁴ patches | 10⁶ patches |
//! | solve | LU | Neumann series |
//! | error in addition to that of the mesh | from visibility samples, not reported | from the difference of the two halves of each row, reported as an error bar |

use crate::math::names::named;
use crate::operator::matrix::Spectral;
use crate::operator::patches::Patches;
use crate::operator::rays::{RayChecks, Rays};
use crate::solver::Radiosity;
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// Form in which T_h is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Factors {
    /// A dense matrix of form factors.
    #[default]
    Dense,
    /// This number of stored rays per row.
    Rays(u32),
}

/// Form of T_h that the user requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A matrix of deterministic form factors.
    Dense,
    /// Rows of stored rays, with an error bar.
    Rays,
    /// The matrix, and the difference between it and stored rays on the same patches.
    Both,
}

impl Form {
    /// All forms.
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
    /// A dense matrix.
    Dense(Radiosity),
    /// The mesh on which rays were traced, and the number of these rays. The rays themselves are not kept: they need three
    /// quarters of the memory, and nothing reads them after the solution.
    Rays(Patches, u64),
}

/// Stored rays with their mesh, for callers that apply T once more.
#[derive(Clone, Debug)]
pub struct Stored {
    /// The mesh.
    pub patches: Patches,
    /// The stored rays, one row per patch.
    pub rays: Rays,
}

impl From<Radiosity> for Discretisation {
    fn from(matrix: Radiosity) -> Self {
        Self::Dense(matrix)
    }
}

/// Frees the rays.
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

    /// The dense matrix, if T_h is stored as one.
    pub fn dense(&self) -> Option<&Radiosity> {
        match self {
            Self::Dense(r) => Some(r),
            Self::Rays(..) => None,
        }
    }

    /// Number of rays traced: those for visibility, or all stored rays.
    pub fn rays(&self) -> u64 {
        match self {
            Self::Dense(r) => r.factors.rays,
            Self::Rays(_, rays) => *rays,
        }
    }
}

/// How accurate the rows of form factors are when each row is estimated from stored rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledRows {
    /// N, the number of rays per row.
    pub per_row: usize,
    /// Relative L² error bar of the reflected light u, per channel, from the halves of the rows.
    pub noise: DVec3,
    /// Checks of properties that must hold.
    pub checks: RayChecks,
    /// Applications of T that the solve took.
    pub steps: usize,
}

/// Difference between two realisations of T on the same mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// ‖u_dense − u_rays‖ / ‖u_dense‖ over the patches by area, per channel.
    pub of_u: DVec3,
    /// Spectral radii of the stored rays, per channel.
    pub spectral: [Spectral; 3],
    /// Accuracy of the stored rays.
    pub sampling: SampledRows,
}
