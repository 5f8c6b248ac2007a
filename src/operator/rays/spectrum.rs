//! The spectral radius of sampled operators, three channels at once.
//!
//! ```text
//! r ≈ ‖T v‖ / ‖v‖ in the weight A/w, w = ρ,    v ← T v / ‖T v‖
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
        let rho: Vec<DVec3> = self.patches.iter().map(|p| p.reflectance).collect();
        self.power_iteration(&rho, start, tolerance, max_steps)
    }

    /// The same for `diag(w) F`: w = ρ²/s tells whether walks with survival s have a finite variance.
    pub fn power_iteration(&self, w: &[DVec3], start: &[DVec3], tolerance: f64, max_steps: usize) -> [Spectral; 3] {
        let mut v = start.to_vec();
        self.normalise(w, &mut v);
        let mut found = [DVec3::ZERO; 3];
        let mut taken = 0;
        for step in 1..=max_steps {
            let y = self.gathered(&v, Half::Both, |i| w[i]);
            let radius = self.inner(w, &y, &y).powf(0.5);
            let rayleigh = self.inner(w, &y, &v);
            let off: Vec<DVec3> = y.iter().zip(&v).map(|(y, v)| *y - rayleigh * *v).collect();
            let settled = (radius - found[0]).abs().cmple(tolerance * radius).all();
            found = [radius, rayleigh, self.inner(w, &off, &off).powf(0.5)];
            (v, taken) = (y, step);
            self.normalise(w, &mut v);
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

    /// Σ Aᵢ xᵢ yᵢ / wᵢ per channel, over the patches that count in it.
    fn inner(&self, w: &[DVec3], x: &[DVec3], y: &[DVec3]) -> DVec3 {
        let one = |(((a, w), x), y): (((&f64, &DVec3), &DVec3), &DVec3)| {
            DVec3::select(w.cmpgt(DVec3::ZERO), *a * *x * *y / *w, DVec3::ZERO)
        };
        self.rays.area.iter().zip(w).zip(x).zip(y).map(one).sum()
    }

    fn normalise(&self, w: &[DVec3], v: &mut [DVec3]) {
        let length = self.inner(w, v, v).powf(0.5);
        let scale = DVec3::select(length.cmpgt(DVec3::ZERO), 1.0 / length, DVec3::ZERO);
        v.iter_mut().for_each(|v| *v *= scale);
    }
}
