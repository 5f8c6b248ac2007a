//! What `sweep` takes.

use crate::cli::base::{Failure, usage};
use crate::cli::options::{Frame, Shared, among, duration, grading, one_of, values};
use crate::cli::preflight::needs_no_guide;
use clap::{Args, ValueEnum};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Estimator;
use fredholm::engine::discretisation::Form;
use fredholm::engine::guided::Guiding;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::math::names::list;
use fredholm::scene::{Selection, bsdf::Sampling};
use fredholm::study::roulette::Schedule;
use fredholm::terms::World;
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// A setting that can be swept over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Over {
    /// Children of every vertex
    Branching,
    /// Samples per pixel
    Spp,
    /// How light is found
    Technique,
    /// How directions are drawn
    Sampling,
    /// How the terms are estimated
    Estimator,
    /// How the samples of a pixel lie
    Points,
    /// How paths end
    Roulette,
    /// How fine the mesh of the matrix is
    Patches,
    /// Where the samples of separate terms go
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
    /// branching, spp, split, technique, … (all: --help)
    ///
    /// branching, spp, split, technique, sampling, estimator, points, roulette or patches
    #[arg(long, value_enum, value_name = "SETTING", hide_possible_values = true)]
    pub over: Over,
    /// Its values, with commas
    ///
    /// With --over spp the numbers of samples to look at: multiples of 16.
    /// [default: 1,2,3,4; 16,32,64,…; scatter,connect,mis,mis-power; uniform,cosine,bsdf;
    /// prefix,single,branching,light,bidirectional; independent,sobol;
    /// none,lecture,albedo; 38,150,600,2400]
    #[arg(long, visible_alias = "schedules", value_name = "V,…", verbatim_doc_comment)]
    pub values: Option<String>,
    /// Give every value the rays of the dearest, instead of the same spp
    #[arg(long)]
    pub equal_rays: bool,
    /// With --over spp: squared error against a run's folder, or a render of so many samples
    ///
    /// Its own variance is subtracted, so that the squared error is unbiased.
    /// A render of its own has another stream.
    #[arg(long, value_name = "DIR|SPP", verbatim_doc_comment)]
    pub reference: Option<String>,
    /// With --over patches: the N largest and the N most negative eigenvalues on every mesh
    ///
    /// Of the channel with the largest spectral radius. Also written: eigenvalues.csv, .svg, .png.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=16), verbatim_doc_comment)]
    pub eigenvalues: Option<u16>,
    /// Samples of the pilot of --over split [default: a quarter of --spp]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=1 << 24))]
    pub pilot: Option<u32>,
    /// Estimator of the terms: prefix, single, light, … [default: prefix]
    ///
    /// With --over spp a list, in which `path` is the full path tracer.
    #[arg(long = "estimator", value_name = "NAME,…", verbatim_doc_comment)]
    pub estimators: Option<String>,
    /// How light is found.
    #[arg(long = "technique", value_name = "NAME,…", help = usual("How light is found", Technique::ALL, "mis"),
        long_help = usual("How light is found", Technique::ALL, "mis") + "\n\nWith --over spp a list.")]
    pub techniques: Option<String>,
    /// Russian roulette: none, lecture, constant:Q@V, … (all: series --help)
    ///
    /// With --over spp a list. [default: none for k ≤ K, then albedo]
    #[arg(long = "roulette", value_name = "SCHEDULE,…", verbatim_doc_comment)]
    pub schedules: Option<String>,
    /// How samples lie in a pixel.
    #[arg(long = "points", value_name = "NAME,…", help = usual("How samples lie in a pixel", Points::ALL, "independent"),
        long_help = usual("How samples lie in a pixel", Points::ALL, "independent") + "\n\nWith --over spp a list.")]
    pub spreads: Option<String>,
    /// What is rendered.
    #[command(flatten)]
    pub frame: Frame,
    /// With --estimator bidirectional: every strategy apart
    ///
    /// Writes strategies.png, strategies-alone.png and strategies.exr, and prints a table:
    /// for each term, what is found with s = 0 to k + 1 vertices walked from the light.
    #[arg(long, verbatim_doc_comment)]
    pub strategies: bool,
    /// Children of every vertex of --estimator branching
    ///
    /// Term k takes N^k rays.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub branching: u32,
    /// How a light is selected.
    #[arg(long, default_value_t = Selection::Uniform, value_name = "NAME", help = among("How a light is selected", Selection::ALL))]
    pub lights: Selection,
    /// How directions are drawn.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help = among("How directions are drawn", Sampling::ALL))]
    pub sampling: Sampling,
    /// What is refused, or is for matrices.
    #[command(flatten)]
    pub aside: Aside,
    /// Scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

