//! Finds the cell of a point: the dividing lines of a tree, stored in the plane's own coordinates with twenty bytes each.
//!
//! ```text
//! (s, t) = ((x − o)·e₁, (x − o)·e₂)        go low where a s + b t ≤ c, else high, until a cell is reached
//! ```
//!
//! The search from the root of a tree of a million cells needs twenty reads, each of which waits for the previous one. A
//! table covers the plane with about one square per cell. It stores for each square the lowest node through which the search
//! passes for every point of the square. Only four or five reads remain. The answer is the same for every point.

use super::polygon::area_vector;
use glam::DVec3;

/// Bit that marks a child as a cell.
pub(super) const LEAF: u32 = 1 << 31;

#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    axis: [f32; 2],
    offset: f32,
    pub(super) children: [u32; 2],
}

/// Finds the number of the cell of a point; cells are numbered in the order of [`Tree::cells`](super::tree::Tree::cells).
#[derive(Clone, Debug)]
pub(super) struct Finder {
    origin: DVec3,
    frame: [DVec3; 2],
    pub(super) root: u32,
    pub(super) lines: Vec<Line>,
    table: Table,
}

/// The state of a search: the current node and the point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent {
    at: u32,
    point: [f32; 2],
}

impl Descent {
    /// A finished search whose result is `cell`.
    pub(super) fn arrived(cell: usize) -> Self {
        Self { at: LEAF | cell as u32, point: [0.0; 2] }
    }

    pub(super) fn is_over(&self) -> bool {
        self.at & LEAF != 0
    }

    /// The cell found; the search must be finished.
    pub(super) fn cell(&self) -> usize {
        (self.at ^ LEAF) as usize
    }
}

/// The start node of the search for every square of the plane.
#[derive(Clone, Debug, Default)]
struct Table {
    /// Lower corner of the table (`low`, metres), and squares per metre (`scale`).
    low: [f32; 2],
    scale: [f32; 2],
    squares: [usize; 2],
    start: Vec<u32>,
}

/// Rounding moves a point by less than this share of the width of the table.
const ROUNDING: f64 = 2e-6;

impl Table {
    /// The start node for a point; `None` if the point lies outside the table.
    fn start(&self, at: [f32; 2]) -> Option<u32> {
        let [x, y] = [0, 1].map(|k| (at[k] - self.low[k]) * self.scale[k]);
        let inside = x >= 0.0 && y >= 0.0 && x < self.squares[0] as f32 && y < self.squares[1] as f32;
        if inside { self.start.get(y as usize * self.squares[0] + x as usize).copied() } else { None }
    }
}

impl Finder {
    /// A finder without lines, in the plane of `cell`.
    pub(super) fn new(cell: Option<&[DVec3]>) -> Self {
        let origin = cell.map_or(DVec3::ZERO, |p| p[0]);
        let normal = cell.map_or(DVec3::Z, |p| area_vector(p).normalize());
        Self {
            origin,
            frame: normal.any_orthonormal_pair().into(),
            root: LEAF,
            lines: Vec::new(),
            table: Table::default(),
        }
    }

    pub(super) fn line(&self, axis: DVec3, offset: f64) -> Line {
        let axis2 = self.frame.map(|e| e.dot(axis) as f32);
        Line { axis: axis2, offset: (offset - axis.dot(self.origin)) as f32, children: [LEAF; 2] }
    }

    /// Builds a table with about `squares` squares that covers the points `corners`. The lines must exist already.
    pub(super) fn index(&mut self, corners: impl Iterator<Item = DVec3>, squares: usize) {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for d in corners.map(|p| p - self.origin) {
            for (k, e) in self.frame.iter().enumerate() {
                (low[k], high[k]) = (low[k].min(e.dot(d)), high[k].max(e.dot(d)));
            }
        }
        let width = [high[0] - low[0], high[1] - low[1]];
        if !(width[0] > 0.0 && width[1] > 0.0 && squares > 1) {
            return;
        }
        let side = (width[0] * width[1] / squares as f64).sqrt();
        let count = width.map(|w| ((w / side).round() as usize).clamp(1, squares));
        self.table = Table {
            low: low.map(|x| x as f32),
            scale: [0, 1].map(|k| (count[k] as f64 / width[k]) as f32),
            squares: count,
            start: vec![self.root; count[0] * count[1]],
        };
        let margin = ROUNDING * width[0].max(width[1]);
        let plane = Plane { low, side: [0, 1].map(|k| width[k] / count[k] as f64), margin };
        let mut start = std::mem::take(&mut self.table.start);
        self.descend(self.root, &plane, [[0, count[0]], [0, count[1]]], &mut |x, y, node| {
            start[y * count[0] + x] = node;
        });
        self.table.start = start;
    }

