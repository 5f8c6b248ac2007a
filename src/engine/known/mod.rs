//! Examines a scene before it is solved: light that will be missing, results that will be doubtful, paths that would never
//! end.
//!
//! | question | place |
//! |---|---|
//! | which visible surfaces coincide and differ | [`coplanar::undecided`] |
//! | which paths a sampling method can never find | [`unsampled::unsampled`] |
//! | which paths it finds too rarely | [`doubts::doubts`] |
//! | whether the variance of long paths is finite | [`growth`](mod@growth) |
//! | whether light can leave the scene | [`trap::trapped`] |
//! | where paths end that nothing else ends | [`resort::with_last_resort`] |
//! | how long paths are | [`length`](mod@length) |

pub mod coplanar;
pub mod doubts;
pub mod growth;
pub mod length;
pub mod resort;
pub mod trap;
pub mod unsampled;
