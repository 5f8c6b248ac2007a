//! Output that consists of text: tables, Markdown, CSV, `summary.json`.

pub mod csv;
pub mod grid;
pub mod markdown;
pub mod measured;
mod null_as_nan;
pub mod number;
pub mod pixel_errors;
pub mod prose;
pub mod ranking;
pub(crate) mod rows;
pub mod sentence;
pub mod summary;
pub mod table;
