//! The primitives of a scene: the surfaces into which its shapes are divided. Rays and patches number them by their order
//! here.

use super::description::{Description, Geometry};
use glam::{DQuat, DVec3};

/// A surface that rays can hit. Its front is the side to which the normal points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// A triangle; its corners are counter-clockwise as seen from the front.
    Triangle([DVec3; 3]),
    /// The parallelogram `origin + u·edge_u + v·edge_v` with u, v in [0, 1]; its normal is `edge_u × edge_v`.
    Parallelogram {
        /// A corner.
        origin: DVec3,
        /// First edge.
        edge_u: DVec3,
        /// Second edge.
        edge_v: DVec3,
    },
    /// The band `z[0] ≤ (p.z − center.z)/radius ≤ z[1]` of a sphere.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius.
        radius: f64,
        /// Range of z in the band; `[-1, 1]` for the whole sphere.
        z: [f64; 2],
        /// True if the front is the inside.
        inward: bool,
    },
    /// A flat disk.
    Disk {
        /// Centre.
        center: DVec3,
        /// Unit normal of the front.
        normal: DVec3,
        /// Radius.
        radius: f64,
    },
}

impl Primitive {
    /// Area of one side, m².
    pub fn area(&self) -> f64 {
        match *self {
            Self::Triangle([a, b, c]) => 0.5 * (b - a).cross(c - a).length(),
            Self::Parallelogram { edge_u, edge_v, .. } => edge_u.cross(edge_v).length(),
            // Archimedes: a band of a sphere has the same area as the band of the enclosing cylinder
            Self::Sphere { radius, z, .. } => std::f64::consts::TAU * radius * radius * (z[1] - z[0]),
            Self::Disk { radius, .. } => std::f64::consts::PI * radius * radius,
        }
    }

    /// Lowest and highest corner of the smallest axis-aligned box that contains the primitive.
    pub fn bounds(&self) -> [DVec3; 2] {
        let hull =
            |p: &[DVec3]| p.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], &p| [a.min(p), b.max(p)]);
        match *self {
            Self::Triangle(p) => hull(&p),
            Self::Parallelogram { origin: o, edge_u: u, edge_v: v } => hull(&[o, o + u, o + v, o + u + v]),
            Self::Sphere { center, radius, z, .. } => [
                center + DVec3::new(-radius, -radius, z[0] * radius),
                center + DVec3::new(radius, radius, z[1] * radius),
            ],
            Self::Disk { center, normal, radius } => {
                let half = radius * (DVec3::ONE - normal * normal).max(DVec3::ZERO).map(f64::sqrt);
                [center - half, center + half]
            }
        }
    }
}

impl Geometry {
    /// The primitives of the shape in a fixed order: mesh faces in file order, box faces −x, +x, −y, +y, −z, +z.
    pub fn primitives(&self) -> Vec<Primitive> {
        self.each().collect()
    }

    /// The same, one after the other: those of a mesh are not kept.
    pub(crate) fn each(&self) -> impl Iterator<Item = Primitive> + '_ {
        let (vertices, faces): (&[DVec3], &[[u32; 3]]) = match self {
            Self::Mesh { vertices, faces, .. } => (vertices, faces),
            _ => Default::default(),
        };
        let triangles = faces.iter().map(move |f| Primitive::Triangle(f.map(|i| vertices[i as usize])));
        triangles.chain(self.few())
    }

    /// The primitives of a shape that is no mesh.
    fn few(&self) -> Vec<Primitive> {
        match self {
            Self::Mesh { .. } => vec![],
            &Self::Quad { origin, edge_u, edge_v } => vec![Primitive::Parallelogram { origin, edge_u, edge_v }],
            &Self::Box { min, max, rotate_y, inward } => box_faces(min, max, rotate_y, inward),
            &Self::Sphere { center, radius, z, inward } => vec![Primitive::Sphere { center, radius, z, inward }],
            &Self::Disk { center, normal, radius } => {
                vec![Primitive::Disk { center, normal: normal.normalize(), radius }]
            }
        }
    }
}

fn box_faces(min: DVec3, max: DVec3, rotate_y: f64, inward: bool) -> Vec<Primitive> {
    let center = 0.5 * (min + max);
    let half = 0.5 * (max - min);
    let turn = DQuat::from_rotation_y(rotate_y.to_radians());
    // each corner is computed once, so that neighbouring faces share it to the last bit
    let corner = |x: usize, y: usize, z: usize| {
        let sign = |b: usize| if b == 0 { -1.0 } else { 1.0 };
        let local = half * DVec3::new(sign(x), sign(y), sign(z));
        if rotate_y == 0.0 { center + local } else { center + turn * local }
    };
    let face = |axis: usize, side: usize| {
        let at = |a: usize, b: usize| match axis {
            0 => corner(side, a, b),
            1 => corner(b, side, a),
            _ => corner(a, b, side),
        };
        let (o, u, v) = (at(0, 0), at(1, 0), at(0, 1));
        // (axis + 1) × (axis + 2) = axis, so u × v points to +axis
        let (edge_u, edge_v) = if (side == 1) != inward { (u - o, v - o) } else { (v - o, u - o) };
        Primitive::Parallelogram { origin: o, edge_u, edge_v }
    };
    (0..6).map(|i| face(i / 2, i % 2)).collect()
}

impl Description {
    /// Every primitive with the index of its shape. The position in this list is the number of the primitive in the whole
    /// program.
    pub fn primitives(&self) -> Vec<(usize, Primitive)> {
        let shapes = || self.shapes.iter().enumerate();
        let mut all = Vec::with_capacity(shapes().map(|(_, s)| s.geometry.each().count()).sum());
        all.extend(shapes().flat_map(|(i, s)| s.geometry.each().map(move |p| (i, p))));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_normals_point_outwards_unless_inward() {
        for inward in [false, true] {
            let faces = box_faces(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), 30.0, inward);
            let center = DVec3::new(0.5, 1.0, 1.5);
            for (i, f) in faces.iter().enumerate() {
                let Primitive::Parallelogram { origin, edge_u, edge_v } = *f else { panic!() };
                let outward = edge_u.cross(edge_v).dot(origin + 0.5 * (edge_u + edge_v) - center) > 0.0;
                assert_eq!(outward, !inward, "face {i}");
            }
            let area: f64 = faces.iter().map(Primitive::area).sum();
            assert!((area - 22.0).abs() < 1e-12);
        }
    }
}
