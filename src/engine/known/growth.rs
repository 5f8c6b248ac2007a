//! Measures whether the variance of long paths is finite: the growth of the second moment of their weight.
//!
//! ```text
//! M = E[ w²/s · … ]: second moments from vertex to vertex        Var[Σ_k α_k E(x_k)] < ∞  if  r(M) < 1, or if α stays bounded and r(T) < 1
//!
//! n walkers with throughputs α:   one step each, factor (α'/α)²·s   →   g = mean factor   →   resampled in proportion to it
//! r(M) ≈ exp(mean of ln g over the last steps)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | w | weight of a step; it depends on the material, the guide and the sampling of directions | |
//! | s | survival probability of roulette, more than 1 where paths split | [`WeightedWalk::q`] |
//! | r(M) | growth per vertex, with its standard error from independent populations | [`Growth::rate`] |
//! | max α | the largest throughput that any walker had | [`Growth::largest`] |
//!
//! Resampling keeps the number of walkers constant while M acts on them. As in a power iteration, the walkers gather where
//! second moments are large. A part of the scene that no walker finds is not measured. If all surfaces are Lambertian,
//! nothing has to be measured, and [`proved`] returns true: with s = ρ, M is T itself, and with constant s it is bounded by
//! max ρ²/s.
//!
//! Reference: the same method finds the largest eigenvalue of transfer operators, with walkers that multiply and die;
//! Grassberger, *Go with the winners* (2002).

use crate::engine::Settings;
use crate::estimator::Roulette;
use crate::math::{Key, Purpose, Rgb, Rng, Streams};
use crate::operator::{Adjoint, Role, Samples, Sensor, Steps, Transport, Wave};
use crate::scene::bsdf::{Bsdf, Sampling};
use crate::scene::{Scene, Vertex};
use crate::terms::Variance;
use rayon::prelude::*;

/// Number of independent populations, walkers in each, steps of each walker, and the first step that counts.
const POPULATIONS: u32 = 8;
const WALKERS: usize = 256;
const STEPS: usize = 96;
const SETTLED: usize = 40;
/// Number of standard errors by which a rate must differ from 1. With seven degrees of freedom the decision is wrong once in
/// 200 times.
pub(crate) const CLEAR: f64 = 4.0;
/// A throughput above this value has grown, and not only by rounding.
const GROWN: f32 = 1.001;

/// Growth of a moment of the weight in one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Factor by which the moment grows per vertex.
    pub rate: f64,
    /// Standard error of the factor.
    pub std_error: f64,
    /// The largest throughput of any walker.
    pub largest: f32,
}

impl Growth {
    /// Tells whether the variance is finite, as far as this growth shows.
    pub fn variance(&self) -> Variance {
        let off = CLEAR * self.std_error;
        if self.largest <= GROWN || self.rate + off < 1.0 {
            Variance::Finite
        } else if self.rate - off > 1.0 {
            Variance::Infinite
        } else {
            Variance::Unknown
        }
    }

    /// A sentence that follows the name of what is estimated; None if the variance is finite.
    pub fn doubt(&self) -> Option<String> {
        let Self { rate, std_error, .. } = self;
        let what = match self.variance() {
            Variance::Finite => return None,
            Variance::Infinite => "has infinite variance",
            Variance::Unknown => "may have infinite variance",
        };
        Some(format!(
            "{what}:\nthe second moment of a path's weight grows by a factor of {rate:.4} ± {std_error:.4} per vertex"
        ))
    }
}

/// A walk that can be followed step by step.
pub trait WeightedWalk: Sync {
    /// State of a walk.
    type State: Copy + Send;
    /// Memory in which many walkers take a step together.
    type Room: Default;
    /// Start of walker `i`.
    fn start(&self, i: usize, rng: &mut Rng) -> Option<Self::State>;
    /// One step of many walkers: the new state and the weight of each, or nothing if its walk ends.
    fn steps(&self, at: &[Self::State], streams: Streams, room: &mut Self::Room) -> Vec<Option<(Self::State, Rgb)>>;
    /// q at vertex v for this throughput and state.
    fn q(&self, v: usize, throughput: Rgb, at: &Self::State) -> f32;
    /// Throughput at the start.
    fn lit(&self) -> Rgb;
}

