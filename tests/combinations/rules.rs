//! The emission rules as a table that can be broken, cell by cell.
//!
//! Walks from the eye weigh emission by p/(p + p°). [`Ruled`] runs them under `Mis` over an operator that answers with p = 1 and
//! p° = 1/w − 1, so that what counts is w, whatever w is: with the right table it **is** the technique of that column, and a table
//! with one wrong cell breaks one rule and no other.
//!
//! Walks from the light do not read that table. They are broken by [`Ruled::scale`]: a strategy that counts too much.

use fredholm::estimator::{Job, Paths, Technique, TermEstimator, TermSink};
use fredholm::math::{Columns, Rgb, Rng};
use fredholm::operator::adjoint::{AdjointStep, Toward};
use fredholm::operator::{Adjoint, Factors, Kernel, Role, SceneTransport, Seen, Sensor, Step, Transport};
use fredholm::scene::{Camera, Vertex};

/// What emission counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    Nothing,
    All,
    Balance,
    Power,
}
use Weight::{All, Balance, Nothing, Power};

impl Weight {
    fn of(self, p: f32, other: f32) -> f32 {
        match self {
            Nothing => 0.0,
            All => 1.0,
            Balance => p / (p + other),
            Power => 1.0 / (1.0 + (other / p).powi(2)),
        }
    }
}

/// One column of the table in `technique.rs`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// At vertex 0.
    pub eye: Weight,
    /// On a hit: p° > 0, p° = 0.
    pub hit: [Weight; 2],
    /// Through a connection: p° > 0, p° = 0.
    pub connection: [Weight; 2],
}

/// The columns as they stand there, written down once more.
pub fn rules(technique: Technique) -> Rules {
    let (hit, connection) = match technique {
        Technique::Scatter => ([All, All], [Nothing, Nothing]),
        Technique::Connect => ([Nothing, All], [All, All]),
        Technique::Mis => ([Balance, All], [Balance, All]),
        Technique::Power => ([Power, All], [Power, All]),
    };
    Rules { eye: All, hit, connection }
}

/// One wrong cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    pub technique: Technique,
    pub cell: &'static str,
    pub rules: Rules,
}

/// Every cell of every column, broken: what counts does not, and what does not does; a share counts whole, or not at all.
pub fn violations() -> Vec<Violation> {
    let mut all = vec![];
    for technique in Technique::ALL {
        let right = rules(technique);
        let wrong = |w: Weight| match w {
            All => vec![Nothing],
            Nothing => vec![All],
            Balance | Power => vec![All, Nothing],
        };
        let mut add = |cell, rules| all.push(Violation { technique, cell, rules });
        for w in wrong(right.eye) {
            add("at vertex 0", Rules { eye: w, ..right });
        }
        for (i, cell) in ["on a hit, p° > 0", "on a hit, p° = 0"].into_iter().enumerate() {
            for w in wrong(right.hit[i]) {
                let mut hit = right.hit;
                hit[i] = w;
                add(cell, Rules { hit, ..right });
            }
        }
        for (i, cell) in ["through a connection, p° > 0", "through a connection, p° = 0"].into_iter().enumerate() {
            for w in wrong(right.connection[i]) {
                let mut connection = right.connection;
                connection[i] = w;
                add(cell, Rules { connection, ..right });
            }
        }
    }
    all
}

/// An operator whose answers make `Mis` weigh by a table.
#[derive(Clone, Copy)]
pub struct Ruled<'a> {
    pub inner: SceneTransport<'a>,
    pub rules: Rules,
    /// Connections, and steps of scattered light, count that much too much.
    pub scale: [f32; 2],
}

fn zero(other: f32) -> usize {
    usize::from(other == 0.0)
}

impl Ruled<'_> {
    fn weigh(s: Step<Vertex>, weights: [Weight; 2]) -> Step<Vertex> {
        let w = weights[zero(s.other_pdf)].of(s.pdf, s.other_pdf);
        Step { pdf: 1.0, other_pdf: 1.0 / w - 1.0, ..s }
    }

    fn weigh_factors(s: Factors<Vertex>, weights: [Weight; 2]) -> Factors<Vertex> {
        let w = weights[zero(s.pair[1])].of(s.pair[0], s.pair[1]);
        Factors { pair: [1.0, 1.0 / w - 1.0], ..s }
    }
}

