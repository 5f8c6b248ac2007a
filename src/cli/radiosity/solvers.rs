//! `--solver`: all ways to solve (I − T) L = E, step by step.
//!
//! | | a matrix | stored rays |
//! |---|---|---|
//! | solved | (I − T) L = E | (I − T) u = D, u = L − E, D the direct light by pairs of points |
//! | reference | LU | GMRES to rounding |

use super::args::Radiosity;
use super::laboratory::Laboratory;
use crate::cli::base::{Ending, Failure, paragraphs, usage};
use crate::cli::preflight;
use fredholm::engine::by_matrix::MatrixError;
use fredholm::engine::discretisation::{Factors, Form, Stored};
use fredholm::operator::matrix::Transposed;
use fredholm::report::figures::solvers::{self, Extrapolated};
use fredholm::report::write_atomically;
use fredholm::solver::Neumann;
use fredholm::solver::comparison::{History, Limits, Reference, Solver, Solvers, System};
use fredholm::terms::Channel;
use serde_json::{Value, json};

/// Good enough, and too many.
const ERROR: f64 = 1e-12;
const APPLICATIONS: f64 = 2000.0;

/// Solves, writes and prints.
pub fn run(args: &Radiosity, name: Solvers) -> Result<Ending, Failure> {
    let factors = factors(args, name)?;
    match factors {
        Factors::Dense => {
            let Some(lab) = Laboratory::new(args, "solvers")? else { return Ok(Ending::Interrupted) };
            let (study, radiosity) = (Study::new(args, &lab, name), &lab.matrix.radiosity);
            let operator = radiosity.operator(study.channel as usize);
            study.run(
                &System::new(&operator, radiosity.emission(study.channel as usize))
                    .map_err(|_| MatrixError::Singular)?,
            )
        }
        Factors::Rays(per_row) => {
            let lab = Laboratory::sampled(args, "solvers", per_row)?;
            let Some(lab) = lab else { return Ok(Ending::Interrupted) };
            let (study, Stored { patches, rays }) = (Study::new(args, &lab, name), &lab.matrix.radiosity);
            let operator = rays.operator(patches.iter().map(|p| p.reflectance[study.channel as usize]).collect());
            let direct = (0..rays.n).map(|i| rays.direct(i)[study.channel as usize]).collect();
            study.run(&System::sampled(&operator, direct).map_err(|_| MatrixError::Unsettled { residual: 1e-8 })?)
        }
    }
}

/// How form factors are held, if the solver can do with it.
fn factors(args: &Radiosity, name: Solvers) -> Result<Factors, Failure> {
    let wrong = |what: &str, help: &str| Err(usage(what, help));
    if args.mesh.factors == Some(Form::Both) {
        return wrong("solvers work on one matrix at a time", "use --factors dense or --factors rays");
    }
    let factors = preflight::factors(args.mesh.factors, args.mesh.rays, args.mesh.patches.unwrap_or(600))?;
    match (factors, name) {
        (Factors::Rays(_), Solvers::One(Solver::ConjugateGradients)) => wrong(
            "conjugate gradients need a self-adjoint T, and that of stored rays is so only within its noise",
            "use --solver gmres or chebyshev, or --factors dense",
        ),
        (Factors::Rays(_), Solvers::One(Solver::Lu)) => {
            wrong("stored rays are no matrix that LU could take apart", "use --solver gmres, or --factors dense")
        }
        _ => Ok(factors),
    }
}

/// What was asked for.
struct Study<'a, R> {
    args: &'a Radiosity,
    lab: &'a Laboratory<R>,
    channel: Channel,
    name: Solvers,
}

impl<'a, R> Study<'a, R> {
    fn new(args: &'a Radiosity, lab: &'a Laboratory<R>, name: Solvers) -> Self {
        Self { args, lab, channel: lab.channel(args.channel), name }
    }

    fn run<T: Transposed>(&self, system: &System<'_, T>) -> Result<Ending, Failure> {
        let lab = self.lab;
        let session = &lab.session;
        let progress = session.progress();
        let stopped = || progress.stopped();
        let limits = Limits { error: ERROR, applications: APPLICATIONS, stopped: &stopped };
        let possible = system.solvers();
        // the direct solution is the reference, and always there
        let wanted = |s: &Solver| self.name.include(*s) || *s == Solver::Lu;
        let solvers: Vec<Solver> = possible.into_iter().filter(wanted).collect();
        progress.begin(&format!("solvers, {} patches", lab.patches), solvers.len() as u64);
        let mut histories: Vec<History> = vec![];
        for solver in solvers {
            let history = system.history(solver, limits);
            progress.advance(1);
            if !history.points.is_empty() {
                histories.push(history);
            }
        }
        session.clear();
        let files = self.write(&histories)?;
        let series = extrapolations(system, lab.matrix.spectral[self.channel as usize].radius);
        let record = self.record(system, &histories, &series);
        write_atomically(&session.folder.join("solvers.json"), serde_json::to_string_pretty(&record)?.as_bytes())?;
        session.show(&record, || {
            let extrapolated = format!(
                "the series itself, Σ Aᵢ xᵢ/A of the first terms: error ×noise gain,\n\
                 the latter if the terms had independent errors of equal relative size\n{}",
                solvers::extrapolations(&series)
            );
            let written = format!("written to {}:\n{}", session.folder.display(), files.join(", "));
            let head = self.head(system, informed(&histories));
            paragraphs(&[head, solvers::table(&histories), extrapolated, written])
        })?;
        Ok(session.ending(false))
    }

