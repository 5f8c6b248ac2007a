//! Names of options: `Display`, `FromStr` and `ALL` for types that do not define them themselves.

use crate::estimator::Technique;
use crate::math::names::named;
use crate::scene::{Selection, bsdf::Sampling};
use std::fmt;
use std::str::FromStr;

impl FromStr for Technique {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

impl Selection {
    /// All selections.
    pub const ALL: [Self; 2] = [Self::Uniform, Self::Power];
}

impl FromStr for Selection {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

impl Sampling {
    /// All samplings.
    pub const ALL: [Self; 3] = [Self::Uniform, Self::Cosine, Self::Bsdf];
}

impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Uniform => "uniform",
            Self::Cosine => "cosine",
            Self::Bsdf => "bsdf",
        })
    }
}

impl FromStr for Sampling {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}
