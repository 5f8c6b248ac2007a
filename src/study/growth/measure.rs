//! The work of one process.

use super::Subject;
use super::scenes::lamps;
use crate::engine::Settings;
use crate::engine::by_matrix::MatrixError;
use crate::engine::by_rays::{self, Estimator};
use crate::estimator::Roulette;
use crate::operator::form_factor::{FormFactors, VisibilitySampling};
use crate::operator::patches::Patches;
use crate::operator::rays::{Half, Light, Rays};
use crate::progress::Progress;
use crate::scene::load::{self, Options};
use crate::scene::{Scene, SceneError};
use crate::solver::{Neumann, Radiosity, direct};
use std::path::Path;
use std::time::Instant;

/// Products with T that are timed: as many as bring the Neumann series of the Cornell box to 1 %.
const PRODUCTS: usize = 30;
/// Stored rays of a patch.
const PER_ROW: usize = 64;

/// Seconds of each of the [`Subject::parts`] at size `n`, by the clock `cpu`, which returns the CPU seconds of this process so far.
/// The triangles are read from the OBJ file `mesh`. The work has one thread, except for [`Subject::Threads`].
///
/// # Errors
/// If the mesh cannot be read, or if the threads cannot be started.
pub fn measure(
    subject: Subject,
    n: u64,
    seed: u64,
    mesh: &Path,
    cpu: &(dyn Fn() -> f64 + Sync),
) -> Result<Vec<f64>, MatrixError> {
    let threads = if subject == Subject::Threads { n as usize } else { 1 };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| SceneError::new(format!("cannot start {threads} threads: {e}")))?;
    pool.install(|| work(subject, n, seed, mesh, cpu))
}

fn work(subject: Subject, n: u64, seed: u64, mesh: &Path, cpu: &dyn Fn() -> f64) -> Result<Vec<f64>, MatrixError> {
    let settings = |spp: u32, max_bounces: usize, roulette: Roulette| Settings {
        spp,
        max_bounces,
        roulette,
        seed,
        ..Settings::default()
    };
    let by_albedo = |k: usize| Roulette::Albedo { from: 2 }.after(k);
    let shown = |scene: &str, side: u64, estimator, settings: &Settings| {
        let scene = Scene::new(&built_in(scene, side)?.description);
        Ok(vec![timed(cpu, || by_rays::terms(&scene, estimator, settings, Progress::NONE)).0])
    };
    let k = n as usize;
    match subject {
        Subject::Samples => shown("cornell", 32, Estimator::Prefix, &settings(n as u32, 8, by_albedo(8))),
        Subject::Pixels => shown("cornell", n.isqrt(), Estimator::Prefix, &settings(16, 8, by_albedo(8))),
        // closed, so that no path leaves: the length of a path is K, or decided by roulette
        Subject::Together => shown("furnace", 32, Estimator::Prefix, &settings(256, k, Roulette::Never)),
        Subject::Separate => shown("furnace", 32, Estimator::Single, &settings(256, k, Roulette::Never)),
        Subject::Roulette => shown("furnace", 32, Estimator::Prefix, &settings(256, k, Roulette::Albedo { from: 2 })),
        Subject::Triangles => {
            let set = ["origin=[0.9,0.3,0.95]", "target=[0,-0.1,0]", "fov=60", "size=[64,64]"];
            let options = Options { set: set.map(|s| format!("camera.{s}")).into(), ..Options::default() };
            let name = mesh.to_string_lossy();
            let (load, scene) =
                timed(cpu, || load::scene(&name, &options).map(|l| l.description).map(|d| Scene::new(&d)));
            let scene = scene?;
            Ok(vec![load, render(&scene, &settings(64, 4, by_albedo(4)), cpu)])
        }
        Subject::Lights => {
            let text = lamps(n);
            let file = Path::new("lamps.toml");
            let read = || load::toml(&text, file, &Options::default()).map(|l| l.description).map(|d| Scene::new(&d));
            let (load, scene) = timed(cpu, read);
            let scene = scene?;
            Ok(vec![load, render(&scene, &settings(256, 4, by_albedo(4)), cpu)])
        }
        Subject::Dense => dense(k, cpu),
        Subject::Rays => rays(k, seed, cpu),
        Subject::Threads => {
            let scene = Scene::new(&built_in("cornell", 128)?.description);
            let wall = Instant::now();
            let render = render(&scene, &settings(64, 8, by_albedo(8)), cpu);
            Ok(vec![wall.elapsed().as_secs_f64(), render])
        }
    }
}

/// Time of some work, and its result.
fn timed<R>(cpu: &dyn Fn() -> f64, work: impl FnOnce() -> R) -> (f64, R) {
    let before = cpu();
    let result = work();
    (cpu() - before, result)
}

fn render(scene: &Scene, settings: &Settings, cpu: &dyn Fn() -> f64) -> f64 {
    timed(cpu, || by_rays::terms(scene, Estimator::Prefix, settings, Progress::NONE)).0
}

fn built_in(name: &str, side: u64) -> Result<load::Loaded, SceneError> {
    load::scene(name, &Options { set: vec![format!("camera.size=[{side},{side}]")], ..Options::default() })
}

/// The Cornell box as a dense matrix: F, products with T, and LU, of the red channel.
fn dense(n: usize, cpu: &dyn Fn() -> f64) -> Result<Vec<f64>, MatrixError> {
    let description = built_in("cornell", 32)?.description;
    let scene = Scene::new(&description);
    let patches = Patches::new(&description, n)?;
    let (factors, f) = timed(cpu, || FormFactors::new(&patches, &scene, VisibilitySampling::default(), Progress::NONE));
    let radiosity = Radiosity::new(patches, f.map_err(|_| MatrixError::Stopped)?);
    let (operator, emission) = (radiosity.operator(0), radiosity.emission(0));
    let (products, _) = timed(cpu, || Neumann::new(&operator, emission.clone()).take(PRODUCTS).last());
    let (lu, solved) = timed(cpu, || direct::solve(&operator, &emission));
    solved.map_err(|_| MatrixError::Singular)?;
    Ok(vec![factors, products, lu])
}

/// The Cornell box as stored rays: the rays, and products with T in three channels.
fn rays(n: usize, seed: u64, cpu: &dyn Fn() -> f64) -> Result<Vec<f64>, MatrixError> {
    let description = built_in("cornell", 32)?.description;
    let scene = Scene::new(&description);
    let patches = Patches::new(&description, n)?;
    let (traced, rays) = timed(cpu, || Rays::new(&patches, &scene, PER_ROW, seed, Progress::NONE));
    let rays = rays.map_err(|_| MatrixError::Stopped)?;
    let light = Light { patches: &patches, rays: &rays };
    let mut x = light.direct();
    let (products, ()) = timed(cpu, || (0..PRODUCTS).for_each(|_| x = light.bounce(&x, Half::Both)));
    Ok(vec![traced, products])
}
