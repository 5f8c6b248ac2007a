//! Files are written completely or not at all.

use std::{fs, path::Path};

use super::ReportError;

/// Writes `bytes` to a temporary name in the same folder and renames it to `path`, so that an interrupted run leaves
/// the old file or the new one, never half of one.
///
/// # Errors
/// If the folder is missing or not writable, or the disk is full. No temporary file stays behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    const HELP: &str = "check that the folder exists and can be written, or choose another with -o";
    let Some(name) = path.file_name() else {
        return Err(ReportError::new(path, "this path has no file name", "name a file, not a folder"));
    };
    let temporary = path.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
    fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path)).map_err(|e| {
        // Report the first error. The rest of the temporary file is useless.
        let _ = fs::remove_file(&temporary);
        ReportError::new(path, e, HELP)
    })
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, ReportError> {
    fs::read(path).map_err(|e| ReportError::new(path, e, "check the name, or render the scene first"))
}
