//! A scene as plain data: the content of a scene file, before anything is built from it.
//!
//! Positions are in metres, right-handed, in `f64`; colours are linear Rec. 709. [`Scene::new`](super::Scene::new) converts
//! a description to a scene for ray tracing.

pub use super::bsdf::colour::Colour;
pub use super::bsdf::conductor::{ConductorSurface, Metal};
pub use super::bsdf::dielectric::{Choice, DielectricSurface};
pub use super::bsdf::diffuse::DiffuseSurface;
pub use super::bsdf::ggx::{Ggx, Masking};
pub use super::bsdf::mirror::MirrorSurface;
pub use super::bsdf::phong::PhongSurface;
pub use super::bsdf::plastic::PlasticSurface;
pub use super::bsdf::register::BsdfDescription;
use super::raster::Raster;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The content of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Short name, also used for the output folder.
    pub name: String,
    /// The pinhole camera.
    pub camera: CameraDescription,
    /// Named surfaces; shapes refer to them by index.
    pub materials: Vec<Material>,
    /// The geometry, in file order.
    pub shapes: Vec<Shape>,
    /// Lights without a surface, in file order; at most one of them is an environment.
    pub lights: Vec<LightDescription>,
    /// Closed-form image means that the file gives for tests, if any.
    pub expect: Option<Expect>,
}

impl Description {
    /// Returns an error with the reason if a radiosity matrix cannot represent this scene. It needs Lambertian surfaces of
    /// one colour, and only surfaces as lights.
    pub fn radiosity_suits(&self) -> Result<(), String> {
        if !self.lights.is_empty() {
            return Err("it has lights without a surface".into());
        }
        let used = |m: &Material| self.shapes.iter().any(|s| self.materials[s.material].name == m.name);
        match self.materials.iter().find(|m| used(m) && m.lambertian().is_none()) {
            Some(m) => Err(format!("material `{}` is not a Lambertian surface of one colour", m.name)),
            None => Ok(()),
        }
    }

    /// 1 in the colour channels in which a light or surface emits, 0 in the others.
    pub fn lit(&self) -> DVec3 {
        let light = |l: &LightDescription| match l {
            LightDescription::Point { intensity, .. } => *intensity,
            LightDescription::Directional { irradiance, .. } => *irradiance,
            LightDescription::Environment { sky: Sky::Constant(radiance), scale, .. } => *radiance * *scale,
            LightDescription::Environment { sky: Sky::LatLong(image) | Sky::MirrorBall(image), scale, .. } => {
                image.mean() * *scale
            }
        };
        let all = self.shapes.iter().map(|s| s.emission).chain(self.lights.iter().map(light));
        DVec3::select(all.fold(DVec3::ZERO, DVec3::max).cmpgt(DVec3::ZERO), DVec3::ONE, DVec3::ZERO)
    }
}

/// A pinhole camera. A pixel is the mean radiance over its square.
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

/// The sides of a surface that take part in light transport. The other side blocks light and is black.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Both sides reflect.
    Both,
    /// Only the side of the normal reflects.
    Front,
}

/// A named surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name by which shapes refer to it.
    pub name: String,
    /// Its scattering.
    pub bsdf: BsdfDescription,
    /// The sides that scatter; for a dielectric always both.
    pub sides: Sides,
}

impl Material {
    /// A Lambertian surface of one colour.
    pub fn diffuse(name: impl Into<String>, reflectance: DVec3, sides: Sides) -> Self {
        let surface = DiffuseSurface { reflectance: Colour::Uniform(reflectance) };
        Self { name: name.into(), bsdf: surface.into(), sides }
    }

    /// Returns true if both sides scatter.
    pub fn both_sides(&self) -> bool {
        self.sides == Sides::Both || self.bsdf.lets_through()
    }

    /// The albedo, if the surface is Lambertian and of one colour; `None` otherwise. Only such surfaces can be in a
    /// radiosity matrix.
    pub fn lambertian(&self) -> Option<DVec3> {
        match &self.bsdf {
            BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(rho) }) => Some(*rho),
            _ => None,
        }
    }
}

