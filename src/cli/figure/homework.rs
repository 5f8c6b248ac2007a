//! `fredholm figure cs184-part4`: the pictures that a well-known homework asks for, with the decay and a verdict.

use super::args::Figure;
use crate::cli::base::{Ending, Failure};
use crate::cli::options::Changes;
use crate::cli::session::Session;
use crate::cli::{preflight, verdict};
use fredholm::engine::Settings;
use fredholm::report::figures::{decay, homework as report};
use fredholm::report::image::contact_sheet::single;
use fredholm::report::page::gallery::{self, Exhibit};
use fredholm::report::plot::{Curve, Look};
use fredholm::report::text::grid::Grid;
use fredholm::report::text::number::{average, plus_minus, significant};
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::write_atomically;
use fredholm::stats::{Criterion, Outcome, TermMeans};
use fredholm::study::homework::{Homework, LAST, homework};

/// Makes every picture.
pub fn run(args: &Figure, id: &str, mut session: Session) -> Result<Ending, Failure> {
    let (size, spp) = if args.quick { ([96, 72], 64) } else { ([480, 360], 1024) };
    let size = args.size.unwrap_or(size);
    let whole_box = Changes { set: vec![format!("camera.fov={}", fov(size))], emit: vec![], lambertian: false };
    let opened = session.open("cornell", &whole_box, Some(size))?;
    let settings = Settings { spp, seed: args.seed, max_bounces: LAST, ..Settings::default() };
    preflight::fits_in_memory(&settings, opened.description.camera.size)?;
    session.make_folder(id)?;
    let Some(done) = homework(&opened.scene, spp, args.seed, session.progress()) else {
        return Ok(session.nothing_to_save(""));
    };
    let comparison = done.verdict();
    let mut record = Summary {
        spp: spp.into(),
        max_bounces: LAST,
        verdicts: summary::verdicts("without − with roulette", &comparison),
        ..session.record()
    };
    record.files = write(&session, &done, [record.width, record.height])?;
    session.sign(&record)?;
    session.show(&record, || {
        let answer = verdict::sentence("The bounces without and with roulette", &comparison, &Criterion::default());
        session.text(
            &wrapped(&answer),
            &[terms(&done).to_string(), noise(&done).to_string()],
            &[],
            &["index.html".into(), format!("{} files", record.files.len())],
        )
    })?;
    Ok(session.ending(comparison.outcome == Outcome::Differs))
}

/// The horizontal field of view, in degrees, with which a picture of this size shows the whole box: as high as it is in the
/// square picture of the scene file.
fn fov([w, h]: [u32; 2]) -> f64 {
    const SQUARE: f64 = 39.3077;
    let wider = (f64::from(w) / f64::from(h)).max(1.0);
    2.0 * (wider * (0.5 * SQUARE).to_radians().tan()).atan().to_degrees()
}

/// Writes pictures, sheets, plot, CSV and page; returns the names of the files.
fn write(session: &Session, done: &Homework, [w, h]: [usize; 2]) -> Result<Vec<String>, Failure> {
    let (mut files, mut exhibits): (Vec<String>, Vec<Exhibit>) = (vec![], vec![]);
    let exhibit = |id: &str, topic: &str, caption: &str, picture: &str| Exhibit {
        id: id.into(),
        topic: topic.into(),
        caption: caption.into(),
        picture: picture.into(),
        command: session.command().into(),
    };
    for sheet in report::sheets(done, [w, h], &session.caption())? {
        let name = format!("{}.png", sheet.name);
        sheet.picture.write(&session.folder.join(&name))?;
        exhibits.push(exhibit(sheet.name, sheet.heading, sheet.text, &name));
        files.push(name);
    }
    for one in report::singles(done) {
        let (developed, _) = single(&one.name, w, h, &one.pixels, Some(one.gain))?;
        let name = format!("{}.png", one.name);
        developed.picture.write(&session.folder.join(&name))?;
        files.push(name);
    }
    let curve = |label: &str, of, look| Curve { label: label.into(), points: decay::norms(&TermMeans::from(of)), look };
    let figure = decay::Decay {
        title: "The mean of each bounce in the picture".into(),
        surface: vec![
            curve("no roulette", &done.terms.replicates, Look::SINGLE),
            curve("with roulette", &done.roulette.replicates, Look::PREFIX),
        ],
        ..decay::Decay::default()
    };
    decay::draw(&figure, &session.caption())?.write(&session.folder, "decay")?;
    exhibits.push(exhibit(
        "decay",
        "How the bounces decay",
        "The mean of each bounce on a logarithmic axis. After the first bounces, each one is the same factor darker.",
        "decay.svg",
    ));
    write_atomically(&session.folder.join("homework.csv"), report::csv(done).as_bytes())?;
    let sentence =
        "Every picture in full size lies beside this page: bounce-m.png, accumulated-m.png, roulette-m.png, spp-n.png.";
    gallery::write(&session.folder.join("index.html"), "Global illumination, bounce by bounce", sentence, &exhibits)?;
    files.extend(["decay.svg", "decay.png", "homework.csv", "index.html", "summary.json"].map(String::from));
    Ok(files)
}

fn terms(done: &Homework) -> Grid {
    let mut grid =
        Grid::new("The mean of each bounce, ± half a 95 % interval.", ["bounce", "no roulette", "with roulette"]);
    for k in 0..=LAST {
        let cell = |of: &fredholm::engine::by_rays::Sampled| {
            let (value, half) = average(&of.series.image().terms[k]);
            plus_minus(value, half, 1)
        };
        grid.push([k.to_string(), cell(&done.terms), cell(&done.roulette)]);
    }
    grid
}

fn noise(done: &Homework) -> Grid {
    let mut grid = Grid::new("The root-mean-square error of a pixel, bounces 0 to 5.", ["spp", "RMSE"]);
    for s in &done.grown {
        let error = if s.squared_error < 0.0 { "≤ noise".into() } else { significant(s.squared_error.sqrt(), 2) };
        grid.push([s.spp.to_string(), error]);
    }
    grid
}
