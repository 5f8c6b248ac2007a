//! How cost grows: CPU time and peak memory against samples, pixels, K, triangles, lights, patches and threads.
//!
//! ```text
//! cost ≈ c nᵇ        b is the slope on logarithmic axes (stats::power_law)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | the quantity that is varied; everything else is kept | [`Varied`], [`Subject::sizes`] |
//! | cost | CPU seconds of one part of the work, or the peak memory of the process | [`Run`] |
//! | b | what the algorithm promises | [`Part::expected`] |
//!
//! **Each run is a process of its own**, which the caller starts: peak memory is a number of a process, and it never falls. Inside,
//! [`measure()`] times each part of the work with a clock that the caller gives, on one thread. The clock should count the CPU time
//! of the process: it does not run while another program has the core. CPU time still depends on what the others do to the caches
//! and to the clock rate; so [`Growth::order`] goes through all sizes in a random order, then again in another one, and a phase of a
//! busy machine meets all sizes alike.

mod measure;
mod scenes;

pub use measure::measure;
pub use scenes::{Room, lamps};

use crate::math::{Key, Purpose, Rng};
use crate::stats::power_law::{PowerLaw, Sized, power_law};
use serde::{Deserialize, Serialize};

/// A quantity that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varied {
    /// Samples per pixel.
    Samples,
    /// Pixels of the image.
    Pixels,
    /// K, the number of terms that are kept, minus one.
    Bounces,
    /// Triangles of the scene.
    Triangles,
    /// Lights of the scene.
    Lights,
    /// Patches of the matrix.
    Patches,
    /// Threads.
    Threads,
}

impl Varied {
    /// All of them, in the order of the figure.
    pub const ALL: [Self; 7] =
        [Self::Samples, Self::Pixels, Self::Bounces, Self::Triangles, Self::Lights, Self::Patches, Self::Threads];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples per pixel",
            Self::Pixels => "pixels",
            Self::Bounces => "K",
            Self::Triangles => "triangles",
            Self::Lights => "lights",
            Self::Patches => "patches",
            Self::Threads => "threads",
        }
    }
}

/// One quantity that is varied, and one way to do the work: what one process measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Samples per pixel, by `prefix`.
    Samples,
    /// Pixels, by `prefix`.
    Pixels,
    /// K, all terms from one path of K + 1 vertices.
    Together,
    /// K, a path of its own for every term.
    Separate,
    /// K, all terms from one path that ends by the albedo.
    Roulette,
    /// Triangles of a ball in a room, from an OBJ file.
    Triangles,
    /// Lamps that share a ceiling.
    Lights,
    /// Patches, as a dense matrix.
    Dense,
    /// Patches, as stored rays.
    Rays,
    /// Threads of one render.
    Threads,
}

/// One part of the work of a process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// What is done.
    pub name: &'static str,
    /// The exponent of its time that the algorithm promises for large sizes.
    pub expected: f64,
}

const fn part(name: &'static str, expected: f64) -> Part {
    Part { name, expected }
}

/// Sides of the square images whose pixels are counted.
const SIDES: [u64; 5] = [32, 64, 128, 256, 512];

impl Subject {
    /// All subjects, in the order of the figure.
    pub const ALL: [Self; 10] = [
        Self::Samples,
        Self::Pixels,
        Self::Together,
        Self::Separate,
        Self::Roulette,
        Self::Triangles,
        Self::Lights,
        Self::Dense,
        Self::Rays,
        Self::Threads,
    ];

    /// The quantity that is varied.
    pub fn varied(self) -> Varied {
        match self {
            Self::Samples => Varied::Samples,
            Self::Pixels => Varied::Pixels,
            Self::Together | Self::Separate | Self::Roulette => Varied::Bounces,
            Self::Triangles => Varied::Triangles,
            Self::Lights => Varied::Lights,
            Self::Dense | Self::Rays => Varied::Patches,
            Self::Threads => Varied::Threads,
        }
    }

