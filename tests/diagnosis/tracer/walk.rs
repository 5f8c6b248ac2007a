//! One path: it starts at the camera and is reflected from surface to surface.
//!
//! At the k-th surface it adds the light that comes straight from the lamp and is reflected towards the path,
//!
//! ```text
//! T_k += β_k · f · L · cos θ · cos θ_lamp · A / r²    if nothing stands between
//! β_1 = 1,   β_{k+1} = β_k · f · cos θ / p(direction)
//! ```
//!
//! with the reflectance f = albedo / π, the emission L and the area A of the lamp, and p = cos θ / π. So β grows by the
//! factor "albedo" with every reflection. A lamp that the path runs into counts only when the camera sees it (T_0);
//! anywhere else the light has been counted by the connection already.
//!
//! Every way to get this wrong that `bugs.rs` lists is a branch on [`Kind`] at the line where the mistake is made.

use super::bugs::Kind;
use super::scene::{Part, Quad, Ray, Scene, Vec3, add, cross, dot, mul, scale, sub, unit};
use std::f64::consts::PI;

/// Paths end here whatever happens. The right program loses less than 1e-6 of the light by this. It is needed for the
/// mistakes with which light grows from bounce to bounce.
const LONGEST: usize = 64;

/// Random numbers: xoshiro256++ by Blackman and Vigna, started with SplitMix64.
pub struct Rng([u64; 4]);

impl Rng {
    /// The numbers of one pixel. Different pixels and different seeds give unrelated numbers.
    pub fn new(seed: u64, pixel: u64) -> Rng {
        let mut state = mix(seed) ^ pixel;
        Rng(std::array::from_fn(|_| {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            mix(state)
        }))
    }

