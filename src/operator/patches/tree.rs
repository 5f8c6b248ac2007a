//! A flat primitive that lines cut into convex cells. It is stored as a tree, so that the cell of a point is found by the
//! signs at the lines.
//!
//! ```text
//! split(cell, axis, s):   low  = cell ∩ {axis·x ≤ s}      high = cell ∩ {axis·x > s}
//! bisect(cell, c):        ⌊c/2⌋ : ⌈c/2⌉ of the area, recursively, until c = 1
//! ```

use super::finder::{Finder, LEAF};
use super::grading::{Chart, Part};
use super::patch::Corners;
use super::polygon::{area_vector, clip, equal_area_line, extent};
use glam::DVec3;

#[derive(Clone, Debug)]
enum Node {
    Split { axis: DVec3, offset: f64, children: [u32; 2] },
    Cell(Corners),
}

/// The cells of one flat primitive.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Size of the primitive, metres; tolerances are shares of it.
    size: f64,
    /// Lengths below this count as zero, metres.
    tiny: f64,
}

/// Lengths below this share of the primitive's size always count as zero.
const TINY: f64 = 1e-9;

impl Tree {
    /// A tree with one cell; lengths below `tiny` will count as zero.
    pub(super) fn new(polygon: Vec<DVec3>, tiny: f64) -> Self {
        let size = polygon.iter().map(|p| p.distance(polygon[0])).fold(0.0, f64::max);
        Self { nodes: vec![Node::Cell(polygon.into())], size, tiny: tiny.max(TINY * size) }
    }

    /// Lengths below this count as zero, metres.
    pub(super) fn tiny(&self) -> f64 {
        self.tiny
    }

    /// The node numbers of the cells, and their outlines.
    pub(super) fn cells(&self) -> impl Iterator<Item = (usize, &[DVec3])> {
        self.nodes.iter().enumerate().filter_map(|(i, n)| match n {
            Node::Cell(p) => Some((i, &**p)),
            Node::Split { .. } => None,
        })
    }

    /// Number of nodes; the node numbers of cells are below it.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The search structure for the cells, without their outlines; cells are numbered in the order of [`Tree::cells`].
    pub(super) fn finder(&self) -> Finder {
        let mut leaf = vec![0; self.nodes.len()];
        self.cells().enumerate().for_each(|(ordinal, (node, _))| leaf[node] = ordinal as u32 | LEAF);
        let mut finder = Finder::new(self.nodes.iter().find_map(|n| match n {
            Node::Cell(p) => Some(&**p),
            Node::Split { .. } => None,
        }));
        finder.root = self.copy(0, &leaf, &mut finder);
        let cells = self.cells().count();
        finder.index(self.cells().flat_map(|(_, p)| p.iter().copied()), cells);
        finder
    }

    /// Copies the lines below a node and returns its number in `to`.
    fn copy(&self, node: usize, leaf: &[u32], to: &mut Finder) -> u32 {
        let Node::Split { axis, offset, children } = &self.nodes[node] else { return leaf[node] };
        let at = to.lines.len();
        to.lines.push(to.line(*axis, *offset));
        to.lines[at].children = children.map(|c| self.copy(c as usize, leaf, to));
        at as u32
    }

    /// Splits every cell whose interior the segment crosses, along the line of the segment. Returns true if any cell was
    /// split.
    pub(super) fn cut(&mut self, normal: DVec3, [a, b]: [DVec3; 2]) -> bool {
        let along = b - a;
        if along.length() <= self.tiny {
            return false;
        }
        let axis = normal.cross(along).normalize();
        let offset = axis.dot(a);
        let crossed: Vec<usize> =
            self.cells().filter(|(_, p)| crosses(p, normal, a, b, axis, offset, self.tiny)).map(|c| c.0).collect();
        for &cell in &crossed {
            self.split(cell, axis, offset);
        }
        !crossed.is_empty()
    }

    /// Replaces a cell by `count` cells of equal area.
    pub(super) fn bisect(&mut self, cell: usize, count: usize) {
        if count < 2 {
            return;
        }
        let Node::Cell(p) = &self.nodes[cell] else { return };
        let low = count / 2;
        let (axis, offset) = equal_area_line(p, low as f64 / count as f64);
        let children = self.split(cell, axis, offset);
        self.bisect(children[0], low);
        self.bisect(children[1], count - low);
    }

    /// Replaces a quadrilateral cell, which is the part `part` of its chart, by `count` cells.
    pub(super) fn grade(&mut self, cell: usize, count: usize, chart: &Chart, part: Part) {
        if count < 2 {
            return;
        }
        let low = count / 2;
        let (parts, (axis, offset)) = chart.cut(part, low as f64 / count as f64);
        let children = self.split(cell, axis, offset);
        self.grade(children[0], low, chart, parts[0]);
        self.grade(children[1], count - low, chart, parts[1]);
    }

