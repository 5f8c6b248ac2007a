//! What stands below the picture of a setting: its noise, its samples, its cost, and its efficiency.
//!
//! ```text
//! noise = √(V/n)        efficiency of setting i relative to the first = (V₁ c₁)/(V_i c_i)        c: rays or seconds of a path
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample, averaged over pixels and channels | [`Setting::noise`] |
//! | n | samples per pixel | [`Setting::spp`] |
//! | c | rays, or seconds, of a path | [`Setting::rays_per_path`], [`Setting::seconds_per_path`] |
//!
//! All pictures have the gain that suits the quietest one outside visible lamps.
//!
//! Reference: Hammersley and Handscomb, *Monte Carlo Methods* (1964), section 3.

use crate::report::{
    ReportError, half_width_95,
    image::{
        picture::{Picture, auto_gain_beside_lamps},
        side_by_side::{self, Panel},
        typeset::Caption,
    },
    text::{
        number::{plus_minus, significant},
        ranking::{Candidate, ratio},
    },
};
use crate::terms::Variance;
use crate::terms::cross_moments::Value;

/// A setting with its image and its numbers.
pub(super) struct Setting<'a> {
    pub(super) label: String,
    /// The whole image.
    pub(super) image: &'a [[f32; 3]],
    /// T^0 E: it is not black where lamps are seen.
    pub(super) emission: &'a [[f32; 3]],
    pub(super) spp: u32,
    /// V of parts of the image, each with the name of the part. The first is the part whose efficiency is compared.
    pub(super) noise: [(&'static str, Value); 2],
    /// Independent replicates behind the errors.
    pub(super) replicates: u64,
    /// Whether the variance is finite, so that its measured value means something.
    pub(super) known: Variance,
    pub(super) rays_per_path: f64,
    /// None if it was not measured.
    pub(super) seconds_per_path: Option<f64>,
    /// V · rays of the first part.
    pub(super) work: Candidate,
}

impl Setting<'_> {
    /// √(V/n) of a part with its standard error.
    fn noise(&self, part: usize) -> Value {
        let v = self.noise[part].1;
        let value = (v.value / f64::from(self.spp)).sqrt();
        Value { value, std_error: 0.5 * value * v.std_error / v.value }
    }

    /// Efficiency per ray and per second, relative to `first`.
    fn efficiency(&self, first: &Self) -> [Option<Value>; 2] {
        let finite = |s: &Self| s.known == Variance::Finite && s.work.work > 0.0;
        let known = finite(self) && finite(first);
        let (value, std_error) = if self.work == first.work { (1.0, 0.0) } else { ratio(&first.work, &self.work) };
        let per_ray = (known && value.is_finite()).then_some(Value { value, std_error });
        // the same variances, with seconds in place of rays
        let price = |s: &Self| s.seconds_per_path.map(|seconds| seconds / s.rays_per_path);
        let per_second = per_ray
            .zip(price(first).zip(price(self)))
            .map(|(v, (one, own))| Value { value: v.value * one / own, std_error: v.std_error * one / own });
        [per_ray, per_second]
    }

    /// √(V/n) of a part as text.
    pub(super) fn shown(&self, part: usize) -> String {
        match self.known {
            Variance::Finite => with_half_width(self.noise(part), self.replicates),
            Variance::Infinite => "infinite variance".into(),
            Variance::Unknown => "not known".into(),
        }
    }

    /// The lines below the picture.
    fn numbers(&self, first: &Self) -> Vec<String> {
        let times = |v: Value| format!("×{}", with_half_width(v, self.replicates));
        let [per_ray, per_second] = self.efficiency(first).map(|v| v.map_or("–".into(), times));
        let part = |i: usize| format!("noise, {}: {}", self.noise[i].0, self.shown(i));
        let plural = if self.spp == 1 { "sample" } else { "samples" };
        let mut lines = vec![
            format!("{} {plural} per pixel", self.spp),
            part(0),
            part(1),
            format!("{} rays per path", significant(self.rays_per_path, 3)),
            format!("efficiency {per_ray} per ray"),
        ];
        if let Some(seconds) = self.seconds_per_path {
            let pixels = self.image.len() as f64;
            lines[0] += &format!(", {} s", significant(seconds * pixels * f64::from(self.spp), 3));
            lines.push(format!("efficiency {per_second} per s"));
        }
        lines
    }
}

/// `0.24 ± 0.01`, with the half width of the 95 % interval. It is left out if it is not known or below 0.5 %.
fn with_half_width(v: Value, replicates: u64) -> String {
    let half = half_width_95(v.std_error, replicates);
    match v.value {
        x if half.is_nan() || half < 5e-3 * x.abs() => significant(x, 3),
        // a small number, or one that is hardly larger than its error, would lose its digits
        x if x.abs() < 1e-3 || half > 0.5 * x.abs() => format!("{} ± {}", significant(x, 2), significant(half, 2)),
        x => plus_minus(x, half, 1),
    }
}

