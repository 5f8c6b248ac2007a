//! Sixteen numbers at once: between the columns of a wave and the SIMD lanes of a loop.
//!
//! The loops `for i in 0..LANES` over arrays of sixteen are plain Rust. The compiler turns them into vector instructions if
//! everything inside is inlined, so these functions always are.

use crate::math::Columns;
use glam::Vec3;

/// Paths or rays that are computed at once.
pub(super) const LANES: usize = 16;

/// Sixteen numbers, and sixteen vectors by component.
pub(super) type Lane = [f32; LANES];
pub(super) type Lane3 = [Lane; 3];

pub(super) const ZERO: Lane = [0.0; LANES];
pub(super) const ZERO3: Lane3 = [ZERO; 3];

#[inline(always)]
pub(super) fn load(column: &[f32], at: usize) -> Lane {
    let mut lane = ZERO;
    lane.copy_from_slice(&column[at..at + LANES]);
    lane
}

#[inline(always)]
pub(super) fn load3(c: &Columns, at: usize) -> Lane3 {
    [load(&c.x, at), load(&c.y, at), load(&c.z, at)]
}

/// The vectors of a list of at most sixteen; the lanes behind it are zero.
#[inline(always)]
pub(super) fn load_some(c: &Columns, list: &[u32]) -> Lane3 {
    let mut lanes = ZERO3;
    for (lane, column) in lanes.iter_mut().zip([&c.x, &c.y, &c.z]) {
        for (a, &i) in lane.iter_mut().zip(list) {
            *a = column[i as usize];
        }
    }
    lanes
}

#[inline(always)]
pub(super) fn store(column: &mut [f32], at: usize, lane: &Lane) {
    column[at..at + LANES].copy_from_slice(lane);
}

#[inline(always)]
pub(super) fn store3(c: &mut Columns, at: usize, lane: &Lane3) {
    store(&mut c.x, at, &lane[0]);
    store(&mut c.y, at, &lane[1]);
    store(&mut c.z, at, &lane[2]);
}

/// Vector `i`.
#[inline(always)]
pub(super) fn get(lane: &Lane3, i: usize) -> Vec3 {
    Vec3::new(lane[0][i], lane[1][i], lane[2][i])
}

/// Replaces vector `i`.
#[inline(always)]
pub(super) fn put(lane: &mut Lane3, i: usize, v: Vec3) {
    (lane[0][i], lane[1][i], lane[2][i]) = (v.x, v.y, v.z);
}

/// Replaces vector `i` if `is`.
#[inline(always)]
pub(super) fn put_if(lane: &mut Lane3, i: usize, is: bool, v: Vec3) {
    let old = get(lane, i);
    put(lane, i, Vec3::new(if is { v.x } else { old.x }, if is { v.y } else { old.y }, if is { v.z } else { old.z }));
}
