//! The choice between reflection and refraction: any probability gives the same mean, the Fresnel probability little noise.
//!
//! ```text
//! reflect with probability p:  weight F/p        refract with probability 1 − p:  weight (1 − F)/(1 − p) · 1/η²
//! mean: p · F/p L_r + (1 − p) · (1 − F)/(1 − p) L_t = F L_r + (1 − F) L_t      for every p in (0, 1)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | F | Fresnel reflectance of the surface of the glass at this angle | `scene/bsdf/fresnel.rs` |
//! | p | probability of reflection: F, or 1/2 | the key `choice` of the scene |
//! | L_r, L_t | radiance from the reflected and from the refracted direction | – |
//! | V | variance of the image; the noise is √V | [`Shot::variance`] |
//!
//! Reference: Pharr, Jakob and Humphreys, *Physically Based Rendering* (4th ed. 2023), sec. 9.5.

use super::board::{Board, Tile};
use super::measure::{Interval, Shot, words};
use super::stage::{SKY, SUN, spheres, under_sky};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::picture::{auto_gain, gain_label};
use fredholm::report::text::csv::Csv;
use fredholm::scene::Scene;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "fresnel-choice",
    topic: "Glass: reflect or refract?",
    caption: "At each surface of the glass sphere one ray is followed, reflected or refracted. On the left the choice \
              has the Fresnel probability, on the right both have probability one half. The means agree, because \
              every choice is divided by its probability. The noise of the right picture is much larger.",
    scene: "three spheres, defined by the program",
    program,
};

/// A glass sphere between two matt ones. `CHOICE` is replaced.
const GLASS: &str = r#"
[materials.left]
type = "diffuse"
reflectance = [0.7, 0.25, 0.15]

[materials.middle]
type = "dielectric"
ior = 1.5
choice = CHOICE

[materials.right]
type = "diffuse"
reflectance = [0.2, 0.35, 0.7]
"#;

/// K: the number of reflections and refractions.
const K: usize = 8;
/// The two means must be proved to differ by less than this part, in a full and in a short run.
const MARGIN: [f64; 2] = [0.01, 0.03];

fn program(folder: &Folder<'_>) -> Result<()> {
    let size: [u32; 2] = folder.pick([456, 320], [228, 160]);
    let spp = folder.pick(32, 16);
    let shots = ["\"fresnel\"", "0.5"].map(|choice| -> Result<Shot> {
        let mut scene = spheres(&format!("{}{SKY}", GLASS.replace("CHOICE", choice)), size)?;
        scene.camera.fov = 19.0;
        let scene = Scene::new(&under_sky(scene, SUN));
        Ok(Shot::terms(&scene, K, spp, choice, folder))
    });
    let [fresnel, constant] = shots;
    let (fresnel, constant) = (fresnel?, constant?);
    let all = 0..K + 1;
    let gain = auto_gain(&fresnel.image(all.clone()).mean);
    let tile = |shot: &Shot, label: &str| {
        let numbers = vec![
            format!("mean {}", words(&shot.estimate(all.clone()))),
            format!("noise √V = {} with {spp} samples per pixel", shot.noise(all.clone()).words()),
        ];
        Tile::new(size[0], &shot.image(all.clone()).mean, gain, label, numbers).enlarged(folder.pick(1, 2))
    };
    let mut board = Board::new(
        "Reflect or refract: the probability changes the noise, not the mean",
        &format!(
            "Weight F/p if the ray is reflected, (1 − F)/(1 − p) · 1/η² if it is refracted. Both pictures: k ≤ {K}, \
             gain {}.",
            gain_label(gain)
        ),
    );
    board.wide_row(vec![tile(&fresnel, "p = F, the Fresnel reflectance"), tile(&constant, "p = 1/2 at every angle")]);
    let apart = constant.mean(all.clone()).minus(fresnel.mean(all.clone()));
    let ratio = constant.variance(all.clone()).over(fresnel.variance(all.clone()));
    board.lines(
        &format!(
            "Difference of the means: {}. Variance of p = 1/2 over variance of p = F: {} (± 95 %).",
            apart.words(),
            ratio.words()
        ),
        14.0,
    );
    let margin = MARGIN[usize::from(folder.quick)];
    if apart.at_most() > margin * fresnel.mean(all.clone()).value {
        return Err(format!("the means are not proved equal to {margin}: difference {}", apart.words()).into());
    }
    if ratio.value - 3.0 * ratio.std_error < 1.0 {
        return Err(format!("p = 1/2 is not proved noisier: ratio of the variances {}", ratio.words()).into());
    }
    let mut csv = Csv::new("choice,mean,std_error,variance,variance_std_error,spp");
    for (name, shot) in [("fresnel", &fresnel), ("0.5", &constant)] {
        let (mean, v) = (shot.mean(all.clone()), shot.variance(all.clone()));
        let numbers = [mean.value, mean.std_error, v.value, v.std_error, f64::from(spp)];
        csv.put(name).numbers(numbers).end();
    }
    folder.text("fresnel-choice.csv", &csv.text())?;
    board.finish(folder, &SLIDE, |_| Ok(()))
}
