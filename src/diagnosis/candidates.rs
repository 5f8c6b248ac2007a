//! The zoo as candidates: every member renders the scene of the suspect, once per number of samples.
//!
//! The seed is not the one that the zoo itself would use: two renders with equal numbers would agree for no good reason.

use super::elimination::Simulate;
use super::picture::Pictures;
use crate::math::fnv1a;
use crate::scene::Scene;
use crate::worlds::{Settings, Unobserved};
use crate::zoo;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// The members of the zoo in one scene; pictures are kept, so that many suspects share them.
pub struct Members<'a> {
    scene: &'a Scene,
    settings: Settings,
    stop: &'a AtomicBool,
    made: Mutex<BTreeMap<(String, u32), Pictures>>,
}

/// A seed for what a suspect is compared with: far from any that people type.
pub fn own_seed(seed: u64) -> u64 {
    fnv1a(b"diagnosis".iter().copied().chain(seed.to_le_bytes()))
}

impl<'a> Members<'a> {
    /// In this scene, with terms up to K as the suspect has them.
    pub fn new(scene: &'a Scene, max_bounces: usize, seed: u64, stop: &'a AtomicBool) -> Self {
        let settings = Settings::default();
        let after = settings.path_roulette.clone().after(max_bounces);
        let settings = Settings { max_bounces, roulette: after, seed: own_seed(seed), ..settings };
        Self { scene, settings, stop, made: Mutex::new(BTreeMap::new()) }
    }
}

impl Simulate for Members<'_> {
    fn names(&self) -> Vec<String> {
        zoo::all().iter().map(|bug| bug.name.to_owned()).collect()
    }

    fn pictures(&self, name: &str, spp: u32) -> Option<Pictures> {
        let key = (name.to_owned(), spp);
        let mut made = self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(pictures) = made.get(&key) {
            return Some(pictures.clone());
        }
        let settings = Settings { spp, ..self.settings.clone() };
        let render = zoo::render(zoo::find(name)?, self.scene, &settings, &Unobserved, self.stop);
        if self.stop.load(Ordering::SeqCst) {
            return None;
        }
        let pictures = Pictures::of(&render, self.scene.camera.size);
        made.insert(key, pictures.clone());
        Some(pictures)
    }
}
