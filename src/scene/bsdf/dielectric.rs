//! Smooth glass: part of the light is reflected, the rest refracted.
//!
//! ```text
//! f = F δ(ω_i − r(ω_o))/cos θ_i + (1 − F) e δ(ω_i − t(ω_o))/|cos θ_i|        e = 1/η² for radiance, 1 for flux
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | η | index beyond the surface divided by the index on the side of ω_o | [`Interface`] |
//! | F | Fresnel reflectance; 1 under total internal reflection | [`Interface::reflectance`] |
//! | t(ω_o) | refracted direction (−x/η, −y/η, −g/η), by Snell's law | [`Dielectric::sample`] |
//! | p | probability of choosing reflection: F, or a constant | [`Odds::of_reflection`] |
//!
//! r(ω_o) is the mirror direction. Refraction into the denser side narrows a beam: radiance grows by η². So radiance divided
//! by the squared index of refraction is constant along a ray. Flux does not change. References: Born and Wolf, *Principles
//! of Optics* (7th ed. 1999), section 1.5; Veach, *Non-symmetric Scattering in Light Transport Algorithms* (EGWR 1996).

use super::fresnel::Interface;
use super::ggx::{Ggx, Microfacets};
use super::mirror::reflection;
pub use super::odds::{Choice, Odds};
use super::rough_dielectric::RoughDielectric;
use super::{BsdfSample, Model, Sampling, Surface, TransportMode, Visitor};
use crate::math::Rgb;
use crate::scene::SceneError;
use crate::scene::load::{Cursor, MtlMaterial, keys, keys::IOR};
use glam::Vec3;

/// Index of refraction of glass if an MTL file has no `Ni`.
const GLASS: f64 = 1.5;

/// A smooth boundary between two dielectrics, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothDielectric {
    /// The indices on both sides.
    pub interface: Interface,
    /// Rule that chooses between reflection and refraction.
    pub odds: Odds,
}

impl Model for SmoothDielectric {
    /// Reflects if `u[2]` < p, refracts otherwise.
    #[inline(always)]
    fn sample(&self, wo: Vec3, _: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        Some(self.choose(wo, mode, u[2]))
    }
    fn max_albedo(&self) -> Rgb {
        Rgb::ONE
    }
    fn connects(&self) -> bool {
        false
    }
    fn has_delta(&self) -> bool {
        true
    }
}

impl SmoothDielectric {
    /// Reflects if `u` < p, refracts otherwise.
    #[inline(always)]
    pub fn choose(&self, wo: Vec3, mode: TransportMode, u: f32) -> BsdfSample {
        let f = self.interface.reflectance(wo.z);
        let p = self.odds.of_reflection(f);
        match self.interface.refracted(wo.z) {
            Some(g) if u >= p => {
                let wi = Vec3::new(-wo.x, -wo.y, -g) / self.interface.eta;
                let weight = (1.0 - f) / (1.0 - p) * mode.squeezed(self.interface.eta2());
                BsdfSample { wi: wi.normalize(), weight: Rgb::splat(weight), pdf: 1.0 - p, delta: true }
            }
            _ => BsdfSample { wi: reflection(wo), weight: Rgb::splat(f / p), pdf: p, delta: true },
        }
    }
}

/// A boundary between two dielectrics, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dielectric {
    /// Smooth: without microfacets.
    Smooth(SmoothDielectric),
    /// Rough: with microfacets.
    Rough(RoughDielectric),
}

impl Model for Dielectric {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        match self {
            Self::Smooth(f) => f.eval(wo, wi, mode),
            Self::Rough(f) => f.eval(wo, wi, mode),
        }
    }
    #[inline(always)]
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        match self {
            Self::Smooth(f) => f.sample(wo, sampling, mode, u),
            Self::Rough(f) => f.sample(wo, sampling, mode, u),
        }
    }
    #[inline(always)]
    fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        match self {
            Self::Smooth(f) => f.pdf(wo, wi, sampling),
            Self::Rough(f) => f.pdf(wo, wi, sampling),
        }
    }
    fn max_albedo(&self) -> Rgb {
        Rgb::ONE
    }
    fn connects(&self) -> bool {
        matches!(self, Self::Rough(_))
    }
    fn has_delta(&self) -> bool {
        matches!(self, Self::Smooth(_))
    }
    fn transmits(&self) -> bool {
        matches!(self, Self::Rough(_))
    }
    #[inline(always)]
    fn welcome<V: Visitor>(&self, visitor: V) -> V::Out {
        match self {
            Self::Smooth(f) => f.welcome(visitor),
            Self::Rough(f) => f.welcome(visitor),
        }
    }
}

