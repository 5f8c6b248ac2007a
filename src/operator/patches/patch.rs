//! A patch: one side of one cell of a surface.
//!
//! ```text
//! Pᵢ = { x : x on the polygon of Patch i, uncovered }        x ↦ the true surface by [`Patch::lift`]
//! ```
//!
//! What all patches of one side of a primitive share is stored once, so that a million patches are 0.2 GB.

use super::polygon::{area_vector, centroid};
use crate::scene::description::Sides;
use glam::DVec3;
use std::ops::Deref;
use std::sync::Arc;

/// A point of the true surface with the normal of the side meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Metres.
    pub position: DVec3,
    /// Unit normal of the side meant.
    pub normal: DVec3,
}

/// One side of one cell of a surface. The fields of its [`SurfaceSide`] are read as if they were its own.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Corners, counter-clockwise seen from the side meant.
    pub polygon: Corners,
    /// Unit normal of the side meant.
    pub normal: DVec3,
    /// Centre of mass of the polygon.
    pub centre: DVec3,
    /// True area, without what is covered, m².
    pub area: f64,
    /// Area of the polygon, m².
    pub flat_area: f64,
    /// True area, covered or not, over the area of the polygon: 1 on flat surfaces with straight edges.
    pub stretch: f64,
    /// What it shares with the others of its side.
    pub side: Arc<SurfaceSide>,
}

/// One side of a primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceSide {
    /// Number of the primitive.
    pub primitive: usize,
    /// The side of the primitive's normal.
    pub front: bool,
    /// The sphere the polygons stand for pieces of: centre and radius.
    pub ball: Option<(DVec3, f64)>,
    /// Albedo per channel.
    pub reflectance: DVec3,
    /// Radiance it emits, W·sr⁻¹·m⁻²; zero on the back.
    pub emission: DVec3,
}

/// The corners of a polygon; four, the usual number, are stored in place.
#[derive(Clone, Debug, PartialEq)]
pub enum Corners {
    /// A quadrilateral.
    Four([DVec3; 4]),
    /// Any other number.
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
    /// An uncovered patch; `polygon` is counter-clockwise seen from the front, `area` that of the true surface.
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

    /// The point of the true surface that a point of the polygon stands for.
    pub fn lift(&self, p: DVec3) -> SurfacePoint {
        match self.ball {
            None => SurfacePoint { position: p, normal: self.normal },
            Some((center, radius)) => {
                let out = (p - center).normalize();
                SurfacePoint { position: center + radius * out, normal: if self.is_concave() { -out } else { out } }
            }
        }
    }

    /// A piece of the inside of a sphere.
    pub fn is_concave(&self) -> bool {
        self.ball.is_some_and(|(center, _)| self.normal.dot(self.centre - center) < 0.0)
    }
}

/// The reflecting sides: 0 is the front, 1 the back.
pub(super) fn sides_of(sides: Sides) -> std::ops::Range<usize> {
    match sides {
        Sides::Front => 0..1,
        Sides::Both => 0..2,
    }
}
