//! Properties that sampled rows must have: exactly where they follow from counting, otherwise within the sampling error.
//!
//! ```text
//! Fᵢⱼ ≥ 0,  Fᵢⱼ ≤ 1,  Σⱼ Fᵢⱼ = 1 (closed)            exactly, by counting
//! ⟨f, F g⟩ = ⟨F f, g⟩ in the area inner product       within z standard errors, for smooth f and g
//! ```
//!
//! f and g run over the functions 1, x, y, z of the patch centres, measured from the middle of the scene. The standard error
//! is computed as if the rays were independent. Lattice points have a smaller error, so that a correct z stays well below 1.

use super::{Half, Hit, Light};
use glam::DVec3;

/// The measured properties of sampled rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayChecks {
    /// Smallest row sum.
    pub row_sum_min: f64,
    /// Largest row sum; by counting it is at most 1.
    pub row_sum_max: f64,
    /// Largest entry.
    pub largest: f64,
    /// Largest |⟨f, F g⟩ − ⟨F f, g⟩| relative to ‖f‖ ‖g‖.
    pub reciprocity: f64,
    /// The same difference in standard errors, computed as if the rays were independent.
    pub reciprocity_z: f64,
    /// Share of the rays that hit a reflecting surface at a point without a patch.
    pub lost: f64,
}

impl Light<'_> {
    /// Measures what the rows of form factors must fulfil: row sums, reciprocity, and the fraction of lost rays.
    pub fn checks(&self) -> RayChecks {
        let rays = self.rays;
        let n = rays.per_row as f64;
        let (mut least, mut most, mut largest) = (f64::INFINITY, 0.0f64, 0);
        for i in 0..rays.n {
            let mut met = 0;
            for half in rays.row(i) {
                met += half.partition_point(|h| *h != Hit::NOTHING);
            }
            (least, most) = (least.min(met as f64 / n), most.max(met as f64 / n));
            largest = largest.max(largest_count(rays.row(i)));
        }
        let (reciprocity, reciprocity_z) = self.reciprocity();
        RayChecks {
            row_sum_min: least,
            row_sum_max: most,
            largest: largest as f64 / n,
            reciprocity,
            reciprocity_z,
            lost: rays.lost as f64 / (n * rays.n as f64),
        }
    }

    fn reciprocity(&self) -> (f64, f64) {
        let area = &self.rays.area;
        let whole: f64 = area.iter().sum();
        let middle = self.patches.iter().map(|p| p.area * p.centre).sum::<DVec3>() / whole;
        let place: Vec<DVec3> = self.patches.iter().map(|p| p.centre - middle).collect();
        let one = vec![DVec3::ONE; place.len()];
        let (f_place, f_one) = (self.arrive(&place), self.arrive(&one));
        // second moments of the values that the rays of a row hit, for the standard error
        let square = self.arrive(&place.iter().map(|p| *p * *p).collect::<Vec<_>>());
        let of = |c: Option<usize>, x: &[DVec3], i: usize| c.map_or(1.0, |c| x[i][c]);
        let (mut relative, mut z) = (0.0f64, 0.0f64);
        let channels = [None, Some(0), Some(1), Some(2)];
        for (a, f) in channels.into_iter().enumerate() {
            for g in channels.into_iter().skip(a + 1) {
                let (mut difference, mut variance, mut ff, mut gg) = (0.0, 0.0, 0.0, 0.0);
                for i in 0..place.len() {
                    let (x, y) = (of(f, &place, i), of(g, &place, i));
                    let fx = f.map_or(f_one[i].x, |c| f_place[i][c]);
                    let fy = g.map_or(f_one[i].x, |c| f_place[i][c]);
                    difference += area[i] * (x * fy - fx * y);
                    let spread =
                        |c: Option<usize>, mean: f64| (c.map_or(f_one[i].x, |c| square[i][c]) - mean * mean).max(0.0);
                    // the covariance is at most the root of the product of the variances, so (a + b)² bounds the variance
                    let error = x.abs() * spread(g, fy).sqrt() + y.abs() * spread(f, fx).sqrt();
                    variance += (area[i] * error).powi(2) / self.rays.per_row as f64;
                    (ff, gg) = (ff + area[i] * x * x, gg + area[i] * y * y);
                }
                relative = worst(relative, difference.abs() / (ff * gg).sqrt());
                if variance > 0.0 {
                    z = worst(z, difference.abs() / variance.sqrt());
                }
            }
        }
        (relative, z)
    }

    /// F x: the arriving light, without albedos.
    fn arrive(&self, x: &[DVec3]) -> Vec<DVec3> {
        self.gathered(x, Half::Both, |_| DVec3::ONE)
    }
}

/// The larger of two numbers; NaN if one is NaN.
fn worst(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Number of rays that hit the most frequent patch of the row.
fn largest_count([a, b]: [&[Hit]; 2]) -> usize {
    let (mut i, mut j, mut largest) = (0, 0, 0);
    let at = |run: &[Hit], k: usize| run.get(k).map_or(Hit::MOST, |h| h.patch());
    loop {
        let hit = at(a, i).min(at(b, j));
        if hit == Hit::MOST {
            return largest;
        }
        let from = i + j;
        while at(a, i) == hit {
            i += 1;
        }
        while at(b, j) == hit {
            j += 1;
        }
        largest = largest.max(i + j - from);
    }
}
