//! Pictures: files with linear radiance, 8-bit pictures, and sheets of pictures with labels.

mod codes;
pub mod contact_sheet;
pub mod exposure;
pub mod exr;
pub mod foreign;
pub mod picture;
pub mod sheet;
pub mod side_by_side;
pub mod typeset;
pub mod zmap;
