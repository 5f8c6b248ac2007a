//! Roulette schedules compared: the answer in sentences, tables, CSV and a figure.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample, averaged over pixels and channels | [`Noise::all`](crate::stats::Noise::all), [`Noise::indirect`](crate::stats::Noise::indirect) |
//! | rays | rays per path | [`Noise::rays`](crate::stats::Noise::rays) |
//! | 1/(V rays) | efficiency | [`Noise::efficiency`](crate::stats::Noise::efficiency), [`Noise::indirect_efficiency`](crate::stats::Noise::indirect_efficiency) |
//! | z | (measured − predicted) divided by the standard error of the difference | [`Row::z`], [`Row::indirect_z`] |
//!
//! "Rays for the same error" means V · rays, the inverse of the efficiency. It is given relative to the lecture's schedule.

mod answer;
mod figure;
mod optima;
mod pictures;
mod rows;

pub use answer::{answer, quantity, small_table, verified};
pub use figure::draw;
pub use optima::{Shares, optima};
pub use pictures::{Shown, pictures};
pub use rows::{Row, csv, table};
