//! Two rays at a time go through the tree in turns: while one waits for memory, the other goes on.
//!
//! ```text
//! ray 0, step 1 → ray 1, step 1 → ray 0, step 2 → ray 1, step 2 → …        a ray that is done makes room for the next one
//! ```
//!
//! What a step needs next is known only at its end, and a large tree is not in the fast caches. The steps of two rays do not depend
//! on each other, so a processor begins the second while the first still waits. Each ray gets the same bits as alone (tested).
//!
//! Three or four rays in turns were slower for camera rays, and no faster for others (`DESIGN.md`, performance).

use super::super::shape::Shape;
use super::lanes::Lanes;
use super::tree::{Search, Wide};

impl Wide {
    /// The answers for the rays of a list: `begin` returns the search for one, `done` gets its number and answer.
    #[inline(always)]
    pub(crate) fn search_all<S: Search>(
        &self,
        l: impl Lanes,
        shapes: &[Shape],
        list: &[u32],
        begin: impl Fn(usize) -> S,
        mut done: impl FnMut(usize, S::Answer),
    ) {
        let mut memory = vec![0; 2 * self.waiting];
        let (first, second) = memory.split_at_mut(self.waiting);
        let mut rays = list.iter().map(|&ray| ray as usize);
        let Some(a) = rays.next() else { return };
        let Some(b) = rays.next() else { return done(a, self.search(l, shapes, begin(a), first)) };
        let mut turns = [(a, begin(a), first), (b, begin(b), second)];
        let alone = 'turns: loop {
            for (turn, (i, search, stack)) in turns.iter_mut().enumerate() {
                if search.step(l, self, shapes, stack) {
                    done(*i, search.answer());
                    let Some(next) = rays.next() else { break 'turns 1 - turn };
                    (*i, *search) = (next, begin(next));
                }
            }
        };
        let (i, search, stack) = &mut turns[alone];
        while !search.step(l, self, shapes, stack) {}
        done(*i, search.answer());
    }
}
