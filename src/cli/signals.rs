//! Signals that end the program: Ctrl-C (SIGINT), SIGTERM, SIGHUP. The first one saves what exists, the second one ends at once.
//!
//! | signal | sent by | exit code |
//! |---|---|---|
//! | SIGINT | Ctrl-C | 130 |
//! | SIGTERM | `kill`, a batch system | 143 |
//! | SIGHUP | a terminal that closes; ignored under `nohup` | 129 |

use super::base::note;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);
/// The signal that came first; 0 before.
static FIRST: AtomicI32 = AtomicI32::new(0);

/// The flag that the first signal sets.
pub fn stop_flag() -> &'static AtomicBool {
    static LISTENING: OnceLock<()> = OnceLock::new();
    // without a listener a signal ends the program at once, without saving
    LISTENING.get_or_init(listen);
    &STOP
}

/// Exit code of a program that a signal has ended.
pub fn exit_code() -> u8 {
    128 + u8::try_from(FIRST.load(Ordering::SeqCst)).ok().filter(|s| *s != 0).unwrap_or(2)
}

/// A signal has come.
fn receive(signal: i32) {
    if FIRST.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst).is_err() {
        // no file is begun any more, and those that are half-written are gone
        let _held = fredholm::report::abandon_files();
        std::process::exit(128 + signal);
    }
    STOP.store(true, Ordering::SeqCst);
    note("\ninterrupted: saving what exists (Ctrl-C again: stop without saving)");
}

#[cfg(unix)]
fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let wanted = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|s| *s != SIGHUP || !hangup_is_ignored());
    if let Ok(mut signals) = signal_hook::iterator::Signals::new(wanted) {
        let listener = std::thread::Builder::new().name("signals".into());
        let _ = listener.spawn(move || signals.forever().for_each(receive));
    }
}

/// True under `nohup`, which makes the program ignore SIGHUP so that it outlives its terminal.
#[cfg(unix)]
fn hangup_is_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).map(str::trim);
    // bit n − 1 belongs to signal n
    ignored.and_then(|mask| u64::from_str_radix(mask, 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

#[cfg(not(unix))]
fn listen() {
    const SIGINT: i32 = 2;
    let _ = ctrlc::set_handler(|| receive(SIGINT));
}
