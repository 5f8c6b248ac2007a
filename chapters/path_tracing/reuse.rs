//! Own paths for every term, against one path for all of them.
//!
//! ```text
//! own paths:  Var = Σ_k σ_k²/n_k,   rays = Σ_k n_k c_k       best split: n_k ∝ σ_k/√c_k,  Var · rays = (Σ_k σ_k √c_k)²
//! one path:   Var = Σ_jk C_jk / n,  rays = n c               C_kk = σ_k²,   correlation C_jk/√(C_jj C_kk)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | σ_k², c_k | variance and rays of one sample of the term k from its own path | [`Noise::variance`], [`Noise::rays`] |
//! | C | covariance of the terms of one path, averaged over pixels and channels | [`Noise::covariance`] |
//! | c | rays of one path | [`Noise::path`] |
//! | n_k | samples of the term k | [`Noise::counts`] |
//!
//! Only reflected light is compared, k = 1, …, K. The lamp seen directly has noise at its edges that has nothing to do with
//! paths. Errors come from the jackknife over independent repetitions.
//!
//! Reference: Neyman, *On the two different aspects of the representative method* (1934).

use super::{LAST, scene};
use fredholm::estimator::{Plan, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Folder, Number};
use fredholm::study::split::{self, Term, Unit};

/// Noise and cost of T E, …, T^K E. Index k − 1 belongs to the term k.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// σ_k², own paths.
    pub variance: Vec<f64>,
    /// c_k, own paths.
    pub rays: Vec<f64>,
    /// C, one path.
    pub covariance: Vec<Vec<f64>>,
    /// c, one path.
    pub path: f64,
}

// ANCHOR: work
impl Noise {
    /// Σ_jk C_jk: variance of the sum of the terms of one path.
    pub fn shared(&self) -> f64 {
        self.covariance.iter().flatten().sum()
    }

    /// Variance times rays of the sum from one path.
    pub fn one_path(&self) -> f64 {
        self.shared() * self.path
    }

    /// The same with one own path for every term.
    pub fn equal(&self) -> f64 {
        self.variance.iter().sum::<f64>() * self.rays.iter().sum::<f64>()
    }

    /// The same with the best numbers of own paths.
    pub fn best(&self) -> f64 {
        split::best(&self.terms(), Unit::Rays).value
    }

    /// Variance times rays of the term k alone: own paths over one path for all.
    pub fn alone(&self, k: usize) -> f64 {
        self.variance[k - 1] * self.rays[k - 1] / (self.covariance[k - 1][k - 1] * self.path)
    }

    /// Correlation of the terms j and k of one path.
    pub fn correlation(&self, j: usize, k: usize) -> f64 {
        let c = |j: usize, k: usize| self.covariance[j - 1][k - 1];
        c(j, k) / (c(j, j) * c(k, k)).sqrt()
    }
}
// ANCHOR_END: work

impl Noise {
    fn terms(&self) -> Vec<Term> {
        let term = |(&variance, &rays): (&f64, &f64)| Term { spp: 1, variance, std_error: 0.0, rays, seconds: 0.0 };
        self.variance.iter().zip(&self.rays).map(term).collect()
    }

    /// n_k of the best split for this number of rays.
    pub fn counts(&self, rays: f64) -> Vec<u32> {
        split::optimal(&self.terms(), Unit::Rays, rays, 1)
    }
}

/// Measures the noise of own paths and of one path in the Cornell box, with connections, in independent repetitions.
///
/// # Errors
/// If the scene cannot be loaded, or the program was stopped.
pub fn repetitions(folder: &Folder<'_>) -> book::Result<Vec<Noise>> {
    let room = scene("cornell", 32)?;
    let t = SceneTransport::new(&room);
    let plan = Plan { max_bounces: LAST, technique: Technique::Connect, roulette: Roulette::Never };
    let (single, prefix) = (SingleTerm(plan.clone()), Prefix(plan));
    let (count, spp) = folder.pick((24, 64), (12, 16));
    let once = |i: u32| {
        let key = |name: &str| Key::new(folder.seed, &format!("{name} {i}"));
        let own = split::measure(&t, &room.camera, &single, &[spp; LAST + 1], key("own paths"), folder.progress);
        let one = split::reuse(&t, &room.camera, &prefix, spp, key("one path"), folder.progress);
        let (own, one) = own.zip(one).ok_or("interrupted")?;
        let row = |j: usize| (1..=LAST).map(|k| one.covariance.entry(j, k)).collect();
        Ok(Noise {
            variance: own[1..].iter().map(|term| term.variance).collect(),
            rays: own[1..].iter().map(|term| term.rays).collect(),
            covariance: (1..=LAST).map(row).collect(),
            path: one.rays,
        })
    };
    (0..count).map(once).collect()
}

/// The mean of some repetitions.
pub(super) fn mean<'a>(all: impl Iterator<Item = &'a Noise> + Clone) -> Noise {
    let n = all.clone().count() as f64;
    let of = |f: &dyn Fn(&Noise) -> f64| all.clone().map(f).sum::<f64>() / n;
    let terms = 0..LAST;
    Noise {
        variance: terms.clone().map(|k| of(&|x| x.variance[k])).collect(),
        rays: terms.clone().map(|k| of(&|x| x.rays[k])).collect(),
        covariance: terms.clone().map(|j| terms.clone().map(|k| of(&|x| x.covariance[j][k])).collect()).collect(),
        path: of(&|x| x.path),
    }
}

/// A function of the mean of all repetitions, with its error by the jackknife.
pub fn value(all: &[Noise], f: impl Fn(&Noise) -> f64) -> Number {
    let n = all.len() as f64;
    let without = |i: usize| f(&mean(all.iter().enumerate().filter(move |(j, _)| *j != i).map(|(_, x)| x)));
    let each: Vec<f64> = (0..all.len()).map(without).collect();
    let centre = each.iter().sum::<f64>() / n;
    let squares: f64 = each.iter().map(|x| (x - centre).powi(2)).sum();
    Number { value: f(&mean(all.iter())), std_error: (squares * (n - 1.0) / n).sqrt() }
}
