//! From a file to comparable radiance: placement, outliers, curve and exposure, error bars.
//!
//! Each step undoes what it finds, so that the next one sees a picture without it. What was found is reported, whatever follows.

use super::audit::{Audit, audit};
use super::curve::Curve;
use super::displacement::{Shift, sharpness, shift};
use super::display::{Against, Developed, Display, develop};
use super::evidence::{Counts, count};
use super::explain::{Suspicion, finding};
use super::outliers::{Outlier, outliers};
use super::picture::{Layer, Pictures};
use super::placement::{magnified, placement};
use super::regions::{self, Region};
use super::{Case, plateau};

/// A suspect as radiance, with all that its file shows.
pub(super) struct Ready {
    /// True if all its pixels have one value.
    pub(super) empty: bool,
    /// Radiance, of the size of the reference.
    pub(super) pictures: Pictures,
    /// The reference, shifted like the suspect.
    pub(super) reference: Pictures,
    /// True for pixels that are left out; empty if there are none.
    pub(super) mask: Vec<bool>,
    /// Pixels whose values depend on the pixel filter; empty if there are none.
    pub(super) edges: Vec<bool>,
    /// Its displacement.
    pub(super) shift: Option<Shift>,
    /// Contrast of its edges, with the standard error.
    pub(super) contrast: Option<[f64; 2]>,
    /// The whole image, the grid, and regions by what the camera sees.
    pub(super) regions: Vec<Region>,
    /// How the stored values were read.
    pub(super) display: Display,
    /// What the file shows to be wrong.
    pub(super) findings: Vec<Suspicion>,
    /// Counts of special values.
    pub(super) counts: Counts,
    /// Single pixels that were left out.
    pub(super) outliers: Vec<Outlier>,
    /// The audits of the error bars.
    pub(super) audits: Vec<Audit>,
}

/// A file after its first steps: finite values, in the right place.
struct Placed {
    stored: Pictures,
    findings: Vec<Suspicion>,
    counts: Counts,
    outliers: Vec<Outlier>,
    /// Pixels that no comparison can use; empty if there are none.
    left_out: Vec<bool>,
    empty: bool,
}

/// Values that are not finite, empty pictures, placement and outliers.
fn placed(case: &Case) -> Placed {
    let (finite, broken) = without_broken(case.suspect);
    let counts = count(case.suspect, &shown(case, &finite), case.reference);
    let empty = empty(&finite, case.reference);
    let mut findings: Vec<Suspicion> =
        not_finite(&counts, &broken, case.suspect.size[0]).into_iter().chain(empty.clone()).collect();
    let mut stored = finite;
    if let Some((place, [here, there])) = placement(&shown(case, &stored), case.reference) {
        stored = place.undo_all(&stored);
        findings.push(finding(
            "another-view",
            place.to_string(),
            format!("its correlation with the correct picture rises from {here:.3} to {there:.3} if that is undone"),
            "compare the order of rows, columns and channels in the file with that of the camera",
        ));
    }
    let small = shown(case, &stored);
    let outliers = if stored.code.for_display() { vec![] } else { outliers(&small, case.reference) };
    let mut left_out = shrink(&broken, case.suspect.size[0], case.factor);
    outliers.iter().for_each(|o| left_out[o.pixel[1] * case.reference.size[0] + o.pixel[0]] = true);
    if left_out.iter().all(|m| !m) {
        left_out.clear();
    }
    Placed { stored, findings, counts, outliers, left_out, empty: empty.is_some() }
}

/// Prepares a suspect.
pub(super) fn prepare(case: &Case) -> Ready {
    let Placed { stored, mut findings, mut counts, outliers, left_out, empty } = placed(case);
    let all = regions_of(case, &left_out, &case.seen.edges);
    let against = Against {
        reference: case.reference,
        regions: &all,
        factor: case.factor,
        gain: case.gain,
        mask: &left_out,
        alpha: case.alpha,
    };
    let Developed { display, mut pictures, mut mask, .. } = develop(&stored, &against);
    if !stored.code.for_display() && display.curve != Curve::LINEAR {
        findings.push(encoded(&display));
    }
    findings.extend(dark_whites(&display));
    counts.clipped = display.hidden;
    // whether a clamp explains the picture is decided with the other explanations
    let level = plateau::level(&pictures, case.reference).filter(|_| display.curve == Curve::LINEAR);
    counts.plateau = level.map(f64::from);
    let audits = audit(&pictures, case.reference, &mask);
    if let Some(a) = audits.iter().find(|a| !a.honest()) {
        findings.push(error_bars(a));
        pictures.layers.iter_mut().for_each(|l| l.std_error = None);
    }
    let (mut reference, mut edges) = (case.reference.clone(), case.seen.edges.clone());
    let magnified = magnified(case.suspect);
    findings.extend(magnified.map(enlarged));
    let shift = shift(&pictures, case.reference, &with_lamps(case, &mask)).filter(|_| magnified.is_none());
    if let Some(s) = shift {
        let reach = s.by.iter().fold(0.0f64, |a, d| a.max(d.abs())).ceil() as usize;
        reference = s.applied(&reference);
        mask = s.border(&mask, reference.size);
        edges = regions::widened(&edges, reference.size, reach);
        findings.push(shifted(&s));
    }
    let contrast = sharpness(&pictures, &reference, &with_lamps(case, &mask)).filter(|_| magnified.is_none());
    let regions = regions_of(case, &mask, &edges);
    Ready {
        empty,
        pictures,
        reference,
        mask,
        edges,
        shift,
        contrast,
        regions,
        display,
        findings,
        counts,
        outliers,
        audits,
    }
}

