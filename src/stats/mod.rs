//! Statistics: do two worlds agree, and how certain is the answer?
//!
//! ```text
//! effect = ⟨W, T^k E⟩₁ − ⟨W, T^k E⟩₂      Agrees: proved within ±δ      Differs: proved ≠ 0      else Inconclusive
//! ```
//!
//! | symbol | meaning (⟨W, ·⟩ is a linear functional of the image, such as its mean) | place |
//! |---|---|---|
//! | x̄, S | mean and covariance over replicates | [`moments`] |
//! | t, ν, p | test of one mean against another; Holm's adjustment for many tests | [`hypothesis`] |
//! | δ, α | margin of equivalence, and level of the family of tests: verdicts on whole results | [`verdict`] |
//! | n, β | sample sizes, and the effect that a test could have detected | [`power`] |
//! | n, n₄, k̂ | events behind a number: whether it gets an error bar, and whether it can have a verdict | [`evidence`] |
//! | γ | observed rate of decay of the terms | [`decay`] |
//! | E_n | evidence that may be checked after every batch, with its confidence interval | [`sequential`] |
//! | | comparison of two results batch by batch, in every quantity | [`detector`] |
//! | p | order of convergence under refinement | [`order`] |
//! | b | slope of the variance against samples | [`slope`] |
//! | b | exponent of a cost against the size of the work | [`power_law`] |
//! | D | distance of the distribution of p-values from the uniform one | [`uniformity()`] |
//! | Q_v, A_v, c_v | noise and cost of a roulette schedule, predicted without rendering | [`schedule`] |
//! | Q* | the most efficient schedule | [`optimal`] |
//!
//! Two principles. *Not rejected does not mean agreed*: a verdict of agreement needs an equivalence test, and that needs
//! samples. *Compare averages*: comparisons use image means, regions and projections, never single pixels. A bias common to
//! many pixels is invisible in each of them and obvious in their mean.

pub mod decay;
pub mod detector;
mod discretisation;
pub mod evidence;
pub mod hypothesis;
mod line;
pub mod moments;
pub mod optimal;
pub mod order;
pub mod power;
pub mod power_law;
mod quantity;
pub mod schedule;
pub mod sequential;
pub mod slope;
pub mod uniformity;
pub mod verdict;

pub use decay::{NoRate, Rate, TermMeans, observed_rate, ratio, tail_window};
pub use detector::{Detector, Finding};
pub use discretisation::discretisation;
pub use evidence::{Evidence, half_width_95};
pub use hypothesis::{Measured, critical, difference, holm, two_sided_p};
pub use moments::{Moments, estimate};
pub use optimal::optimal_reach;
pub use order::{Limit, Order, convergence_order, limit};
pub use power::{min_detectable, needed_samples};
pub use schedule::{Noise, Part, Separable};
pub use sequential::MeanSequence;
pub use slope::{Slope, falling_slope, variance_slope};
pub use uniformity::{Uniformity, uniformity};
pub use verdict::{Comparison, Criterion, Outcome, Verdict, compare};
