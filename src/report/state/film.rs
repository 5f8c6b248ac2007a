//! The bytes of a film: what one part of a render has added up.
//!
//! ```text
//! samples of every block · rays of every slot · non-finite samples · largest contributions of every slot
//! every block, every slot: 0, or 1 · the sums of every replicate · the squares
//! seconds · stands · early images
//! ```
//!
//! A slot of a block to which nothing was added takes one byte. Only blocks, or replicates, of the part are written.

use super::bytes::{read_f32, read_f64, u32, u64, write_f32, write_f64, wrong};
use crate::terms::film::BLOCK;
use crate::terms::history::{Early, History};
use crate::terms::largest::{KEPT, Largest};
use crate::terms::variance::Stand;
use crate::terms::{Part, Shape, TermFilm};
use std::io::{self, Read, Write};

/// Most stands, and most early images: the number of samples doubles from one to the next.
const MOST: u32 = 32;

pub(super) fn write(film: &TermFilm, history: &History, part: Part, file: &mut impl Write) -> io::Result<()> {
    for block in film.blocks_of(part) {
        file.write_all(&film.samples[block * BLOCK].to_le_bytes())?;
    }
    for rays in &film.rays {
        file.write_all(&rays.to_le_bytes())?;
    }
    file.write_all(&film.non_finite.to_le_bytes())?;
    write_largest(&film.largest, file)?;
    for block in film.blocks_of(part) {
        for slot in 0..film.shape.slots {
            let (sums, squares) = film.slot_of_block(block, slot);
            let some = sums.iter().chain(squares).any(|x| *x != 0.0);
            file.write_all(&[u8::from(some)])?;
            if some {
                rows(film, part, sums).try_for_each(|row| write_f64(&sums[row], file))?;
                rows(film, part, squares).try_for_each(|row| write_f64(&squares[row], file))?;
            }
        }
    }
    write_history(history, part, file)
}

pub(super) fn read(file: &mut impl Read, shape: Shape, shared: bool, part: Part) -> io::Result<(TermFilm, History)> {
    let mut film = TermFilm::empty(shape, shared);
    let blocks: Vec<usize> = film.blocks_of(part).collect();
    for &block in &blocks {
        let n = u32(file)?;
        film.samples[block * BLOCK..][..shape.block(block)].fill(n);
    }
    for rays in &mut film.rays {
        *rays = u64(file)?;
    }
    film.non_finite = u64(file)?;
    film.largest = read_largest(shape.slots, file)?;
    for &block in &blocks {
        for slot in 0..shape.slots {
            let mut some = [0];
            file.read_exact(&mut some)?;
            match some {
                [0] => continue,
                [1] => {}
                _ => return Err(wrong("neither 0 nor 1")),
            }
            let (sums, squares) = film.slot_of_block(block, slot);
            let [own_sums, own_squares] = [sums, squares].map(|s| rows(&film, part, s).collect::<Vec<_>>());
            let (sums, squares) = film.slot_of_block_mut(block, slot);
            own_sums.into_iter().try_for_each(|row| read_f64(&mut sums[row], file))?;
            own_squares.into_iter().try_for_each(|row| read_f64(&mut squares[row], file))?;
        }
    }
    Ok((film, read_history(file, shape, part)?))
}

/// The rows of one slot that belong to a part: all, or those of its replicates.
fn rows(film: &TermFilm, part: Part, numbers: &[f64]) -> impl Iterator<Item = std::ops::Range<usize>> {
    let (replicates, length) = (film.shape.replicates, numbers.len());
    let parts = if film.is_shared() && !part.is_whole() { replicates } else { 1 };
    let each = length / parts;
    (0..parts).filter(move |&r| parts == 1 || part.has(r)).map(move |r| r * each..(r + 1) * each)
}

fn write_largest(all: &[Largest], file: &mut impl Write) -> io::Result<()> {
    for largest in all {
        let (values, added) = largest.kept();
        file.write_all(&added.to_le_bytes())?;
        file.write_all(&(values.len() as u32).to_le_bytes())?;
        write_f32(values, file)?;
    }
    Ok(())
}

fn read_largest(slots: usize, file: &mut impl Read) -> io::Result<Vec<Largest>> {
    let one = |_| {
        let (added, n) = (u64(file)?, u32(file)? as usize);
        if n > 2 * KEPT {
            return Err(wrong("too many largest contributions"));
        }
        let mut values = vec![0.0; n];
        read_f32(&mut values, file)?;
        Ok(Largest::restored(values, added))
    };
    (0..slots).map(one).collect()
}

fn write_history(history: &History, part: Part, file: &mut impl Write) -> io::Result<()> {
    let History { stands, early, seconds } = history;
    file.write_all(&seconds.to_le_bytes())?;
    file.write_all(&(stands.len() as u32).to_le_bytes())?;
    for stand in stands {
        file.write_all(&stand.spp.to_le_bytes())?;
        file.write_all(&(stand.rows.len() as u64).to_le_bytes())?;
        write_f64(&stand.rows, file)?;
        write_largest(&stand.largest, file)?;
    }
    file.write_all(&(early.len() as u32).to_le_bytes())?;
    for early in early {
        file.write_all(&early.spp.to_le_bytes())?;
        file.write_all(&(early.terms.len() as u32).to_le_bytes())?;
        for image in early.images() {
            let blocks = image.chunks(BLOCK).enumerate().filter(|(b, _)| part.has(*b));
            blocks.into_iter().try_for_each(|(_, pixels)| write_f32(pixels.as_flattened(), file))?;
        }
    }
    Ok(())
}

fn read_history(file: &mut impl Read, shape: Shape, part: Part) -> io::Result<History> {
    let mut history = History { seconds: f64::from_bits(u64(file)?), ..History::default() };
    let longest = Stand::length(shape, part);
    for _ in 0..some(file, MOST)? {
        let (spp, length) = (u32(file)?, u64(file)?);
        if length != longest as u64 {
            return Err(wrong("a stand of another shape"));
        }
        let mut rows = vec![0.0; longest];
        read_f64(&mut rows, file)?;
        history.stands.push(Stand { spp, rows, largest: read_largest(shape.slots, file)? });
    }
    for _ in 0..some(file, MOST)? {
        let (spp, terms) = (u32(file)?, some(file, shape.slots as u32)?);
        let mut image = || {
            let mut image = vec![[0.0; 3]; shape.pixels()];
            let mut blocks = image.chunks_mut(BLOCK).enumerate().filter(|(b, _)| part.has(*b));
            blocks.try_for_each(|(_, pixels)| read_f32(pixels.as_flattened_mut(), file))?;
            Ok::<_, io::Error>(image)
        };
        let terms = (0..terms).map(|_| image()).collect::<io::Result<_>>()?;
        history.early.push(Early { spp, terms, whole: image()? });
    }
    Ok(history)
}

/// Reads a number of things; at most `most`.
fn some(file: &mut impl Read, most: u32) -> io::Result<u32> {
    let n = u32(file)?;
    if n <= most { Ok(n) } else { Err(wrong("too many stands or images")) }
}
