//! The test of a ray and a triangle, for one triangle or several at once.
//!
//! ```text
//! w_i = ((a − b) × (a + b)) · d      a, b: the ends of edge i, as seen from o
//! t   = (h − n·o)/(n·d)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | o, d | origin and direction of the ray | |
//! | w_i | volume between the ray and edge i, which is opposite to corner i; the line passes inside if all have the same sign | [`edges`] |
//! | n, h | the plane n·p = h of the triangle | |
//! | t | where the ray meets the plane, in units of the length of d | [`distance`] |
//!
//! The functions are written for any type that has the operations of a number: `f32`, or several `f32` in lanes. No operation
//! is fused with another, so every type gives the same bits.
//!
//! Reference: the Plücker test in the robust form of Embree (Wald et al. 2014); Woop, Benthin, Wald, *Watertight
//! Ray/Triangle Intersection* (2013).

use std::ops::{Add, Div, Mul, Sub};

/// What the formulas need of a number.
pub(crate) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
}

impl Number for f32 {}

#[inline(always)]
fn plus<F: Number>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn minus<F: Number>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot<F: Number>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<F: Number>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Volume between a ray and an edge, whose ends are given relative to the start of the ray. The sign is exactly opposite if
/// the ends are exchanged.
#[inline(always)]
pub(crate) fn edge<F: Number>(a: [F; 3], b: [F; 3], d: [F; 3]) -> F {
    dot(cross(minus(a, b), plus(a, b)), d)
}

/// The volumes w between a ray and the edges of a triangle with these corners.
#[inline(always)]
pub(crate) fn edges<F: Number>(corners: [[F; 3]; 3], o: [F; 3], d: [F; 3]) -> [F; 3] {
    let [a, b, c] = [minus(corners[0], o), minus(corners[1], o), minus(corners[2], o)];
    [edge(c, b, d), edge(a, c, d), edge(b, a, d)]
}

/// Where a ray meets the plane n·p = h.
#[inline(always)]
pub(crate) fn distance<F: Number>(n: [F; 3], h: F, o: [F; 3], d: [F; 3]) -> F {
    (h - dot(n, o)) / dot(n, d)
}