/// The wave of walkers that take a step together, what the step gives, and the walkers that go on.
#[derive(Default)]
pub struct Together<W, S> {
    wave: W,
    steps: Option<S>,
    alive: Vec<u32>,
}

impl<W, S> Together<W, S> {
    /// A wave of these states, and room for their steps.
    fn with<State: Copy>(&mut self, at: &[State], steps: impl FnOnce(usize) -> S) -> (&mut W, &mut S, &mut Vec<u32>)
    where
        W: Wave<State>,
    {
        // whole packets, so that batched methods may write past the end; resampling never adds walkers
        let n = WALKERS.next_multiple_of(64);
        let room = self.steps.get_or_insert_with(|| {
            self.wave.resize(n);
            steps(n)
        });
        at.iter().enumerate().for_each(|(i, state)| self.wave.set(i, *state));
        self.alive.clear();
        (&mut self.wave, room, &mut self.alive)
    }
}

/// Walks from a sensor.
pub struct FromEye<'a, T, S, Q> {
    /// The transport.
    pub t: &'a T,
    /// Where paths start.
    pub sensor: &'a S,
    /// Roulette: q at vertex v for this throughput and state.
    pub q: Q,
}

impl<T: Transport, S: Sensor<T>, Q> WeightedWalk for FromEye<'_, T, S, Q>
where
    T::State: Send,
    Q: Fn(usize, Rgb, &T::State) -> f32 + Sync,
{
    type State = T::State;
    type Room = Together<T::Wave, Samples>;
    fn start(&self, i: usize, rng: &mut Rng) -> Option<T::State> {
        let [w, h] = self.sensor.size().map(u64::from);
        let pixel = (i as u64 * w * h / WALKERS as u64) as u32;
        self.sensor.start(self.t, pixel, rng)
    }
    fn steps(&self, at: &[T::State], streams: Streams, room: &mut Self::Room) -> Vec<Option<(T::State, Rgb)>> {
        let (wave, steps, alive) = room.with(at, Samples::new);
        self.t.scatter_wave(wave, streams, steps, alive);
        // the walks that go on are at the front
        let mut next = vec![None; at.len()];
        for (to, &i) in alive.iter().enumerate() {
            next[i as usize] = Some((wave.get(to), steps.value.get(to)));
        }
        next
    }
    fn q(&self, v: usize, throughput: Rgb, at: &T::State) -> f32 {
        (self.q)(v, throughput, at)
    }
    fn lit(&self) -> Rgb {
        self.t.lit()
    }
}

/// Walks from the light with a roulette schedule.
pub struct FromLight<'a, T> {
    /// The transport.
    pub t: &'a T,
    /// The roulette schedule of the walks.
    pub roulette: &'a Roulette,
}

impl<T: Adjoint> WeightedWalk for FromLight<'_, T>
where
    T::State: Send,
{
    type State = T::State;
    type Room = Together<T::Wave, Steps>;
    fn start(&self, _: usize, rng: &mut Rng) -> Option<T::State> {
        let (light, _) = self.t.emit(rng)?;
        Some(self.t.walk(&light, Role::Emission, rng)?.state)
    }
    fn steps(&self, at: &[T::State], streams: Streams, room: &mut Self::Room) -> Vec<Option<(T::State, Rgb)>> {
        let (wave, steps, alive) = room.with(at, |n| Steps { wanted: false, ..Steps::new(n) });
        self.t.walk_wave(wave, Role::Flux, streams, steps, alive);
        let mut next = vec![None; at.len()];
        for &i in alive.iter() {
            let i = i as usize;
            next[i] = Some((wave.get(i), steps.weight.get(i)));
        }
        next
    }
    fn q(&self, v: usize, throughput: Rgb, at: &T::State) -> f32 {
        self.roulette.termination(v, throughput, self.t.albedo(at))
    }
    fn lit(&self) -> Rgb {
        self.t.lit()
    }
}

