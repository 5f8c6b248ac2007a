//! `--modes`: the spectrum of T, what bounds it, and its modes through the camera.

use super::args::Radiosity;
use super::laboratory::Laboratory;
use crate::cli::base::{Ending, Failure, names, paragraphs};
use crate::cli::preflight;
use fredholm::engine::Settings;
use fredholm::operator::edges::{Band, essential_band};
use fredholm::operator::matrix::LinearOperator;
use fredholm::operator::modes::{Modes, norm_2, radius_bounds};
use fredholm::report::figures::modes::{self, Painted, Row, Spectrum};
use fredholm::report::write_atomically;
use fredholm::solver::Neumann;
use fredholm::terms::{Channel, TermImage};
use serde_json::json;

/// Bounces over which modes are seen to die.
const BOUNCES: usize = 12;

/// Takes T apart, writes and prints.
pub fn run(args: &Radiosity, count: usize) -> Result<Ending, Failure> {
    let Some(lab) = Laboratory::new(args, "modes")? else { return Ok(Ending::Interrupted) };
    let settings = Settings {
        spp: args.frame.spp.unwrap_or(64),
        seed: args.frame.seed,
        max_bounces: count + 1,
        ..Settings::default()
    };
    preflight::fits_in_memory(&settings, lab.opened.description.camera.size)?;

    // eigenvalues, channel by channel
    let progress = lab.session.progress();
    progress.begin(&format!("eigenvalues, {} patches", lab.patches), 3);
    let mut found: Vec<(Modes, Spectrum, Band)> = vec![];
    for channel in Channel::ALL {
        if progress.stopped() {
            return Ok(lab.session.nothing_to_save(""));
        }
        found.push(spectrum(&lab, channel, count));
        progress.advance(1);
    }
    let channel = lab.channel(args.channel);
    let painted = painted(&lab, &found[channel as usize], channel, &settings);
    lab.session.clear();
    let (spectra, bands): (Vec<Spectrum>, Vec<Band>) = found.into_iter().map(|(_, s, b)| (s, b)).unzip();

    let files = write(&lab, &spectra[channel as usize], &painted)?;
    let record = json!({
        "command": lab.session.command(),
        "scene": lab.opened.description.name,
        "scene_hash": lab.opened.hash,
        "seed": args.frame.seed,
        "patches": lab.patches,
        "channels": modes::machine(&spectra),
    });
    write_atomically(&lab.session.folder.join("modes.json"), serde_json::to_string_pretty(&record)?.as_bytes())?;
    lab.sign(&files)?;
    lab.session.show(&record, || people(&lab, &spectra, &bands, channel, &files))?;
    Ok(lab.session.ending(false))
}

/// The modes of one channel, as the camera sees them.
fn painted(
    lab: &Laboratory,
    (all, spectrum, _): &(Modes, Spectrum, Band),
    channel: Channel,
    settings: &Settings,
) -> Vec<Painted> {
    let shown: Vec<usize> =
        (0..all.leading.len()).filter(|&i| spectrum.modes[i].value.abs() > modes::ROUNDING).collect();
    let fields: Vec<Vec<f64>> = shown.iter().map(|&i| all.leading[i].vector.clone()).collect();
    let images = lab.matrix.paint(&lab.opened.scene, &fields, settings, lab.session.progress());
    let paint = |(&i, image): (&usize, &TermImage)| {
        let value = spectrum.modes[i].value;
        let where_it_belongs = if spectrum.outside(value) { format!("mode {}", i + 1) } else { "in the band".into() };
        Painted {
            label: format!("{where_it_belongs}, λ = {value:+.4}"),
            values: image.mean.iter().map(|p| f64::from(p[channel as usize]) / value).collect(),
        }
    };
    shown.iter().zip(&images).map(paint).collect()
}

/// Writes the pictures; the names of all files.
fn write(lab: &Laboratory, spectrum: &Spectrum, painted: &[Painted]) -> Result<Vec<String>, Failure> {
    let (folder, caption, patches) = (&lab.session.folder, lab.session.caption(), lab.patches);
    let (name, channel) = (&lab.opened.description.name, &spectrum.channel);
    let title = format!("Spectrum of T: {name}, {patches} patches, {channel}");
    modes::draw(spectrum, &title, &caption)?.write(folder, "modes")?;
    let mut files = names(["modes.json", "modes.png", "modes.svg", "summary.json"]);
    if !painted.is_empty() {
        let title = format!("Modes of T: {name}, {patches} patches, {channel}");
        let size = lab.opened.description.camera.size.map(|s| s as usize);
        modes::sheet(&title, size, painted, &caption)?.write(&folder.join("modes-painted.png"))?;
        files.push("modes-painted.png".into());
    }
    Ok(files)
}

fn people(lab: &Laboratory, spectra: &[Spectrum], bands: &[Band], channel: Channel, files: &[String]) -> String {
    let mut blocks = vec![
        format!(
            "{}\n{} patches; eigenvalues inside the band of the edges belong to the mesh",
            lab.session.command(),
            lab.patches
        ),
        modes::norms(spectra),
    ];
    if let Some(band) = bands.iter().find(|b| b.other > 0) {
        blocks.push(format!(
            "note: {} pairs of patches meet at another angle than 90°: their band is not known",
            band.other
        ));
    }
    for s in spectra {
        blocks.push(format!("{}: leading modes, and |⟨u, TᵏE⟩|/‖TE‖ at two bounces\n{}", s.channel, modes::table(s)));
    }
    let s = &spectra[channel as usize];
    blocks.push(format!("{}: ‖Tᵏ⁺¹E‖/‖TᵏE‖ in two norms\n{}", s.channel, modes::ratio_table(s)));
    blocks.push(format!("written to {}:\n{}", lab.session.folder.display(), files.join(", ")));
    paragraphs(&blocks)
}

/// Everything about one channel.
fn spectrum(lab: &Laboratory, channel: Channel, count: usize) -> (Modes, Spectrum, Band) {
    let radiosity = &lab.matrix.radiosity;
    let t = radiosity.operator(channel as usize);
    let modes = Modes::of(&t, count);
    let band = essential_band(&radiosity.patches, &radiosity.factors, &t.rho);
    let terms: Vec<Vec<f64>> = Neumann::new(&t, radiosity.emission(channel as usize)).skip(1).take(BOUNCES).collect();
    let row = |m: &fredholm::operator::modes::Mode| Row {
        value: m.value,
        residual: m.residual,
        decay: terms.iter().map(|x| t.weighted_inner(&m.vector, x).abs()).collect(),
    };
    let (one, infinity) = radiosity.norms()[channel as usize];
    let spectrum = Spectrum {
        channel: channel.to_string(),
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
