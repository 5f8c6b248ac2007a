//! The report of a run as one page.

pub mod gallery;
pub mod html;
mod tables;