/// The gain that suits the quietest picture outside visible lamps.
fn gain(settings: &[Setting]) -> f64 {
    let known = |s: &&Setting| s.known == Variance::Finite && s.noise(0).value.is_finite();
    let quietest = settings.iter().filter(known).min_by(|a, b| a.noise(0).value.total_cmp(&b.noise(0).value));
    quietest.or(settings.first()).map_or(1.0, |s| auto_gain_beside_lamps(s.image, s.emission))
}

/// Draws the pictures side by side. `part` says in words which part of the image the first noise means.
///
/// # Errors
/// If there is no setting, the images do not match the size, or the text cannot be drawn.
pub(super) fn draw(
    title: &str,
    size: [usize; 2],
    settings: &[Setting],
    part: &str,
    caption: &Caption,
) -> Result<Picture, ReportError> {
    let numbers = settings.iter().map(|s| s.numbers(&settings[0]));
    let panels = settings.iter().zip(numbers);
    let panels: Vec<Panel> =
        panels.map(|(s, numbers)| Panel { label: s.label.clone(), pixels: s.image, numbers }).collect();
    let timed = settings.iter().any(|s| s.seconds_per_path.is_some());
    let (seconds, time) = if timed {
        (" or 1/(V\u{a0}·\u{a0}s)", " The interval per s leaves out the error of the time.")
    } else {
        ("", "")
    };
    let no_error = |s: &Setting| s.known == Variance::Finite && s.noise[0].1.std_error.is_nan();
    let unknown =
        if settings.iter().any(no_error) { " Noise without an interval: its error is not known." } else { "" };
    let foot = format!(
        "Noise: standard deviation √(V/n) of a pixel after n samples, with its 95 % interval. V is the variance of one \
         sample, averaged over pixels and channels; \"all k\" includes lamps seen directly. \
         Efficiency: 1/(V\u{a0}·\u{a0}rays){seconds} of {part}, relative to the first picture.{time}{unknown}"
    );
    side_by_side::draw(title, size, &panels, gain(settings), &foot, caption)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setting(image: &[[f32; 3]], variance: f64, spp: u32) -> Setting<'_> {
        let value = Value { value: variance, std_error: 0.1 * variance };
        let name = format!("{variance}");
        let work = Candidate { name, work: 4.0 * variance, relative_error: 0.1, replicates: 16, without: vec![] };
        Setting {
            label: "a".into(),
            image,
            emission: &[[0.0; 3]],
            spp,
            noise: [("k ≥ 1", value), ("all", value)],
            replicates: 16,
            known: Variance::Finite,
            rays_per_path: 4.0,
            seconds_per_path: Some(0.5),
            work,
        }
    }

    /// √(V/n) with V = 1 ± 0.1 and n = 25 is 0.2 ± 0.01; the second needs twice the rays, and four times the seconds.
    #[test]
    fn numbers_are_those_of_the_definition() {
        let image = [[0.1; 3]];
        let first = setting(&image, 1.0, 25);
        let noise = first.noise(0);
        assert!((noise.value - 0.2).abs() < 1e-12 && (noise.std_error - 0.01).abs() < 1e-12);
        let second = Setting { seconds_per_path: Some(1.0), ..setting(&image, 2.0, 25) };
        let [per_ray, per_second] = second.efficiency(&first);
        assert_eq!(per_ray.map(|v| v.value), Some(0.5));
        assert_eq!(per_second.map(|v| v.value), Some(0.25));
        assert!(per_ray.is_some_and(|v| (v.std_error - 0.5 * 0.1f64.hypot(0.1)).abs() < 1e-12));
        let infinite = Setting { known: Variance::Infinite, ..setting(&image, 1.0, 25) };
        assert_eq!(infinite.efficiency(&first), [None, None]);
        assert_eq!(first.efficiency(&first)[0], Some(Value { value: 1.0, std_error: 0.0 }), "the first has no error");
        assert!(infinite.numbers(&first)[1].ends_with("infinite variance"));
    }

    /// The quietest picture sets the gain: the other one is 100 times brighter, which is its noise.
    #[test]
    fn the_quietest_picture_sets_the_gain() {
        let (quiet, noisy) = ([[0.1; 3]], [[10.0; 3]]);
        let both = [setting(&noisy, 5.0, 16), setting(&quiet, 1.0, 16)];
        assert_eq!(gain(&both), 8.0);
        let unknown = [setting(&noisy, f64::NAN, 16), setting(&quiet, 1.0, 16)];
        assert_eq!(gain(&unknown), 8.0);
        let infinite = [setting(&quiet, 1.0, 16), Setting { known: Variance::Unknown, ..setting(&noisy, 0.1, 16) }];
        assert_eq!(gain(&infinite), 8.0);
    }
}
