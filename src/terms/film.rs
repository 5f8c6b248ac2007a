//! The film: the sum of the samples, for each pixel, replicate and slot.
//!
//! Sample i of a pixel belongs to replicate `i mod R`. Replicates are independent and identically distributed. S_r is the
//! sum of replicate r over its n_r samples, so the mean is `m = Σ S_r / Σ n_r`, and its squared standard error is
//!
//! `se² = R/(R−1) · Σ_r ( (S_r − n_r m) / N )²`
//!
//! These formulas hold for any linear functional of the image and for any estimator, even if the samples inside a replicate
//! depend on each other.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | R | number of replicates | [`Shape::replicates`] |
//! | slot | k = 0..=K, then the tail; the path tracer has one slot | [`Shape::slots`] |
//! | N | samples of a pixel so far | [`TermFilm::samples`] |
//!
//! Memory: `pixels · R · slots · 24` bytes. Sums are `f64`, and nothing is clamped. Non-finite samples are counted and stay
//! in the sums.
//!
//! A film may be rendered in [parts](super::part), and a render may be left within a pass: a block then holds all samples of the
//! pass or none.

use super::largest::Largest;
use super::part::Part;
use crate::math::Columns;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Size of a film: pixels, slots and replicates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Number of slots.
    pub slots: usize,
    /// Number of independent replicates, R.
    pub replicates: usize,
}

impl Shape {
    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    pub(crate) fn per_pixel(&self) -> usize {
        self.replicates * self.slots * 3
    }

    /// Number of blocks of pixels.
    pub fn blocks(&self) -> usize {
        self.pixels().div_ceil(BLOCK)
    }

    /// Number of pixels of a block.
    pub(crate) fn block(&self, block: usize) -> usize {
        BLOCK.min(self.pixels() - block * BLOCK)
    }
}

/// Sums of all samples so far.
#[derive(Clone, Debug)]
pub struct TermFilm {
    /// Size of the film.
    pub shape: Shape,
    /// Number of samples of each pixel so far. Pixels of one block have the same number.
    pub samples: Vec<u32>,
    /// Rays requested, by slot.
    pub rays: Vec<u64>,
    /// Number of samples that were not finite.
    pub non_finite: u64,
    pub(crate) sums: Vec<f64>,
    /// Σ (r + g + b)² of all contributions, by block, slot and pixel; on a shared film also by replicate. It gives the number of
    /// events that carry a mean.
    pub(crate) squares: Vec<f64>,
    /// The largest contributions to each slot, over all pixels.
    pub(crate) largest: Vec<Largest>,
    /// True if paths add to pixels other than their own; pixels then share their noise.
    pub(crate) shared: bool,
}

/// Pixels of a block. Its sums are one piece of memory.
pub(crate) const BLOCK: usize = 64;

/// Index of the sum of a slot, replicate and pixel inside a block. A wave adds to one slot at a time, over all replicates
/// and pixels. The memory has this order, so that one slot of a block fits into the first-level cache.
#[inline(always)]
fn place(slot: usize, replicate: usize, pixel: usize, replicates: usize, pixels: usize) -> usize {
    ((slot * replicates + replicate) * pixels + pixel) * 3
}

/// The part of the film that one thread works on: neighbouring blocks that are whole, or one block.
pub(crate) struct FilmBlocks<'a> {
    shape: Shape,
    /// The number of a pixel minus its place in the blocks; in a crop it changes from row to row.
    pub(crate) first: u32,
    /// Pixels of each block.
    pixels: usize,
    shared: bool,
    sums: &'a mut [f64],
    squares: &'a mut [f64],
    /// Numbers in the sums and in the squares of a block.
    strides: [usize; 2],
    pub(crate) largest: Vec<Largest>,
    pub(crate) non_finite: u64,
    pub(crate) rays: Vec<u64>,
    /// The slots whose memory has never been written.
    fresh: Vec<bool>,
}

/// Sums in a page of memory.
const PAGE: usize = 4096 / size_of::<f64>();

