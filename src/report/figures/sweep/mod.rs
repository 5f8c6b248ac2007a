//! One setting, several values: what each value costs, and what it buys.
//!
//! ```text
//! V = n · Var(mean of n samples)        efficiency = 1 / (V · rays)   or   1 / (V · seconds)        rays, seconds: per path
//! ```
//!
//! The efficiency of independent samples does not depend on their number: twice as efficient is half the work for the
//! same error. Every term is charged with the whole path, because that is what has to be walked to get it.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample, averaged over pixels and channels | [`Row::variance`] |
//! | n | samples per pixel | [`Row::spp`] |
//! | rays | asked for on behalf of each slot | [`Row::rays`] |
//!
//! Reference: Hammersley and Handscomb, *Monte Carlo Methods* (1964), section 3.

pub mod fall;
mod figure;
mod rows;

pub use figure::draw;
pub use rows::{Row, Sweep, csv, table};
