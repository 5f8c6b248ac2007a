//! The largest contributions to one slot of a film, over all pixels. They show how heavy the tail of the contributions is.
//!
//! ```text
//! k̂ = min over q of (1/q) Σ_{i ≤ q} ln(x_(i)/x_(q+1))          x_(1) ≥ x_(2) ≥ …,  q = 63, 31, 15
//! n₄ = (Σ x²)² / Σ x⁴,      Σ x⁴ ≤ Σ_{i ≤ M} x_(i)⁴ + x_(M)² (Σ x² − Σ_{i ≤ M} x_(i)²)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x | r + g + b of one contribution | [`Largest`] |
//! | M | number of contributions that are kept | [`KEPT`] |
//! | k̂ | tail index: P(x > t) falls like t^(−1/k), so that the variance is finite for k < 1/2, the mean for k < 1 | [`Largest::tail`] |
//! | n₄ | number of equal events that would determine the variance as well as these contributions; here a lower bound | [`Largest::spread`] |
//!
//! The M largest of all contributions are kept, in whatever order they came. So the result is the same for any number of
//! threads.
//! Reference: Hill, *Annals of Statistics* 3 (1975); the choice of q: Vehtari, Simpson, Gelman, Yao and Gabry, *Pareto smoothed
//! importance sampling* (2024).

use std::sync::atomic::{AtomicU32, Ordering};

/// M, the number of contributions that are kept.
pub const KEPT: usize = 64;
/// With fewer contributions above the threshold, the tail index is only noise.
const LEAST: usize = 8;

/// The largest contributions so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Largest {
    /// At most 2 M values, the M largest among them.
    values: Vec<f32>,
    /// A lower bound of the M-th largest value: values that are not above it need not be kept.
    floor: f32,
    /// Number of all contributions.
    added: u64,
}

impl Largest {
    /// Takes in one contribution. [`Self::count`] counts it.
    #[inline(always)]
    pub(super) fn push(&mut self, x: f32) {
        if x > self.floor {
            self.keep(x);
        }
    }

    /// Counts `n` contributions that were pushed.
    #[inline(always)]
    pub(super) fn count(&mut self, n: u64) {
        self.added += n;
    }

    #[cold]
    fn keep(&mut self, x: f32) {
        self.values.push(x);
        if self.values.len() >= 2 * KEPT {
            self.trim();
        }
    }

    fn trim(&mut self) {
        if self.values.len() > KEPT {
            let (_, least, _) = self.values.select_nth_unstable_by(KEPT - 1, |a, b| b.total_cmp(a));
            self.floor = self.floor.max(*least);
            self.values.truncate(KEPT);
        }
    }

