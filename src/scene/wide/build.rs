//! Building the tree: the two-wide tree of `obvhs`, collapsed to eight children at least cost.
//!
//! ```text
//! C(n, 1) = min( A(n)  if n fits into one leaf,   A(n) + C(n, 8) )
//! C(n, i) = min( C(n, i − 1),   min over k of C(left, k) + C(right, i − k) )
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | A(n) | surface area of the box of subtree n: how likely a ray meets it | |
//! | C(n, i) | least cost of subtree n as at most i children of a wide node | `cost` |
//!
//! Testing a node and testing a leaf count alike.
//!
//! Reference: Ylitie, Karras, Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs* (2017), sec. 4.

use super::super::shape::Shape;
use super::lanes::N;
use super::leaves::Leaves;
use super::node::{LEAF, Node, SINGLE};
use super::tree::Wide;
use glam::Vec3;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2};

/// A subtree of the two-wide tree.
#[derive(Clone, Copy)]
struct Part {
    /// Places of a leaf that it needs; a shape that is no triangle fills a leaf.
    places: u32,
    /// `cost[i − 1]` is C(n, i).
    cost: [f32; N],
    /// `left[i − 1]`: how many of the i children are in the left half; 0 if one child fewer is as good. `left[0]` is 1 for a
    /// leaf.
    left: [u8; N],
}

struct Collapse<'a> {
    shapes: &'a [Shape],
    without: &'a [u32],
    bvh: &'a Bvh2,
    parts: Vec<Part>,
}

impl Wide {
    /// Builds the tree of all shapes but those with the numbers `without`, in ascending order; `bounds` are boxes about all
    /// shapes, with margins.
    pub(crate) fn new(shapes: &[Shape], bounds: Vec<[Vec3; 2]>, without: &[u32]) -> Self {
        if shapes.len() == without.len() {
            return Self { nodes: vec![Node::EMPTY], leaves: Leaves::with_capacity(0), waiting: 0 };
        }
        let mut boxes: Vec<Aabb> = bounds.into_iter().map(|b| Aabb::new(b[0].into(), b[1].into())).collect();
        for &prim in without.iter().rev() {
            boxes.remove(prim as usize);
        }
        // pairs are searched for among many neighbours at every depth, and more of them are moved afterwards than usual: building takes a
        // fifth longer, and rays 4 to 12 % less time
        let params = BvhBuildParams {
            max_prims_per_leaf: 1,
            search_depth_threshold: 0,
            reinsertion_batch_ratio: 0.1,
            ..BvhBuildParams::medium_build()
        };
        let bvh = obvhs::bvh2::builder::build_bvh2(&boxes, params, &mut std::time::Duration::default());
        drop(boxes);
        Collapse { shapes, without, bvh: &bvh, parts: vec![] }.collapse()
    }
}

