//! A scene as plain data: what a file says, before anything is built from it.
//!
//! Positions in metres, right-handed, `f64`; colours linear Rec. 709. [`Scene::new`](super::Scene::new)
//! turns a description into something rays can hit.

use glam::DVec3;

/// Everything a scene file can say.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Short name, used for the output folder.
    pub name: String,
    /// The pinhole camera.
    pub camera: CameraDescription,
    /// Named surfaces; shapes refer to them by index.
    pub materials: Vec<Material>,
    /// The geometry, in file order.
    pub shapes: Vec<Shape>,
    /// Closed-form image means the scene claims for itself, if any.
    pub expect: Option<Expect>,
}

/// A pinhole camera; a pixel is the mean radiance over its square.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDescription {
    /// Position of the pinhole.
    pub origin: DVec3,
    /// A point in the centre of the image.
    pub target: DVec3,
    /// A direction that is up in the image.
    pub up: DVec3,
    /// Horizontal field of view in degrees.
    pub fov: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// Which sides of a surface take part in light transport. The other side blocks light and is black.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Both sides reflect.
    Both,
    /// Only the side of the normal reflects.
    Front,
}

/// A Lambertian surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name shapes use.
    pub name: String,
    /// Albedo per channel, in [0, 1].
    pub reflectance: DVec3,
    /// Sides that reflect.
    pub sides: Sides,
}

/// A piece of geometry with its material and emission.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// A name for messages: the OBJ group, or `shapes[3]`.
    pub name: String,
    /// Where it is.
    pub geometry: Geometry,
    /// Index into [`Description::materials`].
    pub material: usize,
    /// Radiance leaving the front side, W·sr⁻¹·m⁻²; zero for what does not emit.
    pub emission: DVec3,
}

/// The shapes a scene can hold. Normals of box and sphere point outwards unless `inward`.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// Triangles, counter-clockwise seen from the front.
    Mesh {
        /// Corner positions.
        vertices: Vec<DVec3>,
        /// Three indices into `vertices` per triangle.
        faces: Vec<[u32; 3]>,
    },
    /// The parallelogram `origin + u·edge_u + v·edge_v`, u, v in [0, 1]; normal `edge_u × edge_v`.
    Quad {
        /// A corner.
        origin: DVec3,
        /// First edge.
        edge_u: DVec3,
        /// Second edge.
        edge_v: DVec3,
    },
    /// An axis-aligned box, turned by `rotate_y` degrees about its centre (counter-clockwise seen from +y).
    Box {
        /// Smallest corner before the turn.
        min: DVec3,
        /// Largest corner before the turn.
        max: DVec3,
        /// Degrees about the vertical through the centre.
        rotate_y: f64,
        /// Normals point to the inside.
        inward: bool,
    },
    /// A sphere, or the band of it with `z` between the two fractions of the radius.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius.
        radius: f64,
        /// Lowest and highest `(p.z − center.z)/radius` kept; `[-1, 1]` for the whole sphere.
        z: [f64; 2],
        /// Normals point to the inside.
        inward: bool,
    },
    /// A flat disk.
    Disk {
        /// Centre.
        center: DVec3,
        /// Normal of the front side, any length.
        normal: DVec3,
        /// Radius.
        radius: f64,
    },
}

/// Closed-form values of a scene: grey image means of the first terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Expect {
    /// Mean over the image of T^k E, k = 0, 1, ….
    pub terms: Vec<f64>,
    /// The exact ratio of consecutive terms, where there is one.
    pub gamma: Option<f64>,
    /// Where the numbers come from.
    pub source: String,
}
