//! What light never reaches neither stops a scene nor sets its rates; what keeps the light that it gets is refused.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::scenes::{Surface, description, room, sphere};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::{Matrix, MatrixError, dense_matrix, matrix, sampled_matrix};
use fredholm::engine::by_rays;
use fredholm::engine::discretisation::Factors;
use fredholm::engine::known::resort::with_last_resort;
use fredholm::engine::known::trap::trapped;
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::scene::description::DielectricSurface;
use fredholm::scene::description::{BsdfDescription, Choice, Description, Geometry, LightDescription, Sides, Sky};
use glam::DVec3;

fn block(min: DVec3, max: DVec3) -> Geometry {
    Geometry::Box { min, max, rotate_y: 0.0, inward: false }
}

fn grey_room(emission: DVec3) -> Surface {
    (room(DVec3::NEG_ONE, DVec3::ONE, 0.0), DVec3::splat(0.5), emission)
}

/// A room of albedo 0.5 that shines, with a closed block of reflectance ρ in it, both of whose sides reflect: L = E + T L = 2 where ρ = 1.
fn with_block(rho: DVec3) -> Description {
    let inner = block(DVec3::new(-0.4, -0.9, -0.4), DVec3::new(0.4, -0.1, 0.4));
    let mut d = description(&[grey_room(DVec3::ONE), (inner, rho, DVec3::ZERO)]);
    d.materials[1].sides = Sides::Both;
    d.camera.origin = DVec3::new(0.0, 0.0, 0.9);
    d
}

fn dense(d: &Description) -> Result<Matrix<fredholm::solver::Radiosity>, MatrixError> {
    dense_matrix(d, &Scene::new(d), 200, 1.0, 2, Progress::NONE)
}

#[test]
fn a_white_block_in_a_room_is_no_trap() {
    let d = with_block(DVec3::ONE);
    let scene = with_last_resort(Scene::new(&d));
    assert_eq!(trapped(&scene), None);
    // light loses 3/4 of its second moment at a wall: paths from inside the block end soon
    let (vertex, q) = scene.last_resort().unwrap();
    assert!(vertex < 40 && q > 0.05, "{vertex} {q}");
    let settings = Settings { spp: 64, max_bounces: 3, ..Settings::default() };
    let path = by_rays::path(&scene, &settings, Progress::NONE).series;
    let total = path.image().total;
    assert!((total.mean - 2.0).abs().max_element() < 0.05 + 6.0 * total.std_error.max_element(), "{total:?}");
    // the camera inside of the block sees nothing, and comes to an end
    let mut inside = d;
    inside.camera.origin = DVec3::new(0.0, -0.5, 0.0);
    let scene = with_last_resort(Scene::new(&inside));
    let seen = by_rays::path(&scene, &settings, Progress::NONE).series;
    assert_eq!(seen.image().total.mean, DVec3::ZERO);
    assert!(seen.cost.rays < 200 * seen.cost.paths, "{:?}", seen.cost);
}

#[test]
fn the_matrix_of_a_white_block_is_solved_where_light_is() {
    let d = with_block(DVec3::ONE);
    let m = dense(&d).unwrap();
    assert_eq!(m.unlit.len(), 6);
    assert!(m.unlit.iter().all(|u| !u.front && u.channels == [true; 3]), "{:?}", m.unlit);
    for (p, l) in m.radiosity.patches.iter().zip(&m.solution.radiance) {
        let right = if p.primitive >= 6 && !p.front { 0.0 } else { 2.0 };
        assert!((*l - right).abs().max_element() < 1e-3, "{} {}: {l}", p.primitive, p.front);
    }
    // the same by stored rays
    let settings = Settings { factors: Factors::Rays(64), max_bounces: 2, ..Settings::default() };
    let rays = sampled_matrix(&d, &Scene::new(&d), 200, 64, &settings, Progress::NONE).unwrap();
    assert_eq!(rays.unlit.len(), 6);
    // direct light is sampled patch by patch, so single patches are noisy
    let (mut area, mut light) = (0.0, DVec3::ZERO);
    for (p, l) in rays.radiosity.patches.iter().zip(&rays.solution.radiance) {
        match p.primitive >= 6 && !p.front {
            true => assert_eq!(*l, DVec3::ZERO),
            false => (area, light) = (area + p.area, light + p.area * *l),
        }
    }
    assert!((light / area - 2.0).abs().max_element() < 0.02, "{}", light / area);
}

/// An unlit cavity of albedo 0.95 is not what light decays by: the radius is that of the room around a black block.
#[test]
fn an_unlit_cavity_sets_no_rate() {
    // two sides share the patches that one has alone, so that the meshes differ a little
    let radius = |d: &Description| dense(d).unwrap().spectral.each_ref().map(|s| s.radius);
    let mut one_sided = with_block(DVec3::splat(0.95));
    let two_sided = radius(&one_sided);
    one_sided.materials[1].sides = Sides::Front;
    let [a, b] = [two_sided, radius(&one_sided)];
    assert!(a[0] < 0.65 && (0..3).all(|c| (a[c] - b[c]).abs() < 0.01), "{a:?} {b:?}");
}

