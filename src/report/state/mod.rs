//! The state of a run in a file: the films of its random streams and rows of stored rays, so that a later run goes on from them, or
//! puts parts together.
//!
//! ```text
//! file = "fredholm state 1\n" · section · … · section · header (JSON) · length of the header · its CRC · "state end"
//! section = film, or rows
//! ```
//!
//! | field of the header | meaning |
//! |---|---|
//! | `program` | version of the program; another version may sample other paths |
//! | `words` | the command line, without options that do not change a sample |
//! | `facts` | name and value of everything that the films depend on, in the order in which differences are reported |
//! | `spp` | samples per pixel that were asked for |
//! | `part` | number of this part, from 0, and the number of parts |
//! | `films` | per film: `stream` (name of its random numbers), `size`, `slots`, `replicates`, `shared` (paths add to other pixels), `samples` (smallest and largest number of a pixel), `start`, `length` (bytes), `crc` |
//! | `rows` | per mesh: `mesh` (its name), `patches`, `per_row` (rays), `start`, `length`, `crc` |
//!
//! Numbers are little-endian, and sums are written as they are, so that going on from a file gives the bits of a run that never
//! ended. Every section has a checksum: a damaged file is refused, never used. The file is written completely under another name, then
//! renamed. `film.rs` and `rows.rs` describe the bytes of a section.
//!
//! Reading needs no more memory than a film of the expected shape, or the rows of the expected mesh.
//!
//! ```
//! use fredholm::report::state::{self, Header, State};
//! use fredholm::terms::{Shape, TermFilm, history::History};
//!
//! let folder = tempfile::tempdir()?;
//! let (path, header) = (folder.path().join("state.fsh"), Header { part: [0, 1], ..Header::default() });
//! let shape = Shape { size: [8, 8], slots: 10, replicates: 16 };
//! let film = TermFilm::new(shape);
//! state::write_film(&path, &header, ("prefix", &film, &History::default()))?;
//!
//! let mut kept = State::open(&path)?;
//! let (again, _) = kept.film("prefix", shape)?.unwrap();
//! assert_eq!(again.samples, film.samples);
//! assert!(kept.film("path", shape)?.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bytes;
mod film;
mod rows;

use crate::operator::rays::Rows;
use crate::report::{ReportError, files};
use crate::terms::history::History;
use crate::terms::{Part, Shape, TermFilm};
use bytes::{Hashed, copy};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The first bytes of a file.
const BEGIN: &[u8] = b"fredholm state 1\n";
/// The last bytes of a file.
const END: &[u8] = b"state end";
/// Length of what follows the header: its length, its checksum, the end.
const FOOT: u64 = 8 + 4 + END.len() as u64;
/// What to do with a file that cannot be used.
const AGAIN: &str = "choose another file, or render this one again from the start, with --force";
/// Longest header that is read.
const LONGEST: u64 = 1 << 20;

/// What a state is of.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Header {
    pub program: String,
    pub words: Vec<String>,
    pub facts: Vec<(String, String)>,
    pub spp: u32,
    pub part: [u32; 2],
    pub films: Vec<Entry>,
    #[serde(default)]
    pub rows: Vec<RowsEntry>,
}

/// Where a section is in a file, and its checksum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Place {
    pub start: u64,
    pub length: u64,
    pub crc: u32,
}

/// Rows of stored rays in a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct RowsEntry {
    pub mesh: String,
    pub patches: usize,
    pub per_row: usize,
    #[serde(flatten)]
    pub place: Place,
}

/// A film in a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Entry {
    pub stream: String,
    pub size: [u32; 2],
    pub slots: usize,
    pub replicates: usize,
    pub shared: bool,
    pub samples: [u32; 2],
    #[serde(flatten)]
    pub place: Place,
}

impl Header {
    /// The part of the films that the file holds.
    pub fn part(&self) -> Part {
        Part { index: self.part[0], of: self.part[1] }
    }

    /// The film of that random stream.
    pub fn film(&self, stream: &str) -> Option<&Entry> {
        self.films.iter().find(|f| f.stream == stream)
    }

    /// The rows on that mesh.
    pub fn rows(&self, mesh: &str) -> Option<&RowsEntry> {
        self.rows.iter().find(|r| r.mesh == mesh)
    }

    /// The places of all sections.
    fn places(&self) -> impl Iterator<Item = Place> {
        self.films.iter().map(|f| f.place).chain(self.rows.iter().map(|r| r.place))
    }

    /// Sets a fact.
    pub fn fact(&mut self, name: &str, value: impl ToString) {
        self.facts.push((name.into(), value.to_string()));
    }

