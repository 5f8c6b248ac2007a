//! Fast look-up of the patch that contains a point of a flat primitive, by a grid over the primitive.
//!
//! ```text
//! (a, b) = ((x − o)·g_a, (x − o)·g_b) ∈ [0, 1]²        g_a·u = 1, g_a·v = 0, g_b·u = 0, g_b·v = 1
//! ```
//!
//! x is the point, o a corner of the primitive, u and v its edges. A cell of the grid stores the patch that contains the
//! cell's centre. A point near the edge between two patches may therefore be given the neighbouring patch. This does no
//! harm: the table that a point uses is still a function of the point alone, which is all that unbiased estimates need.

use super::incident::locate;
use crate::operator::patches::Patches;
use crate::scene::{Primitive, Side};
use glam::{DVec3, Vec3};

/// Number of grid cells per patch.
const FINER: f64 = 2.0;

/// Marks a grid cell without a patch.
const NOWHERE: u32 = u32::MAX;

/// The grids of all flat primitives.
#[derive(Clone, Debug)]
pub(super) struct Places {
    grids: Vec<Option<Grid>>,
    cells: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Grid {
    origin: Vec3,
    /// g_a and g_b, multiplied by the number of columns and rows.
    across: Vec3,
    down: Vec3,
    size: [u32; 2],
    /// Number of the first cell of the front and of the back.
    first: [u32; 2],
}

/// Result of a look-up in a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    At(u32),
    /// No patch: another surface covers the point, or the mesh has no patches on this side of the surface.
    Nowhere,
    /// The primitive is a sphere or a disk and has no grid: search the mesh instead.
    Curved,
}

impl Places {
    pub(super) fn new(patches: &Patches) -> Self {
        let area = patches.surface_area() / patches.len() as f64 / FINER;
        let mut cells = vec![];
        let grid = |(number, primitive): (usize, &Primitive)| {
            let (o, u, v) = match *primitive {
                Primitive::Parallelogram { origin, edge_u, edge_v } => (origin, edge_u, edge_v),
                Primitive::Triangle([a, b, c]) => (a, b - a, c - a),
                Primitive::Sphere { .. } | Primitive::Disk { .. } => return None,
            };
            let n = u.cross(v);
            let (ga, gb) = (v.cross(n) / n.length_squared(), n.cross(u) / n.length_squared());
            let count = |edge: DVec3| ((edge.length() / area.sqrt()).ceil() as u32).max(1);
            let size = [count(u), count(v)];
            let first = [0, 1].map(|side| {
                let first = cells.len() as u32;
                for row in 0..size[1] {
                    for column in 0..size[0] {
                        let place = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
                        let p = o + u * place(column, size[0]) + v * place(row, size[1]);
                        let patch = locate(patches, p.as_vec3(), 2 * number as u32 + side);
                        cells.push(patch.map_or(NOWHERE, |i| i as u32));
                    }
                }
                first
            });
            let [across, down] = [ga * f64::from(size[0]), gb * f64::from(size[1])].map(|g| g.as_vec3());
            Some(Grid { origin: o.as_vec3(), across, down, size, first })
        };
        let grids = patches.primitives().iter().enumerate().map(grid).collect();
        Self { grids, cells }
    }

    #[inline(always)]
    pub(super) fn find(&self, p: Vec3, side: Side) -> Place {
        let Some(grid) = &self.grids[(side / 2) as usize] else { return Place::Curved };
        let d = p - grid.origin;
        // a conversion to unsigned saturates at 0
        let column = (d.dot(grid.across) as u32).min(grid.size[0] - 1);
        let row = (d.dot(grid.down) as u32).min(grid.size[1] - 1);
        match self.cells[(grid.first[(side & 1) as usize] + row * grid.size[0] + column) as usize] {
            NOWHERE => Place::Nowhere,
            patch => Place::At(patch),
        }
    }
}
