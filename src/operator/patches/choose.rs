//! Division of each surface into cells: where it is cut, and into how many cells.
//!
//! ```text
//! cells of a region of area A = max(1, round(A/a)),      a such that the number of patches is as near to n as possible
//! ```

use super::cover::{Cover, CoverTest};
use super::curved::Grid;
use super::finder::{Descent, Finder};
use super::grading::{Chart, outline};
use super::patch::{Corners, sides_of};
use super::polygon::{area_vector, extent};
use super::tree::{Tree, meeting, share};
use crate::scene::{Primitive, description::Sides};
use glam::DVec3;
use rayon::prelude::*;

/// Maximum number of cuts per primitive. A primitive with more is not cut completely; the cover of its cells is sampled
/// instead.
const MAX_CUTS: usize = 64;

/// A primitive after the cuts; each piece has its cover on both sides.
pub(super) enum Region {
    Flat { tree: Tree, pieces: Vec<Piece> },
    Curved { primitive: Primitive, sides: usize },
}

/// A cell of the tree after the cuts, before the division.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    node: usize,
    cover: [Cover; 2],
    /// The chart for grading, on a graded mesh and if the cell has four corners.
    chart: Option<Chart>,
}

/// A primitive after the division into cells.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    Flat { tree: Tree, cover: Vec<[Cover; 2]> },
    Curved(Grid),
}

/// Search structure that finds the cell of a point.
#[derive(Clone, Debug)]
pub(super) enum Search {
    Flat(Finder),
    Curved(Grid),
}

/// A cell from which patches are made.
pub(super) struct Cell {
    pub(super) number: usize,
    pub(super) polygon: Corners,
    pub(super) area: f64,
    pub(super) cover: [Cover; 2],
}

/// Cuts every flat primitive where others meet it, and determines which pieces are covered. Lengths below `tiny`, or below a
/// small share of the primitive's size, count as zero. This way the small displacement of emitters causes no slivers.
pub(super) fn regions(primitives: &[(Primitive, Sides)], cover: &CoverTest, grading: f64, tiny: f64) -> Vec<Region> {
    let one = |(number, &(primitive, sides)): (usize, &(Primitive, Sides))| {
        let Some(polygon) = outline(&primitive) else {
            return Region::Curved { primitive, sides: sides_of(sides).count() };
        };
        let normal = area_vector(&polygon).normalize();
        let mut tree = Tree::new(polygon.clone(), tiny);
        let sampled = !cut(&mut tree, &polygon, normal, (primitives, cover), number);
        let side = |side: usize, p: &[DVec3]| {
            if !sides_of(sides).contains(&side) {
                return Cover::Covered;
            }
            if sampled {
                return Cover::Mixed;
            }
            cover.classify(number, p, if side == 0 { normal } else { -normal })
        };
        let chart = |p: &[DVec3]| if grading == 1.0 { None } else { Chart::new(grading, p, primitives, number) };
        let piece = |(node, p)| Piece { node, cover: [side(0, p), side(1, p)], chart: chart(p) };
        let pieces = tree.cells().map(piece).collect();
        Region::Flat { tree, pieces }
    };
    primitives.par_iter().enumerate().map(one).collect()
}

/// Cuts the tree of the primitive `own`. Returns true if straight cuts were enough to separate covered from free parts.
fn cut(
    tree: &mut Tree,
    polygon: &[DVec3],
    normal: DVec3,
    (all, cover): (&[(Primitive, Sides)], &CoverTest),
    own: usize,
) -> bool {
    let margin = DVec3::splat(tree.tiny());
    let fold = |p: &[DVec3]| p.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], &x| [a.min(x), b.max(x)]);
    let [lo, hi] = fold(polygon);
    let (mut cuts, mut close) = (0, vec![]);
    cover.near.within([lo - margin, hi + margin], |i| {
        close.push(i);
        true
    });
    close.sort_unstable();
    for (number, other) in close.iter().filter(|i| **i != own).map(|i| (*i, &all[*i].0)) {
        let [a, b] = other.bounds();
        let coincides = cover.coincide(own, number);
        if !coincides && ((a - margin).cmpgt(hi).any() || (b + margin).cmplt(lo).any()) {
            continue;
        }
        let Some(q) = outline(other) else {
            // a sphere or disk that reaches the plane covers a region with a curved edge, which straight cuts cannot
            // separate
            let corners = (0..8).map(|i| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), a, b));
            let [s, t] = extent(&corners.collect::<Vec<_>>(), normal);
            let d = normal.dot(polygon[0]);
            if coincides || (s <= d + margin.x && t >= d - margin.x) {
                return false;
            }
            continue;
        };
        for segment in meeting(polygon, normal, &q, if coincides { f64::INFINITY } else { tree.tiny() }) {
            if tree.cut(normal, segment) {
                cuts += 1;
                if cuts == MAX_CUTS {
                    return false;
                }
            }
        }
    }
    true
}

