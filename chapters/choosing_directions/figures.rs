//! Figures and tables of chapter 3.
//!
//! ```text
//! histogram of X = f cos θ L/p with L = 1      images of T E with three densities at the same number of rays
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X | a sample; under a sky of radiance 1 it is the weight | [`weights`] |
//! | T E | light reflected once | [`spheres`] |
//! | V, N | relative variance of a sample, and the number of rays for an error of 1 % | [`tables`] |

use super::situations::{RHO, SITUATIONS};
use super::{Measured, Sampling};
use fredholm::engine::{Settings, by_rays};
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::book::{self, Folder};
use fredholm::report::image::picture::{develop, mean};
use fredholm::report::image::sheet::{Layout, Tile, in_rows};
use fredholm::report::plot::{Axis, Drawn, Entry, GREY, Look, Panel, Sample, Stroke, Words, figure};
use fredholm::report::text::markdown;
use fredholm::scene::{Scene, load};
use fredholm::terms::TermImage;
use std::path::Path;

const NAMES: [&str; 3] = ["uniform directions", "directions by the cosine", "directions by f"];

/// Draws and writes everything.
pub(super) fn draw(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    weights(folder, m)?;
    spheres(folder)?;
    tables(folder, m)
}

fn tables(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let light = |angle: f64| if angle == 90.0 { "sky".to_string() } else { format!("lamp, α = {angle}°") };
    let rows = m.spreads.iter().zip(SITUATIONS).map(|(row, (surface, angle))| {
        let [u, c, f] = row.map(|s| if s.variance.value < 1e-9 { "0".into() } else { s.variance.to_string() });
        let rays = row.map(|s| two_digits((1e4 * s.variance.value).max(1.0))).join(" / ");
        [format!("{surface}, {}", light(angle)), u, c, f, rays]
    });
    let header = ["situation", "V, uniform", "V, by the cosine", "V, by f", "rays for an error of 1 %"];
    folder.text("spreads.md", &markdown::table(&header, &rows.collect::<Vec<_>>()))?;
    let [right, wrong] = m.distance;
    Ok(folder.numbers(&[("distance", format!("{right:.3}")), ("wrong_distance", format!("{wrong:.3}"))])?)
}

/// A number of rays, rounded to two digits.
fn two_digits(n: f64) -> String {
    let unit = 10f64.powf((n.log10().floor() - 1.0).max(0.0));
    format!("{:.0}", (n / unit).round() * unit)
}

/// Bars from `start` in steps of `step`: the fraction of the values in each step. Values below the first step
/// are counted in it.
fn bars(panel: &Panel<'_, '_>, values: &[f64], [start, step]: [f64; 2], count: usize, look: Look) -> Drawn {
    let mut heights = vec![0.0; count];
    for v in values {
        let bar = ((v - start) / step).max(0.0) as usize;
        if bar < count {
            heights[bar] += 1.0 / values.len() as f64;
        }
    }
    for (i, &height) in heights.iter().enumerate().filter(|(_, h)| **h > 0.0) {
        let (left, right) = (start + step * i as f64, start + step * (i + 1) as f64);
        let top = height.min(1.0 - 1e-9);
        panel.band(&[(left, 0.0), (left, top), (right, top), (right, 0.0)], look)?;
        let corners = [(left, 0.0), (left, top), (right, top), (right, 0.0)];
        corners.windows(2).try_for_each(|c| panel.line(c[0], c[1], Stroke::solid(look.color, 1.6)))?;
    }
    Ok(())
}

