//! Reading of `[materials.NAME]`: the kind of surface and its sides. Each kind of surface reads its own keys
//! ([`Surface`](crate::scene::bsdf::Surface)).

use super::{cursor::Cursor, names};
use crate::scene::{
    SceneError,
    bsdf::register::{KINDS, Kind},
    description::{Material, Sides},
};

/// Keys of every kind. `sides` is accepted here for all kinds, so that glass can refuse it with a specific message.
pub(super) const KEYS: [&str; 2] = ["type", "sides"];

/// Reads one material.
pub(super) fn read(name: &str, c: &Cursor) -> Result<Material, SceneError> {
    names::check(name, "material").map_err(|f| c.error(f.what).help(f.help))?;
    let names: Vec<&str> = KINDS.iter().map(|k| k.name).collect();
    let at = c.require("type", &format!("type = \"diffuse\"; types: {}", names.join(", ")))?;
    let kinds: Vec<(&str, &Kind)> = KINDS.iter().map(|k| (k.name, k)).collect();
    let kind = at.choice("type of material", &kinds)?;
    // in the order in which a file lists them
    let [first, last] = KEYS;
    let keys: Vec<&str> = [first].into_iter().chain(kind.keys.iter().copied()).chain([last]).collect();
    c.only(&keys)?;
    let sides = match c.get("sides") {
        Some(s) if kind.lets_through => {
            let what = format!("a {} always has both sides", kind.name);
            return Err(s.error(what).help("light enters from both sides: remove the key `sides`"));
        }
        Some(s) => s.choice("choice of sides", &[("both", Sides::Both), ("front", Sides::Front)])?,
        None => Sides::Both,
    };
    Ok(Material { name: name.to_owned(), bsdf: (kind.read)(c)?, sides })
}