    /// The first fact in which two states differ: its name, and its value in each.
    pub fn difference<'a>(&'a self, other: &'a Self) -> Option<(&'a str, [&'a str; 2])> {
        if self.program != other.program {
            return Some(("version of fredholm", [&self.program, &other.program]));
        }
        let of = |h: &'a Self, name: &str| h.facts.iter().find(|f| f.0 == name).map_or("none", |f| f.1.as_str());
        let names = self.facts.iter().chain(&other.facts).map(|f| f.0.as_str());
        names.map(|name| (name, [of(self, name), of(other, name)])).find(|(_, [a, b])| a != b)
    }
}

impl Entry {
    /// Shape of the film.
    pub fn shape(&self) -> Shape {
        Shape { size: self.size, slots: self.slots, replicates: self.replicates }
    }
}

/// Writes a state: the given film, and the other sections of `header`, which are copied from the file that is replaced. Returns the
/// header as written.
///
/// # Errors
/// If the file cannot be written. The old file is then as it was.
pub fn write_film(
    path: &Path,
    header: &Header,
    (stream, film, history): (&str, &TermFilm, &History),
) -> Result<Header, ReportError> {
    let mut next = header.clone();
    next.films.retain(|f| f.stream != stream);
    let (part, Shape { size, slots, replicates }) = (header.part(), film.shape);
    let (samples, shared) = (film.samples_of(part), film.is_shared());
    let samples = [samples.start, samples.end];
    let entry = |place| Entry { stream: stream.into(), size, slots, replicates, shared, samples, place };
    replace(path, next, |out| film::write(film, history, part, out), |next, place| next.films.push(entry(place)))
}

/// The same for rows of stored rays on a mesh.
///
/// # Errors
/// As of [`write_film`].
pub fn write_rows(path: &Path, header: &Header, (mesh, rows): (&str, &Rows)) -> Result<Header, ReportError> {
    let mut next = header.clone();
    next.rows.retain(|r| r.mesh != mesh);
    let entry = |place| RowsEntry { mesh: mesh.into(), patches: rows.n, per_row: rows.per_row, place };
    replace(path, next, |out| rows::write(rows, out), |next, place| next.rows.push(entry(place)))
}

/// Writes a state again with another header, which names sections of the old file.
///
/// # Errors
/// As of [`write_film`].
pub fn write_header(path: &Path, header: &Header) -> Result<Header, ReportError> {
    replace(path, header.clone(), |_| Ok(()), |_, _| {})
}

/// A file in which a section is written.
type Section<'a> = Hashed<&'a mut BufWriter<File>>;

