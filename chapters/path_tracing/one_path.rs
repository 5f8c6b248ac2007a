//! One path, all terms: the loop of the lecture, with the rules of emission as data.
//!
//! ```text
//! X_0     = w_e E(x_0),   α_0 = 1
//! X_{v+1} = α_v w_c (f cos θ/p)(x_v, y) E(y)  +  α_{v+1} w_s E(x_{v+1})      α_{v+1} = α_v (f cos θ/p)(x_v, x_{v+1})
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_v, α_v | vertex v of the path, and the throughput there | `x`, `alpha` in [`follow`] |
//! | y | point on a lamp | [`Kernel::sample_emitter`] |
//! | p, p° | density of the way that found a point, and of the other way | [`Factors::pair`](fredholm::operator::Factors) |
//! | w_e, w_c, w_s | weights of emission | [`Rules`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

use super::{LAST, scene};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Job, PathTracer, Paths, Plan, Roulette, Technique, TermEstimator, TermSink};
use fredholm::math::{Columns, Key, Purpose, Rgb, Rng};
use fredholm::operator::{Kernel, SceneTransport, Sensor};
use fredholm::report::book::{self, Folder};

// ANCHOR: rules
/// The weights with which emission counts.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// w_e: emission that the eye sees directly.
    pub eye: f32,
    /// w_c: emission found by a connection, from [p, p°].
    pub connection: fn([f32; 2]) -> f32,
    /// w_s: emission found by a hit, from [p, p°].
    pub hit: fn([f32; 2]) -> f32,
}

impl Rules {
    /// Connections find the light. A hit counts only where no connection is possible, which is after a mirror or glass.
    pub const CONNECT: Self =
        Self { eye: 1.0, connection: |_| 1.0, hit: |[_, other]| f32::from(u8::from(other == 0.0)) };
    /// Both find the light, with weights that sum to 1.
    pub const MIS: Self = Self { eye: 1.0, connection: balance, hit: balance };
}

fn balance([p, other]: [f32; 2]) -> f32 {
    p / (p + other)
}
// ANCHOR_END: rules

// ANCHOR: loop
/// Follows one path from x_0. Calls `score(k, x)` for everything that it finds of the term k.
fn follow<T: Kernel>(
    t: &T,
    x0: T::State,
    rules: &Rules,
    numbers: impl Fn(usize, Purpose) -> Rng,
    mut score: impl FnMut(usize, Rgb),
) {
    let (mut x, mut alpha) = (x0, t.lit());
    score(0, t.emission(&x) * rules.eye);
    for v in 0..LAST {
        // a connection from x_v to a point y on a lamp
        if let Some(y) = t.sample_emitter(&x, &mut numbers(v, Purpose::Connect)) {
            score(v + 1, alpha * y.f * (y.cos / y.pdf) * t.emission(&y.state) * (rules.connection)(y.pair));
        }
        // the next vertex
        let Some(next) = t.sample_direction(&x, &mut numbers(v, Purpose::Scatter)) else { break };
        alpha *= next.f * (next.cos / next.pdf);
        x = next.state;
        // a hit: x_{v+1} may lie on a lamp
        score(v + 1, alpha * t.emission(&x) * (rules.hit)(next.pair));
    }
}
// ANCHOR_END: loop

/// The loop as an estimator: slot k holds the term k.
struct OnePath(Rules);

impl<T: Kernel> TermEstimator<T> for OnePath {
    fn slots(&self) -> usize {
        LAST + 1
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let mut value = Columns::new(1);
        for (sample, pixel) in batch.samples.clone().flat_map(|s| batch.pixels.clone().map(move |p| (s, p))) {
            let numbers = |v: usize, purpose: Purpose| Rng::at(batch.key, pixel, sample, v, purpose);
            let Some(x0) = sensor.start(t, pixel, &mut numbers(0, Purpose::Start)) else { continue };
            follow(t, x0, &self.0, numbers, |k, x| {
                value.set(0, x);
                sink.add(k, &[pixel], &[sample], &value);
            });
        }
    }
}

// ANCHOR: difference
/// Renders `cornell-spheres` with the loop and with the library's path tracer, once with connections and once with both ways
/// and MIS weights. The two programs draw the same random numbers. Returns the largest difference of a pixel and a channel,
/// in units of the mean of the image.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn difference(folder: &Folder<'_>, rules: [Rules; 2]) -> book::Result<[f64; 2]> {
    let room = scene("cornell-spheres", 64)?;
    let (t, amount) = (SceneTransport::new(&room), Amount::new(folder.pick(32, 8), Key::new(folder.seed, "loop")));
    let compared = |technique: Technique, rules: Rules| {
        let library = PathTracer(Plan { max_bounces: LAST, technique, roulette: Roulette::Never });
        let ours = render(&t, &room.camera, &OnePath(rules), amount, folder.progress);
        let theirs = render(&t, &room.camera, &library, amount, folder.progress);
        let pixels = 0..theirs.shape.pixels();
        let apart = |p: usize| (ours.pixel(p, 0..LAST + 1).0 - theirs.pixel(p, 0..1).0).abs().max_element();
        let mean =
            pixels.clone().map(|p| theirs.pixel(p, 0..1).0.element_sum() / 3.0).sum::<f64>() / pixels.len() as f64;
        pixels.map(apart).fold(0.0, f64::max) / mean
    };
    Ok([compared(Technique::Connect, rules[0]), compared(Technique::Mis, rules[1])])
}
// ANCHOR_END: difference
