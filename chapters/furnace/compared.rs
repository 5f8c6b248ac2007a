//! Wrong renderers next to the right one.
//!
//! ```text
//! r_k = wrong T^k E / right T^k E, means over the image
//! ```

use super::{Pixels, render};
use fredholm::estimator::Technique;
use fredholm::report::book::{self, Folder};
use fredholm::zoo::signature::{Ratio, measured};
use fredholm::zoo::{Mistake, Right, Stage};
use std::error::Error;

/// Two wrong renderers next to the right one, in one scene.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The right image.
    pub right: Pixels,
    /// r_k and the image of `uniform-as-cosine`, then of `cosine-twice`.
    pub wrong: [(Vec<Ratio>, Pixels); 2],
}

// ANCHOR: compare
/// r_k = T_k of each wrong renderer / the right T_k.
pub fn compare(f: &Folder<'_>, scene: Stage, by: Technique, steps: [&dyn Mistake; 2]) -> book::Result<Compared> {
    let side = if by == Technique::Scatter { 32 } else { f.pick(96, 64) }; // the furnace has hardly any noise
    let right = render(f, scene, side, by, &Right, "right")?;
    let one = |step, name| {
        let wrong = render(f, scene, side, by, step, name)?;
        Ok::<_, Box<dyn Error>>((measured(wrong.series.image(), right.series.image()), wrong.total.mean))
    };
    let wrong = [one(steps[0], "wrong 1")?, one(steps[1], "wrong 2")?];
    Ok(Compared { right: right.total.mean, wrong })
}
// ANCHOR_END: compare
