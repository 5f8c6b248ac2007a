//! Output for readers: pictures, plots, tables, and the files that contain them.
//!
//! Everything in this folder takes plain data and returns plain data or writes a file. No module outside it and `cli`
//! imports from it, and nothing here prints. Equal input gives equal bytes: the files contain no time stamps, no system
//! fonts and no hash order.
//!
//! ```text
//! text → image → plot → figures → page;  book: what the chapters write;  exercise: questions and their truth
//! ```
//!
//! | folder | contents |
//! |---|---|
//! | [`text`] | tables for the terminal and the book, CSV, `summary.json` |
//! | [`image`] | EXR, PNG, sheets of pictures with labels |
//! | [`plot`] | axes, marks and curves: the parts of a figure |
//! | [`figures`] | for each study its figure, its table and its CSV |
//! | [`page`] | `index.html` |
//! | [`state`] | films in a file, from which a later run goes on |
//! | [`book`] | chapters and figures of the lecture: their folder, their claims |
//! | [`exercise`] | exercises that are judged: the student's numbers, the truth, the verdict |
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
//! | contact sheets of one image after more and more paths | [`figures::stages`] |
//! | `roulette.csv`, `roulette.svg`, and its table | [`figures::roulette`] |
//! | `pictures.png` of a sweep and of `roulette` | [`image::side_by_side`], [`figures::sweep::pictures`], [`figures::roulette::pictures`] |
//! | `diagnosis.svg` | [`figures::diagnosis`] |
//! | `NAME-ratios.svg` of the zoo and its PNG | [`figures::signature`] |
//! | list of the `_se` layers that can be trusted | [`text::pixel_errors`] |
//! | `summary.json` | [`text::summary`] |
//! | `modes.svg`, `modes-painted.png` | [`figures::modes`] |
//! | `eigenvalues.svg`, `eigenvalues.csv` of a sweep over patches | [`figures::drift`] |
//! | `growth.svg`, `growth-memory.svg`, their PNGs, `growth.csv`, `growth-fits.csv` | [`figures::growth`] |
//! | `mesh.csv`, `norms.csv`, `F.npy` | [`figures::patches`] |
//! | `solvers.svg`, its PNG, `history.csv` | [`figures::solvers`] |
//! | the whole image extrapolated from its first terms | [`figures::extrapolation`] |
//! | `index.html` | [`page::html`] |
//! | `state.fsh`, parts of a run | [`state`] |

pub mod book;
mod error;
pub mod exercise;
pub mod figures;
mod files;
pub mod image;
pub mod page;
pub mod plot;
pub mod state;
pub mod text;

pub use crate::stats::half_width_95;
pub use error::ReportError;
pub use files::{abandon_files, is_temporary, write_atomically};
