//! Arrays of vectors in structure-of-arrays layout: one column per component. Loops over a wave of paths then use all SIMD
//! lanes.

use super::pick::{gather, keep};
use glam::Vec3;
use pulp::{Arch, Simd};

/// An array of `n` vectors or colours, stored as one column per component.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// First components (x or red).
    pub x: Vec<f32>,
    /// Second components (y or green).
    pub y: Vec<f32>,
    /// Third components (z or blue).
    pub z: Vec<f32>,
}

impl Columns {
    /// An array of `n` zero vectors.
    pub fn new(n: usize) -> Self {
        Self { x: vec![0.0; n], y: vec![0.0; n], z: vec![0.0; n] }
    }

    /// Vector `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Replaces vector `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    /// Sets the first `n` vectors to `v`.
    pub fn fill(&mut self, n: usize, v: Vec3) {
        self.x[..n].fill(v.x);
        self.y[..n].fill(v.y);
        self.z[..n].fill(v.z);
    }

    /// Multiplies the first `n` vectors component by component with those of `by`.
    pub fn multiply(&mut self, by: &Columns, n: usize) {
        for (a, b) in [(&mut self.x, &by.x), (&mut self.y, &by.y), (&mut self.z, &by.z)] {
            multiply(&mut a[..n], &b[..n]);
        }
    }

    /// Changes the sign of the first `n` vectors.
    pub fn negate(&mut self, n: usize) {
        for a in [&mut self.x, &mut self.y, &mut self.z] {
            negate(&mut a[..n]);
        }
    }

    /// Multiplies vector `i` by the number `by[i]`, for the first `n` vectors.
    pub fn scale(&mut self, by: &[f32], n: usize) {
        for a in [&mut self.x, &mut self.y, &mut self.z] {
            a[..n].iter_mut().zip(&by[..n]).for_each(|(a, b)| *a *= b);
        }
    }

    /// Keeps only the vectors whose numbers are in `indices`: vector `j` becomes the old vector `indices[j]`. The indices
    /// must ascend, so the order is kept.
    pub fn keep(&mut self, indices: &[u32]) {
        keep(&mut self.x, indices);
        keep(&mut self.y, indices);
        keep(&mut self.z, indices);
    }
}

impl Columns {
    /// Vector `j` becomes vector `indices[j]` of `from`.
    pub fn gather(&mut self, from: &Columns, indices: &[u32]) {
        gather(&mut self.x, &from.x, indices);
        gather(&mut self.y, &from.y, indices);
        gather(&mut self.z, &from.z, indices);
    }
}

#[pulp::with_simd(multiply = Arch::new())]
#[inline(always)]
fn multiply_with_simd<'a, S: Simd>(_simd: S, a: &'a mut [f32], b: &'a [f32]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a *= b;
    }
}

#[pulp::with_simd(negate = Arch::new())]
#[allow(clippy::needless_lifetimes)] // the macro needs a name
#[inline(always)]
fn negate_with_simd<'a, S: Simd>(_simd: S, a: &'a mut [f32]) {
    for a in a {
        *a = -*a;
    }
}
