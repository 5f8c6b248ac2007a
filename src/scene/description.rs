//! A scene as plain data: what a file says, before anything is built from it.
//!
//! Positions in metres, right-handed, `f64`; colours linear Rec. 709. [`Scene::new`](super::Scene::new)
//! turns a description into something rays can hit.

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
    /// Lights without a surface, in file order; at most one of them is an environment.
    pub lights: Vec<LightDescription>,
    /// Closed-form image means the scene claims for itself, if any.
    pub expect: Option<Expect>,
}

impl Description {
    /// Why a radiosity matrix cannot hold this scene, if it cannot: Lambertian surfaces of one colour, lit by surfaces.
    pub fn radiosity_suits(&self) -> Result<(), String> {
        if !self.lights.is_empty() {
            return Err("it has lights that are no surfaces".into());
        }
        let used = |m: &Material| self.shapes.iter().any(|s| self.materials[s.material].name == m.name);
        match self.materials.iter().find(|m| used(m) && m.lambertian().is_none()) {
            Some(m) => Err(format!("material `{}` is not Lambertian of one colour", m.name)),
            None => Ok(()),
        }
    }

    /// 1 in the channels in which anything emits, 0 in the others.
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

/// A named surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name shapes use.
    pub name: String,
    /// How it scatters.
    pub bsdf: BsdfDescription,
    /// Sides that scatter; of a dielectric always both.
    pub sides: Sides,
}

impl Material {
    /// A Lambertian surface of one colour.
    pub fn diffuse(name: impl Into<String>, reflectance: DVec3, sides: Sides) -> Self {
        let surface = DiffuseSurface { reflectance: Colour::Uniform(reflectance) };
        Self { name: name.into(), bsdf: surface.into(), sides }
    }

    /// Whether both sides scatter.
    pub fn both_sides(&self) -> bool {
        self.sides == Sides::Both || self.bsdf.lets_through()
    }

    /// The albedo, if the surface is Lambertian and of one colour: what a radiosity matrix can hold.
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
        /// Where.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: DVec3,
    },
    /// Parallel light from infinity.
    Directional {
        /// Direction the light travels in, any length.
        direction: DVec3,
        /// Irradiance on a surface perpendicular to it, W/m².
        irradiance: DVec3,
    },
    /// Light from every direction at infinity.
    Environment {
        /// What the sky looks like.
        sky: Sky,
        /// Degrees about the vertical, counter-clockwise seen from +y.
        rotate: f64,
        /// Factor on the radiance.
        scale: f64,
    },
}

/// What an environment looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// The same radiance from everywhere.
    Constant(DVec3),
    /// u = ½ + atan2(x, −z)/2π, v = acos(y)/π, row 0 at +y, constant per texel.
    LatLong(Arc<Raster>),
    /// A photograph of a mirror sphere, seen along −z and filling the image.
    MirrorBall(Arc<Raster>),
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
        /// Texture coordinates of the corners of each triangle; empty if there are none.
        uvs: Vec<[DVec2; 3]>,
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
