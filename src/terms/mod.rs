//! What comes out: estimates of the terms `T^k E`, whichever world they come from.

mod series;

pub use series::{Cost, Estimate, Functional, Series, World};
