//! The kinds of surface there are. A new one is a file with its formulas and a line here.
//!
//! A line says: name, what a scene file says of it ([`Surface`]), what a side of it is ([`Model`]).

use super::surface::Surface;
use super::{BsdfSample, Model, Sampling, TransportMode, conductor, dielectric, diffuse, mirror, phong, plastic};
use crate::math::Rgb;
use crate::scene::SceneError;
use crate::scene::description::Colour;
use crate::scene::load::{Cursor, MtlMaterial};
use glam::Vec3;

macro_rules! register {
    ($($(#[$about:meta])* $kind:ident: $surface:ty => $side:ty;)+) => {
        /// How a surface scatters, as a scene file says it.
        #[derive(Clone, PartialEq)]
        pub enum BsdfDescription {
            $($(#[$about])* $kind($surface),)+
        }

        $(impl From<$surface> for BsdfDescription {
            fn from(surface: $surface) -> Self {
                Self::$kind(surface)
            }
        })+

        /// `Phong { … }`: the name here, and the parameters. Scenes are hashed by this text.
        impl std::fmt::Debug for BsdfDescription {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let (name, surface) = match self { $(Self::$kind(s) => (stringify!($kind), format!("{s:?}")),)+ };
                write!(f, "{name} {}", surface.split_once(' ').map_or("", |(_, parameters)| parameters))
            }
        }

        impl BsdfDescription {
            /// Its name in a scene file.
            pub fn kind(&self) -> &'static str {
                match self { $(Self::$kind(_) => <$surface>::KIND,)+ }
            }
            /// Whether light passes.
            pub fn lets_through(&self) -> bool {
                match self { $(Self::$kind(_) => <$surface>::LETS_THROUGH,)+ }
            }
            /// The colour that an image may give.
            pub fn colour(&self) -> Option<&Colour> {
                match self { $(Self::$kind(s) => s.colour(),)+ }
            }
            /// Its kind and its parameters in words.
            pub fn words(&self) -> String {
                let words = match self { $(Self::$kind(s) => s.words(),)+ };
                format!("{}, {words}", self.kind())
            }
            /// A few of every kind.
            pub fn examples() -> Vec<Self> {
                let mut all = vec![];
                $(all.extend(<$surface>::examples().into_iter().map(Self::$kind));)+
                all
            }
        }

        /// The kinds with their keys, and how they are read.
        pub(in crate::scene) const KINDS: &[Kind] = &[
            $(Kind {
                name: <$surface>::KIND,
                keys: <$surface>::KEYS,
                lets_through: <$surface>::LETS_THROUGH,
                read: |c| Ok(<$surface>::read(c)?.into()),
                from_mtl: |m| Ok(<$surface>::from_mtl(m)?.map(Into::into)),
            },)+
        ];

        /// How one side of a surface scatters at a point.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Bsdf {
            /// Nothing leaves.
            Black,
            $($(#[$about])* $kind($side),)+
        }

        impl Bsdf {
            /// The side of a surface: `back` is the side the normal points away from. A textured reflectance is white until
            /// [`Self::with_reflectance`] says more. Tables are made here: once per material, not per hit.
            pub fn new(description: &BsdfDescription, back: bool) -> Self {
                match description { $(BsdfDescription::$kind(s) => Self::$kind(s.side(back)),)+ }
            }

            /// The same with another reflectance where a texture gives it: that of the diffuse part.
            #[must_use]
            pub fn with_reflectance(self, reflectance: Rgb) -> Self {
                match self { Self::Black => self, $(Self::$kind(f) => Self::$kind(f.with_reflectance(reflectance)),)+ }
            }

            /// f(ω_o, ω_i), sr⁻¹, without its delta part.
            pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
                match self { Self::Black => Rgb::ZERO, $(Self::$kind(f) => f.eval(wo, wi, mode),)+ }
            }

            /// A direction; none where there is none to go to. `u[0]`, `u[1]` choose it, `u[2]` chooses between parts. The weight
            /// may be zero where `sampling` does not follow f.
            pub fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
                match self { Self::Black => None, $(Self::$kind(f) => f.sample(wo, sampling, mode, u),)+ }
            }

            /// Density with which [`Self::sample`] draws ω_i, delta parts excepted.
            pub fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
                match self { Self::Black => 0.0, $(Self::$kind(f) => f.pdf(wo, wi, sampling),)+ }
            }

            /// The share of the energy that is scattered, per channel: ∫ f(ω_o → ω_i) cos θ_i dω_i with its delta part. Exact of
            /// what is smooth or Lambertian; an upper bound of microfacets and Phong's lobe, which their files give.
            pub fn albedo(&self, wo: Vec3) -> Rgb {
                match self { Self::Black => Rgb::ZERO, $(Self::$kind(f) => f.albedo(wo),)+ }
            }

            /// The largest albedo of any direction: the local bound on ‖K‖₁.
            pub fn max_albedo(&self) -> Rgb {
                match self { Self::Black => Rgb::ZERO, $(Self::$kind(f) => f.max_albedo(),)+ }
            }

            /// Whether f has a part that connections can find.
            pub fn connects(&self) -> bool {
                match self { Self::Black => false, $(Self::$kind(f) => f.connects(),)+ }
            }

            /// Whether f has a delta part.
            pub fn has_delta(&self) -> bool {
                match self { Self::Black => false, $(Self::$kind(f) => f.has_delta(),)+ }
            }

            /// Whether f reaches the other side without a delta.
            pub(crate) fn transmits(&self) -> bool {
                match self { Self::Black => false, $(Self::$kind(f) => f.transmits(),)+ }
            }
        }
    };
}

register! {
    /// Lambertian.
    Diffuse: diffuse::DiffuseSurface => diffuse::Diffuse;
    /// A perfect mirror, the same at every angle.
    Mirror: mirror::MirrorSurface => mirror::Mirror;
    /// A metal, smooth or rough.
    Conductor: conductor::ConductorSurface => conductor::Conductor;
    /// Glass and its like, smooth or rough.
    Dielectric: dielectric::DielectricSurface => dielectric::Dielectric;
    /// A diffuse base under a dielectric coat, smooth or rough.
    Plastic: plastic::PlasticSurface => plastic::Plastic;
    /// The modified Phong model.
    Phong: phong::PhongSurface => phong::Phong;
}

/// A kind as the loader sees it.
pub(in crate::scene) struct Kind {
    pub(in crate::scene) name: &'static str,
    /// Beside `type` and `sides`.
    pub(in crate::scene) keys: &'static [&'static str],
    pub(in crate::scene) lets_through: bool,
    pub(in crate::scene) read: fn(&Cursor<'_>) -> Result<BsdfDescription, SceneError>,
    /// The kinds are asked from the last to the first; a Lambertian surface is what is left.
    pub(in crate::scene) from_mtl: fn(&mut MtlMaterial<'_>) -> Result<Option<BsdfDescription>, SceneError>,
}
