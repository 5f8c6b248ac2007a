//! What light never reaches, and T leaves out.

use crate::operator::patches::Patches;

/// A side of a primitive that light never reaches in some channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unlit {
    /// Number of the primitive.
    pub primitive: usize,
    /// The side of its normal.
    pub front: bool,
    /// By channel: light reaches no patch of it, and something emits in that channel.
    pub channels: [bool; 3],
}

/// The sides of which no patch is reached, in channels in which something emits.
pub(super) fn unlit(patches: &Patches, lit: &[[bool; 3]]) -> Vec<Unlit> {
    let any: [bool; 3] = [0, 1, 2].map(|c| patches.iter().any(|p| p.emission[c] > 0.0));
    let mut sides = std::collections::BTreeMap::new();
    for (p, lit) in patches.iter().zip(lit) {
        let dark = sides.entry((p.primitive, !p.front)).or_insert(any);
        (0..3).for_each(|c| dark[c] &= !lit[c]);
    }
    let dark = sides.into_iter().filter(|(_, dark)| *dark != [false; 3]);
    dark.map(|((primitive, back), channels)| Unlit { primitive, front: !back, channels }).collect()
}
