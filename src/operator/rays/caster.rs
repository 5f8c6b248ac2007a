//! Traces the rays of a row and finds the patches that they hit.

use super::lamps::Lamps;
use super::lattice::Lattice;
use super::origin::Origins;
use crate::math::direction::cosine_hemisphere;
use crate::math::{Key, Purpose};
use crate::operator::patches::{Lookup, Patches};
use crate::scene::{Scene, Vertex, VertexWave, error, offset_origin};
use glam::{DVec3, Vec3};

/// Entry of a row for a ray that left the scene or hit a side that takes no part in transport.
pub(super) const NOTHING: u32 = u32::MAX;

/// Working memory for the rays of a row, in whole packets, and for the contributions of point pairs before the visibility
/// test.
pub(super) struct Scratch {
    pub(super) row: Vec<u32>,
    pub(super) wave: VertexWave,
    pub(super) lookup: Lookup,
    /// The numbers of the rays that arrived somewhere, and the vertices that they hit.
    pub(super) met: Vec<(usize, Vertex)>,
    pub(super) unblocked: Vec<DVec3>,
}

impl Scratch {
    pub(super) fn new(n: usize) -> Self {
        let mut wave = VertexWave::default();
        wave.resize(n.next_multiple_of(64));
        let (row, unblocked) = (vec![NOTHING; n], vec![DVec3::ZERO; n]);
        Self { row, wave, lookup: Lookup::default(), met: Vec::with_capacity(n), unblocked }
    }
}

pub(super) struct Caster<'a> {
    pub(super) patches: &'a Patches,
    pub(super) scene: &'a Scene,
    pub(super) lamps: Lamps,
    pub(super) key: Key,
}

impl Caster<'_> {
    /// Fills row `i` with hits, in the order of the lattice points. Returns the number of rays that hit a reflecting surface
    /// at a point without a patch.
    pub(super) fn row(&self, i: usize, scratch: &mut Scratch, row: &mut [u32]) -> u64 {
        row.fill(NOTHING);
        let mut origins = Origins::new(self.patches, i);
        let points = Lattice::new(self.key, i, Purpose::Scatter);
        let Scratch { wave, lookup, met, .. } = scratch;
        let rays = &mut wave.rays;
        for k in 0..row.len() {
            let (at, [u, v, ..]) = origins.next(|s| points.at(s));
            let normal = at.normal.as_vec3();
            rays.o.set(k, offset_origin(at.position.as_vec3(), normal));
            rays.d.set(k, cosine_hemisphere(normal, [u, v]).0);
        }
        met.clear();
        let meet = |k: usize, v: Vertex| {
            if self.scene.takes_part(v.side) {
                met.push((k, v));
            }
        };
        self.scene.trace_wave(rays, row.len(), meet);
        lookup.clear();
        met.iter().for_each(|(_, v)| lookup.ask(self.patches, v.side / 2, v.side & 1 == 0, v.p.as_dvec3()));
        let mut lost = 0;
        for ((k, v), found) in met.iter().zip(lookup.answers(self.patches)) {
            row[*k] = found.or_else(|| self.nearby(v)).unwrap_or_else(|| {
                lost += 1;
                NOTHING
            });
        }
        lost
    }

    /// Finds the patch of a hit that rounding has placed under another object that stands on the surface. A small step back
    /// along the ray leads to an uncovered point.
    fn nearby(&self, v: &Vertex) -> Option<u32> {
        let offset = error(v.p, Vec3::ONE);
        let find = |back: f32| {
            let p = (v.p + back * v.omega).as_dvec3();
            self.patches.locate((v.side / 2) as usize, v.side & 1 == 0, p).map(|j| j as u32)
        };
        find(offset).or_else(|| find(4.0 * offset))
    }
}
