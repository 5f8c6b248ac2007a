//! Variance as a function of the samples per pixel, from the snapshots of one render.
//!
//! `V(n) = mean over pixels and channels of se²(n)`, with the standard error of the [film](super::film) after n samples.
//!
//! The error of V(n) comes from leaving out replicates, see [`scatter`](super::scatter). So it accounts for the dependence
//! between the colours of a pixel, and for heavy tails. It needs three replicates.

use super::deviations::{Deviations, Piece, bands, pieces};
use super::film::{BLOCK, Shape, TermFilm};
use super::largest::Largest;
use super::part::Part;
use super::scatter::{Row, Scatter, Sums, row_length};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// A variance with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variance {
    /// Mean over pixels and channels.
    pub value: f64,
    /// Mean over pixels, for each channel.
    pub channels: DVec3,
    /// Standard error of `value`; NaN with fewer than three replicates.
    pub std_error: f64,
}

impl From<&Scatter> for Variance {
    fn from(s: &Scatter) -> Self {
        Self { value: s.variance(), channels: s.channels, std_error: s.variance_error() }
    }
}

/// The variances at one number of samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Samples per pixel so far.
    pub spp: u32,
    /// Variance of each slot.
    pub slots: Vec<Variance>,
    /// Variance of the sum over all slots.
    pub total: Variance,
    /// Scatter of the replicates: of each slot, then of the sum.
    pub scatter: Vec<Scatter>,
}

impl Snapshot {
    /// The variances after `spp` samples per pixel from the scatter of each slot, then of the sum over all slots.
    pub(super) fn new(spp: u32, scatter: Vec<Scatter>) -> Self {
        let variances: Vec<Variance> = scatter.iter().map(Variance::from).collect();
        let (slots, total) = (variances[..scatter.len() - 1].to_vec(), variances[scatter.len() - 1]);
        Self { spp, slots, total, scatter }
    }
}

/// The variances of a film in its present state. The film is read once for all of them.
pub fn snapshot(film: &TermFilm) -> Snapshot {
    Stand::of(film, Part::WHOLE).snapshot(film.shape)
}

/// What a snapshot is made of, for a part of a film: parts that are rendered apart are put together later.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stand {
    /// Samples per pixel so far.
    pub spp: u32,
    /// The rows of every piece of the part, in the order of the film: of each slot, then of the sum.
    pub(crate) rows: Vec<f64>,
    /// The largest contributions to each slot.
    pub(crate) largest: Vec<Largest>,
}

/// The means of the pixels.
type Image = Vec<[f32; 3]>;

/// What is read of one band of a film.
struct Band {
    rows: Vec<f64>,
    images: Vec<Image>,
}

impl Band {
    /// Reads a piece. `images` says of which slots the means are kept, and the places of these pixels in the band.
    fn piece(
        &mut self,
        piece: &Piece<'_>,
        d: &mut Deviations,
        row: &mut Row,
        images: Option<(&Range<usize>, Range<usize>)>,
    ) {
        let Shape { slots, replicates, .. } = piece.shape();
        let (length, start) = (row_length(replicates), self.rows.len());
        self.rows.resize(start + (slots + 1) * length, 0.0);
        let mut to = self.rows[start..].chunks_mut(length);
        d.begin(piece);
        let mut all = 0.0;
        for (s, to) in to.by_ref().take(slots).enumerate() {
            d.slot(piece, s);
            let added = piece.squares(s).sum();
            row.write(d, added, to);
            d.add(piece, s);
            all += added;
            if let Some((kept, places)) = images.as_ref().filter(|(kept, _)| kept.contains(&s)) {
                d.copy_means(&mut self.images[s - kept.start][places.clone()]);
            }
        }
        d.sum();
        to.for_each(|to| row.write(d, all, to));
        if let Some((kept, places)) = images {
            d.copy_means(&mut self.images[kept.len()][places]);
        }
    }
}

impl Stand {
    /// Reads a part of a film.
    pub fn of(film: &TermFilm, part: Part) -> Self {
        Self::with_images(film, part, None).0
    }

    /// Reads a part of a film, and takes from the same reading the images of some slots and, as the last one, of the sum of all slots.
    /// Without `slots` there are no images. Pixels outside the part are zero.
    pub fn with_images(film: &TermFilm, part: Part, slots: Option<Range<usize>>) -> (Self, Vec<Image>) {
        let shape = film.shape;
        let images = slots.as_ref().map_or(0, |s| s.len() + 1);
        let band = |pixels: Range<usize>| {
            let mut band = Band { images: vec![vec![[0.0; 3]; pixels.len()]; images], rows: vec![] };
            let (mut d, mut row) = (Deviations::default(), Row::default());
            for piece in Piece::all(film, pixels.clone()).filter(|piece| piece.is_in(part)) {
                let places = piece.pixels.start - pixels.start..piece.pixels.end - pixels.start;
                band.piece(&piece, &mut d, &mut row, slots.as_ref().map(|s| (s, places)));
            }
            band
        };
        let bands: Vec<Band> = bands(shape).into_par_iter().map(band).collect();
        let rows = bands.iter().flat_map(|b| &b.rows).copied().collect();
        let image = |i: usize| bands.iter().flat_map(|b| &b.images[i]).copied().collect();
        let stand = Self { spp: film.samples_of(part).start, rows, largest: film.largest.clone() };
        (stand, (0..images).map(image).collect())
    }

    /// Number of numbers of the rows of a part of a film.
    pub(crate) fn length(shape: Shape, part: Part) -> usize {
        let pieces = bands(shape).into_iter().flat_map(pieces).filter(|pixels| part.has(pixels.start / BLOCK));
        pieces.count() * (shape.slots + 1) * row_length(shape.replicates)
    }

    /// The variances of a whole film of that shape.
    pub fn snapshot(&self, shape: Shape) -> Snapshot {
        let (slots, replicates) = (shape.slots, shape.replicates);
        let mut rows = self.rows.chunks(row_length(replicates));
        let band = |pixels: Range<usize>| {
            let mut sums = vec![Sums::new(replicates, false); slots + 1];
            for _ in pieces(pixels) {
                sums.iter_mut().zip(rows.by_ref()).for_each(|(sums, row)| sums.add(row));
            }
            sums
        };
        let bands: Vec<Vec<Sums>> = bands(shape).into_iter().map(band).collect();
        let range = |i: usize| if i < slots { i..i + 1 } else { 0..slots };
        let scatter = |i: usize| Sums::scatter(bands.iter().map(|b| &b[i]), shape, &self.largest[range(i)]);
        Snapshot::new(self.spp, (0..=slots).map(scatter).collect())
    }

    /// Puts the parts of a film together; None unless they are as long as they must be.
    pub fn together(parts: &[(Part, &Self)], shape: Shape) -> Option<Self> {
        let length = (shape.slots + 1) * row_length(shape.replicates);
        let mut rows: Vec<_> = parts.iter().map(|(_, s)| s.rows.chunks_exact(length)).collect();
        let mut all = Self { spp: parts.first()?.1.spp, rows: vec![], largest: vec![Largest::default(); shape.slots] };
        for pixels in bands(shape).into_iter().flat_map(pieces) {
            let owner = parts.iter().position(|(part, _)| part.has(pixels.start / BLOCK))?;
            all.rows.extend_from_slice(rows[owner].next()?);
        }
        for (_, stand) in parts {
            all.largest.iter_mut().zip(&stand.largest).for_each(|(a, b)| a.merge(b));
        }
        let complete = parts.iter().all(|(_, s)| s.spp == all.spp) && rows.iter_mut().all(|r| r.next().is_none());
        complete.then_some(all)
    }
}
