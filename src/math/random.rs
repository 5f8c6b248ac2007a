//! Random numbers by address: each number is a hash of where it is used. There is no counter, so the numbers do not depend
//! on the order in which paths are computed.
//!
//! `u = hash(key, pixel, sample, place)` with `place = (bounce, purpose, draw)`.
//!
//! | symbol | type | meaning |
//! |---|---|---|
//! | key | [`Key`] | the run: its seed and the name of the stream |
//! | pixel, sample | `u32` | the path |
//! | bounce | vertex index v | the vertex of the path |
//! | purpose | [`Purpose`] | the decision that the number is used for |
//! | draw | 0, 1, … | number of the draw; each draw gives four numbers |
//! | points | [`Points`] | independent samples, or points of a Sobol sequence |
//!
//! The hash is pcg4d of Jarzynski and Olano, *Hash Functions for GPU Rendering* (JCGT 9(3), 2020).

use super::pcg::pcg4d;
use super::sobol::{self, Deal};

/// The decision that a random number is used for; part of its address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The start of the path: the point in the pixel, or on the surface sensor.
    Start = 0,
    /// The point on a lamp, for next-event estimation.
    Connect = 1,
    /// The direction of the next ray.
    Scatter = 2,
    /// Russian roulette.
    Roulette = 3,
}

/// The relation between the samples of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Points {
    /// The samples are independent of each other.
    #[default]
    Independent,
    /// The samples of one replicate are the points of a scrambled [Sobol sequence](super::sobol).
    Sobol,
}

impl std::fmt::Display for Points {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Independent { "independent" } else { "sobol" })
    }
}

impl Points {
    /// Both kinds of points.
    pub const ALL: [Self; 2] = [Self::Independent, Self::Sobol];
}

impl std::str::FromStr for Points {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        super::names::named(&Self::ALL, name)
    }
}

/// The key of a stream of random numbers. Equal seeds and names give equal numbers; any difference gives unrelated numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    bits: [u32; 2],
    /// Number of replicates over which the samples are distributed, if they are Sobol points; 0 if samples are independent.
    scrambles: u32,
}

impl Key {
    /// The stream called `name` of a run with the seed `seed`.
    ///
    /// ```
    /// use fredholm::math::Key;
    /// assert_eq!(Key::new(1, "prefix"), Key::new(1, "prefix"));
    /// assert_ne!(Key::new(1, "prefix"), Key::new(1, "path"));
    /// ```
    pub fn new(seed: u64, name: &str) -> Self {
        // the hash of the name, then the finaliser of splitmix64
        let name = fnv1a(name.bytes());
        let mut z = name ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        Self { bits: [z as u32, (z >> 32) as u32], scrambles: 0 }
    }

    /// The same stream with other points. Sample i belongs to replicate `i mod replicates`, as on the
    /// [film](crate::terms::film). Replicates are independent of each other for both kinds of points.
    #[must_use]
    pub fn with_points(self, points: Points, replicates: usize) -> Self {
        Self { scrambles: if points == Points::Sobol { replicates.max(1) as u32 } else { 0 }, ..self }
    }

    /// The relation between the samples of one pixel.
    #[inline(always)]
    pub fn points(self) -> Points {
        if self.scrambles == 0 { Points::Independent } else { Points::Sobol }
    }

    /// Another stream of the same run with the number `index`. For example, the estimator `single` uses a separate stream
    /// for each term.
    #[must_use]
    pub fn branch(self, index: u32) -> Self {
        let v = pcg4d([self.bits[0], self.bits[1], index, 0x5bd1_e995]);
        Self { bits: [v[0], v[1]], ..self }
    }
}

/// FNV-1a, 64 bits: the same number for the same bytes on every machine (Fowler, Noll, Vo 1991).
pub fn fnv1a(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}

/// Generator of the random numbers of one (path, bounce, purpose), four per draw.
#[derive(Clone, Copy, Debug)]
pub struct Rng {
    key: Key,
    pixel: u32,
    sample: u32,
    place: u32,
}

const DRAW: u32 = 1 << 24;

impl Rng {
    /// The generator for one purpose at vertex `bounce` of path (`pixel`, `sample`).
    #[inline(always)]
    pub fn at(key: Key, pixel: u32, sample: u32, bounce: usize, purpose: Purpose) -> Self {
        Self { key, pixel, sample, place: place(bounce, purpose) }
    }

