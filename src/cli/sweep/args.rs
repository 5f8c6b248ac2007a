//! Arguments of `sweep`.

use crate::cli::base::{Failure, usage};
use crate::cli::choices::{Choices, ESTIMATORS, LIGHTS, POINTS, SAMPLINGS, TECHNIQUES, names};
use crate::cli::options::{Frame, HOW, MATRIX, Shared, WHAT, grading, one_of, values};
use crate::cli::preflight::needs_no_guide;
use crate::cli::suggest::wrong_value;
use clap::{Args, ValueEnum};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::math::names::list;
use fredholm::report::figures::sweep::Budget;
use fredholm::scene::{Selection, bsdf::Sampling};
use fredholm::study::roulette::Schedule;
use std::fmt;
use std::str::FromStr;

/// Below `sweep --help`.
pub const HELP: &str = "Examples:
  fredholm sweep furnace --over branching --sampling uniform --spp 64
  fredholm sweep cornell --over technique --max-bounces 4 --size 64x64
  fredholm sweep cornell --over estimator --values prefix,single --equal-rays
  fredholm sweep cornell --over sampling --equal-time
  fredholm sweep cornell --over patches
  fredholm sweep cube --over patches --grading 1.5 --values 96,384,1536
  fredholm sweep cornell --over patches --values 129,516,2064 --eigenvalues 6
  fredholm sweep cornell --over spp --estimator single,prefix,path
  fredholm sweep cornell --over spp --points independent,sobol --reference 4096
  fredholm sweep cornell --over split --max-bounces 6 --size 64x64

--over spp renders once for every combination of --estimator (also path), --technique, --roulette and --points, each of which \
may be a list. Variance and squared error at 16, 32, 64, … samples are measured as the image fills. It writes variance.svg, \
variance.png, sweep.csv and summary.json.

--over split estimates the terms with an equal split of the samples (--estimator single), with the optimal split n ∝ σ/√c (σ is \
the standard deviation of a term, c its cost), and from the prefixes of one path, each with about the same number of rays. \
Variance × cost is predicted by a pilot run and measured. It writes split.csv, covariance.csv, covariance.svg, covariance.png \
and summary.json.

A sweep over branching has 32 samples per pixel and K = 4 by default.

All others write pictures.png, sweep.csv, sweep.svg, sweep.png and summary.json. pictures.png shows the image of every value at \
one exposure, with its noise and its efficiency. V is the variance of one sample, averaged over the pixels. \
1/(V rays) is the efficiency: twice the efficiency means half the rays for the same error.";

/// A setting that can be swept over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Over {
    #[value(help = "children of every vertex: 1,2,3,4")]
    Branching,
    #[value(help = "samples per pixel: 16,32,64,…")]
    Spp,
    #[value(help = "how paths find light: scatter,connect,mis,mis-power")]
    Technique,
    #[value(help = "density of directions: uniform,cosine,bsdf")]
    Sampling,
    #[value(help = "prefix,single,branching,light,bidirectional")]
    Estimator,
    #[value(help = "samples of a pixel: independent,sobol")]
    Points,
    #[value(help = "when paths end: none,lecture,albedo")]
    Roulette,
    #[value(help = "patches of the matrix: 38,150,600,2400")]
    Patches,
    #[value(help = "split of the samples among the terms; no values")]
    Split,
}

impl fmt::Display for Over {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().as_ref().map_or("", |v| v.get_name()))
    }
}

