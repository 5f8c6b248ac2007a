//! What a render by rays results in: series, images, and variances against samples.

use crate::engine::known::growth::Growth;
use crate::terms::functional::Replicates;
use crate::terms::history::Early;
use crate::terms::norms::SquaredNorm;
use crate::terms::variance::Snapshot;
use crate::terms::{Series, TermImage, TileSums, Variance};

/// Result of a render by rays: means with errors, images, and variances against samples.
#[derive(Clone, Debug)]
pub struct Sampled {
    /// Means and errors.
    pub series: Series,
    /// Images of T^k E, for k = 0..=K; empty for the path tracer.
    pub terms: Vec<TermImage>,
    /// Image of the tail: everything longer than K.
    pub tail: TermImage,
    /// Image of Σ_{k≤K} T^k E.
    pub sum: TermImage,
    /// The whole image.
    pub total: TermImage,
    /// The image mean by replicate, from which covariances between terms follow.
    pub replicates: Replicates,
    /// Sums over tiles by replicate, from which the means of blocks of tiles follow with their errors.
    pub tiles: TileSums,
    /// Rays requested, by slot.
    pub rays: Vec<u64>,
    /// Number of events behind the median pixel: of every slot, of the sum over k ≤ K, and of the whole.
    pub pixel_events: Vec<f64>,
    /// Images of the first samples, if they were asked for.
    pub early: Vec<Early>,
    /// Variances at 1, 2, 4, … samples per replicate.
    pub snapshots: Vec<Snapshot>,
    /// Squared L2 norms of the term images; none with fewer than three replicates.
    pub norms: Vec<Option<SquaredNorm>>,
    /// Smallest number of samples of a pixel: fewer than requested if the render was interrupted.
    pub spp: u32,
    /// Measured growth of the variance of long paths, if that variance is not known to be finite. The tail and the whole
    /// then have no error bar.
    pub doubt: Option<Growth>,
}

impl Sampled {
    /// Takes away the error bars of the tail and of the whole if there is a doubt about their variance.
    pub(crate) fn judged(mut self, doubt: Option<Growth>) -> Self {
        self.doubt = doubt;
        if let Some(d) = doubt {
            self.distrust(d.variance());
        }
        self
    }

    /// Replaces the error bars of the tail and of the whole by ∞ or NaN, in numbers and in images.
    pub fn distrust(&mut self, variance: Variance) {
        self.series.judge(variance);
        if let Some(instead) = variance.instead() {
            for image in [&mut self.tail, &mut self.total] {
                image.std_error.iter_mut().for_each(|e| *e = [instead as f32; 3]);
            }
        }
    }
}
