//! Connections of a wave, from their places in the sorted order back to their paths.

use super::groups::paths;
use super::sixteen::{LANES, Lane, ZERO, load};
use super::vertex::{NOTHING, Rays};
use crate::math::{Columns, Rgb};
use pulp::{Arch, Simd};

/// What the paths of a wave receive through connections: values, and the densities of both techniques.
pub(crate) struct Received<'a> {
    pub(crate) value: &'a mut Columns,
    pub(crate) pdf: &'a mut [f32],
    pub(crate) other: &'a mut [f32],
}

/// Writes the connections that are not blocked: values `rays.value`, densities `rays.t` and `rays.cosine`. Paths whose
/// connection is blocked or zero receive 0, with densities 1 and 0; paths without a place keep what they have.
#[pulp::with_simd(by_path = Arch::new())]
#[inline(always)]
pub(crate) fn by_path_with_simd<'a, S: Simd>(_simd: S, rays: &'a Rays, to: Received<'a>) {
    let Received { value, pdf, other } = to;
    for ends in rays.ends.windows(2) {
        let (first, end) = (ends[0] as usize, ends[1] as usize);
        for place in (first..end).step_by(LANES) {
            let list = paths(&rays.order, place, end);
            let (flag, blocked) = (&rays.flag[place..place + LANES], &rays.prim[place..place + LANES]);
            if !list.neighbours {
                for place in place..end.min(place + LANES) {
                    let (i, some) = (rays.order[place] as usize, rays.flag[place] != NOTHING && rays.prim[place] == 0);
                    value.set(i, if some { rays.value.get(place) } else { Rgb::ZERO });
                    (pdf[i], other[i]) = if some { (rays.t[place], rays.cosine[place]) } else { (1.0, 0.0) };
                }
                continue;
            }
            // all bits where there is a contribution, so that choosing is two operations on whole registers
            let mut some = [0; LANES];
            for i in 0..LANES {
                some[i] = if (flag[i] != NOTHING) & (blocked[i] == 0) { u32::MAX } else { 0 };
            }
            let at = list.list[0] as usize;
            choose(&mut value.x[at..at + LANES], &load(&rays.value.x, place), &some, 0.0);
            choose(&mut value.y[at..at + LANES], &load(&rays.value.y, place), &some, 0.0);
            choose(&mut value.z[at..at + LANES], &load(&rays.value.z, place), &some, 0.0);
            choose(&mut pdf[at..at + LANES], &load(&rays.t, place), &some, 1.0);
            choose(&mut other[at..at + LANES], &load(&rays.cosine, place), &some, 0.0);
        }
    }
}

#[inline(always)]
fn choose(to: &mut [f32], from: &Lane, some: &[u32; LANES], none: f32) {
    let mut lane = ZERO;
    for i in 0..LANES {
        lane[i] = f32::from_bits(from[i].to_bits() & some[i] | none.to_bits() & !some[i]);
    }
    to.copy_from_slice(&lane);
}
