//! Tests of the estimators on a radiosity matrix. There `T_h^k E` is known up to rounding.
//!
//! ```text
//! E[X_k] = (T_h^k E)_i      for every patch i: neither geometry nor mesh error can disturb the comparison
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | `T_h^k E`, B | powers of the matrix applied to E, and the solution | [`Walked::exact`] |
//! | X | estimates of the same quantities, n samples per patch | [`Walked::sampled`] |
//! | z_i | (mean − true value)/standard error, patch by patch | [`Walked::z`] |
//!
//! The image of such a run has one pixel per patch, all in one row. The zero-variance walk is in
//! [`crate::study::zero_variance`].

use crate::engine::Settings;
use crate::engine::by_matrix::Matrix;
use crate::engine::by_rays::{self, Estimator, Sampled};
use crate::engine::passes::{Passes, Watch};
use crate::estimator::{Absorption, PathTracer, Plan, Roulette};
use crate::math::names::list;
use crate::operator::MatrixWalk;
use crate::operator::matrix_walk::Rows;
use crate::progress::{Clock, Progress};
use crate::solver::Radiosity;
use crate::terms::functional::exact_functionals;
use crate::terms::{Cost, Estimate, Series, Variance, World};
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// The estimator that is tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walker {
    /// An estimator of the terms.
    Terms(Estimator),
    /// The path tracer, which estimates only the sum of all terms.
    Path,
    /// The absorption estimator.
    Absorption,
}

impl fmt::Display for Walker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Terms(estimator) => estimator.fmt(f),
            Self::Path => f.write_str("path tracer"),
            Self::Absorption => f.write_str("absorption"),
        }
    }
}

/// A study that runs on the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Study {
    /// One estimator, compared with the exact values.
    Walk(Walker),
    /// The absorption estimator with guides of increasing quality, up to the exact solution:
    /// [`zero_variance`](crate::study::zero_variance).
    ZeroVariance,
}

impl Study {
    /// All studies.
    pub fn all() -> Vec<Self> {
        let terms = Estimator::ALL.map(Walker::Terms).into_iter();
        let walks = terms.chain([Walker::Path, Walker::Absorption]).map(Self::Walk);
        walks.chain([Self::ZeroVariance]).collect()
    }

    /// Name of the study; it does not contain the number of children of a branching estimator.
    pub fn name(self) -> &'static str {
        match self {
            Self::Walk(Walker::Terms(estimator)) => estimator.name(),
            Self::Walk(Walker::Path) => "path",
            Self::Walk(Walker::Absorption) => "absorption",
            Self::ZeroVariance => "zero-variance",
        }
    }

    /// The same study with `children` children at every vertex, if its estimator is the branching one.
    #[must_use]
    pub fn with_children(self, children: u32) -> Self {
        match self {
            Self::Walk(Walker::Terms(estimator)) => Self::Walk(Walker::Terms(estimator.with_children(children))),
            other => other,
        }
    }
}

impl FromStr for Study {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::all().into_iter().find(|s| s.name() == name);
        found.ok_or_else(|| format!("`{name}` is none of {}", list(Self::all().into_iter().map(Self::name))))
    }
}

/// The result of one estimator, with the exact values.
pub struct Walked {
    /// The estimates; pixel i is patch i.
    pub sampled: Sampled,
    /// The exact terms from powers of the matrix, as the same functionals.
    pub exact: Series,
    /// z of every patch for the terms k = 0..=K, the tail and the whole. Patches without a standard error are left out.
    pub z: Vec<Vec<f64>>,
}

/// The matrix as a transport operator on which the estimators can sample paths.
pub fn transport(matrix: &Matrix<Radiosity>) -> MatrixWalk {
    let r = &matrix.radiosity;
    let rows = r.factors.f.iter().map(|&f| f64::from(f)).collect();
    let colours = |of: &dyn Fn(usize) -> DVec3| (0..r.patches.len()).map(|i| of(i).as_vec3()).collect();
    let patches: Vec<_> = r.patches.iter().collect();
    MatrixWalk::new(rows, colours(&|i| patches[i].reflectance), colours(&|i| patches[i].emission))
}

