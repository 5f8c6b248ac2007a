//! The statements of chapter 12, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::{DIAMOND, GLASS, Measured, fresnel};
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::significant;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    let angle = (1.0 / GLASS).asin().to_degrees();
    let f = fresnel(1.0, DIAMOND, 0.0);
    let through = (1.0 - f) / (1.0 + f);
    let furnace = m.furnace.map(|x| significant(x, 1)).join(" and ");
    vec![
        counted(m),
        claim(
            "inside glass, refraction ends at the critical angle asin(1/n), to 0.01°",
            format!("{:.4}°; the formula gives {angle:.4}°", m.critical),
            (m.critical - angle).abs() < 0.01,
        ),
        claim(
            "a plate of index 2.42 transmits (1 − F)/(1 + F), to 0.01",
            format!("{}; the formula gives {}", m.plate, significant(through, 4)),
            m.plate.is(through, 0.01),
        ),
        claim(
            "under a white sky, every pixel of a glass ball and of a glass cube is 1, to 10⁻⁴",
            format!("largest difference {furnace}"),
            m.furnace.iter().all(|&x| x < 1e-4),
        ),
        chosen(m),
        same_caustic(m),
        missed_from_the_eye(m),
        missed_from_the_light(m),
    ]
}

fn counted(m: &Measured) -> Claim {
    let off = m.angles.iter().map(|a| a.reflected.value - a.formula);
    let largest = off.fold(0.0, |a: f64, x| if x.abs() > a.abs() { x } else { a });
    Claim {
        says: "at 18 angles, the part of the samples that is reflected is F(θ), to 0.01",
        found: format!("largest difference {}", significant(largest.abs(), 1)),
        holds: m.angles.iter().all(|a| a.reflected.is(a.formula, 0.01)),
    }
}

fn chosen(m: &Measured) -> Claim {
    let [fresnel, constant] = &m.choice;
    let ratio = constant.variance.over(fresnel.variance);
    Claim {
        says: "p = 1/2 gives the mean of p = F, to 2 %, with at least ten times the variance",
        found: format!("means {} and {}, variance {ratio} times", fresnel.mean, constant.mean),
        holds: constant.mean.minus(fresnel.mean).is(0.0, 0.02 * fresnel.mean.value)
            && ratio.value - 5.0 * ratio.std_error > 10.0,
    }
}

fn same_caustic(m: &Measured) -> Claim {
    let ratio = m.caustic[0].over(m.caustic[1]);
    Claim {
        says: "of a large lamp, path tracer and light tracer find the same caustic, to 10 %",
        found: format!("{ratio} times"),
        holds: ratio.is(1.0, 0.1),
    }
}

/// Returns true if the number is above 0 by five standard errors.
fn positive(x: Number) -> bool {
    x.value > 5.0 * x.std_error
}

fn missed_from_the_eye(m: &Measured) -> Claim {
    let [path, light, _] = &m.found[1];
    let k2 = [path.floor[2], light.floor[2]];
    let part = path.floor[3].over(light.floor[3]);
    Claim {
        says: "of a point light, connections from the eye find nothing of T²E on the floor, and less than 1 % of T³E",
        found: format!("T²E: {} of {}; T³E: {} %", k2[0].value, k2[1], significant(100.0 * part.value, 2)),
        holds: k2[0].value == 0.0 && positive(k2[1]) && part.value + 5.0 * part.std_error < 0.01,
    }
}

fn missed_from_the_light(m: &Measured) -> Claim {
    let found =
        m.found.each_ref().map(|[path, light, _]| (light.ball.iter().map(|x| x.value).sum::<f64>(), path.ball[3]));
    let words = found.map(|(light, path)| format!("{light} of {path}")).join(", ");
    Claim {
        says: "walks from the light find nothing of what the eye sees in the glass",
        found: format!("T³E: {words}"),
        holds: found.iter().all(|&(light, path)| light == 0.0 && positive(path)),
    }
}
