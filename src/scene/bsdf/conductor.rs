//! Metals, smooth or rough.
//!
//! ```text
//! smooth   f = F(ω_o·n) δ(ω_i − r(ω_o))/cos θ_i
//! rough    f = F(ω_o·h) D(h) G(ω_o, ω_i)/(4 cos θ_o cos θ_i)        p(ω_i) = D_ωo(h)/(4 ω_o·h)
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | F | Fresnel reflectance of index η + ik, or one colour at every angle | [`Conductor::fresnel`] |
//! | h | micronormal, half-way between ω_o and ω_i | [`half()`] |
//! | D, G, D_ωo | microfacet distribution, masking and shadowing, density of the normals visible from ω_o | [`super::ggx`] |
//! | 4 ω_o·h | dω_i/dh of a reflection | [`Conductor::pdf`] |
//!
//! r(ω_o) is the mirror direction and n the normal. Light that one microfacet reflects onto another is lost, so a rough
//! metal with F = 1 has an albedo below 1. The weight f cos θ_i/p = F G/G₁(ω_o) is at most F.
//!
//! References: Torrance and Sparrow, *Theory for Off-Specular Reflection From Roughened Surfaces* (JOSA 57(9), 1967);
//! Cook and Torrance, *A Reflectance Model for Computer Graphics* (TOG 1(1), 1982); microfacets as in [`super::ggx`].

use super::colour::rgb;
use super::ggx::{Ggx, Microfacets, half, reflect};
use super::mirror::reflection;
use super::model::{blind_pdf, sample_blindly};
use super::{BsdfSample, Model, Sampling, Surface, TransportMode, fresnel};
use crate::math::Rgb;
use crate::scene::SceneError;
use crate::scene::load::{Cursor, keys};
use glam::{DVec3, Vec3};

/// One side of a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    metal: Reflects,
    /// Microfacets; `None` for a smooth metal.
    pub rough: Option<Microfacets>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Reflects {
    Index { eta: Rgb, k: Rgb },
    Colour(Rgb),
}

impl Conductor {
    /// Builds the BSDF from the description of a scene file.
    pub fn new(metal: Metal, rough: Option<Ggx>) -> Self {
        let metal = match metal {
            Metal::Fresnel { eta, k } => Reflects::Index { eta: eta.as_vec3(), k: k.as_vec3() },
            Metal::Reflectance(reflectance) => Reflects::Colour(reflectance.as_vec3()),
        };
        Self { metal, rough: rough.map(Microfacets::new) }
    }

    /// F: Fresnel reflectance at cosine c.
    #[inline(always)]
    pub fn fresnel(&self, c: f32) -> Rgb {
        match self.metal {
            Reflects::Index { eta, k } => fresnel::conductor(c, eta, k),
            Reflects::Colour(reflectance) => reflectance,
        }
    }
}

impl Model for Conductor {
    /// f(ω_o, ω_i); zero for a smooth metal.
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> Rgb {
        match self.rough {
            Some(facets) if wi.z > 0.0 => {
                let (h, c) = half(wo, wi);
                self.fresnel(c) * (facets.d(h) * facets.seen(wo.z, wi.z))
            }
            _ => Rgb::ZERO,
        }
    }

    #[inline(always)]
    fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        match self.rough {
            None => 0.0,
            Some(_) if sampling != Sampling::Bsdf => blind_pdf(wi, sampling),
            Some(facets) if wi.z > 0.0 => 0.25 * facets.visible(wo.z, half(wo, wi).0),
            _ => 0.0,
        }
    }

    /// The mirror direction of a smooth metal, or the reflection at a micronormal visible from ω_o. `None` if it points
    /// below the surface.
    #[inline(always)]
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        let Some(facets) = self.rough else {
            return Some(BsdfSample { wi: reflection(wo), weight: self.fresnel(wo.z), pdf: 1.0, delta: true });
        };
        if sampling != Sampling::Bsdf {
            return sample_blindly(self, wo, sampling, mode, u);
        }
        let wi = reflect(wo, facets.sample(wo, [u[0], u[1]]));
        if wi.z <= 0.0 {
            return None;
        }
        // computed from the pair of directions, as in eval and pdf
        let weight = self.fresnel(half(wo, wi).1) * facets.lit(wo.z, wi.z);
        Some(BsdfSample { wi, weight, pdf: self.pdf(wo, wi, sampling), delta: false })
    }

    /// Exact for a smooth metal. For a rough one an upper bound: the largest F, because G/G₁ ≤ 1.
    #[inline(always)]
    fn albedo(&self, wo: Vec3) -> Rgb {
        match self.rough {
            None => self.fresnel(wo.z),
            Some(_) => self.max_albedo(),
        }
    }

    /// The largest F: 1 for a complex index, where everything is reflected at grazing angles.
    #[inline(always)]
    fn max_albedo(&self) -> Rgb {
        match self.metal {
            Reflects::Index { .. } => Rgb::ONE,
            Reflects::Colour(reflectance) => reflectance,
        }
    }

    fn connects(&self) -> bool {
        self.rough.is_some()
    }
    fn has_delta(&self) -> bool {
        self.rough.is_none()
    }
}

/// The reflectance of a metal, as a scene file gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metal {
    /// Complex index of refraction η + ik per channel: exact Fresnel reflectance.
    Fresnel {
        /// η, the real part.
        eta: DVec3,
        /// k, the imaginary part.
        k: DVec3,
    },
    /// This colour as F at every angle.
    Reflectance(DVec3),
}

/// A metal as described in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct ConductorSurface {
    /// Its reflectance.
    pub metal: Metal,
    /// Microfacets; `None` for a smooth metal.
    pub rough: Option<Ggx>,
}

impl Surface for ConductorSurface {
    type Side = Conductor;
    const KIND: &'static str = "conductor";
    const KEYS: &'static [&'static str] = &["eta", "k", "reflectance", "alpha", "masking"];

    fn read(c: &Cursor<'_>) -> Result<Self, SceneError> {
        let metal = match (c.get("eta").or(c.get("k")), c.get("reflectance")) {
            (Some(_), Some(r)) => {
                let e = r.error("eta and k are given together with reflectance");
                return Err(
                    e.help("eta and k give the Fresnel reflectance; reflectance alone is the same at every angle")
                );
            }
            (None, Some(r)) => Metal::Reflectance(r.reflectance()?),
            _ => {
                let eta = c.require("eta", "eta = [r, g, b] and k = [r, g, b], or reflectance = [r, g, b] alone")?;
                let k = c.require("k", "k = [r, g, b], the imaginary part of the index")?;
                Metal::Fresnel { eta: eta.index("eta", 1e-3)?, k: k.index("k", 0.0)? }
            }
        };
        Ok(Self { metal, rough: keys::rough(c)? })
    }
    fn side(&self, _: bool) -> Conductor {
        Conductor::new(self.metal, self.rough)
    }
    fn words(&self) -> String {
        let rough = Ggx::words(self.rough);
        match self.metal {
            Metal::Fresnel { eta, k } => format!("η {}, k {}, {rough}", rgb(eta), rgb(k)),
            Metal::Reflectance(f) => format!("reflectance {}, {rough}", rgb(f)),
        }
    }
    fn examples() -> Vec<Self> {
        let gold = Metal::Fresnel { eta: DVec3::new(0.14, 0.37, 1.44), k: DVec3::new(3.98, 2.38, 1.6) };
        let metals = [gold, Metal::Reflectance(DVec3::new(0.9, 0.6, 0.3))];
        metals.into_iter().flat_map(|metal| Ggx::examples().map(|rough| Self { metal, rough })).collect()
    }
}