/// Each channel has its own dark parts: a lamp without blue leaves the whole room dark in blue.
#[test]
fn channels_are_three_problems() {
    let d =
        description(&[(room(DVec3::NEG_ONE, DVec3::ONE, 0.0), DVec3::new(0.5, 0.5, 1.0), DVec3::new(1.0, 1.0, 0.0))]);
    assert_eq!(trapped(&Scene::new(&d)), None);
    let m = dense(&d).unwrap();
    assert!((m.spectral[0].radius - 0.5).abs() < 1e-5 && m.spectral[2].radius == 0.0);
    assert!(m.solution.radiance.iter().all(|l| (*l - DVec3::new(2.0, 2.0, 0.0)).abs().max_element() < 1e-4));
    // with blue light it is a trap, and in blue alone
    let mut lit = d;
    lit.shapes[0].emission = DVec3::ONE;
    assert_eq!(trapped(&Scene::new(&lit)), Some([false, false, true]));
}

#[test]
fn what_keeps_the_light_it_gets_is_refused() {
    let lamp = block(DVec3::splat(-0.1), DVec3::splat(0.1));
    let closed = |rho: f64| {
        let walls = (room(DVec3::NEG_ONE, DVec3::ONE, 0.0), DVec3::splat(rho), DVec3::ZERO);
        description(&[walls, (lamp.clone(), DVec3::splat(rho), DVec3::ONE)])
    };
    assert_eq!(trapped(&Scene::new(&closed(1.0))), Some([true; 3]));
    assert!(matches!(dense(&closed(1.0)), Err(MatrixError::Singular)));
    assert_eq!(trapped(&Scene::new(&closed(0.999))), None);
    // one lamp among many that is in a trap is found
    let far = |i: usize| {
        let at = DVec3::new(1.2 + 0.25 * (i % 8) as f64, 0.25 * (i / 8) as f64, 0.0);
        (sphere(at, 0.1, false), DVec3::splat(0.5), DVec3::ONE)
    };
    let mut many: Vec<Surface> = (0..40).map(far).collect();
    many.extend([
        (room(DVec3::NEG_ONE, DVec3::ONE, 0.0), DVec3::ONE, DVec3::ZERO),
        (lamp.clone(), DVec3::ONE, DVec3::ONE),
    ]);
    assert_eq!(trapped(&Scene::new(&description(&many))), Some([true; 3]));
}

/// Directions that glass reflects for ever are taken by no light from outside. A white sky: 1 everywhere.
#[test]
fn a_glass_box_in_a_white_sky_is_no_trap() {
    let mut d = description(&[(block(DVec3::splat(-0.5), DVec3::splat(0.5)), DVec3::ONE, DVec3::ZERO)]);
    d.materials[0].bsdf = BsdfDescription::Dielectric(DielectricSurface {
        ior: 1.5,
        ior_outside: 1.0,
        choice: Choice::Fresnel,
        rough: None,
    });
    d.lights = vec![LightDescription::Environment { sky: Sky::Constant(DVec3::ONE), rotate: 0.0, scale: 1.0 }];
    d.camera.origin = DVec3::new(0.3, 0.4, 2.0);
    let scene = with_last_resort(Scene::new(&d));
    assert_eq!(trapped(&scene), None);
    assert!(scene.last_resort().is_some());
    let settings = Settings { spp: 64, max_bounces: 3, ..Settings::default() };
    let path = by_rays::path(&scene, &settings, Progress::NONE).series;
    let total = path.image().total;
    assert!((total.mean - 1.0).abs().max_element() < 0.01 + 6.0 * total.std_error.max_element(), "{total:?}");
}

/// In a closed room errors of F are neither sources nor sinks: 0.1 % of a row sum would be 10 % of L at albedo 0.99.
#[test]
fn a_closed_room_loses_no_light_in_the_matrix() {
    let rho = 0.9999;
    let lamp = Geometry::Quad {
        origin: DVec3::new(-0.3, 0.9, -0.3),
        edge_u: DVec3::new(0.6, 0.0, 0.0),
        edge_v: DVec3::new(0.0, 0.0, 0.6),
    };
    let walls = (room(DVec3::NEG_ONE, DVec3::ONE, 0.0), DVec3::splat(rho), DVec3::ZERO);
    let mut d = description(&[walls, (lamp, DVec3::splat(rho), DVec3::splat(10.0))]);
    d.materials[1].sides = Sides::Both;
    let settings = Settings { max_bounces: 1, ..Settings::default() };
    let m = matrix(&d, &Scene::new(&d), 200, &settings, Progress::NONE).unwrap();
    let r = m.radiosity.dense().unwrap();
    let (area, light): (f64, f64) =
        r.patches.iter().zip(&m.solution.radiance).fold((0.0, 0.0), |a, (p, l)| (a.0 + p.area, a.1 + p.area * l.x));
    // ∫ E = (1 − ρ) ∫ L
    let right = 3.6 / (1.0 - rho);
    assert!((light / right - 1.0).abs() < 0.01, "{} {}", light / area, right / area);
}
