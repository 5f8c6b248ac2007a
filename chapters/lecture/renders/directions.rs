//! Three densities for the directions of a path, at equal time.
//!
//! ```text
//! L_o = ∫ f L_i cos θ dω = E[ f L_i cos θ/p ]      p = 1/2π,   p = cos θ/π,   p as near to f cos θ as can be sampled
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p | density of the sampled direction: uniform, cosine, BSDF | [`Sampling`] |
//! | f | matt, and GGX of widths α = 0.1 and 0.3 | [`MATERIALS`] |
//! | V, t | variance of the image, seconds | [`Shot`] |
//! | efficiency | 1/(V t), relative to uniform directions | [`Shot::efficiency`] |
//!
//! Light is found by hits only (technique `scatter`), so that nothing but the directions differs. Reference: Pharr, Jakob and
//! Humphreys, *Physically Based Rendering* (4th ed. 2023), sec. 2.2 (importance sampling).

use super::board::{Board, Tile};
use super::measure::{Interval, Shot, in_equal_time, seconds, words};
use super::stage::{HAZE, SKY, spheres, under_sky};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::picture::{auto_gain, gain_label};
use fredholm::report::text::csv::Csv;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "directions",
    topic: "Choosing directions: importance sampling",
    caption: "The same scene in the same time, with three densities for the directions. The matt ground and the matt \
              sphere gain from the cosine. The glossy spheres need directions from their BSDF: other densities rarely \
              choose a direction that matters. The mean is the same for all three.",
    scene: "three spheres, defined by the program",
    program,
};

/// A matt sphere, a satin one and a smoother one.
const MATERIALS: &str = r#"
[materials.left]
type = "diffuse"
reflectance = [0.7, 0.4, 0.25]

[materials.middle]
type = "conductor"
reflectance = [0.9, 0.9, 0.9]
alpha = 0.3

[materials.right]
type = "conductor"
reflectance = [0.9, 0.75, 0.4]
alpha = 0.1
"#;

/// K: light after at most this many reflections.
const K: usize = 1;

fn program(folder: &Folder<'_>) -> Result<()> {
    let size: [u32; 2] = folder.pick([300, 256], [150, 128]);
    let mut description = spheres(&format!("{MATERIALS}{SKY}"), size)?;
    (description.camera.fov, description.camera.origin.y) = (31.0, 3.0);
    let scene = Scene::new(&under_sky(description, HAZE));
    let prefix = Prefix(Plan { max_bounces: K, technique: Technique::Scatter, roulette: Roulette::Never });
    let time = folder.pick(2.5, 0.2);
    let shots = in_equal_time(time, |i, spp, stream| Shot::new(&scene, Sampling::ALL[i], &prefix, spp, stream, folder));
    let [uniform, _, by_bsdf] = &shots;
    let all = 0..K + 1;
    let gain = auto_gain(&by_bsdf.image(all.clone()).mean);
    let name = |sampling| match sampling {
        Sampling::Uniform => "uniform: p = 1/2π",
        Sampling::Cosine => "cosine: p = cos θ/π",
        Sampling::Bsdf => "BSDF: p ∝ f cos θ, nearly",
    };
    let gain_of = |shot: &Shot| shot.efficiency(all.clone()).over(uniform.efficiency(all.clone()));
    let mut csv = Csv::new("directions,spp,seconds,mean,std_error,variance,variance_std_error,relative_efficiency");
    let tiles = Sampling::ALL.iter().zip(&shots).map(|(sampling, shot)| {
        let relative = gain_of(shot);
        let efficiency = match sampling {
            Sampling::Uniform => "relative efficiency 1".to_string(),
            _ => format!("relative efficiency {}", relative.words()),
        };
        let (mean, v) = (shot.mean(all.clone()), shot.variance(all.clone()));
        csv.put(sampling)
            .put(shot.spp)
            .numbers([shot.seconds, mean.value, mean.std_error, v.value, v.std_error, relative.value])
            .end();
        let notes = vec![
            format!("{} samples per pixel in {}", shot.spp, seconds(shot)),
            format!("noise √V = {}", shot.noise(all.clone()).words()),
            efficiency,
            format!("mean {}", words(&shot.estimate(all.clone()))),
        ];
        Tile::new(size[0], &shot.image(all.clone()).mean, gain, name(*sampling), notes).enlarged(folder.pick(1, 2))
    });
    let tiles = tiles.collect::<Vec<_>>();
    let mut board = Board::new(
        "Directions where the light matters: less noise in the same time",
        &format!(
            "E[f Lᵢ cos θ/p] is the same for every density p. Light is found only where a path hits the sky (technique \
             scatter), k ≤ {K}. Gain {}.",
            gain_label(gain)
        ),
    );
    board.wide_row(tiles);
    let best = gain_of(by_bsdf);
    let apart = by_bsdf.mean(all.clone()).minus(uniform.mean(all.clone()));
    board.lines(
        &format!(
            "Efficiency is 1/(V · seconds). BSDF directions need 1/{:.0} of the time of uniform ones for the same noise. \
             Mean of BSDF − mean of uniform: {} (95 %).",
            best.value,
            apart.words()
        ),
        14.0,
    );
    if best.value - 3.0 * best.std_error < 1.0 {
        return Err(format!("BSDF directions are not proved better: relative efficiency {}", best.words()).into());
    }
    folder.text("directions.csv", &csv.text())?;
    board.finish(folder, &SLIDE, |_| Ok(()))
}
