//! Progress on stderr with the estimated time left.

use super::base::{lock, note};
use super::signals::stop_flag;
use fredholm::math::names::visible;
use fredholm::progress::{Listener, Progress};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// A progress bar on a terminal; elsewhere one line per 10 % for work that takes more than two seconds.
pub struct Bar {
    quiet: bool,
    bar: Mutex<Option<ProgressBar>>,
    what: Mutex<(String, u64, Instant)>,
    done: AtomicU64,
    tenths: AtomicU64,
    preview: Box<dyn Fn(&fredholm::terms::TermFilm) + Sync + Send>,
}

impl Bar {
    /// A bar that also calls `preview` with the film after every complete pass.
    pub fn new(quiet: bool, preview: impl Fn(&fredholm::terms::TermFilm) + Sync + Send + 'static) -> Self {
        Self {
            quiet,
            bar: Mutex::new(None),
            what: Mutex::new((String::new(), 1, Instant::now())),
            done: AtomicU64::new(0),
            tenths: AtomicU64::new(0),
            preview: Box::new(preview),
        }
    }

    /// A bar without a preview.
    pub fn plain(quiet: bool) -> Self {
        Self::new(quiet, |_| ())
    }

    /// The progress value for library calls: it moves this bar, and a [signal](super::signals) stops it.
    pub fn progress(&self) -> Progress<'_> {
        Progress::to(self).stopped_by(stop_flag())
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Some(bar) = lock(&self.bar).take() {
            bar.finish_and_clear();
        }
    }
}

impl Listener for Bar {
    fn begin(&self, what: &str, units: u64) {
        self.finish();
        *lock(&self.what) = (what.to_string(), units.max(1), Instant::now());
        self.done.store(0, Ordering::Relaxed);
        self.tenths.store(0, Ordering::Relaxed);
        if !self.quiet && std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(units);
            if let Ok(style) = ProgressStyle::with_template("{msg:32} {wide_bar} {percent:>3} %  ETA {eta}") {
                bar.set_style(style);
            }
            bar.set_message(visible(what));
            bar.enable_steady_tick(Duration::from_millis(200));
            *lock(&self.bar) = Some(bar);
        }
    }

    fn advance(&self, units: u64) {
        let done = self.done.fetch_add(units, Ordering::Relaxed) + units;
        if self.quiet {
            return;
        }
        if let Some(bar) = lock(&self.bar).as_ref() {
            bar.set_position(done);
            return;
        }
        let (what, all, since) = &*lock(&self.what);
        let elapsed = since.elapsed().as_secs_f64();
        let tenth = 10 * done / all;
        if elapsed > 2.0 && tenth < 10 && self.tenths.fetch_max(tenth, Ordering::Relaxed) < tenth {
            let eta = elapsed * (*all as f64 / done as f64 - 1.0);
            note(&format!("{what}: {} %, ETA {eta:.0} s", 10 * tenth));
        }
    }

    fn film(&self, film: &fredholm::terms::TermFilm) {
        (self.preview)(film);
    }
}
