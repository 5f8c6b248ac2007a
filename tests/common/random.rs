//! Random scenes, matrices and schedules for property tests; the same ones in every run.

use super::scenes::{description, quad, room, sphere};
use fredholm::estimator::Roulette;
use fredholm::math::Rgb;
use fredholm::operator::MatrixWalk;
use fredholm::scene::description::{
    BsdfDescription, Choice, Colour, Description, Geometry, Ggx, LightDescription, Masking, Metal, Sides, Sky,
};
use fredholm::scene::description::{
    ConductorSurface, DielectricSurface, DiffuseSurface, MirrorSurface, PhongSurface, PlasticSurface,
};
use fredholm::scene::raster::Raster;
use glam::{DQuat, DVec3};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{FileFailurePersistence, RngAlgorithm, RngSeed, TestRunner};
use std::sync::Arc;

/// `n` cases, always the same; `PROPTEST_CASES` and `PROPTEST_RNG_SEED` override. What once failed is kept beside the
/// test and tried first.
pub fn cases(n: u32) -> ProptestConfig {
    ProptestConfig {
        cases: n,
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(20_260_101),
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..ProptestConfig::default()
    }
}

/// The first `n` values of a strategy; the same in every run.
pub fn draw<S: Strategy>(strategy: S, n: usize) -> impl Iterator<Item = S::Value> {
    let mut runner = TestRunner::new(cases(n as u32));
    (0..n).map(move |_| strategy.new_tree(&mut runner).unwrap().current())
}

/// A thing in a room.
#[derive(Clone, Debug)]
pub struct Item {
    kind: Kind,
    at: DVec3,
    size: DVec3,
    turn: DVec3,
    rho: DVec3,
    glow: DVec3,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Sphere,
    Box,
    Quad,
    Disk,
    Triangle,
}

fn vector(lo: f64, hi: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(lo..hi).prop_map(DVec3::from)
}

pub fn albedo() -> impl Strategy<Value = DVec3> {
    // black and white walls are cases of their own
    prop_oneof![8 => vector(0.0, 1.0), 1 => Just(DVec3::ZERO), 1 => Just(DVec3::ONE)]
}

/// A thing; `bright` ones always glow.
fn item(kinds: Vec<Kind>, bright: bool) -> impl Strategy<Value = Item> {
    let glow = prop_oneof![3 => Just(DVec3::ZERO), 1 => vector(0.0, 5.0)];
    let glow = if bright { vector(0.5, 5.0).boxed() } else { glow.boxed() };
    let shape = (prop::sample::select(kinds), vector(-0.5, 0.5), vector(0.1, 0.3), vector(-3.0, 3.0));
    (shape, albedo(), glow).prop_map(|((kind, at, size, turn), rho, glow)| Item { kind, at, size, turn, rho, glow })
}

/// Up to five things, the first of which glows.
pub fn items() -> impl Strategy<Value = Vec<Item>> {
    let all = vec![Kind::Sphere, Kind::Box, Kind::Quad, Kind::Disk, Kind::Triangle];
    let more = prop::collection::vec(item(all.clone(), false), 0..5);
    (item(all, true), more).prop_map(|(first, mut rest)| {
        rest.insert(0, first);
        rest
    })
}

/// One ball or block that glows.
pub fn solid() -> impl Strategy<Value = Item> {
    item(vec![Kind::Sphere, Kind::Box], true)
}

impl Item {
    /// The same thing with another albedo.
    pub fn with_albedo(mut self, rho: DVec3) -> Self {
        self.rho = rho;
        self
    }

    fn geometry(&self) -> Geometry {
        let (at, size) = (self.at, self.size);
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, self.turn.x, self.turn.y, self.turn.z);
        match self.kind {
            Kind::Sphere => sphere(at, size.x, false),
            Kind::Box => {
                Geometry::Box { min: at - size, max: at + size, rotate_y: self.turn.y.to_degrees(), inward: false }
            }
            Kind::Quad => quad(at, turn * DVec3::X * size.x, turn * DVec3::new(0.3 * size.z, size.y, 0.0)),
            Kind::Disk => Geometry::Disk { center: at, normal: turn * DVec3::Z, radius: size.x },
            Kind::Triangle => {
                let corners = [DVec3::ZERO, DVec3::X * size.x, DVec3::Y * size.y];
                Geometry::Mesh {
                    vertices: corners.map(|c| at + turn * c).to_vec(),
                    faces: vec![[0, 1, 2]],
                    uvs: vec![],
                }
            }
        }
    }
}

