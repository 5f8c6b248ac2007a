//! What a reader sees: pictures, plots, tables, and the files that hold them.
//!
//! Everything here consumes plain data and returns plain data or a file. Nothing upstream imports from this folder,
//! nothing here prints, and equal input gives equal bytes: no time stamps, no system fonts, no hash order.
//!
//! | file | module |
//! |---|---|
//! | `terms.exr` | [`exr`] |
//! | `T00.png`, `terms.png`, `partial_00.png` | [`picture`], [`contact_sheet`] |
//! | z maps of `compare` | [`zmap`] |
//! | `decay.svg`, `variance.svg` and their PNGs | [`plot`], [`decay`], [`variance`] |
//! | `bias.svg`, `equilibrium.svg` and their PNGs | [`watch`], [`equilibrium`] |
//! | `variance.svg` of a sweep over spp | [`sweep::fall`] |
//! | `covariance.svg`, `split.csv` | [`split`] |
//! | sheets of one image as it grows | [`stages`] |
//! | `roulette.csv`, `roulette.svg`, and its table | [`roulette`] |
//! | `diagnosis.svg` | [`diagnosis`] |
//! | `NAME-ratios.svg` of the zoo and its PNG | [`signature`] |
//! | which `_se` layers can be trusted | [`pixel_errors`] |
//! | `summary.json` | [`summary`] |
//! | `modes.svg`, `modes-painted.png` | [`modes`] |
//! | `eigenvalues.svg`, `eigenvalues.csv` of a sweep over patches | [`drift`] |
//! | `mesh.csv`, `norms.csv`, `F.npy` | [`patches`] |
//! | `solvers.svg`, its PNG, `history.csv` | [`solvers`] |
//! | the whole from its first terms | [`extrapolation`] |
//! | `index.html` | [`html`] |
//! | tables on the terminal, and in the book | [`table`], [`markdown`] |

mod axis;
mod canvas;
pub mod contact_sheet;
pub mod decay;
pub mod diagnosis;
pub mod drift;
pub mod equilibrium;
mod error;
pub mod exr;
pub mod extrapolation;
mod files;
pub mod html;
pub mod markdown;
pub mod modes;
mod null_as_nan;
mod panel;
pub mod patches;
pub mod picture;
pub mod pixel_errors;
pub mod plot;
pub mod pyramid;
mod rate;
pub mod refine;
pub mod roulette;
pub mod signature;
pub mod solvers;
pub mod split;
pub mod stages;
pub mod summary;
pub mod sweep;
pub mod table;
pub mod typeset;
pub mod variance;
pub mod walk;
pub mod watch;
pub mod zmap;

pub use crate::stats::half_width_95;
pub use error::ReportError;
pub use files::write_atomically;
