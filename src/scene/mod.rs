//! The scene: surfaces, lights and sensors.
//!
//! A [`Description`] is the content of a scene file. A [`Scene`] is built from it and is what rays hit.
//!
//! | notation | type | place |
//! |---|---|---|
//! | x, ω | [`Vertex`] | [`vertex`] |
//! | ray(x, ω) | [`Scene::trace`] | `accel`, `wide`, `packets`, `shape` |
//! | f(ω_o, ω_i) | [`Bsdf`] | [`bsdf`] |
//! | E(x, ω) | [`Scene::emission`], [`Scene::light`] | [`emitter`] |
//! | W(x, ω) | [`Camera`], [`SurfaceSensor`] | [`sensor`] |

mod accel;
mod arrive;
mod ball;
#[doc(hidden)]
pub mod batch;
pub mod bsdf;
pub mod builtin;
mod by_path;
mod cast;
pub mod centre;
pub mod coplanar;
mod crop;
pub mod description;
mod emitted;
pub mod emitter;
mod enter;
mod error;
pub mod export;
mod faces;
mod few;
mod flat;
mod front;
mod groups;
pub mod image_header;
mod light_lanes;
mod lighting;
pub mod load;
mod packets;
mod plucker;
pub mod primitive;
pub mod raster;
mod rounding;
pub mod sensor;
mod shape;
mod sheet;
mod sixteen;
mod stand_in;
mod textures;
pub mod vertex;
mod wide;

pub(crate) use by_path::{Received, by_path};
pub use crop::Crop;
pub use description::{Description, Expect};
pub use error::SceneError;
pub use lighting::LightSample;
pub use primitive::Primitive;
pub use sensor::{Camera, SurfaceSensor};
pub use stand_in::stand_in;
pub(crate) use vertex::{DELTA, NOTHING, NOWHERE};
pub use vertex::{ESCAPED, LIGHT, Side, Vertex, VertexWave};

use crate::math::Rgb;
use accel::Accel;
use arrive::Arrivals;
use bsdf::Bsdf;
use coplanar::Relation;
use description::LightDescription;
pub use emitter::Selection;
use emitter::{Light, Lights};
use faces::Faces;
use glam::{DVec3, Vec3};
pub(crate) use groups::Vertices;
pub(crate) use rounding::{error, offset_origin, segment};
use shape::Shape;
use textures::Textures;
pub(crate) use vertex::Rays;

pub(crate) use packets::numbers;
pub(crate) use sensor::camera_rays;

/// Change of measure: converts a density per area at a point y to one per solid angle at a point at distance r, with `r2` =
/// r².
#[inline(always)]
pub(crate) fn solid_angle(per_area: f32, r2: f32, cos_y: f32) -> f32 {
    per_area * r2 / cos_y
}

/// Geometry of a connection from x (normal n) to y (normal m): unit direction, squared distance, and the cosines at x and at
/// y.
#[inline(always)]
pub(crate) fn connection(x: Vec3, n: Vec3, y: Vec3, m: Vec3) -> (Vec3, f32, f32, f32) {
    let d = y - x;
    let r2 = d.x * d.x + d.y * d.y + d.z * d.z;
    let d = d * (1.0 / r2.sqrt());
    (d, r2, d.x * n.x + d.y * n.y + d.z * n.z, -(d.x * m.x + d.y * m.y + d.z * m.z))
}