/// A closed room [−1, 1]³ with these walls and things in it, seen from a corner.
pub fn furnished(walls: DVec3, items: &[Item]) -> Description {
    let mut surfaces = vec![(room(DVec3::splat(-1.0), DVec3::ONE, 0.0), walls, DVec3::ZERO)];
    surfaces.extend(items.iter().map(|i| (i.geometry(), i.rho, i.glow)));
    let mut d = description(&surfaces);
    d.camera.origin = DVec3::splat(0.93);
    d.camera.target = DVec3::ZERO;
    d
}

/// A random substochastic matrix with albedos and emissions, some of them zero.
pub fn matrix() -> impl Strategy<Value = MatrixWalk> {
    let row = |n: usize| (prop::collection::vec(0.0..1.0f64, n), 0.5..1.0f64);
    let colour = |hi: f64| prop_oneof![3 => vector(0.0, hi), 1 => Just(DVec3::ZERO)];
    (2usize..7).prop_flat_map(move |n| {
        let rows = prop::collection::vec(row(n), n);
        let (rho, emission) = (prop::collection::vec(colour(0.99), n), prop::collection::vec(colour(3.0), n));
        (rows, rho, emission).prop_map(|(rows, rho, emission)| {
            let scaled = |(row, sum): &(Vec<f64>, f64)| {
                let scale = sum / row.iter().sum::<f64>().max(1e-9);
                row.iter().map(|f| f * scale).collect::<Vec<_>>()
            };
            let colours = |c: Vec<DVec3>| c.into_iter().map(|c| c.as_vec3()).collect::<Vec<Rgb>>();
            MatrixWalk::new(rows.iter().flat_map(scaled).collect(), colours(rho), colours(emission))
        })
    })
}

/// Any schedule that ends paths.
pub fn schedule() -> impl Strategy<Value = Roulette> {
    let q = || prop_oneof![1 => Just(0.0), 4 => 0.0..0.9f64];
    prop_oneof![
        (0usize..4, 0.05..0.9f64).prop_map(|(from, q)| Roulette::Constant { from, q }),
        (prop::collection::vec(q(), 0..5), 0.05..0.9f64).prop_map(|(mut table, last)| {
            table.push(last);
            Roulette::Table(table)
        }),
        (0usize..4).prop_map(|from| Roulette::Albedo { from }),
        (0usize..4).prop_map(|from| Roulette::Throughput { from }),
    ]
}

// ------------------------------------------------------------------------------------------------ worlds of any material

fn any_albedo(top: f64) -> impl Strategy<Value = DVec3> {
    prop_oneof![6 => vector(0.05, top), 1 => Just(DVec3::splat(top))]
}

/// Microfacets or none.
fn rough() -> impl Strategy<Value = Option<Ggx>> {
    let masking = prop_oneof![Just(Masking::HeightCorrelated), Just(Masking::Separable)];
    prop_oneof![Just(None), (0.1..1.0f64, masking).prop_map(|(alpha, masking)| Some(Ggx { alpha, masking }))]
}

