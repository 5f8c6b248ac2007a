//! Diagnosis of images from another renderer: finds out whether they are wrong, and which mistakes could be the cause. The
//! method combines what the file shows, families of mistakes with a fitted parameter, and simulations.
//!
//! The *suspect* is the set of images under test. The *reference* is the set of correct terms.
//!
//! ```text
//! r_k = mean S_k / mean T_k        correct: p(S, T) ≥ α        explanation c stays on the list while p(S, P_c) ≥ α
//! ```
//!
//! | step | what happens | place |
//! |---|---|---|
//! | pictures | terms and whole image, averaged down to at most 96 pixels a side where possible | [`picture`] |
//! | placement | turned, shifted or blurred pictures, exchanged channels | [`placement`], [`displacement`] |
//! | outliers | values that are not finite, and single pixels that are far too bright | [`outliers`] |
//! | display | curve, exposure, clipped pixels: from stored values to radiance | [`display`], [`curve`] |
//! | audit | are the error bars of the file honest? | [`audit`] |
//! | comparison | means of regions, t-tests adjusted by Holm | [`gap`], [`regions`] |
//! | evidence | ratios, whether they are constant over the image, counts | [`evidence`], [`series`], [`hints`] |
//! | families | rules for r_k with a fitted parameter | [`family`], [`fit`] |
//! | simulations | every member of the zoo on the same scene | [`elimination`], [`candidates`] |
//! | decision | the explanations that remain, in words | [`explain`], [`diagnose`] |
//!
//! *Correct* means two things: no significant difference from the reference was found, and a uniform bias above a stated
//! size would have been found. *Undecided* means that the file hides too much for either answer. A name is given only if at most
//! [`MOST`] explanations remain that are equally good. Ratios per bounce as a diagnostic follow the practice of rendering the terms one
//! by one (Arvo and Kirk 1990 for the mistakes in roulette; Veach 1997 for those of measure).

pub mod audit;
pub mod candidates;
mod compared;
mod correlated;
pub mod curve;
pub mod displacement;
pub mod display;
pub mod elimination;
pub mod encoded;
pub mod evidence;
pub mod explain;
pub mod family;
pub mod fit;
pub mod gap;
pub mod hints;
mod judge;
mod limits;
pub mod outliers;
pub mod picture;
pub mod placement;
pub mod plateau;
mod prepare;
mod rare;
pub mod regions;
mod rounding;
pub mod series;
mod variants;

pub use elimination::{Effort, Simulate, Tried};
pub use evidence::{Counts, Evidence};
pub use explain::{Basis, Suspicion};
pub use judge::diagnose;
pub use picture::{Code, Layer, Pictures, Slot};
pub use regions::{Region, Seen};

use serde::Serialize;

/// Wider pictures are averaged down to this width before they are compared, because the comparison uses means over regions.
pub const WIDEST: usize = 96;

/// Largest number of explanations that are named. More of them mean that the data cannot tell the cause.
pub const MOST: usize = 3;

/// Result of a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Conclusion {
    /// No significant difference from the reference.
    Correct,
    /// Significantly different from the reference.
    Wrong,
    /// The file hides too much for either answer, or is correct up to a factor that may be its exposure.
    Undecided,
}

/// A candidate that was simulated, as a row of the table.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Name of the member of the zoo.
    pub name: String,
    /// Smallest p-value of the comparison, adjusted for the number of comparisons.
    pub p: f64,
    /// Mean squared deviation, in squared standard errors.
    pub misfit: f64,
    /// Samples per pixel of its last simulation.
    pub spp: u32,
    /// True if the suspect differs significantly from the simulation.
    pub rejected: bool,
}

/// A family that was fitted, as a row of the table.
#[derive(Clone, Debug, Serialize)]
pub struct FamilyTried {
    /// What is wrong, with the fitted constant.
    pub what: String,
    /// Smallest adjusted p-value.
    pub p: f64,
    /// χ² of the fit, divided by the number of cells.
    pub chi2: f64,
    /// True if the family does not explain the suspect, or another one explains it much better.
    pub rejected: bool,
}

/// A reason why nothing, or not everything, can be told.
#[derive(Clone, Debug, Serialize)]
pub struct Limit {
    /// The reason: the part of a sentence after "because".
    pub why: String,
    /// What to send instead.
    pub next: String,
}

/// The result for one suspect.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// The conclusion.
    pub verdict: Conclusion,
    /// Adjusted p-value of the hypothesis that the suspect is correct, after its findings have been corrected.
    pub p: f64,
    /// Description of the largest difference; empty if there is none.
    pub worst: String,
    /// Smallest uniform relative bias that would have been found with probability 0.99; infinite if no bias would have been
    /// found.
    pub visible: f64,
    /// Reasons why nothing, or not everything, can be told.
    pub limits: Vec<Limit>,
    /// Pictures that are off by more than `visible` and by more than 5 %, but not significantly, for example because too few
    /// pixels carry their noise.
    pub undecided: Vec<Slot>,
    /// What the file itself shows: all of it is wrong.
    pub findings: Vec<Suspicion>,
    /// Explanations of the remaining difference, the best first: one of them is wrong, and the data cannot tell which.
    pub suspects: Vec<Suspicion>,
    /// Observations about the remaining difference that name no cause.
    pub hints: Vec<String>,
    /// How the stored values were read.
    pub display: display::Display,
    /// How the whole image relates to its layers.
    pub relation: family::Relation,
    /// The audits of the error bars.
    pub audits: Vec<audit::Audit>,
    /// Contrast of the edges of the picture, with its standard error; none if it has too few edges.
    pub contrast: Option<[f64; 2]>,
    /// Share of the pixels that are edges or lamps, which are compared only in sums.
    pub edges: f64,
    /// Pixels that were left out because they are far too bright.
    pub outliers: Vec<outliers::Outlier>,
    /// The evidence.
    pub evidence: Evidence,
    /// Change of the mean with the number of samples, if several numbers were given.
    pub samples: Option<series::BySamples>,
    /// Families that were fitted, best first.
    pub families: Vec<FamilyTried>,
    /// Candidates that were simulated, best first.
    pub candidates: Vec<Candidate>,
}

impl Diagnosis {
    /// The findings and the explanations with their names.
    pub fn named(&self) -> impl Iterator<Item = &Suspicion> {
        self.findings.iter().chain(&self.suspects)
    }
}

/// The input of a diagnosis.
pub struct Case<'a> {
    /// The pictures under test, as they are stored.
    pub suspect: &'a Pictures,
    /// Factor by which width and height are averaged down.
    pub factor: usize,
    /// The correct terms, of the averaged size.
    pub reference: &'a Pictures,
    /// Samples per pixel of the reference; NaN if not known.
    pub reference_spp: f64,
    /// What the camera sees, at the averaged size.
    pub seen: &'a Seen,
    /// The same render with different numbers of samples per pixel, including the suspect itself.
    pub by_samples: &'a [(u32, Pictures)],
    /// The same scene scaled by a factor, rendered by the renderer under test.
    pub scaled: Option<(f64, &'a Pictures)>,
    /// Candidates for simulation, if the scene is known.
    pub candidates: Option<&'a dyn Simulate>,
    /// Probability of an error: that a correct renderer is called wrong, and that the true cause is removed from the list.
    pub alpha: f64,
    /// Exposure of the suspect; None if unknown.
    pub gain: Option<f64>,
    /// Limits on the work of simulation.
    pub effort: Effort,
}
