//! The evidence behind a diagnosis in words: facts about a picture, and the explanations that were tried.

use super::found::Diagnosed;
use fredholm::diagnosis::curve::Curve;
use fredholm::diagnosis::explain::in_words;
use fredholm::diagnosis::family::Relation;
use fredholm::diagnosis::fit::Constant;
use fredholm::diagnosis::{Code, Conclusion, Diagnosis};
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::table::significant;

/// Longest line of a table.
const WIDEST: usize = 100;

/// A share in percent with two digits.
pub fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}

/// How the stored values were read, if they are not linear radiance.
pub fn read_as(f: &Diagnosed) -> Option<String> {
    let display = &f.diagnosis.display;
    if display.curve == Curve::LINEAR {
        return None;
    }
    let code = match f.code {
        Code::EightBit => "8 bits",
        Code::SixteenBit => "16 bits",
        Code::Jpeg => "JPEG",
        Code::Float | Code::Half | Code::SharedExponent => "floating point",
    };
    let down = if display.rounded_down { ", rounded down" } else { "" };
    let exposure = if display.fitted {
        in_words(Constant { value: display.exposure, std_error: display.half_width / 1.96 })
    } else {
        format!("{} (given)", significant(display.exposure, 4))
    };
    let hidden = if display.hidden > 0.0 {
        format!("; {} of the pixels are clipped or beside such pixels, and left out", percent(display.hidden))
    } else {
        String::new()
    };
    if !display.known {
        return Some(format!("It was read as {code}; of the known curves, none fits."));
    }
    Some(format!("Read as {code}{down}, {}, exposure {exposure}{hidden}.", display.curve))
}

/// What a verdict of *correct* rests on.
pub fn power(f: &Diagnosed) -> Option<String> {
    let d = &f.diagnosis;
    let what = if f.terms { "terms" } else { "image" };
    let bias = percent(d.visible);
    let negative = match d.evidence.counts.negative {
        0 => String::new(),
        n if f.terms => format!(" {} negative, as differences of pictures are.", is_or_are(n)),
        n => format!(
            " {} negative, which radiance is not; a filter with negative lobes can be the reason.",
            is_or_are(n)
        ),
    };
    let power = if d.display.fitted {
        format!(
            "The {what} agrees with the correct one up to its exposure; a bias of {bias} in one region would have been seen with \
             probability 0.99. A factor on all light cannot be seen, because the exposure is unknown."
        )
    } else {
        let agree = if f.terms { "agree" } else { "agrees" };
        format!(
            "The {what} {agree} in all regions; a uniform bias above {bias} would have been seen with probability 0.99."
        )
    };
    Some(power + &negative)
}

fn is_or_are(n: u64) -> String {
    if n == 1 { "One value is".into() } else { format!("{n} values are") }
}

/// What would tell more about a picture that is correct as far as it can tell.
pub fn more(f: &Diagnosed) -> String {
    if f.code.for_display() {
        "send linear radiance as EXR, best with the terms as layers (fredholm diagnose --how)".into()
    } else if !f.terms {
        "send the terms as layers, which tell most (fredholm diagnose --how)".into()
    } else {
        "nothing is left to do. To see whether samples repeat, give two renders with different samples per pixel (r_16.exr r_64.exr)".into()
    }
}

