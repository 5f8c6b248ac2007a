//! Some rows of F, those of one part: a row is traced by one part alone, so that parts on several machines put together have the
//! bits of one.
//!
//! ```text
//! row i belongs to part i mod n
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | number of parts | [`Part::of`] |
//! | i | number of a row, and of its patch | [`Rows::numbers`] |
//! | N | rays of a row | [`Rows::per_row`] |

use super::caster::{Caster, Scratch};
use super::lamps::Lamps;
use super::{Hit, Rays};
use crate::math::Key;
use crate::operator::form_factor::Stopped;
use crate::operator::patches::Patches;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::terms::Part;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// The rows of one part.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// The part.
    pub part: Part,
    /// Number of patches, and of the rows of all parts.
    pub n: usize,
    /// N, the number of rays per row; it is even.
    pub per_row: usize,
    /// The hits of the k-th row of the part begin at `k·N`: those of its first half, ascending, then those of its second half.
    pub hits: Vec<Hit>,
    /// Direct light T E per row, half of the rays, and channel; the reflectance ρ is included.
    pub direct: Vec<[[f32; 3]; 2]>,
    /// Number of rays that hit a reflecting surface at a point without a patch.
    pub lost: u64,
}

/// Number of rows per progress report, because a row takes little time.
const ROWS: u64 = 64;

impl Rows {
    /// Rows without hits and light.
    pub fn empty(part: Part, n: usize, per_row: usize) -> Self {
        let own = Self::count(part, n);
        Self { part, n, per_row, hits: vec![Hit::NOTHING; own * per_row], direct: vec![[[0.0; 3]; 2]; own], lost: 0 }
    }

    /// Number of rows that a part has of `n`.
    pub fn count(part: Part, n: usize) -> usize {
        n.saturating_sub(part.index as usize).div_ceil(part.of as usize)
    }

    /// The numbers of the rows of the part, in the order of [`Rows::direct`].
    pub fn numbers(&self) -> impl Iterator<Item = usize> + use<> {
        (self.part.index as usize..self.n).step_by(self.part.of as usize)
    }

    /// Traces the rows of a part; see [`Rays::new`].
    ///
    /// # Errors
    /// [`Stopped`] if `progress` asks to stop.
    ///
    /// # Panics
    /// If the mesh has more than [`Hit::MOST`] patches.
    pub fn trace(
        patches: &Patches,
        scene: &Scene,
        per_row: usize,
        seed: u64,
        part: Part,
        progress: Progress<'_>,
    ) -> Result<Self, Stopped> {
        assert!(patches.len() <= Hit::MOST, "patches are numbered in three bytes");
        let caster = Caster { patches, scene, lamps: Lamps::new(patches), key: Key::new(seed, "form factors") };
        let (done, lost) = (AtomicU64::new(0), AtomicU64::new(0));
        let mut rows = Self::empty(part, patches.len(), per_row);
        let own = rows.direct.len() as u64;
        let number = |k: usize| part.index as usize + k * part.of as usize;
        rows.hits.par_chunks_mut(per_row).zip(&mut rows.direct).enumerate().with_min_len(16).for_each_init(
            || Scratch::new(per_row),
            |scratch, (k, (row, direct))| {
                if progress.stopped() {
                    return;
                }
                let (i, mut met) = (number(k), std::mem::take(&mut scratch.row));
                lost.fetch_add(caster.row(i, scratch, &mut met), Relaxed);
                *direct = caster.direct(i, &met, scratch);
                met.chunks_mut(per_row / 2).for_each(<[u32]>::sort_unstable);
                row.iter_mut().zip(&met).for_each(|(hit, patch)| *hit = Hit::new(*patch));
                scratch.row = met;
                let done = done.fetch_add(1, Relaxed) + 1;
                if done % ROWS == 0 || done == own {
                    progress.advance(if done % ROWS == 0 { ROWS } else { done % ROWS });
                }
            },
        );
        rows.lost = lost.into_inner();
        if progress.stopped() { Err(Stopped) } else { Ok(rows) }
    }
}

impl Rays {
    /// Traces `per_row` rays from every patch. The number is rounded up to an even number; powers of two are best. The
    /// result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`Stopped`] if `progress` asks to stop.
    ///
    /// # Panics
    /// If the mesh has more than [`Hit::MOST`] patches.
    pub fn new(
        patches: &Patches,
        scene: &Scene,
        per_row: usize,
        seed: u64,
        progress: Progress<'_>,
    ) -> Result<Self, Stopped> {
        let rows = Rows::trace(patches, scene, Self::rounded(per_row), seed, Part::WHOLE, progress)?;
        Ok(Self::of(patches, rows))
    }

    /// The number of rays of a row for which `asked` are asked for: an even number.
    pub fn rounded(asked: usize) -> usize {
        asked.max(2).next_multiple_of(2)
    }

    /// Rays that have hit nothing, for [`Rays::take`].
    pub fn empty(patches: &Patches, per_row: usize) -> Self {
        Self::of(patches, Rows::empty(Part::WHOLE, patches.len(), Self::rounded(per_row)))
    }

    /// Takes over the rows of a part.
    ///
    /// # Panics
    /// If the rows are of another mesh, or have another number of rays.
    pub fn take(&mut self, rows: &Rows) {
        assert_eq!((self.n, self.per_row), (rows.n, rows.per_row), "rows of other rays");
        for (k, i) in rows.numbers().enumerate() {
            let own = &rows.hits[k * self.per_row..(k + 1) * self.per_row];
            self.hits[i * self.per_row..(i + 1) * self.per_row].copy_from_slice(own);
            self.direct[i] = rows.direct[k];
        }
        self.lost += rows.lost;
    }

    /// All rows of a mesh.
    fn of(patches: &Patches, rows: Rows) -> Self {
        let Rows { n, per_row, hits, direct, lost, .. } = rows;
        Self { n, per_row, area: patches.areas(), hits, direct, lost }
    }
}
