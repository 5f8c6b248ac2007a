//! The images of a run: all of them as floats in one EXR file, and the pictures for a reader as PNG.

use super::files::{Files, Pixels};
use crate::cli::base::Failure;
use fredholm::engine::by_rays::Sampled;
use fredholm::report::image::contact_sheet::{self, Cell, Sheet, direct_and_indirect, single};
use fredholm::report::image::exposure::Exposure;
use fredholm::report::image::exr;
use fredholm::report::image::picture;
use fredholm::report::image::typeset::{Caption, superscript};
use fredholm::report::image::zmap;
use fredholm::report::page::data::Slot;
use fredholm::report::text::pixel_errors::{self, PixelErrors};
use fredholm::scene::Crop;
use fredholm::study::run::Run;
use fredholm::terms::{Estimate, TermImage};

/// A layer with errors.
pub(super) struct Layer<'a> {
    pub name: String,
    pub image: &'a TermImage,
    /// Whether the errors can be trusted.
    pub errors: PixelErrors,
    /// The result that it is a part of.
    pub of: &'a Sampled,
    /// Which part; none for the sum of the first terms beside the whole.
    pub slot: Option<Slot>,
}

/// The layers of a run that have errors.
pub(super) fn layers<'a>(run: &'a Run) -> Vec<Layer<'a>> {
    let mut layers = vec![];
    let mut push = |name: String, image: &'a TermImage, s: &'a Sampled, part: usize, mean: &Estimate, slot| {
        // light that is found only by chance: a pixel gets at most its share of the expected hits
        let share = s.series.cost.paths as f64 / s.total.mean.len() as f64;
        let concerned = s.series.doubts.iter().filter(|d| part >= s.terms.len() || d.from <= part);
        let events = concerned.map(|d| d.per_path * share).fold(s.pixel_events[part], f64::min);
        let errors = pixel_errors::of(&name, mean, events, u64::from(run.settings.replicates_of(s.spp)));
        layers.push(Layer { name, image, errors, of: s, slot });
    };
    let series = |s: &'_ Sampled| s.series.image().clone();
    if let Some(t) = run.terms.first() {
        let (f, last) = (series(t), t.terms.len());
        t.terms.iter().enumerate().for_each(|(k, image)| {
            push(format!("T{k:02}"), image, t, k, &f.terms[k], Some(Slot::Term(k)));
        });
        let cut = f.tail.is_none();
        push("Tsum".into(), &t.sum, t, last + 1, &f.sum, cut.then_some(Slot::Whole));
        if !cut {
            push("tail".into(), &t.tail, t, last, &f.tail, Some(Slot::Rest));
            push("Tall".into(), &t.total, t, last + 2, &f.total, Some(Slot::Whole));
        }
    }
    if let Some(p) = &run.path {
        push("path".into(), &p.total, p, 0, &p.series.image().total, Some(Slot::Whole));
    }
    if let Some(r) = run.radiosity.as_ref().map(|r| &r.fine) {
        let (f, last) = (series(r), r.terms.len());
        r.terms.iter().enumerate().for_each(|(k, image)| {
            push(format!("R{k:02}"), image, r, k, &f.terms[k], Some(Slot::Term(k)));
        });
        push("Rsum".into(), &r.sum, r, last + 1, &f.sum, None);
        push("Rfull".into(), &r.total, r, last + 2, &f.total, Some(Slot::Whole));
    }
    layers
}

/// For each layer with errors, whether they can be trusted.
pub(super) fn pixel_errors(run: &Run) -> Vec<PixelErrors> {
    layers(run).into_iter().map(|l| l.errors).collect()
}

pub(super) fn write_exr<'a>(run: &'a Run, trust: &[PixelErrors], out: &mut Files<'a>) {
    let beauty = run.path.as_ref().or(run.terms.first()).map(|s| &s.total);
    let beauty = beauty.or(run.radiosity.as_ref().map(|r| &r.fine.total));
    if beauty.is_none() {
        return;
    }
    let flags: Vec<(String, String)> =
        trust.iter().map(|t| (format!("fredholm.{}_se", t.layer), t.why.clone())).collect();
    let attributes = out.attributes(run);
    out.later("terms.exr", move |path| {
        let all = layers(run);
        let names: Vec<String> = all.iter().map(|l| format!("{}_se", l.name)).collect();
        let mut layers: Vec<exr::Layer> =
            beauty.into_iter().map(|image| exr::Layer { name: "", pixels: &image.mean }).collect();
        for (Layer { name, image, .. }, errors) in all.iter().zip(&names) {
            layers.push(exr::Layer { name, pixels: &image.mean });
            layers.push(exr::Layer { name: errors, pixels: &image.std_error });
        }
        let mut attributes = attributes.to_vec();
        attributes.extend(flags.iter().map(|(name, why)| (name.as_str(), why.clone())));
        let whole = run.scene.camera.size;
        let crop = run.settings.crop.unwrap_or(Crop::whole(whole));
        exr::write_crop(path, crop, whole, &layers, &attributes)?;
        Ok(())
    });
}