/// A light without a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum LightDescription {
    /// Light from a point, the same in every direction.
    Point {
        /// Position.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: DVec3,
    },
    /// Parallel light from infinity.
    Directional {
        /// Direction in which the light travels, of any length.
        direction: DVec3,
        /// Irradiance on a surface perpendicular to it, W/m².
        irradiance: DVec3,
    },
    /// Light from every direction at infinity.
    Environment {
        /// The radiance of the sky by direction.
        sky: Sky,
        /// Rotation about the vertical in degrees, counter-clockwise seen from +y.
        rotate: f64,
        /// Factor by which the radiance is multiplied.
        scale: f64,
    },
}

/// The radiance of the sky by direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// The same radiance from every direction.
    Constant(DVec3),
    /// An image by latitude and longitude: u = ½ + atan2(x, −z)/2π, v = acos(y)/π, row 0 at +y, constant in each texel.
    LatLong(Arc<Raster>),
    /// A photograph of a mirror sphere, seen along −z and filling the image.
    MirrorBall(Arc<Raster>),
}

/// A piece of geometry with its material and emission.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// A name for messages: the OBJ group, or `shapes[3]`.
    pub name: String,
    /// Its geometry.
    pub geometry: Geometry,
    /// Index into [`Description::materials`].
    pub material: usize,
    /// Radiance that leaves the front side, W·sr⁻¹·m⁻²; zero if the shape does not emit.
    pub emission: DVec3,
}

/// Geometry of a shape. Normals of box and sphere point outwards unless `inward` is true.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// Triangles, counter-clockwise seen from the front.
    Mesh {
        /// Corner positions.
        vertices: Vec<DVec3>,
        /// Three indices into `vertices` per triangle.
        faces: Vec<[u32; 3]>,
        /// Texture coordinates of the corners of each triangle; empty if there are none.
        uvs: Vec<[DVec2; 3]>,
    },
    /// The parallelogram `origin + u·edge_u + v·edge_v` with u, v in [0, 1]; its normal is `edge_u × edge_v`.
    Quad {
        /// A corner.
        origin: DVec3,
        /// First edge.
        edge_u: DVec3,
        /// Second edge.
        edge_v: DVec3,
    },
    /// An axis-aligned box, rotated by `rotate_y` degrees about the vertical through its centre (counter-clockwise seen from
    /// +y).
    Box {
        /// Smallest corner before the rotation.
        min: DVec3,
        /// Largest corner before the rotation.
        max: DVec3,
        /// Rotation in degrees about the vertical through the centre.
        rotate_y: f64,
        /// True if normals point to the inside.
        inward: bool,
    },
    /// A sphere, or a band of it with z between two fractions of the radius.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius.
        radius: f64,
        /// Range of `(p.z − center.z)/radius` that belongs to the band; `[-1, 1]` for the whole sphere.
        z: [f64; 2],
        /// True if normals point to the inside.
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

/// Closed-form values of a scene: image means of the first terms, the same in all channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Expect {
    /// Mean over the image of T^k E, k = 0, 1, ….
    pub terms: Vec<f64>,
    /// The exact ratio of consecutive terms, if it is constant.
    pub gamma: Option<f64>,
    /// Mean over the image of the whole series L, if it is known and not given by `gamma`.
    pub total: Option<f64>,
    /// δ, the margin within which a value counts as confirmed, as a fraction of the value.
    pub tolerance: f64,
    /// Reference for the numbers.
    pub source: String,
}

impl Expect {
    /// The usual margin.
    pub const TOLERANCE: f64 = 0.01;

    /// Mean over the image of the whole series: given, or the geometric series after the last term.
    pub fn total(&self) -> Option<f64> {
        let sum: f64 = self.terms.iter().sum();
        let geometric = |g: f64| sum + self.terms.last().copied().unwrap_or(0.0) * g / (1.0 - g);
        self.total.or(self.gamma.filter(|g| *g < 1.0).map(geometric))
    }
}
