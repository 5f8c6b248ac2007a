//! What is known of a scene before it is solved: what is missing, what is in doubt, what would never end.
//!
//! | question | place |
//! |---|---|
//! | which surfaces coincide and differ, and are seen | [`coplanar::undecided`] |
//! | which paths a way of sampling can never find | [`unsampled::unsampled`] |
//! | which it finds too rarely | [`doubts::doubts`] |
//! | whether the variance of long paths is finite | [`growth`](mod@growth) |
//! | whether light gets out | [`trap::trapped`] |
//! | how paths end that nothing else ends | [`resort::with_last_resort`] |
//! | how long they are | [`length`](mod@length) |

pub mod coplanar;
pub mod doubts;
pub mod growth;
pub mod length;
pub mod resort;
pub mod trap;
pub mod unsampled;
