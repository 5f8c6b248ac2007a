//! The density with which each bidirectional strategy finds a path, and the weight of the strategy that found it: the plain
//! form of what `estimator/densities.rs` computes by running products. Every density of a path is kept, one path at a time.
//!
//! ```text
//! p_s = Π_{i < t} p→(z_i) · Π_{i ≥ t} p←(z_i)          t = k + 1 − s
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | p→(z_i) | density of z_i walked from the eye, given z_{i−1} and z_{i−2} | `from_eye` |
//! | p←(z_i) | density of z_i walked from the light, given z_{i+1} and z_{i+2} | `from_light` |
//! | c(z_k) | density of next-event estimation, which replaces p←(z_k) where s = 1 | `connect` |
//!
//! Strategy s walks s vertices from the light and t from the eye; the two walks meet at the junction. A density depends on
//! three consecutive vertices. So a walk knows all of its own densities except the two next to the junction. [`Node`] stores
//! the known ones, and `PathDensities::new` computes the four that are missing. p_s = 0 where strategy s cannot find the
//! path: no link is possible at a delta vertex, and no walk hits a light without area.

use super::*;

/// A vertex of a walk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<S> {
    /// The state at this vertex; its direction points to the predecessor in the walk.
    pub state: S,
    /// Throughput before this vertex scatters.
    pub throughput: Rgb,
    /// Density with which the walk reached this vertex.
    pub forward: f32,
    /// Density with which a walk from the other end would reach this vertex.
    pub reverse: f32,
    /// If the vertex scattered by a delta component (mirror or glass): the probability of choosing that component.
    pub delta: Option<f32>,
}

impl<S> Node<S> {
    /// The start of a walk.
    pub(crate) fn new(state: S, throughput: Rgb, forward: f32) -> Self {
        Self { state, throughput, forward, reverse: 0.0, delta: None }
    }
}

/// Extends a walk from its start by at most `last` steps. `first` is the role of the first vertex. `rays` is called with the
/// number of each step.
pub(crate) fn walk<T: Adjoint>(
    t: &T,
    nodes: &mut Vec<Node<T::State>>,
    last: usize,
    first: Role,
    numbers: impl Fn(usize) -> Rng,
    mut rays: impl FnMut(usize),
) {
    let (role, other) = opposite(first);
    for v in 0..last {
        let Node { state, throughput, .. } = nodes[v];
        rays(v + 1);
        let Some(step) = t.walk(&state, if v == 0 { first } else { role }, &mut numbers(v)) else { break };
        nodes[v].delta = step.delta;
        if v > 0 {
            let before = nodes[v - 1].state;
            nodes[v - 1].reverse = match step.delta {
                Some(choice) => t.delta_density(&t.facing(&state, &step.state), &before, choice),
                None => t.density(&step.state, &state, &before, other),
            };
        }
        nodes.push(Node::new(step.state, throughput * step.weight, step.density));
    }
}

/// The role of scattering in this walk, and in a walk from the other end.
fn opposite(first: Role) -> (Role, Role) {
    if first == Role::Radiance { (Role::Radiance, Role::Flux) } else { (Role::Flux, Role::Radiance) }
}

/// The densities of one path under all strategies.
#[derive(Clone, Debug)]
pub(crate) struct PathDensities {
    from_eye: Vec<f64>,
    from_light: Vec<f64>,
    connect: f64,
    delta: Vec<bool>,
    /// Vertices walked from the light by the strategy that found it.
    s: usize,
}