impl<'a> FilmBlocks<'a> {
    /// The blocks of these sums and squares, of which pixel `first` is the first one. They are `fresh` if nothing was added to them.
    pub(crate) fn new(
        shape: Shape,
        shared: bool,
        first: u32,
        [sums, squares]: [&'a mut [f64]; 2],
        largest: Vec<Largest>,
        fresh: bool,
    ) -> Self {
        let all = sums.len() / shape.per_pixel();
        let pixels = all.min(BLOCK);
        let strides = [&*sums, &*squares].map(|numbers| numbers.len() / all * pixels);
        let (rays, fresh) = (vec![0; shape.slots], vec![fresh; shape.slots]);
        Self { shape, first, pixels, shared, sums, squares, strides, largest, non_finite: 0, rays, fresh }
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        let n = pixel.len();
        let mut added = 0;
        for first in (0..n).step_by(RUN) {
            let last = (first + RUN).min(n);
            let some = some_of([&value.x[first..last], &value.y[first..last], &value.z[first..last]]);
            added += u64::from(some);
            if some > 0 && self.fresh[slot] {
                self.touch(slot);
            }
            // most hits emit nothing, so that a run has few contributions or none. Where there are many, zeros are added too:
            // they change no sum, and a branch that depends on chance costs more
            if some > FEW {
                (first..last).for_each(|i| self.add_one(slot, pixel[i], sample[i], value.get(i)));
            } else if some > 0 {
                for i in (first..last).filter(|&i| value.get(i) != Vec3::ZERO) {
                    self.add_one(slot, pixel[i], sample[i], value.get(i));
                }
            }
        }
        self.largest[slot].count(added);
    }

    /// Writes to every page of a slot. If pages are read before they are written, the system brings in each of them twice. A slot
    /// without light, which many blocks have, needs no memory.
    #[cold]
    fn touch(&mut self, slot: usize) {
        let each = self.shape.replicates * self.pixels * 3;
        for block in self.sums.chunks_mut(self.strides[0]) {
            block[slot * each..][..each].iter_mut().step_by(PAGE).for_each(|s| *s = 0.0);
        }
        self.fresh[slot] = false;
    }

    #[inline(always)]
    fn add_one(&mut self, slot: usize, pixel: u32, sample: u32, v: Vec3) {
        let replicates = self.shape.replicates as u32;
        let replicate = if replicates.is_power_of_two() { sample & (replicates - 1) } else { sample % replicates };
        let pixel = (pixel - self.first) as usize;
        let (block, pixel) = (pixel / BLOCK, pixel % BLOCK);
        let [sums, squares] = self.strides.map(|n| n * block);
        let at = sums + place(slot, replicate as usize, pixel, replicates as usize, self.pixels);
        let s = &mut self.sums[at..at + 3];
        s[0] += f64::from(v.x);
        s[1] += f64::from(v.y);
        s[2] += f64::from(v.z);
        let sum = v.x + v.y + v.z;
        let all = f64::from(sum);
        let row = if self.shared { slot * replicates as usize + replicate as usize } else { slot };
        self.squares[squares + row * self.pixels + pixel] += all * all;
        self.non_finite += u64::from(!sum.is_finite());
        self.largest[slot].push(sum);
    }
}

/// Contributions that are looked at together, and the number of them that are not zero up to which they are added one by one.
const RUN: usize = 16;
const FEW: u32 = 4;

/// Number of vectors that are not zero.
#[inline(always)]
fn some_of([x, y, z]: [&[f32]; 3]) -> u32 {
    let mut some = 0;
    for ((x, y), z) in x.iter().zip(y).zip(z) {
        some += u32::from((*x != 0.0) | (*y != 0.0) | (*z != 0.0));
    }
    some
}

impl TermFilm {
    /// An empty film for paths that add to their own pixel.
    pub fn new(shape: Shape) -> Self {
        Self::empty(shape, false)
    }

    /// An empty film. On a `shared` one, paths add to pixels other than their own.
    pub fn empty(shape: Shape, shared: bool) -> Self {
        let mut film = Self {
            shape,
            samples: vec![0; shape.pixels()],
            rays: vec![0; shape.slots],
            non_finite: 0,
            sums: vec![0.0; shape.pixels() * shape.per_pixel()],
            squares: vec![],
            largest: vec![Largest::default(); shape.slots],
            shared,
        };
        film.squares = vec![0.0; shape.pixels() * film.squares_per_pixel()];
        film
    }

