//! What T is: one symbol, three realisations.

pub mod matrix_walk;
pub mod scene_transport;
pub mod transport;

pub use matrix_walk::MatrixWalk;
pub use scene_transport::SceneTransport;
pub use transport::{Samples, Sensor, Step, Transport, Wave};
