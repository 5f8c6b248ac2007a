//! `radiosity --solver`: runs the solvers of (I − T) L = E and compares their work.
//!
//! | | T as a dense matrix | T as stored rays |
//! |---|---|---|
//! | equation | (I − T) L = E | (I − T) u = D with u = L − E; D is the direct light by pairs of points |
//! | reference | LU | GMRES to rounding |

use super::args::Radiosity;
use super::laboratory::Laboratory;
use crate::cli::base::{Ending, Failure, usage};
use crate::cli::preflight;
use fredholm::engine::by_matrix::MatrixError;
use fredholm::engine::discretisation::{Factors, Form, Stored};
use fredholm::operator::matrix::Transposed;
use fredholm::report::figures::solvers::{self, Extrapolated};
use fredholm::report::text::prose::{listed, wrapped};
use fredholm::report::write_atomically;
use fredholm::solver::Neumann;
use fredholm::solver::comparison::{History, Limits, Reference, Solver, Solvers, System};
use fredholm::terms::Channel;
use serde_json::{Value, json};

/// A solver stops at this relative error …
const ERROR: f64 = 1e-12;
/// … or after this many products with T.
const APPLICATIONS: f64 = 2000.0;

/// Runs the chosen solvers, writes the files and prints the text.
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

/// How the form factors are stored; a usage error if the solver cannot work on them.
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

/// The solvers that were asked for, on one channel of one mesh.
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
        let series = extrapolations(system, self.radius());
        let record = self.record(system, &histories, &series);
        write_atomically(&session.folder.join("solvers.json"), serde_json::to_string_pretty(&record)?.as_bytes())?;
        session.show(&record, || {
            let details =
                [self.head(system, informed(&histories)), full_table(&histories), extrapolated(&series, self.dense())];
            session.text(&self.answer(&histories), &[self.table(system, &histories)], &details, &files)
        })?;
        Ok(session.ending(false))
    }

    /// The answer: which solver needs the fewest products with T, on which mesh.
    fn answer(&self, histories: &[History]) -> String {
        let (scene, patches, channel) = (&self.lab.opened.description.name, self.lab.patches, self.channel);
        let mesh = format!(
            "The mesh of {scene} has {patches} patches{}; in the {channel} channel the spectral radius of T is {:.4}.",
            self.held(),
            self.radius()
        );
        wrapped(&format!("{}\n{mesh}", fewest(self.equation(), histories)))
    }

    /// The small table, with a sentence above it and the reasons for rows that look odd below it.
    fn table<T: Transposed>(&self, system: &System<'_, T>, histories: &[History]) -> String {
        let x = self.unknown();
        let mut above = format!(
            "Products with T until the relative error ‖x − {x}‖/‖{x}‖ is below 1e-3, 1e-6 and 1e-10, seconds until it is \
             below 1e-10, and the error of the last step. {x} is "
        );
        above += match system.reference {
            Reference::Lu { .. } => "the solution by LU, whose work is that of n/3 products with T for n patches.",
            Reference::Gmres { .. } => "the solution by GMRES to rounding.",
        };
        let mut below = vec![];
        if informed(histories) {
            let spent = system.ends().applications;
            below.push(format!("The rows of Chebyshev and SOR include {spent} products for the ends of the spectrum."));
        }
        if histories.iter().any(|h| h.solver == Solver::Jacobi) && sees_itself_nowhere(system) {
            below.push("No patch sees itself, so Jacobi is the Neumann series here.".into());
        }
        if !self.dense() {
            below.push(
                "Stored rays have no CG, because T is self-adjoint only within its noise, and no LU, because there is no \
                 matrix."
                    .into(),
            );
        }
        format!("{}\n{}{}", wrapped(&above), solvers::table(histories), wrapped(&below.join("\n")))
    }

    /// Details: the command, the equation, the reference and the spectrum.
    fn head<T: Transposed>(&self, system: &System<'_, T>, informed: bool) -> String {
        let mut head = format!(
            "equation: {} in the {} channel; r(T) = {:.5}; the error is measured in the weight A/ρ",
            self.equation(),
            self.channel,
            self.radius()
        );
        if let Reference::Gmres { applications } = system.reference {
            head += &format!(
                "\nreference: GMRES to rounding, {applications} products, residual {:.1e} of ‖D‖",
                system.residual()
            );
        }
        if informed {
            let (ends, part) = (system.ends(), if self.dense() { "" } else { " of the symmetric part" });
            head += &format!(
                "\nspectrum{part}: {:.5} to {:.5}, found in {} products",
                ends.found.smallest, ends.found.largest, ends.applications
            );
        }
        format!("{}\n{}", self.lab.session.command(), wrapped(&head))
    }

    fn radius(&self) -> f64 {
        self.lab.matrix.spectral[self.channel as usize].radius
    }

    /// The equation that is solved.
    fn equation(&self) -> &'static str {
        if self.dense() { "(I − T) L = E" } else { "(I − T) u = D, u = L − E," }
    }

    /// Returns true if T is a dense matrix.
    fn dense(&self) -> bool {
        self.lab.matrix.sampling.is_none()
    }

    /// ` of 256 rays` if T is stored rays, nothing if it is a matrix.
    fn held(&self) -> String {
        self.lab.matrix.sampling.map_or(String::new(), |s| format!(" of {} rays each", s.per_row))
    }

    /// The symbol of the unknown: L, or u = L − E for stored rays.
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
            "spectral_radius": self.radius(),
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
            solvers::draw(histories, self.radius(), &title, &lab.session.caption())?
                .write(&lab.session.folder, "solvers")?;
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