/// Histograms of the weights, under a sky of radiance 1.
fn weights(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let looks = [0, 1, 2].map(Look::nth);
    let dashes = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
    let title = "Weights f cos θ/p of 65 536 directions";
    let drawn = figure("weights", 960, 446, &folder.caption("a surface under a sky of radiance 1"), |page| {
        page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
        let y = || Axis::linear("fraction of the directions", 0.0, 1.05, 5);
        let of_mean = |panel: &Panel<'_, '_>, at: f64| panel.line((at, 0.0), (at, 1.05), dashes);
        let matt = |i: usize| m.weights[i].iter().map(|w| w / RHO).collect::<Vec<_>>();
        let x = Axis::linear("weight/ρ", -0.2, 2.4, 6);
        let left = Panel::draw(page, "Matt surface, f = ρ/π", [90.0, 72.0, 350.0, 240.0], x, y())?;
        bars(&left, &matt(0), [-0.1, 0.2], 12, looks[0])?;
        bars(&left, &matt(1), [-0.1, 0.2], 12, looks[1])?;
        of_mean(&left, 1.0)?;
        let x = Axis::linear("log₁₀ of the weight", -8.0, 2.0, 5);
        let right = Panel::draw(page, "Glossy surface", [570.0, 72.0, 350.0, 240.0], x, y())?;
        let logs = |i: usize| m.weights[i].iter().map(|w| w.max(1e-30).log10()).collect::<Vec<_>>();
        bars(&right, &logs(2), [-8.0, 0.5], 20, looks[1])?;
        bars(&right, &logs(3), [-8.0, 0.5], 20, looks[2])?;
        of_mean(&right, m.spreads[2][2].mean.value.log10())?;
        let entry = |i: usize| Entry::new(Sample::Line(Stroke::solid(looks[i].color, 8.0)), NAMES[i]);
        let line = || Entry::new(Sample::Line(dashes), "the mean, the same for both");
        page.legend((90.0, 376.0), 350.0, &[entry(0), entry(1), line()])?;
        page.legend((570.0, 376.0), 350.0, &[entry(1), entry(2), line()])?;
        Ok(())
    })?;
    Ok(folder.figure("weights", &drawn)?)
}

/// A glossy sphere on a matt floor, with three densities.
fn spheres(folder: &Folder<'_>) -> book::Result<()> {
    let size = folder.pick(280, 64);
    let text = format!(
        "camera = {{ origin = [0, 1.3, 3.4], target = [0, 0.4, 0], up = [0, 1, 0], fov = 38, size = [{size}, {size}] }}
        shapes = [
          {{ type = 'disk', center = [0, 0, 0], normal = [0, 1, 0], radius = 4, material = 'matt' }},
          {{ type = 'sphere', center = [0, 0.5, 0], radius = 0.5, material = 'glossy' }},
          {{ type = 'disk', center = [-1, 3, 1], normal = [1, -3, -1], radius = 1, material = 'black', emission = [5, 5, 5] }}]
        lights = [{{ type = 'environment', radiance = [0.2, 0.2, 0.2] }}]
        [materials]
        black = {{ type = 'diffuse', reflectance = [0, 0, 0] }}
        matt = {{ type = 'diffuse', reflectance = [0.5, 0.5, 0.5] }}
        glossy = {{ type = 'phong', reflectance = [0.1, 0.1, 0.1], specular = [0.7, 0.7, 0.7], exponent = 100 }}"
    );
    let scene = Scene::new(&load::toml(&text, Path::new("chapter 3"), &load::Options::default())?.description);
    let settings = Settings {
        spp: 16,
        max_bounces: 1,
        technique: Technique::Scatter,
        roulette: Roulette::Never,
        seed: folder.seed,
        ..Settings::default()
    };
    let tile = |i: usize| {
        let settings = Settings { sampling: Sampling::ALL[i], ..settings.clone() };
        let image = by_rays::terms(&scene, by_rays::Estimator::Prefix, &settings, folder.progress).terms.swap_remove(1);
        Tile {
            image: develop(size as usize, size as usize, &image.mean, 1.0).picture.enlarged(2),
            label: NAMES[i].into(),
            notes: vec![format!(
                "mean {:.3}, error of a pixel {:.0} % of it",
                mean(&image.mean),
                100.0 * error(&image)
            )],
        }
    };
    let tiles = [0, 1, 2].map(tile);
    let title = "A glossy sphere on a matt disc: the same light, T E, with three densities of directions";
    let layout = Layout { title, tiles: &tiles, places: &in_rows(3, 3), heads: &[], foot: None, scale: 2.0 };
    let caption = folder.caption("a lamp and a sky over a sphere, 16 directions per pixel");
    Ok(folder.picture("spheres.png", &layout.draw(&caption)?)?)
}

/// Root mean square of the standard errors of the pixels, divided by the mean.
fn error(image: &TermImage) -> f64 {
    let squares = image.std_error.iter().map(|e| f64::from(e[0]).powi(2)).sum::<f64>();
    (squares / image.std_error.len() as f64).sqrt() / mean(&image.mean)
}