    /// Merges the largest contributions of another part.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.added += other.added;
        other.values.iter().for_each(|&x| self.push(x));
    }

    /// The largest contributions in falling order; at most M.
    pub fn falling(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.values.iter().map(|&x| f64::from(x)).collect();
        all.sort_by(|a, b| b.total_cmp(a));
        all.truncate(KEPT);
        all
    }

    /// The values that are kept, and the number of all contributions: enough to go on later.
    pub(crate) fn kept(&self) -> (&[f32], u64) {
        (&self.values, self.added)
    }

    /// The largest contributions as they were kept. A lower floor decides only how many smaller values are kept.
    pub(crate) fn restored(values: Vec<f32>, added: u64) -> Self {
        Self { values, floor: 0.0, added }
    }

    /// k̂; 0 if there are too few contributions to estimate it.
    ///
    /// ```
    /// use fredholm::terms::largest::Largest;
    /// // P(x > t) = t^(−1/k): the i-th of n quantiles is (n/i)^k
    /// let pareto = |k: f64| Largest::of((1..=10_000).map(|i| (10_000.0 / f64::from(i)).powf(k) as f32));
    /// assert!([0.2, 0.5, 1.0].iter().all(|k| (pareto(*k).tail() - k).abs() < 0.1 * k));
    /// assert_eq!(Largest::of((0..1000).map(|_| 3.0)).tail(), 0.0);
    /// ```
    pub fn tail(&self) -> f64 {
        let x = self.falling();
        let most = ((self.added / 5) as usize).min(x.len().saturating_sub(1));
        if most < LEAST {
            return 0.0;
        }
        let hill = |q: usize| x[..q].iter().map(|v| (v / x[q]).ln()).sum::<f64>() / q as f64;
        // a true tail looks the same from every threshold; a gap between bright and dim contributions, as with a lamp in
        // view, resembles a tail from one threshold only
        [most, most / 2, most / 4].into_iter().filter(|&q| q >= LEAST).map(hill).fold(f64::INFINITY, f64::min)
    }

    /// n₄, where `square` is Σ x² of all contributions; 0 if there is none.
    pub fn spread(&self, square: f64) -> f64 {
        let x = self.falling();
        let (two, four) = x.iter().fold((0.0, 0.0), |s, v| (s.0 + v * v, s.1 + v.powi(4)));
        let rest = if x.len() < KEPT { 0.0 } else { x[KEPT - 1].powi(2) * (square - two).max(0.0) };
        if square > 0.0 { square * square / (four + rest) } else { 0.0 }
    }

    /// The largest of the given contributions.
    pub fn of(all: impl Iterator<Item = f32>) -> Self {
        let mut largest = Self::default();
        for x in all {
            largest.push(x);
            largest.count(1);
        }
        largest
    }

    /// The present floors, slot by slot. Values that are not above a floor need not be kept.
    pub(crate) fn floors(all: &[Self]) -> Vec<AtomicU32> {
        all.iter().map(|l| AtomicU32::new(l.floor.to_bits())).collect()
    }

    /// Starts with a floor that other blocks have found: values that are not above it are not among the largest.
    pub(crate) fn above(floor: &AtomicU32) -> Self {
        Self { floor: f32::from_bits(floor.load(Ordering::Relaxed)), ..Self::default() }
    }

    /// Raises the shared floor. The order in which blocks do so decides only which smaller values they skip, never which
    /// values are the largest.
    pub(crate) fn tell(&self, floor: &AtomicU32) {
        // the bit patterns of non-negative numbers have the order of the numbers
        floor.fetch_max(self.floor.to_bits(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(n: u32) -> impl Iterator<Item = f32> {
        (0..n).map(|i| (i.wrapping_mul(2_654_435_761) % 10_007) as f32)
    }

    #[test]
    fn the_largest_are_the_largest_in_whatever_parts_they_come() {
        let whole = Largest::of(numbers(5000));
        let mut all: Vec<f64> = numbers(5000).map(f64::from).collect();
        all.sort_by(|a, b| b.total_cmp(a));
        assert_eq!(whole.falling(), all[..KEPT]);
        let values: Vec<f32> = numbers(5000).collect();
        let floor = AtomicU32::new(0);
        let mut merged = Largest::default();
        for part in values.chunks(317).rev() {
            let mut one = Largest::above(&floor);
            for &x in part {
                one.push(x);
                one.count(1);
            }
            one.tell(&floor);
            merged.merge(&one);
        }
        assert_eq!(merged.falling(), whole.falling());
        assert_eq!(merged.tail(), whole.tail());
    }

    #[test]
    fn equal_events_carry_the_variance_as_they_carry_the_mean() {
        let equal = Largest::of((0..1000).map(|_| 2.0));
        assert!((equal.spread(4000.0) - 1000.0).abs() < 1e-9);
        // one bright event among a thousand dim ones carries the variance alone
        let one = Largest::of((0..1000).map(|i| if i == 7 { 1e4 } else { 1.0 }));
        assert!((one.spread(1e8 + 999.0) - 1.0).abs() < 1e-3);
        assert_eq!(Largest::default().spread(0.0), 0.0);
    }
}
