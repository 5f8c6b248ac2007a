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

use super::{Caster, Scratch};
use crate::math::Purpose;
use crate::operator::patches::{Patches, polygon::radius_about};
use crate::operator::rays::{lattice::Lattice, origin::Origins};
use crate::scene::segment;
use glam::DVec3;
use std::f64::consts::PI;
use std::ops::Range;

struct Lamp {
    primitive: u32,
    /// The patches of its front, the only ones that emit.
    patches: Range<u32>,
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

/// Pairs per half of a row: half as many as rays, and no more than this. Their error is less than a third of that of
/// the rays.
const PAIRS: usize = 256;

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

    /// The lamp that the number `u` in [0, 1) chooses, and what is left of `u` as a number in [0, 1).
    fn choose(&self, u: f64) -> (&Lamp, f64) {
        let at = self.0.partition_point(|l| l.cumulative <= u).min(self.0.len() - 1);
        let below = if at == 0 { 0.0 } else { self.0[at - 1].cumulative };
        let rest = (u - below) / (self.0[at].cumulative - below);
        (&self.0[at], rest.clamp(0.0, 1.0 - f64::EPSILON))
    }

    /// The lamp that patch `hit` belongs to.
    fn find(&self, hit: u32) -> Option<&Lamp> {
        let at = self.0.partition_point(|l| l.patches.end <= hit);
        self.0.get(at).filter(|l| l.patches.contains(&hit))
    }
}

impl Lamp {
    fn is_near(&self, centre: DVec3, radius: f64) -> bool {
        self.centre.distance(centre) < radius + 1.5 * self.radius
    }
}

impl Caster<'_> {
    /// T E of patch `i` by both halves of its samples; `row` holds the hits.
    pub(super) fn direct(&self, i: usize, row: &[u32], scratch: &mut Scratch) -> [[f32; 3]; 2] {
        if self.lamps.0.is_empty() {
            return [[0.0; 3]; 2];
        }
        let (patch, half_row) = (&self.patches[i], row.len() / 2);
        let radius = radius_about(&patch.polygon, patch.centre);
        let near = |lamp: &Lamp| lamp.is_near(patch.centre, radius);
        let mut light = [DVec3::ZERO; 2];
        for (k, &hit) in row.iter().enumerate() {
            if let Some(lamp) = self.lamps.find(hit).filter(|l| near(l)) {
                light[k / half_row] += lamp.emission / half_row as f64;
            }
        }
        if !self.lamps.0.iter().all(near) {
            self.pairs(i, half_row.div_ceil(2).min(PAIRS), near, scratch, &mut light);
        }
        light.map(|l| (patch.reflectance * l).as_vec3().to_array())
    }

    /// Adds the mean over `pairs` pairs of points for either half.
    fn pairs(
        &self,
        i: usize,
        pairs: usize,
        near: impl Fn(&Lamp) -> bool,
        scratch: &mut Scratch,
        light: &mut [DVec3; 2],
    ) {
        let Scratch { wave, unblocked, .. } = scratch;
        let rays = &mut wave.rays;
        let mut origins = Origins::new(self.patches, i);
        let points = Lattice::new(self.key, i, Purpose::Connect);
        let mut facing = 0;
        for (s, unblocked) in unblocked[..2 * pairs].iter_mut().enumerate() {
            let (x, [u, v, ..]) = origins.next(|s| points.at(s));
            let (lamp, u) = self.lamps.choose(u.into());
            if near(lamp) {
                continue;
            }
            let (y, m) = self.scene.point(2 * lamp.primitive, [u as f32, v]);
            let r = y.as_dvec3() - x.position;
            let cosines = [x.normal.dot(r), -m.as_dvec3().dot(r)];
            if cosines[0] > 0.0 && cosines[1] > 0.0 {
                let square = r.length_squared();
                *unblocked = lamp.emission * (cosines[0] * cosines[1] / (PI * square * square * lamp.density));
                let (o, d) = segment(x.position.as_vec3(), x.normal.as_vec3(), y, m);
                rays.o.set(s, o);
                rays.d.set(s, d);
                rays.list[facing] = s as u32;
                facing += 1;
            }
        }
        self.scene.block_wave(rays, facing);
        for s in rays.list[..facing].iter().map(|s| *s as usize).filter(|s| rays.prim[*s] == 0) {
            light[s / pairs] += unblocked[s] / pairs as f64;
        }
    }
}