    /// True if paths add to pixels other than their own.
    pub fn is_shared(&self) -> bool {
        self.shared
    }

    /// The blocks that hold a part of the film; all blocks of a shared film.
    pub(crate) fn blocks_of(&self, part: Part) -> impl Iterator<Item = usize> + use<> {
        let all = self.shared;
        (0..self.shape.blocks()).filter(move |&b| all || part.has(b))
    }

    /// The sums and squares of one slot of a block.
    pub(crate) fn slot_of_block(&self, block: usize, slot: usize) -> (&[f64], &[f64]) {
        let [sums, squares] = self.places(block, slot);
        (&self.sums[sums], &self.squares[squares])
    }

    /// The same, to be changed.
    pub(crate) fn slot_of_block_mut(&mut self, block: usize, slot: usize) -> (&mut [f64], &mut [f64]) {
        let [sums, squares] = self.places(block, slot);
        (&mut self.sums[sums], &mut self.squares[squares])
    }

    fn places(&self, block: usize, slot: usize) -> [Range<usize>; 2] {
        let (first, pixels) = (block * BLOCK, self.shape.block(block));
        [self.shape.per_pixel(), self.squares_per_pixel()].map(|all| {
            let each = all / self.shape.slots * pixels;
            let start = first * all + slot * each;
            start..start + each
        })
    }

    /// Numbers of [`TermFilm::squares`] for each pixel.
    pub(crate) fn squares_per_pixel(&self) -> usize {
        self.shape.slots * if self.shared { self.shape.replicates } else { 1 }
    }

    /// A film of exactly known values: one sample of each pixel, `slots[s][pixel]`.
    pub(crate) fn exact(size: [u32; 2], slots: &[Vec<DVec3>]) -> Self {
        let mut film = Self::new(Shape { size, slots: slots.len(), replicates: 1 });
        film.samples.fill(1);
        for (slot, values) in slots.iter().enumerate() {
            for (pixel, v) in values.iter().enumerate() {
                let at = film.at(pixel, 0, slot);
                film.sums[at..at + 3].copy_from_slice(&v.to_array());
            }
        }
        film
    }

    /// Adds a value to any pixel; `sample` is the number of the sample that it belongs to.
    #[cfg(test)]
    pub(crate) fn splat(&mut self, slot: u32, pixel: u32, sample: u32, value: crate::math::Rgb) {
        let at = self.at(pixel as usize, sample as usize % self.shape.replicates, slot as usize);
        let first = pixel as usize / BLOCK * BLOCK;
        let pixels = BLOCK.min(self.samples.len() - first);
        let pixel = pixel as usize - first;
        (0..3).for_each(|c| self.sums[at + c] += f64::from(value[c]));
        let all = f64::from(value.x + value.y + value.z);
        assert!(!self.shared, "of tests");
        self.squares[first * self.shape.slots + slot as usize * pixels + pixel] += all * all;
        self.non_finite += u64::from(!(value.x + value.y + value.z).is_finite());
        self.largest[slot as usize].push(value.x + value.y + value.z);
        self.largest[slot as usize].count(1);
    }

    /// Sum of the samples of one pixel, replicate and slot.
    #[inline(always)]
    pub fn sum(&self, pixel: usize, replicate: usize, slot: usize) -> DVec3 {
        let at = self.at(pixel, replicate, slot);
        DVec3::new(self.sums[at], self.sums[at + 1], self.sums[at + 2])
    }

    #[inline(always)]
    fn at(&self, pixel: usize, replicate: usize, slot: usize) -> usize {
        let first = pixel / BLOCK * BLOCK;
        let pixels = BLOCK.min(self.samples.len() - first);
        first * self.shape.per_pixel() + place(slot, replicate, pixel - first, self.shape.replicates, pixels)
    }

    /// The sums of one replicate and slot at neighbouring pixels of one block, three numbers for each pixel.
    pub(super) fn row(&self, pixels: &Range<usize>, replicate: usize, slot: usize) -> &[f64] {
        let at = self.at(pixels.start, replicate, slot);
        &self.sums[at..at + 3 * pixels.len()]
    }