impl Transport for Ruled<'_> {
    type State = Vertex;
    type Wave = Vec<Vertex>;

    fn emission(&self, at: &Vertex) -> Rgb {
        self.inner.emission(at)
    }
    fn scatter(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        self.inner.scatter(at, rng).map(|s| Self::weigh(s, self.rules.hit))
    }
    fn connect(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let s = Self::weigh(self.inner.connect(at, rng)?, self.rules.connection);
        Some(Step { weight: s.weight * self.scale[0], ..s })
    }
    fn albedo(&self, at: &Vertex) -> Rgb {
        self.inner.albedo(at)
    }
    fn connects_to_all(&self) -> bool {
        false
    }
}

impl Kernel for Ruled<'_> {
    fn sample_direction(&self, at: &Vertex, rng: &mut Rng) -> Option<Factors<Vertex>> {
        self.inner.sample_direction(at, rng).map(|s| Self::weigh_factors(s, self.rules.hit))
    }
    fn sample_emitter(&self, at: &Vertex, rng: &mut Rng) -> Option<Factors<Vertex>> {
        let s = Self::weigh_factors(self.inner.sample_emitter(at, rng)?, self.rules.connection);
        Some(Factors { f: s.f * self.scale[0], ..s })
    }
}

impl Adjoint for Ruled<'_> {
    fn emit(&self, rng: &mut Rng) -> Option<(Vertex, f32)> {
        self.inner.emit(rng)
    }
    fn emit_density(&self, at: &Vertex) -> f32 {
        self.inner.emit_density(at)
    }
    fn connect_density(&self, from: &Vertex, at: &Vertex) -> f32 {
        self.inner.connect_density(from, at)
    }
    fn walk(&self, at: &Vertex, role: Role, rng: &mut Rng) -> Option<AdjointStep<Vertex>> {
        let step = self.inner.walk(at, role, rng)?;
        let scale = if role == Role::Flux { self.scale[1] } else { 1.0 };
        Some(AdjointStep { weight: step.weight * scale, ..step })
    }
    fn toward(&self, at: &Vertex, to: &Vertex, role: Role) -> Toward {
        self.inner.toward(at, to, role)
    }
    fn delta_density(&self, at: &Vertex, to: &Vertex, choice: f32) -> f32 {
        self.inner.delta_density(at, to, choice)
    }
    fn facing(&self, at: &Vertex, other: &Vertex) -> Vertex {
        self.inner.facing(at, other)
    }
    fn link(&self, eye: &Vertex, light: &Vertex) -> f32 {
        self.inner.link(eye, light)
    }
}

/// The camera of the scene, for the operator that may be wrong.
pub struct Through<'a>(pub &'a Camera);

impl Sensor<Ruled<'_>> for Through<'_> {
    fn size(&self) -> [u32; 2] {
        self.0.size
    }
    fn start(&self, t: &Ruled, pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        self.0.start(&t.inner, pixel, rng)
    }
    fn project(&self, t: &Ruled, at: &Vertex) -> Option<Seen<Vertex>> {
        self.0.project(&t.inner, at)
    }
    fn density(&self, t: &Ruled, at: &Vertex) -> f32 {
        self.0.density(&t.inner, at)
    }
    fn sees(&self, t: &Ruled, at: &Vertex) -> bool {
        self.0.sees(&t.inner, at)
    }
}

/// An estimator whose emission at vertex 0, slot 0, counts by another rule. (The path tracer has one slot for all, where this
/// rule cannot be broken from outside.)
pub struct Eye<E> {
    pub estimator: E,
    pub eye: Weight,
}

struct EyeSink<'a, S> {
    sink: &'a mut S,
    eye: Weight,
}

impl<S: TermSink> TermSink for EyeSink<'_, S> {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        if slot > 0 || self.eye == All {
            self.sink.add(slot, pixel, sample, value);
        }
    }
}

impl<T: Transport, E: TermEstimator<T>> TermEstimator<T> for Eye<E> {
    fn slots(&self) -> usize {
        self.estimator.slots()
    }
    fn splats(&self) -> bool {
        self.estimator.splats()
    }
    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        self.estimator.sample(
            job,
            paths,
            &mut EyeSink { sink, eye: if self.estimator.slots() > 1 { self.eye } else { All } },
        );
    }
}