/// Replaces a file by one with the sections of `next`, copied, and a new one, which `enter` adds to the header.
fn replace(
    path: &Path,
    mut next: Header,
    section: impl FnOnce(&mut Section<'_>) -> io::Result<()>,
    enter: impl FnOnce(&mut Header, Place),
) -> Result<Header, ReportError> {
    let old = File::open(path).map(BufReader::new);
    files::write_atomically_by(path, |file| {
        let mut out = BufWriter::with_capacity(1 << 20, file);
        out.write_all(BEGIN)?;
        let mut at = BEGIN.len() as u64;
        match old {
            Ok(mut old) => {
                let films = next.films.iter_mut().map(|f| &mut f.place);
                for place in films.chain(next.rows.iter_mut().map(|r| &mut r.place)) {
                    let mut body = Hashed::new(&mut out);
                    copy(&mut old, place.start..place.start + place.length, &mut body)?;
                    if body.done() != (place.length, place.crc) {
                        return Err(bytes::wrong("another run has written this file"));
                    }
                    place.start = at;
                    at += place.length;
                }
            }
            // somebody has removed the file: its other sections are lost, but not this one
            Err(_) => {
                next.films.clear();
                next.rows.clear();
            }
        }
        let mut body = Hashed::new(&mut out);
        section(&mut body)?;
        let (length, crc) = body.done();
        enter(&mut next, Place { start: at, length, crc });
        let json = serde_json::to_vec(&next)?;
        out.write_all(&json)?;
        out.write_all(&(json.len() as u64).to_le_bytes())?;
        out.write_all(&crc32fast::hash(&json).to_le_bytes())?;
        out.write_all(END)?;
        // the bytes are on the disk before the file gets its name
        out.into_inner()?.sync_data()
    })?;
    Ok(next)
}

/// A file that holds a state.
#[derive(Debug)]
pub struct State {
    path: PathBuf,
    file: BufReader<File>,
    /// What it is of.
    pub header: Header,
}

impl State {
    /// Opens a file and reads its header.
    ///
    /// # Errors
    /// If the file cannot be read, is no state, or is damaged.
    pub fn open(path: &Path) -> Result<Self, ReportError> {
        let broken = |e: io::Error| ReportError::new(path, why(&e), AGAIN);
        let mut file = BufReader::new(files::open(path)?);
        let header = header(&mut file).map_err(broken)?;
        Ok(Self { path: path.into(), file, header })
    }

    /// Checks the checksums of all sections.
    ///
    /// # Errors
    /// If the file is damaged.
    pub fn check(&mut self) -> Result<(), ReportError> {
        for place in self.header.places() {
            let mut body = Hashed::new(io::sink());
            let copied = copy(&mut self.file, place.start..place.start + place.length, &mut body);
            let right = copied.is_ok() && body.done() == (place.length, place.crc);
            if !right {
                let what = "the file is damaged: a checksum is wrong";
                return Err(ReportError::new(&self.path, what, AGAIN));
            }
        }
        Ok(())
    }

    /// Reads the film of a stream. None if there is no such film.
    ///
    /// # Errors
    /// If the film has another shape than expected, or is damaged.
    pub fn film(&mut self, stream: &str, shape: Shape) -> Result<Option<(TermFilm, History)>, ReportError> {
        let Some(entry) = self.header.film(stream) else { return Ok(None) };
        let found = film_of(&mut self.file, entry, self.header.part(), shape);
        found.map(Some).map_err(|e| ReportError::new(&self.path, why(&e), AGAIN))
    }

    /// Reads the rows on a mesh of `patches` patches, with `per_row` rays each. None if there are no such rows.
    ///
    /// # Errors
    /// If the rows are of another mesh, or damaged.
    pub fn rows(&mut self, mesh: &str, patches: usize, per_row: usize) -> Result<Option<Rows>, ReportError> {
        let Some(entry) = self.header.rows(mesh) else { return Ok(None) };
        let found = rows_of(&mut self.file, entry, self.header.part(), [patches, per_row]);
        found.map(Some).map_err(|e| ReportError::new(&self.path, why(&e), AGAIN))
    }
}

fn why(e: &io::Error) -> String {
    match e.kind() {
        io::ErrorKind::UnexpectedEof => "the file ends too early".into(),
        _ => e.to_string(),
    }
}

/// Reads the header of a state.
///
/// # Errors
/// If the bytes are no state.
pub fn header(file: &mut (impl Read + Seek)) -> io::Result<Header> {
    let mut begin = [0; BEGIN.len()];
    let short = file.read_exact(&mut begin).is_err();
    if short || begin != BEGIN {
        return Err(bytes::wrong("this is not a state or a part of a run, or one of another version"));
    }
    let end = file.seek(SeekFrom::End(0))?;
    let damaged = || bytes::wrong("the file is damaged: its end is missing");
    let foot = end.checked_sub(FOOT).ok_or_else(damaged)?;
    file.seek(SeekFrom::Start(foot))?;
    let length = bytes::u64(file)?;
    let crc = bytes::u32(file)?;
    let mut last = [0; END.len()];
    file.read_exact(&mut last)?;
    let start = foot.checked_sub(length).filter(|_| last == END && length <= LONGEST).ok_or_else(damaged)?;
    file.seek(SeekFrom::Start(start))?;
    let mut json = vec![0; length as usize];
    file.read_exact(&mut json)?;
    let header: Header =
        serde_json::from_slice(&json).ok().filter(|_| crc32fast::hash(&json) == crc).ok_or_else(damaged)?;
    let inside = |p: Place| p.start >= BEGIN.len() as u64 && p.start.checked_add(p.length).is_some_and(|e| e <= start);
    let [index, of] = header.part;
    if index < of && header.places().all(inside) { Ok(header) } else { Err(damaged()) }
}

/// Reads one film.
///
/// # Errors
/// If it has another shape than expected, or is damaged.
pub fn film_of(
    file: &mut (impl Read + Seek),
    entry: &Entry,
    part: Part,
    shape: Shape,
) -> io::Result<(TermFilm, History)> {
    if entry.shape() != shape {
        return Err(bytes::wrong("its film has another size, number of terms or number of replicates"));
    }
    section(file, entry.place, |body| film::read(body, shape, entry.shared, part))
}

/// Reads the rows on a mesh of `[patches, rays per row]`.
///
/// # Errors
/// If they are of another mesh, or damaged.
pub fn rows_of(file: &mut (impl Read + Seek), entry: &RowsEntry, part: Part, shape: [usize; 2]) -> io::Result<Rows> {
    if [entry.patches, entry.per_row] != shape {
        return Err(bytes::wrong("its rows have another number of patches or rays"));
    }
    section(file, entry.place, |body| rows::read(body, part, entry.patches, entry.per_row))
}

/// Reads a section, and compares its checksum.
fn section<F: Read + Seek, T>(
    file: &mut F,
    place: Place,
    read: impl FnOnce(&mut Hashed<io::Take<&mut F>>) -> io::Result<T>,
) -> io::Result<T> {
    file.seek(SeekFrom::Start(place.start))?;
    let mut body = Hashed::new(file.take(place.length));
    let found = read(&mut body);
    match (found, body.done()) {
        (Ok(found), (length, crc)) if length == place.length && crc == place.crc => Ok(found),
        (Err(e), _) if e.kind() != io::ErrorKind::InvalidData && e.kind() != io::ErrorKind::UnexpectedEof => Err(e),
        _ => Err(bytes::wrong("the file is damaged: a checksum is wrong")),
    }
}