/// A surface that lets nothing through, of albedo at most `top`.
pub fn opaque(top: f64) -> impl Strategy<Value = BsdfDescription> {
    let metal = prop_oneof![
        any_albedo(top).prop_map(Metal::Reflectance),
        (vector(0.1, 3.0), vector(1.0, 4.0)).prop_map(move |(eta, k)| {
            // an index reflects everything at grazing angles
            if top < 1.0 { Metal::Reflectance(DVec3::splat(top)) } else { Metal::Fresnel { eta, k } }
        }),
    ];
    let coated = (any_albedo(1.0), 1.1..2.0f64, rough());
    let phong = (vector(0.0, 0.5 * top), vector(0.05, 0.5 * top), 0.0..60.0f64);
    prop_oneof![
        3 => any_albedo(top).prop_map(|c| BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(c) })),
        1 => any_albedo(top).prop_map(|reflectance| BsdfDescription::Mirror(MirrorSurface { reflectance })),
        2 => (metal, rough()).prop_map(|(metal, rough)| BsdfDescription::Conductor(ConductorSurface { metal, rough })),
        2 => coated.prop_map(move |(c, ior, rough)| match top < 1.0 {
            true => BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(c * top) }),
            false => BsdfDescription::Plastic(PlasticSurface { reflectance: Colour::Uniform(c), ior, rough }),
        }),
        1 => phong.prop_map(|(c, specular, exponent)| {
            BsdfDescription::Phong(PhongSurface { reflectance: Colour::Uniform(c), specular, exponent })
        }),
    ]
}

/// Glass, smooth or rough.
pub fn glass() -> impl Strategy<Value = BsdfDescription> {
    let choice = prop_oneof![2 => Just(Choice::Fresnel), 1 => (0.2..0.8f64).prop_map(Choice::Constant)];
    (1.1..2.2f64, choice, rough()).prop_map(|(ior, choice, rough)| {
        BsdfDescription::Dielectric(DielectricSurface { ior, ior_outside: 1.0, choice, rough })
    })
}

fn sides() -> impl Strategy<Value = Sides> {
    prop_oneof![Just(Sides::Both), Just(Sides::Front)]
}

/// A light without a surface.
pub fn light() -> impl Strategy<Value = LightDescription> {
    let colour = || vector(0.3, 3.0);
    let texels = prop::collection::vec(prop_oneof![vector(0.0, 2.0), Just(DVec3::ZERO)], 8);
    let sky = prop_oneof![
        colour().prop_map(Sky::Constant),
        texels.prop_map(|t| Sky::LatLong(Arc::new(Raster::new([4, 2], t.iter().map(|c| c.as_vec3()).collect())))),
    ];
    prop_oneof![
        (vector(-0.9, 0.9), colour()).prop_map(|(position, intensity)| LightDescription::Point { position, intensity }),
        (vector(-1.0, 1.0), colour()).prop_map(|(direction, irradiance)| LightDescription::Directional {
            direction: direction + DVec3::new(0.0, -1.5, 0.0),
            irradiance
        }),
        (sky, 0.0..360.0f64).prop_map(|(sky, rotate)| LightDescription::Environment { sky, rotate, scale: 0.7 }),
    ]
}

/// Anything at all: up to five things of any material, the first of which glows, in a room or under the open sky, with up
/// to two lights without a surface.
pub fn world() -> impl Strategy<Value = Description> {
    let any = || prop_oneof![3 => opaque(1.0), 1 => glass()];
    let lights = prop::collection::vec(light(), 0..3);
    let walls = prop::option::of((any(), sides()));
    let materials = prop::collection::vec((any(), sides()), 6);
    (items(), materials, walls, lights).prop_map(|(items, materials, walls, mut lights)| {
        let mut d = furnished(DVec3::splat(0.5), &items);
        for (m, (bsdf, sides)) in d.materials[1..].iter_mut().zip(materials) {
            (m.bsdf, m.sides) = (bsdf, sides);
        }
        match walls {
            Some((bsdf, sides)) => (d.materials[0].bsdf, d.materials[0].sides) = (bsdf, sides),
            // open: a floor is left of the room
            None => d.shapes[0].geometry = quad(DVec3::new(-1.0, -0.9, 1.0), DVec3::X * 2.0, DVec3::NEG_Z * 2.0),
        }
        // one sky is enough
        let is_sky = |l: &LightDescription| matches!(l, LightDescription::Environment { .. });
        if lights.len() == 2 && lights.iter().all(is_sky) {
            lights.pop();
        }
        d.lights = lights;
        d
    })
}
