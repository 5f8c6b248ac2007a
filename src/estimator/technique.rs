//! How light is found: by hitting it, by connecting to it, or both.
//!
//! | technique | term k ≥ 1 is scored | weight |
//! |---|---|---|
//! | `Scatter` | when the walk lands on an emitter at vertex k | 1 |
//! | `Connect` | by next-event estimation from vertex k − 1 | 1 |
//! | `Mis` | both | balance heuristic `p / (p + p°)` |
//!
//! Term 0, emission seen directly, is always scored at vertex 0. Reference: Veach and Guibas, *Optimally Combining
//! Sampling Techniques* (1995).

use crate::math::Columns;
use crate::operator::Samples;

/// How light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// Emission counts where the walk hits it.
    Scatter,
    /// Emission counts through next-event estimation.
    Connect,
    /// Both, weighted so that each light path counts once.
    Mis,
}

impl Technique {
    /// Whether emission counts on hits.
    pub fn scatters(self) -> bool {
        self != Self::Connect
    }

    /// Whether there is next-event estimation.
    pub fn connects(self) -> bool {
        self != Self::Scatter
    }

    /// Weight of a sample with density `p` where the other technique has density `other`, both in the same measure.
    #[inline(always)]
    pub fn weight(self, p: f32, other: f32) -> f32 {
        if self == Self::Mis { p / (p + other) } else { 1.0 }
    }

    /// The weights of a wave, multiplied onto its values.
    pub fn weigh(self, samples: &mut Samples, n: usize) {
        if self == Self::Mis {
            let (p, other) = (&samples.pdf[..n], &samples.other_pdf[..n]);
            let Columns { x, y, z } = &mut samples.value;
            let (x, y, z) = (&mut x[..n], &mut y[..n], &mut z[..n]);
            for i in 0..n {
                let w = self.weight(p[i], other[i]);
                x[i] *= w;
                y[i] *= w;
                z[i] *= w;
            }
        }
    }
}

impl std::fmt::Display for Technique {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Scatter => "scatter",
            Self::Connect => "connect",
            Self::Mis => "mis",
        })
    }
}
