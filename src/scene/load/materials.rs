//! `[materials.NAME]`: which kind of surface it is, and on which sides. The keys of a kind are its own ([`Surface`](crate::scene::bsdf::Surface)).

use super::cursor::Cursor;
use crate::scene::{
    SceneError,
    bsdf::register::{KINDS, Kind},
    description::{Material, Sides},
};

/// Keys of every kind; `sides` is legal on all, if only to be refused on glass with a reason.
pub(super) const KEYS: [&str; 2] = ["type", "sides"];

/// Reads one material.
pub(super) fn read(name: &str, c: &Cursor) -> Result<Material, SceneError> {
    let names: Vec<&str> = KINDS.iter().map(|k| k.name).collect();
    let at = c.require("type", &format!("type = \"diffuse\"; types: {}", names.join(", ")))?;
    let kinds: Vec<(&str, &Kind)> = KINDS.iter().map(|k| (k.name, k)).collect();
    let kind = at.choice("type of material", &kinds)?;
    // in the order in which a file has them
    let [first, last] = KEYS;
    let keys: Vec<&str> = [first].into_iter().chain(kind.keys.iter().copied()).chain([last]).collect();
    c.only(&keys)?;
    let sides = match c.get("sides") {
        Some(s) if kind.lets_through => {
            let what = format!("a {} has no sides", kind.name);
            return Err(s.error(what).help("light passes from both sides: remove the key"));
        }
        Some(s) => s.choice("choice of sides", &[("both", Sides::Both), ("front", Sides::Front)])?,
        None => Sides::Both,
    };
    Ok(Material { name: name.to_owned(), bsdf: (kind.read)(c)?, sides })
}
