//! How many paths the results without an image get: a share of the run.
//!
//! ```text
//! P = min(pixels · samples, rays/(K + 1))        norms P/192        long terms P/96 on each sensor        each surface P/768
//! moments (pixels · samples)/128
//! ```
//!
//! The long terms and the moments have longer paths than the run, and the norms by `single` walk once for each term. Where most paths
//! of the run leave the scene early, paths that start on its surfaces are longer, so P is smaller there. All these results together
//! take about a tenth of the run. Below a lower limit their answers would be useless; a run of fewer paths than that takes a moment anyway.
//! Beyond an upper limit they are more exact than anything that is printed.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | P | paths of one estimator of the run, or fewer if these are short | [`Share::of`] |
//! | rays | rays of the run, closest-hit and shadow together: 2 K + 1 for a path that never ends early | [`Share::of`] |
//! | | paths for ‖T^k E‖₁, by estimator | [`Share::norms`] |
//! | | paths for the question how many bounces are enough, on each of two sensors | [`Share::bounces`] |
//! | | paths for the question which bounce lights what, on each of up to six surfaces | [`Share::lit`] |

use crate::progress::{Listener, Progress};

/// Numbers of paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Share {
    pixels: u64,
    run: u64,
    pub(super) norms: u32,
    pub(super) bounces: u32,
    pub(super) lit: u32,
}

/// Fewest and most paths: norms of ten terms with errors of a percent; K to a bounce or two; shares of single percents.
const NORMS: [u64; 2] = [1 << 14, 1 << 22];
const BOUNCES: [u64; 2] = [1 << 15, 1 << 20];
const LIT: [u64; 2] = [1 << 13, 1 << 18];
/// Samples of a pixel of which moments are recorded, and the fewest pixels.
const SAMPLES: [u32; 2] = [2, 16];
const PIXELS: u64 = 4096;

impl Share {
    /// The shares of a run with terms up to K = `max_bounces` that has traced so many rays.
    pub(super) fn of([w, h]: [u32; 2], spp: u32, rays: u64, max_bounces: usize) -> Self {
        let pixels = u64::from(w) * u64::from(h);
        let run = pixels * u64::from(spp);
        let paths = run.min(rays / (max_bounces as u64 + 1));
        let part = |of: u64, [least, most]: [u64; 2]| (paths / of).clamp(least, most) as u32;
        Self { pixels, run, norms: part(192, NORMS), bounces: part(96, BOUNCES), lit: part(768, LIT) }
    }

    /// Samples per pixel, and pixels, of which moments are recorded.
    pub(super) fn moments(&self, spp: u32) -> (u32, u32) {
        let samples = (spp / 32).clamp(SAMPLES[0], SAMPLES[1]);
        let pixels = (self.run / 128 / u64::from(samples)).max(PIXELS).min(self.pixels);
        (samples, pixels as u32)
    }

    /// About the number of paths of all results, for the progress bar.
    pub(super) fn all(&self, estimators: usize, longer: bool, moments: bool) -> u64 {
        let longer = if longer { 2 * u64::from(self.bounces) + 6 * u64::from(self.lit) } else { 0 };
        estimators as u64 * u64::from(self.norms) + longer + if moments { self.run / 128 } else { 0 }
    }
}

/// Progress of several computations that run side by side: one bar for all of them.
pub(super) struct Together<'a>(pub(super) Progress<'a>);

impl Listener for Together<'_> {
    fn advance(&self, units: u64) {
        self.0.advance(units);
    }
}

#[cfg(test)]
mod tests {
    use super::Share;

    /// With one path tracer and one estimator, all together stay below a tenth, counted in paths; the smallest run gets the
    /// lower limits, and short paths a smaller share.
    #[test]
    fn what_was_not_asked_for_is_a_small_share() {
        for (size, spp) in [([256, 256], 64), ([512, 512], 1024), ([1920, 1080], 256)] {
            let run = u64::from(size[0] * size[1]) * u64::from(spp);
            let share = Share::of(size, spp, 17 * run, 8);
            assert!(share.all(2, true, true) * 16 < run, "{share:?}");
            let (samples, pixels) = share.moments(spp);
            assert!(samples >= 2 && u64::from(samples) * u64::from(pixels) * 120 < run);
        }
        // paths of three rays in place of seventeen
        let [long, short] = [17, 3].map(|rays| Share::of([256, 256], 256, rays << 24, 8));
        assert_eq!((short.norms, short.bounces), (long.norms / 3, long.bounces / 3));
        let tiny = Share::of([8, 8], 64, 17 << 12, 8);
        assert_eq!((tiny.norms, tiny.bounces, tiny.lit, tiny.moments(64)), (1 << 14, 1 << 15, 1 << 13, (2, 64)));
    }
}