/// A scene ready for ray tracing, with its lights.
pub struct Scene {
    /// The camera of the description.
    pub camera: Camera,
    /// All lights.
    pub lights: Lights,
    accel: Accel,
    /// How the rays of a wave are traced, and where they arrive.
    arrivals: Arrivals,
    /// True if waves are advanced together, and not path by path.
    waves: bool,
    /// For every side: its BSDF, largest albedo and emission, and whether it takes part in light transport.
    faces: Faces,
    area: Vec<f64>,
    textures: Option<Textures>,
    /// Position of the scene's coordinate origin in the coordinates of the file, m.
    origin: DVec3,
    /// Centre and radius of a sphere that encloses the shapes.
    center: Vec3,
    radius: f32,
    /// A distance that leads out of the scene from every point of it, including point lights.
    beyond: f32,
    /// True if some surface has a delta part.
    any_delta: bool,
    /// Pairs of coincident shapes that look different.
    conflicts: Vec<Relation>,
    /// 1 in the colour channels in which anything emits, 0 in the others.
    lit: Rgb,
    /// First vertex and smallest probability of termination, for paths that nothing else ends.
    last_resort: Option<(usize, f32)>,
}

impl Scene {
    /// Builds the scene in coordinates about its middle ([`Description::centred`]). The description must have passed the
    /// checks of the loader: all numbers are finite, no shape is empty, and single precision deforms none.
    pub fn new(description: &Description) -> Self {
        let centre::Centred { scene, origin, touch } = description.centred();
        let description = &scene;
        let surfaces = description.surfaces();
        let prims = surfaces.list.as_slice();
        let bounds: Vec<[DVec3; 2]> = prims.iter().map(|(_, p)| p.bounds()).collect();
        let all = bounds.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let radius = 0.5 * (all[1] - all[0]).length();
        let center = 0.5 * (all[0] + all[1]);
        let shapes: Vec<Shape> = prims.iter().map(|(_, p)| Shape::new(p, touch)).collect();
        let farthest = all[0].abs().max(all[1].abs()).max_element();
        let widened: Vec<[Vec3; 2]> = bounds.into_iter().map(|b| accel::widened(b, farthest, touch)).collect();
        let textures = Textures::new(description, prims);
        let faces = Faces::new(description, prims, |i| textures.as_ref().and_then(|t| t.brightest(i)));
        let any_delta = faces.iter().any(|face| face.bsdf.has_delta());
        // lights without area illuminate the shapes too, so `beyond` must also lead past point lights
        let outside = description.lights.iter().filter_map(|l| match l {
            LightDescription::Point { position, .. } => Some(*position),
            _ => None,
        });
        let reach = outside.map(|p| (p - center).length()).fold(radius, f64::max);
        let lights = Lights::new(description, prims, radius);
        let area = prims.iter().map(|(_, p)| p.area()).collect();
        let conflicts = surfaces.conflicts(description);
        // building the tree needs most of the memory
        drop(surfaces);
        Self {
            arrivals: Arrivals::new(&shapes),
            waves: true,
            camera: Camera::new(&description.camera, center, radius),
            lights,
            accel: Accel::new(shapes, widened),
            any_delta,
            lit: description.lit().as_vec3(),
            last_resort: None,
            center: center.as_vec3(),
            radius: radius as f32,
            beyond: (4.0 * reach) as f32,
            faces,
            textures,
            area,
            origin,
            conflicts,
        }
    }

    /// Position of the scene's coordinate origin in the coordinates of the file, m. Positions of vertices and of [`Camera`]
    /// are relative to it.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Pairs of coincident shapes that look different, including pairs that are hidden from the camera.
    pub fn conflicts(&self) -> &[Relation] {
        &self.conflicts
    }

    /// Number of sides: two per primitive.
    pub fn sides(&self) -> u32 {
        self.faces.sides()
    }

    /// Returns true if a side takes part in light transport: every front, and the back of a two-sided surface. All other sides
    /// block light and are black.
    pub fn takes_part(&self, side: Side) -> bool {
        self.faces.of(side).takes_part
    }

    /// Area of a side, m².
    pub fn area(&self, side: Side) -> f64 {
        self.area[(side / 2) as usize]
    }

