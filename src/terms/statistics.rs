//! All statistics of a film, from one pass over its memory.
//!
//! A film of 256² pixels, 16 replicates and 10 slots has 250 MB. Reading it costs more than the arithmetic, so everything
//! that a result needs is computed while a piece of it is in the cache.
//!
//! | statistic | place |
//! |---|---|
//! | images of the terms, the tail, the sum and the total | [`TermImage`] |
//! | number of events behind the median pixel | [`image`](super::image) |
//! | variances | [`Snapshot`] |
//! | squared norms of the terms | [`norms`](super::norms) |
//! | image mean, regions, projections | [`functional`](mod@super::functional) |
//! | sums over tiles | [`tile_sums`](super::tile_sums) |

use super::deviations::{Deviations, Piece, bands};
use super::film::TermFilm;
use super::functional::{self, Replicates};
use super::image::{PixelEvents, TermImage};
use super::norms::{NormSums, SquaredNorm};
use super::scatter::{self, Scatter};
use super::series::Functional;
use super::tile_sums::TileSums;
use super::tiles::{TileRow, Tiles, parts};
use super::variance::Snapshot;
use rayon::prelude::*;
use std::ops::Range;

/// All statistics of a film.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// The images of the slots, of the sum of all slots but the last, and of the whole; only one if there is one slot.
    pub images: Vec<TermImage>,
    /// Number of events behind the median pixel of each of these images.
    pub events: Vec<f64>,
    /// The variances; with one replicate they are NaN.
    pub snapshot: Snapshot,
    /// Squared L2 norms of the images of all slots but the last; none with fewer than three replicates.
    pub norms: Vec<Option<SquaredNorm>>,
    /// Image mean, region means and projections.
    pub functionals: Vec<Functional>,
    /// The image mean, replicate by replicate.
    pub replicates: Replicates,
    /// Sums over tiles, replicate by replicate.
    pub tiles: TileSums,
}

/// What is added up for one image.
struct Part {
    image: TermImage,
    events: PixelEvents,
    scatter: scatter::Sums,
    norm: NormSums,
}

impl Statistics {
    /// Reads a film.
    pub fn of(film: &TermFilm) -> Self {
        let (slots, all) = (film.shape.slots, bands(film.shape));
        let (rows, bands): (Vec<TileRow>, Vec<Vec<Part>>) =
            all.into_par_iter().map(|pixels| band(film, pixels)).unzip();
        let ranges = parts(slots);
        let part = |i: usize| bands.iter().map(move |b| &b[i]);
        let each = 0..ranges.len();
        let images = each.clone().into_par_iter().map(|i| TermImage::of_bands(part(i).map(|p| &p.image)));
        let events = each.clone().into_par_iter().map(|i| PixelEvents::median(part(i).map(|p| &p.events)));
        let scatter = |i: usize| {
            scatter::Sums::scatter(part(i).map(|p| &p.scatter), film.shape, &film.largest[ranges[i].clone()])
        };
        // the sum without the tail has no variance in a snapshot
        let scatters: Vec<Scatter> = (0..slots).chain([ranges.len() - 1]).map(scatter).collect();
        let norm = |i: usize| NormSums::norm(part(i).map(|p| &p.norm), film.shape);
        let tiles = Tiles::of_rows(film, rows.into_iter());
        Self {
            images: images.collect(),
            events: events.collect(),
            snapshot: Snapshot::new(film.least_samples(), scatters),
            norms: (0..slots - 1).map(norm).collect(),
            functionals: functional::all(&tiles),
            replicates: functional::image(&tiles),
            tiles: TileSums::of(&tiles, !film.shared),
        }
    }
}

/// Reads one band of a film.
fn band(film: &TermFilm, pixels: Range<usize>) -> (TileRow, Vec<Part>) {
    let (slots, replicates) = (film.shape.slots, film.shape.replicates);
    let part = |_| Part {
        image: TermImage::default(),
        events: PixelEvents::default(),
        scatter: scatter::Sums::new(replicates, false),
        norm: NormSums::new(replicates),
    };
    let mut all: Vec<Part> = parts(slots).into_iter().map(part).collect();
    let (mut tiles, mut d, mut memory) = (TileRow::new(film, &pixels), Deviations::default(), vec![]);
    let mut row = (scatter::Row::default(), vec![0.0; scatter::row_length(replicates)]);
    for piece in Piece::all(film, pixels) {
        let places = tiles.places(&piece);
        tiles.pixels(&places);
        d.begin(&piece);
        // Σ x² of the slots so far, by pixel and over all pixels
        let (mut squares, mut added) = (vec![0.0; piece.pixels.len()], 0.0);
        for s in 0..slots {
            d.slot(&piece, s);
            tiles.slot(&piece, &places, s, &d);
            tiles.noise(&places, s, &d);
            let own: Vec<f64> = piece.squares(s).collect();
            let own_added = own.iter().sum();
            all[s].piece(&d, &own, own_added, &mut row);
            if s + 1 < slots {
                all[s].norm.piece(&d, &mut memory);
            }
            d.add(&piece, s);
            added += own_added;
            squares.iter_mut().zip(&own).for_each(|(a, b)| *a += b);
            // the sum without the tail, or the whole
            if slots > 1 && s + 2 >= slots {
                let i = s + 2;
                d.sum();
                tiles.noise(&places, i, &d);
                all[i].piece(&d, &squares, added, &mut row);
            }
        }
    }
    (tiles, all)
}

impl Part {
    /// Adds a piece; `squares` is Σ x² of each pixel, and `added` that of all of them. `row` is memory for a row of the scatter.
    fn piece(&mut self, d: &Deviations, squares: &[f64], added: f64, (row, numbers): &mut (scatter::Row, Vec<f64>)) {
        self.image.piece(d);
        row.write(d, added, numbers);
        self.scatter.add(numbers);
        for (sum, square) in d.all.as_chunks::<3>().0.iter().zip(squares) {
            self.events.push(sum.iter().sum(), *square);
        }
    }
}