impl Collapse<'_> {
    fn halves(&self, n: usize) -> Option<[usize; 2]> {
        let node = &self.bvh.nodes[n];
        (node.prim_count == 0).then_some([node.first_index as usize, node.first_index as usize + 1])
    }

    fn prim(&self, leaf: usize) -> u32 {
        let box_of = self.bvh.primitive_indices[self.bvh.nodes[leaf].first_index as usize];
        // boxes are counted without those left out
        self.without.iter().fold(box_of, |prim, &out| prim + u32::from(out <= prim))
    }

    /// Fills the tables from the leaves up.
    fn costs(&mut self) {
        let n = self.bvh.nodes.len();
        self.parts = vec![Part { places: 0, cost: [0.0; N], left: [0; N] }; n];
        let mut order = Vec::with_capacity(n);
        order.push(0);
        let mut at = 0;
        while at < order.len() {
            order.extend(self.halves(order[at]).into_iter().flatten());
            at += 1;
        }
        for &n in order.iter().rev() {
            self.parts[n] = self.part(n);
        }
    }

    fn part(&self, n: usize) -> Part {
        let area = self.bvh.nodes[n].aabb().half_area();
        let Some([l, r]) = self.halves(n) else {
            let triangle = matches!(self.shapes[self.prim(n) as usize], Shape::Triangle(_));
            return Part {
                places: if triangle { 1 } else { N as u32 },
                cost: [area; N],
                left: [1, 0, 0, 0, 0, 0, 0, 0],
            };
        };
        let (l, r) = (&self.parts[l], &self.parts[r]);
        let (places, mut cost, mut left) = (l.places + r.places, [f32::INFINITY; N], [0; N]);
        for i in 2..=N {
            for k in 1..i {
                let c = l.cost[k - 1] + r.cost[i - k - 1];
                if c < cost[i - 1] {
                    (cost[i - 1], left[i - 1]) = (c, k as u8);
                }
            }
        }
        let leaf = if places <= N as u32 { 0.7 * area } else { f32::INFINITY };
        cost[0] = leaf.min(cost[N - 1] + area);
        left[0] = u8::from(leaf <= cost[0]);
        for i in 1..N - 1 {
            if cost[i - 1] <= cost[i] {
                (cost[i], left[i]) = (cost[i - 1], 0);
            }
        }
        Part { places, cost, left }
    }

    /// The subtrees that become the at most `i` children of a wide node.
    fn cut(&self, n: usize, i: usize, out: &mut Vec<usize>) {
        match (self.halves(n), self.parts[n].left[i - 1] as usize) {
            (Some([l, r]), k) if i > 1 && k > 0 => {
                self.cut(l, k, out);
                self.cut(r, i - k, out);
            }
            (Some(_), _) if i > 1 => self.cut(n, i - 1, out),
            _ => out.push(n),
        }
    }

    fn collapse(mut self) -> Wide {
        self.costs();
        // room for all triangles, so that they are never copied
        let leaves = Leaves::with_capacity(self.shapes.len());
        let mut wide = Wide { nodes: vec![], leaves, waiting: 0 };
        // subtrees that become nodes, and their places in their parents
        let (mut todo, mut parts) = (vec![(0, None)], vec![]);
        while let Some((n, place)) = todo.pop() {
            let (at, mut node) = (wide.nodes.len(), Node::EMPTY);
            if let Some((parent, i)) = place {
                let parent: &mut Node = &mut wide.nodes[parent];
                parent.child[i] = at as u32;
            }
            parts.clear();
            self.cut(n, N, &mut parts);
            // large boxes first: they are the most likely to block a segment
            let area = |n: &usize| self.bvh.nodes[*n].aabb().half_area();
            parts.sort_by(|a, b| area(b).total_cmp(&area(a)));
            for (i, &c) in parts.iter().enumerate() {
                let b = self.bvh.nodes[c].aabb();
                for axis in 0..3 {
                    node.planes[axis][0][i] = b.min[axis];
                    node.planes[axis][1][i] = b.max[axis];
                }
                if self.parts[c].left[0] == 1 {
                    node.child[i] = self.leaf(c, &mut wide.leaves);
                } else {
                    todo.push((c, Some((at, i))));
                }
            }
            wide.nodes.push(node);
        }
        wide.waiting = waiting(&wide.nodes);
        wide
    }

    /// The number of a leaf with the shapes of subtree `n`.
    fn leaf(&self, n: usize, leaves: &mut Leaves) -> u32 {
        let (mut triangles, mut todo) = (vec![], vec![n]);
        while let Some(n) = todo.pop() {
            if let Some([l, r]) = self.halves(n) {
                todo.extend([r, l]);
                continue;
            }
            let prim = self.prim(n);
            let Shape::Triangle(t) = &self.shapes[prim as usize] else { return LEAF | SINGLE | prim };
            triangles.push((prim, t));
        }
        LEAF | leaves.push(&triangles)
    }
}

/// The largest number of children that wait at one time: all but one of each node on the way down.
fn waiting(nodes: &[Node]) -> usize {
    let mut most = vec![0; nodes.len()];
    // children come after their parents
    for (n, node) in nodes.iter().enumerate().rev() {
        let used = (0..N).filter(|&i| node.planes[0][0][i] < f32::INFINITY);
        let below = used.clone().filter(|&i| node.child[i] & LEAF == 0).map(|i| most[node.child[i] as usize]);
        most[n] = used.count().saturating_sub(1) + below.max().unwrap_or(0);
    }
    most[0]
}
