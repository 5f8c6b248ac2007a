//! The rendering equation as a test: it holds where it should, and what breaks it is found.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::{Judged, Jury, at};
use common::open;
use common::sampling::plan;
use common::scenes::{bands, description};
use fredholm::engine::Settings;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Equilibrium, Roulette, Technique};
use fredholm::math::{Key, Rgb};
use fredholm::operator::MatrixWalk;
use fredholm::operator::matrix_walk::Rows;
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::stats::Outcome;
use fredholm::study::equilibrium::{Balance, Judgement, Origin, aggregate, at_points, judge, points};
use glam::DVec3;

const END: Roulette = Roulette::Albedo { from: 2 };

/// On a matrix L is known: both slots have its rows as their means.
#[test]
fn both_sides_are_the_solution_on_a_matrix() {
    let mut jury = Jury::open("both_sides_are_the_solution_on_a_matrix");
    let rows = [[0.1, 0.5, 0.3], [0.4, 0.2, 0.3], [0.3, 0.3, 0.4]];
    let rho = [0.5, 0.6, 0.4].map(|r| Rgb::new(r, 0.9 * r, 0.7)).to_vec();
    let emission = [1.0, 0.5, 0.2].map(|e| Rgb::new(e, 1.0, 0.5 * e)).to_vec();
    let walk = MatrixWalk::new(rows.concat(), rho, emission);
    let powers = walk.powers(400);
    for technique in Technique::ALL {
        let estimator = Equilibrium { plan: plan(0, technique, &END), factor: 1.0 };
        let amount = Amount { spp: 1 << 18, replicates: 256, key: Key::new(jury.seed(), &technique.to_string()) };
        let film = render(&walk, &Rows(3), &estimator, amount, Progress::NONE);
        for row in 0..3 {
            let truth: DVec3 = powers.iter().map(|t| t[row]).sum();
            for slot in 0..2 {
                let what = format!("{technique}, row {row}, slot {slot}");
                let judged = jury.judge(&what, &at(&film, row, slot..slot + 1), truth, 0.02 * truth, 0.1 * truth);
                assert_ne!(judged, Judged::TooNoisy, "{what}");
            }
        }
    }
    jury.assert_power(0.9, 0.0);
}

/// A ball of three colours, all of which glow; the camera stands in the middle.
fn ball() -> Scene {
    Scene::new(&description(&bands(1.0, &[1.0, 0.4, -0.3, -1.0], &[0.4, 0.25, 0.3], &[1.0, 0.6, 0.8])))
}

fn balances(scene: &Scene, settings: &Settings, factor: f32) -> [Vec<Balance>; 2] {
    [Origin::Surface, Origin::Camera].map(|from| {
        let at = points(scene, from, 24, settings.seed);
        assert_eq!(at.len(), 24);
        let settings = Settings { seed: settings.seed ^ from as u64, ..settings.clone() };
        at_points(scene, &at, &settings, factor, Progress::NONE)
    })
}

fn verdict([surface, camera]: &[Vec<Balance>; 2], alpha: f64) -> Judgement {
    judge(&[("surface", surface), ("camera", camera)], alpha, 0.01)
}

#[test]
fn the_equation_holds_and_a_wrong_step_is_found() {
    let mut account = open("the_equation_holds_and_a_wrong_step_is_found");
    let scene = ball();
    let settings = Settings { spp: 1 << 13, seed: account.seed(), path_roulette: END, ..Settings::default() };
    // the whole judgement is one comparison for each way of estimating L
    for technique in [Technique::Scatter, Technique::Connect, Technique::Mis] {
        let settings = Settings { technique, ..settings.clone() };
        let right = verdict(&balances(&scene, &settings, 1.0), account.spend(1));
        assert_eq!(right.outcome, Outcome::Agrees, "{technique}: {right:?}");
        assert!(right.judged == 48 && right.rejected.is_empty());
    }
    for factor in [0.98, 1.02] {
        let wrong = balances(&scene, &settings, factor);
        let judgement = verdict(&wrong, account.spend(1));
        assert_eq!(judgement.outcome, Outcome::Differs, "× {factor}: {judgement:?}");
        // by how much: (1 − factor) T L
        let all: Vec<&Balance> = wrong.iter().flatten().collect();
        let share =
            aggregate(&all).mean.x / (all.iter().map(|b| b.left.mean.x - b.emission.x).sum::<f64>() / all.len() as f64);
        assert!((share - (1.0 - f64::from(factor))).abs() < 0.005, "{share}");
    }
    // paths that are cut solve no such equation: E + T S_K is S_{K+1}
    let cut = Settings { max_bounces: 3, path_roulette: Roulette::Never, ..settings.clone() };
    assert_eq!(verdict(&balances(&scene, &cut, 1.0), account.spend(1)).outcome, Outcome::Differs);
}
