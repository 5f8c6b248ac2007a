//! Two more scenes with an exact answer, and helpers of chapter 4.
//!
//! | scene | exact answer | function |
//! |---|---|---|
//! | a glass ball in a sky of radiance 1 | L = 1 at every pixel | [`glass`] |
//! | integrating sphere of albedo ρ; the share s of its area emits 1 | L − E = s ρ/(1 − ρ) at every point | [`sphere`] |

use super::{Pixels, Value, render};
use fredholm::estimator::Technique;
use fredholm::report::book::{self, Folder};
use fredholm::terms::Estimate;
use fredholm::zoo::{self, Mistake, Stage};

/// A glass ball in a sky of radiance 1: T E, T²E, T³E, and the whole image, which is 1 everywhere.
pub fn glass(f: &Folder<'_>, step: &dyn Mistake) -> book::Result<Vec<Pixels>> {
    let light = render(f, Stage::GLASS_BALL, f.pick(128, 64), Technique::Mis, step, "glass")?;
    Ok(light.terms[1..4].iter().chain([&light.total]).map(|image| image.mean.clone()).collect())
}

/// L − E in the integrating sphere, over the pixels where E = 1, and where E = 0.
pub fn sphere(f: &Folder<'_>, step: &dyn Mistake) -> book::Result<[Value; 2]> {
    let light = render(f, Stage::SPHERE, f.pick(64, 32), Technique::Mis, step, "sphere")?;
    let emitted = |pixel: usize| light.terms[0].mean[pixel][0];
    Ok([1.0, 0.0].map(|e| {
        let pixels: Vec<usize> = (0..light.total.mean.len()).filter(|&p| (emitted(p) - e).abs() < 1e-6).collect();
        let (n, total) = (pixels.len() as f64, &light.total);
        let mean = pixels.iter().map(|&p| f64::from(total.mean[p][0] - e)).sum::<f64>() / n;
        [mean, pixels.iter().map(|&p| f64::from(total.std_error[p][0]).powi(2)).sum::<f64>().sqrt() / n]
    }))
}

/// Mean over the channels, and its standard error.
pub(super) fn value(e: &Estimate) -> Value {
    [e.mean, e.std_error].map(|v| v.element_sum() / 3.0)
}

/// A member of the zoo.
pub(super) fn member(name: &str) -> book::Result<&'static dyn Mistake> {
    Ok(zoo::find(name).ok_or("the zoo has lost a member")?.mistake)
}

/// The largest value; NaN if one is NaN, so that no claim holds because of it.
pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, x| if x.is_nan() || x > a { x } else { a })
}
