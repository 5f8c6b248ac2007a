//! `--modes`: the spectrum of T, what bounds it, and its modes through the camera.

use super::super::progress::Bar;
use super::super::{Ending, Failure, paragraphs, preflight, print};
use super::{Laboratory, NAMES, Radiosity};
use fredholm::engine::Settings;
use fredholm::operator::edges::{Band, essential_band};
use fredholm::operator::matrix::LinearOperator;
use fredholm::operator::modes::{Modes, norm_2, radius_bounds};
use fredholm::report::figures::modes::{self, Painted, Row, Spectrum};
use fredholm::report::write_atomically;
use fredholm::solver::Neumann;
use serde_json::json;

/// Bounces over which modes are seen to die.
const BOUNCES: usize = 12;

/// Takes T apart, writes and prints.
pub fn run(args: &Radiosity, count: usize) -> Result<Ending, Failure> {
    let run = &args.run;
    let Some(lab) = Laboratory::new(run, "modes")? else { return Ok(Ending::Interrupted) };
    let settings =
        Settings { spp: run.spp.unwrap_or(64), seed: run.seed, max_bounces: count + 1, ..Settings::default() };
    let size = lab.opened.description.camera.size;
    preflight::fits_in_memory(&settings, size)?;
    let bar = Bar::plain(run.shared.quiet);
    let progress = bar.progress();
    let stopped = || progress.stopped();

    // eigenvalues, channel by channel
    progress.begin(&format!("eigenvalues, {} patches", lab.patches()), 3);
    let (mut all, mut spectra, mut bands): (Vec<Modes>, Vec<Spectrum>, Vec<Band>) = (vec![], vec![], vec![]);
    for channel in 0..3 {
        if stopped() {
            bar.finish();
            super::super::note("nothing to save yet");
            let _ = std::fs::remove_dir(&lab.folder); // only if it is empty
            return Ok(Ending::Interrupted);
        }
        let (modes, spectrum, band) = spectrum(&lab, channel, count);
        all.push(modes);
        spectra.push(spectrum);
        bands.push(band);
        progress.advance(1);
    }

    // the modes of one channel, as the camera sees them
    let channel = lab.channel(args.channel);
    let shown: Vec<usize> =
        (0..all[channel].leading.len()).filter(|&i| spectra[channel].modes[i].value.abs() > modes::ROUNDING).collect();
    let fields: Vec<Vec<f64>> = shown.iter().map(|&i| all[channel].leading[i].vector.clone()).collect();
    let images = lab.matrix.paint(&lab.opened.scene, &fields, &settings, progress);
    bar.finish();
    let paint = |(&i, image): (&usize, &fredholm::terms::TermImage)| {
        let value = spectra[channel].modes[i].value;
        let where_it_belongs =
            if spectra[channel].outside(value) { format!("mode {}", i + 1) } else { "in the band".into() };
        Painted {
            label: format!("{where_it_belongs}, λ = {value:+.4}"),
            values: image.mean.iter().map(|p| f64::from(p[channel]) / value).collect(),
        }
    };
    let painted: Vec<Painted> = shown.iter().zip(&images).map(paint).collect();

    // files
    let name = &lab.opened.description.name;
    let caption = lab.caption(run);
    let title = format!("Spectrum of T: {name}, {} patches, {}", lab.patches(), NAMES[channel]);
    modes::draw(&spectra[channel], &title, &caption)?.write(&lab.folder, "modes")?;
    let mut files: Vec<String> = ["modes.json", "modes.png", "modes.svg", "summary.json"].map(String::from).into();
    if !painted.is_empty() {
        let title = format!("Modes of T: {name}, {} patches, {}", lab.patches(), NAMES[channel]);
        let size = size.map(|s| s as usize);
        modes::sheet(&title, size, &painted, &caption)?.write(&lab.folder.join("modes-painted.png"))?;
        files.push("modes-painted.png".into());
    }
    let record = json!({
        "command": lab.opened.command,
        "scene": name,
        "scene_hash": lab.opened.hash.clone(),
        "seed": run.seed,
        "patches": lab.patches(),
        "channels": modes::machine(&spectra),
    });
    write_atomically(&lab.folder.join("modes.json"), serde_json::to_string_pretty(&record)?.as_bytes())?;
    lab.sign(run, &files)?;
    if run.shared.json {
        print(&serde_json::to_string_pretty(&record)?)?;
    } else {
        let mut blocks = vec![
            format!(
                "{}\n{} patches; eigenvalues inside the band of the edges belong to the mesh",
                lab.opened.command,
                lab.patches()
            ),
            modes::norms(&spectra),
        ];
        if let Some(band) = bands.iter().find(|b| b.other > 0) {
            blocks.push(format!(
                "note: {} pairs of patches meet at another angle than 90°: their band is not known",
                band.other
            ));
        }
        for s in &spectra {
            blocks.push(format!(
                "{}: leading modes, and |⟨u, TᵏE⟩|/‖TE‖ at two bounces\n{}",
                s.channel,
                modes::table(s)
            ));
        }
        let s = &spectra[channel];
        blocks.push(format!("{}: ‖Tᵏ⁺¹E‖/‖TᵏE‖ in two norms\n{}", s.channel, modes::ratio_table(s)));
        blocks.push(format!("written to {}:\n{}", lab.folder.display(), files.join(", ")));
        print(&paragraphs(&blocks))?;
    }
    Ok(if stopped() { Ending::Interrupted } else { Ending::Ok })
}

/// Everything about one channel.
fn spectrum(lab: &Laboratory, channel: usize, count: usize) -> (Modes, Spectrum, Band) {
    let radiosity = &lab.matrix.radiosity;
    let t = radiosity.operator(channel);
    let modes = Modes::of(&t, count);
    let band = essential_band(&radiosity.patches, &radiosity.factors, &t.rho);
    let terms: Vec<Vec<f64>> = Neumann::new(&t, radiosity.emission(channel)).skip(1).take(BOUNCES).collect();
    let row = |m: &fredholm::operator::modes::Mode| Row {
        value: m.value,
        residual: m.residual,
        decay: terms.iter().map(|x| t.weighted_inner(&m.vector, x).abs()).collect(),
    };
    let (one, infinity) = radiosity.norms()[channel];
    let spectrum = Spectrum {
        channel: NAMES[channel].into(),
        values: modes.values.clone(),
        band: band.half_width,
        radius: radius_bounds(&t, 200),
        norms: [one, norm_2(&t, 1e-10, 500), infinity],
        modes: modes.leading.iter().map(row).collect(),
        weighted: terms.iter().map(|x| t.weighted_norm(x)).collect(),
        unweighted: terms.iter().map(|x| t.norm(x)).collect(),
    };
    (modes, spectrum, band)
}
