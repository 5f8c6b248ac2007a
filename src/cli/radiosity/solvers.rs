//! `--solver`: all ways to solve (I − T) L = E, step by step.

use super::super::progress::{Progress, stop_flag};
use super::super::{Ending, Failure, paragraphs, say};
use super::{Laboratory, NAMES, Radiosity, SolverName};
use fredholm::operator::matrix::{LinearOperator, Rows};
use fredholm::report::solvers::{self, Extrapolated};
use fredholm::report::write_atomically;
use fredholm::solver::Neumann;
use fredholm::solver::study::{History, Limits, System};
use fredholm::terms::TermFilm;
use fredholm::worlds::Observer;
use fredholm::worlds::discrete::MatrixError;
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// Good enough, and too many.
const ERROR: f64 = 1e-12;
const APPLICATIONS: f64 = 2000.0;

/// Solves, writes and prints.
pub fn run(args: &Radiosity, name: SolverName) -> Result<Ending, Failure> {
    let Some(lab) = Laboratory::new(&args.run, "solvers")? else { return Ok(Ending::Interrupted) };
    let channel = lab.channel(args.channel);
    let radiosity = &lab.matrix.radiosity;
    let operator = radiosity.operator(channel);
    let system = System::new(&operator, radiosity.emission(channel)).map_err(|_| MatrixError::Singular)?;
    let stopped = || stop_flag().load(Ordering::Relaxed);
    let limits = Limits { error: ERROR, applications: APPLICATIONS, stopped: &stopped };
    let progress = Progress::new(args.run.quiet, |_: &TermFilm| {});
    let solvers = name.solvers();
    progress.begin(&format!("solvers, {} patches", lab.patches()), solvers.len() as u64);
    let mut histories: Vec<History> = vec![];
    for solver in solvers {
        let history = system.history(solver, limits);
        progress.advance(1);
        if !history.points.is_empty() {
            histories.push(history);
        }
    }
    progress.finish();
    let files = write(args, &lab, &histories, channel)?;
    let [low, high] = [system.ends.smallest, system.ends.largest];
    let series = extrapolations(&system);
    let mut record = record(args, &lab, channel, [low, high], solvers::machine(&histories));
    record["extrapolations"] = solvers::machine_extrapolations(&series);
    write_atomically(&lab.folder.join("solvers.json"), serde_json::to_string_pretty(&record)?.as_bytes())?;
    if args.run.json {
        say(&serde_json::to_string_pretty(&record)?)?;
    } else {
        let sees_itself = (0..operator.len()).any(|i| operator.entry(i, i) > 0.0);
        let mut head = format!(
            "{}\n{} patches, {} channel: eigenvalues {low:.5} to {high:.5}\n\
             products with T, then seconds, until ‖x − L‖/‖L‖ in the weight A/ρ is below 1e-3, 1e-6, 1e-10\n\
             LU counts as n/3 products; Chebyshev and SOR spend {} on the spectrum first",
            lab.opened.command,
            lab.patches(),
            NAMES[channel],
            system.ends.steps,
        );
        if !sees_itself {
            head += "\nno patch sees itself, so Jacobi is the Neumann series here";
        }
        let table = solvers::table(&histories);
        let extrapolated = format!(
            "the series itself, Σ Aᵢ xᵢ/A of the first terms: error ×noise gain,\n\
             the latter if the terms had independent errors of equal relative size\n{}",
            solvers::extrapolations(&series)
        );
        let written = format!("written to {}:\n{}", lab.folder.display(), files.join(", "));
        say(&paragraphs(&[head, table, extrapolated, written]))?;
    }
    Ok(if stopped() { Ending::Interrupted } else { Ending::Ok })
}

/// What extrapolation makes of the first terms: their means over all patches.
fn extrapolations(system: &System<'_>) -> Vec<Extrapolated> {
    const TERMS: [usize; 5] = [3, 5, 7, 9, 13];
    let t = system.operator;
    let ones = vec![1.0; t.len()];
    let mean = |x: &[f64]| t.inner(&ones, x) / t.inner(&ones, &ones);
    let terms: Vec<f64> = Neumann::new(t, system.emission.clone()).take(TERMS[4]).map(|x| mean(&x)).collect();
    TERMS.map(|n| Extrapolated::new(&terms[..n], mean(&system.light), system.ends.largest)).into()
}

fn record(args: &Radiosity, lab: &Laboratory, channel: usize, ends: [f64; 2], solvers: Value) -> Value {
    json!({
        "command": lab.opened.command,
        "scene": lab.opened.description.name,
        "scene_hash": lab.opened.hash.clone(),
        "seed": args.run.seed,
        "threads": rayon::current_num_threads(),
        "patches": lab.patches(),
        "channel": NAMES[channel],
        "eigenvalues": { "smallest": ends[0], "largest": ends[1] },
        "solvers": solvers,
    })
}

/// Writes the figure, the steps and the summary; returns the names of the files.
fn write(args: &Radiosity, lab: &Laboratory, histories: &[History], channel: usize) -> Result<Vec<String>, Failure> {
    let scene = &lab.opened.description.name;
    let title = format!("Solvers of (I − T) L = E: {scene}, {} patches, {}", lab.patches(), NAMES[channel]);
    let mut files = vec!["solvers.json".to_string(), "summary.json".into()];
    if histories.iter().any(|h| h.points.len() > 1) {
        let radius = lab.matrix.spectral[channel].radius;
        solvers::draw(histories, radius, &title, &lab.caption(&args.run))?.write(&lab.folder, "solvers")?;
        files.extend(["solvers.png", "solvers.svg"].map(String::from));
    }
    if let Some(name) = &args.history {
        write_atomically(&lab.folder.join(name), solvers::csv(histories).as_bytes())?;
        files.push(name.clone());
    }
    lab.sign(&args.run, &files)?;
    Ok(files)
}
