//! `summary.json`: all results of a run in one versioned file for other programs.
//!
//! Radiances are RGB triples in W·sr⁻¹·m⁻² of the image mean, unless stated otherwise. An *estimate* is
//! `{mean: [r,g,b], std_error: [r,g,b], replicates, events}`. `replicates` is 0 for an exact value, and 1 if the error is
//! not known.
//!
//! `events` is `null` or has three entries. `mean` and `variance` are the numbers of equal contributions that would carry
//! the mean and the variance; `tail` is k̂. If the numbers are small, `std_error` is meaningless
//! ([`crate::stats::evidence`]). A number that is not finite is written as `null` and read back as NaN.
//!
//! | key | meaning |
//! |---|---|
//! | `schema`, `version` | `"fredholm-summary"` and 1; a reader refuses any other |
//! | `command` | the command that reproduces this result |
//! | `scene`, `scene_hash` | name and hash of the scene as loaded |
//! | `seed`, `spp`, `max_bounces` | seed, samples per pixel, K: the terms are k = 0..=K |
//! | `threads`, `seconds` | worker threads and wall-clock seconds; the results do not depend on them |
//! | `width`, `height` | pixels |
//! | `terms` | per k: `k`, `mean`, `std_error`, `variance` (of one sample, averaged over the pixels), `ratio` (`mean` divided by the mean of term k − 1; `null` for k = 0), `rays` (traced for this k) |
//! | `tail` | estimate: everything longer than K; all `null` with `replicates` 0 where paths are cut at K (`--roulette none`) |
//! | `sum` | estimate: Σ_{k≤K} of the terms |
//! | `path` | estimate of the whole image by the path tracer, or `null` |
//! | `radiosity` | results of the matrix, or `null`: `patches`, `terms` (triples), `sum`, `full` (the solution of the linear system), `spectral_radius` per channel, `spectral_radius_limit` and its `…_error` (h → 0, from three meshes), `norms` (k, 1-, 2- and 1/ρ-weighted norm of T_h^k E over the patches), `unlit_sides` (never reached by light, left out of T), `discretisation` (absolute difference to a mesh of a quarter as many patches) |
//! | `bounds` | `max_albedo` per channel (the guarantee ‖T‖₁ ≤ max albedo), `observed_rate` and `observed_rate_error` (fitted, no guarantee; `observed_rates`, `observed_rate_errors` per channel), `tail_bound` (a-posteriori bound of the surface norm beyond K) |
//! | `bounces` | how many bounces are enough: per `light` (`all`, `indirect`) and fraction `missing`, the smallest and largest K by measurement in the `picture` and over the `surfaces`, and the K that the albedo has `guaranteed` |
//! | `surfaces` | per surface `name`, `area` (m²) and `shares` of k = 1, …, 5 and of longer paths in the light that it reflects |
//! | `cross_moments` | of paths without roulette up to vertex K, or `null` where none were recorded: `max_bounces` (their own K), `paths`, `beyond` (q from vertex K on), `slots` (per slot `vertex`, `kind` `hit`, `connect` or `tail`, and `term`), `second` and `product` (per channel M_ab and m_ab, rows of numbers), `rays` (per path, by slot); see [`crate::stats::schedule`] for what they predict |
//! | `pixel_errors` | per layer of `terms.exr` with a `_se`: `layer`, `trusted`, `events` (half the pixels have fewer), `why` |
//! | `verdicts` | list of `name`, `effect`, `interval`, `p`, `min_detectable`, `outcome` (`agrees`, `differs`, `inconclusive`) |
//! | `files` | names of the files of this run, relative to this one |
//! | `series` | per world: `world`, `label`, `functionals` (`name`, `terms`, `tail`, `sum`, `total` as estimates; the image mean first, then regions and projections), `cost` (`paths`, `rays`, `non_finite`, `seconds`), `unsampled`, `doubts` (`what`, `from`, `per_path`: expected events per path), `variance` of tail and total (`finite`, `infinite`, `unknown`; unless it is finite their `std_error` is `null`) |

