//! The cube with walls that are mirrors, and with diffuse walls: what T^k E becomes.
//!
//! ```text
//! mirrors:  (T L)(x, ω) = ρ L(ray(x, r ω))     ‖T^k E‖₁ = ρ^k ‖E‖₁     u_k = ⟨(T^k E)²⟩/⟨T^k E⟩² = u_0
//! diffuse:  ‖T^k E‖₁ = ρ^k ‖E‖₁ as well, but u_k → 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r ω | mirror direction; the mirrored ray is the only one, so T moves values and never averages them | |
//! | ⟨ ⟩ | mean over all surface points and cosine-weighted directions | [`fredholm::study::surface::norms`] |
//! | u_k | unevenness: 1 for the same light everywhere | [`Room::uneven`] |
//!
//! A sample of T^k E in the mirror room has no noise: it is the value for its ray. So the mean square of the samples is that of
//! T^k E. The diffuse room is solved by a matrix, where T_h^k E is known as well.
//!
//! Reference: Soler, Molazem and Subr, *A Theoretical Analysis of Compactness of the Light Transport Operator* (2022).

use fredholm::engine::{Settings, by_matrix, by_rays::Estimator};
use fredholm::estimator::{Roulette, Technique};
use fredholm::operator::matrix::LinearOperator;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, description::Description, load};
use fredholm::study::surface;

/// The last term.
pub const LAST: usize = 16;
/// The albedo of the diffuse room.
const DIFFUSE: f64 = 0.9;

/// ‖T^k E‖₁ and u_k for k = 0, …, 16.
#[derive(Clone)]
pub struct Room {
    /// ‖T^k E‖₁.
    pub norm: Vec<Number>,
    /// u_k.
    pub uneven: Vec<f64>,
}

/// The cube, under its emitting ceiling, with six equal walls.
fn cube(kind: &str, albedo: f64) -> book::Result<Description> {
    let wall = |name: &str| {
        let key = |key: &str, value: String| format!("materials.{name}.{key}={value}");
        [key("type", format!("{kind:?}")), key("reflectance", format!("[{albedo}, {albedo}, {albedo}]"))]
    };
    let set = ["floor", "ceiling", "back", "front", "left", "right"].into_iter().flat_map(wall).collect();
    Ok(load::scene("cube", &load::Options { set, ..Default::default() })?.description)
}

/// Mirrors with this albedo, by paths.
pub fn mirrors(folder: &Folder<'_>, albedo: f64) -> book::Result<Room> {
    let scene = Scene::new(&cube("mirror", albedo)?);
    let paths = folder.pick(1u32 << 19, 1 << 17);
    let (technique, roulette) = (Technique::Scatter, Roulette::Never);
    let settings = Settings { technique, roulette, max_bounces: LAST, seed: folder.seed, ..Settings::default() };
    let found = surface::norms(&scene, Estimator::Prefix, paths, &settings, folder.progress);
    let terms = 0..=LAST;
    let uneven = |k: usize| f64::from(paths) * found.counted[k].square / found.counted[k].sum.powi(2);
    Ok(Room {
        norm: terms.clone().map(|k| (&found.estimate(k..k + 1)).into()).collect(),
        uneven: terms.map(uneven).collect(),
    })
}

/// Diffuse walls, by a matrix.
pub fn diffuse(folder: &Folder<'_>) -> book::Result<Room> {
    let description = cube("diffuse", DIFFUSE)?;
    let patches = folder.pick(600, 150);
    let room = by_matrix::dense_matrix(&description, &Scene::new(&description), patches, 1.0, LAST, folder.progress)?;
    let t = room.radiosity.operator(0);
    let all: f64 = t.area().iter().sum();
    let mean =
        |k: usize, power: i32| t.area().iter().zip(&room.terms[k]).map(|(a, x)| a * x.x.powi(power)).sum::<f64>() / all;
    Ok(Room {
        norm: (0..=LAST).map(|k| Number { value: mean(k, 1), std_error: 0.0 }).collect(),
        uneven: (0..=LAST).map(|k| mean(k, 2) / mean(k, 1).powi(2)).collect(),
    })
}