/// Glass or another dielectric as described in a scene file. The inside is the side behind the normal.
#[derive(Clone, Debug, PartialEq)]
pub struct DielectricSurface {
    /// Index of refraction inside.
    pub ior: f64,
    /// Index of refraction outside.
    pub ior_outside: f64,
    /// Rule that chooses between reflection and refraction.
    pub choice: Choice,
    /// Microfacets; `None` for a smooth boundary.
    pub rough: Option<Ggx>,
}

impl Surface for DielectricSurface {
    type Side = Dielectric;
    const KIND: &'static str = "dielectric";
    const KEYS: &'static [&'static str] = &["ior", "ior_outside", "choice", "alpha", "masking"];
    const LETS_THROUGH: bool = true;

    fn read(c: &Cursor<'_>) -> Result<Self, SceneError> {
        let ior = c.require("ior", "the index of refraction inside: ior = 1.5")?.within("ior", IOR[0], IOR[1])?;
        let ior_outside = c.get("ior_outside").map_or(Ok(1.0), |i| i.within("ior_outside", IOR[0], IOR[1]))?;
        let choice = match c.get("choice") {
            None => Choice::Fresnel,
            Some(at) if at.is_text() => at.choice("choice of reflection", &[("fresnel", Choice::Fresnel)])?,
            Some(at) => {
                let p = at.number()?;
                if !(p > 0.0 && p < 1.0) {
                    let e = at.error(format!("choice {p} is outside (0, 1)"));
                    return Err(e.help(
                        "it is the probability of reflection, and both reflection and refraction must be possible",
                    ));
                }
                Choice::Constant(p)
            }
        };
        let rough = keys::rough(c)?;
        if let (Some(_), Some(at)) = (rough, c.get("alpha").filter(|_| (ior / ior_outside - 1.0).abs() < 1e-3)) {
            let e = at.error(format!("alpha is given, but the indices {ior_outside} and {ior} hardly differ"));
            return Err(
                e.help("equal indices do not scatter: leave alpha out, or let the indices differ by at least 0.1 %")
            );
        }
        Ok(Self { ior, ior_outside, choice, rough })
    }

    /// An MTL material is glass if `d` < 1, or if `illum` is 4, 6, 7 or 9 and `Ni` > 1.
    fn from_mtl(m: &mut MtlMaterial<'_>) -> Result<Option<Self>, SceneError> {
        if !m.is_glass() {
            return Ok(None);
        }
        let ior = match m.entry.ior {
            Some(n) if (IOR[0]..=IOR[1]).contains(&n) => n,
            Some(n) => {
                m.warn(format!("has Ni {n} outside [{}, {}]; {GLASS} is used instead", IOR[0], IOR[1]));
                GLASS
            }
            None => {
                m.warn(format!("has no Ni; {GLASS} is used"));
                GLASS
            }
        };
        if ior == 1.0 {
            m.warn("has Ni 1 and d below 1, so it is invisible".into());
        }
        let lost = m.tints();
        if !lost.is_empty() {
            m.warn(format!("is rendered as clear glass, without its {}", lost.join(", ")));
        }
        Ok(Some(Self { ior, ior_outside: 1.0, choice: Choice::Fresnel, rough: None }))
    }

    fn side(&self, back: bool) -> Dielectric {
        let Self { ior, ior_outside, choice, rough } = *self;
        let (here, beyond) = if back { (ior, ior_outside) } else { (ior_outside, ior) };
        let (interface, odds) = (Interface::new(here, beyond), Odds::new(choice));
        match rough {
            // between equal indices a rough boundary is invisible, as a smooth one is
            Some(ggx) if interface.eta != 1.0 => {
                Dielectric::Rough(RoughDielectric { interface, odds, facets: Microfacets::new(ggx) })
            }
            _ => Dielectric::Smooth(SmoothDielectric { interface, odds }),
        }
    }

    fn words(&self) -> String {
        let choice = match self.choice {
            Choice::Fresnel => "reflection chosen by Fresnel".to_owned(),
            Choice::Constant(p) => format!("reflected with probability {p}"),
        };
        format!("index {} in {}, {choice}, {}", self.ior, self.ior_outside, Ggx::words(self.rough))
    }

    fn examples() -> Vec<Self> {
        let of = |choice| Ggx::examples().map(|rough| Self { ior: 1.5, ior_outside: 1.0, choice, rough });
        [Choice::Fresnel, Choice::Constant(0.3)].into_iter().flat_map(of).collect()
    }
}
