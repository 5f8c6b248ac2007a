//! Files are written completely or not at all.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fs, io, io::Write};

use super::ReportError;

/// Writes `bytes` to a temporary name in the same folder and renames it to `path`, so that an interrupted run leaves
/// the old file or the new one, never half of one.
///
/// # Errors
/// If the folder is missing or not writable, or the disk is full. No temporary file stays behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    write_atomically_by(path, |mut file| file.write_all(bytes))
}

/// The same for a file that is written in pieces.
///
/// # Errors
/// As of [`write_atomically`], and those of `contents`.
pub(super) fn write_atomically_by(
    path: &Path,
    contents: impl FnOnce(fs::File) -> io::Result<()>,
) -> Result<(), ReportError> {
    const HELP: &str = "check that the folder exists and can be written, or choose another with -o";
    let Some(name) = path.file_name() else {
        return Err(ReportError::new(path, "this path has no file name", "name a file, not a folder"));
    };
    let temporary = path.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
    write(&temporary, contents, path).map_err(|e| {
        // Report the first error. The rest of the temporary file is useless.
        let _ = fs::remove_file(&temporary);
        ReportError::new(path, e, HELP)
    })
}

/// Writes the temporary file and renames it.
fn write(temporary: &Path, contents: impl FnOnce(fs::File) -> io::Result<()>, path: &Path) -> io::Result<()> {
    unfinished().insert(temporary.to_path_buf());
    let written = fs::File::create(temporary).and_then(contents).and_then(|()| fs::rename(temporary, path));
    unfinished().remove(temporary);
    written
}

/// Opens a file to be read.
pub(super) fn open(path: &Path) -> Result<fs::File, ReportError> {
    is_file(path)?;
    fs::File::open(path).map_err(|e| missing(path, e))
}

fn is_file(path: &Path) -> Result<(), ReportError> {
    if path.exists() && !path.is_file() {
        return Err(ReportError::new(path, "this is not a file", "give a file, not a folder, a pipe or a device"));
    }
    Ok(())
}

fn missing(path: &Path, e: io::Error) -> ReportError {
    ReportError::new(path, e, "check the name, or render the scene first")
}

/// The temporary files that exist at this moment.
fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    static FILES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all files that are half-written, for a program that ends at once. While the returned value is held, no other file is
/// begun.
pub fn abandon_files() -> impl Sized {
    let files = unfinished();
    for file in files.iter() {
        let _ = fs::remove_file(file);
    }
    files
}

/// True for the name of a temporary file of [`write_atomically`], of any process.
///
/// ```
/// use fredholm::report::is_temporary;
/// assert!(is_temporary(".terms.exr.4711.tmp"));
/// assert!(!is_temporary("terms.exr") && !is_temporary(".notes.tmp"));
/// ```
pub fn is_temporary(name: &str) -> bool {
    let rest = name.strip_prefix('.').and_then(|n| n.strip_suffix(".tmp"));
    let process = rest.and_then(|n| n.rsplit_once('.')).filter(|(name, _)| !name.is_empty()).map(|n| n.1);
    process.is_some_and(|p| !p.is_empty() && p.bytes().all(|b| b.is_ascii_digit()))
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, ReportError> {
    is_file(path)?;
    fs::read(path).map_err(|e| missing(path, e))
}
