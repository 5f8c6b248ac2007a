//! The reflection equation: light reflected once, from a sky, from a lamp and from a point light.
//!
//! ```text
//! L_o(x, ω_o) = ∫ f(ω_o, ω_i) L_i(x, ω_i) cos θ_i dω_i
//! lamp:   ∫ f L_e(y) V cos θ_i cos θ_y/r² dA_y            point light:   f V I cos θ_i/r²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_o | light after one reflection: the term k = 1 alone | slot 1 |
//! | f | matt, glossy and mirror BSDF | [`MATT_GLOSSY_MIRROR`] |
//! | L_i, L_e, I | radiance of the sky, radiance of the lamp, intensity of the point light | [`stage`](super::stage) |
//! | V | 1 if nothing lies between x and the light, else 0 | – |
//!
//! Reference: Nicodemus et al., *Geometrical Considerations and Nomenclature for Reflectance* (1977); Kajiya, *The Rendering
//! Equation* (1986).

use super::board::{Board, GAP, MARGIN, Tile, WIDTH};
use super::measure::{Shot, words};
use super::stage::{LAMP, MATT_GLOSSY_MIRROR, POINT, SKY, SUN, spheres, under_sky};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::picture::{auto_gain, gain_label};
use fredholm::report::text::csv::Csv;
use fredholm::scene::Scene;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "reflection-equation",
    topic: "The reflection equation",
    caption: "A matt, a glossy and a mirror sphere reflect the same three lights once. Only the reflected light, k = 1, \
              is shown. The matt sphere shows how much light arrives, the mirror shows from where it arrives. The mirror \
              is black under a point light: no reflected ray meets a point.",
    scene: "three spheres, defined by the program",
    program,
};

/// A light: its name, its text in the scene file, its integral, and what to look at.
type Light = (&'static str, &'static str, &'static str, &'static str);
const LIGHTS: [Light; 3] = [
    (
        "A sky: light from every direction",
        SKY,
        "Lₒ = ∫ f L(ω) V cos θ dω",
        "L: sky, V: visible. Soft shadows. The mirror shows the sky and its sun; the glossy sphere shows them blurred.",
    ),
    (
        "A lamp: light from an area",
        LAMP,
        "Lₒ = ∫ f Lₑ V cos θ cos θ′/r² dA",
        "θ′: angle at the lamp. Shadows with a soft edge. The mirror shows the lamp, and the ground as black: it does \
         not emit.",
    ),
    (
        "A point light: light from one point",
        POINT,
        "Lₒ = f V I cos θ/r²",
        "I: intensity. Sharp shadows. The mirror is black: it reflects one direction only, and a point has no area to be hit.",
    ),
];

fn program(folder: &Folder<'_>) -> Result<()> {
    let size: [u32; 2] = folder.pick([400, 128], [200, 64]);
    let mut board = Board::new(
        "Lₒ = ∫ f Lᵢ cos θ dω: one reflection of three lights",
        "Matt, glossy (GGX, α = 0.2), mirror. Only light after one reflection, k = 1. Gain: the 99th percentile is shown \
         as about 0.8.",
    );
    let mut csv = Csv::new("light,mean,std_error,gain");
    for (name, light, integral, look) in LIGHTS {
        let scene = spheres(&format!("{MATT_GLOSSY_MIRROR}{light}"), size)?;
        let scene = Scene::new(&if light == SKY { under_sky(scene, SUN) } else { scene });
        let shot = Shot::terms(&scene, 1, folder.pick(64, 16), name, folder);
        let (image, mean) = (shot.image(1..2).mean, shot.estimate(1..2));
        let gain = auto_gain(&image);
        let tile = Tile::new(size[0], &image, gain, name, vec![]).enlarged(folder.pick(1, 2));
        let top = board.y;
        let right = MARGIN + 400.0 + 2.0 * GAP;
        board.row(vec![tile], [MARGIN, MARGIN + 400.0]);
        let room = WIDTH - MARGIN - right;
        let y = board.paragraph(integral, (right, top + 36.0), room, 17.0);
        let y = board.paragraph(look, (right, y + 10.0), room, 14.0);
        let numbers = format!("gain {}, mean {} (95 %)", gain_label(gain), words(&mean));
        board.paragraph(&numbers, (right, y + 6.0), room, 13.0);
        csv.put(name).numbers([mean.mean.element_sum() / 3.0, mean.std_error.element_sum() / 3.0, gain]).end();
    }
    folder.text("reflection-equation.csv", &csv.text())?;
    board.finish(folder, &SLIDE, |_| Ok(()))
}