/// Values that should be clipped, and are dark.
fn dark_whites(display: &Display) -> Option<Suspicion> {
    let found = finding(
        "white-is-dark",
        "places that should be white are dark".into(),
        format!(
            "{:.0} % of the values that should be far above 1 are not: the writer lets values wrap around, or the lamp is missing or elsewhere",
            100.0 * display.dark
        ),
        "clip values at 1 before they become integers, and look whether the lamp is seen",
    );
    (display.dark > 0.5).then_some(Suspicion { members: vec!["emission-missing"], ..found })
}

fn enlarged(n: usize) -> Suspicion {
    finding(
        "low-resolution",
        format!("every block of {n} × {n} pixels holds one value"),
        "the picture was rendered smaller and enlarged".into(),
        "render it at the size of the file",
    )
}

fn shifted(s: &Shift) -> Suspicion {
    let ([x, y], [dx, dy]) = (s.by, s.half_width);
    finding(
        "shifted",
        format!("the picture is shifted by {x:.2} ± {dx:.2} pixels to the right and {y:.2} ± {dy:.2} down"),
        "all parts of the picture are displaced by the same amount".into(),
        "sample each pixel from its corner to the next one, and compare the camera",
    )
}

/// The mask with the surroundings of lamps, whose edges are too bright for a fit.
fn with_lamps(case: &Case, mask: &[bool]) -> Vec<bool> {
    let [w, h] = case.reference.size;
    let mut all = if mask.is_empty() { vec![false; w * h] } else { mask.to_vec() };
    let lamps = case.seen.regions.iter().find(|r| r.name == regions::LAMPS);
    lamps.iter().flat_map(|r| &r.pixels).for_each(|&p| all[p] = true);
    all
}

/// The suspect as a picture of the size of the reference, with the usual curve: good enough to see what it shows.
fn shown(case: &Case, stored: &Pictures) -> Pictures {
    if !stored.code.for_display() {
        return stored.shrunk(case.factor);
    }
    let decode = |v: &[f32; 3]| Curve::SRGB.decode(v.map(f64::from)).map(|x| x as f32);
    let layer = |l: &Layer| Layer { mean: l.mean.iter().map(decode).collect(), ..l.clone() };
    Pictures { layers: stored.layers.iter().map(layer).collect(), ..stored.clone() }.shrunk(case.factor)
}

/// The pictures with zero in place of values that are not finite, and the pixels that have such values.
fn without_broken(pictures: &Pictures) -> (Pictures, Vec<bool>) {
    let mut broken = vec![false; pictures.size[0] * pictures.size[1]];
    let mut finite = pictures.clone();
    for layer in &mut finite.layers {
        let known = layer.std_error.take();
        for (p, v) in layer.mean.iter_mut().enumerate() {
            let bad = v.iter().chain(known.as_ref().map_or(&[0.0; 3], |s| &s[p])).any(|x| !x.is_finite());
            broken[p] |= bad;
            v.iter_mut().filter(|x| !x.is_finite()).for_each(|x| *x = 0.0);
        }
        let zero = |mut s: [f32; 3]| {
            s.iter_mut().filter(|x| !x.is_finite()).for_each(|x| *x = 0.0);
            s
        };
        layer.std_error = known.map(|s| s.into_iter().map(zero).collect());
    }
    (finite, broken)
}