    fn split(&mut self, cell: usize, axis: DVec3, offset: f64) -> [usize; 2] {
        let Node::Cell(p) = &self.nodes[cell] else { return [cell; 2] };
        let (mut low, mut high) = (Vec::new(), Vec::new());
        let tolerance = 1e-13 * self.size;
        clip(p, -axis, -offset, tolerance, &mut low);
        clip(p, axis, offset, tolerance, &mut high);
        let at = self.nodes.len();
        self.nodes[cell] = Node::Split { axis, offset, children: [at as u32, at as u32 + 1] };
        self.nodes.extend([Node::Cell(low.into()), Node::Cell(high.into())]);
        [at, at + 1]
    }
}

/// Returns true if the segment runs inside the polygon for more than `tiny`, with corners more than `tiny` away on both
/// sides.
fn crosses(p: &[DVec3], normal: DVec3, a: DVec3, b: DVec3, axis: DVec3, offset: f64, tiny: f64) -> bool {
    let [lo, hi] = extent(p, axis);
    if lo > offset - tiny || hi < offset + tiny {
        return false;
    }
    let (mut from, mut to) = (0.0, 1.0);
    for (i, &q) in p.iter().enumerate() {
        let inward = normal.cross(p[(i + 1) % p.len()] - q);
        let (s, t) = (inward.dot(a - q), inward.dot(b - q));
        if s < 0.0 && t < 0.0 {
            return false;
        } else if s < 0.0 {
            from = f64::max(from, s / (s - t));
        } else if t < 0.0 {
            to = f64::min(to, s / (s - t));
        }
    }
    (to - from) * a.distance(b) > tiny
}

/// The segments in which the convex polygon `q` meets the plane of `p`, or none. Heights up to `tiny` count as zero.
pub(super) fn meeting(p: &[DVec3], normal: DVec3, q: &[DVec3], tiny: f64) -> Vec<[DVec3; 2]> {
    let offset = normal.dot(p[0]);
    let height = |x: DVec3| {
        let s = normal.dot(x) - offset;
        if s.abs() <= tiny { 0.0 } else { s }
    };
    let edges = || q.iter().enumerate().map(|(i, &a)| [a, q[(i + 1) % q.len()]]);
    if q.iter().all(|&x| height(x) == 0.0) {
        return edges().collect();
    }
    let mut on: Vec<DVec3> = Vec::new();
    for [a, b] in edges() {
        let (s, t) = (height(a), height(b));
        if s == 0.0 {
            on.push(a);
        } else if s * t < 0.0 {
            on.push(a + (b - a) * (s / (s - t)));
        }
    }
    // a convex polygon meets a plane in at most two boundary points, or in an edge
    match on.as_slice() {
        [a, b] => vec![[*a, *b]],
        _ => Vec::new(),
    }
}

/// Number of cells of a region if cells have about the area `a`.
pub(super) fn share(polygon: &[DVec3], a: f64) -> usize {
    ((area_vector(polygon).length() / a).round() as usize).max(1)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::operator::patches::polygon::centroid;

    fn square() -> Vec<DVec3> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec()
    }

    #[test]
    fn a_square_bisects_into_the_regular_grid() {
        for m in [1, 2, 4, 8] {
            let mut tree = Tree::new(square(), 0.0);
            tree.bisect(0, m * m);
            let mut seen = vec![false; m * m];
            for (i, p) in tree.cells() {
                assert!((area_vector(p).length() * (m * m) as f64 - 1.0).abs() < 1e-14);
                let c = centroid(p) * m as f64 - 0.5;
                assert!((c.x - c.x.round()).abs() < 1e-13 && (c.y - c.y.round()).abs() < 1e-13);
                seen[c.y.round() as usize * m + c.x.round() as usize] = true;
                assert_eq!(tree.cells().nth(tree.finder().locate(centroid(p))).map(|c| c.0), Some(i));
            }
            assert!(seen.iter().all(|s| *s));
        }
    }

    #[test]
    fn only_crossed_cells_are_cut_and_boundary_segments_cut_nothing() {
        let v = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let mut tree = Tree::new(square(), 0.0);
        assert!(!tree.cut(DVec3::Z, [v(0.0, 0.0), v(1.0, 0.0)]));
        assert!(!tree.cut(DVec3::Z, [v(-1.0, 0.5), v(0.0, 0.5)]));
        // an inner square: four cuts, each through one remaining outer region, leave 5 cells
        let inner = [v(0.3, 0.3), v(0.6, 0.3), v(0.6, 0.6), v(0.3, 0.6)];
        for i in 0..4 {
            assert!(tree.cut(DVec3::Z, [inner[i], inner[(i + 1) % 4]]));
        }
        assert_eq!(tree.cells().count(), 5);
        let (_, cell) = tree.cells().nth(tree.finder().locate(v(0.5, 0.5))).unwrap();
        assert!((area_vector(cell).length() - 0.09).abs() < 1e-15);
    }
}
