//! Light that comes directly from emitters, by pairs of points instead of chance hits.
//!
//! ```text
//! (T E)ᵢ = ρᵢ/Aᵢ ∫_{Pᵢ} Σ_l E_l ∫_l v cos θ cos θ' / πr² dA' dA
//!        ≈ ρᵢ (1/S) Σₛ  E_l/p_l · v cos θ cos θ' / πr²              emitters l that are far from i
//!        + ρᵢ (1/N) Σₛ  E_{hit(i,s)}                               emitters that are near: the stored rays
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | l | emitting primitive, chosen ∝ power | [`Lamps`] |
//! | near | closer to the patch than 1.5 radii of the emitter: there the kernel varies too much for few pairs | [`Lamps::is_near`] |
//!
//! Either way the estimate is unbiased, so the line between near and far costs no accuracy in the mean.

use super::{Caster, NOTHING};
use crate::math::{Purpose, Rng};
use crate::operator::patches::{Patches, polygon::radius_about};
use crate::operator::rays::origin::Origins;
use glam::DVec3;
use std::f64::consts::PI;

struct Lamp {
    primitive: u32,
    emission: DVec3,
    centre: DVec3,
    radius: f64,
    /// Share of the choices that fall on this lamp or an earlier one.
    cumulative: f64,
    /// Density of its points, 1/m².
    density: f64,
}

/// The emitting primitives.
pub(super) struct Lamps(Vec<Lamp>);

/// Most pairs per half of a row; fewer where the row has fewer rays.
const PAIRS: usize = 256;

impl Lamps {
    pub(super) fn new(patches: &Patches) -> Self {
        let mut emission = vec![DVec3::ZERO; patches.primitives().len()];
        patches.iter().filter(|p| p.front).for_each(|p| emission[p.primitive] = p.emission);
        let power = |i: usize| patches.primitives()[i].area() * emission[i].element_sum();
        let whole: f64 = (0..emission.len()).map(power).sum();
        let mut cumulative = 0.0;
        let lamps = (0..emission.len()).filter(|i| power(*i) > 0.0).map(|i| {
            let p = &patches.primitives()[i];
            let [lo, hi] = p.bounds();
            cumulative += power(i) / whole;
            Lamp {
                primitive: i as u32,
                emission: emission[i],
                centre: 0.5 * (lo + hi),
                radius: 0.5 * (hi - lo).length(),
                cumulative,
                density: power(i) / whole / p.area(),
            }
        });
        Self(lamps.collect())
    }

    /// The lamp that the number `u` in [0, 1) chooses, and what is left of `u` as a number in [0, 1).
    fn choose(&self, u: f64) -> (&Lamp, f64) {
        let at = self.0.partition_point(|l| l.cumulative <= u).min(self.0.len() - 1);
        let below = if at == 0 { 0.0 } else { self.0[at - 1].cumulative };
        let rest = (u - below) / (self.0[at].cumulative - below);
        (&self.0[at], rest.clamp(0.0, 1.0 - f64::EPSILON))
    }

    fn find(&self, primitive: usize) -> Option<&Lamp> {
        self.0.binary_search_by_key(&(primitive as u32), |l| l.primitive).ok().map(|i| &self.0[i])
    }
}

impl Lamp {
    fn is_near(&self, centre: DVec3, radius: f64) -> bool {
        self.centre.distance(centre) < radius + 1.5 * self.radius
    }
}

impl Caster<'_> {
    /// T E of patch `i` by both halves of its samples; `row` holds the hits.
    pub(super) fn direct(&self, i: usize, row: &[u32]) -> [[f32; 3]; 2] {
        if self.lamps.0.is_empty() {
            return [[0.0; 3]; 2];
        }
        let (patch, half_row) = (&self.patches[i], row.len() / 2);
        let radius = radius_about(&patch.polygon, patch.centre);
        let mut light = [DVec3::ZERO; 2];
        for (k, &hit) in row.iter().enumerate().filter(|h| *h.1 != NOTHING) {
            let met = &self.patches[hit as usize];
            if met.emission != DVec3::ZERO
                && self.lamps.find(met.primitive).is_some_and(|l| l.is_near(patch.centre, radius))
            {
                light[k / half_row] += met.emission / half_row as f64;
            }
        }
        let pairs = half_row.min(PAIRS);
        let mut origins = Origins::new(self.patches, i);
        for s in 0..2 * pairs {
            let (x, [_, _, u, v]) = origins.next(|s| Rng::at(self.key, i as u32, s, 0, Purpose::Connect).four());
            let far = self.pair(x.position, x.normal, [u, v], |lamp| lamp.is_near(patch.centre, radius));
            light[s / pairs] += far / pairs as f64;
        }
        light.map(|l| (patch.reflectance * l).as_vec3().to_array())
    }

    /// One pair: E_l/p_l · v cos θ cos θ' / πr².
    fn pair(&self, x: DVec3, n: DVec3, [u, v]: [f32; 2], left_out: impl Fn(&Lamp) -> bool) -> DVec3 {
        let (lamp, u) = self.lamps.choose(u.into());
        if left_out(lamp) {
            return DVec3::ZERO;
        }
        let (y, m) = self.scene.point(2 * lamp.primitive, [u as f32, v]);
        let r = y.as_dvec3() - x;
        let square = r.length_squared();
        let cosines = n.dot(r) * -m.as_dvec3().dot(r);
        if n.dot(r) <= 0.0 || cosines <= 0.0 || self.scene.blocked(x.as_vec3(), n.as_vec3(), y, m) {
            return DVec3::ZERO;
        }
        lamp.emission * (cosines / (PI * square * square * lamp.density))
    }
}
