//! The bytes of the rows of stored rays that one part has traced.
//!
//! ```text
//! rays that met no patch · direct light of every row · hits of every row, three bytes each
//! ```

use super::bytes::{read_f32, u64, write_f32, wrong};
use crate::operator::rays::{Hit, Rows};
use crate::terms::Part;
use std::io::{self, Read, Write};

/// Hits that are converted at once.
const AT_ONCE: usize = 4096;

pub(super) fn write(rows: &Rows, file: &mut impl Write) -> io::Result<()> {
    file.write_all(&rows.lost.to_le_bytes())?;
    for direct in &rows.direct {
        write_f32(direct.as_flattened(), file)?;
    }
    let mut bytes = [[0; 3]; AT_ONCE];
    for some in rows.hits.chunks(AT_ONCE) {
        bytes.iter_mut().zip(some).for_each(|(b, hit)| *b = hit.bytes());
        file.write_all(bytes[..some.len()].as_flattened())?;
    }
    Ok(())
}

pub(super) fn read(file: &mut impl Read, part: Part, n: usize, per_row: usize) -> io::Result<Rows> {
    let mut rows = Rows::empty(part, n, per_row);
    rows.lost = u64(file)?;
    for direct in &mut rows.direct {
        read_f32(direct.as_flattened_mut(), file)?;
    }
    let mut bytes = [[0; 3]; AT_ONCE];
    for some in rows.hits.chunks_mut(AT_ONCE) {
        file.read_exact(bytes[..some.len()].as_flattened_mut())?;
        for (hit, bytes) in some.iter_mut().zip(bytes) {
            *hit = Hit::from_bytes(bytes, n).ok_or_else(|| wrong("a ray hits a patch that is not there"))?;
        }
    }
    Ok(rows)
}