    /// Sets for all squares of the block (a range of columns and a range of rows) the lowest node through which all their
    /// points pass.
    fn descend(&self, node: u32, plane: &Plane, block: [[usize; 2]; 2], set: &mut impl FnMut(usize, usize, u32)) {
        let mut node = node;
        while node & LEAF == 0 {
            let line = &self.lines[node as usize];
            let Some(child) = plane.side_of(line, block) else { break };
            node = line.children[child];
        }
        let [columns, rows] = block.map(|[a, b]| b - a);
        if node & LEAF != 0 || columns * rows == 1 {
            (block[1][0]..block[1][1]).for_each(|y| (block[0][0]..block[0][1]).for_each(|x| set(x, y, node)));
            return;
        }
        let k = usize::from(rows > columns);
        let [from, to] = block[k];
        let middle = (from + to) / 2;
        for half in [[from, middle], [middle, to]] {
            let mut part = block;
            part[k] = half;
            self.descend(node, plane, part, set);
        }
    }

    /// The cell of a point of the plane. A point outside gets the cell that lies on the same side of every line that was
    /// tested.
    pub(super) fn locate(&self, p: DVec3) -> usize {
        let mut walk = self.begin(p);
        while !walk.is_over() {
            self.step(&mut walk);
        }
        walk.cell()
    }

    /// Begins the search for the cell of a point.
    #[inline(always)]
    pub(super) fn begin(&self, p: DVec3) -> Descent {
        let d = p - self.origin;
        let at = self.frame.map(|e| e.dot(d) as f32);
        Descent { at: self.table.start(at).unwrap_or(self.root), point: at }
    }

    /// Moves the search one line down; it must not be finished.
    #[inline(always)]
    pub(super) fn step(&self, walk: &mut Descent) {
        let line = &self.lines[walk.at as usize];
        let [s, t] = walk.point;
        walk.at = line.children[usize::from(line.axis[0] * s + line.axis[1] * t > line.offset)];
    }

    /// For every cell, the number of its group. Groups are the largest subtrees of at most `most` cells.
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

/// The geometry of the squares of a table, in metres.
struct Plane {
    low: [f64; 2],
    side: [f64; 2],
    margin: f64,
}

impl Plane {
    /// The child on whose side of the line the whole block lies, with a margin for rounding; `None` if the line may cut the
    /// block.
    fn side_of(&self, line: &Line, block: [[usize; 2]; 2]) -> Option<usize> {
        let (mut least, mut most) = (-f64::from(line.offset), -f64::from(line.offset));
        for (k, range) in block.iter().enumerate() {
            let a = f64::from(line.axis[k]);
            let [p, q] = range.map(|i| a * (self.low[k] + i as f64 * self.side[k]));
            (least, most) = (least + p.min(q), most + p.max(q));
        }
        if most < -self.margin {
            Some(0)
        } else if least > self.margin {
            Some(1)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tree::Tree;
    use super::*;

    #[test]
    fn the_table_changes_no_answer() {
        // a skew quadrilateral, divided into uneven parts by a line that is parallel to none of its sides
        let v = DVec3::new;
        let mut tree = Tree::new(vec![v(0.0, 0.0, 1.0), v(2.0, 0.1, 1.0), v(1.7, 1.3, 1.0), v(0.2, 1.0, 1.0)], 0.0);
        assert!(tree.cut(DVec3::Z, [v(0.3, 0.1, 1.0), v(1.5, 1.1, 1.0)]));
        for cell in tree.cells().map(|c| c.0).collect::<Vec<_>>() {
            tree.bisect(cell, 700 + cell);
        }
        let quick = tree.finder();
        let mut plain = quick.clone();
        plain.table = Table::default();
        let mut shortened = 0;
        for i in 0..40_000 {
            let p = v(-0.1 + 2.2 * f64::from(i % 200) / 199.0, -0.1 + 1.5 * f64::from(i / 200) / 199.0, 1.0);
            assert_eq!(quick.locate(p), plain.locate(p), "{p}");
            let d = p - quick.origin;
            let at = quick.frame.map(|e| e.dot(d) as f32);
            shortened += usize::from(quick.table.start(at).is_some_and(|s| s != quick.root));
        }
        assert!(shortened > 20_000, "{shortened}");
        // on the corners of cells, where rounding decides
        for (_, p) in tree.cells() {
            p.iter().for_each(|c| assert_eq!(quick.locate(*c), plain.locate(*c), "{c}"));
        }
    }
}
