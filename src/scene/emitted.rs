//! E at the vertices of a wave, in SIMD lanes: of few sides by a table, of a constant sky as one colour.

use super::Scene;
use super::faces::{ColourTable, FEW};
use super::groups::Vertices;
use super::sixteen::LANES;
use super::vertex::{ESCAPED, LIGHT, Side};
use crate::math::{Columns, Rgb};
use pulp::{Arch, Simd};

impl Scene {
    /// [`Self::light`] at the first `n` vertices.
    pub(crate) fn light_of_wave(&self, at: Vertices, n: usize, value: &mut Columns) {
        let sky = match &self.lights.environment {
            Some((sky, _)) => sky.constant().map(|(radiance, _)| radiance),
            None => Some(Rgb::ZERO),
        };
        let (Some(table), Some(sky)) = (self.faces.emissions(), sky) else {
            (0..n).for_each(|i| value.set(i, self.light_at(at, i)));
            return;
        };
        let whole = n - n % LANES;
        let others = light_in_lanes(table, sky, &at.side[..whole], value);
        for i in if others { 0 } else { whole }..n {
            value.set(i, self.light_at(at, i));
        }
    }

    #[inline(always)]
    fn light_at(&self, at: Vertices, i: usize) -> Rgb {
        match at.side[i] {
            side if side < LIGHT => self.emission(side),
            _ => self.light(&at.get(i)),
        }
    }
}

/// The emission of every side, and of the sky. Returns true if some vertex is neither.
#[pulp::with_simd(light_in_lanes = Arch::new())]
#[inline(always)]
fn light_in_lanes_with_simd<'a, S: Simd>(
    _simd: S,
    table: &'a ColourTable,
    sky: Rgb,
    side: &'a [Side],
    value: &'a mut Columns,
) -> bool {
    let mut others = 0;
    for (at, side) in side.chunks_exact(LANES).enumerate().map(|(i, side)| (i * LANES, side)) {
        for ((to, table), sky) in [&mut value.x, &mut value.y, &mut value.z].into_iter().zip(table).zip(sky.to_array())
        {
            let to = &mut to[at..at + LANES];
            for i in 0..LANES {
                let surface = table[side[i] as usize % FEW];
                to[i] = if side[i] == ESCAPED { sky } else { surface };
            }
        }
        for side in side {
            others |= u32::from((*side >= LIGHT) & (*side != ESCAPED));
        }
    }
    others != 0
}
