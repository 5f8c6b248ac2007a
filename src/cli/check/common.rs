//! Arguments of every check.

use crate::cli::base::Failure;
use crate::cli::open::Opened;
use crate::cli::options::{Shared, WHAT, size};
use crate::cli::session::Session;
use clap::Args;
use fredholm::engine::known::resort::with_last_resort;
use fredholm::scene::Scene;

/// Arguments of every check.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Seed: the same seed gives the same bits
    ///
    /// The number of threads does not matter; the number of samples must be the same, too.
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = WHAT)]
    pub seed: u64,
    /// Image size in pixels [default: small]
    ///
    /// By default the scene's shape with few pixels.
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = WHAT)]
    pub size: Option<[u32; 2]>,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

impl Common {
    /// Loads the scene, with at most `most` pixels a side unless a size is given.
    pub fn load(&self, session: &mut Session, name: &str, most: u32) -> Result<Opened, Failure> {
        let mut opened = session.open(name, &self.shared.changes, None)?;
        let size = self.size.unwrap_or_else(|| small(opened.description.camera.size, most));
        opened.description.camera.size = size;
        session.sized(size);
        Ok(Opened { scene: with_last_resort(Scene::new(&opened.description)), ..opened })
    }
}

/// The same shape with at most `most` pixels on each side.
fn small([w, h]: [u32; 2], most: u32) -> [u32; 2] {
    let largest = w.max(h);
    if largest <= most {
        return [w, h];
    }
    [w, h].map(|side| (f64::from(side) * f64::from(most) / f64::from(largest)).round().max(1.0) as u32)
}
