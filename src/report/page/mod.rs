//! The report of a run as one page.

pub mod html;
mod tables;
