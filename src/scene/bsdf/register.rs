//! The register: the list of all kinds of surface. A new kind is a file with its formulas and a line here.
//!
//! Each line gives the name of the kind, its type in a scene file ([`Surface`]) and the type of one of its sides
//! ([`Model`]).

use super::surface::Surface;
use super::{
    BsdfSample, Departure, Model, Sampling, Towards, TransportMode, Visitor, conductor, dielectric, diffuse, mirror,
    phong, plastic,
};
use crate::math::Rgb;
use crate::scene::SceneError;
use crate::scene::description::Colour;
use crate::scene::load::{Cursor, MtlMaterial};
use glam::Vec3;

macro_rules! register {
    ($($(#[$about:meta])* $kind:ident: $surface:ty => $side:ty;)+) => {
        /// Scattering of a surface, as described in a scene file.
        #[derive(Clone, PartialEq)]
        pub enum BsdfDescription {
            $($(#[$about])* $kind($surface),)+
        }

        $(impl From<$surface> for BsdfDescription {
            fn from(surface: $surface) -> Self {
                Self::$kind(surface)
            }
        })+

        /// `Phong { … }`: the name in the register, and the parameters. The hash of a scene is computed from this text.
        impl std::fmt::Debug for BsdfDescription {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let (name, surface) = match self { $(Self::$kind(s) => (stringify!($kind), format!("{s:?}")),)+ };
                write!(f, "{name} {}", surface.split_once(' ').map_or("", |(_, parameters)| parameters))
            }
        }

        impl BsdfDescription {
            /// The name of the kind in a scene file.
            pub fn kind(&self) -> &'static str {
                match self { $(Self::$kind(_) => <$surface>::KIND,)+ }
            }
            /// Returns true if light passes through the surface.
            pub fn lets_through(&self) -> bool {
                match self { $(Self::$kind(_) => <$surface>::LETS_THROUGH,)+ }
            }
            /// The colour that an image may give; `None` for kinds that cannot have a texture.
            pub fn colour(&self) -> Option<&Colour> {
                match self { $(Self::$kind(s) => s.colour(),)+ }
            }
            /// The kind and its parameters as text for the user.
            pub fn words(&self) -> String {
                let words = match self { $(Self::$kind(s) => s.words(),)+ };
                format!("{}, {words}", self.kind())
            }
            /// A few examples of every kind, for tests.
            pub fn examples() -> Vec<Self> {
                let mut all = vec![];
                $(all.extend(<$surface>::examples().into_iter().map(Self::$kind));)+
                all
            }
        }

        /// All kinds, with their keys and the functions that read them.
        pub(in crate::scene) const KINDS: &[Kind] = &[
            $(Kind {
                name: <$surface>::KIND,
                keys: <$surface>::KEYS,
                lets_through: <$surface>::LETS_THROUGH,
                read: |c| Ok(<$surface>::read(c)?.into()),
                from_mtl: |m| Ok(<$surface>::from_mtl(m)?.map(Into::into)),
            },)+
        ];

        /// The BSDF of one side of a surface at a point.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Bsdf {
            /// No light is scattered.
            Black,
            $($(#[$about])* $kind($side),)+
        }

        $(impl From<$side> for Bsdf {
            fn from(side: $side) -> Self {
                Self::$kind(side)
            }
        })+

        impl Bsdf {
            /// The BSDF of one side; `back` is the side from which the normal points away. A textured reflectance is white
            /// until [`Self::with_reflectance`] sets it. Tables are computed here: once per material, not per hit.
            pub fn new(description: &BsdfDescription, back: bool) -> Self {
                match description { $(BsdfDescription::$kind(s) => Self::$kind(s.side(back)),)+ }
            }

            /// The same BSDF with another reflectance of its diffuse part, which a texture gives.
            #[must_use]
            pub fn with_reflectance(self, reflectance: Rgb) -> Self {
                match self { Self::Black => self, $(Self::$kind(f) => Self::$kind(f.with_reflectance(reflectance)),)+ }
            }

            /// f(ω_o, ω_i) without its delta part, sr⁻¹.
            pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
                match self { Self::Black => Rgb::ZERO, $(Self::$kind(f) => f.eval(wo, wi, mode),)+ }
            }

            /// A sampled direction; `None` if light is absorbed or no direction is possible. `u[0]` and `u[1]` choose the
            /// direction, `u[2]` chooses between parts of f. The weight may be zero if `sampling` does not follow f.
            pub fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
                match self { Self::Black => None, $(Self::$kind(f) => f.sample(wo, sampling, mode, u),)+ }
            }

            /// Density of ω_i under [`Self::sample`] without delta parts, sr⁻¹.
            pub fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
                match self { Self::Black => 0.0, $(Self::$kind(f) => f.pdf(wo, wi, sampling),)+ }
            }

            /// [`Self::sample`] in world coordinates, for a vertex with the normal `n` seen from `omega`.
            #[inline(always)]
            pub fn depart(
                &self, n: Vec3, omega: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3],
            ) -> Option<Departure> {
                match self { Self::Black => None, $(Self::$kind(f) => f.depart(n, omega, sampling, mode, u),)+ }
            }

            /// f cos θ_i and [`Self::pdf`] in world coordinates; `None` if f cos θ_i is zero.
            #[inline(always)]
            pub fn towards(
                &self, n: Vec3, omega: Vec3, to: Vec3, sampling: Sampling, mode: TransportMode,
            ) -> Option<Towards> {
                match self { Self::Black => None, $(Self::$kind(f) => f.towards(n, omega, to, sampling, mode),)+ }
            }

            /// The same for radiance from a direction that was drawn with density `pdf`: the value is divided by it.
            #[inline(always)]
            pub fn connect(&self, n: Vec3, omega: Vec3, to: Vec3, pdf: f32, sampling: Sampling) -> Option<Towards> {
                match self { Self::Black => None, $(Self::$kind(f) => f.connect(n, omega, to, pdf, sampling),)+ }
            }

            /// Calls the visitor with the formulas of this BSDF; `None` for black.
            pub fn welcome<V: Visitor>(&self, visitor: V) -> Option<V::Out> {
                match self { Self::Black => None, $(Self::$kind(f) => Some(f.welcome(visitor)),)+ }
            }

            /// The fraction of the light that is scattered, per channel: ∫ f(ω_o → ω_i) cos θ_i dω_i including the delta
            /// part. It is exact for smooth and Lambertian surfaces. For microfacets and Phong's lobe it is an upper bound,
            /// which their modules state.
            pub fn albedo(&self, wo: Vec3) -> Rgb {
                match self { Self::Black => Rgb::ZERO, $(Self::$kind(f) => f.albedo(wo),)+ }
            }

            /// The largest albedo over all directions: the local bound on ‖K‖₁.
            pub fn max_albedo(&self) -> Rgb {
                match self { Self::Black => Rgb::ZERO, $(Self::$kind(f) => f.max_albedo(),)+ }
            }

            /// Returns true if f has a part other than a delta, so that connections to lamps can be made.
            pub fn connects(&self) -> bool {
                match self { Self::Black => false, $(Self::$kind(f) => f.connects(),)+ }
            }

            /// Returns true if f has a delta part.
            pub fn has_delta(&self) -> bool {
                match self { Self::Black => false, $(Self::$kind(f) => f.has_delta(),)+ }
            }

            /// Returns true if f transmits light to the other side by a part that is not a delta.
            pub(crate) fn transmits(&self) -> bool {
                match self { Self::Black => false, $(Self::$kind(f) => f.transmits(),)+ }
            }
        }
    };
}

