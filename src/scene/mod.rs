//! What exists: surfaces, lights, sensors.
//!
//! A [`Description`] is what a file says; a [`Scene`] is what rays meet.
//!
//! | notation | type | place |
//! |---|---|---|
//! | x, ω | [`Vertex`] | [`vertex`] |
//! | ray(x, ω) | [`Scene::trace`] | `accel`, `packets`, `shape` |
//! | f(ω_o, ω_i) | [`Bsdf`] | [`bsdf`] |
//! | E(x, ω) | [`Scene::emission`], [`Scene::light`] | [`emitter`] |
//! | W(x, ω) | [`Camera`], [`SurfaceSensor`] | [`sensor`] |

mod accel;
pub mod bsdf;
pub mod builtin;
mod cast;
pub mod centre;
pub mod coplanar;
pub mod description;
pub mod emitter;
mod error;
mod lighting;
pub mod load;
mod packets;
pub mod primitive;
pub mod raster;
mod rounding;
pub mod sensor;
mod shape;
mod stand_in;
mod textures;
pub mod vertex;

pub use description::Description;
pub use error::SceneError;
pub use lighting::LightSample;
pub use primitive::Primitive;
pub use sensor::{Camera, SurfaceSensor};
pub use stand_in::stand_in;
pub use vertex::{ESCAPED, LIGHT, Side, Vertex, VertexWave};

use crate::math::Rgb;
use accel::Accel;
use bsdf::Bsdf;
use coplanar::Relation;
use description::LightDescription;
pub use emitter::Selection;
use emitter::{Light, Lights};
use glam::{DVec3, Vec3};
pub(crate) use rounding::{error, offset_origin, segment};
use shape::Shape;
use textures::Textures;
pub(crate) use vertex::Rays;

pub(crate) use packets::{cosine_directions, numbers};

/// The change of measure: a density per area at y, seen from a point at distance r, per solid angle.
#[inline(always)]
pub(crate) fn solid_angle(per_area: f32, r2: f32, cos_y: f32) -> f32 {
    per_area * r2 / cos_y
}

/// A connection from x (normal n) to y (normal m): unit direction, distance squared, cosines at both ends.
#[inline(always)]
pub(crate) fn connection(x: Vec3, n: Vec3, y: Vec3, m: Vec3) -> (Vec3, f32, f32, f32) {
    let d = y - x;
    let r2 = d.x * d.x + d.y * d.y + d.z * d.z;
    let d = d * (1.0 / r2.sqrt());
    (d, r2, d.x * n.x + d.y * n.y + d.z * n.z, -(d.x * m.x + d.y * m.y + d.z * m.z))
}

/// Surfaces ready for rays, and their lights.
pub struct Scene {
    /// The camera of the description.
    pub camera: Camera,
    /// What emits.
    pub lights: Lights,
    accel: Accel,
    /// Whether waves are traced in packets.
    packets: bool,
    /// By side: BSDF, largest albedo, emission, whether it takes part in transport.
    bsdf: Vec<Bsdf>,
    albedo: Vec<Rgb>,
    emission: Vec<Rgb>,
    takes_part: Vec<bool>,
    area: Vec<f64>,
    textures: Option<Textures>,
    /// Where its coordinates begin, in those of the file, m.
    origin: DVec3,
    /// A sphere around the shapes.
    center: Vec3,
    radius: f32,
    /// A distance that leaves the scene from everywhere in it, point lights included.
    beyond: f32,
    /// Whether some surface has a delta part.
    any_delta: bool,
    /// Shapes that coincide and differ.
    conflicts: Vec<Relation>,
    /// 1 in the channels in which anything emits.
    lit: Rgb,
    /// How paths end that nothing else ends.
    last_resort: Option<(usize, f32)>,
}

