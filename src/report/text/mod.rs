//! What is made of text only: tables, Markdown, CSV, `summary.json`.

pub mod csv;
pub mod markdown;
mod null_as_nan;
pub mod number;
pub mod pixel_errors;
pub mod prose;
pub mod ranking;
pub(crate) mod rows;
pub mod summary;
pub mod table;
