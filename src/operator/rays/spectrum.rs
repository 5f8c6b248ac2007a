//! The spectral radius of sampled operators, three channels at once.
//!
//! ```text
//! r ≈ ‖T v‖ / ‖v‖ in the weight A/w, w = ρ,    v ← T v / ‖T v‖
//! ```
//!
//! T is self-adjoint in this weight only within the sampling error. The ratio is therefore an estimate, not a bound. Its
//! noise is that of a sum over all rays, which is much smaller than that of one row.

use super::solution::channels;
use super::{Light, Record, record};
use crate::operator::matrix::Spectral;
use glam::DVec3;

impl Light<'_> {
    /// The spectral radius r(T) per channel, by power iteration from `start` (for example u = ρ). The iteration ends when
    /// the relative change per step is at most `tolerance`, or after `max_steps` steps.
    pub fn spectral_radius(&self, start: &[Record], tolerance: f64, max_steps: usize) -> [Spectral; 3] {
        self.power_iteration(|i| self.patches[i].reflectance, start, tolerance, max_steps)
    }

    /// The spectral radius of `diag(w) F` by the same iteration. With w = ρ²/s it tells whether random walks with survival
    /// probability s have a finite variance.
    pub fn power_iteration(
        &self,
        w: impl Fn(usize) -> DVec3 + Sync + Send,
        start: &[Record],
        tolerance: f64,
        max_steps: usize,
    ) -> [Spectral; 3] {
        let mut v = start.to_vec();
        self.normalise(&w, &mut v);
        let mut found = [DVec3::ZERO; 3];
        let mut taken = 0;
        for step in 1..=max_steps {
            let y = self.mapped(&v, &w);
            let [at, to] = [&v, &y].map(|x| |i: usize| channels(x[i]));
            let radius = self.inner(&w, to, to).powf(0.5);
            let rayleigh = self.inner(&w, to, at);
            let off = |i: usize| to(i) - rayleigh * at(i);
            let settled = (radius - found[0]).abs().cmple(tolerance * radius).all();
            found = [radius, rayleigh, self.inner(&w, off, off).powf(0.5)];
            (v, taken) = (y, step);
            self.normalise(&w, &mut v);
            if settled {
                break;
            }
        }
        let largest = v.iter().fold(DVec3::ZERO, |a, x| a.max(channels(*x).abs()));
        let [radius, rayleigh, residual] = found;
        [0, 1, 2].map(|c| Spectral {
            radius: radius[c],
            rayleigh: rayleigh[c],
            residual: residual[c],
            steps: taken,
            mode: v.iter().map(|v| if largest[c] > 0.0 { f64::from(v[c]) / largest[c] } else { 0.0 }).collect(),
        })
    }

    /// Σ Aᵢ xᵢ yᵢ / wᵢ per channel, over the patches with wᵢ > 0.
    fn inner(&self, w: impl Fn(usize) -> DVec3, x: impl Fn(usize) -> DVec3, y: impl Fn(usize) -> DVec3) -> DVec3 {
        let one = |(i, a): (usize, &f64)| DVec3::select(w(i).cmpgt(DVec3::ZERO), *a * x(i) * y(i) / w(i), DVec3::ZERO);
        self.rays.area.iter().enumerate().map(one).sum()
    }

    fn normalise(&self, w: impl Fn(usize) -> DVec3, v: &mut [Record]) {
        let at = |i: usize| channels(v[i]);
        let length = self.inner(w, at, at).powf(0.5);
        let scale = DVec3::select(length.cmpgt(DVec3::ZERO), 1.0 / length, DVec3::ZERO);
        v.iter_mut().for_each(|v| *v = record(scale * channels(*v)));
    }
}