    /// Σ (r + g + b)² of the contributions to one pixel and slot.
    #[inline(always)]
    pub fn square(&self, pixel: usize, slot: usize) -> f64 {
        let first = pixel / BLOCK * BLOCK;
        let pixels = BLOCK.min(self.samples.len() - first);
        let rows = if self.shared { self.shape.replicates } else { 1 };
        let at = |row: usize| first * self.squares_per_pixel() + (slot * rows + row) * pixels + pixel - first;
        (0..rows).map(|row| self.squares[at(row)]).sum()
    }

    /// Number of samples of one pixel in one replicate.
    #[inline(always)]
    pub fn count(&self, pixel: usize, replicate: usize) -> f64 {
        let (n, r) = (self.samples[pixel] as usize, self.shape.replicates);
        ((n + r - 1 - replicate) / r) as f64
    }

    /// Takes over another part of the same film, of equal shape. What that part made is zero here, and adding to zero rounds nothing.
    pub fn take(&mut self, part: Part, other: &Self) {
        for block in other.blocks_of(part) {
            for slot in 0..self.shape.slots {
                let (from, to) = (other.slot_of_block(block, slot), self.slot_of_block_mut(block, slot));
                to.0.iter_mut().zip(from.0).for_each(|(a, b)| *a += b);
                to.1.iter_mut().zip(from.1).for_each(|(a, b)| *a += b);
            }
        }
        self.samples.iter_mut().zip(&other.samples).for_each(|(a, b)| *a = (*a).max(*b));
        self.rays.iter_mut().zip(&other.rays).for_each(|(a, b)| *a += b);
        self.largest.iter_mut().zip(&other.largest).for_each(|(a, b)| a.merge(b));
        self.non_finite += other.non_finite;
    }

    /// Smallest number of samples of any pixel.
    pub fn least_samples(&self) -> u32 {
        self.samples_of(Part::WHOLE).start
    }

    /// Smallest and largest number of samples of the pixels of a part. They differ if a render was left within a pass.
    pub fn samples_of(&self, part: Part) -> Range<u32> {
        let own = |(b, _): &(usize, &[u32])| self.shared || part.has(*b);
        let all = self.samples.chunks(BLOCK).enumerate().filter(own).flat_map(|(_, n)| n).copied();
        let (least, most) = all.fold((u32::MAX, 0), |(least, most), n| (least.min(n), most.max(n)));
        least.min(most)..most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of n numbers that are not negative are wrong by less than n 2⁻⁵³ of themselves (Higham, *Accuracy and Stability of
    /// Numerical Algorithms*, §4.2). A replicate has at most 2²¹ samples of a pixel, so that a mean is right to 2.4·10⁻¹⁰.
    #[test]
    fn the_longest_sum_keeps_nine_digits() {
        const N: u32 = 1 << 21;
        let shape = Shape { size: [1, 1], slots: 1, replicates: 1 };
        let (mut sums, mut squares) = (vec![0.0; 3], vec![0.0]);
        let both = [&mut sums[..], &mut squares[..]];
        let mut block = FilmBlocks::new(shape, false, 0, both, vec![Largest::default()], true);
        // whole multiples of 2⁻⁴⁰, most of them small and a few of them large, so that the exact sum is a whole number
        let mut exact = 0_u128;
        let mut value = Columns::default();
        for i in 0..N {
            let bits = u64::from(i.wrapping_mul(2_654_435_761) >> 8);
            let whole = if i % 1000 == 0 { bits << 26 } else { bits << 10 };
            exact += u128::from(whole);
            let x = (whole as f64 / (1_u64 << 40) as f64) as f32;
            [&mut value.x, &mut value.y, &mut value.z].into_iter().for_each(|c| {
                c.clear();
                c.push(x);
            });
            block.add(0, &[0], &[i], &value);
        }
        let exact = exact as f64 / (1_u64 << 40) as f64;
        let wrong = sums.iter().map(|s| (s / exact - 1.0).abs()).fold(0.0, f64::max);
        assert!(wrong < f64::from(N) * 0.5 * f64::EPSILON && wrong < 1e-9, "{wrong:e}");
    }
}
