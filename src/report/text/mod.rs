//! What is made of text only: tables, Markdown, `summary.json`.

pub mod markdown;
mod null_as_nan;
pub mod number;
pub mod pixel_errors;
pub(crate) mod rows;
pub mod summary;
pub mod table;
