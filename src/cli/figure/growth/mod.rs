//! `fredholm figure growth`: how time and memory grow. Every run is a process of its own; this one starts them, one after the
//! other, and draws what they have measured.

mod process;

use super::args::Figure;
use crate::cli::base::{Ending, Failure, names, print_json, usage};
use crate::cli::session::Session;
use fredholm::report::figures::growth as report;
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::study::growth::{Growth, Point, Run, Subject, measure};
use process::Meshes;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Rounds through all sizes; `--quick` takes two.
const ROUNDS: u32 = 5;

/// Measures, and draws the figure.
pub fn run(args: &Figure, id: &str, mut session: Session) -> Result<Ending, Failure> {
    session.about("several", "");
    session.make_folder(id)?;
    let threads = std::thread::available_parallelism()?.get();
    let mut growth = Growth::new(args.quick, threads);
    let meshes = Meshes::write(&growth)?;
    let rounds = if args.quick { 2 } else { ROUNDS };
    session.progress().begin("processes", u64::from(rounds) * growth.points.len() as u64);
    let visits = (0..rounds).flat_map(|round| growth.order(args.seed, round));
    for i in visits.collect::<Vec<_>>() {
        if session.stopped() {
            break;
        }
        let Some(run) = child(&growth.points[i], args.seed, &meshes, &session)? else { break };
        growth.points[i].runs.push(run);
        session.progress().advance(1);
    }
    drop(meshes);
    if growth.points.iter().all(|p| p.runs.is_empty()) {
        return Ok(session.nothing_to_save(""));
    }
    let files = ["growth.svg", "growth.png", "growth-memory.svg", "growth-memory.png", "growth.csv", "growth-fits.csv"];
    report::draw(&growth, &session.caption())?.write(&session.folder, "growth")?;
    report::draw_memory(&growth, &session.caption())?.write(&session.folder, "growth-memory")?;
    write_atomically(&session.folder.join("growth.csv"), report::csv(&growth).as_bytes())?;
    write_atomically(&session.folder.join("growth-fits.csv"), report::fits_csv(&growth).as_bytes())?;
    let record = Summary { threads, files: [&names(files)[..], &names(["summary.json"])].concat(), ..session.record() };
    session.sign(&record)?;
    session.show(&record, || {
        let tables = [report::table(&growth).to_string(), report::memory_table(&growth).to_string()];
        session.text(&wrapped(&report::answer(&growth)), &tables, &[], &record.files)
    })?;
    Ok(session.ending(false))
}

/// One run, in a process of its own. None if it was ended because this process is to end.
fn child(point: &Point, seed: u64, meshes: &Meshes, session: &Session) -> Result<Option<Run>, Failure> {
    let mesh = meshes.file(point.size);
    let ended = Command::new(std::env::current_exe()?)
        .args(["figure", "growth", "--measure"])
        .arg(format!("{}:{}:{}", point.subject.id(), point.size, mesh.display()))
        .args(["--seed", &seed.to_string()])
        .stdin(Stdio::null())
        .stderr(Stdio::piped())
        .output()?;
    if ended.status.success() {
        return Ok(Some(serde_json::from_slice(&ended.stdout)?));
    }
    // Ctrl-C reaches the child as well, and perhaps a little earlier
    std::thread::sleep(Duration::from_millis(100));
    if session.stopped() {
        return Ok(None);
    }
    session.clear();
    let what = format!("{} with n = {} could not be measured ({})", point.subject.id(), point.size, ended.status);
    let why = String::from_utf8_lossy(&ended.stderr);
    Err(Failure::Input(format!("error: {what}\n{}\nhelp: try it with more free memory", why.trim())))
}

/// What a child does: measures the point `SUBJECT:SIZE:MESH`, and prints the run as JSON.
pub fn measured(args: &Figure, point: &str) -> Result<Ending, Failure> {
    let mut words = point.splitn(3, ':');
    let mut next = || words.next().unwrap_or_default();
    let id = next();
    let subject = Subject::ALL.into_iter().find(|s| s.id() == id);
    let (size, mesh) = (next().parse::<u64>().ok().filter(|n| *n > 0), next());
    let (Some(subject), Some(size)) = (subject, size) else {
        return Err(usage(
            &format!("`{point}` is no SUBJECT:SIZE:MESH"),
            "leave --measure out: it is used by the program",
        ));
    };
    let seconds = measure(subject, size, args.seed, Path::new(mesh), &process::cpu_seconds)?;
    print_json(&Run { seconds, peak: process::peak_bytes() })?;
    Ok(Ending::Ok)
}
