//! Choice of a lamp for next-event estimation, separately for each patch: in proportion to the light that the lamp sends to
//! the patch. A few test connections to each lamp estimate this light.
//!
//! ```text
//! P_i(l) = 0.85 v_il/Σ v_il + 0.10 o_il/Σ o_il + 0.05/n        T E = E[ (weight under the scene's own choice 1/n) / (n P_i(l)) ]
//! ```
//!
//! v_il is the light that arrives at patch i from lamp l; o_il is what would arrive if nothing were in between. The part
//! with o keeps a lamp possible that every test connection has missed because an edge hides it. The table only decides which
//! number selects the lamp, and the point on the lamp is chosen as without a guide. So the density of a connection is the
//! scene's density times n P_i(l). This factor depends only on the lamp and on the patch, so it is known exactly.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | P_i(l) | probability of lamp l at patch i | [`Lamps::choose`] |
//! | n P_i(l) | density divided by that of the scene's own choice | [`Lamps::ratio`] |
//! | v, o | root mean squares over the test connections, with and without occlusion | [`looks`] |
//!
//! References: Shirley, Wang, Zimmerman, *Monte Carlo Techniques for Direct Lighting Calculations* (1996); Vévoda,
//! Kondapaneni, Křivánek, *Bayesian online regression for adaptive direct illumination sampling* (2018), for tables per
//! region that learn which lamps are hidden.

use super::incident::vertex;
use crate::math::distribution::Discrete;
use crate::math::{Key, Purpose, Rng};
use crate::operator::SceneTransport;
use crate::operator::patches::{Patch, Patches};
use rayon::prelude::*;

/// Number of test connections from a patch to all lamps together, then the least and the largest number for each lamp.
const LOOKS: (usize, usize, usize) = (512, 4, 32);
/// Largest number of lamps with a table for every patch. With more lamps the tables would take more memory than everything
/// else.
const MANY: usize = 2048;
/// Shares of the three parts of P: visible light v, unoccluded light o, and the same probability for all lamps.
const SHARES: [f64; 3] = [0.85, 0.1, 0.05];

/// For every patch a distribution over the lamps.
pub(super) struct Lamps {
    choices: Vec<Option<Discrete>>,
    count: usize,
}

impl Lamps {
    /// Makes test connections to the lamps from every patch. `None` if there are fewer than two lamps or more than `MANY`.
    /// `scene` must be the scene from which `patches` were made.
    pub(super) fn new(scene: &SceneTransport<'_>, patches: &Patches, key: Key) -> Option<Self> {
        let count = scene.scene.lights.len();
        if !(2..=MANY).contains(&count) {
            return None;
        }
        let choice = |i: usize| Discrete::new(&mixed(&looks(scene, &patches[i], i, count, key))?);
        Some(Self { choices: (0..patches.len()).into_par_iter().map(choice).collect(), count })
    }

    /// The number that makes the scene select the lamp chosen by u, and the density of that lamp divided by that of the
    /// scene's own choice.
    #[inline(always)]
    pub(super) fn choose(&self, patch: usize, u: f32) -> (f32, f32) {
        let Some(choice) = &self.choices[patch] else { return (u, 1.0) };
        let (lamp, _) = choice.sample(u);
        ((lamp as f32 + 0.5) / self.count as f32, self.count as f32 * choice.probability(lamp))
    }

    /// The density with which a patch chooses this lamp, divided by that of the scene's own choice.
    #[inline(always)]
    pub(super) fn ratio(&self, patch: usize, lamp: u32) -> f32 {
        self.choices[patch].as_ref().map_or(1.0, |choice| self.count as f32 * choice.probability(lamp as usize))
    }
}

/// [v_l, o_l] of patch i for every lamp l, from test connections.
fn looks(scene: &SceneTransport<'_>, patch: &Patch, i: usize, lamps: usize, key: Key) -> Vec<[f64; 2]> {
    let (all, least, most) = LOOKS;
    let each = (all / lamps).clamp(least, most);
    let look = |lamp: usize, look: usize| {
        let numbers = |purpose| Rng::at(key, i as u32, look as u32, lamp + 1, purpose).four();
        let u = numbers(Purpose::Start);
        let at = vertex(patch, [u[2], u[3]]);
        let [_, b, c, d] = numbers(Purpose::Connect);
        let selects = (lamp as f32 + 0.5) / lamps as f32;
        let (step, normal) = scene.propose(&at, [selects, b, c, d])?;
        let value = f64::from((step.weight * scene.scene.light(&step.state)).element_sum()).powi(2);
        let hidden = scene.scene.blocked(at.p, normal, step.state.p, step.state.n);
        Some([if hidden { 0.0 } else { value }, value])
    };
    let mean = |lamp: usize| {
        let sum = (0..each).filter_map(|s| look(lamp, s)).fold([0.0, 0.0], |a, b| [a[0] + b[0], a[1] + b[1]]);
        sum.map(|s| (s / each as f64).sqrt())
    };
    (0..lamps).map(mean).collect()
}

/// P_i for every lamp; `None` if no lamp would be visible even without occlusion.
fn mixed(looks: &[[f64; 2]]) -> Option<Vec<f64>> {
    let [seen, unhidden] = [0, 1].map(|which| looks.iter().map(|look| look[which]).sum::<f64>());
    let part = |share: f64, value: f64, sum: f64| if sum > 0.0 { share * value / sum } else { 0.0 };
    let [a, b, c] = SHARES;
    let one = |look: &[f64; 2]| part(a, look[0], seen) + part(b, look[1], unhidden) + c / looks.len() as f64;
    (unhidden > 0.0 && unhidden.is_finite()).then(|| looks.iter().map(one).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Over all numbers u every lamp is selected as often as its ratio says, including a lamp that no test connection has
    /// found. A patch that sees no lamp chooses as the scene does.
    #[test]
    fn lamps_are_chosen_with_the_ratio_they_claim() {
        let looks = [[3.0, 4.0], [0.0, 2.0], [1e-6, 1e-6], [0.0, 0.0], [0.5, 0.5]];
        let choices = vec![Discrete::new(&mixed(&looks).unwrap()), None];
        let (lamps, n, all) = (Lamps { choices, count: looks.len() }, looks.len() as f32, 1u32 << 20);
        assert_eq!(mixed(&[[0.0, 0.0]; 3]), None);
        let mut counts = [0u32; 5];
        for j in 0..all {
            let u = (j as f32 + 0.5) / all as f32;
            let (number, ratio) = lamps.choose(0, u);
            // the lamp that the scene selects with this number
            let lamp = (number * n) as usize;
            assert_eq!(ratio, lamps.ratio(0, lamp as u32));
            assert_eq!(lamps.choose(1, u), (u, 1.0));
            counts[lamp] += 1;
        }
        for (lamp, &count) in counts.iter().enumerate() {
            let expected = lamps.ratio(0, lamp as u32) * all as f32 / n;
            assert!(count > 0 && (count as f32 - expected).abs() <= 2.0, "{lamp}: {count}, {expected}");
        }
    }
}
