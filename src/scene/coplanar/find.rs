//! Search for primitives that coincide. A tree of bounding boxes finds neighbours, and each pair is then tested in `f64`.
//!
//! ```text
//! parallel    |n·m| ≥ 0.99                     the heights below are the sharper test
//! one plane   |h| ≤ γ at every corner of one of the two, over the plane of the other
//! overlap     no edge of either leaves the other outside, or inside by less than 2γ    (separating axes)
//! ```
//!
//! n and m are the normals of the two primitives, h and γ the height and tolerance of the [parent module](super). Primitives
//! that only touch along an edge overlap by rounding, and the position of a plane is uncertain by γ; hence the limit 2γ. Two
//! convex polygons in one plane are separate if and only if an edge of one of them separates them. Reference: Ericson,
//! *Real-Time Collision Detection* (2005), 5.2.1.

use super::{Overlap, Scale};
use crate::scene::primitive::Primitive;
use glam::DVec3;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2};
use rayon::prelude::*;

/// Pairs of normals whose cosine is below this are not compared.
const PARALLEL: f64 = 0.99;

/// A primitive, prepared for comparison.
enum Outline {
    /// Corners counter-clockwise as seen from the front; a triangle uses the first three of the four.
    Polygon {
        n: DVec3,
        corners: [DVec3; 4],
        count: usize,
    },
    Disk {
        n: DVec3,
        center: DVec3,
        radius: f64,
    },
    Sphere {
        center: DVec3,
        radius: f64,
        z: [f64; 2],
        inward: bool,
    },
}

/// All pairs of primitives that coincide, in ascending order.
pub(super) fn overlaps(list: &[(usize, Primitive)], scale: &Scale) -> Vec<Overlap> {
    let outlines: Vec<Outline> = list.iter().map(|(_, p)| Outline::new(p)).collect();
    let (tree, boxes) = boxes(list, scale);
    let of = |i: usize| {
        let mut found = vec![];
        near(&tree, boxes[i], |j| {
            found.extend((j > i).then(|| meeting(&outlines, [i, j], scale)).flatten());
        });
        found.sort_unstable_by_key(|o: &Overlap| o.pair);
        found
    };
    (0..list.len()).into_par_iter().with_min_len(256).flat_map_iter(of).collect()
}

/// The boxes of the primitives, enlarged by the largest tolerance, and a tree of them.
fn boxes(list: &[(usize, Primitive)], scale: &Scale) -> (Bvh2, Vec<Aabb>) {
    let margin = DVec3::splat(2.0 * scale.largest_gap());
    let one = |(_, p): &(usize, Primitive)| {
        let [lo, hi] = p.bounds();
        Aabb::new((lo - margin).as_vec3().into(), (hi + margin).as_vec3().into())
    };
    let boxes: Vec<Aabb> = list.iter().map(one).collect();
    let params = BvhBuildParams::fast_build();
    let tree = obvhs::bvh2::builder::build_bvh2(&boxes, params, &mut std::time::Duration::default());
    (tree, boxes)
}

/// Calls `see` with every primitive whose box intersects the box `own`.
fn near(tree: &Bvh2, own: Aabb, mut see: impl FnMut(usize)) {
    tree.aabb_traverse(own, |tree, node| {
        let node = &tree.nodes[node as usize];
        let leaf = node.first_index as usize..(node.first_index + node.prim_count) as usize;
        tree.primitive_indices[leaf].iter().for_each(|i| see(*i as usize));
        true
    });
}

fn meeting(outlines: &[Outline], pair: [usize; 2], scale: &Scale) -> Option<Overlap> {
    let [a, b] = pair.map(|i| &outlines[i]);
    if let (
        Outline::Sphere { center: c, radius: r, z, inward },
        Outline::Sphere { center: d, radius: s, z: w, inward: v },
    ) = (a, b)
    {
        let gap = scale.largest_gap();
        let (apart, over) = (c.distance(*d), if *inward { s - r } else { r - s });
        let shared = z[1].min(w[1]) - z[0].max(w[0]);
        let one = apart + over.abs() <= gap && shared * r.min(*s) > 2.0 * gap;
        return one.then(|| Overlap { pair, same_way: inward == v, height: [over - apart, over + apart], gap });
    }
    let (n, m) = (a.normal()?, b.normal()?);
    let cosine = n.dot(m);
    if cosine.abs() < PARALLEL {
        return None;
    }
    let gap = scale.gap(n).max(scale.gap(m));
    let height = heights(a, b, gap)?;
    if apart(a, b, 2.0 * gap) || apart(b, a, 2.0 * gap) {
        return None;
    }
    Some(Overlap { pair, same_way: cosine > 0.0, height, gap })
}

/// Lowest and highest height of `a` over `b` along the normal of `a`. Measured at the corners of one over the plane of the
/// other; `None` if for neither choice all corners are within `gap`.
fn heights(a: &Outline, b: &Outline, gap: f64) -> Option<[f64; 2]> {
    let (n, m) = (a.normal()?, b.normal()?);
    let m = if n.dot(m) < 0.0 { -m } else { m };
    let (p, q) = (a.anchor(), b.anchor());
    let [lo, hi] = a.extent(m).map(|x| x - m.dot(q));
    let by_mine = [lo, hi];
    let [lo, hi] = b.extent(n).map(|x| n.dot(p) - x);
    let by_theirs = [hi, lo];
    [by_mine, by_theirs].into_iter().find(|[lo, hi]| *lo >= -gap && *hi <= gap)
}

