//! Keeps the films and rows of a run in a file, and gives the films back.

use super::{Interval, meshes, streams};
use crate::cli::base::{Failure, lock, note};
use crate::cli::signals;
use fredholm::engine::passes::Keep;
use fredholm::estimator::render::ends_a_group;
use fredholm::operator::rays::Rows;
use fredholm::report::ReportError;
use fredholm::report::state::{self, Entry, Header, State};
use fredholm::study::run::Run;
use fredholm::terms::history::History;
use fredholm::terms::{Part, TermFilm};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Name of the file in an output folder.
pub const NAME: &str = "state.fsh";

/// A state is written again after at least this many times the time that writing it takes.
const RARELY: u32 = 60;
/// A film is kept at its end if the run has taken this part of the time between two states.
const LONG: u32 = 4;

/// The file of a run, or of a part of one.
pub struct Keeper {
    path: PathBuf,
    part: Part,
    /// True for a part of a run: its file is its result, and is always written.
    is_result: bool,
    every: Option<Duration>,
    started: Instant,
    /// Milliseconds after the start at which the next state is due.
    next: AtomicU64,
    /// The state of an earlier run.
    left: Mutex<Option<State>>,
    /// What the file says, or will say.
    header: Mutex<Header>,
    /// True if the file is there, from this run or from the one that it goes on with.
    kept: AtomicBool,
    failed: AtomicBool,
}

impl Keeper {
    /// A keeper that begins with an empty film.
    pub fn new(path: PathBuf, header: Header, interval: Interval) -> Self {
        let every = if let Interval::Every(time) = interval { Some(time) } else { None };
        let next = every.map_or(u64::MAX, |t| t.as_millis() as u64);
        Self {
            path,
            part: header.part(),
            is_result: false,
            every,
            started: Instant::now(),
            next: AtomicU64::new(next),
            left: Mutex::new(None),
            header: Mutex::new(header),
            kept: AtomicBool::new(false),
            failed: AtomicBool::new(false),
        }
    }

    /// The same for a part of a run, whose result is the file.
    pub fn of_part(path: PathBuf, header: Header, interval: Interval) -> Self {
        Self { is_result: true, ..Self::new(path, header, interval) }
    }

    /// Goes on from a state, or refuses it and names what is different.
    pub fn go_on(&mut self, mut state: State, run: &Run) -> Result<(), Failure> {
        let mut header = lock(&self.header);
        if let Some((name, [kept, now])) = state.header.difference(&header) {
            let what = format!("{name}: {kept} in the state, {now} now");
            return Err(Failure::at(&self.path, &what, "repeat the earlier command; only --spp may grow"));
        }
        let known = streams(run);
        for entry in state.header.films.iter().filter(|f| known.contains(&f.stream)) {
            fits(entry, run).map_err(|(what, help)| Failure::at(&self.path, &what, &help))?;
        }
        state.check()?;
        // films and rows that this run does not need stay in the file
        header.films = state.header.films.clone();
        header.rows = state.header.rows.clone();
        drop(header);
        (self.left, self.kept) = (Mutex::new(Some(state)), true.into());
        Ok(())
    }

    /// True if the file holds a state of this run.
    pub fn kept(&self) -> bool {
        self.kept.load(Relaxed)
    }

    /// True if the file holds all samples and rows.
    pub fn finished(&self, run: &Run) -> bool {
        let header = lock(&self.header);
        let traced = meshes(run).iter().all(|mesh| header.rows(mesh).is_some());
        traced && streams(run).iter().all(|stream| header.film(stream).is_some_and(|f| f.samples[0] == header.spp))
    }

    /// How far the state has come, in words.
    pub fn stand(&self, run: &Run) -> String {
        let header = lock(&self.header);
        let one = |stream: &String| match header.film(stream).map_or([0; 2], |f| f.samples) {
            [a, b] if a == b => format!("{stream} {a}"),
            [a, b] => format!("{stream} {a} to {b}"),
        };
        let films: Vec<String> = streams(run).iter().map(one).collect();
        let of = if run.settings.time.is_some() { String::new() } else { format!(" of {}", header.spp) };
        let films = (!films.is_empty()).then(|| format!("{}{of} samples per pixel", films.join(", ")));
        let (rows, lacks): (Vec<_>, Vec<_>) = meshes(run).into_iter().partition(|mesh| header.rows(mesh).is_some());
        let all: Vec<String> = films.into_iter().chain(rows).collect();
        let lacks = if lacks.is_empty() { String::new() } else { format!("; still to trace: {}", lacks.join("; ")) };
        format!("going on with {}{lacks}", if all.is_empty() { "nothing".into() } else { all.join("; ") })
    }

