//! The evidence behind a diagnosis in words: facts about a picture, and the mistakes that were simulated.

use super::found::Diagnosed;
use fredholm::diagnosis::{Conclusion, Diagnosis};
use fredholm::report::text::table::significant;

/// Rows of the table of ratios that are printed without `--verbose`.
pub const ROWS: usize = 8;

/// A share in percent with two digits.
pub fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}

/// Facts about a picture in sentences: those a reader must know, and the others.
pub fn facts(f: &Diagnosed) -> [Vec<String>; 2] {
    let (d, e) = (&f.diagnosis, &f.diagnosis.evidence);
    let (mut important, mut other) = (vec![], vec![format!("Errors of the picture: from {}.", e.errors)]);
    if f.any_gain {
        important.push(
            "The exposure is unknown: the picture is scaled to the brightness of the reference, so a uniform factor cannot be \
             seen."
                .into(),
        );
    }
    if !f.terms {
        important.push("The file has no terms, so only the whole image is compared.".into());
    }
    let samples = e.samples / (f.factor * f.factor) as f64;
    if samples.is_finite() && d.verdict == Conclusion::Correct {
        let as_noisy = format!("It is as noisy as {} samples per pixel of the reference", significant(samples, 2));
        match f.told.filter(|told| *told > 2.5 * samples) {
            Some(told) => important.push(format!(
                "{as_noisy}, but the file says {told}: its sampling is noisier, or random numbers repeat. Two files with \
                 different samples per pixel would tell."
            )),
            None => other.push(format!("{as_noisy}.")),
        }
    }
    if d.verdict == Conclusion::Correct && d.samples.is_none() {
        important.push(
            "One file cannot show samples that repeat; two with different samples per pixel can (r_16.exr r_64.exr)."
                .into(),
        );
    }
    if let Some([sum, half, right]) = e.sum {
        other.push(format!("Whole image over the sum of its own layers: {sum:.4} ± {half:.4}; {right:.4} is right."));
    }
    let c = &e.counts;
    if c.non_finite + c.negative > 0 {
        important.push(format!("{} values are not finite, {} are negative.", c.non_finite, c.negative));
    }
    if c.black > 0.01 {
        let share = percent(c.black);
        other.push(format!("Up to {share} of the pixels of a layer are black where the reference is not."));
    }
    if c.clipped > 0.0 {
        let share = percent(c.clipped);
        important
            .push(format!("{share} of the pixels are at the end of 8 bits; they and their neighbours are left out."));
    }
    if let Some(s) = &d.samples {
        let means: Vec<String> = s.means.iter().map(|m| format!("{:.4} at {}", m[1], m[0])).collect();
        important.push(format!("Mean over the right one by samples per pixel: {}.", means.join(", ")));
        if s.slope.is_finite() {
            important.push(format!("The squared error falls as samples^{:.2}.", s.slope));
        }
    }
    if !f.ignored.is_empty() {
        other.push(format!("Layers whose names were not understood: {}.", f.ignored.join(", ")));
    }
    [important, other]
}

/// The mistakes that were simulated, with the p-value and the misfit of each.
pub fn candidates(d: &Diagnosis) -> String {
    let mut out = format!(
        "Simulated mistakes: samples per pixel, p-value (✗: rejected), and the misfit in standard errors.\n\
         {:<28} {:>6} {:>12} {:>14}\n{}\n",
        "candidate",
        "spp",
        "p, adjusted",
        "rms deviation",
        "─".repeat(63)
    );
    for c in &d.candidates {
        let p = if c.rejected { format!("{} ✗", significant(c.p, 2)) } else { significant(c.p, 2) };
        out += &format!("{:<28} {:>6} {p:>12} {:>11.1} se\n", c.name, c.spp, c.misfit.sqrt());
    }
    out
}