/// Returns true if an edge of `a` has all of `b` outside, or less than the length `least` of it inside. Every tangent of a
/// disk counts as an edge; only the one towards `b` has to be tested.
fn apart(a: &Outline, b: &Outline, least: f64) -> bool {
    match (a, b) {
        (Outline::Polygon { n, corners, count }, _) => (0..*count).any(|i| {
            let (p, q) = (corners[i], corners[(i + 1) % count]);
            let inward = n.cross(q - p).normalize();
            b.extent(inward)[1] - inward.dot(p) <= least
        }),
        (Outline::Disk { n, center, radius }, _) => {
            let to = b.nearest(*center, *n) - *center;
            radius - (to - *n * n.dot(to)).length() <= least
        }
        (Outline::Sphere { .. }, _) => true,
    }
}

impl Outline {
    fn new(p: &Primitive) -> Self {
        match *p {
            Primitive::Triangle(p) => {
                let [a, b, c] = p;
                Self::Polygon { n: (b - a).cross(c - a).normalize(), corners: [a, b, c, c], count: 3 }
            }
            Primitive::Parallelogram { origin: o, edge_u: u, edge_v: v } => {
                Self::Polygon { n: u.cross(v).normalize(), corners: [o, o + u, o + u + v, o + v], count: 4 }
            }
            Primitive::Disk { center, normal, radius } => Self::Disk { n: normal, center, radius },
            Primitive::Sphere { center, radius, z, inward } => Self::Sphere { center, radius, z, inward },
        }
    }

    /// Unit normal of the front; `None` for a sphere.
    fn normal(&self) -> Option<DVec3> {
        match *self {
            Self::Polygon { n, .. } | Self::Disk { n, .. } => Some(n),
            Self::Sphere { .. } => None,
        }
    }

    /// A point of the plane, or the centre of a sphere.
    fn anchor(&self) -> DVec3 {
        match self {
            Self::Polygon { corners, .. } => corners[0],
            Self::Disk { center, .. } | Self::Sphere { center, .. } => *center,
        }
    }

    /// Lowest and highest value of `axis·x`.
    fn extent(&self, axis: DVec3) -> [f64; 2] {
        match self {
            Self::Polygon { corners, count, .. } => crate::math::polygon::extent(&corners[..*count], axis),
            Self::Disk { n, center, radius } => {
                let (middle, reach) = (axis.dot(*center), radius * (axis - *n * n.dot(axis)).length());
                [middle - reach, middle + reach]
            }
            Self::Sphere { center, radius, .. } => [axis.dot(*center) - radius, axis.dot(*center) + radius],
        }
    }

    /// The point of this primitive nearest to `p`, within its plane with normal `n`.
    fn nearest(&self, p: DVec3, n: DVec3) -> DVec3 {
        match self {
            Self::Polygon { corners, count, n: own } => {
                let edges = || (0..*count).map(|i| [corners[i], corners[(i + 1) % count]]);
                if edges().all(|[a, b]| own.cross(b - a).dot(p - a) >= 0.0) {
                    return p;
                }
                let on = edges().map(|[a, b]| {
                    let t = (p - a).dot(b - a) / (b - a).length_squared();
                    a + (b - a) * t.clamp(0.0, 1.0)
                });
                on.min_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p))).unwrap_or(p)
            }
            Self::Disk { center, radius, .. } | Self::Sphere { center, radius, .. } => {
                let to = p - *center;
                let to = to - n * n.dot(to);
                if to.length() <= *radius { p } else { *center + to * (radius / to.length()) }
            }
        }
    }
}

/// Number of corners of the polygon inscribed in a disk.
const FACETS: usize = 32;

/// Outline and unit normal of a flat primitive; for a disk, an inscribed polygon. `None` for a sphere.
pub(super) fn outline(p: &Primitive) -> Option<(Vec<DVec3>, DVec3)> {
    match (*p, Outline::new(p)) {
        (Primitive::Disk { center, normal, radius }, _) => {
            let (u, v) = normal.any_orthonormal_pair();
            let corner = |i: usize| {
                let (s, c) = (std::f64::consts::TAU * i as f64 / FACETS as f64).sin_cos();
                center + radius * (c * u + s * v)
            };
            Some(((0..FACETS).map(corner).collect(), normal))
        }
        (_, Outline::Polygon { n, corners, count }) => Some((corners[..count].to_vec(), n)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The grid of 2 m² triangles of a wavy sheet.
    fn sheet(m: u32) -> Vec<(usize, Primitive)> {
        let at = |i: u32, j: u32| {
            let [x, z] = [i, j].map(|i| f64::from(i) / f64::from(m));
            DVec3::new(x, 0.1 * (7.0 * x).sin() * (5.0 * z).cos(), z)
        };
        let cells = (0..m * m).map(|c| (c / m, c % m));
        let two = |(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            [Primitive::Triangle([a, b, c]), Primitive::Triangle([a, c, d])]
        };
        cells.flat_map(two).map(|p| (0, p)).collect()
    }

    /// The search looks at the neighbours of a triangle, however many triangles there are.
    #[test]
    fn pairs_per_triangle_do_not_grow() {
        let pairs = |m: u32| {
            let list = sheet(m);
            let (tree, boxes) = boxes(&list, &Scale::new(&list));
            let mut seen = 0u32;
            boxes.iter().for_each(|own| near(&tree, *own, |_| seen += 1));
            f64::from(seen) / list.len() as f64
        };
        let (few, many) = (pairs(20), pairs(160));
        assert!(few > 5.0 && many < 1.2 * few, "{few} and {many} pairs per triangle");
    }
}
