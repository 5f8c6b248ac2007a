//! Mutated copies of files, by a seed: for the short run with every change, without the instruments of a coverage-guided fuzzer.

use std::path::Path;

/// Random numbers of one case (splitmix64; Steele, Lea, Flood 2014).
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`; 0 if `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// The words of a dictionary in the format of libFuzzer: one word per line, in quotes, with `\xNN` for other bytes.
pub fn dictionary(path: &Path) -> Vec<Vec<u8>> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let word = |line: &str| {
        let inner = line.trim().strip_prefix('"')?.strip_suffix('"')?;
        let mut parts = inner.split("\\x");
        let mut out = parts.next()?.as_bytes().to_vec();
        for part in parts {
            out.push(u8::from_str_radix(part.get(..2)?, 16).ok()?);
            out.extend(part.as_bytes().get(2..)?);
        }
        Some(out)
    };
    text.lines().filter_map(word).collect()
}

/// Numbers at which readers err.
const NUMBERS: [u64; 12] = [0, 1, 2, 0x7f, 0x80, 0xff, 0x7fff, 0x8000, 0xffff, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff];

/// A copy of one of the files with one to five changes.
pub fn mutated(corpus: &[Vec<u8>], words: &[Vec<u8>], r: &mut Random) -> Vec<u8> {
    let mut out = corpus[r.below(corpus.len())].clone();
    let more = r.below(2) * r.below(5);
    for _ in 0..=more {
        let at = r.below(out.len() + 1);
        let end = (at + r.below(16)).min(out.len());
        match r.below(9) {
            8 => renumber(&mut out, at, r),
            0 => {
                if let Some(byte) = out.get_mut(at) {
                    *byte ^= 1 << r.below(8);
                }
            }
            1 => drop(out.drain(at..end)),
            2 => {
                let part = out[at..end].to_vec();
                out.splice(at..at, part);
            }
            3 => {
                let (number, width) = (NUMBERS[r.below(12)], [1, 2, 4][r.below(3)]);
                let bytes =
                    if r.below(2) == 0 { number.to_le_bytes() } else { (number << (64 - 8 * width)).to_be_bytes() };
                let end = (at + width).min(out.len());
                out.splice(at..end, bytes.into_iter().take(width));
            }
            4 | 5 if !words.is_empty() => {
                let end = if r.below(2) == 0 { at } else { end };
                out.splice(at..end, words[r.below(words.len())].iter().copied());
            }
            6 => {
                let other = &corpus[r.below(corpus.len())];
                let from = r.below(other.len() + 1);
                let to = (from + r.below(200)).min(other.len());
                out.splice(at..end, other[from..to].iter().copied());
            }
            _ => {
                if r.below(8) == 0 {
                    out.truncate(at);
                } else if let Some(byte) = out.get_mut(at) {
                    *byte = r.below(256) as u8;
                }
            }
        }
    }
    if r.below(8) > 0 {
        repair(&mut out);
        repair_state(&mut out);
    }
    out
}

/// Another value for the first number in ASCII from `at` on.
fn renumber(out: &mut Vec<u8>, at: usize, r: &mut Random) {
    let part = |b: &u8| b.is_ascii_digit() || b".-".contains(b);
    let Some(start) = (at..out.len()).find(|&i| part(&out[i])) else { return };
    let end = (start..out.len()).find(|&i| !part(&out[i])).unwrap_or(out.len());
    let number = match r.below(4) {
        0 => NUMBERS[r.below(12)].to_string(),
        1 => f64::from_bits(r.next()).to_string(),
        2 => ((r.below(6000) as f64 - 3000.0) / 1000.0).to_string(),
        _ => (r.below(9) as i32 - 4).to_string(),
    };
    out.splice(start..end, number.into_bytes());
}

/// Corrects the checksums of a PNG file, so that its reader looks at what was changed.
fn repair(bytes: &mut [u8]) {
    let mut at = 8;
    while bytes.starts_with(b"\x89PNG\r\n\x1a\n") && at + 12 <= bytes.len() {
        let length = u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize;
        let Some(end) = at.checked_add(8 + length).filter(|end| end + 4 <= bytes.len()) else { return };
        let sum = crc(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
}

/// Corrects the checksums of a state, so that its reader looks at what was changed.
fn repair_state(bytes: &mut Vec<u8>) {
    const END: &[u8] = b"state end";
    let Some(foot) = bytes.len().checked_sub(12 + END.len()).filter(|_| bytes.ends_with(END)) else { return };
    let length = u64::from_le_bytes(bytes[foot..foot + 8].try_into().unwrap()) as usize;
    let Some(start) = foot.checked_sub(length) else { return };
    let Ok(mut header) = serde_json::from_slice::<serde_json::Value>(&bytes[start..foot]) else { return };
    for kind in ["films", "rows"] {
        for section in header.get_mut(kind).and_then(|s| s.as_array_mut()).into_iter().flatten() {
            let place = |name: &str| section[name].as_u64().map(|n| n as usize);
            let of = place("start").zip(place("length"));
            let Some(body) = of.and_then(|(a, n)| bytes.get(a..a.checked_add(n)?)) else { continue };
            section["crc"] = crc(body).into();
        }
    }
    let json = serde_json::to_vec(&header).unwrap();
    bytes.truncate(start);
    bytes.extend_from_slice(&json);
    bytes.extend_from_slice(&(json.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&crc(&json).to_le_bytes());
    bytes.extend_from_slice(END);
}

/// The CRC of a PNG chunk, and of a state.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { (c >> 1) ^ 0xedb8_8320 } else { c >> 1 })
    })
}
