//! What a reader sees: pictures, plots, tables, and the files that hold them.
//!
//! Everything here consumes plain data and returns plain data or a file. Nothing upstream imports from this folder,
//! nothing here prints, and equal input gives equal bytes: no time stamps, no system fonts, no hash order.
//!
//! ```text
//! text → image → plot → figures → page
//! ```
//!
//! | folder | makes |
//! |---|---|
//! | [`text`] | tables for the terminal and the book, CSV, `summary.json` |
//! | [`image`] | EXR, PNG, sheets of pictures with words |
//! | [`plot`] | axes, marks and curves: the parts of a figure |
//! | [`figures`] | what belongs to one study: its figure, its table, its CSV |
//! | [`page`] | `index.html` |
//!
//! | file | module |
//! |---|---|
//! | `terms.exr` | [`image::exr`] |
//! | `T00.png`, `terms.png`, `partial_00.png` | [`image::picture`], [`image::contact_sheet`] |
//! | z maps of `compare` | [`image::zmap`] |
//! | `decay.svg`, `variance.svg` and their PNGs | [`figures::decay`], [`figures::variance`] |
//! | `bias.svg`, `equilibrium.svg` and their PNGs | [`figures::watch`], [`figures::equilibrium`] |
//! | `variance.svg` of a sweep over spp | [`figures::sweep::fall`] |
//! | `covariance.svg`, `split.csv` | [`figures::split`] |
//! | sheets of one image as it grows | [`figures::stages`] |
//! | `roulette.csv`, `roulette.svg`, and its table | [`figures::roulette`] |
//! | `diagnosis.svg` | [`figures::diagnosis`] |
//! | `NAME-ratios.svg` of the zoo and its PNG | [`figures::signature`] |
//! | which `_se` layers can be trusted | [`text::pixel_errors`] |
//! | `summary.json` | [`text::summary`] |
//! | `modes.svg`, `modes-painted.png` | [`figures::modes`] |
//! | `eigenvalues.svg`, `eigenvalues.csv` of a sweep over patches | [`figures::drift`] |
//! | `mesh.csv`, `norms.csv`, `F.npy` | [`figures::patches`] |
//! | `solvers.svg`, its PNG, `history.csv` | [`figures::solvers`] |
//! | the whole from its first terms | [`figures::extrapolation`] |
//! | `index.html` | [`page::html`] |

mod error;
pub mod figures;
mod files;
pub mod image;
pub mod page;
pub mod plot;
pub mod text;

pub use crate::stats::half_width_95;
pub use error::ReportError;
pub use files::write_atomically;
