//! One ray against a few shapes: sixteen parallelograms at once, other shapes one by one. They are all shapes of a very small scene, or
//! the large ones of another, which are [in front of its tree](super::front).
//!
//! The formula is that of [`Flat::look`], and hits close to an edge are decided by [`Flat::edges`], so the bits are those of
//! the tree. A path that is followed alone in `cornell` takes 0.9 of the time through the tree.

use super::flat::Flat;
use super::shape::{Hit, Shape};
use super::sixteen::{LANES, Lane};
use glam::Vec3;

/// The most parallelograms, and the most other shapes, of a scene for which this is faster than the tree.
const MOST_FLATS: usize = 2 * LANES;
pub(super) const MOST_OTHERS: usize = 4;

/// Sixteen parallelograms.
#[derive(Clone, Debug)]
struct Block {
    numbers: [Lane; Flat::NUMBERS],
    prim: [u32; LANES],
}

/// A few shapes of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Few {
    blocks: Vec<Block>,
    others: Vec<u32>,
}

/// What a ray meets in a block: the distance as bits, which ascend with it, or `u32::MAX`; and whether it passes so close to
/// an edge that this is not certain.
struct Look {
    t: [u32; LANES],
    close: u32,
}

impl Few {
    /// All shapes, if they are few and no triangles.
    pub(crate) fn new(shapes: &[Shape]) -> Option<Self> {
        if shapes.len() > MOST_FLATS + MOST_OTHERS || shapes.iter().any(|s| matches!(s, Shape::Triangle(_))) {
            return None;
        }
        let flats = shapes.iter().filter(|s| matches!(s, Shape::Flat(_))).count();
        let few = flats <= MOST_FLATS && shapes.len() - flats <= MOST_OTHERS;
        few.then(|| Self::of(shapes, 0..shapes.len() as u32))
    }

    /// Some of the shapes; triangles among them are left out.
    pub(crate) fn of(shapes: &[Shape], prims: impl Iterator<Item = u32>) -> Self {
        let mut few = Self::default();
        let mut flats = vec![];
        for prim in prims {
            match &shapes[prim as usize] {
                Shape::Flat(s) => flats.push((prim, s)),
                Shape::Ball(_) | Shape::Disc(_) => few.others.push(prim),
                Shape::Triangle(_) => {}
            }
        }
        for flats in flats.chunks(LANES) {
            // free places are never met: no coordinate is below −1
            let mut block = Block { numbers: [[-1.0; LANES]; Flat::NUMBERS], prim: [u32::MAX; LANES] };
            for (i, (prim, s)) in flats.iter().enumerate() {
                block.prim[i] = *prim;
                block.numbers.iter_mut().zip(s.numbers()).for_each(|(lane, x)| lane[i] = x);
            }
            few.blocks.push(block);
        }
        few
    }

    /// The nearest hit with t > 0; of two at the same distance the one with the lower number.
    #[inline(always)]
    pub(crate) fn closest(&self, shapes: &[Shape], o: Vec3, d: Vec3) -> Hit {
        let mut best = Hit::NONE;
        for block in &self.blocks {
            let look = block.look(o, d);
            let mut least = u32::MAX;
            for t in look.t {
                least = least.min(t);
            }
            if least != u32::MAX {
                let mut first = 0;
                for (i, &t) in look.t.iter().enumerate() {
                    first |= u32::from(t == least) << i;
                }
                let prim = block.prim[first.trailing_zeros() as usize % LANES];
                best.take(Hit { t: f32::from_bits(least), prim });
            }
            if look.close != 0 {
                block.each(shapes, o, d, &mut best);
            }
        }
        for &prim in &self.others {
            let (t, met) = shapes[prim as usize].meet(o, d);
            if met {
                best.take(Hit { t, prim });
            }
        }
        best
    }

    /// Returns true if a shape lies at 0 < t < 1.
    #[inline(always)]
    pub(crate) fn occluded(&self, shapes: &[Shape], o: Vec3, d: Vec3) -> bool {
        for block in &self.blocks {
            let look = block.look(o, d);
            let mut any = 0;
            for t in look.t {
                any |= u32::from(t < 1.0f32.to_bits());
            }
            if any != 0 {
                return true;
            }
            let mut best = Hit::NONE;
            if look.close != 0 {
                block.each(shapes, o, d, &mut best);
            }
            if best.t < 1.0 {
                return true;
            }
        }
        self.others.iter().map(|&prim| shapes[prim as usize].meet(o, d)).any(|(t, met)| met && t < 1.0)
    }
}

impl Block {
    #[inline(always)]
    fn look(&self, o: Vec3, d: Vec3) -> Look {
        let (mut t, mut close) = ([0; LANES], 0);
        for (i, t) in t.iter_mut().enumerate() {
            let flat = Flat::with_numbers(std::array::from_fn(
                #[inline(always)]
                |k| self.numbers[k][i],
            ));
            let (at, most) = flat.look(o, d);
            let (near, sure) = (flat.near(at, most), most <= 1.0);
            *t = if near & sure { at.to_bits() } else { u32::MAX };
            close |= u32::from(near & !sure);
        }
        Look { t, close }
    }

    /// The same, one by one.
    #[cold]
    #[inline(never)]
    fn each(&self, shapes: &[Shape], o: Vec3, d: Vec3, best: &mut Hit) {
        for &prim in self.prim.iter().filter(|&&prim| prim != u32::MAX) {
            let (t, met) = shapes[prim as usize].meet(o, d);
            if met {
                best.take(Hit { t, prim });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Primitive;
    use glam::DVec3;

    /// The bits are those of every shape in turn, also for rays at edges and corners, where the tests in lanes leave off.
    #[test]
    fn lanes_give_the_bits_of_single_shapes() {
        let mut next = crate::math::chance::numbers();
        let mut v = move || DVec3::new(next(), next(), next());
        let (mut hits, mut blocked) = (0, 0);
        for n in 1..30 {
            let flats: Vec<[DVec3; 3]> = (0..n).map(|_| [v(), v(), v()]).collect();
            let primitive =
                |&[origin, edge_u, edge_v]: &[DVec3; 3]| Primitive::Parallelogram { origin, edge_u, edge_v };
            let mut shapes: Vec<Shape> = flats.iter().map(|f| Shape::new(&primitive(f), 0.0)).collect();
            shapes.push(Shape::new(&Primitive::Disk { center: v(), normal: v().normalize(), radius: 0.2 }, 0.0));
            let few = Few::new(&shapes).expect("few shapes");
            for i in 0..300 {
                let [corner, edge_u, edge_v] = flats[i % flats.len()];
                let to = [corner, corner + 0.3 * edge_u, corner + edge_u, corner + 0.4 * edge_u + 0.6 * edge_v][i % 4];
                let o = v();
                let (o, d) = (o.as_vec3(), (to - o).as_vec3() * if i % 3 == 0 { 2.0 } else { 0.9 });
                let (mut best, mut any) = (Hit::NONE, false);
                for (prim, shape) in shapes.iter().enumerate() {
                    let (t, met) = shape.meet(o, d);
                    if met {
                        best.take(Hit { t, prim: prim as u32 });
                        any |= t < 1.0;
                    }
                }
                let found = few.closest(&shapes, o, d);
                assert_eq!((found.t.to_bits(), found.prim), (best.t.to_bits(), best.prim));
                assert_eq!(few.occluded(&shapes, o, d), any);
                hits += usize::from(best.prim != u32::MAX);
                blocked += usize::from(any);
            }
        }
        assert!(hits > 4000 && blocked > 2000, "{hits} hits, {blocked} blocked");
    }
}