    /// What is solved, and what the table counts.
    fn head<T: Transposed>(&self, system: &System<'_, T>, informed: bool) -> String {
        let (command, patches, channel) = (self.lab.session.command(), self.lab.patches, self.channel);
        let radius = self.lab.matrix.spectral[self.channel as usize].radius;
        let mut head = format!("{command}\n{patches} patches{}, {channel} channel: r(T) = {radius:.5}", self.held());
        if let Reference::Gmres { applications } = system.reference {
            head += &format!(
                "; (I − T) u = D for u = L − E\n\
                 held against GMRES to rounding: {applications} products, residual {:.1e} of ‖D‖; no CG, because T is\n\
                 self-adjoint only within its noise, and no LU, because there is no matrix",
                system.residual()
            );
        }
        head += &format!(
            "\nproducts with T, then seconds, until ‖x − {x}‖/‖{x}‖ in the weight A/ρ is below 1e-3, 1e-6, 1e-10",
            x = self.unknown()
        );
        if informed {
            let (ends, part) = (system.ends(), if self.dense() { "" } else { " of its symmetric part" });
            head += &format!(
                "\nChebyshev and SOR first spend {} on the spectrum{part}: {:.5} to {:.5}",
                ends.applications, ends.found.smallest, ends.found.largest
            );
        }
        if self.dense() {
            head += "\nLU counts as n/3 products";
        }
        let t = system.operator;
        if (0..t.len()).all(|i| t.entry(i, i) == 0.0) {
            head += "\nno patch sees itself, so Jacobi is the Neumann series here";
        }
        head
    }

    fn dense(&self) -> bool {
        self.lab.matrix.sampling.is_none()
    }

    /// How the rows are held, where it is not as a matrix.
    fn held(&self) -> String {
        self.lab.matrix.sampling.map_or(String::new(), |s| format!(" of {} rays", s.per_row))
    }

    /// What x tends to.
    fn unknown(&self) -> &'static str {
        if self.dense() { "L" } else { "u" }
    }

    fn record<T: Transposed>(&self, system: &System<'_, T>, histories: &[History], series: &[Extrapolated]) -> Value {
        let Self { args, lab, .. } = self;
        let reference = match system.reference {
            Reference::Lu { .. } => json!({ "solver": "LU", "residual": system.residual() }),
            Reference::Gmres { applications } => {
                json!({ "solver": "GMRES", "products": applications, "residual": system.residual() })
            }
        };
        json!({
            "command": lab.session.command(),
            "scene": lab.opened.description.name,
            "scene_hash": lab.opened.hash.clone(),
            "seed": args.frame.seed,
            "threads": rayon::current_num_threads(),
            "patches": lab.patches,
            "rays": lab.matrix.sampling.map(|s| s.per_row),
            "unknown": self.unknown(),
            "channel": self.channel.name(),
            "spectral_radius": lab.matrix.spectral[self.channel as usize].radius,
            "eigenvalues": informed(histories).then(|| {
                let ends = system.ends();
                json!({
                    "smallest": ends.found.smallest, "largest": ends.found.largest, "products": ends.applications,
                })
            }),
            "reference": reference,
            "solvers": solvers::machine(histories),
            "extrapolations": solvers::machine_extrapolations(series),
        })
    }

    /// Writes the figure, the steps and the summary; returns the names of the files.
    fn write(&self, histories: &[History]) -> Result<Vec<String>, Failure> {
        let Self { args, lab, channel, .. } = self;
        let equation = if self.dense() { "(I − T) L = E" } else { "(I − T) u = D" };
        let (scene, channel_name) = (&lab.opened.description.name, channel.name());
        let title = format!("Solvers of {equation}: {scene}, {} patches{}, {channel_name}", lab.patches, self.held());
        let mut files = vec!["solvers.json".to_string(), "summary.json".into()];
        if histories.iter().any(|h| h.points.len() > 1) {
            let radius = lab.matrix.spectral[*channel as usize].radius;
            solvers::draw(histories, radius, &title, &lab.session.caption())?.write(&lab.session.folder, "solvers")?;
            files.extend(["solvers.png", "solvers.svg"].map(String::from));
        }
        if let Some(name) = &args.history {
            write_atomically(&lab.session.folder.join(name), solvers::csv(histories).as_bytes())?;
            files.push(name.clone());
        }
        lab.sign(&files)?;
        Ok(files)
    }
}

/// Whether one of them had to know the ends of the spectrum.
fn informed(histories: &[History]) -> bool {
    histories.iter().any(|h| matches!(h.solver, Solver::Chebyshev | Solver::Sor))
}

/// What extrapolation makes of the first terms: their means over all patches.
fn extrapolations<T: Transposed>(system: &System<'_, T>, radius: f64) -> Vec<Extrapolated> {
    const TERMS: [usize; 5] = [3, 5, 7, 9, 13];
    let t = system.operator;
    let ones = vec![1.0; t.len()];
    let mean = |x: &[f64]| t.inner(&ones, x) / t.inner(&ones, &ones);
    let terms: Vec<f64> = Neumann::new(t, system.emission.clone()).take(TERMS[4]).map(|x| mean(&x)).collect();
    TERMS.map(|n| Extrapolated::new(&terms[..n], mean(&system.light), radius)).into()
}
