//! The description of a surface in a scene file: its keys, the function that reads it, and the BSDF that it becomes.
//!
//! Each kind of surface declares all its properties itself, in the file that holds its formulas. The
//! [register](super::register) lists the kinds.
//!
//! | property | used by | place |
//! |---|---|---|
//! | keys in a scene file, and the function that reads them | the loader | [`Surface::KEYS`], [`Surface::read`] |
//! | MTL materials that become this kind | the loader of OBJ | [`Surface::from_mtl`] |
//! | BSDF of one side | the scene | [`Surface::side`] |
//! | colour that an image may give | textures | [`Surface::colour`] |
//! | transparency: light passes through | sides, stand-in, coplanar surfaces | [`Surface::LETS_THROUGH`] |
//! | text for the user | `info` | [`Surface::words`] |
//! | examples | tests of properties of every BSDF | [`Surface::examples`] |

use super::Model;
use super::colour::Colour;
use crate::scene::SceneError;
use crate::scene::load::{Cursor, MtlMaterial};

/// A kind of surface, as described in a scene file.
pub trait Surface: Clone + PartialEq + std::fmt::Debug {
    /// The BSDF of one side.
    type Side: Model;
    /// The name of the kind in a scene file.
    const KIND: &'static str;
    /// The keys in a scene file, in addition to `type` and `sides`.
    const KEYS: &'static [&'static str];
    /// True if light passes through: both sides then scatter, and the transmitted light goes to places that a Lambertian
    /// surface would not reach.
    const LETS_THROUGH: bool = false;

    /// Reads a surface from a table of a scene file.
    ///
    /// # Errors
    /// If a key is missing or a value is not allowed. The error names the value and its place and says what to do.
    fn read(c: &Cursor<'_>) -> Result<Self, SceneError>;

    /// Reads a surface from an MTL material; `None` if the material is not of this kind.
    ///
    /// # Errors
    /// If an image cannot be read.
    fn from_mtl(_: &mut MtlMaterial<'_>) -> Result<Option<Self>, SceneError> {
        Ok(None)
    }

    /// The BSDF of one side; `back` is the side from which the normal points away. A textured colour is white until
    /// [`Model::with_reflectance`] sets it. Tables are computed here: once per material, not per hit.
    fn side(&self, back: bool) -> Self::Side;

    /// The colour that an image may give; `None` if the kind cannot have a texture.
    fn colour(&self) -> Option<&Colour> {
        None
    }

    /// The parameters as text for the user.
    fn words(&self) -> String;

    /// A few examples with clearly different parameters, for tests.
    fn examples() -> Vec<Self>;
}