    /// Four uniform numbers in [0, 1). They are independent multiples of 2⁻²⁴, or the coordinates of one Sobol point.
    #[inline(always)]
    pub fn four(&mut self) -> [f32; 4] {
        let Self { key, pixel, sample, place } = *self;
        self.place = place.wrapping_add(DRAW);
        match key.points() {
            Points::Independent => independent(key, pixel, sample, place),
            Points::Sobol => sobol::four(key.bits, pixel, place, Deal::to(key.scrambles).at(sample)),
        }
    }

    /// One uniform number in [0, 1); the other three of the draw are not used.
    #[inline(always)]
    pub fn one(&mut self) -> f32 {
        self.four()[0]
    }
}

#[inline(always)]
fn independent(key: Key, pixel: u32, sample: u32, place: u32) -> [f32; 4] {
    pcg4d([pixel.wrapping_add(key.bits[0]), sample, place, key.bits[1]]).map(unit)
}

#[inline(always)]
fn place(bounce: usize, purpose: Purpose) -> u32 {
    (bounce as u32) << 2 | purpose as u32
}

/// The top 24 bits of `x` as a number in [0, 1).
#[inline(always)]
fn unit(x: u32) -> f32 {
    // through i32, which is converted by one vector instruction
    (x >> 8) as i32 as f32 * (1.0 / 16_777_216.0)
}

/// The random streams of a wave of paths: each path has its own (pixel, sample), and all share one (bounce, purpose).
#[derive(Clone, Copy, Debug)]
pub struct Streams<'a> {
    /// The key of the run's stream.
    pub key: Key,
    /// Pixel of each path.
    pub pixel: &'a [u32],
    /// Sample number of each path within its pixel.
    pub sample: &'a [u32],
    /// Vertex index, the same for all paths.
    pub bounce: usize,
    /// The decision that the numbers are used for.
    pub purpose: Purpose,
}

impl Streams<'_> {
    /// The generator of path `i`.
    #[inline(always)]
    pub fn rng(&self, i: usize) -> Rng {
        Rng::at(self.key, self.pixel[i], self.sample[i], self.bounce, self.purpose)
    }

    /// The first draw of path `i`, for independent samples only. A loop over paths then has no branch.
    #[inline(always)]
    pub(crate) fn first_draw(&self, i: usize) -> [f32; 4] {
        independent(self.key, self.pixel[i], self.sample[i], place(self.bounce, self.purpose))
    }

    /// The first draw of all paths as columns, for Sobol points only.
    #[inline(always)]
    pub(crate) fn sobol_draws(&self, [a, b, c, d]: [&mut [f32]; 4]) {
        let (n, bits, place) = (self.len(), self.key.bits, place(self.bounce, self.purpose));
        let (pixel, sample) = (&self.pixel[..n], &self.sample[..n]);
        let (a, b, c, d) = (&mut a[..n], &mut b[..n], &mut c[..n], &mut d[..n]);
        // two loops, so that the first has no branch
        if let Deal::Bits(shift) = Deal::to(self.key.scrambles) {
            for i in 0..n {
                [a[i], b[i], c[i], d[i]] = sobol::four(bits, pixel[i], place, Deal::Bits(shift).at(sample[i]));
            }
            return;
        }
        for i in 0..n {
            [a[i], b[i], c[i], d[i]] = self.rng(i).four();
        }
    }

    /// Number of paths.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.pixel.len()
    }

    /// Returns true if there is no path.
    pub fn is_empty(&self) -> bool {
        self.pixel.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_uncorrelated_in_every_address() {
        // means of u and of products of neighbouring numbers over 2^18 addresses; each must lie within 5.5 standard errors
        let key = Key::new(3, "test");
        let n = 1u32 << 18;
        let (mut mean, mut product) = ([0.0; 4], [0.0; 3]);
        for i in 0..n {
            let (pixel, sample, bounce) = (i & 63, i >> 12, (i as usize >> 6) & 63);
            let u = Rng::at(key, pixel, sample, bounce, Purpose::Scatter).four().map(f64::from);
            let next = [
                Rng::at(key, pixel + 1, sample, bounce, Purpose::Scatter).one(),
                Rng::at(key, pixel, sample + 1, bounce, Purpose::Scatter).one(),
                Rng::at(key, pixel, sample, bounce, Purpose::Connect).one(),
            ];
            (0..4).for_each(|j| mean[j] += u[j] - 0.5);
            (0..3).for_each(|j| product[j] += (u[0] - 0.5) * (f64::from(next[j]) - 0.5));
        }
        let n = f64::from(n);
        assert!(mean.iter().all(|m| (m / n).abs() < 5.5 * (1.0 / 12.0 / n).sqrt()), "{mean:?}");
        assert!(product.iter().all(|m| (m / n).abs() < 5.5 / 12.0 / n.sqrt()), "{product:?}");
    }
}
