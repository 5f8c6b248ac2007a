//! `radiosity --modes`: the spectrum of T, bounds on it, and its modes as images.

use super::args::Radiosity;
use super::laboratory::Laboratory;
use crate::cli::base::{Ending, Failure, names};
use crate::cli::preflight;
use fredholm::engine::Settings;
use fredholm::operator::edges::{Band, essential_band};
use fredholm::operator::matrix::LinearOperator;
use fredholm::operator::modes::{Modes, norm_2, radius_bounds};
use fredholm::report::figures::modes::{self, Painted, Row, Spectrum};
use fredholm::report::text::prose::{listed, wrapped};
use fredholm::report::text::table::plus_minus;
use fredholm::report::write_atomically;
use fredholm::solver::Neumann;
use fredholm::terms::{Channel, TermImage};
use serde_json::json;

/// Number of bounces over which the decay of the modes is shown.
const BOUNCES: usize = 12;

/// Modes in the table that is printed without `--verbose`.
const SHOWN: usize = 10;

/// Finds the spectrum of T in every channel, writes the files and prints the text.
pub fn run(args: &Radiosity, count: usize) -> Result<Ending, Failure> {
    let Some(mut lab) = Laboratory::new(args, "modes")? else { return Ok(Ending::Interrupted) };
    let settings = Settings {
        spp: args.frame.spp.unwrap_or(64),
        seed: args.frame.seed,
        max_bounces: count + 1,
        ..Settings::default()
    };
    preflight::fits_in_memory(&settings, lab.opened.description.camera.size)?;

    // eigenvalues of every channel
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

/// Images of the modes of one channel, without those whose eigenvalue is zero to rounding.
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

/// Writes the pictures; returns the names of all files.
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

/// The text: the spectral radius, the leading modes, and with `--verbose` all channels and norms.
fn people(lab: &Laboratory, spectra: &[Spectrum], bands: &[Band], channel: Channel, files: &[String]) -> String {
    let s = &spectra[channel as usize];
    let mut above = format!(
        "The leading modes u of T in the {channel} channel: the eigenvalue λ, the residual ‖T u − λ u‖, the share of the \
         first bounce TE that the mode carries, and its size at bounces 4 and 8 relative to ‖TE‖. Modes in the band, \
         |λ| ≤ {:.3}, belong to the mesh: they change with every refinement.",
        s.band
    );
    if bands.iter().any(|b| b.other > 0) {
        above += " Some faces meet at an angle other than 90°; for them the band of eigenvalues that belong to the mesh is not known.";
    }
    let left = s.modes.len().saturating_sub(SHOWN);
    let below = if left > 0 { format!("… and {left} more in modes.json") } else { String::new() };
    let table = format!("{}\n{}{below}", wrapped(&above), modes::table(s, SHOWN));
    let mut details = vec![format!(
        "{}\n{}\n{}",
        lab.session.command(),
        wrapped(&format!(
            "Bounds of the spectral radius r(T), norms of T, the half width of the band, and how many of the eigenvalues lie \
             outside it; {} patches.",
            lab.patches
        )),
        modes::norms(spectra)
    )];
    if let Some(band) = bands.iter().find(|b| b.other > 0) {
        details.push(format!("note: {} pairs of patches meet at another angle than 90°", band.other));
    }
    for s in spectra {
        details.push(format!(
            "The leading modes in the {} channel, with |⟨u, TᵏE⟩|/‖TE‖ at k = 4 and 8.\n{}",
            s.channel,
            modes::table(s, usize::MAX)
        ));
    }
    details.push(format!(
        "Ratios ‖Tᵏ⁺¹E‖/‖TᵏE‖ in the {channel} channel: in the weight A/ρ they never fall.\n{}",
        modes::ratio_table(s)
    ));
    lab.session.text(&answer(lab, spectra, channel), &[table], &details, files)
}

/// The answer: the spectral radius of the channel, its meaning, its bounds, and the other channels.
fn answer(lab: &Laboratory, spectra: &[Spectrum], channel: Channel) -> String {
    let s = &spectra[channel as usize];
    let [low, high] = s.radius;
    let (radius, half) = (0.5 * (low + high), 0.5 * (high - low));
    let value =
        if half < 5e-6 { format!("{radius:.5} (bounded to all digits shown)") } else { plus_minus(radius, half, 1) };
    let [one, two, infinity] = s.norms;
    let others: Vec<String> = Channel::ALL
        .iter()
        .filter(|c| **c != channel)
        .map(|c| format!("{:.5} ({c})", spectra[*c as usize].radius[1]))
        .collect();
    let (name, patches) = (&lab.opened.description.name, lab.patches);
    wrapped(&format!(
        "The spectral radius of the {channel} channel is {value} on this mesh of {patches} patches.\n\
         In the long run each bounce keeps {:.1} % of the light of the bounce before. The other channels have {}. The norms \
         bound the radius: ‖T‖₁ = {one:.4}, ‖T‖₂ = {two:.4}, ‖T‖∞ = {infinity:.4}. \
         `fredholm radiosity {name}` estimates the radius for ever finer meshes.",
        100.0 * radius,
        listed(&others)
    ))
}

/// Eigenvalues, modes, bounds and norms of one channel.
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
