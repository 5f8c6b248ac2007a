//! Pictures of the scene `veach-mis`: each strategy alone, both with weights, and the mean weight as a map.
//!
//! ```text
//! share = D₀/(D₀ + D₁)       Dᵢ = E[wᵢ f E V cos θ/pᵢ], so D₀ + D₁ = T E
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | D₀, D₁ | the parts of the direct light that MIS takes from BSDF sampling and from light sampling | [`Pixel::parts`] |
//! | share | the weight of BSDF sampling, averaged over the light that arrives | [`share`] |

use super::{estimate, found, weight};
use fredholm::estimator::Technique;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, Sensor, Transport};
use fredholm::report::book::{self, Folder};
use fredholm::report::image::picture::{Picture, auto_gain_beside_lamps, develop, gain_label};
use fredholm::report::image::{sheet, sheet::Tile};
use fredholm::scene::Scene;
use rayon::prelude::*;

/// Rays of each picture, per pixel.
const RAYS: u32 = 8;

/// What is computed for one pixel.
#[derive(Clone, Copy, Default)]
struct Pixel {
    /// E, seen directly.
    emission: f64,
    /// T E by BSDF sampling, by light sampling, and by MIS, with the same number of rays.
    pictures: [f64; 3],
    /// D₀ and D₁.
    parts: [f64; 2],
}

/// Samples one pixel: `many` samples of each strategy for the map, the first of them for the pictures.
fn pixel(t: &SceneTransport<'_>, key: Key, pixel: u32, many: u32) -> Pixel {
    let mut sum = Pixel::default();
    for n in 0..many {
        let mut numbers = Rng::at(key, pixel, n, 0, Purpose::Start);
        let Some(x) = t.scene.camera.start(t, pixel, &mut numbers) else { continue };
        let both = found(t, &x, key, [pixel, n]);
        let of = |technique| estimate(t, &both, technique, weight);
        let add = |sum: &mut f64, x: f64, count: u32| *sum += if n < count { x / f64::from(count) } else { 0.0 };
        add(&mut sum.emission, f64::from(t.emission(&x).y), RAYS);
        add(&mut sum.pictures[0], of(Technique::Scatter)[0], RAYS);
        add(&mut sum.pictures[1], of(Technique::Connect)[1], RAYS);
        let parts = of(Technique::Mis);
        add(&mut sum.pictures[2], parts[0] + parts[1], RAYS / 2);
        (0..2).for_each(|i| add(&mut sum.parts[i], parts[i], many));
    }
    sum
}

/// Colour of a share: blue for 0, white for ½, orange for 1; black where no light arrives.
fn colour(share: f64) -> [u8; 3] {
    const ENDS: [[f64; 3]; 2] = [[0.0, 90.0, 181.0], [230.0, 126.0, 0.0]];
    if share.is_nan() {
        return [0; 3];
    }
    let end = ENDS[usize::from(share > 0.5)];
    end.map(|c| (255.0 + (2.0 * share - 1.0).abs() * (c - 255.0)).round() as u8)
}

/// Draws `pictures.png`.
pub(super) fn draw(folder: &Folder<'_>) -> book::Result<()> {
    let [w, h]: [u32; 2] = folder.pick([444, 296], [148, 99]);
    let scene = Scene::new(&super::plates::veach([w, h])?);
    let t = SceneTransport::new(&scene);
    let (key, many) = (Key::new(folder.seed, "pictures"), folder.pick(24, 8));
    let pixels: Vec<Pixel> = (0..w * h).into_par_iter().map(|p| pixel(&t, key, p, many)).collect();
    let grey = |value: f64| [value as f32; 3];
    let emission: Vec<[f32; 3]> = pixels.iter().map(|p| grey(p.emission)).collect();
    let images = [0, 1, 2].map(|i| pixels.iter().map(|p| grey(p.emission + p.pictures[i])).collect::<Vec<_>>());
    let gain = auto_gain_beside_lamps(&images[2], &emission);
    let [width, height] = [w, h].map(|n| n as usize);
    let enlarged = |picture: &Picture| picture.enlarged(folder.pick(2, 6));
    let tile = |image: Picture, label: &str, note: &str| Tile {
        image: enlarged(&image),
        label: label.into(),
        notes: vec![note.into()],
    };
    let shown = |i: usize| develop(width, height, &images[i], gain).picture;
    let share = |p: &Pixel| colour(p.parts[0] / (p.parts[0] + p.parts[1]));
    let map = Picture { width, height, pixels: pixels.iter().map(share).collect() };
    let tiles = [
        tile(shown(0), "BSDF sampling", "8 directions per pixel"),
        tile(shown(1), "light sampling", "8 points on the lamps per pixel"),
        tile(shown(2), "MIS, balance heuristic", "4 directions and 4 points per pixel"),
        tile(map, "weight of BSDF sampling", "orange: 1     white: ½     blue: 0     black: no light"),
    ];
    let foot = format!(
        "Four plates (alpha 0.005, 0.02, 0.06 and 0.2 from top to bottom) under four lamps of equal power. Emission and direct light, gain {}.",
        gain_label(gain)
    );
    let title = "The same number of rays, three ways to use them";
    Ok(folder.picture("pictures.png", &sheet::slide(title, 2, &tiles, Some(&foot), &folder.caption("veach-mis"))?)?)
}
