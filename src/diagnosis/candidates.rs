//! The members of the zoo as candidates: every member renders the scene of the suspect, once per number of samples.
//!
//! The seed differs from the one that the zoo command uses. With the same random numbers, a suspect made by that command
//! would agree too well with its own simulation.

use super::elimination::Simulate;
use super::picture::Pictures;
use super::variants::{self, Variant};
use crate::engine::Settings;
use crate::engine::by_rays::Sampled;
use crate::math::fnv1a;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::zoo;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The members of the zoo, rendered in one scene. Pictures are cached, so that several suspects share them.
pub struct Members<'a> {
    scene: &'a Scene,
    settings: Settings,
    variants: Vec<Variant>,
    progress: Progress<'a>,
    made: Mutex<BTreeMap<(String, u32), Pictures>>,
    shown: Mutex<Option<Vec<String>>>,
}

/// Samples per pixel of the trial in which a member is compared with the correct renderer.
const TRIAL: u32 = 2;

/// Seed for renders with which a suspect is compared. It is a hash, so that it differs from seeds that users type.
pub fn own_seed(seed: u64) -> u64 {
    fnv1a(b"diagnosis".iter().copied().chain(seed.to_le_bytes()))
}

impl<'a> Members<'a> {
    /// Members in this scene, with terms up to the K of the suspect. `progress` is used only to stop early, and shows
    /// nothing.
    pub fn new(scene: &'a Scene, max_bounces: usize, seed: u64, progress: Progress<'a>) -> Self {
        let settings = Settings::default();
        let after = settings.path_roulette.clone().after(max_bounces);
        let settings = Settings { max_bounces, roulette: after, seed: own_seed(seed), ..settings };
        Self {
            scene,
            settings,
            variants: variants::all(),
            progress: progress.silent(),
            made: Mutex::new(BTreeMap::new()),
            shown: Mutex::new(None),
        }
    }
}

impl Members<'_> {
    /// Renders a member of the zoo or a variant; or, if `right`, the correct renderer with the same plan and random numbers. None if
    /// there is no such mistake.
    fn render(&self, name: &str, settings: &Settings, right: bool) -> Option<Sampled> {
        let variant = self.variants.iter().find(|v| v.name == name);
        let bug = zoo::find(name);
        let plan = match (&variant, bug) {
            (Some(v), _) => v.plan(settings.max_bounces, &settings.roulette),
            (_, Some(bug)) => bug.plan(settings),
            _ => return None,
        };
        let mistake: &dyn zoo::Mistake = match (&variant, bug) {
            _ if right => &zoo::Right,
            (Some(v), _) => &*v.mistake,
            (_, bug) => bug?.mistake,
        };
        Some(zoo::of(&plan, mistake, "diagnosis", self.scene, settings, self.progress))
    }

    /// Returns true if a mistake differs from the correct renderer in any pixel when both use the same random numbers.
    fn shows(&self, name: &str) -> bool {
        let settings = Settings { spp: TRIAL, ..self.settings.clone() };
        let means = |right| {
            let s = self.render(name, &settings, right)?;
            Some(s.terms.iter().chain([&s.tail, &s.total]).map(|i| i.mean.clone()).collect::<Vec<_>>())
        };
        means(false) != means(true)
    }
}

impl Simulate for Members<'_> {
    /// The mistakes that this scene can show: with the same random numbers they differ from the correct renderer.
    fn names(&self) -> Vec<String> {
        let mut shown = self.shown.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let names = || {
            zoo::all().into_iter().map(|bug| bug.name.to_owned()).chain(self.variants.iter().map(|v| v.name.clone()))
        };
        shown.get_or_insert_with(|| names().filter(|name| self.shows(name)).collect()).clone()
    }

    fn what(&self, name: &str) -> String {
        let variant = self.variants.iter().find(|v| v.name == name);
        variant.map(|v| v.what.clone()).or(zoo::find(name).map(|bug| bug.what.to_owned())).unwrap_or_default()
    }

    fn pictures(&self, name: &str, spp: u32) -> Option<Pictures> {
        let key = (name.to_owned(), spp);
        let mut made = self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(pictures) = made.get(&key) {
            return Some(pictures.clone());
        }
        let render = self.render(name, &Settings { spp, ..self.settings.clone() }, false)?;
        if self.progress.stopped() {
            return None;
        }
        let pictures = Pictures::of(&render, self.scene.camera.size);
        made.insert(key, pictures.clone());
        Some(pictures)
    }
}
