//! The values of a sweep, each with its settings.

use super::args::{Over, Sweep};
use crate::cli::base::{Failure, usage};
use crate::cli::options::{number, values};
use crate::cli::suggest::question;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Estimator;
use fredholm::study::roulette::{Aim, Schedule};

/// One value of the setting.
pub struct Case {
    pub value: String,
    pub estimator: Estimator,
    pub settings: Settings,
    /// The quantity for which the best schedule must first be found; None if the schedule is given.
    pub optimal: Option<Aim>,
}

/// The default values of each setting.
fn usual(over: Over) -> &'static str {
    match over {
        Over::Branching => "1,2,3,4",
        Over::Technique => "scatter,connect,mis,mis-power",
        Over::Sampling => "uniform,cosine,bsdf",
        Over::Estimator => "prefix,single,branching,light,bidirectional",
        Over::Points => "independent,sobol",
        Over::Roulette => "none,lecture,albedo",
        Over::Spp | Over::Split | Over::Patches => "", // sweeps of their own
    }
}

/// The values that were asked for, or the default ones, each with its settings.
pub fn cases(args: &Sweep) -> Result<Vec<Case>, Failure> {
    let (one, mut common) = (args.one_of_each()?, args.settings(if args.over == Over::Branching { 32 } else { 256 }));
    (common.points, common.technique) = (one.points, one.technique);
    if let Some(given) = one.roulette.as_ref().and_then(Schedule::given) {
        common.roulette = given;
    }
    let case = |value: String| {
        let optimal = one.roulette.as_ref().and_then(Schedule::aim);
        let mut case = Case { value, estimator: one.estimator, settings: common.clone(), optimal };
        let help = || format!("values of --over {} are such as --values {}", args.over, usual(args.over));
        let asked =
            || question(&format!("--{}", args.over), &case.value, &usual(args.over).split(',').collect::<Vec<_>>());
        let asked = asked().map_or(String::new(), |q| q + "\n      ");
        case.set(args.over, args.branching).map_err(|why| usage(&why, &(asked + &help())))?;
        Ok(case)
    };
    values(args.values.as_deref().unwrap_or(usual(args.over))).into_iter().map(case).collect()
}

impl Case {
    /// Sets what is swept over to its value.
    fn set(&mut self, over: Over, children: u32) -> Result<(), String> {
        let value = &self.value;
        match over {
            Over::Branching => self.estimator = Estimator::Branching { children: number(value, 1000)? },
            Over::Spp | Over::Split | Over::Patches => {}
            Over::Technique => self.settings.technique = value.parse()?,
            Over::Sampling => self.settings.sampling = value.parse()?,
            Over::Points => self.settings.points = value.parse()?,
            Over::Roulette => {
                let asked: Schedule = value.parse()?;
                if let Schedule::ByExpectation(end) = asked {
                    return Err(format!("{end} needs a guide, and a sweep has none"));
                }
                self.optimal = asked.aim();
                if let Some(given) = asked.given() {
                    self.settings.roulette = given;
                }
            }
            Over::Estimator => self.estimator = value.parse::<Estimator>()?.with_children(children),
        }
        Ok(())
    }
}