    /// Writes the file again with the header of this run, and the films and rows that it has.
    pub fn renew(&self) -> Result<(), Failure> {
        let mut header = lock(&self.header);
        *header = state::write_header(&self.path, &header)?;
        Ok(())
    }

    /// Removes the state of an earlier run which is not that of this one.
    pub fn tidy(&self) {
        if !self.kept() {
            let _ = std::fs::remove_file(&self.path);
        }
    }

    fn write(&self, section: impl FnOnce(&Path, &Header) -> Result<Header, ReportError>) {
        let (begun, mut header) = (Instant::now(), lock(&self.header));
        match section(&self.path, &header) {
            Ok(written) => {
                *header = written;
                self.kept.store(true, Relaxed);
            }
            // the run itself goes on
            Err(e) if !self.failed.swap(true, Relaxed) => note(&format!("warning: the state is not kept\n{e}")),
            Err(_) => {}
        }
        let wait = self.every.map_or(Duration::MAX, |every| every.max(begun.elapsed() * RARELY));
        let next = self.started.elapsed().saturating_add(wait).as_millis();
        self.next.store(u64::try_from(next).unwrap_or(u64::MAX), Relaxed);
    }
}

impl Keep for Keeper {
    fn part(&self) -> Part {
        self.part
    }

    fn left(&self, stream: &str) -> Option<(TermFilm, History)> {
        let mut left = lock(&self.left);
        let state = left.as_mut()?;
        let shape = state.header.film(stream)?.shape();
        // its checksums were right a moment ago
        state.film(stream, shape).unwrap_or_else(|e| {
            note(&format!("warning: {stream} starts at its first sample\n{e}"));
            None
        })
    }

    fn due(&self) -> bool {
        // a run that was stopped keeps its state at its end, which is near
        let stopped = signals::stop_flag().load(Relaxed);
        !stopped && self.started.elapsed().as_millis() as u64 >= self.next.load(Relaxed)
    }

    fn keep(&self, stream: &str, film: &TermFilm, history: &History, ended: bool) {
        let stopped = signals::stop_flag().load(Relaxed);
        let wanted = match ended {
            // the end follows at once
            false => !stopped,
            true => {
                let long = self.every.is_some_and(|every| self.started.elapsed() > every / LONG);
                self.is_result || self.every.is_some() && (stopped || long || self.kept())
            }
        };
        if wanted {
            self.write(|path, header| state::write_film(path, header, (stream, film, history)));
        }
    }

    fn has_rows(&self, mesh: &str) -> bool {
        lock(&self.header).rows(mesh).is_some()
    }

    fn keep_rows(&self, mesh: &str, rows: &Rows) {
        self.write(|path, header| state::write_rows(path, header, (mesh, rows)));
    }
}

/// Refuses a film with which the run cannot go on to the same bits: what is wrong, and what to do.
fn fits(entry: &Entry, run: &Run) -> Result<(), (String, String)> {
    let (settings, [_, most], [w, h]) = (&run.settings, entry.samples, run.scene.camera.size);
    if most > settings.spp {
        let what = format!("the state has {most} samples per pixel already, and --spp asks for {}", settings.spp);
        return Err((what, format!("use --spp {most} or more")));
    }
    let replicates = settings.replicates_of(settings.spp) as usize;
    if entry.replicates != replicates {
        let what = format!("the state has {} replicates, and this run has {replicates}", entry.replicates);
        return Err((what, format!("only a run that began with --spp {replicates} or more can grow; start anew")));
    }
    // within a pass, the smaller number is where the pass before it ended
    if most < settings.spp && !ends_a_group(most, w * h, entry.replicates, entry.shared) {
        let what = format!("after {most} samples per pixel, a run cannot grow to the bits of a longer one");
        let [a, b, c] = [1, 2, 4].map(|n| n * replicates);
        return Err((what, format!("start anew; runs can always grow from {a}, {b}, {c}, … samples")));
    }
    Ok(())
}

/// The state in an output folder.
pub fn kept_in(folder: &Path) -> Option<Result<State, Failure>> {
    let path = folder.join(NAME);
    path.exists().then(|| State::open(&path).map_err(Failure::from))
}