use std::path::Path;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::estimator::Vertices;
use crate::operator::patches::{Patch, Patches};
use crate::report::{
    ReportError, files,
    text::{null_as_nan::NullAsNan, pixel_errors::PixelErrors},
    write_atomically,
};
use crate::stats::{self, Outcome};
use crate::terms::{Estimate, Recorded, Series};

/// Name of the schema.
pub const SCHEMA: &str = "fredholm-summary";
/// Version of the schema written and read.
pub const VERSION: u32 = 1;

/// The contents of `summary.json`. The keys are explained in the [module documentation](self).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Summary {
    pub schema: String,
    pub version: u32,
    pub command: String,
    pub scene: String,
    pub scene_hash: String,
    pub seed: u64,
    pub spp: u64,
    pub max_bounces: usize,
    pub threads: usize,
    pub seconds: f64,
    pub width: usize,
    pub height: usize,
    pub terms: Vec<Term>,
    pub tail: Estimate,
    pub sum: Estimate,
    pub path: Option<Estimate>,
    pub radiosity: Option<Radiosity>,
    pub bounds: Bounds,
    /// How many bounces are enough.
    #[serde(default)]
    pub bounces: Vec<Bounces>,
    /// Which bounce lights which surface.
    #[serde(default)]
    pub surfaces: Vec<Surface>,
    pub cross_moments: Option<serde_json::Value>,
    #[serde(default)]
    pub pixel_errors: Vec<PixelErrors>,
    pub verdicts: Vec<VerdictRecord>,
    pub files: Vec<String>,
    pub series: Vec<Series>,
}

impl Default for Summary {
    fn default() -> Self {
        Self {
            schema: SCHEMA.into(),
            version: VERSION,
            command: String::new(),
            scene: String::new(),
            scene_hash: String::new(),
            seed: 0,
            spp: 0,
            max_bounces: 0,
            threads: 0,
            seconds: 0.0,
            width: 0,
            height: 0,
            terms: Vec::new(),
            tail: Estimate::default(),
            sum: Estimate::default(),
            path: None,
            radiosity: None,
            bounds: Bounds::default(),
            bounces: Vec::new(),
            surfaces: Vec::new(),
            cross_moments: None,
            pixel_errors: Vec::new(),
            verdicts: Vec::new(),
            files: Vec::new(),
            series: Vec::new(),
        }
    }
}

/// One term of the image mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// Applications of T.
    pub k: usize,
    /// Mean over the image.
    pub mean: DVec3,
    /// Standard error of `mean`; NaN if not known.
    pub std_error: DVec3,
    /// Variance of one sample, averaged over the pixels; NaN if not known.
    pub variance: DVec3,
    /// `mean` divided by the mean of term k − 1; NaN for k = 0.
    pub ratio: DVec3,
    /// Rays traced for this term.
    pub rays: u64,
}

/// The rows of a series. The ratios are computed from the means.
///
/// `variance` and `rays` have one value per k. Missing values become NaN and 0.
pub fn terms(estimates: &[Estimate], variance: &[DVec3], rays: &[u64]) -> Vec<Term> {
    let row = |(k, e): (usize, &Estimate)| Term {
        k,
        mean: e.mean,
        std_error: e.std_error,
        variance: variance.get(k).copied().unwrap_or(DVec3::NAN),
        ratio: if k == 0 { DVec3::NAN } else { e.mean / estimates[k - 1].mean },
        rays: rays.get(k).copied().unwrap_or(0),
    };
    estimates.iter().enumerate().map(row).collect()
}

/// Results of the matrix.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Radiosity {
    /// Number of patches.
    pub patches: usize,
    /// Image means of the terms.
    pub terms: Vec<DVec3>,
    /// Sum of the terms k = 0..=K.
    pub sum: DVec3,
    /// Image mean of the solution of L = E + T_h L.
    pub full: DVec3,
    /// Spectral radius of T_h, per channel.
    pub spectral_radius: DVec3,
    /// The spectral radius extrapolated to h → 0 from three meshes; NaN if not known.
    #[serde(default = "not_known")]
    pub spectral_radius_limit: DVec3,
    /// Half width of the error of this extrapolation. It is an estimate, not a bound.
    #[serde(default = "not_known")]
    pub spectral_radius_limit_error: DVec3,
    /// Norms of T_h^k E over the patches, k = 0..=K.
    #[serde(default)]
    pub norms: Vec<BounceNorms>,
    /// Number of surface sides that light never reaches. T and its spectral radius do not contain them.
    #[serde(default)]
    pub unlit_sides: usize,
    /// |R_h − R_2h| of the image mean R: an estimate of the mesh error.
    pub discretisation: DVec3,
}

