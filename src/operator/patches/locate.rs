//! Finds the patch of a surface point, for one point or for many together.
//!
//! ```text
//! (primitive, side, x)  ↦  cell of the primitive  ↦  patch of the cell's side
//! ```
//!
//! In a mesh of a million patches, every read waits for main memory. [`Lookup`] advances all its points by one step of the
//! search before it takes the next step, so that the waits overlap. Its answers are those of [`Patches::locate`].

use super::finder::Descent;
use super::{NONE, Patches};
use glam::DVec3;

impl Patches {
    /// The patch of a point of the surface, even if rounding has put the point slightly outside; `None` if the point is
    /// covered.
    pub fn locate(&self, primitive: usize, front: bool, point: DVec3) -> Option<usize> {
        let index = self.indices.get(primitive)?;
        let patch = &index.patch[usize::from(!front)];
        if patch.is_empty() {
            return None;
        }
        patch.get(index.search.locate(point)).filter(|i| **i != NONE).map(|i| *i as usize)
    }

    /// The patch on the given side of a cell, or [`NONE`]. Both sides of a primitive share one tree of cells.
    fn on(&self, primitive: u32, front: bool, cell: usize) -> u32 {
        self.indices[primitive as usize].patch[usize::from(!front)].get(cell).copied().unwrap_or(NONE)
    }
}

/// A batch of points whose patches are searched together.
#[derive(Debug, Default)]
pub(crate) struct Lookup {
    asked: Vec<Asked>,
    /// The indices of the points in `asked` whose search is not finished.
    open: Vec<u32>,
}

#[derive(Debug)]
struct Asked {
    walk: Descent,
    primitive: u32,
    front: bool,
}

impl Lookup {
    /// Removes all points.
    pub(crate) fn clear(&mut self) {
        self.asked.clear();
    }

    /// Adds a point of a primitive of `patches`.
    #[inline(always)]
    pub(crate) fn ask(&mut self, patches: &Patches, primitive: u32, front: bool, point: DVec3) {
        let walk = patches.indices[primitive as usize].search.begin(point);
        self.asked.push(Asked { walk, primitive, front });
    }

    /// The patches of all points, in the order in which the points were added; `None` for a covered point.
    pub(crate) fn answers<'a>(&'a mut self, patches: &'a Patches) -> impl Iterator<Item = Option<u32>> + 'a {
        let Self { asked, open } = self;
        open.clear();
        open.extend(0..asked.len() as u32);
        loop {
            let mut left = 0;
            for k in 0..open.len() {
                let i = open[k];
                open[left] = i;
                left += usize::from(!asked[i as usize].walk.is_over());
            }
            open.truncate(left);
            if left == 0 {
                break;
            }
            for i in open.iter() {
                let Asked { walk, primitive, .. } = &mut asked[*i as usize];
                patches.indices[*primitive as usize].search.step(walk);
            }
        }
        asked.iter().map(|a| Some(patches.on(a.primitive, a.front, a.walk.cell())).filter(|j| *j != NONE))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::scene::load;

    #[test]
    fn together_they_find_what_each_finds_alone() {
        let scene = load::scene("cornell", &load::Options::default()).unwrap().description;
        let patches = Patches::new(&scene, 3000).unwrap();
        let (mut lookup, mut found) = (Lookup::default(), 0);
        for part in patches.chunks(100) {
            // test centres, and corners, where rounding decides; the corners of the floor under the blocks have no patch
            let points = || part.iter().flat_map(|p| p.polygon.iter().copied().chain([p.centre]).map(move |x| (p, x)));
            lookup.clear();
            points().for_each(|(p, x)| lookup.ask(&patches, p.primitive as u32, p.front, x));
            let together: Vec<_> = lookup.answers(&patches).map(|j| j.map(|j| j as usize)).collect();
            let alone: Vec<_> = points().map(|(p, x)| patches.locate(p.primitive, p.front, x)).collect();
            assert_eq!(together, alone);
            found += together.iter().flatten().count();
        }
        assert!(found > 4 * patches.len(), "{found}");
    }
}
