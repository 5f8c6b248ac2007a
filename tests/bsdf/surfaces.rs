//! The surfaces that are tested, and Fresnel's equations a second time, in complex `f64`.

use fredholm::scene::bsdf::{Bsdf, Sampling};
use fredholm::scene::description::{BsdfDescription, Choice, Colour, Ggx, Masking, Metal};
use fredholm::scene::description::{
    ConductorSurface, DielectricSurface, DiffuseSurface, MirrorSurface, PhongSurface, PlasticSurface,
};
use glam::{DVec3, Vec3};

/// A side of a surface.
#[derive(Clone, Debug)]
pub struct Surface {
    pub description: BsdfDescription,
    pub back: bool,
    /// α of its microfacets, or what comes near it.
    pub width: f64,
    /// n of what ω_i is in below the surface, over that above.
    pub eta: f64,
}

impl Surface {
    pub fn bsdf(&self) -> Bsdf {
        Bsdf::new(&self.description, self.back)
    }

    /// The samplings worth trying from the i-th outgoing direction: uniform directions do not find a narrow lobe.
    pub fn samplings(&self, i: usize) -> &[Sampling] {
        match i {
            _ if self.width < 0.3 => &[Sampling::Bsdf],
            0 | 3 => &[Sampling::Bsdf, Sampling::Uniform],
            _ => &[Sampling::Bsdf, Sampling::Cosine],
        }
    }

    /// Heights at which densities jump: the horizon, and what a refraction by a vertical facet leads to.
    pub fn cuts(&self, wo: Vec3) -> [f64; 2] {
        [0.0, -f64::from(wo.z) / self.eta]
    }
}

pub const RHO: DVec3 = DVec3::new(0.9, 0.5, 0.2);

pub fn gold() -> Metal {
    Metal::Fresnel { eta: DVec3::new(0.17, 0.4, 1.4), k: DVec3::new(3.1, 2.4, 1.6) }
}

fn ggx(alpha: f64, masking: Masking) -> Option<Ggx> {
    Some(Ggx { alpha, masking })
}

fn colour(c: DVec3) -> Colour {
    Colour::Uniform(c)
}

pub fn glass(choice: Choice, rough: Option<Ggx>, back: bool) -> Surface {
    let width = rough.map_or(0.0, |g| g.alpha);
    let description = BsdfDescription::Dielectric(DielectricSurface { ior: 1.5, ior_outside: 1.0, choice, rough });
    Surface { description, back, width, eta: if back { 1.0 / 1.5 } else { 1.5 } }
}

fn front(description: BsdfDescription, width: f64) -> Surface {
    Surface { description, back: false, width, eta: 1.0 }
}

pub fn plastic(reflectance: DVec3, rough: Option<Ggx>) -> Surface {
    let width = rough.map_or(1.0, |g| g.alpha);
    front(BsdfDescription::Plastic(PlasticSurface { reflectance: colour(reflectance), ior: 1.5, rough }), width)
}

pub fn metal(metal: Metal, rough: Option<Ggx>) -> Surface {
    front(BsdfDescription::Conductor(ConductorSurface { metal, rough }), rough.map_or(0.0, |g| g.alpha))
}

/// Every kind of surface, every roughness, both sides where they differ.
pub fn all() -> Vec<Surface> {
    use Masking::{HeightCorrelated, Separable};
    let mut list = vec![
        front(BsdfDescription::Diffuse(DiffuseSurface { reflectance: colour(RHO) }), 1.0),
        front(BsdfDescription::Mirror(MirrorSurface { reflectance: RHO }), 0.0),
        metal(gold(), None),
        metal(Metal::Reflectance(RHO), None),
        plastic(RHO, None),
        plastic(DVec3::ONE, None),
    ];
    for (alpha, masking) in [(0.05, Separable), (0.2, HeightCorrelated), (0.5, Separable), (1.0, HeightCorrelated)] {
        let rough = ggx(alpha, masking);
        list.push(metal(gold(), rough));
        list.push(metal(Metal::Reflectance(DVec3::ONE), rough));
        list.push(plastic(RHO, rough));
        list.push(plastic(DVec3::ONE, rough));
        for back in [false, true] {
            list.push(glass(Choice::Fresnel, rough, back));
            list.push(glass(Choice::Constant(0.4), rough, back));
        }
    }
    for back in [false, true] {
        list.push(glass(Choice::Fresnel, None, back));
        list.push(glass(Choice::Constant(0.4), None, back));
    }
    for exponent in [0.0, 1.0, 7.5, 100.0, 5000.0f64] {
        let (reflectance, specular) = (colour(0.5 * RHO), DVec3::new(0.5, 0.4, 0.3));
        let width = (2.0 / (exponent + 2.0)).sqrt();
        list.push(front(BsdfDescription::Phong(PhongSurface { reflectance, specular, exponent }), width));
    }
    list
}

/// Outgoing directions, from the normal to grazing.
pub fn outgoing() -> [Vec3; 4] {
    [(1.0, 0.0), (0.8, 0.4), (0.3, 2.5), (0.05, -1.0)].map(|(z, phi)| tilted(z, phi))
}

pub fn tilted(z: f64, phi: f64) -> Vec3 {
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * phi.cos(), r * phi.sin(), z).as_vec3()
}

/// √(x + iy) with a positive real part.
fn root(x: f64, y: f64) -> (f64, f64) {
    let r = x.hypot(y);
    let a = (0.5 * (r + x)).max(0.0).sqrt();
    let b = (0.5 * (r - x)).max(0.0).sqrt();
    (a, if y < 0.0 { -b } else { b })
}

/// R of a complex relative index by the amplitudes r_s = (c − w)/(c + w), r_p = (N²c − w)/(N²c + w), w² = N² − s².
pub fn fresnel(c: f64, eta: f64, k: f64) -> f64 {
    let (x, y) = (eta * eta - k * k, 2.0 * eta * k);
    let (a, b) = root(x - (1.0 - c * c), y);
    let s = ((c - a).powi(2) + b * b) / ((c + a).powi(2) + b * b);
    let p = ((x * c - a).powi(2) + (y * c - b).powi(2)) / ((x * c + a).powi(2) + (y * c + b).powi(2));
    0.5 * (s + p)
}