    /// A word for files and command lines.
    pub fn id(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Pixels => "pixels",
            Self::Together => "together",
            Self::Separate => "separate",
            Self::Roulette => "roulette",
            Self::Triangles => "triangles",
            Self::Lights => "lights",
            Self::Dense => "dense",
            Self::Rays => "rays",
            Self::Threads => "threads",
        }
    }

    /// The way to do the work, in words.
    pub fn way(self) -> &'static str {
        match self {
            Self::Samples | Self::Pixels | Self::Triangles | Self::Lights | Self::Threads => "prefix",
            Self::Together => "one path for all terms",
            Self::Separate => "a path for each term",
            Self::Roulette => "one path, roulette",
            Self::Dense => "dense matrix",
            Self::Rays => "stored rays",
        }
    }

    /// The parts of the work that are timed, in their order.
    pub fn parts(self) -> &'static [Part] {
        const RENDER: &[Part] = &[part("render", 1.0)];
        const TOGETHER: &[Part] = &[part("one path for all terms", 1.0)];
        const SEPARATE: &[Part] = &[part("a path for each term", 2.0)];
        const ROULETTE: &[Part] = &[part("one path, roulette", 0.0)];
        const SCENE: &[Part] = &[part("load", 1.0), part("render", 0.0)];
        const DENSE: &[Part] = &[part("form factors", 2.0), part("30 products", 2.0), part("LU", 3.0)];
        const RAYS: &[Part] = &[part("stored rays", 1.0), part("30 products with them", 1.0)];
        const THREADS: &[Part] = &[part("wall clock", -1.0), part("CPU", 0.0)];
        match self {
            Self::Samples | Self::Pixels => RENDER,
            Self::Together => TOGETHER,
            Self::Separate => SEPARATE,
            Self::Roulette => ROULETTE,
            Self::Triangles | Self::Lights => SCENE,
            Self::Dense => DENSE,
            Self::Rays => RAYS,
            Self::Threads => THREADS,
        }
    }

    /// The sizes n at which it is measured, ascending. `quick` takes few and small ones; `threads` are those of the machine.
    pub fn sizes(self, quick: bool, threads: usize) -> Vec<u64> {
        let all: Vec<u64> = match self {
            Self::Samples => vec![16, 64, 256, 1024, 4096],
            Self::Pixels => SIDES.map(|s| s * s).into(),
            Self::Together | Self::Roulette => vec![2, 4, 8, 16, 32, 64],
            Self::Separate => vec![2, 4, 8, 16, 32],
            Self::Triangles => [1, 3, 10, 32, 100, 224].map(|f| Room { frequency: f }.triangles()).into(),
            Self::Lights => vec![1, 10, 100, 1000, 10_000],
            Self::Dense => vec![258, 516, 1032, 2064, 4128],
            Self::Rays => vec![1000, 4000, 16_000, 64_000, 256_000],
            // 1, 2, 4, … and the number of threads of the machine
            Self::Threads => {
                let doubled = std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|n| *n < threads as u64);
                doubled.chain([threads as u64]).collect()
            }
        };
        if quick { all[..all.len().min(2)].to_vec() } else { all }
    }
}

/// What one process has measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Seconds of each of the [`Subject::parts`].
    pub seconds: Vec<f64>,
    /// Peak memory of the process, bytes; none where the system does not tell.
    pub peak: Option<u64>,
}

/// The runs of one subject at one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// What was measured.
    pub subject: Subject,
    /// n.
    pub size: u64,
    /// The runs so far.
    pub runs: Vec<Run>,
}

/// All points of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// The points by subject, ascending in size.
    pub points: Vec<Point>,
}

/// One cost at all sizes.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What was measured.
    pub subject: Subject,
    /// What it is the cost of.
    pub name: &'static str,
    /// The exponent that the algorithm promises.
    pub expected: Option<f64>,
    /// The costs: seconds, or bytes.
    pub sizes: Vec<Sized>,
}

impl Curve {
    /// The fitted exponent.
    pub fn fit(&self) -> Option<PowerLaw> {
        power_law(&self.sizes)
    }
}

impl Growth {
    /// A study without runs.
    pub fn new(quick: bool, threads: usize) -> Self {
        let points = Subject::ALL.iter().flat_map(|&subject| {
            let sizes = subject.sizes(quick, threads).into_iter();
            sizes.map(move |size| Point { subject, size, runs: vec![] })
        });
        Self { points: points.collect() }
    }

    /// The order in which the `repeat`-th round visits the points: indices into `points`, shuffled.
    pub fn order(&self, seed: u64, repeat: u32) -> Vec<usize> {
        let key = Key::new(seed, "order of growth");
        let number = |i: usize| Rng::at(key, i as u32, repeat, 0, Purpose::Start).one();
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by(|&a, &b| number(a).total_cmp(&number(b)));
        order
    }

    /// The time of every part of the work of a quantity, against its size.
    pub fn times(&self, varied: Varied) -> Vec<Curve> {
        let subjects = Subject::ALL.into_iter().filter(|s| s.varied() == varied);
        let parts = subjects.flat_map(|s| s.parts().iter().enumerate().map(move |(i, p)| (s, i, p)));
        let curve = |(subject, i, p): (Subject, usize, &Part)| Curve {
            subject,
            name: p.name,
            expected: Some(p.expected),
            sizes: self.of(subject, |run| run.seconds.get(i).copied()),
        };
        parts.map(curve).collect()
    }

    /// The peak memory of the process by the ways to do the work of a quantity, against its size, in bytes.
    pub fn memory(&self, varied: Varied) -> Vec<Curve> {
        let subjects = Subject::ALL.into_iter().filter(|s| s.varied() == varied);
        let curve = |subject: Subject| Curve {
            subject,
            name: subject.way(),
            expected: None,
            sizes: self.of(subject, |run| run.peak.map(|bytes| bytes as f64)),
        };
        subjects.map(curve).collect()
    }

    /// The costs of a subject at the sizes that have any.
    fn of(&self, subject: Subject, cost: impl Fn(&Run) -> Option<f64>) -> Vec<Sized> {
        let points = self.points.iter().filter(|p| p.subject == subject);
        let sized = points.map(|p| Sized { size: p.size as f64, costs: p.runs.iter().filter_map(&cost).collect() });
        sized.filter(|s| !s.costs.is_empty()).collect()
    }
}
