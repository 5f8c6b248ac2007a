//! The cell of a point: the lines of a tree in the plane's own coordinates, twenty bytes each.
//!
//! ```text
//! (s, t) = ((x − o)·e₁, (x − o)·e₂)        go low where a s + b t ≤ c, else high, until a cell is reached
//! ```

use super::polygon::area_vector;
use glam::DVec3;

/// Marks a child that is a cell.
pub(super) const LEAF: u32 = 1 << 31;

#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    axis: [f32; 2],
    offset: f32,
    pub(super) children: [u32; 2],
}

/// Finds cells by their number in the order of the tree's cells.
#[derive(Clone, Debug)]
pub(super) struct Finder {
    origin: DVec3,
    frame: [DVec3; 2],
    pub(super) root: u32,
    pub(super) lines: Vec<Line>,
}

impl Finder {
    /// No lines yet, in the plane of some cell.
    pub(super) fn new(cell: Option<&[DVec3]>) -> Self {
        let origin = cell.map_or(DVec3::ZERO, |p| p[0]);
        let normal = cell.map_or(DVec3::Z, |p| area_vector(p).normalize());
        Self { origin, frame: normal.any_orthonormal_pair().into(), root: LEAF, lines: Vec::new() }
    }

    pub(super) fn line(&self, axis: DVec3, offset: f64) -> Line {
        let axis2 = self.frame.map(|e| e.dot(axis) as f32);
        Line { axis: axis2, offset: (offset - axis.dot(self.origin)) as f32, children: [LEAF; 2] }
    }

    /// The cell a point of the plane belongs to; points outside belong to the cell whose side of every line they share.
    pub(super) fn locate(&self, p: DVec3) -> usize {
        let d = p - self.origin;
        let [s, t] = self.frame.map(|e| e.dot(d) as f32);
        let mut at = self.root;
        while at & LEAF == 0 {
            let line = &self.lines[at as usize];
            at = line.children[usize::from(line.axis[0] * s + line.axis[1] * t > line.offset)];
        }
        (at ^ LEAF) as usize
    }

    /// For every cell, the number of the group it belongs to: the largest subtrees of at most `most` cells.
    pub(super) fn groups(&self, cells: usize, most: usize) -> Vec<u32> {
        let (mut group, mut next) = (vec![0; cells], 0);
        self.collect(self.root, most, &mut group, &mut next);
        group
    }

    fn collect(&self, at: u32, most: usize, group: &mut [u32], next: &mut u32) {
        if at & LEAF == 0 && self.count(at) > most {
            self.lines[at as usize].children.iter().for_each(|c| self.collect(*c, most, group, next));
            return;
        }
        self.assign(at, group, *next);
        *next += 1;
    }

    fn assign(&self, at: u32, group: &mut [u32], number: u32) {
        if at & LEAF != 0 {
            group[(at ^ LEAF) as usize] = number;
            return;
        }
        self.lines[at as usize].children.iter().for_each(|c| self.assign(*c, group, number));
    }

    fn count(&self, at: u32) -> usize {
        if at & LEAF != 0 { 1 } else { self.lines[at as usize].children.iter().map(|c| self.count(*c)).sum() }
    }
}
