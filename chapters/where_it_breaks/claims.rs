//! The statements of chapter 16, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::{Measured, corner::Corner, dimension::LAST};
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::significant;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    let slopes: Vec<Number> = m.dimension.independent[1..].iter().filter_map(|c| c.slope()).map(slope).collect();
    let straight = slopes.len() == LAST && slopes.iter().all(|b| b.is(-1.0, 0.1));
    let [first, last] = [1, 4].map(|k| m.dimension.gain(k));
    let (b, tail) = (growth(&m.corner), m.corner.tail);
    let bounded = m.corner.places.iter().map(|p| p.square[1]).all(|x| below(x, 1.0));
    let [eye, light] = m.caustic.t3;
    let never = below(eye, 0.01 * light.value) && m.caustic.note.is_some();
    let kept = m.mirrors.norm.iter().all(|x| x.is(1.0 / 6.0, 0.06 / 6.0));
    let rough = m.mirrors.uneven.iter().all(|u| (u / 6.0 - 1.0).abs() < 0.06);
    let [mirror, diffuse] = [&m.mirrors, &m.diffuse].map(|room| room.uneven.last().copied().unwrap_or(f64::NAN));
    let [same, crossed, mean] = [m.brewster.same, m.brewster.crossed, m.brewster.mean].map(|x| x / m.brewster.scalar);
    let near = |x: f64, exact: f64| (x - exact).abs() < 1e-4;
    let own = m.own;
    vec![
        claim(
            "with independent samples, V of T E to T⁴E falls like N⁻¹, to ± 0.1 in the exponent",
            format!("exponents {}", list(&slopes)),
            straight,
        ),
        claim(
            "Sobol points divide V of TE by more than 3, and V of T⁴E by less than 1.5",
            format!("{first} and {last}"),
            above(first, 3.0) && below(last, 1.5),
        ),
        rare(m),
        claim(
            "connections to a lamp that touches the wall: E[X²] grows like d⁻², to ± 0.25; by MIS it stays below (ρE)²",
            format!("exponent {b}"),
            b.is(-2.0, 0.25) && bounded,
        ),
        claim(
            "over the whole wall their tail index is 2/3, to ± 0.15: the variance is infinite",
            format!("k̂ = {tail}"),
            tail.is(2.0 / 3.0, 0.15) && above(tail, 0.5),
        ),
        claim(
            "of T³E below a glass ball under a point light, paths from the eye find less than 1 %, and the program says which light \
             they cannot find",
            format!("{eye} from the eye, {light} from the light, W sr⁻¹ m⁻²"),
            never && above(light, 0.0),
        ),
        claim(
            "between mirrors of albedo 1, norm and unevenness of TᵏE stay the same up to k = 16, to 6 %; between diffuse \
             walls TᵏE becomes even",
            format!("unevenness {}, diffuse {}", significant(mirror, 3), significant(diffuse, 4)),
            kept && rough && diffuse < 1.1,
        ),
        claim(
            "two reflections at Brewster's angle leave 2 F² in one plane, nothing in crossed planes, F² on average",
            format!("{same:.5}, {crossed:.5} and {mean:.5} times F²"),
            near(same, 2.0) && near(crossed, 0.0) && near(mean, 1.0),
        ),
        claim(
            "light with all albedos 20 % too low fulfils its own equation to 10⁻¹², and a third of the reflected light is missing",
            format!(
                "residual {:.0e}, in the right equation {:.2}; missing {:.0} %",
                own.own,
                own.right,
                100.0 * own.deficit
            ),
            own.own < 1e-12 && own.right > 1e-2 && own.deficit > 1.0 / 3.0,
        ),
    ]
}

/// Runs that look for a rare event.
fn rare(m: &Measured) -> Claim {
    let (few, many) = (m.rare[0], m.rare[m.rare.len() - 1]);
    let missed = m.rare.iter().all(|row| row.none.is(row.predicted, 0.1));
    let silent = m.rare.iter().filter(|row| row.expected <= 10).all(|row| row.printed.value == 0.0);
    Claim {
        says: "N samples miss an event with probability (1 − p)ᴺ, to ± 0.1; with one expected event the 95 % interval covers less \
               than 75 % and no error is printed; with 100 it covers 95 %, to ± 6 %",
        found: format!("missed {} of e⁻¹, covered {} and {}", few.none, few.covered, many.covered),
        holds: missed && silent && below(few.covered, 0.75) && many.covered.is(0.95, 0.06),
    }
}

/// A number that fails every comparison.
pub(super) const UNKNOWN: Number = Number { value: f64::NAN, std_error: f64::NAN };

/// The exponent b of E[X²] ∝ d^b by connections, from the distances 1/8 and 1/32.
pub(super) fn growth(corner: &Corner) -> Number {
    let at = |d: f64| corner.places.iter().find(|p| p.d == d).map_or(UNKNOWN, |p| p.square[0]);
    let ratio = at(1.0 / 32.0).over(at(1.0 / 8.0));
    Number { value: -ratio.value.ln() / 4f64.ln(), std_error: ratio.std_error / ratio.value / 4f64.ln() }
}

/// A fitted exponent with its error.
pub(super) fn slope(s: fredholm::stats::Slope) -> Number {
    Number { value: s.slope, std_error: s.std_error }
}

fn list(numbers: &[Number]) -> String {
    numbers.iter().map(|n| n.to_string()).collect::<Vec<_>>().join(", ")
}

fn below(x: Number, bound: f64) -> bool {
    x.value + 5.0 * x.std_error < bound
}

fn above(x: Number, bound: f64) -> bool {
    x.value - 5.0 * x.std_error > bound
}
