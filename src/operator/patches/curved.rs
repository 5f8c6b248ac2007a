//! Spheres and disks as flat facets that store the area of the true surface.
//!
//! ```text
//! sphere: rows of equal polar angle θ, each cut into nearly square cells; area R² Δz Δφ (Archimedes)
//! disk:   rings of equal width, each cut into sectors;                   area ½ (r₁² − r₀²) Δφ
//! ```
//!
//! The rows of a sphere have equal angle, not equal height. With equal height, the rows at the poles would span an angle of
//! order √h (h: cell size), and their facets would deviate from the sphere by O(h) instead of O(h²).

use glam::DVec3;
use std::f64::consts::{FRAC_PI_3, TAU};

/// The cells `first .. first + columns` of one row. `lo` and `hi` limit the height (sphere, in radii) or the radius (disk,
/// metres).
#[derive(Clone, Copy, Debug)]
struct Row {
    lo: f64,
    hi: f64,
    columns: usize,
    first: usize,
}

/// The surface on which the rows lie.
#[derive(Clone, Copy, Debug)]
enum Chart {
    Sphere { center: DVec3, radius: f64, inward: bool },
    Disk { center: DVec3, u: DVec3, v: DVec3 },
}

/// The cells of a sphere band or a disk.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    chart: Chart,
    rows: Vec<Row>,
}

/// A flat polygon that approximates a piece of a curved surface.
pub(super) struct Facet {
    /// Corners, counter-clockwise as seen from the front.
    pub(super) polygon: Vec<DVec3>,
    /// Area of the piece of the curved surface, m².
    pub(super) area: f64,
}

impl Grid {
    /// Cells of about the area `a` on the band `z` of a sphere. A row spans at most 60° of the polar angle and has at least
    /// six cells.
    pub(super) fn sphere(center: DVec3, radius: f64, z: [f64; 2], inward: bool, a: f64) -> Self {
        let [top, bottom] = [z[1].acos(), z[0].acos()];
        let span = bottom - top;
        let count = (radius * span / a.sqrt()).round().max((span / FRAC_PI_3 - 1e-9).ceil()).max(1.0) as usize;
        // the first and the last height are exactly the given ones
        let height = |i: usize| match i {
            0 => z[1],
            i if i == count => z[0],
            i => (top + span * i as f64 / count as f64).cos(),
        };
        let area = |lo: f64, hi: f64| TAU * radius * radius * (hi - lo);
        let rows = rows(count, 6, a, |i| [height(count - i), height(count - i - 1)], area);
        Self { chart: Chart::Sphere { center, radius, inward }, rows }
    }

    /// Cells of about the area `a` on a disk; every ring has at least six sectors.
    pub(super) fn disk(center: DVec3, normal: DVec3, radius: f64, a: f64) -> Self {
        let count = (radius / a.sqrt()).round().max(1.0) as usize;
        let r = |i: usize| radius * i as f64 / count as f64;
        let area = |lo: f64, hi: f64| 0.5 * TAU * (hi * hi - lo * lo);
        let (u, v) = normal.any_orthonormal_pair();
        Self { chart: Chart::Disk { center, u, v }, rows: rows(count, 6, a, |i| [r(i), r(i + 1)], area) }
    }

    /// Number of cells.
    pub(super) fn len(&self) -> usize {
        self.rows.last().map_or(0, |r| r.first + r.columns)
    }

    /// All facets in the order of their cells.
    pub(super) fn facets(&self) -> Vec<Facet> {
        self.rows.iter().flat_map(|row| (0..row.columns).map(move |c| self.facet(row, c))).collect()
    }

