//! One setting with several values: the cost and the noise of each value.
//!
//! ```text
//! V = n · Var(mean of n samples)        efficiency = 1 / (V · rays)   or   1 / (V · seconds)        rays, seconds: per path
//! ```
//!
//! The efficiency of independent samples does not depend on their number. Twice the efficiency means half the work for the
//! same error. Every term is charged with the rays of the whole path, because the whole path must be traced to sample it.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample, averaged over pixels and channels | [`Row::variance`] |
//! | n | samples per pixel | [`Row::spp`] |
//! | rays | rays requested for each slot | [`Row::rays`] |
//!
//! Reference: Hammersley and Handscomb, *Monte Carlo Methods* (1964), section 3.

mod answer;
mod budget;
pub mod fall;
pub mod fall_answer;
mod figure;
mod pictures;
mod rows;

pub use answer::{answer, small_table};
pub use budget::{Budget, budget_table};
pub use figure::draw;
pub use pictures::{Shown, pictures, reflected};
pub use rows::{Row, Sweep, csv, table};
