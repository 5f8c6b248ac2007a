//! The spectral radius on a mesh, on two coarser meshes made of its patches, and in the limit h → 0.
//!
//! ```text
//! r(T_h) = ⟨u, T u⟩_w/⟨u, u⟩_w        r(T_H) ≈ ⟨P R u, T P R u⟩_w/⟨P R u, P R u⟩_w        w = A/ρ
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | u | eigenvector of the largest eigenvalue of T_h, T u = r u | [`Spectral::mode`] |
//! | R, P | R takes the mean over each union of patches; P gives this value to each patch of the union | [`Patches::unions`] |
//! | w, A, ρ | weight of a patch, its area, its reflectance | |
//! | h | √(area/patches), m | [`Radius::h`] |
//!
//! T_H = R T P is the operator of the unions. R u is close to its eigenvector, so the error of the quotient is only of
//! second order in their difference. The quotient costs one product with T. It shares the sampling noise of stored rays with
//! r(T_h), so this noise cancels in the difference of the two. Unions are less regular than a mesh, which matters if there
//! are few patches. Dense matrices have separate coarser meshes. The limit ([`limit`]) is an estimate from the last two
//! values; the first value shows that the meshes get finer.

use crate::operator::matrix::Spectral;
use crate::operator::patches::Patches;
use crate::operator::rays::{Half, Light};
use crate::stats::{Limit, limit};
use glam::DVec3;

/// The spectral radius on one mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radius {
    /// Mesh width √(area/patches), m.
    pub h: f64,
    /// r per channel.
    pub value: DVec3,
    /// Standard error from the sampling of stored rays; 0 if there is none, or if it is shared with the finest mesh.
    pub noise: DVec3,
    /// True if the mesh is fine enough for errors to fall like a power of h: three patches per face, or 400 in all.
    pub resolved: bool,
}

/// Patches per face that a limit needs. With fewer, limits were covered in 21 of 32 cases instead of 95 %
/// (`tests/limits.rs`).
const TO_A_FACE: usize = 3;
/// This many patches in all are enough, because in a mesh of many triangles a face is not a feature of the scene.
const IN_ALL: usize = 400;

impl Radius {
    /// The spectral radius that was found on a mesh.
    pub fn of(patches: &Patches, spectral: &[Spectral; 3], noise: DVec3) -> Self {
        let area: f64 = patches.iter().map(|p| p.area).sum();
        let value = DVec3::from_array(spectral.each_ref().map(|s| s.radius));
        let resolved = patches.len() >= IN_ALL.min(TO_A_FACE * patches.primitives().len());
        Self { h: (area / patches.len() as f64).sqrt(), value, noise, resolved }
    }
}

/// Maximum number of patches in a union, for the two coarser meshes.
const UNIONS: [usize; 2] = [16, 4];
/// With fewer patches than this, unions differ too much from a mesh.
const LEAST: usize = 50_000;
/// Unions of four must reduce the number of patches to less than this fraction. Otherwise most surfaces are curved or have
/// one patch, and the mesh has no coarser one.
const SHRINKS: f64 = 0.4;

/// The radii on unions of up to 16 patches, on unions of up to 4, and on the patches themselves, coarsest first. Only the
/// last one if there are few patches, or if most of them are in no union. `bounce` applies T; `noise` is the standard error
/// of the radius.
pub fn radii(
    patches: &Patches,
    spectral: &[Spectral; 3],
    noise: DVec3,
    bounce: impl Fn(&[DVec3]) -> Vec<DVec3>,
) -> Vec<Radius> {
    let fine = Radius::of(patches, spectral, noise);
    if patches.len() < LEAST {
        return vec![fine];
    }
    let u = mode(spectral);
    let area: f64 = patches.iter().map(|p| p.area).sum();
    let width = |n: usize| (area / n as f64).sqrt();
    let coarser = |most: usize| {
        let union = patches.unions(most);
        let count = union.iter().max().map_or(0, |m| *m as usize + 1);
        let mut sums = vec![(DVec3::ZERO, 0.0); count];
        for ((k, p), u) in union.iter().zip(patches.iter()).zip(&u) {
            let sum = &mut sums[*k as usize];
            *sum = (sum.0 + p.area * *u, sum.1 + p.area);
        }
        let x: Vec<DVec3> = union.iter().map(|k| sums[*k as usize].0 / sums[*k as usize].1).collect();
        let value = inner(patches, &x, &bounce(&x)) / inner(patches, &x, &x);
        (count, Radius { h: width(count), value, noise: DVec3::ZERO, resolved: true })
    };
    let coarse = UNIONS.map(coarser);
    if coarse[1].0 as f64 > SHRINKS * patches.len() as f64 {
        vec![fine]
    } else {
        coarse.into_iter().map(|c| c.1).chain([fine]).collect()
    }
}

/// r for h → 0 per channel, from meshes with the coarsest first. None with one mesh, or if the second finest mesh does not
/// resolve the scene.
pub fn radius_limit(meshes: &[Radius]) -> Option<[Limit; 3]> {
    if !meshes.iter().nth_back(1).is_some_and(|m| m.resolved) {
        return None;
    }
    let of = |c: usize| limit(&meshes.iter().map(|m| (m.h, m.value[c], m.noise[c])).collect::<Vec<_>>());
    Some([of(0)?, of(1)?, of(2)?])
}

/// The standard error of r(T) of stored rays, to first order: rows are independent, and each row has two halves. The halves
/// share the random scramble of their points, so the error is too large by about a third.
pub fn sampled_noise(light: &Light<'_>, spectral: &[Spectral; 3]) -> DVec3 {
    let u = mode(spectral);
    let [first, second] = [Half::First, Half::Second].map(|half| light.bounce(&u, half));
    let row = |(i, p): (usize, &crate::operator::patches::Patch)| {
        let weight = DVec3::select(p.reflectance.cmpgt(DVec3::ZERO), p.area / p.reflectance, DVec3::ZERO);
        let off = weight * u[i] * 0.5 * (first[i] - second[i]);
        off * off
    };
    light.patches.iter().enumerate().map(row).sum::<DVec3>().powf(0.5) / inner(light.patches, &u, &u)
}

fn mode(spectral: &[Spectral; 3]) -> Vec<DVec3> {
    let [r, g, b] = spectral.each_ref().map(|s| &s.mode);
    r.iter().zip(g).zip(b).map(|((r, g), b)| DVec3::new(*r, *g, *b)).collect()
}

/// ⟨x, y⟩_w per channel, over the patches with ρ > 0.
fn inner(patches: &Patches, x: &[DVec3], y: &[DVec3]) -> DVec3 {
    let one = |((p, x), y): ((&crate::operator::patches::Patch, &DVec3), &DVec3)| {
        DVec3::select(p.reflectance.cmpgt(DVec3::ZERO), p.area * *x * *y / p.reflectance, DVec3::ZERO)
    };
    patches.iter().zip(x).zip(y).map(one).sum()
}