pub(super) fn write_pictures<'a>(
    run: &'a Run,
    out: &mut Files<'a>,
    size: [u32; 2],
    exposure: Exposure,
    caption: &'a Caption,
) {
    let [w, h] = size.map(|s| s as usize);
    let shown = run.terms.first().or(run.radiosity.as_ref().map(|r| &r.fine));
    if let Some(s) = shown {
        terms_and_sums(s, out, size, exposure, caption);
    }
    if let Some(p) = &run.path {
        out.later("path.png", move |path| {
            let gain = whole_gain(&p.total.mean, shown.and_then(|s| s.terms.first()));
            let (picture, _) = single("path tracer", w, h, &p.total.mean, Some(gain))?;
            Ok(picture.picture.write(path)?)
        });
    }
    if let (Some(t), Some(p)) = (run.terms.first(), &run.path) {
        out.later("z.png", move |path| {
            let z = z_values((&t.total.mean, &t.total.std_error), (&p.total.mean, &p.total.std_error));
            let map = zmap::draw("z of the whole image: terms − path tracer", w, h, &z, caption)?;
            Ok(map.picture.write(path)?)
        });
    }
    if let Some(r) = &run.radiosity {
        out.later("radiosity.png", move |path| {
            let gain = whole_gain(&r.fine.total.mean, r.fine.terms.first());
            let (picture, _) = single("radiosity", w, h, &r.fine.total.mean, Some(gain))?;
            Ok(picture.picture.write(path)?)
        });
    }
    if let (Some(t), Some(p), Some(r)) = (run.terms.first(), &run.path, &run.radiosity) {
        out.later("three.png", move |path| {
            let gain = Some(whole_gain(&p.total.mean, t.terms.first()));
            let answers = [("the series: Σ TᵏE", t), ("the path tracer", p), ("the matrix: (I − T)⁻¹E", &r.fine)];
            let cells = answers.map(|(label, s)| Cell { label: label.into(), pixels: &s.total.mean, gain });
            Ok(contact_sheet::grid("One scene, three answers", w, h, &cells, caption)?.picture.write(path)?)
        });
    }
}

/// The pictures of the terms and of their partial sums.
fn terms_and_sums<'a>(s: &'a Sampled, out: &mut Files<'a>, size: [u32; 2], exposure: Exposure, caption: &'a Caption) {
    let [w, h] = size.map(|s| s as usize);
    out.later("terms.png", move |path| {
        let means: Vec<&[[f32; 3]]> = s.terms.iter().map(|t| t.mean.as_slice()).collect();
        let note = format!("{}, {} spp", s.series.label, s.spp);
        Ok(terms_sheet(exposure, size, &means, Some(&s.total.mean), caption, &note)?.picture.write(path)?)
    });
    let common = exposure.gain(&s.terms.iter().map(|t| t.mean.as_slice()).collect::<Vec<_>>());
    for (k, image) in s.terms.iter().enumerate() {
        out.later(&format!("T{k:02}.png"), move |path| {
            let (picture, _) = single(&format!("T{}E", superscript(k)), w, h, &image.mean, common)?;
            Ok(picture.picture.write(path)?)
        });
    }
    // partial sums at the exposure of the whole
    let gain = Some(whole_gain(&s.total.mean, s.terms.first()));
    let mut partial: Pixels = vec![[0.0; 3]; w * h];
    for (k, image) in s.terms.iter().enumerate() {
        add(&mut partial, &image.mean);
        let partial = partial.clone();
        if k == 1 {
            let direct = partial.clone();
            out.later("direct.png", move |path| {
                let sheet = direct_and_indirect(w, h, &s.terms[0].mean, &direct, &s.total.mean, caption)?;
                Ok(sheet.picture.write(path)?)
            });
        }
        out.later(&format!("partial_{k:02}.png"), move |path| {
            let (picture, _) = single(&format!("S{}", subscript(k)), w, h, &partial, gain)?;
            Ok(picture.picture.write(path)?)
        });
    }
}

/// The exposure of a whole image. Pixels of lamps are left out where the terms tell which they are.
fn whole_gain(pixels: &Pixels, emission: Option<&TermImage>) -> f64 {
    emission.map_or_else(|| picture::auto_gain(pixels), |e| picture::auto_gain_beside_lamps(pixels, &e.mean))
}

fn subscript(k: usize) -> String {
    const DIGITS: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];
    k.to_string().bytes().map(|b| DIGITS[usize::from(b - b'0')]).collect()
}

fn add(sum: &mut Pixels, image: &Pixels) {
    for (s, v) in sum.iter_mut().zip(image) {
        (0..3).for_each(|c| s[c] += v[c]);
    }
}

pub(super) fn terms_sheet(
    exposure: Exposure,
    [w, h]: [u32; 2],
    images: &[&[[f32; 3]]],
    whole: Option<&Pixels>,
    caption: &Caption,
    note: &str,
) -> Result<Sheet, Failure> {
    let (gain, whole) = (exposure.gain(images), whole.map(Vec::as_slice));
    Ok(contact_sheet::terms_at(gain, w as usize, h as usize, images, whole, note, caption)?)
}

/// z for each pixel: the mean over the channels of a − b, divided by its standard error. The channels are treated as fully
/// correlated, which they nearly are.
pub fn z_values(a: (&Pixels, &Pixels), b: (&Pixels, &Pixels)) -> Vec<f64> {
    let sum = |v: &[f32; 3]| v.iter().map(|&x| f64::from(x)).sum::<f64>();
    let z = |i: usize| {
        let errors = (sum(&a.1[i]), sum(&b.1[i]));
        let error = errors.0.hypot(errors.1);
        let difference = sum(&a.0[i]) - sum(&b.0[i]);
        // an error of 0 means that no light has reached the pixel yet, so its error is not known
        if errors.0 > 0.0 && errors.1 > 0.0 { difference / error } else { f64::NAN }
    };
    (0..a.0.len()).map(z).collect()
}
