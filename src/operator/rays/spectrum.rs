//! The spectral radius of sampled operators, three channels at once.
//!
//! ```text
//! r ≈ ‖T v‖ / ‖v‖ in the weight A/ρ,     v ← T v / ‖T v‖
//! ```
//!
//! T is self-adjoint in that weight only within the sampling error, so the ratio is an estimate and no bound. Its noise is
//! that of a sum over all rays, much smaller than that of a row.

use super::{Half, Light};
use crate::operator::matrix::Spectral;
use glam::DVec3;

impl Light<'_> {
    /// r(T) per channel, from `start` (u = ρ will do) to the relative change `tolerance` per step.
    pub fn spectral_radius(&self, start: &[DVec3], tolerance: f64, max_steps: usize) -> [Spectral; 3] {
        let mut v = start.to_vec();
        self.normalise(&mut v);
        let mut found = [DVec3::ZERO; 3];
        let mut taken = 0;
        for step in 1..=max_steps {
            let y = self.bounce(&v, Half::Both);
            let radius = self.inner(&y, &y).powf(0.5);
            let rayleigh = self.inner(&y, &v);
            let off: Vec<DVec3> = y.iter().zip(&v).map(|(y, v)| *y - rayleigh * *v).collect();
            let settled = (radius - found[0]).abs().cmple(tolerance * radius).all();
            found = [radius, rayleigh, self.inner(&off, &off).powf(0.5)];
            (v, taken) = (y, step);
            self.normalise(&mut v);
            if settled {
                break;
            }
        }
        let largest = v.iter().fold(DVec3::ZERO, |a, x| a.max(x.abs()));
        let [radius, rayleigh, residual] = found;
        [0, 1, 2].map(|c| Spectral {
            radius: radius[c],
            rayleigh: rayleigh[c],
            residual: residual[c],
            steps: taken,
            mode: v.iter().map(|v| if largest[c] > 0.0 { v[c] / largest[c] } else { 0.0 }).collect(),
        })
    }

    /// Σ Aᵢ xᵢ yᵢ / ρᵢ per channel, over the patches that reflect in it.
    fn inner(&self, x: &[DVec3], y: &[DVec3]) -> DVec3 {
        let one = |((p, x), y): ((&crate::operator::patches::Patch, &DVec3), &DVec3)| {
            DVec3::select(p.reflectance.cmpgt(DVec3::ZERO), p.area * *x * *y / p.reflectance, DVec3::ZERO)
        };
        self.patches.iter().zip(x).zip(y).map(one).sum()
    }

    fn normalise(&self, v: &mut [DVec3]) {
        let length = self.inner(v, v).powf(0.5);
        let scale = DVec3::select(length.cmpgt(DVec3::ZERO), 1.0 / length, DVec3::ZERO);
        v.iter_mut().for_each(|v| *v *= scale);
    }
}