impl Scene {
    /// Builds what rays need, in coordinates about the middle of the scene ([`Description::centred`]). The description must have
    /// passed the checks of the loader: finite, no empty shapes, none that single precision rounds away.
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
        let widened: Vec<[Vec3; 2]> = bounds.iter().map(|b| accel::widened(*b, farthest, touch)).collect();
        let (mut bsdf, mut emission, mut takes_part) = (vec![], vec![], vec![]);
        for &(shape, _) in prims {
            let shape = &description.shapes[shape];
            let material = &description.materials[shape.material];
            let both = material.both_sides();
            let back = if both { Bsdf::new(&material.bsdf, true) } else { Bsdf::Black };
            bsdf.extend([Bsdf::new(&material.bsdf, false), back]);
            emission.extend([shape.emission.as_vec3(), Rgb::ZERO]);
            takes_part.extend([true, both]);
        }
        let textures = Textures::new(description, prims);
        let plain = bsdf.iter().all(|b| matches!(b, Bsdf::Diffuse(_) | Bsdf::Black));
        let plain = plain && textures.is_none() && description.lights.is_empty();
        let albedo = bsdf.iter().enumerate().map(|(side, b)| match &textures {
            Some(t) => t.brightest(side / 2).map_or(*b, |rho| b.with_reflectance(rho)).max_albedo(),
            None => b.max_albedo(),
        });
        // lights without area shine on the shapes; what is beyond lies beyond point lights, too
        let outside = description.lights.iter().filter_map(|l| match l {
            LightDescription::Point { position, .. } => Some(*position),
            _ => None,
        });
        let reach = outside.map(|p| (p - center).length()).fold(radius, f64::max);
        Self {
            packets: plain && packets::suit(&shapes),
            camera: Camera::new(&description.camera, center, radius),
            lights: Lights::new(description, prims, radius),
            accel: Accel::new(shapes, &widened),
            albedo: albedo.collect(),
            any_delta: bsdf.iter().any(Bsdf::has_delta),
            lit: description.lit().as_vec3(),
            last_resort: None,
            center: center.as_vec3(),
            radius: radius as f32,
            beyond: (4.0 * reach) as f32,
            bsdf,
            textures,
            emission,
            takes_part,
            area: prims.iter().map(|(_, p)| p.area()).collect(),
            origin,
            conflicts: surfaces.conflicts(description),
        }
    }

    /// Where its coordinates begin, in those of the file: positions of vertices and of [`Camera`] are relative to it.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The shapes that coincide and differ, whether anybody sees them or not.
    pub fn conflicts(&self) -> &[Relation] {
        &self.conflicts
    }

    /// Number of sides: two per primitive.
    pub fn sides(&self) -> u32 {
        self.takes_part.len() as u32
    }

    /// Whether a side takes part in transport. One that does not blocks light and is black.
    pub fn takes_part(&self, side: Side) -> bool {
        self.takes_part[side as usize]
    }

    /// Area of a side, m².
    pub fn area(&self, side: Side) -> f64 {
        self.area[(side / 2) as usize]
    }

    /// How the surface scatters at a vertex; black where there is none.
    #[inline(always)]
    pub fn bsdf(&self, at: &Vertex) -> Bsdf {
        if !at.on_surface() {
            return Bsdf::Black;
        }
        let bsdf = self.bsdf[at.side as usize];
        match &self.textures {
            None => bsdf,
            Some(t) => match t.reflectance(at.side / 2, &self.accel.shapes[(at.side / 2) as usize], at.p) {
                Some(rho) => bsdf.with_reflectance(rho),
                None => bsdf,
            },
        }
    }

    /// What arrives from a vertex by its own light: E on a surface, the sky's radiance where a ray has escaped, W/sr of a
    /// point, W/m² of a direction.
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

    /// The largest albedo of a side in any direction: ρ of a Lambertian one.
    #[inline(always)]
    pub fn albedo(&self, side: Side) -> Rgb {
        self.albedo[side as usize]
    }

    /// The largest albedo of any side, per channel: the bound on ‖T‖₁ and ‖T‖∞.
    pub fn max_albedo(&self) -> Rgb {
        self.albedo.iter().fold(Rgb::ZERO, |a, &b| a.max(b))
    }

    /// Emitted radiance E of a side, W·sr⁻¹·m⁻², the same in every direction.
    #[inline(always)]
    pub fn emission(&self, side: Side) -> Rgb {
        self.emission[side as usize]
    }

    /// Density of next-event estimation at a point of this side, per area: 0 where it cannot choose.
    #[inline(always)]
    pub fn light_density(&self, side: Side) -> f32 {
        if side & 1 == 0 { self.lights.density[(side / 2) as usize] } else { 0.0 }
    }

    /// Lights selected in another way.
    #[must_use]
    pub fn select_lights(mut self, selection: Selection) -> Self {
        self.lights.select(selection);
        self
    }

    /// Whether some surface is a mirror or glass, at least in part: no connection finds what it shows.
    pub fn any_delta_surface(&self) -> bool {
        self.any_delta
    }

    /// 1 in the channels in which anything emits, 0 in the others.
    #[inline(always)]
    pub fn lit(&self) -> Rgb {
        self.lit
    }

    /// From which vertex on, and with which probability at least, paths end that nothing else ends; see `engine::known::resort`.
    #[inline(always)]
    pub fn last_resort(&self) -> Option<(usize, f32)> {
        self.last_resort
    }

    /// The same scene with such an end.
    #[must_use]
    pub fn ending_at(self, vertex: usize, q: f32) -> Self {
        Self { last_resort: Some((vertex, q)), ..self }
    }

    /// Whether a ray can leave for the sky and bring light from there.
    pub fn has_environment(&self) -> bool {
        self.lights.environment.is_some()
    }

    /// A uniformly distributed point of a side, and the normal there.
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

    /// The light points of a wave: positions in `rays.o`, normals in `rays.d`, densities in `rays.t`, primitives in `rays.prim`.
    #[inline(always)]
    pub(crate) fn light_points(&self, rays: &mut Rays, n: usize) {
        if let Some(prim) = self.lights.only() {
            packets::points_on(&self.accel.shapes[prim as usize], self.lights.density[prim as usize], rays, n);
            rays.prim[..n].fill(prim);
            return;
        }
        for i in 0..n {
            let [u, v, s, t] = rays.u.each_ref().map(|u| u[i]);
            let prim = self.lights.primitive(self.lights.choose(u), v).unwrap_or_default();
            let shape = &self.accel.shapes[prim as usize];
            let p = shape.point([s, t]);
            rays.o.set(i, p);
            rays.d.set(i, shape.normal(p));
            rays.t[i] = self.lights.density[prim as usize];
            rays.prim[i] = prim;
        }
    }
}
