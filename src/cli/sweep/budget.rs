//! `--equal-rays` and `--equal-time`: every value gets the samples that fit into the cost of the most expensive one.
//!
//! ```text
//! n_i = n · max_j c_j / c_i        c: rays, or seconds, of one sample of value i
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | `--spp` | `Settings::spp` before [`share`] |
//! | n_i | samples per pixel of value i, 1 to 2²⁴ | `Settings::spp` after it |
//! | c_i | cost of a sample, measured by a pilot | [`costs`] |

use super::case::Case;
use fredholm::engine::Settings;
use fredholm::engine::by_rays;
use fredholm::engine::timing::seconds_per_sample;
use fredholm::progress::Progress;
use fredholm::report::figures::sweep::Budget;
use fredholm::scene::Scene;

/// Most samples per pixel of a value.
const MOST: f64 = (1u32 << 24) as f64;
/// Pilots of every value that are timed; the shortest counts, because other load on the machine can only add time.
const TURNS: usize = 2;

/// Sets the samples per pixel of every case. Changes nothing if the pilots were interrupted.
pub fn share(budget: Budget, cases: &mut [Case], scene: &Scene, progress: Progress<'_>) {
    let costs = costs(budget, cases, scene, progress);
    if progress.stopped() {
        return;
    }
    let dearest = costs.iter().copied().fold(0.0, f64::max);
    for (case, cost) in cases.iter_mut().zip(costs) {
        let spp = f64::from(case.settings.spp) * dearest / cost;
        case.settings.spp = spp.round().clamp(1.0, MOST) as u32;
    }
}

/// Rays, or seconds, of one sample of every case. A trial with one sample per pixel counts the rays. The pilots that are timed
/// take turns, so that a change of the load on the machine affects all of them.
fn costs(budget: Budget, cases: &[Case], scene: &Scene, progress: Progress<'_>) -> Vec<f64> {
    let rays = |case: &Case| {
        let trial = Settings { spp: 1, ..case.settings.clone() };
        let cost = by_rays::terms(scene, case.estimator, &trial, progress.silent()).series.cost;
        cost.rays as f64 / cost.paths as f64
    };
    if budget == Budget::Rays {
        return cases.iter().map(rays).collect();
    }
    let mut least = vec![f64::INFINITY; cases.len()];
    for _ in 0..TURNS {
        for (least, case) in least.iter_mut().zip(cases) {
            *least = least.min(seconds_per_sample(scene, case.estimator, &case.settings, progress));
        }
    }
    least
}