/// Runs the estimator from every patch, with `settings.spp` samples each.
pub fn walk(matrix: &Matrix<Radiosity>, walker: Walker, settings: &Settings, progress: Progress<'_>) -> Walked {
    let t = transport(matrix);
    let n = matrix.radiosity.patches.len();
    let rows = Rows(n as u32);
    let stream = format!("walk {walker}");
    let amount = by_rays::amount(settings, &stream);
    let clock = settings.time.map(Clock::start);
    let what = format!("walk, {walker}");
    let mut passes = Passes::begin((&what, &stream), [n as u32, 1], settings, progress, clock.as_ref(), Watch::NONE);
    let plan = settings.plan();
    let (film, ends) = match walker {
        Walker::Terms(estimator) => {
            let ends = plan.roulette.ends();
            (by_rays::film(&t, &rows, estimator, plan, amount, &mut passes), ends)
        }
        Walker::Path => {
            let plan = Plan { roulette: settings.path_roulette.clone(), ..plan };
            let ends = plan.roulette.ends();
            (passes.render(&t, &rows, &PathTracer(plan), amount), ends)
        }
        Walker::Absorption => {
            // this estimator scores only where a walk ends, so that every vertex must be able to end it
            let estimator = Absorption(Plan { roulette: everywhere(matrix), ..plan });
            (passes.render(&t, &rows, &estimator, amount), true)
        }
    };
    let technique = match walker {
        Walker::Absorption | Walker::Terms(Estimator::Light) => String::new(),
        _ => format!(", {}", settings.technique),
    };
    let world = if walker == Walker::Path { World::Path } else { World::Terms };
    let mut found = passes.finish(film, world, format!("walk, {walker}{technique}"));
    let exact = exact(matrix, settings.max_bounces, walker == Walker::Path, ends);
    if !ends {
        by_rays::cut(&mut found.series, settings);
    }
    let roulette = if walker == Walker::Path { &settings.path_roulette } else { &settings.roulette };
    if ends && walker != Walker::Absorption {
        found.distrust(variance(matrix, roulette));
    }
    let z = z(&found, &exact);
    let functionals = exact_functionals([n as u32, 1], &exact);
    let mut series = Series {
        world: World::Radiosity,
        label: format!("powers of the matrix, {n} patches"),
        functionals,
        cost: Cost::default(),
        unsampled: vec![],
        doubts: vec![],
        undecided: None,
        variance: Default::default(),
    };
    if !ends {
        series.functionals.iter_mut().for_each(|f| f.tail = Estimate::NONE);
    }
    Walked { sampled: found, exact: series, z }
}

/// Roulette by albedo. If an emitting patch has albedo 1, walks could never end there; then a constant q is used that keeps
/// the variance finite.
fn everywhere(matrix: &Matrix<Radiosity>) -> Roulette {
    let white =
        |p: &crate::operator::patches::Patch| p.emission.max_element() > 0.0 && p.reflectance.max_element() >= 1.0;
    if !matrix.radiosity.patches.iter().any(white) {
        return Roulette::Albedo { from: 0 };
    }
    let radius = matrix.radiosity.second_moment_radius(1.0).into_iter().fold(0.0, f64::max);
    Roulette::Constant { from: 0, q: (0.25 * (1.0 - radius)).max(f64::EPSILON) }
}

/// States whether the variance is finite under a schedule. The spectral radius of the matrix decides it exactly.
fn variance(matrix: &Matrix<Radiosity>, roulette: &Roulette) -> Variance {
    let q = match roulette {
        Roulette::Constant { q, .. } => *q,
        Roulette::Table(q) => q.last().copied().unwrap_or(0.0),
        // with roulette by albedo or throughput the weights do not grow
        _ => return Variance::Finite,
    };
    let infinite = matrix.radiosity.second_moment_radius(1.0 - q).into_iter().any(|r| r >= 1.0);
    if infinite { Variance::Infinite } else { Variance::Finite }
}

/// The exact values slot by slot: the terms and the tail, or only the whole for the path tracer. The powers are computed
/// from the same single-precision numbers that the walk uses.
fn exact(matrix: &Matrix<Radiosity>, max_bounces: usize, whole: bool, ends: bool) -> Vec<Vec<DVec3>> {
    let mut slots = transport(matrix).powers(max_bounces);
    let n = slots[0].len();
    let sum: Vec<DVec3> = (0..n).map(|i| slots.iter().map(|t| t[i]).sum()).collect();
    let tail: Vec<DVec3> = match ends {
        true => matrix.solution.radiance.iter().zip(&sum).map(|(b, s)| *b - *s).collect(),
        false => vec![DVec3::ZERO; n],
    };
    if whole {
        return vec![sum.iter().zip(&tail).map(|(s, t)| *s + *t).collect()];
    }
    slots.push(tail);
    slots
}

/// z of the mean over channels, for every patch: first slot by slot, then of the whole.
fn z(found: &Sampled, exact: &[Vec<DVec3>]) -> Vec<Vec<f64>> {
    let grey = |v: &[f32; 3]| v.iter().map(|&x| f64::from(x)).sum::<f64>();
    let of = |image: &crate::terms::TermImage, truth: &dyn Fn(usize) -> DVec3| -> Vec<f64> {
        let z = |i: usize| (grey(&image.mean[i]) - truth(i).element_sum()) / grey(&image.std_error[i]);
        let known = |&i: &usize| grey(&image.std_error[i]) > 0.0 && grey(&image.std_error[i]).is_finite();
        (0..image.mean.len()).filter(known).map(z).collect()
    };
    let slots = found.terms.iter().chain((!found.terms.is_empty()).then_some(&found.tail));
    let mut all: Vec<Vec<f64>> = slots.zip(exact).map(|(image, truth)| of(image, &|i| truth[i])).collect();
    all.push(of(&found.total, &|i| exact.iter().map(|slot| slot[i]).sum()));
    all
}