/// The cell area for which the number of patches is nearest to `n`.
pub(super) fn cell_area(regions: &[Region], n: usize) -> f64 {
    let count = |a: f64| regions.iter().map(|r| r.count(a)).sum::<usize>();
    let whole: f64 = regions.iter().map(Region::area).sum();
    let (mut fine, mut coarse) = (whole / (4 * n + 4 * regions.len()) as f64, whole);
    // invariant: count(fine) ≥ n > count(coarse), unless even the coarsest mesh has at least n patches
    if count(coarse) >= n || count(fine) == 0 {
        return coarse;
    }
    while count(fine) < n {
        fine *= 0.5;
    }
    for _ in 0..60 {
        let a = (fine * coarse).sqrt();
        if count(a) >= n { fine = a } else { coarse = a }
    }
    if count(fine) - n <= n - count(coarse) { fine } else { coarse }
}

impl Region {
    fn area(&self) -> f64 {
        match self {
            Self::Flat { tree, .. } => tree.cells().map(|(_, p)| area_vector(p).length()).sum(),
            Self::Curved { primitive, .. } => primitive.area(),
        }
    }

    /// Number of patches for the cell area `a`.
    fn count(&self, a: f64) -> usize {
        match self {
            Self::Flat { tree, pieces } => {
                let cells = tree.cells().zip(pieces);
                cells.map(|((_, p), piece)| share(p, a) * piece.sides()).sum()
            }
            Self::Curved { primitive, sides } => grid(primitive, a).map_or(0, |g| g.len()) * sides,
        }
    }

    /// Divides the region into cells of about the area `a`.
    pub(super) fn divide(self, primitive: &Primitive, a: f64) -> Shape {
        match self {
            Self::Flat { mut tree, pieces } => {
                let mut cover = vec![[Cover::Covered; 2]; tree.len()];
                for piece in pieces {
                    let cells = tree.cells().find(|(i, _)| *i == piece.node).map_or(1, |(_, p)| share(p, a));
                    let first = tree.len();
                    let cells = if piece.sides() == 0 { 1 } else { cells };
                    match &piece.chart {
                        None => tree.bisect(piece.node, cells),
                        Some(chart) => tree.grade(piece.node, cells, chart, [[0.0, 1.0]; 2]),
                    }
                    cover[piece.node] = piece.cover;
                    cover.resize(first, [Cover::Covered; 2]);
                    cover.resize(tree.len(), piece.cover);
                }
                Shape::Flat { tree, cover }
            }
            Self::Curved { .. } => match grid(primitive, a) {
                Some(grid) => Shape::Curved(grid),
                None => Shape::Flat { tree: Tree::new(Vec::new(), 0.0), cover: Vec::new() },
            },
        }
    }
}

impl Piece {
    fn sides(&self) -> usize {
        self.cover.iter().filter(|c| **c != Cover::Covered).count()
    }
}

fn grid(p: &Primitive, a: f64) -> Option<Grid> {
    match *p {
        Primitive::Sphere { center, radius, z, inward } => Some(Grid::sphere(center, radius, z, inward, a)),
        Primitive::Disk { center, normal, radius } => Some(Grid::disk(center, normal, radius, a)),
        Primitive::Triangle(_) | Primitive::Parallelogram { .. } => None,
    }
}

impl Shape {
    /// The cells in order, numbered from 0.
    pub(super) fn cells(&self) -> Vec<Cell> {
        match self {
            Self::Flat { tree, cover } => {
                let one = |(number, (node, p)): (usize, (usize, &[DVec3]))| Cell {
                    number,
                    polygon: p.to_vec().into(),
                    area: area_vector(p).length(),
                    cover: cover[node],
                };
                tree.cells().enumerate().map(one).collect()
            }
            Self::Curved(grid) => {
                let one = |(number, f): (usize, super::curved::Facet)| Cell {
                    number,
                    polygon: f.polygon.into(),
                    area: f.area,
                    cover: [Cover::Mixed; 2],
                };
                grid.facets().into_iter().enumerate().map(one).collect()
            }
        }
    }

    /// The search structure that finds the cell of a point.
    pub(super) fn finder(self) -> Search {
        match self {
            Self::Flat { tree, .. } => Search::Flat(tree.finder()),
            Self::Curved(grid) => Search::Curved(grid),
        }
    }
}

impl Search {
    pub(super) fn locate(&self, p: DVec3) -> usize {
        match self {
            Self::Flat(finder) => finder.locate(p),
            Self::Curved(grid) => grid.locate(p),
        }
    }

    #[inline(always)]
    pub(super) fn begin(&self, p: DVec3) -> Descent {
        match self {
            Self::Flat(finder) => finder.begin(p),
            Self::Curved(grid) => Descent::arrived(grid.locate(p)),
        }
    }

    #[inline(always)]
    pub(super) fn step(&self, walk: &mut Descent) {
        if let Self::Flat(finder) = self {
            finder.step(walk);
        }
    }

    /// For every cell the number of its group; a group has up to `most` neighbouring cells. On a curved surface every cell
    /// is a separate group.
    pub(super) fn groups(&self, cells: usize, most: usize) -> Vec<u32> {
        match self {
            Self::Flat(finder) => finder.groups(cells, most),
            Self::Curved(_) => (0..cells as u32).collect(),
        }
    }
}