    /// A number from 0 to 1, without 1.
    pub fn next(&mut self) -> f64 {
        let s = &mut self.0;
        let result = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        (result >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// What one path found: the first terms one by one, and the sum of all terms.
#[derive(Clone)]
pub struct Light {
    pub terms: Vec<Vec3>,
    pub whole: Vec3,
}

impl Light {
    pub fn none(terms: usize) -> Light {
        Light { terms: vec![[0.0; 3]; terms], whole: [0.0; 3] }
    }

    /// Adds light that was reflected `order` times.
    fn add(&mut self, kind: Kind, order: usize, light: Vec3) {
        let light = match kind {
            Kind::TermFactor { term, factor } if term == order => scale(light, factor),
            _ => light,
        };
        self.whole = add(self.whole, light);
        if let Some(term) = self.terms.get_mut(order) {
            *term = add(*term, light);
        }
    }
}

/// Follows one path. `start` is β_1: 1 in every channel.
pub fn trace(scene: &Scene, kind: Kind, mut ray: Ray, start: f64, max_bounces: usize, rng: &mut Rng) -> Light {
    let mut found = Light::none(max_bounces + 2);
    let mut beta = [start; 3];
    for bounce in 1..=LONGEST {
        let Some((quad, t)) = scene.first_hit(&ray) else { break };
        // The back of a surface is black.
        if dot(ray.dir, quad.normal) >= 0.0 {
            break;
        }
        let counted = if bounce == 1 { kind != Kind::EmissionForgotten } else { kind == Kind::LampTwice };
        if quad.part == Part::Lamp && counted {
            found.add(kind, bounce - 1, mul(beta, quad.emission));
        }
        if matches!(kind, Kind::EndsAfter { bounces } if bounce > bounces) {
            break;
        }
        let point = add(ray.origin, scale(ray.dir, t));
        found.add(kind, bounce, mul(beta, connection(scene, kind, quad, point, rng)));

        let (dir, weight) = next_direction(kind, quad, rng);
        beta = mul(beta, weight);
        let (survive, factor) = roulette(kind, quad, bounce, max_bounces);
        if survive < 1.0 && rng.next() >= survive {
            break;
        }
        beta = scale(beta, factor);
        ray = Ray { origin: point, dir };
    }
    found
}

/// The reflectance f of the material, the same for all directions.
fn reflectance(kind: Kind, albedo: Vec3) -> Vec3 {
    match kind {
        Kind::NoPi => albedo,
        Kind::AlbedoTwice => scale(mul(albedo, albedo), 1.0 / PI),
        _ => scale(albedo, 1.0 / PI),
    }
}

/// The light from a random point of the lamp, after its reflection at `point`: f L cos θ cos θ_lamp A / r².
fn connection(scene: &Scene, kind: Kind, quad: &Quad, point: Vec3, rng: &mut Rng) -> Vec3 {
    let lamp = scene.lamp();
    let (u, v) = (rng.next(), rng.next());
    let u = if kind == Kind::HalfLamp { 0.5 * u } else { u };
    let way = sub(lamp.point(u, v), point);
    let r2 = dot(way, way);
    let r = r2.sqrt();
    let dir = scale(way, 1.0 / r);
    let mut cos = dot(dir, quad.normal);
    let mut cos_lamp = -dot(dir, lamp.normal);
    if kind == Kind::LampBothSides {
        cos_lamp = cos_lamp.abs();
    }
    if cos <= 0.0 || cos_lamp <= 0.0 {
        return [0.0; 3];
    }
    let ignored = (kind == Kind::TallBlockCastsNoShadow).then_some(Part::TallBlock);
    if kind != Kind::NoShadows && scene.blocked(&Ray { origin: point, dir }, r, ignored) {
        return [0.0; 3];
    }
    match kind {
        Kind::NoCosine => cos = 1.0,
        Kind::NoLampCosine => cos_lamp = 1.0,
        _ => {}
    }
    let falloff = if kind == Kind::DistanceNotSquared { r } else { r2 };
    let factor = match kind {
        Kind::ConnectionFactor(factor) => factor,
        Kind::NoPiInConnection => PI,
        _ => 1.0,
    };
    let f = reflectance(kind, quad.albedo);
    scale(mul(f, lamp.emission), factor * cos * cos_lamp * lamp.area / falloff)
}

/// A random direction on the front side, and the factor f cos θ / p by which β grows.
fn next_direction(kind: Kind, quad: &Quad, rng: &mut Rng) -> (Vec3, Vec3) {
    let (a, b) = (rng.next(), rng.next());
    // A uniform cos θ gives directions that are uniform on the hemisphere, √(1 − a) gives the density cos θ / π. Never
    // 0, so that the direction leaves the surface and p is not 0.
    let cos = if kind == Kind::UniformDirections { 1.0 - a } else { (1.0 - a).sqrt() };
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (2.0 * PI * b).sin_cos();
    let n = quad.normal;
    let other = if n[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let x = unit(cross(other, n));
    let y = cross(n, x);
    let dir = add(scale(n, cos), add(scale(x, sin * cos_phi), scale(y, sin * sin_phi)));

    let density = if kind == Kind::UniformDensity { 1.0 / (2.0 * PI) } else { cos / PI };
    (dir, scale(reflectance(kind, quad.albedo), cos / density))
}

/// Russian roulette after a reflection: the probability to go on, and the factor for β if the path does.
///
/// The right program plays after the last term that has a picture of its own. It goes on with the largest albedo a and
/// divides by it, so that the mean a · (1/a) stays 1.
fn roulette(kind: Kind, quad: &Quad, bounce: usize, max_bounces: usize) -> (f64, f64) {
    match kind {
        Kind::Roulette { from, survive, factor } if bounce >= from => (survive, factor),
        Kind::Roulette { .. } => (1.0, 1.0),
        _ if bounce >= max_bounces => {
            let survive = quad.albedo.into_iter().fold(0.0, f64::max);
            (survive, 1.0 / survive)
        }
        _ => (1.0, 1.0),
    }
}