/// True for pixels of the small picture that contain a flagged one.
fn shrink(flags: &[bool], width: usize, factor: usize) -> Vec<bool> {
    let (w, h) = (width / factor, flags.len() / width / factor);
    let mut small = vec![false; w * h];
    for (p, _) in flags.iter().enumerate().filter(|(_, f)| **f) {
        let (x, y) = (p % width / factor, p / width / factor);
        if x < w && y < h {
            small[y * w + x] = true;
        }
    }
    small
}

fn regions_of(case: &Case, mask: &[bool], edges: &[bool]) -> Vec<Region> {
    let grid = regions::inside(regions::grid(case.reference.size), edges);
    let all = grid.into_iter().chain(case.seen.regions.iter().cloned()).collect();
    regions::lit(regions::without(all, mask), case.reference)
}

/// A picture with one value in all pixels, where the correct picture has many. White may be a matter of exposure.
fn empty(stored: &Pictures, reference: &Pictures) -> Option<Suspicion> {
    let first = stored.layers.first()?.mean.first()?;
    let same = stored.layers.iter().all(|l| l.mean.iter().all(|v| v == first));
    let white = stored.code.for_display() && first.iter().any(|v| *v >= 1.0);
    let right = reference.layers.last()?.mean.iter().flatten();
    let (low, high) = right.fold((f32::INFINITY, 0.0f32), |a, v| (a.0.min(*v), a.1.max(*v)));
    if !same || white || high < 1.5 * low {
        return None;
    }
    let what =
        if *first == [0.0; 3] { "it is black".to_owned() } else { format!("all its pixels have one value, {first:?}") };
    let why = "the correct picture has many values".to_owned();
    Some(finding("empty", what, why, "look at the file in a viewer, and at the camera"))
}

fn not_finite(counts: &Counts, broken: &[bool], width: usize) -> Option<Suspicion> {
    let first = broken.iter().position(|b| *b)?;
    let (values, are) = if counts.non_finite == 1 { ("value", "is") } else { ("values", "are") };
    let pixels = broken.iter().filter(|b| **b).count();
    let found = finding(
        "not-a-number",
        format!("{} {values} in {pixels} of its pixels {are} not finite", counts.non_finite),
        format!(
            "the first one is in column {}, row {}. Probably a value was divided by a density of 0 and added to the image",
            first % width,
            first / width
        ),
        "print the density of every sample of this pixel",
    );
    Some(Suspicion { members: vec!["not-a-number"], ..found })
}

fn encoded(display: &Display) -> Suspicion {
    finding(
        "encoded",
        format!("the file holds values that are encoded for a display ({}), not linear radiance", display.curve),
        format!(
            "decoded with this curve, and divided by an exposure of {:.4}, the values are radiance",
            display.exposure
        ),
        "write linear radiance into float files, without a view transform",
    )
}

/// Contrasts of edges outside this range are those of no pixel filter.
const FILTERS: [f64; 2] = [0.6, 1.25];
/// Largest standard error of a contrast.
const VAGUE: f64 = 0.08;
/// A contrast must be this many standard errors outside.
const CERTAIN: f64 = 3.0;

/// Edges that are much softer or sharper than any pixel filter makes them. Wrong light changes them, too.
pub(super) fn blurred([contrast, error]: [f64; 2]) -> Option<Suspicion> {
    let (name, how, cause) = if error > VAGUE {
        return None;
    } else if contrast + CERTAIN * error < FILTERS[0] {
        ("blurred", "blurred", "a denoiser, a blur, or a lens")
    } else if contrast - CERTAIN * error > FILTERS[1] {
        ("sharpened", "sharpened", "a sharpening filter")
    } else {
        return None;
    };
    Some(finding(
        name,
        format!("its edges are {how}"),
        format!(
            "their contrast is {contrast:.2} ± {:.2} times the correct one; pixel filters give 0.8 to 1.1",
            1.96 * error
        ),
        &format!("render it without what could have changed them: {cause}"),
    ))
}

/// The error bars of the file are wrong.
fn error_bars(a: &Audit) -> Suspicion {
    let [low, high] = a.interval;
    let (how, cause) = if a.ratio > 1.0 {
        ("too small", "samples repeat, or errors are divided by the number of samples once too often")
    } else {
        ("too large", "pixels share random numbers, or the standard deviation of one sample was written")
    };
    let found = finding(
        "error-bars",
        format!("the error bars of the file are {how}"),
        format!(
            "the scatter of the pixels of {} is {:.3} times the variance that its _se layer states ({low:.3} to {high:.3}): {cause}",
            a.slot, a.ratio
        ),
        "render it with two seeds: their difference must be as large as the error bars say",
    );
    Suspicion { members: vec!["same-numbers"], ..found }
}
