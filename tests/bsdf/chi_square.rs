//! Are directions drawn with the density that is claimed? Pearson's χ² over cells of the sphere.
//!
//! ```text
//! χ² = Σ_cells (O − E)²/E        E = n ∫_cell p dω
//! ```
//!
//! A direction is (z, φ), where solid angle is area. Cells are rectangles, halved again and again where a pilot sample is
//! dense: small in a lobe, growing with the distance from it. Their integrals do not use that sample, and neighbours are
//! taken together until each expects its share.

use glam::{DVec2, DVec3, Vec3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::TAU;

/// A rectangle of directions.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    z: [f64; 2],
    phi: [f64; 2],
}

/// Directions as (z, φ), with φ = π where ω_o is reflected to.
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    x: DVec2,
}

impl Chart {
    pub fn about(wo: Vec3) -> Self {
        Self { x: DVec2::new(f64::from(wo.x), f64::from(wo.y)).try_normalize().unwrap_or(DVec2::X) }
    }

    pub fn at(&self, wi: Vec3) -> [f64; 2] {
        let (x, y) = (f64::from(wi.x), f64::from(wi.y));
        let [a, b] = [self.x.x * x + self.x.y * y, self.x.x * y - self.x.y * x];
        [f64::from(wi.z), b.atan2(a).rem_euclid(TAU)]
    }

    pub fn direction(&self, z: f64, phi: f64) -> Vec3 {
        let (sin, cos) = phi.sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        let [a, b] = [r * cos, r * sin];
        DVec3::new(a * self.x.x - b * self.x.y, a * self.x.y + b * self.x.x, z).as_vec3()
    }
}

// Gauss and Legendre, three points
const NODES: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

impl Cell {
    fn gauss(&self, f: &impl Fn(f64, f64) -> DVec3) -> DVec3 {
        let at = |[a, b]: [f64; 2], x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x;
        let area = 0.25 * (self.z[1] - self.z[0]) * (self.phi[1] - self.phi[0]);
        let row = |(x, w): (f64, f64)| -> DVec3 {
            NODES.iter().map(|&(y, v)| w * v * f(at(self.z, x), at(self.phi, y))).sum()
        };
        area * NODES.iter().map(|&n| row(n)).sum::<DVec3>()
    }

    fn quarters(&self) -> [Self; 4] {
        let (z, phi) = (0.5 * (self.z[0] + self.z[1]), 0.5 * (self.phi[0] + self.phi[1]));
        let pick = |i: usize, [a, b]: [f64; 2], m: f64| if i == 0 { [a, m] } else { [m, b] };
        std::array::from_fn(|i| Self { z: pick(i % 2, self.z, z), phi: pick(i / 2, self.phi, phi) })
    }

    /// ∫ f dω over the cell: Gauss's rule, in quarters until they agree with the whole.
    fn integral(&self, f: &impl Fn(f64, f64) -> DVec3, tolerance: f64, depth: u32) -> DVec3 {
        let (whole, quarters) = (self.gauss(f), self.quarters());
        let parts = quarters.map(|q| q.gauss(f));
        let sum: DVec3 = parts.iter().sum();
        if (sum - whole).abs().max_element() <= tolerance || depth == 0 {
            return sum;
        }
        quarters.iter().map(|q| q.integral(f, 0.5 * tolerance, depth - 1)).sum()
    }
}

/// Cells that together cover the sphere.
#[derive(Debug)]
pub enum Tree {
    Leaf(usize),
    Split { axis: usize, at: f64, below: Box<Tree>, above: Box<Tree> },
}

/// The cells of a tree, in the order of its leaves.
#[derive(Debug)]
pub struct Cells {
    tree: Tree,
    pub cells: Vec<Cell>,
}

impl Cells {
    /// Cells with at most `most` of `pilot` each, at most 1/1024 of the sphere or so, never across one of the `cuts` in z.
    pub fn new(pilot: &mut [[f64; 2]], most: usize, cuts: &[f64]) -> Self {
        let mut cells = vec![];
        let whole = Cell { z: [-1.0, 1.0], phi: [0.0, TAU] };
        let tree = grow(pilot, whole, most, cuts, 0, &mut cells);
        Self { tree, cells }
    }

    /// The cell of a direction.
    pub fn find(&self, x: [f64; 2]) -> usize {
        let mut tree = &self.tree;
        loop {
            match tree {
                Tree::Leaf(i) => return *i,
                Tree::Split { axis, at, below, above } => tree = if x[*axis] < *at { below } else { above },
            }
        }
    }

    /// ∫ f dω over each cell, to about `tolerance` over all of them: where a cell and its quarters differ by so much, the
    /// quarters are much better.
    pub fn integrals(&self, f: impl Fn(f64, f64) -> DVec3, tolerance: f64) -> Vec<DVec3> {
        let each = tolerance / (self.cells.len() as f64).sqrt();
        self.cells.iter().map(|c| c.integral(&f, each, 7)).collect()
    }
}

fn grow(pilot: &mut [[f64; 2]], cell: Cell, most: usize, cuts: &[f64], depth: usize, cells: &mut Vec<Cell>) -> Tree {
    let cut = cuts.iter().copied().find(|&c| cell.z[0] < c && c < cell.z[1]);
    if cut.is_none() && depth >= 10 && (pilot.len() <= most || depth > 40) {
        cells.push(cell);
        return Tree::Leaf(cells.len() - 1);
    }
    let (axis, at) = match cut {
        Some(c) => (0, c),
        None if depth.is_multiple_of(2) => (0, 0.5 * (cell.z[0] + cell.z[1])),
        None => (1, 0.5 * (cell.phi[0] + cell.phi[1])),
    };
    pilot.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
    let (low, high) = pilot.split_at_mut(pilot.partition_point(|p| p[axis] < at));
    let (mut lower, mut upper) = (cell, cell);
    if axis == 0 {
        (lower.z[1], upper.z[0]) = (at, at);
    } else {
        (lower.phi[1], upper.phi[0]) = (at, at);
    }
    let below = Box::new(grow(low, lower, most, cuts, depth + 1, cells));
    let above = Box::new(grow(high, upper, most, cuts, depth + 1, cells));
    Tree::Split { axis, at, below, above }
}

/// Neighbours taken together until each expects a share 1/`count`.
pub fn together(counts: &[u64], probabilities: &[f64], count: usize) -> (Vec<u64>, Vec<f64>) {
    let (mut observed, mut expected) = (vec![0], vec![0.0]);
    for (o, p) in counts.iter().zip(probabilities) {
        if expected[expected.len() - 1] >= 1.0 / count as f64 {
            observed.push(0);
            expected.push(0.0);
        }
        *observed.last_mut().unwrap() += o;
        *expected.last_mut().unwrap() += p;
    }
    (observed, expected)
}

/// P(χ² ≥ observed) for counts against probabilities that add up to 1. Cells that expect less than 5 are taken together,
/// and with the next larger one if that is still too few.
pub fn p_value(counts: &[u64], probabilities: &[f64]) -> f64 {
    let n: u64 = counts.iter().sum();
    let mut cells: Vec<(f64, f64)> =
        counts.iter().zip(probabilities).map(|(&o, &p)| (p.max(0.0) * n as f64, o as f64)).collect();
    cells.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    while let [.., a, b] = cells[..]
        && b.0 < 5.0
    {
        cells.pop();
        *cells.last_mut().unwrap() = (a.0 + b.0, a.1 + b.1);
    }
    if cells.len() == 1 {
        return 1.0;
    }
    let chi2: f64 = cells.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    ChiSquared::new((cells.len() - 1) as f64).unwrap().sf(chi2)
}