fn not_known() -> DVec3 {
    DVec3::NAN
}

/// Norms of one term over the surfaces, per channel; radiance in W sr⁻¹ m⁻².
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BounceNorms {
    /// Applications of T.
    pub k: usize,
    /// ‖x‖₁ = Σ Aᵢ |xᵢ|.
    pub norm_1: DVec3,
    /// ‖x‖₂ = √Σ Aᵢ xᵢ².
    pub norm_2: DVec3,
    /// ‖x‖_w = √Σ Aᵢ xᵢ²/ρᵢ over the patches with ρ > 0: in this norm the ratios of successive terms never decrease.
    pub norm_w: DVec3,
}

/// The norms of every term, from the radiance of every patch.
pub fn bounce_norms(patches: &Patches, terms: &[Vec<DVec3>]) -> Vec<BounceNorms> {
    let norms = |(k, term): (usize, &Vec<DVec3>)| {
        let sum = |f: &dyn Fn(&Patch, DVec3) -> DVec3| patches.iter().zip(term).map(|(p, x)| f(p, *x)).sum::<DVec3>();
        BounceNorms {
            k,
            norm_1: sum(&|p, x| p.area * x.abs()),
            norm_2: sum(&|p, x| p.area * x * x).powf(0.5),
            norm_w: sum(&|p, x| {
                DVec3::select(p.reflectance.cmpgt(DVec3::ZERO), p.area * x * x / p.reflectance, DVec3::ZERO)
            })
            .powf(0.5),
        }
    };
    terms.iter().enumerate().map(norms).collect()
}

/// Bounds and rates of the decay of the terms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Bound of ‖T‖₁ per channel: the largest albedo.
    pub max_albedo: DVec3,
    /// Rate fitted to the surface norms; NaN if not fitted.
    pub observed_rate: f64,
    /// Standard error of `observed_rate`.
    pub observed_rate_error: f64,
    /// The same rate per channel; NaN if not fitted.
    #[serde(default = "not_known")]
    pub observed_rates: DVec3,
    /// Their standard errors.
    #[serde(default = "not_known")]
    pub observed_rate_errors: DVec3,
    /// Bound of the tail: g/(1−g) ‖T^K E‖₁ with g = max albedo; NaN if g = 1.
    pub tail_bound: DVec3,
}

impl Default for Bounds {
    fn default() -> Self {
        let unknown = f64::NAN;
        Self {
            max_albedo: DVec3::NAN,
            observed_rate: unknown,
            observed_rate_error: unknown,
            observed_rates: DVec3::NAN,
            observed_rate_errors: DVec3::NAN,
            tail_bound: DVec3::NAN,
        }
    }
}

/// How many bounces are enough for one fraction of the light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounces {
    /// `all` light or `indirect` light (k ≥ 2).
    pub light: String,
    /// The fraction that may be missing.
    pub missing: f64,
    /// Smallest and largest K that the noise allows, in the picture; `null`: more than 100.
    pub picture: [Option<usize>; 2],
    /// The same over all surfaces.
    pub surfaces: [Option<usize>; 2],
    /// The K that the largest albedo guarantees over all surfaces; `null`: it guarantees nothing.
    pub guaranteed: Option<usize>,
}

/// The light that one surface reflects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Its name.
    pub name: String,
    /// Area of its sides that take part in light transport, m².
    pub area: f64,
    /// Shares of k = 1, …, 5 and of everything longer in the light that it reflects; NaN if not known.
    pub shares: Vec<f64>,
}

