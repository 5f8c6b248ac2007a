//! Values as they are typed.

use super::Schedule;
use fredholm::estimator::Technique;
use fredholm::math::Points;
use fredholm::scene::{Selection, bsdf::Sampling};
use std::time::Duration;

pub fn size(s: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{s}` is not a size such as 128x128 (each side 1 to 32768)");
    let (w, h) = s.split_once('x').ok_or_else(wrong)?;
    let side = |s: &str| s.parse().ok().filter(|n| (1..=32768).contains(n)).ok_or_else(wrong);
    Ok([side(w)?, side(h)?])
}

pub fn grading(s: &str) -> Result<f64, String> {
    let g: f64 = s.parse().map_err(|_| format!("`{s}` is not a number"))?;
    if (1.0..=8.0).contains(&g) { Ok(g) } else { Err("a grading is a number from 1 to 8".into()) }
}

/// `30s`, `1.5m`, `500ms`; a bare number is seconds.
pub fn duration(s: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let (number, unit) = units.iter().find_map(|(u, f)| Some((s.strip_suffix(u)?, *f))).unwrap_or((s, 1.0));
    let seconds = number.parse().ok().map(|x: f64| x * unit).filter(|x| *x > 0.0 && *x <= 1e6);
    seconds.map(Duration::from_secs_f64).ok_or(format!("`{s}` is not a time such as 30s, 1.5m or 500ms"))
}

pub fn fraction(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite()).ok_or(format!("`{s}` is not a number from 0 on"))
}

pub fn probability(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|p| *p > 0.0 && *p < 1.0).ok_or(format!("`{s}` is not between 0 and 1"))
}

pub fn technique(s: &str) -> Result<Technique, String> {
    match s {
        "scatter" => Ok(Technique::Scatter),
        "connect" => Ok(Technique::Connect),
        "mis" => Ok(Technique::Mis),
        "mis-power" => Ok(Technique::Power),
        _ => Err(format!("`{s}` is none of scatter, connect, mis, mis-power")),
    }
}

pub fn schedule(s: &str) -> Result<Schedule, String> {
    match s.parse() {
        _ if s == "optimal" => Ok(Schedule::Optimal),
        Ok(by_expectation) => Ok(Schedule::ByExpectation(by_expectation)),
        Err(_) => {
            let more = |wrong: String| {
                if wrong.starts_with("unknown") { wrong + "; contribution[@V] or window[@V]" } else { wrong }
            };
            s.parse().map(Schedule::Given).map_err(more)
        }
    }
}

pub fn points(s: &str) -> Result<Points, String> {
    match s {
        "independent" => Ok(Points::Independent),
        "sobol" => Ok(Points::Sobol),
        _ => Err(format!("`{s}` is none of independent, sobol")),
    }
}

pub fn selection(s: &str) -> Result<Selection, String> {
    match s {
        "uniform" => Ok(Selection::Uniform),
        "power" => Ok(Selection::Power),
        _ => Err(format!("`{s}` is none of uniform, power")),
    }
}

pub fn sampling(s: &str) -> Result<Sampling, String> {
    match s {
        "uniform" => Ok(Sampling::Uniform),
        "cosine" => Ok(Sampling::Cosine),
        "bsdf" => Ok(Sampling::Bsdf),
        _ => Err(format!("`{s}` is none of uniform, cosine, bsdf")),
    }
}
