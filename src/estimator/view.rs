//! Connections of walks from the light to the sensor: what each vertex adds to the pixel that sees it.
//!
//! ```text
//! X_k = β_k · S(y_k → eye) · W(y_k) / (number of pixels)
//! ```
//!
//! The symbols are those of [`light_tracer`](super::light_tracer). Every pixel has as many samples as there are walks for
//! one pixel, but the walks of all pixels add to it; so each contribution is divided by the number of pixels.

use super::TermSink;
use super::walk::Walk;
use crate::math::{Columns, Rgb};
use crate::operator::{Adjoint, Role, Sensor, Wave};

/// The vertices of a wave that the sensor sees.
pub(super) struct Views<W> {
    /// Their numbers in the wave, ascending.
    pub(super) list: Vec<u32>,
    /// For each vertex of the wave: the pixel that sees it, and X_k.
    pub(super) pixel: Vec<u32>,
    pub(super) value: Columns,
    sample: Vec<u32>,
    /// A state at the position of the sensor, and the density with which the walks of all pixels start at the vertex.
    pub(super) eye: W,
    pub(super) density: Vec<f32>,
}

impl<W> Views<W> {
    /// Room for a wave of `n` walks.
    pub(super) fn new<S>(n: usize) -> Self
    where
        W: Wave<S>,
    {
        let mut eye = W::default();
        eye.resize(n);
        Self { list: vec![], pixel: vec![0; n], sample: vec![0; n], value: Columns::new(n), eye, density: vec![0.0; n] }
    }

    /// Connects the present vertices of all walks to the sensor. Returns the number of rays.
    pub(super) fn connect<T: Adjoint<Wave = W>>(
        &mut self,
        t: &T,
        sensor: &impl Sensor<T>,
        walk: &mut Walk<W>,
        role: Role,
    ) -> usize
    where
        W: Wave<T::State>,
    {
        let [w, h] = sensor.size();
        let share = 1.0 / (w * h) as f32;
        self.list.clear();
        for i in 0..walk.n {
            let y = walk.state.get(i);
            let Some(seen) = sensor.project(t, &y) else { continue };
            let value = walk.throughput.get(i) * t.toward(&y, &seen.eye, role).value * seen.importance;
            if value != Rgb::ZERO {
                self.list.push(i as u32);
                (self.pixel[i], self.density[i]) = (seen.pixel, seen.density * share);
                self.value.set(i, value * share);
                self.eye.set(i, seen.eye);
            }
        }
        let rays = self.list.len();
        sensor.sees_wave(t, &mut walk.state, &mut self.list);
        rays
    }

    /// Adds what the sensor sees to a slot. `sample` are the sample numbers of the walks. The columns are then those of the
    /// list.
    pub(super) fn add(&mut self, sample: &[u32], slot: usize, sink: &mut impl TermSink) {
        let n = self.list.len();
        for (to, &from) in self.list.iter().enumerate() {
            let from = from as usize;
            (self.pixel[to], self.sample[to]) = (self.pixel[from], sample[from]);
            self.value.set(to, self.value.get(from));
        }
        sink.add(slot, &self.pixel[..n], &self.sample[..n], &self.value);
    }
}