/// Returns true if a solver had to find the ends of the spectrum first.
fn informed(histories: &[History]) -> bool {
    histories.iter().any(|h| matches!(h.solver, Solver::Chebyshev | Solver::Sor))
}

/// Returns true if the diagonal of T is zero.
fn sees_itself_nowhere<T: Transposed>(system: &System<'_, T>) -> bool {
    let t = system.operator;
    (0..t.len()).all(|i| t.entry(i, i) == 0.0)
}

/// One sentence: the solvers that reach the smallest milestone with the fewest products, or that none does.
fn fewest(equation: &str, histories: &[History]) -> String {
    let goal = solvers::MILESTONES[2];
    let iterative: Vec<&History> = histories.iter().filter(|h| h.solver != Solver::Lu).collect();
    let work = |h: &History| h.reaches(goal).map(|p| p.applications);
    let least = iterative.iter().filter_map(|h| work(h)).fold(f64::INFINITY, f64::min);
    let best: Vec<&str> = iterative.iter().filter(|h| work(h) == Some(least)).map(|h| h.solver.name()).collect();
    if iterative.is_empty() {
        let residual = histories.first().and_then(|h| h.points.last()).map_or(f64::NAN, |p| p.residual);
        return format!("LU solves {equation} directly and leaves a residual of {residual:.1e}.");
    }
    if best.is_empty() {
        return format!("No solver solves {equation} to {goal:.0e} within {APPLICATIONS} products with T.");
    }
    let (solve, each) = if best.len() == 1 { ("solves", "") } else { ("solve", " each") };
    let among = match iterative.len() {
        1 => String::new(),
        n => format!(", the fewest of the {n} iterative solvers"),
    };
    format!("{} {solve} {equation} to {goal:.0e} in {} products with T{each}{among}.", listed(&best), number(least))
}

/// A number of products, with a decimal where there is one.
fn number(products: f64) -> String {
    if products.fract() == 0.0 { format!("{products:.0}") } else { format!("{products:.1}") }
}

/// Details: everything about every solver, with a sentence above the table.
fn full_table(histories: &[History]) -> String {
    let above = "Products with T and seconds until the error is below 1e-3, 1e-6 and 1e-10, the error of the last step, and its \
                 residual ‖E − (I − T) x‖.";
    format!("{}\n{}", wrapped(above), solvers::full_table(histories))
}

/// Details: the sum of the series extrapolated from its first terms, with a sentence above the table.
fn extrapolated(series: &[Extrapolated], dense: bool) -> String {
    let start = if dense { "E" } else { "D" };
    let above = format!(
        "The mean of the solution over all surfaces, extrapolated from the first terms of the series {start} + T{start} + …: \
         its relative error, and × the noise gain, the noise relative to that of the plain sum S_n if the terms had \
         independent errors of equal relative size."
    );
    format!("{}\n{}", wrapped(&above), solvers::extrapolations(series))
}

/// Extrapolates the means of the terms over all patches, for several numbers of terms.
fn extrapolations<T: Transposed>(system: &System<'_, T>, radius: f64) -> Vec<Extrapolated> {
    const TERMS: [usize; 5] = [3, 5, 7, 9, 13];
    let t = system.operator;
    let ones = vec![1.0; t.len()];
    let mean = |x: &[f64]| t.inner(&ones, x) / t.inner(&ones, &ones);
    let terms: Vec<f64> = Neumann::new(t, system.emission.clone()).take(TERMS[4]).map(|x| mean(&x)).collect();
    TERMS.map(|n| Extrapolated::new(&terms[..n], mean(&system.light), radius)).into()
}
