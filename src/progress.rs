//! How far long work has come, and whether it is to go on: one value for everything that takes long.
//!
//! ```text
//! begin("form factors", n)    advance(1) … advance(1)    film(…) after every pass    stopped()?
//! ```
//!
//! A computation is given a [`Progress`], tells it what it does, and asks it whether to stop. The caller chooses
//! who listens: nobody ([`Progress::NONE`]), a bar on a terminal, a test. No result depends on it, except that it may be cut short.
//!
//! | what | place |
//! |---|---|
//! | what is told to whom | [`Listener`] |
//! | whether to stop | [`Progress::stopped`] |
//! | work that is measured by the clock | [`Clock`] |

use crate::terms::TermFilm;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Who is told. Methods are called from any thread.
pub trait Listener: Sync {
    /// A stretch of work begins, with so many units to do.
    fn begin(&self, _what: &str, _units: u64) {}
    /// Some units are done.
    fn advance(&self, _units: u64) {}
    /// The film after a complete pass.
    fn film(&self, _film: &TermFilm) {}
}

/// Who listens, and the flag that stops the work.
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
    /// Stands before what begins.
    name: Option<&'a str>,
    clock: Option<&'a Clock>,
}

impl<'a> Progress<'a> {
    /// Nobody listens, and nothing stops.
    pub const NONE: Progress<'static> = Progress { listener: None, stop: None, name: None, clock: None };

    /// Somebody listens.
    pub fn to(listener: &'a dyn Listener) -> Self {
        Self { listener: Some(listener), ..Self::default() }
    }

    /// Work ends early once the flag is set.
    #[must_use]
    pub fn stopped_by(self, flag: &'a AtomicBool) -> Self {
        Self { stop: Some(flag), ..self }
    }

    /// The same for one of several things that are done in turn: `name: what`.
    #[must_use]
    pub fn named(self, name: &'a str) -> Self {
        Self { name: Some(name), ..self }
    }

    /// The same, told to nobody: for small parts of something that is itself told.
    #[must_use]
    pub fn silent(self) -> Self {
        Self { listener: None, ..self }
    }

    /// The same for work that ends after a given time: its progress is counted in milliseconds.
    #[must_use]
    pub fn by_clock(self, clock: &'a Clock) -> Self {
        Self { clock: Some(clock), ..self }
    }

    /// A stretch of work begins, with so many units to do.
    pub fn begin(&self, what: &str, units: u64) {
        let Some(listener) = self.listener else { return };
        match self.name {
            Some(name) => listener.begin(&format!("{name}: {what}"), units),
            None => listener.begin(what, units),
        }
    }

    /// Some units are done.
    pub fn advance(&self, units: u64) {
        if let Some(listener) = self.listener {
            listener.advance(self.clock.map_or(units, Clock::passed));
        }
    }

    /// The film after a complete pass.
    pub fn film(&self, film: &TermFilm) {
        if let Some(listener) = self.listener {
            listener.film(film);
        }
    }

    /// Whether the work is to end now.
    pub fn stopped(&self) -> bool {
        self.stop.is_some_and(|flag| flag.load(Relaxed))
    }
}

/// A clock for work that may take so long.
#[derive(Debug)]
pub struct Clock {
    /// How long.
    pub time: Duration,
    since: Instant,
    /// Milliseconds that have been told.
    told: AtomicU64,
}

impl Clock {
    /// Starts now.
    pub fn start(time: Duration) -> Self {
        Self { time, since: Instant::now(), told: AtomicU64::new(0) }
    }

    /// Milliseconds since it was last asked.
    fn passed(&self) -> u64 {
        let now = self.since.elapsed().as_millis() as u64;
        now.saturating_sub(self.told.fetch_max(now, Relaxed))
    }
}
