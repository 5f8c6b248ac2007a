//! Pictures: linear radiance in files, developed to 8 bits, on sheets with words.

pub mod contact_sheet;
pub mod exr;
pub mod picture;
pub(crate) mod sheet;
pub mod typeset;
pub mod zmap;