register! {
    /// A Lambertian surface.
    Diffuse: diffuse::DiffuseSurface => diffuse::Diffuse;
    /// A perfect mirror, the same at every angle.
    Mirror: mirror::MirrorSurface => mirror::Mirror;
    /// A metal, smooth or rough.
    Conductor: conductor::ConductorSurface => conductor::Conductor;
    /// Glass or another dielectric, smooth or rough.
    Dielectric: dielectric::DielectricSurface => dielectric::Dielectric;
    /// A diffuse base under a dielectric coat, smooth or rough.
    Plastic: plastic::PlasticSurface => plastic::Plastic;
    /// The modified Phong model.
    Phong: phong::PhongSurface => phong::Phong;
}

/// A kind of surface as the loader uses it.
pub(in crate::scene) struct Kind {
    pub(in crate::scene) name: &'static str,
    /// Keys in a scene file, in addition to `type` and `sides`.
    pub(in crate::scene) keys: &'static [&'static str],
    pub(in crate::scene) lets_through: bool,
    pub(in crate::scene) read: fn(&Cursor<'_>) -> Result<BsdfDescription, SceneError>,
    /// Tries to read an MTL material as this kind. The loader tries the kinds from the last to the first; Lambertian is the
    /// first and accepts every material.
    pub(in crate::scene) from_mtl: fn(&mut MtlMaterial<'_>) -> Result<Option<BsdfDescription>, SceneError>,
}