    fn facet(&self, row: &Row, column: usize) -> Facet {
        let angle = |c: usize| TAU * (c % row.columns) as f64 / row.columns as f64;
        let [a, b] = [angle(column), angle(column + 1)];
        match self.chart {
            Chart::Sphere { center, radius, inward } => {
                let at = |z: f64, phi: f64| {
                    let s = (1.0 - z * z).max(0.0).sqrt();
                    center + radius * DVec3::new(s * phi.cos(), s * phi.sin(), z)
                };
                let mut polygon = vec![at(row.lo, a), at(row.lo, b), at(row.hi, b), at(row.hi, a)];
                polygon.dedup_by(|p, q| p.distance(*q) <= 1e-12 * radius);
                if polygon[0].distance(polygon[polygon.len() - 1]) <= 1e-12 * radius {
                    polygon.pop();
                }
                if inward {
                    polygon.reverse();
                }
                Facet { polygon, area: TAU / row.columns as f64 * radius * radius * (row.hi - row.lo) }
            }
            Chart::Disk { center, u, v } => {
                let at = |r: f64, phi: f64| center + r * (phi.cos() * u + phi.sin() * v);
                let mut polygon = vec![at(row.lo, a), at(row.hi, a), at(row.hi, b), at(row.lo, b)];
                if row.lo == 0.0 {
                    polygon.pop();
                }
                Facet { polygon, area: 0.5 * TAU / row.columns as f64 * (row.hi * row.hi - row.lo * row.lo) }
            }
        }
    }

    /// The cell nearest to a point of the surface.
    pub(super) fn locate(&self, p: DVec3) -> usize {
        let (height, phi) = match self.chart {
            Chart::Sphere { center, .. } => {
                let d = (p - center).normalize();
                (d.z, d.y.atan2(d.x))
            }
            Chart::Disk { center, u, v } => {
                let (x, y) = ((p - center).dot(u), (p - center).dot(v));
                (x.hypot(y), y.atan2(x))
            }
        };
        let row = &self.rows[self.rows.partition_point(|r| r.hi < height).min(self.rows.len() - 1)];
        let column = (phi.rem_euclid(TAU) / TAU * row.columns as f64) as usize;
        row.first + column.min(row.columns - 1)
    }
}

fn rows(
    count: usize,
    least: usize,
    a: f64,
    span: impl Fn(usize) -> [f64; 2],
    area: impl Fn(f64, f64) -> f64,
) -> Vec<Row> {
    let mut first = 0;
    let row = |i| {
        let [lo, hi] = span(i);
        let columns = ((area(lo, hi) / a).round() as usize).max(least);
        first += columns;
        Row { lo, hi, columns, first: first - columns }
    };
    (0..count).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::patches::polygon::{area_vector, centroid};

    #[test]
    fn cells_tile_the_surface_and_are_found_again() {
        let c = DVec3::new(0.1, 0.2, 0.3);
        let grids = [
            (Grid::sphere(c, 2.0, [-1.0, 1.0], false, 0.1), 2.0 * TAU * 4.0, 1.0),
            (Grid::sphere(c, 2.0, [-0.3, 0.8], true, 0.05), TAU * 4.0 * 1.1, -1.0),
            (Grid::disk(c, DVec3::new(0.6, 0.0, 0.8), 2.0, 0.03), 0.5 * TAU * 4.0, 0.0),
        ];
        for (grid, area, outward) in grids {
            let facets = grid.facets();
            assert_eq!(facets.len(), grid.len());
            assert!((facets.iter().map(|f| f.area).sum::<f64>() - area).abs() < 1e-11);
            for (i, f) in facets.iter().enumerate() {
                assert_eq!(grid.locate(centroid(&f.polygon)), i);
                let a = area_vector(&f.polygon);
                assert!(a.length() < f.area * (1.0 + 1e-12) && a.length() > 0.8 * f.area);
                assert!(outward * a.dot(centroid(&f.polygon) - c) >= 0.0);
                assert!(outward != 0.0 || a.dot(DVec3::new(0.6, 0.0, 0.8)) > 0.0);
                // facets are planar
                assert!(f.polygon.iter().all(|p| a.normalize().dot(*p - f.polygon[0]).abs() < 1e-12));
            }
        }
    }
}
