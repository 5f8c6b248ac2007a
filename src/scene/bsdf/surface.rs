//! A surface as a scene file says it: its keys, how it is read, what it becomes.
//!
//! Everything that the program has to know of a kind of surface it says of itself, in the file that holds its formulas; the
//! [register](super::register) lists the kinds.
//!
//! | question | asked by | place |
//! |---|---|---|
//! | which keys, how are they read? | the loader | [`Surface::KEYS`], [`Surface::read`] |
//! | which MTL materials are it? | the loader of OBJ | [`Surface::from_mtl`] |
//! | how does a side scatter? | the scene | [`Surface::side`] |
//! | may an image give its colour? | textures | [`Surface::colour`] |
//! | does light pass? | sides, stand-in, coplanar surfaces | [`Surface::LETS_THROUGH`] |
//! | in words | `info` | [`Surface::words`] |
//! | what is it like? | tests of what holds for every BSDF | [`Surface::examples`] |

use super::Model;
use super::colour::Colour;
use crate::scene::SceneError;
use crate::scene::load::{Cursor, MtlMaterial};

/// A kind of surface.
pub trait Surface: Clone + PartialEq + std::fmt::Debug {
    /// One side of it.
    type Side: Model;
    /// Its name in a scene file.
    const KIND: &'static str;
    /// Its keys there, beside `type` and `sides`.
    const KEYS: &'static [&'static str];
    /// Whether light passes: both sides scatter, and what lies behind is not where a Lambertian surface would send light.
    const LETS_THROUGH: bool = false;

    /// From a table of a scene file.
    ///
    /// # Errors
    /// Names the value, its place and what to do.
    fn read(c: &Cursor<'_>) -> Result<Self, SceneError>;

    /// From an MTL material, if it is one of this kind.
    ///
    /// # Errors
    /// If an image cannot be read.
    fn from_mtl(_: &mut MtlMaterial<'_>) -> Result<Option<Self>, SceneError> {
        Ok(None)
    }

    /// How one side scatters; `back` is the side the normal points away from. A textured colour is white until
    /// [`Model::with_reflectance`] says more. Tables are made here: once per material, not per hit.
    fn side(&self, back: bool) -> Self::Side;

    /// The colour that an image may give.
    fn colour(&self) -> Option<&Colour> {
        None
    }

    /// Its parameters in words.
    fn words(&self) -> String;

    /// A few that differ in what matters, for tests.
    fn examples() -> Vec<Self>;
}
