//! The members of the zoo as candidates: every member renders the scene of the suspect, once per number of samples.
//!
//! The seed differs from the one that the zoo command uses. With the same random numbers, a suspect made by that command
//! would agree too well with its own simulation.

use super::elimination::Simulate;
use super::picture::Pictures;
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
    progress: Progress<'a>,
    made: Mutex<BTreeMap<(String, u32), Pictures>>,
    shown: Mutex<Option<Vec<String>>>,
}

/// Samples per pixel of the trial in which a member is compared with the correct renderer.
const TRIAL: u32 = 8;

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
            progress: progress.silent(),
            made: Mutex::new(BTreeMap::new()),
            shown: Mutex::new(None),
        }
    }
}

impl Members<'_> {
    /// Returns true if a member differs from the correct renderer in any pixel when both use the same random numbers.
    fn shows(&self, bug: &zoo::Bug) -> bool {
        let settings = Settings { spp: TRIAL, ..self.settings.clone() };
        let plan = bug.plan(&settings);
        let render = |mistake| zoo::of(&plan, mistake, "trial", self.scene, &settings, self.progress);
        let (wrong, right) = (render(bug.mistake), render(&zoo::Right));
        let means = |s: &Sampled| s.terms.iter().chain([&s.tail, &s.total]).map(|i| i.mean.clone()).collect::<Vec<_>>();
        means(&wrong) != means(&right)
    }
}

impl Simulate for Members<'_> {
    /// The members whose mistake this scene can show: with the same random numbers they differ from the correct renderer.
    fn names(&self) -> Vec<String> {
        let mut shown = self.shown.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let all = || zoo::all().into_iter().filter(|bug| self.shows(bug)).map(|bug| bug.name.to_owned()).collect();
        shown.get_or_insert_with(all).clone()
    }

    fn pictures(&self, name: &str, spp: u32) -> Option<Pictures> {
        let key = (name.to_owned(), spp);
        let mut made = self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(pictures) = made.get(&key) {
            return Some(pictures.clone());
        }
        let settings = Settings { spp, ..self.settings.clone() };
        let render = zoo::render(zoo::find(name)?, self.scene, &settings, self.progress);
        if self.progress.stopped() {
            return None;
        }
        let pictures = Pictures::of(&render, self.scene.camera.size);
        made.insert(key, pictures.clone());
        Some(pictures)
    }
}