/// Facts about a picture in sentences.
pub fn facts(f: &Diagnosed) -> Vec<String> {
    let (d, e) = (&f.diagnosis, &f.diagnosis.evidence);
    let mut facts = vec![format!("The errors of the pixels come from {}.", e.errors)];
    if !f.terms {
        facts.push("The file has no terms, so only the whole image is compared.".into());
    }
    facts.extend(match d.relation {
        Relation::Sum => Some("The whole image is the sum of its layers: it holds no longer paths.".into()),
        Relation::Rest => Some("The whole image minus its layers is compared with the tail.".to_owned()),
        Relation::Apart => None,
    });
    if d.edges > 0.0 {
        facts.push(format!(
            "{} of the pixels lie beside edges or lamps. They depend on the pixel filter, and are compared only in sums.",
            percent(d.edges)
        ));
    }
    if let Some([contrast, error]) = d.contrast {
        facts.push(format!("The contrast of edges is {contrast:.2} ± {:.2} times the correct one.", 1.96 * error));
    }
    for a in &d.audits {
        let honest = if a.honest() { "honest" } else { "wrong" };
        facts.push(format!(
            "Error bars of {}: the scatter of its pixels is {} times the variance that they state ({} to {}): {honest}.",
            a.slot,
            significant(a.ratio, 3),
            significant(a.interval[0], 3),
            significant(a.interval[1], 3)
        ));
    }
    let samples = e.samples / (f.factor * f.factor) as f64;
    if samples.is_finite() && d.verdict == Conclusion::Correct {
        let as_noisy = format!("It is as noisy as {} samples per pixel of the reference", significant(samples, 2));
        match f.told.filter(|told| *told > 2.5 * samples) {
            Some(told) => facts.push(format!(
                "{as_noisy}, but the file says {told}: its sampling is noisier, or random numbers repeat. Two files with \
                 different samples per pixel would tell."
            )),
            None => facts.push(format!("{as_noisy}.")),
        }
    }
    if let Some([sum, half, right]) = e.sum {
        facts.push(format!("Whole image over the sum of its own layers: {sum:.4} ± {half:.4}; {right:.4} is right."));
    }
    let c = &e.counts;
    if c.non_finite + c.negative > 0 {
        facts.push(format!("{} values are not finite, {} are negative.", c.non_finite, c.negative));
    }
    if c.black > 0.01 {
        let share = percent(c.black);
        facts.push(format!("Up to {share} of the pixels of a layer are black where the reference is not."));
    }
    for o in d.outliers.iter().take(3) {
        let [x, y] = o.pixel;
        let image = o.slot.in_words();
        facts.push(format!(
            "Left out: the pixel in column {x}, row {y} of {image}, {} times as bright as it should be.",
            significant(o.times, 3)
        ));
    }
    if let Some(s) = &d.samples {
        let means: Vec<String> = s.means.iter().map(|m| format!("{:.4} at {}", m[1], m[0])).collect();
        facts.push(format!("Mean over the correct one by samples per pixel: {}.", means.join(", ")));
        if s.slope.is_finite() {
            facts.push(format!("The squared error falls as samples^{:.2}.", s.slope));
        }
    }
    if !f.ignored.is_empty() {
        facts.push(format!("Layers whose names were not understood: {}.", f.ignored.join(", ")));
    }
    facts
}

/// The families that were fitted, with the p-value and χ² of each.
pub fn families(d: &Diagnosis) -> String {
    let above = "Families of mistakes with a fitted constant: p-value (✗: rejected, or another one fits much better), and χ² per cell.";
    let mut out = format!("{}\n{:>12} {:>9}  what\n{}\n", wrapped(above), "p, adjusted", "χ²", "─".repeat(63));
    for t in d.families.iter().take(8) {
        let p = if t.rejected { format!("{} ✗", significant(t.p, 2)) } else { significant(t.p, 2) };
        let what = t.what.split(", as").next().unwrap_or_default();
        let what = what.split(", and all").next().unwrap_or_default();
        let line = format!("{p:>12} {:>9}  {what}", significant(t.chi2, 3));
        let cut = if line.chars().count() > WIDEST { "…" } else { "" };
        out += &format!("{}{cut}\n", line.chars().take(WIDEST - 1).collect::<String>());
    }
    out
}

/// The mistakes that were simulated, with the p-value and the misfit of each.
pub fn candidates(d: &Diagnosis) -> String {
    let mut out = format!(
        "Simulated mistakes: samples per pixel, p-value (✗: rejected), and the misfit in standard errors.\n\
         {:<46} {:>6} {:>12} {:>14}\n{}\n",
        "candidate",
        "spp",
        "p, adjusted",
        "rms deviation",
        "─".repeat(81)
    );
    for c in &d.candidates {
        let p = if c.rejected { format!("{} ✗", significant(c.p, 2)) } else { significant(c.p, 2) };
        out += &format!("{:<46} {:>6} {p:>12} {:>11.1} se\n", c.name, c.spp, c.misfit.sqrt());
    }
    out
}