/// Options of `series` that a sweep knows only to refuse them, or that are for --over patches.
#[derive(Clone, Debug, Args)]
pub struct Aside {
    #[arg(long, hide = true, value_name = "G", default_value_t = 1.0, value_parser = grading)]
    pub grading: f64,
    #[arg(long, hide = true)]
    pub read_patches: bool,
    #[arg(long, hide = true, value_name = "NAME", default_value_t = Guiding::Bsdf, value_parser = one_of::<Guiding>(Guiding::ALL))]
    guide: Guiding,
    #[arg(long, hide = true, value_name = "TIME", value_parser = duration, conflicts_with = "spp")]
    time: Option<Duration>,
    #[arg(long, hide = true, value_name = "WORLD,…", value_delimiter = ',', value_parser = one_of::<World>(World::ALL))]
    worlds: Vec<World>,
    #[arg(long, hide = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2_000_000))]
    patches: Option<u32>,
    #[arg(long, hide = true, value_name = "HOW", value_parser = one_of::<Form>(Form::ALL))]
    factors: Option<Form>,
    #[arg(long, hide = true, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=65_536))]
    rays: Option<u32>,
    #[arg(long, hide = true)]
    orders: bool,
}

/// Help for an option with one usual value.
fn usual(what: &str, names: impl IntoIterator<Item: fmt::Display>, value: &str) -> String {
    format!("{} [default: {value}]", among(what, names))
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
    /// K, where nothing is said 8, and 4 where the setting makes trees.
    pub fn max_bounces(&self) -> usize {
        self.frame.max_bounces.unwrap_or(if self.over == Over::Branching { 4 } else { 8 }).into()
    }

    /// The settings that are no lists, with the usual schedules.
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

    /// The options that may be lists, where they may not be.
    pub fn one_of_each(&self) -> Result<One, Failure> {
        fn one<T>(
            name: &str,
            list: Option<&String>,
            parse: impl Fn(&str) -> Result<T, String>,
        ) -> Result<Option<T>, Failure> {
            let Some(list) = list else { return Ok(None) };
            if values(list).len() > 1 {
                let what = format!("{name} takes one value here, not `{list}`");
                return Err(usage(&what, "lists are for --over spp; elsewhere the list is --values"));
            }
            parse(list).map(Some).map_err(|why| usage(&why, &format!("give {name} one of them")))
        }
        let of_terms = |s: &str| match estimator(s, self.branching)? {
            Some(estimator) => Ok(estimator),
            None => Err("`path` has one value for all terms, and is for --over spp".into()),
        };
        let schedule = one("--roulette", self.schedules.as_ref(), Schedule::from_str)?;
        needs_no_guide(schedule.as_ref())?;
        Ok(One {
            estimator: one("--estimator", self.estimators.as_ref(), of_terms)?.unwrap_or(Estimator::Prefix),
            technique: one("--technique", self.techniques.as_ref(), Technique::from_str)?.unwrap_or(Technique::Mis),
            roulette: schedule,
            points: one("--points", self.spreads.as_ref(), Points::from_str)?.unwrap_or_default(),
        })
    }

    /// Options that a sweep of the terms would silently ignore.
    pub fn refuse_what_has_no_part(&self) -> Result<(), Failure> {
        let aside = &self.aside;
        let given = [
            ("--worlds", !aside.worlds.is_empty()),
            ("--patches", aside.patches.is_some()),
            ("--read-patches", aside.read_patches),
            ("--orders", aside.orders),
            ("--strategies", self.strategies),
            ("--guide", aside.guide != Guiding::Bsdf),
            ("--time", aside.time.is_some()),
        ];
        if let Some((name, _)) = given.iter().find(|g| g.1) {
            return Err(usage(&format!("{name} has no part in a sweep, which renders the terms"), "leave it out"));
        }
        let (spp, split) = (self.over == Over::Spp, self.over == Over::Split);
        let refused = [
            (
                self.eigenvalues.is_some() || aside.grading != 1.0,
                "--eigenvalues and --grading are for matrices",
                "leave them out, or use --over patches",
            ),
            (
                self.equal_rays && spp,
                "--equal-rays would make every spp the same",
                "leave it out, or sweep something else",
            ),
            (
                self.equal_rays && split,
                "--over split gives every way about the same rays already",
                "leave --equal-rays out",
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
