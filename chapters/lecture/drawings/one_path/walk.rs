//! One path of the path tracer, followed step by step with the random numbers that the library uses.
//!
//! ```text
//! colour ← E(x_0),  α ← 1
//! at x_v:   colour ← colour + α f cos θ/p E(y)          y on the lamp, drawn with density p; 0 if y is hidden
//!           stop with probability q,  α ← α/(1 − q)
//!           α ← α f cos θ/p                             x_{v+1} along a direction of density p
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_v, α | vertex and throughput on arrival | [`Visit::at`], [`Visit::throughput`] |
//! | y | the point on the lamp, and where the ray to it ends | [`Shadow`] |
//! | q, u | probability of termination and the number drawn: the path ends if u < q | [`Coin`] |
//! | cos θ, p | of the next direction | [`Visit::direction`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

use fredholm::estimator::Roulette;
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::{Kernel, SceneTransport, Sensor, Transport};
use fredholm::scene::{Scene, Vertex};
use glam::Vec3;

/// The address of a path: its stream, pixel and sample.
#[derive(Clone, Copy, Debug)]
pub struct Address {
    pub key: Key,
    pub pixel: u32,
    pub sample: u32,
}

impl Address {
    /// The random numbers of a decision at vertex `v`.
    pub fn numbers(self, v: usize, purpose: Purpose) -> Rng {
        Rng::at(self.key, self.pixel, self.sample, v, purpose)
    }
}

/// The ray from a vertex to the lamp.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// Where the ray ends: at y on the lamp, or at the surface that hides it.
    pub end: Vec3,
    /// What the path adds to the pixel here, with cos θ and the density p (sr⁻¹) of y; none if y is hidden.
    pub adds: Option<(Rgb, f32, f32)>,
}

/// The coin of Russian roulette.
#[derive(Clone, Copy, Debug)]
pub struct Coin {
    /// Probability of termination.
    pub q: f32,
    /// The number that was drawn; none if q = 0.
    pub drawn: Option<f32>,
}

impl Coin {
    /// Returns true if the path ends here.
    pub fn ends(self) -> bool {
        self.drawn.is_some_and(|u| u < self.q)
    }
}

/// What happens at one vertex.
#[derive(Clone, Copy, Debug)]
pub struct Visit {
    pub at: Vertex,
    /// α on arrival.
    pub throughput: Rgb,
    pub shadow: Shadow,
    pub coin: Coin,
    /// cos θ and density p (sr⁻¹) of the direction to the next vertex; none if the path ends.
    pub direction: Option<(f32, f32)>,
}

/// Follows a path. None if it sees nothing, leaves the room, touches the lamp, or has a vertex that cannot face the lamp: such
/// paths are not drawn.
pub fn follow(t: &SceneTransport<'_>, roulette: &Roulette, path: Address, most: usize) -> Option<Vec<Visit>> {
    let lamp = (0..t.scene.sides()).find(|&side| t.scene.emission(side) != Rgb::ZERO)?;
    let mut x = t.scene.camera.start(t, path.pixel, &mut path.numbers(0, Purpose::Start))?;
    let mut throughput = t.lit();
    let mut visits = vec![];
    for v in 0..most {
        if t.emission(&x) != Rgb::ZERO {
            return None;
        }
        let shadow = shadow(t, &x, lamp, throughput, path, v)?;
        let q = roulette.q(t, v, throughput, &x);
        let coin = Coin { q, drawn: (q > 0.0).then(|| path.numbers(v, Purpose::Roulette).one()) };
        let mut visit = Visit { at: x, throughput, shadow, coin, direction: None };
        if coin.ends() {
            visits.push(visit);
            return Some(visits);
        }
        throughput *= 1.0 / (1.0 - q);
        let next = t.sample_direction(&x, &mut path.numbers(v, Purpose::Scatter))?;
        throughput *= next.f * (next.cos / next.pdf);
        x = next.state;
        visit.direction = Some((next.cos, next.pdf));
        visits.push(visit);
    }
    None
}

/// The ray to the lamp from vertex `v`. None if the surface or the lamp faces away.
fn shadow(t: &SceneTransport<'_>, x: &Vertex, lamp: u32, throughput: Rgb, path: Address, v: usize) -> Option<Shadow> {
    let [_, _, s, u] = path.numbers(v, Purpose::Connect).four();
    let (y, m) = t.scene.point(lamp, [s, u]);
    let to = (y - x.p).normalize();
    if to.dot(x.n) <= 0.0 || to.dot(m) >= 0.0 {
        return None;
    }
    if let Some(found) = t.sample_emitter(x, &mut path.numbers(v, Purpose::Connect)) {
        let adds = throughput * found.f * (found.cos / found.pdf) * t.emission(&found.state);
        // the library has drawn the same point of the lamp
        let same = found.state.p.distance(y) < 1e-4;
        return same.then_some(Shadow { end: y, adds: Some((adds, found.cos, found.pdf)) });
    }
    let blocker = t.scene.trace(Scene::offset_origin(x.p, x.n), to)?;
    (blocker.side != lamp).then_some(Shadow { end: blocker.p, adds: None })
}
