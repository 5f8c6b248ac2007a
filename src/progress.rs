//! Progress reports and cancellation: one value, [`Progress`], that every long computation receives.
//!
//! ```text
//! begin("form factors", n)    advance(1) … advance(1)    film(…) after every pass    stopped()?
//! ```
//!
//! A computation receives a [`Progress`], reports its work to it, and asks it whether to stop. The caller chooses the
//! listener: none ([`Progress::NONE`]), a progress bar on a terminal, or a test. The progress value never changes a result,
//! except that it can end the work early.
//!
//! | what | place |
//! |---|---|
//! | receiver of the progress reports | [`Listener`] |
//! | request to stop | [`Progress::stopped`] |
//! | work limited by time instead of units | [`Clock`] |

use crate::terms::TermFilm;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Receiver of progress reports. Its methods may be called from any thread.
pub trait Listener: Sync {
    /// A phase named `_what` begins; it consists of `_units` units of work.
    fn begin(&self, _what: &str, _units: u64) {}
    /// Another `_units` units of work are done.
    fn advance(&self, _units: u64) {}
    /// Receives the film (the accumulated samples of all pixels) after a complete pass.
    fn film(&self, _film: &TermFilm) {}
}

/// A listener for progress reports and a flag that stops the work; both are optional.
///
/// ```
/// use fredholm::progress::Progress;
/// use std::sync::atomic::{AtomicBool, Ordering};
///
/// let flag = AtomicBool::new(false);
/// let progress = Progress::NONE.stopped_by(&flag);
/// assert!(!progress.stopped());
/// flag.store(true, Ordering::Relaxed);
/// assert!(progress.stopped() && !Progress::NONE.stopped());
/// ```
#[derive(Clone, Copy, Default)]
pub struct Progress<'a> {
    listener: Option<&'a dyn Listener>,
    stop: Option<&'a AtomicBool>,
    /// Prefix for the names of phases.
    name: Option<&'a str>,
    clock: Option<&'a Clock>,
}

impl<'a> Progress<'a> {
    /// No listener and no stop flag.
    pub const NONE: Progress<'static> = Progress { listener: None, stop: None, name: None, clock: None };

    /// Sends the reports to `listener`.
    pub fn to(listener: &'a dyn Listener) -> Self {
        Self { listener: Some(listener), ..Self::default() }
    }

    /// The same progress with a stop flag: the work ends early once `flag` is true.
    #[must_use]
    pub fn stopped_by(self, flag: &'a AtomicBool) -> Self {
        Self { stop: Some(flag), ..self }
    }

    /// The same progress with `name` in front of every phase name, as in `name: what`. Use it if several computations run
    /// one after the other.
    #[must_use]
    pub fn named(self, name: &'a str) -> Self {
        Self { name: Some(name), ..self }
    }

    /// The same progress without a listener. Use it for small parts of a computation that reports its own progress.
    #[must_use]
    pub fn silent(self) -> Self {
        Self { listener: None, ..self }
    }

    /// The same progress for work that ends after a given time: progress is then counted in milliseconds.
    #[must_use]
    pub fn by_clock(self, clock: &'a Clock) -> Self {
        Self { clock: Some(clock), ..self }
    }

    /// Reports that a phase begins: `what` is its name, `units` its number of units of work.
    pub fn begin(&self, what: &str, units: u64) {
        let Some(listener) = self.listener else { return };
        match self.name {
            Some(name) => listener.begin(&format!("{name}: {what}"), units),
            None => listener.begin(what, units),
        }
    }

    /// Reports that `units` more units are done. With a clock, the milliseconds passed since the last report are sent
    /// instead.
    pub fn advance(&self, units: u64) {
        if let Some(listener) = self.listener {
            listener.advance(self.clock.map_or(units, Clock::passed));
        }
    }

    /// Sends the film to the listener after a complete pass.
    pub fn film(&self, film: &TermFilm) {
        if let Some(listener) = self.listener {
            listener.film(film);
        }
    }

    /// The flag that ends the work, if there is one.
    pub fn stop_flag(&self) -> Option<&'a AtomicBool> {
        self.stop
    }

    /// Returns true if the work should end now.
    pub fn stopped(&self) -> bool {
        self.stop.is_some_and(|flag| flag.load(Relaxed))
    }
}

/// A clock for work with a time limit.
#[derive(Debug)]
pub struct Clock {
    /// The time limit.
    pub time: Duration,
    since: Instant,
    /// Milliseconds already reported.
    told: AtomicU64,
}

impl Clock {
    /// Starts a clock now, with the time limit `time`.
    pub fn start(time: Duration) -> Self {
        Self { time, since: Instant::now(), told: AtomicU64::new(0) }
    }

    /// Milliseconds since the previous call.
    fn passed(&self) -> u64 {
        let now = self.since.elapsed().as_millis() as u64;
        now.saturating_sub(self.told.fetch_max(now, Relaxed))
    }
}
