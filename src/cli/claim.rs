//! One run at a time in a folder: while it works, a run holds a locked file there with its command.
//!
//! ```text
//! claim → work → release        killed: the file stays, but nobody holds it
//! ```
//!
//! The operating system frees the lock when the process ends, however it ends. So a file without a lock belongs to a run that was
//! killed, and the same command may use its folder again. Where a file system knows no locks, the file is only a note.

use fredholm::report::is_temporary;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Name of the file.
pub const NAME: &str = ".fredholm.run";

/// A folder that this process writes into.
#[derive(Debug)]
pub struct Claim {
    path: PathBuf,
    /// Holds the lock until it is closed.
    _file: File,
}

/// Why a folder cannot be claimed.
#[derive(Debug)]
pub enum Denied {
    /// Another process is writing into it.
    Taken,
    /// The file cannot be made.
    Failed(std::io::Error),
}

impl Claim {
    /// Claims a folder, which must exist, and removes what a killed run left half-written there.
    pub fn folder(folder: &Path, command: &str) -> Result<Self, Denied> {
        let claim = Self::by(folder.join(NAME), command)?;
        remove_unfinished(folder);
        Ok(claim)
    }

    /// Claims one file, by another one beside it.
    pub fn file(path: &Path, command: &str) -> Result<Self, Denied> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Self::by(path.with_file_name(format!(".{name}.run")), command)
    }

    fn by(path: PathBuf, command: &str) -> Result<Self, Denied> {
        // the file may be removed by its owner between opening and locking it; then the lock is of no use
        for _ in 0..100 {
            let mut file = open(&path).map_err(Denied::Failed)?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Err(Denied::Taken),
                // a file system without locks
                Err(TryLockError::Error(_)) | Ok(()) => {}
            }
            let mine = format!("{command}\n{}\n", std::process::id());
            let written = file.set_len(0).and_then(|()| file.rewind()).and_then(|()| file.write_all(mine.as_bytes()));
            written.and_then(|()| file.flush()).map_err(Denied::Failed)?;
            // where a locked file cannot be read by its name (Windows), it cannot be removed either
            if std::fs::read_to_string(&path).map_or_else(|e| e.kind() != std::io::ErrorKind::NotFound, |t| t == mine) {
                return Ok(Self { path, _file: file });
            }
        }
        Err(Denied::Taken)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

fn open(path: &Path) -> std::io::Result<File> {
    OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)
}

/// True if a run is at work in this folder.
pub fn is_taken(folder: &Path) -> bool {
    File::open(folder.join(NAME)).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// True if a run is at work in this folder, and does not end at once. A run that was killed a moment ago may need some time until
/// its memory is free.
pub fn stays_taken(folder: &Path) -> bool {
    const POLLS: u32 = 20;
    for _ in 0..POLLS {
        if !is_taken(folder) {
            return false;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    true
}

/// The command of a run that was killed in this folder. None if there is none, or if a run is at work.
pub fn left_behind(folder: &Path) -> Option<String> {
    let mut file = File::open(folder.join(NAME)).ok()?;
    if matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)) {
        return None;
    }
    let mut text = String::new();
    file.read_to_string(&mut text).ok()?;
    text.lines().next().map(str::to_owned)
}

/// Removes temporary files: no other run is at work here.
fn remove_unfinished(folder: &Path) {
    let files = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    for file in files.filter(|f| is_temporary(&f.file_name().to_string_lossy())) {
        let _ = std::fs::remove_file(file.path());
    }
}

/// True for the file of a claim, or a file that a killed run left half-written: no result of anybody.
pub fn is_trace(name: &str) -> bool {
    name == NAME || is_temporary(name)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_claimed_once_and_a_released_one_again() {
        let folder = tempfile::tempdir().unwrap();
        let claim = Claim::folder(folder.path(), "fredholm series a.toml").unwrap();
        assert!(matches!(Claim::folder(folder.path(), "fredholm series a.toml"), Err(Denied::Taken)));
        assert_eq!(left_behind(folder.path()), None, "its owner is at work");
        drop(claim);
        assert!(!folder.path().join(NAME).exists());
        assert!(Claim::folder(folder.path(), "fredholm").is_ok());
    }

    #[test]
    fn a_killed_run_leaves_its_command_and_its_half_written_files_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let [half, picture] = [".terms.exr.123.tmp", "terms.png"].map(|n| folder.path().join(n));
        std::fs::write(folder.path().join(NAME), "fredholm series a.toml\n123\n").unwrap();
        for file in [&half, &picture] {
            std::fs::write(file, "").unwrap();
        }
        assert_eq!(left_behind(folder.path()).as_deref(), Some("fredholm series a.toml"));
        let _claim = Claim::folder(folder.path(), "fredholm series a.toml").unwrap();
        assert!(!half.exists() && picture.exists());
    }
}
