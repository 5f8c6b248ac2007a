//! A patch: one side of one cell of a surface.
//!
//! ```text
//! Pᵢ = { x : x on the polygon of Patch i, uncovered }        x ↦ the true surface by [`Patch::lift`]
//! ```
//!
//! The data that all patches of one side of a primitive share are stored once. A million patches then need 0.2 GB.

use super::polygon::{area_vector, centroid};
use crate::scene::description::Sides;
use glam::DVec3;
use std::ops::Deref;
use std::sync::Arc;

/// A point of the true surface, with the normal of one of its two sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position, metres.
    pub position: DVec3,
    /// Unit normal of the chosen side.
    pub normal: DVec3,
}

/// One side of one cell of a surface. The fields of its [`SurfaceSide`] can be read like its own fields.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Corners, counter-clockwise as seen from this side.
    pub polygon: Corners,
    /// Unit normal of this side.
    pub normal: DVec3,
    /// Centre of mass of the polygon.
    pub centre: DVec3,
    /// Area of the true surface without its covered part, m².
    pub area: f64,
    /// Area of the polygon, m².
    pub flat_area: f64,
    /// Area of the true surface, covered or not, divided by the area of the polygon. It is 1 on flat surfaces with straight
    /// edges.
    pub stretch: f64,
    /// The data shared by all patches of the same side of the primitive.
    pub side: Arc<SurfaceSide>,
}

/// One side of a primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceSide {
    /// Number of the primitive.
    pub primitive: usize,
    /// True for the side to which the primitive's normal points.
    pub front: bool,
    /// Centre and radius of the sphere whose pieces the polygons approximate; `None` on other surfaces.
    pub ball: Option<(DVec3, f64)>,
    /// Albedo per channel.
    pub reflectance: DVec3,
    /// Emitted radiance per channel, W·sr⁻¹·m⁻²; zero on the back.
    pub emission: DVec3,
}

/// The corners of a polygon. Four corners, the usual number, are stored without a separate allocation.
#[derive(Clone, Debug, PartialEq)]
pub enum Corners {
    /// A quadrilateral.
    Four([DVec3; 4]),
    /// A polygon with any other number of corners.
    Many(Box<[DVec3]>),
}

impl From<Vec<DVec3>> for Corners {
    fn from(list: Vec<DVec3>) -> Self {
        match *list {
            [a, b, c, d] => Self::Four([a, b, c, d]),
            _ => Self::Many(list.into()),
        }
    }
}

impl Deref for Corners {
    type Target = [DVec3];
    fn deref(&self) -> &[DVec3] {
        match self {
            Self::Four(list) => list,
            Self::Many(list) => list,
        }
    }
}

impl Deref for Patch {
    type Target = SurfaceSide;
    fn deref(&self) -> &SurfaceSide {
        &self.side
    }
}

impl Patch {
    /// A patch that nothing covers; `polygon` is counter-clockwise as seen from the front, and `area` is the area of the
    /// true surface.
    pub(super) fn new(side: &Arc<SurfaceSide>, mut polygon: Vec<DVec3>, area: f64) -> Self {
        if !side.front {
            polygon.reverse();
        }
        let vector = area_vector(&polygon);
        let flat_area = vector.length();
        Self {
            normal: vector / flat_area,
            centre: centroid(&polygon),
            polygon: polygon.into(),
            area,
            flat_area,
            stretch: area / flat_area,
            side: side.clone(),
        }
    }

    /// The point of the true surface that corresponds to a point `p` of the polygon.
    pub fn lift(&self, p: DVec3) -> SurfacePoint {
        match self.ball {
            None => SurfacePoint { position: p, normal: self.normal },
            Some((center, radius)) => {
                let out = (p - center).normalize();
                SurfacePoint { position: center + radius * out, normal: if self.is_concave() { -out } else { out } }
            }
        }
    }

    /// Returns true for a piece of the inside of a sphere.
    pub fn is_concave(&self) -> bool {
        self.ball.is_some_and(|(center, _)| self.normal.dot(self.centre - center) < 0.0)
    }
}

/// The numbers of the reflecting sides: 0 is the front, 1 the back.
pub(super) fn sides_of(sides: Sides) -> std::ops::Range<usize> {
    match sides {
        Sides::Front => 0..1,
        Sides::Both => 0..2,
    }
}