impl PathDensities {
    /// A path whose vertices are those of `eye`, followed by those of `light` in reverse order. If `eye` is empty, `seen`
    /// gives the state of the eye and the density with which a walk from the eye starts at this path's first vertex.
    pub(crate) fn new<T: Adjoint>(
        t: &T,
        eye: &[Node<T::State>],
        light: &[Node<T::State>],
        seen: Option<(T::State, f32)>,
    ) -> Self {
        let s = light.len();
        let emits = |j: usize| if j == 0 { Role::Emission } else { Role::Flux };
        let nodes = || eye.iter().chain(light.iter().rev());
        let mut from_eye: Vec<f32> = eye.iter().map(|x| x.forward).collect();
        from_eye.extend(light.iter().rev().map(|y| y.reverse));
        let mut from_light: Vec<f32> = eye.iter().map(|x| x.reverse).collect();
        from_light.extend(light.iter().rev().map(|y| y.forward));
        let mut delta: Vec<bool> = nodes().map(|n| n.delta.is_some()).collect();
        let states: Vec<T::State> = nodes().map(|n| n.state).collect();
        let ends = eye.len(); // index of the first vertex walked from the light

        // the two vertices beyond the junction, as if walked from the eye
        if s > 0 {
            let y = &states[ends];
            match (eye.last(), seen) {
                (Some(x), _) => from_eye[ends] = t.toward(&x.state, y, Role::Radiance).density,
                (None, Some((_, density))) => from_eye[ends] = density,
                (None, None) => {}
            }
            delta[ends] = false;
            if s > 1 {
                let before = eye.last().map(|x| x.state).or(seen.map(|(eye, _)| eye));
                from_eye[ends + 1] =
                    before.map_or(0.0, |before| t.density(&before, y, &states[ends + 1], Role::Radiance));
            }
        }
        // the two vertices before the junction, as if walked from the light
        if let Some(x) = eye.last() {
            let i = ends - 1;
            delta[i] = false;
            from_light[i] = match light.last() {
                Some(y) => t.toward(&y.state, &x.state, emits(s - 1)).density,
                None => t.emit_density(&x.state),
            };
            if i > 0 {
                from_light[i - 1] = match light.last() {
                    Some(y) => t.density(&y.state, &x.state, &states[i - 1], Role::Flux),
                    None => t.toward(&x.state, &states[i - 1], Role::Emission).density,
                };
            }
        }
        let k = states.len() - 1;
        let connect = if k > 0 { f64::from(t.connect_density(&states[k - 1], &states[k])) } else { 0.0 };
        let wide = |v: Vec<f32>| v.into_iter().map(f64::from).collect();
        Self { from_eye: wide(from_eye), from_light: wide(from_light), connect, delta, s }
    }

    /// Density of z_i under strategy s: p→ before the junction, p← behind it, and c instead of p← where s = 1.
    fn of_vertex(&self, i: usize, s: usize) -> f64 {
        let k = self.delta.len() - 1;
        if i + s <= k {
            self.from_eye[i]
        } else if s == 1 && k > 0 {
            self.connect
        } else {
            self.from_light[i]
        }
    }

    /// Returns true if strategy s can find the path. No link is possible at a delta vertex.
    fn links(&self, s: usize) -> bool {
        let t = self.delta.len() - s;
        s == 0 || !(self.delta[t] || t > 0 && self.delta[t - 1])
    }

    /// p_s: the density with which strategy s finds the path.
    pub(crate) fn density(&self, s: usize) -> f64 {
        if self.links(s) { (0..self.delta.len()).map(|i| self.of_vertex(i, s)).product() } else { 0.0 }
    }

    /// p_s/p_r for the strategy r that found the path, as a product of ratios at the vertices. The products p_s and p_r
    /// themselves leave the range of `f64` on long paths when lengths are in millimetres.
    fn ratio(&self, s: usize) -> f64 {
        if self.links(s) {
            (0..self.delta.len()).map(|i| self.of_vertex(i, s) / self.of_vertex(i, self.s)).product()
        } else {
            0.0
        }
    }

    /// Weight of the strategy that found the path: p_s/Σ p_r, or the same with squared densities.
    pub(crate) fn weight(&self, squared: bool) -> f32 {
        let ratio = |s: usize| if squared { self.ratio(s).powi(2) } else { self.ratio(s) };
        (1.0 / (0..=self.delta.len()).map(ratio).sum::<f64>()) as f32
    }
}
