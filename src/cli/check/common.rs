//! Options that every check has, and the scene they load.

use crate::cli::base::Failure;
use crate::cli::open::Opened;
use crate::cli::options::{Shared, size};
use crate::cli::session::Session;
use clap::Args;
use fredholm::engine::known::resort::with_last_resort;
use fredholm::scene::Scene;

/// Options that every check has.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Seed: same seed and same number of samples, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Image size in pixels [default: the scene's shape, small]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

impl Common {
    /// Loads the scene; without `--size` the image has at most `most` pixels on each side.
    pub fn load(&self, session: &mut Session, name: &str, most: u32) -> Result<Opened, Failure> {
        let mut opened = session.open(name, &self.shared.changes, None)?;
        let size = self.size.unwrap_or_else(|| small(opened.description.camera.size, most));
        opened.description.camera.size = size;
        session.sized(size);
        Ok(Opened { scene: with_last_resort(Scene::new(&opened.description)), ..opened })
    }
}

/// A size of the same aspect ratio with at most `most` pixels on each side.
fn small([w, h]: [u32; 2], most: u32) -> [u32; 2] {
    let largest = w.max(h);
    if largest <= most {
        return [w, h];
    }
    [w, h].map(|side| (f64::from(side) * f64::from(most) / f64::from(largest)).round().max(1.0) as u32)
}
