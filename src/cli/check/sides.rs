//! The two sides of `check bias`: estimators by name or a finished run, and the combinations that are refused.

use super::bias_args::Bias;
use crate::cli::base::{Failure, usage};
use crate::cli::preflight;
use fredholm::engine::Settings;
use fredholm::engine::batches::Side;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::names::list;
use fredholm::report::text::summary;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::terms::{Series, World};
use std::path::PathBuf;

/// The side with which the first one is compared: an estimator, or a finished run.
pub(super) enum Against {
    Rendered(Side),
    Finished(Box<Series>),
}

/// A side by the name of its estimator, with `spp` samples per pixel in a batch.
pub(super) fn side(
    args: &Bias,
    name: &str,
    technique: Technique,
    sampling: Sampling,
    roulette: Option<Roulette>,
    spp: u32,
) -> Result<Side, Failure> {
    let max_bounces = usize::from(args.max_bounces);
    let usual = Roulette::Albedo { from: 2 };
    let settings = Settings {
        spp,
        seed: args.common.seed,
        max_bounces,
        technique,
        sampling,
        roulette: roulette.clone().unwrap_or_else(|| usual.clone().after(max_bounces)),
        path_roulette: roulette.unwrap_or(usual),
        ..Settings::default()
    };
    let estimator = match name {
        "path" => None,
        name => {
            let unknown = |_| {
                let names = list(Estimator::ALL.map(Estimator::name));
                usage(
                    &format!("`{name}` is no estimator, and no folder of a finished run"),
                    &format!("name one of {names}, path, or a folder with a summary.json"),
                )
            };
            Some(name.parse::<Estimator>().map_err(unknown)?.with_children(args.branching))
        }
    };
    Ok(Side { estimator, settings })
}

/// The series of a finished run and the size of its image.
pub(super) type FinishedRun = (Box<Series>, [u32; 2]);

/// The finished run that `--against` names; `None` if it names an estimator.
pub(super) fn finished(args: &Bias) -> Result<Option<FinishedRun>, Failure> {
    let path = PathBuf::from(&args.against);
    let file = if path.is_dir() { path.join("summary.json") } else { path };
    if !file.is_file() {
        return Ok(None);
    }
    let run = summary::read(&file)?;
    let size = [run.width, run.height].map(|s| s as u32);
    if args.common.size.is_some_and(|asked| asked != size) {
        let [w, h] = size;
        return Err(usage(&format!("the finished run has {w}×{h} pixels"), "leave --size out"));
    }
    let mut series = run.series;
    // the terms first, because they allow a verdict on each of them
    series.sort_by_key(|s| [World::Terms, World::Path, World::Radiosity].iter().position(|w| *w == s.world));
    match series.into_iter().next() {
        Some(series) if series.world != World::Radiosity => Ok(Some((Box::new(series), size))),
        _ => {
            let help =
                "a radiosity matrix has a discretisation error, which batches do not measure: use `fredholm compare`";
            Err(usage(&format!("{} holds no sampled result", file.display()), help))
        }
    }
}

impl Against {
    pub(super) fn label(&self) -> String {
        match self {
            Self::Rendered(side) => side.label(),
            Self::Finished(series) => format!("{}, finished before", series.label),
        }
    }

    pub(super) fn limits(&self, scene: &Scene) -> Option<Series> {
        match self {
            Self::Rendered(side) => Some(side.limits(scene)),
            Self::Finished(series) => Some(Series { functionals: vec![], ..(**series).clone() }),
        }
    }
}

/// Refuses estimators that cannot find the light of the scene.
pub(super) fn check_sides(scene: &Scene, first: &Side, against: &Against) -> Result<(), Failure> {
    preflight::can_be_sampled(scene, first.estimator, &first.settings)?;
    match against {
        Against::Rendered(side) => preflight::can_be_sampled(scene, side.estimator, &side.settings),
        Against::Finished(_) => Ok(()),
    }
}
