//! Do two worlds agree, and how sure are we?
//!
//! ```text
//! effect = ⟨W, T^k E⟩₁ − ⟨W, T^k E⟩₂      Agrees: proved within ±δ      Differs: proved ≠ 0      else Inconclusive
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x̄, S | mean and covariance over replicates | [`moments`] |
//! | t, ν, p | tests of one mean against another, Holm's adjustment | [`hypothesis`] |
//! | δ, α | margin of equivalence, family level: verdicts on whole results | [`verdict`] |
//! | n, β | sample sizes and what a test could have seen | [`power`] |
//! | n, n₄, k̂ | what a number rests on: whether it may have an error, and may be judged | [`evidence`] |
//! | γ | observed rate of decay of the terms | [`decay`] |
//! | E_n | evidence that may be watched while it grows, and the interval that goes with it | [`sequential`] |
//! | | two results watched batch by batch, in every quantity | [`detector`] |
//! | p | order of convergence under refinement | [`order`] |
//! | b | slope of the variance against samples | [`slope`] |
//! | D | distance of p-values from uniform ones | [`uniformity()`] |
//! | Q_v, A_v, c_v | noise and cost of a roulette schedule, without rendering it | [`schedule`] |
//! | Q* | the schedule with the most efficiency | [`optimal`] |
//!
//! Two principles. *Not rejected is not agreed*: a verdict of agreement is an equivalence test, and it needs samples.
//! *Aggregate*: image means, regions and projections are compared, never pixels one by one, because a bias common to
//! many pixels is invisible in each and obvious in their mean.

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
