//! Sides that light never reaches, and that T leaves out.

use crate::operator::patches::Patches;

/// A side of a primitive that light never reaches in some channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unlit {
    /// Number of the primitive.
    pub primitive: usize,
    /// True for the side to which the normal points.
    pub front: bool,
    /// For each channel: true if light reaches no patch of the side, although something emits in that channel.
    pub channels: [bool; 3],
}

/// The sides without any patch that light reaches, in channels in which something emits.
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
