//! The modified Phong model: a Lambertian base and a lobe about the mirror direction. It is normalised and reciprocal.
//!
//! ```text
//! f = k_d/π + k_s (n + 2)/2π (cos α)ⁿ        p(ω_i) = (1 − p_s) cos θ_i/π + p_s (n + 1)/2π (cos α)ⁿ
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | k_d, k_s | albedo of the base, and of the lobe at normal incidence; k_d + k_s ≤ 1 | [`Phong::new`] |
//! | n | exponent | [`Phong::new`] |
//! | α | angle between ω_i and the mirror direction of ω_o; the lobe is zero for α > π/2 | `lobe` |
//! | p_s | probability of sampling the lobe: k_s/(k_d + k_s), each taken from its largest channel | [`Phong::sample`] |
//!
//! At oblique incidence a part of the lobe lies below the surface. Samples from that part are lost, and the albedo is below
//! k_d + k_s. cos α is computed from |ω_i − r|² = 2(1 − cos α), with r the mirror direction, because this keeps its digits
//! for large n.
//!
//! Reference: Lafortune and Willems, *Using the Modified Phong Reflectance Model for Physically Based Rendering* (Report
//! CW 197, K.U. Leuven, 1994).

use super::colour::{Colour, rgb};
use super::mirror::reflection;
use super::model::{blind_pdf, sample_blindly};
use super::{BsdfSample, Model, Sampling, Surface, TransportMode};
use crate::math::Rgb;
use crate::math::direction::{about, cos_sin_turn, cosine_hemisphere};
use crate::scene::SceneError;
use crate::scene::load::{Cursor, MtlMaterial, keys};
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// One side of a surface with the modified Phong model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    diffuse: Rgb,
    specular: Rgb,
    exponent: f32,
    p_specular: f32,
}

impl Phong {
    /// The model with `diffuse` = k_d, `specular` = k_s and `exponent` = n.
    pub fn new(diffuse: Rgb, specular: Rgb, exponent: f32) -> Self {
        let (d, s) = (diffuse.max_element(), specular.max_element());
        Self { diffuse, specular, exponent, p_specular: if s > 0.0 { s / (d + s) } else { 0.0 } }
    }

    /// (cos α)ⁿ/2π, the lobe without its normalisation.
    #[inline(always)]
    fn lobe(&self, wo: Vec3, wi: Vec3) -> f32 {
        let versine = 0.5 * (wi - reflection(wo)).length_squared();
        if versine < 1.0 { (self.exponent * (-versine).ln_1p()).exp() / TAU } else { 0.0 }
    }
}

impl Model for Phong {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        self.diffuse * FRAC_1_PI + self.specular * ((self.exponent + 2.0) * self.lobe(wo, wi))
    }

    #[inline(always)]
    fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        if sampling != Sampling::Bsdf {
            return blind_pdf(wi, sampling);
        }
        if wi.z <= 0.0 {
            return 0.0;
        }
        let lobe = (self.exponent + 1.0) * self.lobe(wo, wi);
        (1.0 - self.p_specular) * Sampling::Cosine.pdf(wi.z) + self.p_specular * lobe
    }

    /// Samples the lobe if `u[2]` < p_s, otherwise the cosine about the normal. `None` if the direction points below the
    /// surface.
    #[inline(always)]
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        if sampling != Sampling::Bsdf {
            return sample_blindly(self, wo, sampling, mode, u);
        }
        let wi = if u[2] < self.p_specular {
            let log = (-u[0]).ln_1p() / (self.exponent + 1.0);
            let (cos, sin) = (log.exp(), (-(2.0 * log).exp_m1()).sqrt());
            let (x, y) = cos_sin_turn(u[1]);
            about(reflection(wo), sin * x, sin * y, cos).normalize()
        } else {
            cosine_hemisphere(Vec3::Z, [u[0], u[1]]).0
        };
        BsdfSample::of(wi, self.eval(wo, wi, mode), self.pdf(wo, wi, sampling))
    }

    /// k_d + k_s: exact at normal incidence, an upper bound elsewhere.
    #[inline(always)]
    fn max_albedo(&self) -> Rgb {
        self.diffuse + self.specular
    }

    /// The same model with another k_d.
    fn with_reflectance(self, diffuse: Rgb) -> Self {
        Self::new(diffuse, self.specular, self.exponent)
    }
}

/// A surface with the modified Phong model, as described in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct PhongSurface {
    /// Albedo of the diffuse part.
    pub reflectance: Colour,
    /// Albedo of the lobe at normal incidence; the sum with `reflectance` is at most 1 in every channel.
    pub specular: DVec3,
    /// Exponent of the lobe, at least 0.
    pub exponent: f64,
}

impl Surface for PhongSurface {
    type Side = Phong;
    const KIND: &'static str = "phong";
    const KEYS: &'static [&'static str] = &["reflectance", "texture", "specular", "exponent"];

    fn read(c: &Cursor<'_>) -> Result<Self, SceneError> {
        let reflectance = keys::colour(c)?;
        let at = c.require("specular", "the albedo of the lobe: specular = [0.3, 0.3, 0.3]")?;
        let specular = at.albedo("specular")?;
        let example = "the exponent, larger for a narrower lobe: exponent = 50";
        let exponent = c.require("exponent", example)?.within("exponent", 0.0, keys::LARGEST_EXPONENT)?;
        let most = keys::largest(&reflectance);
        if let Some(i) = (0..3).find(|&i| most[i] + specular[i] > 1.0 + keys::ROUNDING) {
            let e = at.error(format!("the sum of reflectance {} and specular {} exceeds 1", most[i], specular[i]));
            return Err(e.help("a surface cannot reflect more light than it receives: lower one of them"));
        }
        Ok(Self { reflectance, specular, exponent })
    }

    /// An MTL material is Phong if `Ks` > 0 and `Ns` is given: reflectance `Kd`, specular `Ks`, exponent `Ns`.
    fn from_mtl(m: &mut MtlMaterial<'_>) -> Result<Option<Self>, SceneError> {
        if m.is_glass() || m.is_mirror() || m.specular() == DVec3::ZERO || m.lost_lobe().is_some() {
            return Ok(None);
        }
        let (kd, ks) = (m.colour()?, m.specular());
        let Some(exponent) = m.entry.exponent else { return Ok(None) };
        if m.mirrors() {
            let illum = m.illum();
            m.warn(format!(
                "has illum {illum} (mirror) and Kd; it is rendered with a Phong lobe of exponent {exponent}"
            ));
        }
        let excess = m.excess("Kd + Ks reach", keys::largest(&kd) + ks);
        Ok(Some(Self { reflectance: keys::times(kd, 1.0 / excess), specular: ks / excess, exponent }))
    }

    fn side(&self, _: bool) -> Phong {
        let specular = self.specular.as_vec3();
        Phong::new(self.reflectance.uniform(), specular, self.exponent as f32)
    }
    fn colour(&self) -> Option<&Colour> {
        Some(&self.reflectance)
    }
    fn words(&self) -> String {
        let Self { reflectance, specular, exponent } = self;
        format!("reflectance {}, specular {}, exponent {exponent}", reflectance.words(), rgb(*specular))
    }
    fn examples() -> Vec<Self> {
        let of = |exponent| {
            let (reflectance, specular) = (Colour::Uniform(DVec3::new(0.1, 0.2, 0.4)), DVec3::splat(0.5));
            Self { reflectance, specular, exponent }
        };
        [0.0, 10.0, 300.0].map(of).into()
    }
}