/// Growth of the moment of that order (2 for the variance) from vertex `from` on, in the channel where it grows fastest.
pub fn growth(walk: &impl WeightedWalk, from: usize, order: i32, seed: u64) -> Growth {
    let channels = (0..3).filter(|&c| walk.lit()[c] > 0.0);
    let all = channels.map(|c| in_channel(walk, from, order, c, Key::new(seed, "growth of moments")));
    let nothing = Growth { rate: 0.0, std_error: 0.0, largest: 0.0 };
    all.reduce(|a, b| {
        let worst = if b.rate > a.rate { b } else { a };
        Growth { largest: a.largest.max(b.largest), ..worst }
    })
    .unwrap_or(nothing)
}

fn in_channel(walk: &impl WeightedWalk, from: usize, order: i32, channel: usize, key: Key) -> Growth {
    let runs: Vec<(f64, f32)> =
        (0..POPULATIONS).into_par_iter().map(|p| population(walk, from, order, channel, key.branch(p))).collect();
    let largest = runs.iter().fold(0.0, |a: f32, r| a.max(r.1));
    // a population whose walkers have all ended has growth 0
    if runs.iter().all(|r| r.0 == f64::NEG_INFINITY) {
        return Growth { rate: 0.0, std_error: 0.0, largest };
    }
    let logs: Vec<f64> = runs.iter().map(|r| r.0.max(-1e3)).collect();
    let n = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / n;
    let variance = logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let rate = mean.exp();
    Growth { rate, std_error: rate * (variance / n).sqrt(), largest }
}

struct Walker<S> {
    x: S,
    throughput: Rgb,
}

/// Follows one population. Returns the mean of ln g, and the largest throughput.
fn population<W: WeightedWalk>(walk: &W, from: usize, order: i32, channel: usize, key: Key) -> (f64, f32) {
    let rng = |i: usize, step: usize, purpose: Purpose| Rng::at(key, i as u32, 0, step, purpose);
    let begin = |i: usize| {
        let x = walk.start(i, &mut rng(i, 0, Purpose::Start))?;
        Some(Walker { x, throughput: walk.lit() })
    };
    let mut walkers: Vec<Walker<W::State>> = (0..WALKERS).filter_map(begin).collect();
    // walker i has the random numbers of pixel i
    let (pixel, sample): (Vec<u32>, Vec<u32>) = (0..WALKERS as u32).map(|i| (i, 0)).unzip();
    let (mut sum, mut largest, mut room) = (0.0, 0.0f32, W::Room::default());
    for step in 0..STEPS {
        let mut factors = Vec::with_capacity(walkers.len());
        let at: Vec<W::State> = walkers.iter().map(|w| w.x).collect();
        let (pixel, sample) = (&pixel[..at.len()], &sample[..at.len()]);
        let streams = Streams { key, pixel, sample, bounce: step, purpose: Purpose::Scatter };
        let next = walk.steps(&at, streams, &mut room);
        for (w, next) in walkers.iter_mut().zip(next) {
            let (q, before) = (walk.q(from + step, w.throughput, &w.x), w.throughput[channel]);
            let Some((x, weight)) = next.filter(|_| q < 1.0 && before > 0.0) else {
                factors.push(0.0);
                continue;
            };
            (w.x, w.throughput) = (x, w.throughput * weight * (1.0 / (1.0 - q)));
            largest = largest.max(w.throughput[channel]);
            let ratio = f64::from(w.throughput[channel] / before);
            factors.push(ratio.powi(order) * f64::from(1.0 - q));
        }
        let total: f64 = factors.iter().sum();
        if total == 0.0 {
            return (f64::NEG_INFINITY, largest);
        }
        if step >= SETTLED {
            sum += (total / factors.len() as f64).ln();
        }
        // as many walkers as before, evenly spaced over the cumulative sums of the factors
        let each = total / WALKERS as f64;
        let mut at = each * f64::from(rng(0, step, Purpose::Roulette).one());
        let (mut up_to, mut next) = (0.0, Vec::with_capacity(WALKERS));
        for (w, f) in walkers.iter().zip(&factors) {
            up_to += f;
            while at < up_to && next.len() < WALKERS {
                next.push(Walker { x: w.x, throughput: w.throughput });
                at += each;
            }
        }
        walkers = next;
    }
    (sum / (STEPS - SETTLED) as f64, largest)
}

