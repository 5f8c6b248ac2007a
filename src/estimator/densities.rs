//! The weight of the strategy that found a path, from the densities with which each strategy finds it.
//!
//! ```text
//! p_s = Π_{i < t} p→(z_i) · Π_{i ≥ t} p←(z_i)          t = k + 1 − s
//! w_s = p_s / Σ_r p_r = 1 / (1 + A + B)                A = Σ_{r > s} p_r/p_s      B = Σ_{r < s} p_r/p_s
//! A   = r_{t−1} (o_{t−1} + r_{t−2} F_{t−2})            r_i = p←(x_i)/p→(x_i)      F_i = o_i + r_{i−1} F_{i−1}
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | p→(z_i) | density of z_i walked from the eye, given z_{i−1} and z_{i−2} | |
//! | p←(z_i) | density of z_i walked from the light, given z_{i+1} and z_{i+2} | |
//! | r_i | ratio of both; from r_{t−1} on it leads from strategy s to s + 1, s + 2, … | [`Walked::fewer`] |
//! | o_i | 1 if a link may join x_{i−1} and x_i, else 0: no link is possible at a delta vertex | |
//! | F_i | sum over all strategies with at most i vertices from this end, relative to the one with i | `fewer` of [`Vertices`] |
//! | κ | c(y_0)/p←(y_0), where c is the density of next-event estimation | `kappa` |
//!
//! Strategy s walks s vertices from the light and t from the eye; the two walks meet at the junction. A density depends on
//! three consecutive vertices. So a walk knows all of its own ratios except those of its last two vertices, and F_{t−2}
//! does not depend on the other walk. It is computed once, along the walk. A path then costs the four densities next to the
//! junction, whatever its length. B is the same formula for the walk from the light, with r_i = p→(y_i)/p←(y_i). There
//! o_1 is multiplied by κ, because the strategy s = 1 chooses y_0 by next-event estimation.
//!
//! For the power heuristic all ratios are squared. A ratio of densities has no unit and stays near 1, where the densities of
//! whole paths leave the range of `f64`. Reference: Veach (1997), sec. 10.2.1.

use super::walk::Walk;
use crate::math::{Columns, Key};
use crate::operator::{Adjoint, Role, Wave};

/// Vertex v of all walks of a wave. A walk that ended before v has no meaningful entry here.
pub(super) struct Vertices<W> {
    /// States; their directions point to the predecessors in the walks.
    pub(super) state: W,
    /// Throughputs before the vertices scatter.
    pub(super) throughput: Columns,
    /// Densities with which the walks reached the vertices.
    density: Vec<f32>,
    /// True where a vertex scattered by a delta component (mirror or glass).
    delta: Vec<bool>,
    /// Densities with which walks from the other end would go from vertex v to v − 1, or [`DEPENDS`].
    back: Vec<f32>,
    /// F_v.
    fewer: Vec<f64>,
}

/// Marks a density that depends on where the walk comes from.
const DEPENDS: f32 = -1.0;

/// The vertices of all walks of a wave from one end.
pub(super) struct Walked<W> {
    /// `vertices[v]` are the v-th vertices.
    pub(super) vertices: Vec<Vertices<W>>,
    /// Number of vertices of each walk.
    pub(super) length: Vec<u32>,
    /// κ of each walk from the light; 1 for walks from the eye.
    kappa: Vec<f64>,
    /// The role of a walk from the other end.
    other: Role,
    /// True for the power heuristic.
    squared: bool,
}

impl<W> Walked<W> {
    /// Room for `n` walks with at most `last` steps, from the eye (`Radiance`) or from the light (`Flux`).
    pub(super) fn new<S>(n: usize, last: usize, role: Role, squared: bool) -> Self
    where
        W: Wave<S>,
    {
        let vertices = |_| {
            let mut state = W::default();
            state.resize(n);
            let (density, back) = (vec![0.0; n], vec![0.0; n]);
            let (delta, fewer) = (vec![false; n], vec![0.0; n]);
            Vertices { state, throughput: Columns::new(n), density, delta, back, fewer }
        };
        let other = if role == Role::Radiance { Role::Flux } else { Role::Radiance };
        let vertices = (0..=last).map(vertices).collect();
        Self { vertices, length: vec![0; n], kappa: vec![1.0; n], other, squared }
    }

    /// Forgets all walks.
    pub(super) fn clear(&mut self) {
        self.length.fill(0);
    }

    /// A ratio of densities as it counts in the weight.
    #[inline(always)]
    pub(super) fn ratio(&self, a: f32, b: f32) -> f64 {
        let ratio = f64::from(a) / f64::from(b);
        if self.squared { ratio * ratio } else { ratio }
    }

    /// Stores the present vertices of the walks, which are their v-th; `density(i)` is the density with which walk i has
    /// reached its vertex.
    pub(super) fn store<T: Adjoint<Wave = W>>(
        &mut self,
        t: &T,
        walk: &Walk<W>,
        v: usize,
        density: impl Fn(usize) -> f32,
    ) where
        W: Wave<T::State>,
    {
        let (behind, here) = self.vertices.split_at_mut(v);
        let to = &mut here[0];
        for (i, &place) in walk.place[..walk.n].iter().enumerate() {
            let (w, state) = (place as usize, walk.state.get(i));
            to.state.set(w, state);
            to.throughput.set(w, walk.throughput.get(i));
            to.density[w] = density(i);
            to.back[w] = match behind.last() {
                Some(before) if t.forgets(&state) => t.toward(&state, &before.state.get(w), self.other).density,
                _ => DEPENDS,
            };
            self.length[w] = v as u32 + 1;
        }
    }

