//! Numbers as little-endian bytes, with a checksum of all of them.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;

/// A reader or writer that counts the bytes and computes their CRC-32.
pub(super) struct Hashed<F> {
    file: F,
    crc: crc32fast::Hasher,
    length: u64,
}

impl<F> Hashed<F> {
    pub(super) fn new(file: F) -> Self {
        Self { file, crc: crc32fast::Hasher::new(), length: 0 }
    }

    /// Number and checksum of the bytes.
    pub(super) fn done(self) -> (u64, u32) {
        (self.length, self.crc.finalize())
    }

    fn take_in(&mut self, bytes: &[u8]) {
        self.crc.update(bytes);
        self.length += bytes.len() as u64;
    }
}

impl<F: Write> Write for Hashed<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.take_in(&bytes[..n]);
        Ok(n)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl<F: Read> Read for Hashed<F> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let n = self.file.read(bytes)?;
        self.take_in(&bytes[..n]);
        Ok(n)
    }
}

/// An error about the contents of a file.
pub(super) fn wrong(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// Copies some bytes of a file.
pub(super) fn copy(from: &mut (impl Read + Seek), bytes: Range<u64>, to: &mut impl Write) -> io::Result<()> {
    from.seek(SeekFrom::Start(bytes.start))?;
    let copied = io::copy(&mut from.take(bytes.end - bytes.start), to)?;
    if copied == bytes.end - bytes.start { Ok(()) } else { Err(wrong("a film is missing in the old state")) }
}

pub(super) fn u64(file: &mut impl Read) -> io::Result<u64> {
    let mut bytes = [0; 8];
    file.read_exact(&mut bytes)?;
    Ok(u64::from_le_bytes(bytes))
}

pub(super) fn u32(file: &mut impl Read) -> io::Result<u32> {
    let mut bytes = [0; 4];
    file.read_exact(&mut bytes)?;
    Ok(u32::from_le_bytes(bytes))
}

/// Numbers that are converted at once.
const AT_ONCE: usize = 1024;

pub(super) fn write_f64(numbers: &[f64], file: &mut impl Write) -> io::Result<()> {
    let mut bytes = [0; 8 * AT_ONCE];
    for some in numbers.chunks(AT_ONCE) {
        bytes.as_chunks_mut().0.iter_mut().zip(some).for_each(|(b, x)| *b = x.to_le_bytes());
        file.write_all(&bytes[..8 * some.len()])?;
    }
    Ok(())
}

pub(super) fn read_f64(numbers: &mut [f64], file: &mut impl Read) -> io::Result<()> {
    let mut bytes = [0; 8 * AT_ONCE];
    for some in numbers.chunks_mut(AT_ONCE) {
        file.read_exact(&mut bytes[..8 * some.len()])?;
        some.iter_mut().zip(bytes.as_chunks().0).for_each(|(x, b)| *x = f64::from_le_bytes(*b));
    }
    Ok(())
}

pub(super) fn write_f32(numbers: &[f32], file: &mut impl Write) -> io::Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    file.write_all(&bytes)
}

pub(super) fn read_f32(numbers: &mut [f32], file: &mut impl Read) -> io::Result<()> {
    for x in numbers {
        *x = f32::from_bits(u32(file)?);
    }
    Ok(())
}
