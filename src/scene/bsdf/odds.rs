//! The choice of a dielectric, smooth or rough, between reflection and refraction.

/// Rule by which a dielectric chooses between reflection and refraction, as described in a scene file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Choice {
    /// The probability of reflection is the Fresnel reflectance.
    Fresnel,
    /// The probability of reflection is this constant in (0, 1). Under total internal reflection it is 1.
    Constant(f64),
}

/// The same rule as [`Choice`], prepared for evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Odds {
    /// The probability of reflection is F.
    Fresnel,
    /// The probability of reflection is a constant, or 1 under total internal reflection.
    Constant(f32),
}

impl Odds {
    /// Prepares the rule of a description.
    pub fn new(choice: Choice) -> Self {
        match choice {
            Choice::Fresnel => Self::Fresnel,
            Choice::Constant(p) => Self::Constant(p as f32),
        }
    }

    /// p: the probability of reflection at Fresnel reflectance `f`.
    #[inline(always)]
    pub fn of_reflection(self, f: f32) -> f32 {
        match self {
            Self::Constant(p) if f < 1.0 => p,
            _ => f,
        }
    }
}
