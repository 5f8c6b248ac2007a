//! The discrete world against closed forms.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod discrete;
use discrete::*;
use fredholm::operator::form_factor::*;
use fredholm::operator::matrix::*;
use fredholm::operator::patches::*;
use fredholm::solver::*;

/// Not a test of the result: prints what the form factors cost. `cargo test --release -- --ignored timings --nocapture`
#[test]
#[ignore = "a benchmark"]
fn timings() {
    struct Everything(BruteForce);
    impl Visibility for Everything {
        fn visible(&self, a: SurfacePoint, b: SurfacePoint) -> bool {
            self.0.visible(a, b)
        }
    }
    let run = |name: &str, scene: &fredholm::scene::Description, n: usize, visibility: &dyn Visibility| {
        let (wall, cpu) = (std::time::Instant::now(), cpu_seconds());
        let patches = Patches::new(scene, n).unwrap();
        let mesh = cpu_seconds() - cpu;
        let f = FormFactors::new(&patches, visibility, Sampling::default(), Watch::default()).unwrap();
        println!(
            "{name} n = {}: mesh {mesh:.2}, all {:.2} CPU-s, {:.2} s wall, {:.1} M rays, {:?}",
            f.n,
            cpu_seconds() - cpu,
            wall.elapsed().as_secs_f64(),
            f.rays as f64 * 1e-6,
            f.invariants()
        );
        f
    };
    let cube = room(glam::DVec3::ONE, [0.5; 6], [0.0; 6]);
    run("cube", &cube, 1944, &BruteForce::new(&cube));
    let box_ = cornell();
    for n in [600, 2305] {
        let f = run("cornell", &box_, n, &BruteForce::new(&box_));
        run("cornell, rays against everything", &box_, n, &Everything(BruteForce::new(&box_)));
        let patches = Patches::new(&box_, n).unwrap();
        println!("covered {}", patches.covered_area());
        let r = Radiosity::new(patches, f);
        println!("{:?}", r.spectral_radius().map(|s| (s.radius, s.steps)));
        let cpu = cpu_seconds();
        println!("{:?} residual, {:.2} CPU-s", r.solve().unwrap().residual, cpu_seconds() - cpu);
    }
}
