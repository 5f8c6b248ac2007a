//! How a dielectric chooses between reflection and refraction, smooth or rough.

/// How a dielectric chooses between reflection and refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Choice {
    /// With the Fresnel reflectance as probability of reflection.
    Fresnel,
    /// With this probability of reflection, in (0, 1); under total internal reflection always.
    Constant(f64),
}

/// How reflection or refraction is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Odds {
    /// By F.
    Fresnel,
    /// By a constant, unless nothing is refracted.
    Constant(f32),
}

impl Odds {
    /// From a description.
    pub fn new(choice: Choice) -> Self {
        match choice {
            Choice::Fresnel => Self::Fresnel,
            Choice::Constant(p) => Self::Constant(p as f32),
        }
    }

    /// p, where the reflectance is `f`.
    #[inline(always)]
    pub fn of_reflection(self, f: f32) -> f32 {
        match self {
            Self::Constant(p) if f < 1.0 => p,
            _ => f,
        }
    }
}
