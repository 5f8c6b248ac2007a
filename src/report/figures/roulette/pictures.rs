//! The sheet of the schedules that were rendered: a picture for each at one exposure, and below it its noise and efficiency.
//!
//! ```text
//! noise = √(V/n)        efficiency = 1/(V · rays)        V of indirect light, Σ_{k≥2} T^k E, and of the whole image
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample, measured | [`Noise::indirect`](crate::stats::Noise::indirect), [`Noise::all`](crate::stats::Noise::all) |
//! | n | samples per pixel | argument of [`pictures`] |
//!
//! Reference: Arvo and Kirk, *Particle Transport and Image Synthesis* (1990), on Russian roulette.

use super::rows::Row;
use crate::report::{
    ReportError,
    figures::pictures::{self, Setting},
    image::{picture::Picture, typeset::Caption},
    text::ranking::Candidate,
};
use crate::terms::Variance;
use crate::terms::cross_moments::Value;

/// The image of one schedule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// The name of the schedule, as in [`Row::name`].
    pub name: String,
    /// The whole image.
    pub image: Vec<[f32; 3]>,
    /// Its term k = 0.
    pub emission: Vec<[f32; 3]>,
}

fn setting<'a>(r: &Row, shown: &'a Shown, spp: u32, doubtful: &[&str]) -> Option<Setting<'a>> {
    let m = r.measured.as_ref()?;
    let told = !doubtful.contains(&r.name.as_str());
    let trusted = |v: Value| Value { std_error: if told { v.std_error } else { f64::NAN }, ..v };
    let e = trusted(m.indirect_efficiency);
    let work = Candidate {
        name: r.name.clone(),
        work: 1.0 / e.value,
        relative_error: e.std_error / e.value,
        replicates: r.replicates,
        without: vec![],
    };
    Some(Setting {
        label: r.name.clone(),
        image: &shown.image,
        emission: &shown.emission,
        spp,
        noise: [("k ≥ 2", trusted(m.indirect)), ("all k", trusted(m.all))],
        replicates: r.replicates,
        known: Variance::Finite,
        rays_per_path: m.rays.value,
        seconds_per_path: r.seconds,
        work,
    })
}

/// Draws a picture for each schedule that was rendered with `spp` samples per pixel. All of them end with a
/// constant q after vertex K, so their variance is finite. `doubtful` names those whose measured variance has no error.
///
/// # Errors
/// If no schedule was rendered, the images do not match the size, or the text cannot be drawn.
pub fn pictures<'a>(
    rows: &[Row],
    shown: &'a [Shown],
    spp: u32,
    size: [usize; 2],
    doubtful: &[&str],
    caption: &Caption,
) -> Result<Picture, ReportError> {
    let of = |s: &'a Shown| setting(rows.iter().find(|r| r.name == s.name)?, s, spp, doubtful);
    let settings: Vec<Setting> = shown.iter().filter_map(of).collect();
    let title = format!("{} by roulette", caption.scene);
    pictures::draw(&title, size, &settings, "indirect light, k ≥ 2", caption)
}