    /// Density with which a walk from the other end goes from vertex v of walk `w`, which has the state `at`, to vertex
    /// v − 1, if it comes from `from`; 0 if there is no such vertex.
    #[inline(always)]
    pub(super) fn back<T: Adjoint<Wave = W>>(&self, t: &T, w: usize, v: usize, at: &T::State, from: &T::State) -> f32
    where
        W: Wave<T::State>,
    {
        match self.vertices[v].back[w] {
            _ if v == 0 => 0.0,
            DEPENDS => t.density(from, at, &self.vertices[v - 1].state.get(w), self.other),
            known => known,
        }
    }

    /// Moves the walks from vertex v to vertex v + 1 and stores it. `role` is that of vertex v.
    pub(super) fn step<T: Adjoint<Wave = W>>(&mut self, t: &T, walk: &mut Walk<W>, key: Key, role: Role, v: usize)
    where
        W: Wave<T::State>,
    {
        walk.step(t, key, role, v);
        self.store(t, walk, v + 1, |i| walk.steps.density[i]);
        for (i, &place) in walk.place[..walk.n].iter().enumerate() {
            let w = place as usize;
            let (choice, next) = (walk.steps.choice[i], walk.state.get(i));
            let at = self.vertices[v].state.get(w);
            if role == Role::Emission {
                self.kappa[w] = self.ratio(t.connect_density(&next, &at), self.vertices[0].density[w]);
            }
            let reverse = if choice > 0.0 && v > 0 {
                t.delta_density(&t.facing(&at, &next), &self.vertices[v - 1].state.get(w), choice)
            } else {
                self.back(t, w, v, &at, &next)
            };
            self.count(w, v, choice > 0.0, reverse);
        }
    }

    /// Computes F_v of walk `w`. `delta` says whether vertex v scattered by a delta component, and `reverse` is the density of
    /// vertex v − 1, walked from the other end.
    #[inline(always)]
    fn count(&mut self, w: usize, v: usize, delta: bool, reverse: f32) {
        let free = |delta: bool, factor: f64| if delta { 0.0 } else { factor };
        self.vertices[v].delta[w] = delta;
        self.vertices[v].fewer[w] = match v.checked_sub(1) {
            None => free(delta, 1.0),
            Some(before) => {
                let behind = &self.vertices[before];
                let link = free(delta || behind.delta[w], self.kappa(w, v));
                link + self.ratio(reverse, behind.density[w]) * behind.fewer[w]
            }
        };
    }

    /// Factor of the strategy that has v vertices from this end.
    #[inline(always)]
    fn kappa(&self, w: usize, v: usize) -> f64 {
        if v == 1 { self.kappa[w] } else { 1.0 }
    }

    /// A or B: Σ p_r/p_s over all strategies that have fewer vertices from this end than the one that found the path, which
    /// has the first `m` vertices of walk `w`. `last` and `before` are the densities of the last two of them, walked from the
    /// other end.
    #[inline(always)]
    pub(super) fn fewer(&self, w: usize, m: usize, last: f32, before: f32) -> f64 {
        match m {
            0 => 0.0,
            1 => self.ratio(last, self.vertices[0].density[w]),
            _ => {
                let (end, behind) = (&self.vertices[m - 1], &self.vertices[m - 2]);
                let link = if behind.delta[w] { 0.0 } else { self.kappa(w, m - 1) };
                let before = self.ratio(before, behind.density[w]) * behind.fewer[w];
                self.ratio(last, end.density[w]) * (link + before)
            }
        }
    }

    /// A for a path that consists of the first `m` vertices of walk `w` alone, so that s = 0. `emit` and `before` are the
    /// densities of the last two vertices, walked from the light; `connect` is the density of next-event estimation.
    pub(super) fn fewer_than_all(&self, w: usize, m: usize, connect: f32, emit: f32, before: f32) -> f64 {
        if m == 1 {
            return self.ratio(emit, self.vertices[0].density[w]);
        }
        let (end, behind) = (&self.vertices[m - 1], &self.vertices[m - 2]);
        let link = if behind.delta[w] { 0.0 } else { self.ratio(connect, end.density[w]) };
        let before = self.ratio(before, behind.density[w]) * behind.fewer[w];
        link + self.ratio(emit, end.density[w]) * before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The densities per area of this path of 64 vertices are as small, or as large, as in a room measured in micrometres or
    /// in kilometres. The densities of the whole path are then 0 or infinite in `f64`, but the weights follow from the
    /// ratios: with equal densities, each of the m strategies with fewer than m vertices from one end adds 1.
    #[test]
    fn weights_survive_long_paths_in_any_unit() {
        for (unit, squared) in [1e-12, 1.0, 1e12].into_iter().flat_map(|unit| [(unit, false), (unit, true)]) {
            let mut walked = Walked::<Vec<u32>>::new::<u32>(1, 63, Role::Flux, squared);
            for v in 0..64 {
                walked.vertices[v].density[0] = unit;
                walked.count(0, v, false, unit);
            }
            for m in [0, 1, 2, 3, 40, 63, 64] {
                assert!((walked.fewer(0, m, unit, unit) - m as f64).abs() < 1e-7, "{unit} {m}");
            }
            // twice as dense from the other end: 2 + 4 + … + 2^m, or the same with squares
            let base: f64 = if squared { 4.0 } else { 2.0 };
            (1..64).for_each(|v| walked.count(0, v, false, 2.0 * unit));
            let sum = (1..=20).map(|i| base.powi(i)).sum::<f64>();
            assert!((walked.fewer(0, 20, 2.0 * unit, 2.0 * unit) / sum - 1.0).abs() < 1e-7);
            // no link is possible at a mirror: vertex 1 leaves out the strategies with one and with two vertices
            (0..64).for_each(|v| walked.count(0, v, v == 1, unit));
            assert_eq!(walked.fewer(0, 4, unit, unit), 2.0);
        }
    }
}
