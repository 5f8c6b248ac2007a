//! A small path tracer as a good student would write it, and forty ways to get it wrong.
//!
//! It shares no code with the library, so its pictures of the scene `cornell` are what another program would hand in.
//!
//! ```text
//! L = T_0 + T_1 + T_2 + …,    T_k = light that was reflected k times
//! picture of T_k = mean over all paths of what they found of T_k
//! ```
//!
//! | file | what it holds |
//! |---|---|
//! | `scene.rs` | rectangles, camera, ray against scene |
//! | `walk.rs` | one path, and its random numbers |
//! | `bugs.rs` | the list of mistakes |
//! | this file | from paths to a finished picture |

pub mod bugs;
pub mod scene;
pub mod walk;

pub use bugs::{BUGS, Bug, Kind, RIGHT};

use scene::{Scene, Vec3, add, camera_ray, scale};
use std::sync::{Mutex, PoisonError};
use walk::{Light, Rng, trace};

/// A finished picture. Rows run from the top, columns from the left.
pub struct Picture {
    /// Width and height.
    pub size: usize,
    /// T_0 to T_K, each with `size`² pixels.
    pub terms: Vec<Vec<[f32; 3]>>,
    /// The sum of all terms, those after T_K too.
    pub whole: Vec<[f32; 3]>,
    /// Whether the numbers are meant for a screen, not light.
    pub encoded: bool,
}

/// Renders the scene with `spp` paths for each pixel and K = `max_bounces`.
pub fn render(bug: &Bug, size: usize, spp: u32, max_bounces: usize, seed: u64) -> Picture {
    let kind = bug.kind;
    let scene = Scene::new(kind);
    let mut pixels = vec![Light::none(0); size * size];
    // Each thread takes the next row until none is left. A pixel's random numbers depend on its place only.
    let rows = Mutex::new(pixels.chunks_mut(size.max(1)).enumerate());
    let next_row = || rows.lock().unwrap_or_else(PoisonError::into_inner).next();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((row, pixels)) = next_row() {
                    for (column, pixel) in pixels.iter_mut().enumerate() {
                        let seed =
                            Rng::new(seed, if kind == Kind::SameSeed { 0 } else { (row * size + column) as u64 });
                        *pixel = mean_of_paths(&scene, kind, size, [row, column], spp, max_bounces, seed);
                    }
                }
            });
        }
    });
    finish(kind, size, max_bounces, pixels)
}

/// The mean over the paths of one pixel.
fn mean_of_paths(
    scene: &Scene,
    kind: Kind,
    size: usize,
    [row, column]: [usize; 2],
    spp: u32,
    max_bounces: usize,
    mut rng: Rng,
) -> Light {
    let mut sum = Light::none(max_bounces + 2);
    for path in 0..spp {
        let mut x = column as f64 + rng.next();
        let mut y = row as f64 + rng.next();
        match kind {
            Kind::Shift { right, down } => {
                x += right;
                y += down;
            }
            Kind::LeftRight => x = size as f64 - x,
            Kind::UpsideDown => y = size as f64 - y,
            _ => {}
        }
        let broken = kind == Kind::NotANumber && path == 0 && nan_pixels(size).contains(&[row, column]);
        let start = if broken { f64::NAN } else { 1.0 };
        let ray = camera_ray(x / size as f64, y / size as f64);
        let found = trace(scene, kind, ray, start, max_bounces, &mut rng);
        let of_path = |light: Vec3| match kind {
            Kind::PathsEncoded => light.map(gamma),
            Kind::PathsClamped => light.map(|value| value.min(1.0)),
            _ => light,
        };
        sum.whole = add(sum.whole, of_path(found.whole));
        for (sum, term) in sum.terms.iter_mut().zip(found.terms) {
            *sum = add(*sum, of_path(term));
        }
    }
    let exposure = if kind == Kind::Darker { 0.95 } else { 1.0 };
    let factor = exposure / f64::from(spp.max(1));
    Light { terms: sum.terms.into_iter().map(|term| scale(term, factor)).collect(), whole: scale(sum.whole, factor) }
}

/// Sorts the pixels into pictures and takes the steps that come after the mean.
fn finish(kind: Kind, size: usize, max_bounces: usize, pixels: Vec<Light>) -> Picture {
    let of_pixel = |light: Vec3| {
        match kind {
            Kind::RedBlueSwapped => [light[2], light[1], light[0]],
            Kind::Srgb => light.map(srgb),
            Kind::Gamma => light.map(gamma),
            Kind::PixelsClamped => light.map(|value| value.min(1.0)),
            _ => light,
        }
        .map(|value| value as f32)
    };
    // With the wrong numbers, the picture of T_{k+1} lies in the place of T_k.
    let first = usize::from(kind == Kind::LayersOffByOne);
    let mut terms: Vec<Vec<[f32; 3]>> = (first..=max_bounces + first)
        .map(|order| pixels.iter().map(|pixel| of_pixel(pixel.terms[order])).collect())
        .collect();
    let mut whole: Vec<[f32; 3]> = pixels.iter().map(|pixel| of_pixel(pixel.whole)).collect();
    match kind {
        Kind::LayersOffByOne => {
            for (place, pixel) in whole.iter_mut().enumerate() {
                *pixel = std::array::from_fn(|channel| terms.iter().map(|term| term[place][channel]).sum());
            }
        }
        Kind::Ambient(constant) => {
            for pixel in terms.iter_mut().skip(1).take(1).chain([&mut whole]).flatten() {
                *pixel = pixel.map(|value| value + constant);
            }
        }
        Kind::Firefly(factor) => {
            // On the front of the tall block.
            let place = size * 3 / 4 * size + size / 3;
            for picture in terms.iter_mut().skip(2).take(1).chain([&mut whole]) {
                if let Some(pixel) = picture.get_mut(place) {
                    *pixel = pixel.map(|value| value * factor);
                }
            }
        }
        _ => {}
    }
    let encoded = matches!(kind, Kind::Srgb | Kind::Gamma | Kind::PathsEncoded);
    Picture { size, terms, whole, encoded }
}

/// Row and column of the three pixels with a path whose β is not a number. Their T_1 to T_K and sum are not, either.
fn nan_pixels(size: usize) -> [[usize; 2]; 3] {
    [[size / 4, size / 3], [size / 2, size / 2], [size * 3 / 4, size * 2 / 3]]
}

fn gamma(value: f64) -> f64 {
    value.max(0.0).powf(1.0 / 2.2)
}

fn srgb(value: f64) -> f64 {
    if value <= 0.0031308 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}
