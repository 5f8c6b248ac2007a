//! GGX microfacets: the surface consists of tiny mirrors, whose normals are distributed like those of an ellipsoid.
//!
//! ```text
//! D(h) = 1/(π α² (h_x²/α² + h_y²/α² + h_z²)²)            ∫ D(h) cos θ_h dh = 1
//! 1 + Λ(ω) = (c + s)/2c        s² = c² + α² (1 − c²)      G₁ = 1/(1 + Λ)
//! D_ω(h) = G₁(ω) (ω·h)⁺ D(h)/c                            ∫ D_ω(h) dh = 1
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | h | normal of a microfacet (micronormal), on the side of the macroscopic normal | arguments |
//! | α | roughness: width of the distribution of slopes | [`Microfacets::alpha`] |
//! | c | absolute cosine between a direction and the macroscopic normal | arguments |
//! | s(c) | square root in Λ; at least α if α ≤ 1 | [`Microfacets::s`] |
//! | G₁(ω), G(ω_o, ω_i) | fraction of the microfacets visible from ω, and from both directions | [`Microfacets::seen`], [`Microfacets::lit`] |
//! | D_ω | density of the normals visible from ω | [`Microfacets::visible`], [`Microfacets::sample`] |
//!
//! Written with s, the quotients of G and the cosines have no 0/0 at grazing angles:
//!
//! | | height-correlated, 1/(1 + Λ_o + Λ_i) | separable, G₁(ω_o) G₁(ω_i) |
//! |---|---|---|
//! | G/(4 c_o c_i) | 1/2(s_o c_i + s_i c_o) | 1/((c_o + s_o)(c_i + s_i)) |
//! | G/G₁(ω_o) | (c_o + s_o) c_i/(s_o c_i + s_i c_o) | 2 c_i/(c_i + s_i) |
//!
//! References: Walter, Marschner, Li and Torrance, *Microfacet Models for Refraction through Rough Surfaces* (EGSR 2007);
//! Heitz, *Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs* (JCGT 3(2), 2014) and *Sampling the
//! GGX Distribution of Visible Normals* (JCGT 7(4), 2018); Dupuy and Benyoub, *Sampling Visible GGX Normals with
//! Spherical Caps* (Computer Graphics Forum 42(8), 2023).

use crate::math::direction::cos_sin_turn;
use glam::Vec3;
use std::f32::consts::PI;

/// GGX microfacets as described in a scene file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// Roughness α as it enters the distribution; it is not squared first.
    pub alpha: f64,
    /// Model of masking and shadowing.
    pub masking: Masking,
}

/// Model of masking and shadowing: the joint visibility of a microfacet from ω_o and ω_i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// G = 1/(1 + Λ(ω_o) + Λ(ω_i)).
    HeightCorrelated,
    /// G = G₁(ω_o) G₁(ω_i).
    Separable,
}

impl Ggx {
    /// The microfacets as text for the user; "smooth" for `None`.
    pub(super) fn words(rough: Option<Self>) -> String {
        match rough {
            None => "smooth".to_owned(),
            Some(Self { alpha, masking: Masking::HeightCorrelated }) => format!("GGX α {alpha}"),
            Some(Self { alpha, masking: Masking::Separable }) => format!("GGX α {alpha}, separable masking"),
        }
    }

    /// A smooth surface and two rough ones, for tests.
    pub(super) fn examples() -> [Option<Self>; 3] {
        let of = |alpha, masking| Some(Self { alpha, masking });
        [None, of(0.1, Masking::HeightCorrelated), of(0.5, Masking::Separable)]
    }
}

/// Isotropic GGX microfacets, prepared for evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    /// Roughness α.
    pub alpha: f32,
    /// Model of masking and shadowing.
    pub masking: Masking,
}

impl Microfacets {
    /// Prepares the microfacets of a description.
    pub fn new(ggx: Ggx) -> Self {
        Self { alpha: ggx.alpha as f32, masking: ggx.masking }
    }

    /// D(h): density of the normals, sr⁻¹.
    #[inline(always)]
    pub fn d(&self, h: Vec3) -> f32 {
        let (x, y) = (h.x / self.alpha, h.y / self.alpha);
        let w = self.alpha * (x * x + y * y + h.z * h.z);
        1.0 / (PI * w * w)
    }

    /// s(c) = √(c² + α² (1 − c²)).
    #[inline(always)]
    pub fn s(&self, c: f32) -> f32 {
        (c * c + self.alpha * self.alpha * (1.0 - c * c)).sqrt()
    }

    /// G/(4 c_o c_i), the factor of D and F in a reflection.
    #[inline(always)]
    pub fn seen(&self, co: f32, ci: f32) -> f32 {
        let (so, si) = (self.s(co), self.s(ci));
        match self.masking {
            Masking::HeightCorrelated => 0.5 / (so * ci + si * co),
            Masking::Separable => 1.0 / ((co + so) * (ci + si)),
        }
    }

    /// G/G₁(ω_o): the fraction of the microfacets visible from ω_o that are visible from ω_i too.
    #[inline(always)]
    pub fn lit(&self, co: f32, ci: f32) -> f32 {
        let (so, si) = (self.s(co), self.s(ci));
        match self.masking {
            Masking::HeightCorrelated => (co + so) * ci / (so * ci + si * co),
            Masking::Separable => 2.0 * ci / (ci + si),
        }
    }

    /// D_ω(h)/(ω·h) for a direction ω with cosine c, sr⁻¹.
    #[inline(always)]
    pub fn visible(&self, c: f32, h: Vec3) -> f32 {
        2.0 * self.d(h) / (c + self.s(c))
    }

    /// A random normal with density D_ω for ω = `omega`. If the ellipsoid is scaled to a sphere, the mirror directions of
    /// the normals visible from ω fill a cap of the sphere uniformly.
    #[inline(always)]
    pub fn sample(&self, omega: Vec3, u: [f32; 2]) -> Vec3 {
        let w = Vec3::new(self.alpha * omega.x, self.alpha * omega.y, omega.z).normalize();
        let (cos, sin) = cos_sin_turn(u[1]);
        // z of the sum of ω and a direction of the cap, and the sine of that direction, without loss of digits
        let z = (1.0 - u[0]) * (1.0 + w.z);
        let below = (w.x * w.x + w.y * w.y) / (1.0 + w.z);
        let r = (u[0] * (1.0 + w.z) * (below + z)).sqrt();
        Vec3::new(self.alpha * (w.x + r * cos), self.alpha * (w.y + r * sin), z).normalize()
    }
}

/// The normal that reflects ω_o to ω_i, and its cosine with both directions.
#[inline(always)]
pub fn half(wo: Vec3, wi: Vec3) -> (Vec3, f32) {
    let sum = wo + wi;
    let length = sum.length();
    (sum / length, 0.5 * length)
}

/// ω_o reflected by a mirror with normal h, normalised.
#[inline(always)]
pub fn reflect(wo: Vec3, h: Vec3) -> Vec3 {
    ((2.0 * wo.dot(h)) * h - wo).normalize()
}