/// Returns true if the variance is proved to be finite. This needs Lambertian surfaces, directions drawn by the cosine, and
/// no guide; with constant q, also ρ² < 1 − q.
pub fn proved(scene: &Scene, sampling: Sampling, roulette: &Roulette) -> bool {
    let lambertian =
        |side: u32| matches!(scene.bsdf(&Vertex { side, ..Vertex::default() }), Bsdf::Diffuse(_) | Bsdf::Black);
    let plain = || sampling != Sampling::Uniform && (0..scene.sides()).all(lambertian);
    let bounded = |q: f64| {
        let rho = f64::from((scene.max_albedo() * scene.lit()).max_element());
        rho * rho < 1.0 - q
    };
    match roulette {
        // paths are cut at K
        Roulette::Never => true,
        Roulette::Constant { q, .. } => *q == 0.0 || bounded(*q) && plain(),
        Roulette::Table(q) => q.last().is_none_or(|&q| q == 0.0 || bounded(q)) && plain(),
        Roulette::Albedo { .. } | Roulette::Throughput { .. } => plain(),
    }
}

/// Measures a walk whose schedule does not change any more from vertex `settled` on. None if its variance is finite.
pub(crate) fn doubt(walk: &impl WeightedWalk, settled: usize, settings: &Settings) -> Option<Growth> {
    let found = growth(walk, settled, 2, settings.seed);
    (found.variance() != Variance::Finite).then_some(found)
}

/// The same for walks from the eye with a roulette schedule.
pub(crate) fn doubt_from_eye<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    roulette: &Roulette,
    settings: &Settings,
) -> Option<Growth>
where
    T::State: Send,
{
    let q = |v: usize, throughput, at: &T::State| roulette.q(t, v, throughput, at);
    doubt(&FromEye { t, sensor, q }, roulette.settled(), settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::SceneTransport;
    use crate::scene::load;

    /// The same walks, one walker after the other.
    struct OneByOne<'a, T, W> {
        t: &'a T,
        walk: W,
        from_light: bool,
    }

    impl<T: Adjoint, W: WeightedWalk<State = T::State>> WeightedWalk for OneByOne<'_, T, W>
    where
        T::State: Send,
    {
        type State = T::State;
        type Room = ();
        fn start(&self, i: usize, rng: &mut Rng) -> Option<T::State> {
            self.walk.start(i, rng)
        }
        fn steps(&self, at: &[T::State], streams: Streams, (): &mut ()) -> Vec<Option<(T::State, Rgb)>> {
            let step = |(i, at)| {
                let rng = &mut streams.rng(i);
                if self.from_light {
                    self.t.walk(at, Role::Flux, rng).map(|s| (s.state, s.weight))
                } else {
                    self.t.scatter(at, rng).map(|s| (s.state, s.weight))
                }
            };
            at.iter().enumerate().map(step).collect()
        }
        fn q(&self, v: usize, throughput: Rgb, at: &T::State) -> f32 {
            self.walk.q(v, throughput, at)
        }
        fn lit(&self) -> Rgb {
            self.walk.lit()
        }
    }

    /// Walkers that step together have the bits of walkers that step alone.
    #[test]
    fn waves_have_the_bits_of_single_walkers() {
        for name in ["env-ggx", "cornell-spheres"] {
            let scene = Scene::new(&load::scene(name, &load::Options::default()).expect(name).description);
            let (t, roulette) = (&SceneTransport::new(&scene), &Roulette::Albedo { from: 3 });
            let light = || FromLight { t, roulette };
            let q = |v: usize, throughput, at: &Vertex| roulette.q(t, v, throughput, at);
            let eye = || FromEye { t, sensor: &scene.camera, q };
            let found = [growth(&light(), 3, 2, 1), growth(&eye(), 3, 2, 1)];
            let alone = [
                growth(&OneByOne { t, walk: light(), from_light: true }, 3, 2, 1),
                growth(&OneByOne { t, walk: eye(), from_light: false }, 3, 2, 1),
            ];
            assert_eq!(found, alone);
            assert!(found.iter().any(|g| g.rate > 0.0), "{found:?}");
        }
    }
}
