//! Sums over a grid of 16 × 16 tiles by slot and replicate: enough for the mean of any block of tiles, with its error.
//!
//! ```text
//! mean of a block    m = Σ_t M_t / n           se² = R/(R−1) Σ_r (Σ_t D_{t,r} / n)²
//! ```
//!
//! The errors of single pixels do not add up where pixels share paths (light tracing) or points (Sobol). The replicates are
//! independent in any case, so the error of a block comes from them.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | number of pixels of the block | [`TileSums::pixels`] |
//! | M_t | Σ_p m_p over the pixels of tile t | [`TileSums::mean`] |
//! | D_{t,r} | Σ_p d_{p,r}, where d is the deviation of replicate r | [`TileSums::deviation`] |

use super::tiles::{GRID, Tiles};

/// Tiles of a row, and rows of tiles: pixel (x, y) of a w × h image is in tile (⌊16 x/w⌋, ⌊16 y/h⌋).
pub const TILES: usize = GRID;

/// Sums of all tiles, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileSums {
    /// Number of pixels, by tile.
    pub pixels: Vec<u32>,
    /// Sum of the pixel means, by tile and slot.
    pub mean: Vec<[f32; 3]>,
    /// Sum of the deviations, by tile, slot and replicate.
    pub deviation: Vec<[f32; 3]>,
    /// Number of slots.
    pub slots: usize,
    /// Number of replicates.
    pub replicates: usize,
    /// True if no two pixels share paths, so that the errors of pixels may be added.
    pub apart: bool,
}

impl TileSums {
    pub(super) fn of(tiles: &Tiles, apart: bool) -> Self {
        let (slots, replicates) = (tiles.shape.slots, tiles.shape.replicates);
        let all = GRID * GRID;
        let mut sums = Self {
            pixels: vec![0; all],
            mean: vec![[0.0; 3]; all * slots],
            deviation: vec![[0.0; 3]; all * slots * replicates],
            slots,
            replicates,
            apart,
        };
        for (t, tile) in &tiles.tiles {
            sums.pixels[*t] = tile.pixels as u32;
            let places = (&mut sums.mean[t * slots..][..slots], &mut sums.deviation[t * slots * replicates..]);
            places.0.iter_mut().zip(&tile.mean).for_each(|(to, m)| *to = m.as_vec3().to_array());
            places.1.iter_mut().zip(&tile.deviation).for_each(|(to, d)| *to = d.as_vec3().to_array());
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::film::{Shape, TermFilm};
    use crate::terms::functional::image_replicates;
    use glam::DVec3;

    /// All tiles together are the image, and its replicates are the sums of theirs.
    #[test]
    fn tiles_add_up_to_the_image() {
        let slots: Vec<Vec<DVec3>> =
            (0..3).map(|s| (0..40 * 23).map(|p| DVec3::new(0.1, 0.2, 0.3) * f64::from(p + s)).collect()).collect();
        let film = TermFilm::exact([40, 23], &slots);
        let (tiles, image) = (Tiles::of(&film), image_replicates(&film));
        let sums = TileSums::of(&tiles, true);
        let Shape { replicates, .. } = film.shape;
        assert_eq!(sums.pixels.iter().sum::<u32>(), 40 * 23);
        for s in 0..3 {
            let mean: f64 = (0..TILES * TILES).map(|t| f64::from(sums.mean[t * 3 + s][1])).sum();
            assert!((mean / 920.0 / image.mean[s].y - 1.0).abs() < 1e-6);
            for (r, expected) in image.deviation.iter().enumerate() {
                let of = |t: usize| f64::from(sums.deviation[(t * 3 + s) * replicates + r][2]);
                let found: f64 = (0..TILES * TILES).map(of).sum();
                assert!((found / 920.0 - expected[s].z).abs() < 1e-6 * image.mean[s].z);
            }
        }
    }
}
