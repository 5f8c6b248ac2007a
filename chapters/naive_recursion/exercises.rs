//! Exercises of chapter 5 that the program judges.
//!
//! ```text
//! 1 + N + … + N^K rays      V_1 C_1 = (a_0 + a_1/N)(c_0 + c_1 N)      share of depth K = rays of depth K/all rays
//! ```
//!
//! | exercise | truth |
//! |---|---|
//! | 5.1 | the count of every depth |
//! | 5.2 | closed form |
//! | 5.5 | measured: the rays that the library requests in the Cornell box |

use super::load;
use fredholm::engine::Settings;
use fredholm::estimator::Branching;
use fredholm::estimator::render::{Amount, render};
use fredholm::operator::SceneTransport;
use fredholm::progress::Progress;
use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, Mistake, Result, Student, Task, Unit};
use fredholm::report::text::number::{percent, significant};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[RAYS, PRICE, LAST_DEPTH];

const RAYS: Exercise = Exercise {
    number: 1,
    title: "rays of a tree",
    question: |s| {
        let (n, k) = tree(s);
        format!(
            "A renderer sends N = {n} rays from every hit and stops after K = {k} reflections. No ray leaves the scene. How many \
             rays does it trace for one camera ray, the camera ray included?"
        )
    },
    task: Task::Number {
        unit: Unit::Count,
        margin: 0.0,
        truth: |s| Ok(exact(all(tree(s)) as f64)),
        mistakes: |s| {
            let (n, k) = tree(s);
            vec![
                Mistake { value: n.pow(k) as f64, says: "These are only the rays of the last depth." },
                Mistake { value: (all((n, k)) - 1) as f64, says: "The camera ray is missing." },
                Mistake {
                    value: all((n, k - 1)) as f64,
                    says: "The last depth is missing: K reflections need K + 1 depths.",
                },
            ]
        },
    },
    hint: "Depth 0 has one ray, depth 1 has N rays, depth 2 has N² rays, up to depth K.",
    solution: |s| {
        let (n, k) = tree(s);
        let depths: Vec<String> = (0..=k).map(|j| n.pow(j).to_string()).collect();
        format!("{} = {} rays.", depths.join(" + "), all((n, k)))
    },
};

/// N and K.
fn tree(s: &Student) -> (u64, u32) {
    (s.pick("5.1 N", &[3, 4, 5, 6, 7, 8, 9]), s.pick("5.1 K", &[2, 3, 4, 5, 6]))
}

/// 1 + N + … + N^K.
fn all((n, k): (u64, u32)) -> u64 {
    (0..=k).map(|j| n.pow(j)).sum()
}

fn exact(value: f64) -> Number {
    Number { value, std_error: 0.0 }
}

const PRICE: Exercise = Exercise {
    number: 2,
    title: "the price of more rays for direct light",
    question: |s| {
        let (a, n) = direct(s);
        format!(
            "In one pixel the variance of direct light is a₀ + a₁/N with a₀ = {a} and a₁ = {}. A tree takes 1 + 2N rays. Predict: \
             how many times the rays of N = 1 does N = {n} need for the same error? (Below 1 it is better than N = 1.) Give three \
             digits.",
            significant(1.0 - a, 2)
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| Ok(exact(price(s))),
        mistakes: |s| {
            let (a, n) = direct(s);
            vec![
                Mistake { value: a + (1.0 - a) / n, says: "This is the variance. The rays are missing." },
                Mistake { value: (1.0 + 2.0 * n) / 3.0, says: "These are the rays. The variance is missing." },
                Mistake {
                    value: (1.0 + 2.0 * n) / (3.0 * n),
                    says: "Here all of the variance falls as 1/N. a₀ is decided by the camera ray, which all N rays share.",
                },
            ]
        },
    },
    hint: "Compute variance × rays for both N, and divide.",
    solution: |s| {
        let (a, n) = direct(s);
        format!(
            "N = 1: variance 1, 3 rays, product 3. N = {n}: variance {a} + {}/{n} = {}, {} rays. The ratio is {}·{}/3 = {}.",
            significant(1.0 - a, 2),
            significant(a + (1.0 - a) / n, 4),
            1.0 + 2.0 * n,
            significant(a + (1.0 - a) / n, 4),
            1.0 + 2.0 * n,
            significant(price(s), 4)
        )
    },
};

/// a_0 and N; a_0 + a_1 = 1.
fn direct(s: &Student) -> (f64, f64) {
    (s.pick("5.2 camera ray", &[0.08, 0.1, 0.15, 0.2, 0.3, 0.4]), s.pick("5.2 N", &[2.0, 3.0, 4.0, 5.0, 6.0, 8.0]))
}

/// V C of N over V C of 1.
fn price(s: &Student) -> f64 {
    let (a, n) = direct(s);
    (a + (1.0 - a) / n) * (1.0 + 2.0 * n) / 3.0
}

const LAST_DEPTH: Exercise = Exercise {
    number: 5,
    title: "the rays of the last depth in the Cornell box",
    question: |s| {
        let (n, k) = measured(s);
        format!(
            "Run `fredholm series cornell --estimator branching --branching {n} --max-bounces {k} --spp 16 --size 32x32 --patches \
             60 --verbose`. Its table has a column of rays. Which share of the rays of k = 0 to {k} is in the row k = {k}?"
        )
    },
    task: Task::Number {
        unit: Unit::Share,
        margin: 0.015,
        truth: share,
        mistakes: |s| {
            let (n, k) = measured(s);
            vec![Mistake {
                value: n.pow(k) as f64 / all((n, k)) as f64,
                says: "This is the share in a closed room with one ray per child. Read the column: rays leave the open box, and \
                       every hit also sends rays to the lamp.",
            }]
        },
    },
    hint: "Add the numbers of the column from k = 0 to K, and divide the last of them by the sum.",
    solution: |s| {
        let (n, k) = measured(s);
        let share = share(s).map_or(f64::NAN, |x| x.value);
        format!(
            "The row k = {k} has {} of the rays. In a closed room with one ray per child it would be N^K/(1 + … + N^K) = {}. The \
             last term holds little light, and yet it takes the largest part of the rays.",
            percent(share),
            percent(n.pow(k) as f64 / all((n, k)) as f64)
        )
    },
};

/// N and K of the command.
fn measured(s: &Student) -> (u64, u32) {
    s.pick("5.5 N and K", &[(2, 2), (2, 3), (2, 4), (3, 2), (3, 3), (4, 2), (4, 3)])
}

/// Rays of depth K over the rays of all depths; its error from 8 independent renders.
fn share(s: &Student) -> Result<Number> {
    let (n, k) = measured(s);
    let scene = load("cornell", 32)?;
    let settings = Settings { seed: s.seed(), ..Settings::default() };
    let plan =
        Settings { max_bounces: k as usize, roulette: settings.path_roulette.clone().after(k as usize), ..settings };
    let estimator = Branching { plan: plan.plan(), children: n as u32 };
    let one = |i: u32| {
        let amount = Amount::new(1, plan.key("rays of the last depth", 1).branch(i));
        let film = render(&SceneTransport::new(&scene), &scene.camera, &estimator, amount, Progress::NONE);
        film.rays[k as usize] as f64 / film.rays[..=k as usize].iter().sum::<u64>() as f64
    };
    let shares: Vec<f64> = (0..8).map(one).collect();
    let mean = shares.iter().sum::<f64>() / 8.0;
    let squares = shares.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    Ok(Number { value: mean, std_error: (squares / (7.0 * 8.0)).sqrt() })
}
