//! Pictures: files with linear radiance, 8-bit pictures, and sheets of pictures with labels.

pub mod contact_sheet;
pub mod exr;
pub mod picture;
pub mod sheet;
pub mod typeset;
pub mod zmap;
