//! Direct light from the emitters, estimated with pairs of points instead of chance hits.
//!
//! ```text
//! (T E)ᵢ = ρᵢ/Aᵢ ∫_{Pᵢ} Σ_l E_l ∫_l v cos θ cos θ' / πr² dA' dA
//!        ≈ ρᵢ (1/S) Σₛ  E_l/p_l · v cos θ cos θ' / πr²              emitters l that are far from i
//!        + ρᵢ (1/N) Σₛ  E_{hit(i,s)}                               emitters that are near: the stored rays
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | l | emitting primitive, chosen with probability proportional to its power | [`Lamps`](super::lamps::Lamps) |
//! | S | number of pairs of points | `PAIRS` |
//! | p_l | density of a point on emitter l, m⁻² | [`Lamp::density`](super::lamps::Lamp) |
//! | v | 1 if nothing blocks the segment between the points, else 0 | |
//! | N, hit(i, s) | number of rays of a patch; the patch that ray s hits | [`Rays`](super::Rays) |
//! | near | the distance from the patch to the centre of the emitter is below 1.5 radii of the emitter; there the kernel varies too much for few pairs | [`Lamp::is_near`](super::lamps::Lamp::is_near) |
//!
//! Both estimates are unbiased, so the choice of the limit between near and far does not bias the mean.

use super::caster::{Caster, Scratch};
use super::lamps::Lamp;
use super::lattice::Lattice;
use super::origin::Origins;
use crate::math::Purpose;
use crate::operator::patches::polygon::radius_about;
use crate::scene::segment;
use glam::DVec3;
use std::f64::consts::PI;

/// Largest number of pairs per half of a row. Half as many pairs as rays are used, up to this limit. Their error is less
/// than a third of that of the rays.
const PAIRS: usize = 256;

impl Caster<'_> {
    /// Direct light T E of patch `i`, estimated separately from each half of its samples; `row` holds the hits.
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

    /// Adds to the light of each half the mean over `pairs` pairs of points.
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
