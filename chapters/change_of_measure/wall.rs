//! Direct light at points of a wall of the cube, near its lamp and far from it, by points on the lamp and by directions.
//!
//! ```text
//! T E = ρ E F      F = (1/2π) |Σᵢ θᵢ n·Γᵢ|      points on the lamp: E[X²] → ρ²E² A/(24π h²) as h → 0
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X, X² | a sample and its square, in units of ρE and (ρE)²; their means over batches | [`Place::by`] |
//! | F | closed form for a polygon (Lambert 1760): θᵢ is the angle of edge i, Γᵢ the normal of the triangle from x to it | [`Place::exact`] |
//! | A, h | area of the lamp, 1 m²; distance of x from the plane of the lamp | [`Place::h`] |

use super::{connect, scatter};
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, form_factor::point_to_polygon};
use fredholm::report::book::{self, Folder};
use fredholm::scene::{Scene, load};
use fredholm::stats::Moments;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A point on a wall of the cube.
#[derive(Clone)]
pub struct Place {
    /// Distance from the lamp, which is the whole ceiling, m.
    pub h: f64,
    /// F by Lambert's formula.
    pub exact: f64,
    /// X and X² in units of ρE and (ρE)², by points on the lamp and by directions.
    pub by: [Moments; 2],
}

/// Direct light on a wall of the cube, near its lamp and far from it.
pub fn wall(folder: &Folder<'_>, jacobian: fn(f64, f64) -> f64) -> book::Result<Vec<Place>> {
    let scene = Scene::new(&load::scene("cube", &load::Options::default())?.description);
    let t = SceneTransport::new(&scene);
    let lamp = (0..scene.sides()).find(|&s| scene.light_density(s) > 0.0).ok_or("the cube has no lamp")?;
    let ceiling = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, z]| DVec3::new(x, 1.0, z));
    let (batches, each) = (64, folder.pick(1 << 13, 1 << 12));
    let at = |h: f64| {
        let p = DVec3::new(0.5, 1.0 - h, 0.0);
        let x = scene.trace((p + 0.5 * DVec3::Z - scene.origin()).as_vec3(), Vec3::NEG_Z).ok_or("there is no wall")?;
        let rho_e = f64::from(scene.albedo(x.side).y * scene.emission(lamp).y);
        let moments = |name: &str, sample: &(dyn Fn(&mut Rng) -> f64 + Sync)| {
            let key = Key::new(folder.seed, &format!("{name} {h}"));
            let x = |batch, i| sample(&mut Rng::at(key, batch, i, 0, Purpose::Connect)) / rho_e;
            let sums = |b| (0..each).map(|i| x(b, i)).fold([0.0; 2], |[m, s], x| [m + x, s + x * x]);
            let means = (0..batches).into_par_iter().map(|b| sums(b).map(|sum| sum / f64::from(each)));
            let mut all = Moments::new(2);
            means.collect::<Vec<_>>().iter().for_each(|mean| all.push(mean));
            all
        };
        let points = moments("points", &|u| connect(&scene, &x, lamp, jacobian, u.four()));
        let directions = moments("directions", &|u| scatter(&t, &x, u));
        Ok(Place { h, exact: point_to_polygon(p, DVec3::Z, &ceiling), by: [points, directions] })
    };
    [0.5, 0.25, 0.125, 0.0625, 0.03125].into_iter().map(at).collect()
}
