//! The reference images of a sweep over spp: a finished run, or a separate render.

use super::args::Sweep;
use crate::cli::base::{Failure, usage};
use crate::cli::preflight;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::engine::known::unsampled::unsampled;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::progress::Progress;
use fredholm::report::image::exr;
use fredholm::report::text::summary;
use fredholm::scene::{Description, Scene};
use fredholm::study::convergence::Reference;
use fredholm::study::stages::reference_seed;
use fredholm::terms::{TermImage, World};
use std::path::Path;

/// The source of a reference.
pub enum Planned {
    Read(Box<Reference>),
    Render(Estimator, Settings),
}

impl Planned {
    /// The reference, rendered if it must be.
    pub fn have(self, scene: &Scene, progress: Progress<'_>) -> Reference {
        match self {
            Self::Read(reference) => *reference,
            Self::Render(estimator, settings) => {
                let result = by_rays::terms(scene, estimator, &settings, progress.named("reference"));
                let mut reference = Reference::from(result);
                reference.label = format!("{}, {} spp, seed {}", reference.label, settings.spp, settings.seed);
                reference
            }
        }
    }
}

/// The reference that `--reference` asks for. Refuses one that is not possible before anything is rendered.
pub fn plan(
    args: &Sweep,
    scene: &Scene,
    description: &Description,
    settings: &Settings,
) -> Result<Option<Planned>, Failure> {
    let Some(text) = &args.reference else { return Ok(None) };
    if let Ok(spp) = text.parse::<u32>() {
        if !(16..=1 << 24).contains(&spp) {
            return Err(usage(&format!("a reference of {spp} samples has no error of its own"), "give it at least 16"));
        }
        let roulette = Roulette::Albedo { from: 2 }.after(settings.max_bounces);
        let settings = Settings {
            spp,
            seed: reference_seed(settings.seed),
            technique: Technique::Mis,
            points: Points::Independent,
            roulette,
            ..settings.clone()
        };
        preflight::light_is_lost(scene, &settings, &[World::Terms])?;
        let all = [Estimator::Prefix, Estimator::Bidirectional, Estimator::Light];
        let sees = all.into_iter().find(|&e| unsampled(scene, Some(e), settings.technique).is_empty());
        let Some(estimator) = sees else {
            return Err(usage("no estimator sees all light of this scene", "leave --reference out"));
        };
        return Ok(Some(Planned::Render(estimator, settings)));
    }
    finished(text, description, settings).map(|found| Some(Planned::Read(Box::new(found))))
}

/// A finished run of the same scene.
fn finished(text: &str, description: &Description, settings: &Settings) -> Result<Reference, Failure> {
    let folder = Path::new(text);
    let known = summary::read(&folder.join("summary.json"))?;
    let help = |what: String, help: &str| Failure::Input(format!("error: {what}\n  --> {text}\nhelp: {help}"));
    let [w, h] = description.camera.size.map(|s| s as usize);
    if (known.width, known.height, known.scene.as_str()) != (w, h, description.name.as_str()) {
        let what = format!(
            "the reference is {}, {}×{}; this is {}, {w}×{h}",
            known.scene, known.width, known.height, description.name
        );
        return Err(help(what, "render both with the same scene and --size"));
    }
    if known.max_bounces != settings.max_bounces {
        let what = format!("the reference keeps k ≤ {}, this run k ≤ {}", known.max_bounces, settings.max_bounces);
        return Err(help(what, "render both with the same --max-bounces: their tails differ"));
    }
    if known.seed == settings.seed {
        let what = format!("the reference has seed {}, too: its noise would be this run's own", known.seed);
        return Err(help(what, "give one of them another --seed"));
    }
    let image = exr::read(&folder.join("terms.exr"))?;
    let layer = |name: &str| {
        let mean = image.layer(name)?.to_vec();
        Some(TermImage { mean, std_error: image.layer(&format!("{name}_se"))?.to_vec() })
    };
    let terms: Option<Vec<TermImage>> = (0..=known.max_bounces).map(|k| layer(&format!("T{k:02}"))).collect();
    let (Some(terms), Some(total)) = (terms, layer("Tall").or_else(|| layer("Tsum"))) else {
        return Err(help("terms.exr does not hold the terms".into(), "make it with `fredholm series`"));
    };
    let label = format!("{text}, {} spp, seed {}", known.spp, known.seed);
    Ok(Reference { label, terms, tail: layer("tail"), total })
}