/// Arguments of `sweep`.
#[derive(Clone, Debug, Args)]
pub struct Sweep {
    /// Setting: branching, spp, technique, patches, …
    ///
    /// The setting that is swept over. The values behind each name are the default of --values.
    #[arg(long, value_enum, value_name = "SETTING", help_heading = WHAT)]
    pub over: Over,
    /// Values of the setting, separated by commas
    ///
    /// With --over spp these are the numbers of samples at which errors are measured: multiples of 16. --schedules is another name
    /// for this option.
    #[arg(long, alias = "schedules", value_name = "V,…", help_heading = WHAT)]
    pub values: Option<String>,
    /// Scene, samples, size, K, seed.
    #[command(flatten)]
    pub frame: Frame,
    /// Estimator of the terms [default: prefix]
    ///
    /// One of prefix, single, branching, light, bidirectional. With --over spp it may be a list, in which `path` is the full path
    /// tracer.
    #[arg(long = "estimator", value_name = "NAME,…", help_heading = HOW)]
    pub estimators: Option<String>,
    /// Children of every vertex of the branching estimator
    ///
    /// Term k takes N^k rays.
    #[arg(long, value_name = "N", default_value_t = 2, hide_short_help = true, help_heading = HOW, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub branching: u32,
    /// Light by scatter, connect, mis, … [default: mis]
    ///
    /// One of scatter, connect, mis, mis-power. With --over spp it may be a list.
    #[arg(long = "technique", value_name = "NAME,…", help_heading = HOW)]
    pub techniques: Option<String>,
    /// Roulette: none, lecture, constant:Q@V, albedo, …
    ///
    /// `fredholm series --help` lists the rules. With --over spp it may be a list.
    /// [default: none for k ≤ K, then albedo]
    #[arg(long = "roulette", value_name = "RULE,…", help_heading = HOW)]
    pub schedules: Option<String>,
    /// Points: independent, sobol
    ///
    /// How the samples of a pixel are spread. [default: independent] With --over spp it may be a list.
    #[arg(long = "points", value_name = "NAME,…", help_heading = HOW)]
    pub spreads: Option<String>,
    /// Light choice: uniform or power
    ///
    /// How a connection selects a light.
    #[arg(long, default_value_t = Selection::Uniform, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Selection>(LIGHTS))]
    pub lights: Selection,
    /// Directions: uniform, cosine or bsdf
    ///
    /// The density of the sampled directions at a surface.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Sampling>(SAMPLINGS))]
    pub sampling: Sampling,
    /// Same number of rays for every value
    ///
    /// Gives every value the rays of the most expensive one, in place of the same number of samples.
    #[arg(long, help_heading = HOW)]
    pub equal_rays: bool,
    /// Same time for every value
    ///
    /// Gives every value the samples that fit into the time of the most expensive one, in place of the same number of samples. A
    /// short pilot measures the time of a sample of every value. The numbers of samples, and with them the results, depend on the
    /// machine and its load; they are printed. A render with --spp N repeats a value.
    #[arg(long, help_heading = HOW)]
    pub equal_time: bool,
    /// With --over spp: reference for the squared error
    ///
    /// Either a run's output folder, or a number of samples per pixel for a separate render with independent random numbers. Its
    /// own variance is subtracted, so that the squared error is unbiased.
    #[arg(long, value_name = "DIR|SPP", help_heading = HOW)]
    pub reference: Option<String>,
    /// With --over split: samples of the pilot run
    ///
    /// [default: a quarter of --spp]
    #[arg(long, value_name = "N", hide_short_help = true, help_heading = HOW, value_parser = clap::value_parser!(u32).range(16..=1 << 24))]
    pub pilot: Option<u32>,
    /// With --over patches: N eigenvalues from each end
    ///
    /// The N largest and the N most negative eigenvalues on every mesh, for the channel with the largest spectral radius. Also
    /// writes eigenvalues.csv, eigenvalues.svg and eigenvalues.png.
    #[arg(long, value_name = "N", help_heading = MATRIX, value_parser = clap::value_parser!(u16).range(1..=16))]
    pub eigenvalues: Option<u16>,
    /// With --over patches: as in `radiosity --help`
    ///
    /// How much narrower patches are near edges: 1 (not) to 8.
    #[arg(long, value_name = "G", default_value_t = 1.0, hide_short_help = true, help_heading = MATRIX, value_parser = grading)]
    pub grading: f64,
    /// With --over patches: show patches without gathering
    #[arg(long, hide_short_help = true, help_heading = MATRIX)]
    pub read_patches: bool,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

/// An estimator of the terms by name, or none for the path tracer.
pub fn estimator(text: &str, children: u32) -> Result<Option<Estimator>, String> {
    if text == "path" {
        return Ok(None);
    }
    let wrong = |_| format!("`{text}` is none of {}, path", list(Estimator::ALL.map(Estimator::name)));
    text.parse::<Estimator>().map(|e| Some(e.with_children(children))).map_err(wrong)
}

impl Sweep {
    /// K: by default 8, or 4 in a sweep over branching, where the number of rays grows like N^K.
    pub fn max_bounces(&self) -> usize {
        self.frame.max_bounces.unwrap_or(if self.over == Over::Branching { 4 } else { 8 }).into()
    }