    /// The BSDF at a vertex; black if the vertex is not on a surface.
    #[inline(always)]
    pub fn bsdf(&self, at: &Vertex) -> Bsdf {
        if !at.on_surface() {
            return Bsdf::Black;
        }
        let bsdf = self.faces.of(at.side).bsdf;
        match &self.textures {
            None => bsdf,
            Some(t) => match t.reflectance(at.side / 2, &self.accel.shapes[(at.side / 2) as usize], at.p) {
                Some(rho) => bsdf.with_reflectance(rho),
                None => bsdf,
            },
        }
    }

    /// The light that a vertex emits itself. The quantity depends on the vertex: radiance E on a surface, radiance of the
    /// sky for an escaped ray, intensity (W/sr) of a point light, irradiance (W/m²) of a directional light.
    #[inline(always)]
    pub fn light(&self, at: &Vertex) -> Rgb {
        match at.side {
            side if side < LIGHT => self.emission(side),
            ESCAPED => self.lights.environment.as_ref().map_or(Rgb::ZERO, |(sky, _)| sky.radiance(-at.omega)),
            side => match self.lights.lights[(side - LIGHT) as usize] {
                Light::Point { intensity, .. } => intensity,
                Light::Directional { irradiance, .. } => irradiance,
                _ => Rgb::ZERO,
            },
        }
    }

    /// The largest albedo of a side over all directions and, for a texture, all its texels; ρ for a Lambertian side.
    #[inline(always)]
    pub fn albedo(&self, side: Side) -> Rgb {
        self.faces.of(side).albedo
    }

    /// The largest albedo of all sides, per channel: the bound on ‖T‖₁ and ‖T‖∞.
    pub fn max_albedo(&self) -> Rgb {
        self.faces.iter().fold(Rgb::ZERO, |a, b| a.max(b.albedo))
    }

    /// Emitted radiance E of a side, W·sr⁻¹·m⁻², the same in every direction.
    #[inline(always)]
    pub fn emission(&self, side: Side) -> Rgb {
        self.faces.of(side).emission
    }

    /// Density per area (m⁻²) with which next-event estimation chooses a point of this side; 0 if it cannot choose it.
    #[inline(always)]
    pub fn light_density(&self, side: Side) -> f32 {
        if side & 1 == 0 { self.lights.density[(side / 2) as usize] } else { 0.0 }
    }

    /// The same scene with another rule for the choice of a light.
    #[must_use]
    pub fn select_lights(mut self, selection: Selection) -> Self {
        self.lights.select(selection);
        self
    }

    /// Returns true if some surface has a delta part, such as a mirror or smooth glass. No connection finds light that
    /// arrives over it.
    pub fn any_delta_surface(&self) -> bool {
        self.any_delta
    }

    /// 1 in the channels in which anything emits, 0 in the others.
    #[inline(always)]
    pub fn lit(&self) -> Rgb {
        self.lit
    }

    /// The first vertex at which paths end that nothing else ends, and their smallest probability of termination there; see
    /// `engine::known::resort`.
    #[inline(always)]
    pub fn last_resort(&self) -> Option<(usize, f32)> {
        self.last_resort
    }

    /// The same scene, but paths that nothing else ends are terminated from `vertex` on with a probability of at least `q`.
    #[must_use]
    pub fn ending_at(self, vertex: usize, q: f32) -> Self {
        Self { last_resort: Some((vertex, q)), ..self }
    }

    /// Returns true if the scene has an environment light, which rays that leave the scene find.
    pub fn has_environment(&self) -> bool {
        self.lights.environment.is_some()
    }

    /// A uniformly distributed point of a side, and the normal of this side there.
    #[inline(always)]
    pub fn point(&self, side: Side, u: [f32; 2]) -> (Vec3, Vec3) {
        let shape = &self.accel.shapes[(side / 2) as usize];
        let p = shape.settle(shape.point(u));
        let n = shape.normal(p);
        (p, if side & 1 == 0 { n } else { -n })
    }

    /// A point outside the scene in direction `d` from `x`.
    #[inline(always)]
    pub(crate) fn beyond(&self, x: Vec3, d: Vec3) -> Vec3 {
        x + d * self.beyond
    }
}
