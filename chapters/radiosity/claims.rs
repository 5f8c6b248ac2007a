//! The statements of chapter 7, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::{LAST, Measured, Value};
use fredholm::report::book::Claim;
use fredholm::report::text::number::{plus_minus, significant};

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    let value = |(x, s): Value| plus_minus(x, s, 1);
    // two results agree if their difference and three of its standard errors are small
    let apart = |(x, s): Value, (y, t): Value| ((x - y).abs() + 3.0 * s.hypot(t)) / y;
    let rows = m.row_sums.map(|sum| (1.0 - sum).abs()).into_iter().fold(0.0, f64::max);
    let [there, back] = m.exchange;
    let powers = (1..=LAST).map(|k| apart((m.matrix[1][k], 0.0), m.paths[k])).fold(0.0, f64::max);
    let products = |i: usize, error: f64| m.histories[i].reaches(error).map_or(f64::NAN, |p| p.applications);
    let (sweeps, predicted) = (products(0, 1e-10) - products(0, 1e-4), 1e-6f64.ln() / m.radius.ln());
    let [jacobi, seidel, cg] = [0, 1, 2].map(|i| products(i, 1e-6));
    let (p, [weighted, _]) = (m.order, &m.ratios);
    let rises = weighted.windows(2).all(|r| r[1] > r[0] * (1.0 - 1e-9));
    let top = weighted.iter().copied().fold(0.0, f64::max) / m.radius;

    let exchange = format!("{} and {} m²", value(there), value(back));
    let faster = format!("{jacobi}, {seidel} and {cg} to an error of 10⁻⁶");
    let powers_found = format!("to {}, with 3 standard errors", percent(powers));
    let same = format!("to {:.0e} in 30 sweeps", m.sweeps_apart);
    let order = format!("p = {p:.2}, error {:.1e} on the finest mesh", m.mesh[2].1);
    vec![
        claim("in a closed room the rows of F sum to 1, to 10⁻⁶", format!("to {rows:.0e}"), rows < 1e-6),
        claim("rays from i and rays from j give the same A_i F_ij, to 5 %", exchange, apart(there, back) < 0.05),
        claim("T_h^k E is the term k of the paths, to 5 %, for k = 1 to 6", powers_found, powers < 0.05),
        claim("Jacobi's iterates are the partial sums, up to rounding", same, m.sweeps_apart < 1e-13),
        claim(
            "r(T_h) predicts the sweeps for six more digits, to 2 sweeps",
            format!("{sweeps} sweeps, predicted {predicted:.1}"),
            (sweeps - predicted).abs() < 2.0,
        ),
        claim(
            "Gauss–Seidel and conjugate gradients need less than 0.6 times the products of Jacobi",
            faster,
            seidel < 0.6 * jacobi && cg < 0.6 * jacobi,
        ),
        claim("the error of the mesh falls like h^p with 1.2 < p < 2", order, 1.2 < p && p < 2.0),
        claim(
            "in the norm ‖·‖_w the ratio of the terms never falls, and stays below r(T_h)",
            format!("it ends at {top:.6} r(T_h)"),
            rises && top < 1.0 + 1e-9,
        ),
    ]
}

pub(super) fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}