    /// What all values have in common besides the number of samples, if anything.
    pub fn budget(&self) -> Option<Budget> {
        let rays = self.equal_rays.then_some(Budget::Rays);
        rays.or(self.equal_time.then_some(Budget::Time))
    }

    /// The settings that cannot be lists, with the default roulette.
    pub fn settings(&self, spp: u32) -> Settings {
        let (max_bounces, end) = (self.max_bounces(), Roulette::Albedo { from: 2 });
        Settings {
            spp: self.frame.spp.unwrap_or(spp),
            seed: self.frame.seed,
            max_bounces,
            sampling: self.sampling,
            roulette: end.clone().after(max_bounces),
            path_roulette: end,
            ..Settings::default()
        }
    }

    /// The options that are lists in a sweep over spp, for sweeps in which each of them takes one value.
    pub fn one_of_each(&self) -> Result<One, Failure> {
        fn one<T>(
            (name, known): (&str, Choices),
            list: Option<&String>,
            parse: impl Fn(&str) -> Result<T, String>,
        ) -> Result<Option<T>, Failure> {
            let Some(list) = list else { return Ok(None) };
            if values(list).len() > 1 {
                let what = format!("{name} takes one value here, not `{list}`");
                return Err(usage(&what, "lists are for --over spp; elsewhere the list is --values"));
            }
            parse(list).map(Some).map_err(|why| wrong_value(name, list, &why, &names(known)))
        }
        let of_terms = |s: &str| match estimator(s, self.branching)? {
            Some(estimator) => Ok(estimator),
            None => Err("`path` has one value for all terms, and is for --over spp".into()),
        };
        let schedule = one(("--roulette", &[]), self.schedules.as_ref(), Schedule::from_str)?;
        needs_no_guide(schedule.as_ref())?;
        Ok(One {
            estimator: one(("--estimator", ESTIMATORS), self.estimators.as_ref(), of_terms)?
                .unwrap_or(Estimator::Prefix),
            technique: one(("--technique", TECHNIQUES), self.techniques.as_ref(), Technique::from_str)?
                .unwrap_or(Technique::Mis),
            roulette: schedule,
            points: one(("--points", POINTS), self.spreads.as_ref(), Points::from_str)?.unwrap_or_default(),
        })
    }

    /// Refuses options that have no effect on this sweep.
    pub fn refuse_what_has_no_part(&self) -> Result<(), Failure> {
        let (spp, split) = (self.over == Over::Spp, self.over == Over::Split);
        let refused = [
            (
                self.eigenvalues.is_some() || self.grading != 1.0 || self.read_patches,
                "--eigenvalues, --grading and --read-patches are for matrices",
                "leave them out, or use --over patches",
            ),
            (
                self.equal_rays && self.equal_time,
                "--equal-rays and --equal-time exclude each other",
                "choose one of them",
            ),
            (
                (self.equal_rays || self.equal_time) && spp,
                "--equal-rays and --equal-time choose the numbers of samples, which --over spp sweeps over",
                "leave it out, or sweep something else",
            ),
            (
                (self.equal_rays || self.equal_time) && split,
                "--over split gives every way about the same rays already",
                "leave --equal-rays and --equal-time out",
            ),
            (
                self.values.is_some() && split,
                "--over split has no values: it always compares equal, optimal and prefix",
                "leave them out",
            ),
            (self.reference.is_some() && !spp, "--reference is for --over spp", "leave it out, or sweep over spp"),
            (self.pilot.is_some() && !split, "--pilot is for --over split", "leave it out, or sweep over split"),
        ];
        refused.iter().find(|r| r.0).map_or(Ok(()), |(_, what, help)| Err(usage(what, help)))
    }
}

/// One value of each option that may be a list.
pub struct One {
    pub estimator: Estimator,
    pub technique: Technique,
    pub roulette: Option<Schedule>,
    pub points: Points,
}
