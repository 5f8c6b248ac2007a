//! What a process knows about itself, and the files that its children read.

use crate::cli::base::Failure;
use fredholm::study::growth::{Growth, Room, Subject};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

/// CPU seconds of all threads of this process so far.
#[cfg(unix)]
pub fn cpu_seconds() -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let now = clock_gettime(ClockId::ProcessCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Wall-clock seconds since the first call: the CPU time is not known here.
#[cfg(not(unix))]
pub fn cpu_seconds() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// The largest memory that this process has had, bytes. Only Linux tells. (`getrusage` counts what the parent had before it
/// started this process.)
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

/// OBJ files in a temporary folder, which is removed in the end.
pub struct Meshes(PathBuf);

impl Meshes {
    /// Writes all of them.
    pub fn write(growth: &Growth) -> Result<Self, Failure> {
        let folder = std::env::temp_dir().join(format!("fredholm-growth-{}", std::process::id()));
        std::fs::create_dir_all(&folder)?;
        let all = Self(folder);
        std::fs::write(all.0.join("room.mtl"), Room::materials())?;
        let counted = growth.points.iter().filter(|p| p.subject == Subject::Triangles);
        for room in counted.filter_map(|p| Room::of(p.size)) {
            let mut out = BufWriter::new(File::create(all.file(room.triangles()))?);
            room.write("room.mtl", &mut out)?;
            out.flush()?;
        }
        Ok(all)
    }

    /// The file of the mesh with so many triangles.
    pub fn file(&self, triangles: u64) -> PathBuf {
        self.0.join(format!("room-{triangles}.obj"))
    }
}

impl Drop for Meshes {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