/// The moments of [`Vertices`] as the value of the key `cross_moments`. `beyond` is q from vertex K on.
pub fn cross_moments(recorded: &Recorded, beyond: f64) -> serde_json::Value {
    let m = &recorded.all;
    let last = m.slots.saturating_sub(1);
    let kind = |a: usize| match a {
        _ if a == last => "tail",
        _ if a.is_multiple_of(2) => "hit",
        _ => "connect",
    };
    let slot =
        |a: usize| serde_json::json!({"vertex": Vertices::vertex(a), "kind": kind(a), "term": Vertices::term(a)});
    let rows = |channel: &Vec<f64>| channel.chunks(m.slots.max(1)).map(<[f64]>::to_vec).collect::<Vec<_>>();
    serde_json::json!({
        "max_bounces": last / 2,
        "paths": recorded.paths,
        "beyond": beyond,
        "slots": (0..m.slots).map(slot).collect::<Vec<_>>(),
        "second": m.second.each_ref().map(rows),
        "product": m.product.each_ref().map(rows),
        "rays": m.rays,
    })
}

/// One comparison and its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VerdictRecord {
    /// Name of the comparison, such as `T3: terms − radiosity`.
    pub name: String,
    /// The difference that was measured.
    pub effect: f64,
    /// Interval of the difference at the declared level.
    pub interval: (f64, f64),
    /// p-value of no difference.
    pub p: f64,
    /// The smallest difference that the comparison would have found.
    pub min_detectable: f64,
    /// The verdict.
    pub outcome: Outcome,
}

impl VerdictRecord {
    /// The record of a verdict, under a given name.
    pub fn of(name: String, v: &stats::Verdict) -> Self {
        let (effect, interval, p, outcome) = (v.effect, v.interval, v.p, v.outcome);
        Self { name, effect, interval, p, min_detectable: v.min_detectable, outcome }
    }
}

/// The records of a comparison with the given name. If the name is empty, each record names the functional that was
/// compared.
pub fn verdicts(name: &str, comparison: &stats::Comparison) -> Vec<VerdictRecord> {
    let words = |v: &stats::Verdict| match name {
        "" => format!("{} ({})", v.name, v.functional),
        name => format!("{}: {name}", v.name),
    };
    comparison.rows.iter().map(|v| VerdictRecord::of(words(v), v)).collect()
}

/// Writes the summary, indented, with a final newline.
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, summary: &Summary) -> Result<(), ReportError> {
    let mut text = serde_json::to_string_pretty(summary)
        .map_err(|e| ReportError::new(path, e, "this is a defect of the program: please report it"))?;
    text.push('\n');
    write_atomically(path, text.as_bytes())
}

/// Reads a summary back.
///
/// # Errors
/// If the file cannot be read, is not JSON, has another schema or version, lacks a key, or has a series without its image mean.
pub fn read(path: &Path) -> Result<Summary, ReportError> {
    let wrong = |cause: String, help: &str| ReportError::new(path, cause, help);
    let value: serde_json::Value = serde_json::from_slice(&files::read(path)?)
        .map_err(|e| wrong(format!("not valid JSON: {e}"), "give the summary.json of a finished run"))?;
    match value.get("schema").and_then(|s| s.as_str()) {
        Some(SCHEMA) => {}
        Some(other) => {
            let cause = format!("the schema is `{other}` instead of `{SCHEMA}`");
            return Err(wrong(cause, "give a summary.json written by fredholm"));
        }
        None => {
            return Err(wrong(format!("no key `schema` = `{SCHEMA}`"), "give a summary.json written by fredholm"));
        }
    }
    match value.get("version").and_then(serde_json::Value::as_u64) {
        Some(v) if v == u64::from(VERSION) => {}
        Some(v) => {
            let cause = format!("version {v} of the schema; this program reads version {VERSION}");
            return Err(wrong(cause, "repeat the run with this program, or read the file with the one that wrote it"));
        }
        None => return Err(wrong("no key `version`".into(), "give a summary.json written by fredholm")),
    }
    let summary = Summary::deserialize(NullAsNan(value))
        .map_err(|e| wrong(format!("not a complete summary: {e}"), "repeat the run that wrote it"))?;
    match summary.series.iter().find(|s| s.functionals.is_empty()) {
        Some(s) => {
            let cause = format!("the result `{}` of `series` has no functional: the image mean is missing", s.world);
            Err(wrong(cause, "repeat the run that wrote it"))
        }
        None => Ok(summary),
    }
}
