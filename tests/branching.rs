//! Naive branching against what is known of it: the prefix estimator at N = 1, matrix powers, N^k rays, and the
//! variance that N children leave.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::judge::{Judged, Jury, at};
use common::sampling::{TECHNIQUES, collect, mean_of, plan};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Branching, Plan, Prefix, Roulette, Technique};
use fredholm::math::{Key, Points, Rgb};
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::{MatrixWalk, SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::scene::load::{self, Options};
use glam::DVec3;

const ROWS: [[f64; 4]; 4] = [[0.0, 0.3, 0.3, 0.4], [0.4, 0.1, 0.2, 0.3], [0.3, 0.3, 0.1, 0.2], [0.5, 0.0, 0.4, 0.1]];
const RHO: [Rgb; 4] =
    [Rgb::new(0.5, 0.3, 0.58), Rgb::new(0.55, 0.5, 0.4), Rgb::new(0.3, 0.58, 0.5), Rgb::new(0.58, 0.4, 0.45)];

fn walk() -> MatrixWalk {
    let emission = vec![Rgb::new(1.0, 2.0, 3.0), Rgb::ZERO, Rgb::new(0.2, 0.1, 0.5), Rgb::ZERO];
    MatrixWalk::new(ROWS.concat(), RHO.to_vec(), emission)
}

fn scene(name: &str) -> Scene {
    let mut d = load::scene(name, &Options::default()).unwrap().description;
    d.camera.size = [4, 4];
    Scene::new(&d)
}

fn same<T: Transport>(t: &T, sensor: &impl Sensor<T>, plan: &Plan, key: Key) {
    let prefix = collect(t, sensor, &Prefix(plan.clone()), 48, 16, key);
    let one = collect(t, sensor, &Branching { plan: plan.clone(), children: 1 }, 48, 7, key);
    assert_eq!(one.values, prefix.values, "{plan:?}");
    assert_eq!(one.rays, prefix.rays, "{plan:?}");
    let two = collect(t, sensor, &Branching { plan: plan.clone(), children: 2 }, 48, 16, key);
    assert_ne!(two.values, prefix.values, "two children are not one: {plan:?}");
}

#[test]
fn one_child_is_the_prefix_bit_for_bit() {
    let (cornell, furnace) = (scene("cornell"), scene("furnace"));
    for technique in TECHNIQUES {
        for roulette in ["none", "lecture", "constant:0.3@0", "albedo@1", "throughput@1", "albedo@4"] {
            for points in [Points::Independent, Points::Sobol] {
                let key = Key::new(7, "same").with_points(points, 16);
                let plan = plan(4, technique, &roulette.parse().unwrap());
                same(&walk(), &Rows(4), &plan, key);
                same(&SceneTransport::new(&cornell), &cornell.camera, &plan, key);
            }
        }
    }
    // K = 0 has nothing to branch
    let zero = Branching { plan: plan(0, Technique::Mis, &Roulette::LECTURE), children: 5 };
    let t = SceneTransport::new(&furnace);
    let key = Key::new(1, "zero");
    let all = collect(&t, &furnace.camera, &zero, 16, 16, key);
    assert_eq!(all.values, collect(&t, &furnace.camera, &Prefix(zero.plan.clone()), 16, 16, key).values);
}

/// In a closed furnace no path is lost: depth k takes exactly N^k rays of each technique.
#[test]
fn rays_grow_as_powers_of_the_children() {
    let furnace = scene("furnace");
    let t = SceneTransport::new(&furnace);
    let k_max = 5u32;
    for children in 1..=4u32 {
        for technique in TECHNIQUES {
            let plan = plan(k_max as usize, technique, &Roulette::Never);
            let rays = collect(&t, &furnace.camera, &Branching { plan, children }, 8, 8, Key::new(2, "rays")).rays;
            let paths = 16 * 8;
            let expected = |k: u32| {
                let each = match technique {
                    Technique::Scatter => 1,
                    Technique::Mis | Technique::Power => 2,
                    // what follows the last connection is of no use
                    Technique::Connect => 1 + u64::from(k < k_max),
                };
                if k == 0 { paths } else { paths * each * u64::from(children).pow(k) }
            };
            for k in 0..=k_max {
                assert_eq!(rays[k as usize], expected(k), "N = {children}, {technique}, k = {k}");
            }
            assert_eq!(rays[k_max as usize + 1], 0, "no roulette, no tail");
        }
    }
}

#[test]
fn a_tree_has_the_powers_of_the_matrix() {
    let mut jury = Jury::open("a_tree_has_the_powers_of_the_matrix");
    let (walk, k) = (walk(), 4);
    let (powers, long) = (walk.powers(k), walk.powers(80));
    let whole: Vec<DVec3> = (0..4).map(|i| long.iter().map(|t| t[i]).sum()).collect();
    for children in 1..=3 {
        for technique in TECHNIQUES {
            for roulette in ["none", "constant:0.2@0", "albedo@1"] {
                let roulette: Roulette = roulette.parse().unwrap();
                let name = format!("tree {children} {technique} {roulette}");
                let amount = Amount { spp: 1 << 15, replicates: 256, key: Key::new(jury.seed(), &name) };
                let tree = Branching { plan: plan(k, technique, &roulette), children };
                let film = render(&walk, &Rows(4), &tree, amount, Progress::NONE);
                for row in 0..4 {
                    for (s, term) in powers.iter().enumerate() {
                        jury.part(
                            &format!("{name}, T{s}, row {row}"),
                            &at(&film, row, s..s + 1),
                            term[row],
                            whole[row],
                        );
                    }
                    if roulette.ends() {
                        jury.part(
                            &format!("{name}, total, row {row}"),
                            &at(&film, row, 0..k + 2),
                            whole[row],
                            whole[row],
                        );
                    }
                }
            }
        }
    }
    jury.assert_power(0.18, 0.0);
}

/// Children are independent, so with scattering alone `V_k(i) = 1/N · ( Σ_j F_ij ρ_i² (V_{k−1}(j) + m_{k−1}(j)²) −
/// m_k(i)² )` and V_0 = 0. Siblings or cousins that shared a random number would show.
#[test]
fn variances_follow_the_recursion_of_independent_children() {
    let mut jury = Jury::open("variances_follow_the_recursion_of_independent_children");
    let (walk, k) = (walk(), 3);
    let m = walk.powers(k);
    for children in [1u32, 2, 4] {
        let mut exact = vec![vec![DVec3::ZERO; 4]];
        for s in 1..=k {
            let row = |i: usize| {
                let second = |j: usize| ROWS[i][j] * (exact[s - 1][j] + m[s - 1][j].powf(2.0));
                let rho = RHO[i].as_dvec3();
                (rho * rho * (0..4).map(second).sum::<DVec3>() - m[s][i].powf(2.0)) / f64::from(children)
            };
            exact.push((0..4).map(row).collect());
        }
        let tree = Branching { plan: plan(k, Technique::Scatter, &Roulette::Never), children };
        let key = Key::new(jury.seed(), "variance").branch(children);
        let all = collect(&walk, &Rows(4), &tree, 1 << 17, 256, key);
        for s in 1..=k {
            for row in 0..4 {
                let squares: Vec<DVec3> =
                    (0..1 << 17).map(|i| (all.path(row as u32, i)[s] - m[s][row]).powf(2.0)).collect();
                let measured = mean_of(squares.into_iter());
                let (v, what) = (exact[s][row], format!("N = {children}, variance of T{s}, row {row}"));
                let judged = jury.judge(&what, &measured, v, 0.05 * v, 0.3 * v);
                assert_ne!(judged, Judged::TooNoisy, "{what}: {measured:?}, exact {v}");
            }
        }
    }
    jury.assert_power(0.2, 0.0);
}
