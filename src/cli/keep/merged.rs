//! The films and rows of several parts, put together.

use super::{Shard, meshes, streams};
use crate::cli::base::{Failure, lock, note};
use crate::cli::output::{but_for_samples, command_of};
use fredholm::engine::passes::Keep;
use fredholm::operator::patches::Patches;
use fredholm::operator::rays::Rays;
use fredholm::report::state::{Header, State};
use fredholm::study::run::Run;
use fredholm::terms::history::History;
use fredholm::terms::{Part, TermFilm};
use std::path::PathBuf;
use std::sync::Mutex;

/// What to do about a part that is not finished.
const GO_ON: &str = "repeat the command of this part; it goes on where it was stopped";

/// All parts of a run.
pub struct Merged {
    parts: Mutex<Vec<(PathBuf, State)>>,
    /// What all of them are of.
    pub header: Header,
}

impl Merged {
    /// Opens the files. Refuses parts of different runs, parts that are missing, and parts that are given twice.
    pub fn open(files: &[PathBuf]) -> Result<Self, Failure> {
        let mut parts = vec![];
        for path in files {
            parts.push((path.clone(), State::open(path)?));
        }
        let Some((first, state)) = parts.first() else { return Err(Failure::input("no file")) };
        let header = state.header.clone();
        let of = header.part().of;
        for (path, state) in &parts[1..] {
            let other = &state.header;
            let samples = [&header, other].map(|h| h.spp.to_string());
            let counts = [&header, other].map(|h| h.part().of.to_string());
            let differs = header.difference(other).map(|(name, values)| (name, values.map(str::to_owned)));
            let differs = differs.or((samples[0] != samples[1]).then_some(("--spp", samples)));
            let differs = differs.or((counts[0] != counts[1]).then_some(("number of parts", counts)));
            let commands = [&header, other].map(|h| command_of(&h.words));
            let differs =
                differs.or((sorted(&header.words) != sorted(&other.words)).then_some(("the command", commands)));
            if let Some((name, [a, b])) = differs {
                let what = format!("these are parts of two runs: {name} is {a} in {}, {b} here", first.display());
                return Err(Failure::at(path, &what, "merge the parts of one run"));
            }
        }
        parts.sort_by_key(|(_, state)| state.header.part().index);
        let number = |s: &State| Shard(s.header.part());
        if let Some([a, b]) = parts.windows(2).find_map(|w| {
            let [a, b] = [&w[0], &w[1]];
            (a.1.header.part == b.1.header.part).then_some([a, b])
        }) {
            let what = format!("part {} is given twice, also in {}", number(&a.1), a.0.display());
            return Err(Failure::at(&b.0, &what, "give every part once"));
        }
        let missing: Vec<String> = (0..of)
            .filter(|i| !parts.iter().any(|(_, s)| s.header.part().index == *i))
            .map(|index| Shard(Part { index, of }).to_string())
            .collect();
        if !missing.is_empty() {
            let (some, more) = missing.split_at(missing.len().min(8));
            let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
            let what = format!("parts are missing: {}{more}", some.join(", "));
            return Err(Failure::Input(format!("error: {what}\nhelp: render them, and give the files of all parts")));
        }
        Ok(Self { parts: Mutex::new(parts), header })
    }

    /// Refuses parts that are not finished or damaged, and a scene that is another one now.
    pub fn check(&self, run: &Run, now: &Header) -> Result<(), Failure> {
        if let Some((name, [parts, now])) = self.header.difference(now) {
            let what = format!("{name}: {parts} in the parts, {now} now");
            return Err(Failure::Input(format!(
                "error: {what}\nhelp: merge where the parts were rendered, with the same scene"
            )));
        }
        let meshes = meshes(run);
        for (path, state) in lock(&self.parts).iter_mut() {
            for stream in streams(run) {
                let samples = state.header.film(&stream).map_or(0, |f| f.samples[0]);
                if samples < self.header.spp {
                    let part = Shard(state.header.part());
                    let what =
                        format!("part {part} is not finished: {stream} has {samples} of {} samples", self.header.spp);
                    return Err(Failure::at(path, &what, GO_ON));
                }
            }
            for mesh in &meshes {
                if state.header.rows(mesh).is_none() {
                    let part = Shard(state.header.part());
                    let what = format!("part {part} is not finished: {mesh} are missing");
                    return Err(Failure::at(path, &what, GO_ON));
                }
            }
            if !meshes.is_empty() {
                state.check()?;
            }
        }
        // what is damaged or cannot be put together is an error here, and not rendered later
        streams(run).iter().try_for_each(|stream| self.film(stream).map(drop))
    }

    fn rows_of(&self, mesh: &str, patches: &Patches, per_row: usize) -> Result<Option<Rays>, Failure> {
        let mut all = Rays::empty(patches, per_row);
        for (_, state) in lock(&self.parts).iter_mut() {
            let Some(rows) = state.rows(mesh, patches.len(), all.per_row)? else { return Ok(None) };
            all.take(&rows);
        }
        Ok(Some(all))
    }

    fn film(&self, stream: &str) -> Result<Option<(TermFilm, History)>, Failure> {
        let mut parts = lock(&self.parts);
        let (mut all, mut histories) = (None::<TermFilm>, vec![]);
        for (path, state) in parts.iter_mut() {
            let part = state.header.part();
            let Some(shape) = state.header.film(stream).map(|f| f.shape()) else { return Ok(None) };
            let Some((film, history)) = state.film(stream, shape)? else { return Ok(None) };
            match &mut all {
                None => all = Some(film),
                Some(all) if all.shape == film.shape => all.take(part, &film),
                Some(_) => {
                    return Err(Failure::at(path, "the parts have films of different shapes", "render them again"));
                }
            }
            histories.push((part, history));
        }
        let Some(film) = all else { return Ok(None) };
        let each: Vec<_> = histories.iter().map(|(part, history)| (*part, history)).collect();
        let history = History::together(&each, film.shape, film.is_shared());
        let history = history.ok_or_else(|| Failure::input("the parts have different passes; render them again"))?;
        Ok(Some((film, history)))
    }
}

impl Keep for Merged {
    fn part(&self) -> Part {
        Part::WHOLE
    }
    fn left(&self, stream: &str) -> Option<(TermFilm, History)> {
        // the parts were checked a moment ago
        self.film(stream).unwrap_or_else(|_| {
            note(&format!("warning: the parts of {stream} cannot be read any more; it is rendered here"));
            None
        })
    }
    fn due(&self) -> bool {
        false
    }
    fn keep(&self, _: &str, _: &TermFilm, _: &History, _: bool) {}
    fn rows(&self, mesh: &str, patches: &Patches, per_row: usize) -> Option<Rays> {
        self.rows_of(mesh, patches, per_row).unwrap_or_else(|_| {
            note(&format!("warning: the parts of {mesh} cannot be read any more; they are traced here"));
            None
        })
    }
}

/// True if two commands differ in their numbers of samples and the order of their words only.
pub fn same_command(a: &[String], b: &[String]) -> bool {
    let [a, b] = [a, b].map(but_for_samples);
    sorted(&a) == sorted(&b)
}

fn sorted(words: &[String]) -> Vec<&String> {
    let mut words: Vec<_> = words.iter().collect();
    words.sort();
    words
}
