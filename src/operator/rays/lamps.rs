//! The emitting primitives, with a distribution for choosing one of them.

use crate::operator::patches::Patches;
use glam::DVec3;
use std::ops::Range;

pub(super) struct Lamp {
    pub(super) primitive: u32,
    /// The patches on its front side; only these emit.
    pub(super) patches: Range<u32>,
    pub(super) emission: DVec3,
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    /// Probability of choosing this lamp or an earlier one.
    pub(super) cumulative: f64,
    /// Probability of choosing this lamp divided by its area: the density of its points, 1/m².
    pub(super) density: f64,
}

/// The emitting primitives.
pub(super) struct Lamps(pub(super) Vec<Lamp>);

impl Lamps {
    pub(super) fn new(patches: &Patches) -> Self {
        // patches are numbered primitive by primitive, front before back
        let mut emission = vec![DVec3::ZERO; patches.primitives().len()];
        let mut own = vec![0..0; emission.len()];
        for (i, p) in patches.iter().enumerate().filter(|p| p.1.front && p.1.emission != DVec3::ZERO) {
            emission[p.primitive] = p.emission;
            let first = if own[p.primitive].is_empty() { i as u32 } else { own[p.primitive].start };
            own[p.primitive] = first..i as u32 + 1;
        }
        let power = |i: usize| patches.primitives()[i].area() * emission[i].element_sum();
        let whole: f64 = (0..emission.len()).map(power).sum();
        let mut cumulative = 0.0;
        let lamps = (0..emission.len()).filter(|i| power(*i) > 0.0).map(|i| {
            let p = &patches.primitives()[i];
            let [lo, hi] = p.bounds();
            cumulative += power(i) / whole;
            Lamp {
                primitive: i as u32,
                patches: own[i].clone(),
                emission: emission[i],
                centre: 0.5 * (lo + hi),
                radius: 0.5 * (hi - lo).length(),
                cumulative,
                density: power(i) / whole / p.area(),
            }
        });
        Self(lamps.collect())
    }

    /// The lamp that the number `u` in [0, 1) chooses, and the rest of `u`, rescaled to [0, 1).
    pub(super) fn choose(&self, u: f64) -> (&Lamp, f64) {
        let at = self.0.partition_point(|l| l.cumulative <= u).min(self.0.len() - 1);
        let below = if at == 0 { 0.0 } else { self.0[at - 1].cumulative };
        let rest = (u - below) / (self.0[at].cumulative - below);
        (&self.0[at], rest.clamp(0.0, 1.0 - f64::EPSILON))
    }

    /// The lamp to which patch `hit` belongs.
    pub(super) fn find(&self, hit: u32) -> Option<&Lamp> {
        let at = self.0.partition_point(|l| l.patches.end <= hit);
        self.0.get(at).filter(|l| l.patches.contains(&hit))
    }
}

impl Lamp {
    pub(super) fn is_near(&self, centre: DVec3, radius: f64) -> bool {
        self.centre.distance(centre) < radius + 1.5 * self.radius
    }
}
