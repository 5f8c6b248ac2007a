//! Sums of a film over a grid of 16 × 16 tiles, from which the [functionals](super::functional) follow.
//!
//! ```text
//! Σ_p m      Σ_p d_r      Σ_p se²,  Σ_p se⁴      Σ x,  Σ x²        over the pixels p of a tile
//! ```
//!
//! Here m, d_r and se are mean, [deviation](super::deviations) of replicate r and standard error of a pixel, and x = r + g + b is
//! one contribution. A row of tiles is one band of the film, so that one thread adds up each tile, pixel by pixel.

use super::deviations::{BANDS, Deviations, Piece, bands};
use super::film::{Shape, TermFilm};
use super::largest::Largest;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Tiles in a row, and rows.
pub(super) const GRID: usize = BANDS;
/// With fewer replicates than this, errors come from the pixels.
const REPLICATES: usize = 8;

/// Data of a slot that is known only for the whole image: Σ x² and the largest contributions.
#[derive(Clone, Debug, Default)]
pub struct Whole {
    pub(super) square: f64,
    pub(super) largest: Largest,
}

/// The slot ranges of the terms, the tail, the sum and the total, in this order; a single slot gives only its own range.
pub(super) fn parts(slots: usize) -> Vec<Range<usize>> {
    let single = (0..slots).map(|s| s..s + 1);
    if slots == 1 { single.collect() } else { single.chain([0..slots - 1, 0..slots]).collect() }
}

/// Sums of one tile.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    /// Number of its pixels.
    pub pixels: f64,
    /// Σ m, by slot.
    pub mean: Vec<DVec3>,
    /// Σ d_r, by slot and replicate.
    pub deviation: Vec<DVec3>,
    /// Σ x, and below Σ x², of all contributions, by slot.
    pub sum: Vec<f64>,
    pub square: Vec<f64>,
    /// Σ se² and Σ se⁴ of the [`parts`], if replicates are few and pixels share no path; otherwise empty.
    pub noise: Vec<[DVec3; 2]>,
}

/// The tiles of one row that have pixels.
pub(super) struct TileRow {
    width: usize,
    tiles: Vec<Tile>,
    /// For each column of the grid, the number of its tile.
    places: [Option<usize>; GRID],
    noisy: bool,
}

impl TileRow {
    /// The tiles in which these pixels lie, which are whole rows of the film.
    pub(super) fn new(film: &TermFilm, pixels: &Range<usize>) -> Self {
        let Shape { size, slots, replicates } = film.shape;
        let width = size[0] as usize;
        let noisy = (2..REPLICATES).contains(&replicates) && !film.shared;
        let tile = Tile {
            pixels: 0.0,
            mean: vec![DVec3::ZERO; slots],
            deviation: vec![DVec3::ZERO; slots * replicates],
            sum: vec![0.0; slots],
            square: vec![0.0; slots],
            noise: if noisy { vec![[DVec3::ZERO; 2]; parts(slots).len()] } else { vec![] },
        };
        let mut row = Self { width, tiles: vec![], places: [None; GRID], noisy };
        let columns = if pixels.is_empty() { 0 } else { width };
        for column in (0..columns).map(|x| x * GRID / width) {
            if row.places[column].is_none() {
                row.places[column] = Some(row.tiles.len());
                row.tiles.push(tile.clone());
            }
        }
        row
    }

    /// For each pixel of a piece, the number of its tile.
    pub(super) fn places(&self, piece: &Piece<'_>) -> Vec<usize> {
        let tile = |p: usize| self.places[p % self.width * GRID / self.width].unwrap_or_default();
        piece.pixels.clone().map(tile).collect()
    }

    /// Counts the pixels of a piece.
    pub(super) fn pixels(&mut self, places: &[usize]) {
        places.iter().for_each(|&t| self.tiles[t].pixels += 1.0);
    }

    /// Adds one slot of a piece.
    pub(super) fn slot(&mut self, piece: &Piece<'_>, places: &[usize], slot: usize, d: &Deviations) {
        let n = f64::from(piece.samples());
        let each = places.iter().zip(d.mean.as_chunks().0).zip(piece.squares(slot));
        for ((&t, &mean), square) in each {
            let (tile, mean) = (&mut self.tiles[t], DVec3::from_array(mean));
            tile.mean[slot] += mean;
            tile.sum[slot] += mean.element_sum() * n;
            tile.square[slot] += square;
        }
        // neighbouring pixels of one tile are added to a sum that stays in registers
        let mut first = 0;
        for same in places.chunk_by(|a, b| a == b) {
            let sums = &mut self.tiles[same[0]].deviation[slot * d.replicates..][..d.replicates];
            for (r, sum) in sums.iter_mut().enumerate() {
                let of = &d.replicate(r).as_chunks().0[first..first + same.len()];
                *sum = of.iter().fold(*sum, |a, d| a + DVec3::from_array(*d));
            }
            first += same.len();
        }
    }

    /// Adds the errors of the pixels of a piece; `part` is the number of the range of slots among [`parts`].
    pub(super) fn noise(&mut self, places: &[usize], part: usize, d: &Deviations) {
        for (&t, (_, error)) in places.iter().zip(d.pixels()).filter(|_| self.noisy) {
            let v = error * error;
            let noise = &mut self.tiles[t].noise[part];
            *noise = [noise[0] + v, noise[1] + v * v];
        }
    }
}

/// All tiles.
pub(super) struct Tiles {
    /// The tiles that have pixels: place in the grid, row by row, and sums.
    pub tiles: Vec<(usize, Tile)>,
    /// Data of each slot over the whole image.
    pub whole: Vec<Whole>,
    pub shape: Shape,
}

impl Tiles {
    /// Puts the rows together.
    pub(super) fn of_rows(film: &TermFilm, rows: impl Iterator<Item = TileRow>) -> Self {
        let mut tiles = vec![];
        for (y, row) in rows.enumerate() {
            let mut all: Vec<Option<Tile>> = row.tiles.into_iter().map(Some).collect();
            for (x, place) in row.places.iter().enumerate() {
                tiles.extend(place.and_then(|t| all[t].take()).map(|tile| (y * GRID + x, tile)));
            }
        }
        let square = |s: usize| tiles.iter().map(|(_, t)| t.square[s]).sum();
        let whole = |s: usize| Whole { square: square(s), largest: film.largest[s].clone() };
        Self { whole: (0..film.shape.slots).map(whole).collect(), tiles, shape: film.shape }
    }

    /// Reads a film.
    pub(super) fn of(film: &TermFilm) -> Self {
        let slots = film.shape.slots;
        let of = |pixels: Range<usize>| {
            let (mut row, mut d) = (TileRow::new(film, &pixels), Deviations::default());
            for piece in Piece::all(film, pixels) {
                let places = row.places(&piece);
                row.pixels(&places);
                d.begin(&piece);
                for s in 0..slots {
                    d.slot(&piece, s);
                    row.slot(&piece, &places, s, &d);
                }
                let noisy = if row.noisy { parts(slots) } else { vec![] };
                for (i, part) in noisy.into_iter().enumerate() {
                    d.slots(&piece, part);
                    row.noise(&places, i, &d);
                }
            }
            row
        };
        let rows: Vec<TileRow> = bands(film.shape).into_par_iter().map(of).collect();
        Self::of_rows(film, rows.into_iter())
    }

    /// True if errors come from the pixels.
    pub(super) fn noisy(&self) -> bool {
        self.tiles.first().is_some_and(|(_, t)| !t.noise.is_empty())
    }
}
