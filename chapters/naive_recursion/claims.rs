//! The statements of chapter 5, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::figures::{percent, times};
use super::{CHILDREN, K, Measured, Value, price};
use fredholm::report::book::Claim;
use fredholm::report::text::number::significant;

// ANCHOR: claims
/// The statements of the text. Margins are four standard errors, five for the means.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let powers = CHILDREN.map(|n| [0, 1, 2, 3, 4].map(|k| u64::from(n).pow(k)));
    let exact = 0.06 * (1.0 + 0.6 + 0.36 + 0.216); // T^k E = 0.06 · 0.6^(k−1) on the sphere
    let largest = |of: &dyn Fn(&Value) -> f64| m.sphere.iter().map(of).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    let (off, noise) = (largest(&|[l, se]| (l - exact).abs() / se), largest(&|[_, se]| se / exact));
    let rays = m.trees[3].rays[K] / m.trees[3].rays.iter().sum::<f64>();
    let light = m.trees[0].mean[K] / m.trees[0].mean[1..=K].iter().sum::<f64>();
    let whole = [1, 2, 3].map(|i| price(&m.trees, i, K + 1));
    let deep = [2, 3, 4].map(|k| price(&m.trees, 3, k));
    let small = price(&m.direct[0], 2, 1);
    let [[v_1, se_1], [v_8, se_8]] = [0, 3].map(|i| m.direct[1][i].variance[1]);
    let left = [v_8 / v_1, v_8 / v_1 * (se_8 / v_8).hypot(se_1 / v_1)];
    let above = |values: &[Value], limit: f64| values.iter().all(|[v, se]| v - 4.0 * se > limit);
    let claim = |holds, says, found| Claim { says, found, holds };
    let list = |values: [Value; 3]| values.map(times).join(", ");
    let means = format!("off by at most {} standard errors; these are at most {}", significant(off, 2), percent(noise));
    let shares = format!("{} of the rays, {} of the reflected light", percent(rays), percent(light));
    vec![
        claim(
            m.counted == powers,
            "in the furnace, depth k has exactly Nᵏ rays",
            format!("{:?} for N = 8", m.counted[3]),
        ),
        claim(off < 5.0 && noise < 0.05, "naive recursion has the right mean for every N", means),
        claim(rays > 0.8 && light < 0.15, "with N = 8, most rays go to k = 4, which holds little light", shares),
        claim(above(&whole, 1.0), "all terms in one tree: N = 2, 4, 8 need more rays than N = 1", list(whole)),
        claim(above(&deep, 1.5), "k = 2, 3, 4 alone: N = 8 needs over 1.5 times the rays of N = 1", list(deep)),
        claim(small[0] + 4.0 * small[1] < 1.0, "k = 1 alone, small pixels: N = 4 needs fewer rays", times(small)),
        claim(above(&[left], 1.0 / 3.0), "k = 1, large pixels: N = 8 leaves over ⅓ of the variance", times(left)),
    ]
}
// ANCHOR_END: claims
