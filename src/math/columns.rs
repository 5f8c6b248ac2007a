//! Many vectors as three columns, so that loops over a wave run on all lanes of the machine.

use glam::Vec3;

/// `n` vectors or colours, component by component.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// First components.
    pub x: Vec<f32>,
    /// Second components.
    pub y: Vec<f32>,
    /// Third components.
    pub z: Vec<f32>,
}

impl Columns {
    /// `n` zeros.
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

    /// The first `n` become `v`.
    pub fn fill(&mut self, n: usize, v: Vec3) {
        self.x[..n].fill(v.x);
        self.y[..n].fill(v.y);
        self.z[..n].fill(v.z);
    }

    /// The first `n` are multiplied, component by component.
    pub fn multiply(&mut self, by: &Columns, n: usize) {
        for (a, b) in [(&mut self.x, &by.x), (&mut self.y, &by.y), (&mut self.z, &by.z)] {
            a[..n].iter_mut().zip(&b[..n]).for_each(|(a, b)| *a *= b);
        }
    }

    /// The first `n` are scaled, each by its own factor.
    pub fn scale(&mut self, by: &[f32], n: usize) {
        for a in [&mut self.x, &mut self.y, &mut self.z] {
            a[..n].iter_mut().zip(&by[..n]).for_each(|(a, b)| *a *= b);
        }
    }

    /// Stable compaction: vector `j` becomes the old vector `indices[j]`; `indices` ascend.
    pub fn keep(&mut self, indices: &[u32]) {
        keep(&mut self.x, indices);
        keep(&mut self.y, indices);
        keep(&mut self.z, indices);
    }
}

/// Stable compaction of one column: `v[j] = v[indices[j]]`, `indices` ascending.
pub fn keep<X: Copy>(v: &mut [X], indices: &[u32]) {
    for (j, &i) in indices.iter().enumerate() {
        v[j] = v[i as usize];
    }
}
