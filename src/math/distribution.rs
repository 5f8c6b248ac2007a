//! Sampling of one entry out of many with given weights. The uniform numbers u are multiples of 2⁻²⁴.
//!
//! ```text
//! pᵢ = nᵢ / N      N = 2²⁴      Σ nᵢ = N      nᵢ = [wᵢ > 0] + ⌊(N − m) Wᵢ₊₁/W⌉ − ⌊(N − m) Wᵢ/W⌉
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | wᵢ | weight of entry i, on any scale | argument of [`Discrete::new`] |
//! | Wᵢ, W | w₀ + … + wᵢ₋₁, and the sum of all weights | – |
//! | m | number of positive weights | – |
//! | N | number of different values of u | [`Discrete::NUMBERS`] |
//! | nᵢ | number of values of u that choose entry i | – |
//! | pᵢ | probability of entry i, exact in `f32` | [`Discrete::probability`] |
//!
//! A uniform number u is an integer j < N divided by N. Entry i is chosen by exactly nᵢ of the N values of u, so pᵢ = nᵢ/N
//! is exact. Only the proportion of p to w is rounded, which costs variance but adds no bias: pᵢ = (1 − m/N) wᵢ/W + 1/N with
//! an error of at most 1/N. An entry of weight 0 is never chosen. An entry of positive weight can always be chosen, however
//! small the weight. A single entry has p = 1. The probabilities of m equal weights differ by at most 1/N, and are equal if
//! m divides N.
//!
//! **The rest of u is used again.** After the choice, the rest of u is uniform within the chosen entry. The nᵢ numbers of
//! the entry become the centres of nᵢ equal parts of the unit interval. They are shifted down by 2⁻²⁵, because u itself is:
//! the numbers 0, …, 1 − 2⁻²⁴ have the mean ½ − 2⁻²⁵. So a single entry returns u unchanged, and the rest never reaches 1.
//! An entry of probability p has pN different positions. A function of bounded variation V inside the entry is therefore
//! integrated with an error of at most V/N from p times its mean. In two dimensions row and column use one number each, 48
//! bits together.
//!
//! References: inversion over rows and columns: Matt Pharr, Wenzel Jakob and Greg Humphreys, *Physically Based Rendering*
//! (4th ed. 2023), ch. 2 and appendix A; a uniform part that keeps every positive weight possible: Tim Hesterberg, *Weighted
//! average importance sampling and defensive mixture distributions*, Technometrics 37 (1995).

/// A discrete distribution over numbered entries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Discrete {
    /// Partial sums n₀ + … + nᵢ: the integers j from `ends[i − 1]` up to `ends[i]` choose entry i.
    ends: Vec<u32>,
}

impl Discrete {
    /// N: the number of different values of u, and the largest allowed number of positive weights.
    pub const NUMBERS: u32 = 1 << 24;

    /// A distribution with probabilities in proportion to `weights`; `None` if no weight is positive.
    ///
    /// ```
    /// use fredholm::math::distribution::Discrete;
    /// let d = Discrete::new(&[3.0, 0.0, 1.0]).unwrap();
    /// assert_eq!(d.sample(0.375), (0, 0.5));
    /// assert_eq!(d.sample(0.75).0, 2);
    /// assert_eq!([0, 1, 2].map(|i| d.probability(i)), [0.75, 0.0, 0.25]);
    /// ```
    ///
    /// # Panics
    /// If a weight is negative or NaN, their sum is not finite, or more than [`Self::NUMBERS`] are positive.
    pub fn new(weights: &[f64]) -> Option<Self> {
        assert!(weights.iter().all(|&w| w >= 0.0), "a negative weight");
        // the same order of summation as below, so that the last share is exactly 1
        let total = weights.iter().fold(0.0, |sum, w| sum + w);
        assert!(total.is_finite(), "the weights are too large");
        let positive = weights.iter().filter(|&&w| w > 0.0).count();
        assert!(positive <= Self::NUMBERS as usize, "{positive} positive weights");
        let shared = f64::from(Self::NUMBERS - positive as u32);
        let (mut sum, mut before) = (0.0, 0u32);
        let ends = weights.iter().map(|&w| {
            sum += w;
            before += u32::from(w > 0.0);
            before + (sum / total * shared).round() as u32
        });
        (positive > 0).then(|| Self { ends: ends.collect() })
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Always false: a distribution has at least one entry.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The integers j that choose entry i: the first one, and how many there are (nᵢ).
    fn numbers(&self, i: usize) -> (u32, u32) {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        (start, self.ends[i] - start)
    }

    /// The entry that u in [0, 1) chooses, and the rest of u, rescaled to [0, 1).
    pub fn sample(&self, u: f32) -> (usize, f32) {
        let j = (u * Self::NUMBERS as f32) as u32;
        let i = self.ends.partition_point(|&end| end <= j);
        let (start, n) = self.numbers(i);
        let centre = (f64::from(j - start) + 0.5) / f64::from(n);
        (i, (centre - 0.5 / f64::from(Self::NUMBERS)) as f32)
    }

    /// pᵢ: the probability of entry i.
    pub fn probability(&self, i: usize) -> f32 {
        self.numbers(i).1 as f32 / Self::NUMBERS as f32
    }
}

/// A discrete distribution over the cells of a table: first a row is chosen, then a column in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    rows: Discrete,
    /// The distribution within each row; `None` for a row of zeros.
    columns: Vec<Option<Discrete>>,
}

impl Table {
    /// A distribution with probabilities in proportion to `weight(column, row)`; `None` if no weight is positive. `size` is
    /// `[columns, rows]`.
    ///
    /// # Panics
    /// As [`Discrete::new`], for each row and for the sums of rows.
    pub fn new(size: [u32; 2], weight: impl Fn(u32, u32) -> f64) -> Option<Self> {
        let (mut sums, mut columns) = (vec![], vec![]);
        for row in 0..size[1] {
            let weights: Vec<f64> = (0..size[0]).map(|column| weight(column, row)).collect();
            sums.push(weights.iter().sum());
            columns.push(Discrete::new(&weights));
        }
        Some(Self { rows: Discrete::new(&sums)?, columns })
    }

    /// The chosen cell `[column, row]` and the position in it, in [0, 1)²: `u[0]` chooses the column, `u[1]` the row.
    pub fn sample(&self, u: [f32; 2]) -> ([u32; 2], [f32; 2]) {
        let (row, v) = self.rows.sample(u[1]);
        // a chosen row has a positive weight
        let (column, u) = self.columns[row].as_ref().map_or((0, u[0]), |c| c.sample(u[0]));
        ([column as u32, row as u32], [u, v])
    }

    /// The probability of a cell.
    pub fn probability(&self, [column, row]: [u32; 2]) -> f32 {
        let columns = &self.columns[row as usize];
        columns.as_ref().map_or(0.0, |c| c.probability(column as usize)) * self.rows.probability(row as usize)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const N: u32 = Discrete::NUMBERS;

    /// Tries all N values of u: every entry is chosen exactly as often as its probability says, and the rest of u is evenly
    /// spread.
    fn check_every_number(weights: &[f64]) {
        let d = Discrete::new(weights).unwrap();
        let (mut hits, mut sums) = (vec![0u32; weights.len()], vec![0.0f64; weights.len()]);
        let mut last = (0, -1.0);
        for j in 0..N {
            let (i, rest) = d.sample(j as f32 / N as f32);
            assert!((0.0..1.0).contains(&rest), "{j}: {rest}");
            assert!(i > last.0 || (i == last.0 && rest > last.1), "{j}: the order is kept, no value comes twice");
            last = (i, rest);
            hits[i] += 1;
            sums[i] += f64::from(rest);
        }
        let (total, positive) = (weights.iter().sum::<f64>(), weights.iter().filter(|&&w| w > 0.0).count());
        for (i, &w) in weights.iter().enumerate() {
            let n = f64::from(hits[i]);
            assert_eq!(hits[i] as f32 / N as f32, d.probability(i), "{i}");
            assert_eq!(hits[i] == 0, w == 0.0, "{i}");
            let ideal = f64::from(N - positive as u32) * w / total + f64::from(w > 0.0);
            assert!((n - ideal).abs() <= 1.0, "{i}: {n} for {ideal}");
            let mean = 0.5 - 0.5 / f64::from(N);
            assert!(hits[i] == 0 || (sums[i] / n - mean).abs() < 3e-8, "{i}: {}", sums[i] / n);
        }
    }

    #[test]
    fn every_number_there_is_chooses_as_the_probabilities_say() {
        check_every_number(&[1.0]);
        check_every_number(&[0.0, 0.0, 1e-300, 0.0]);
        check_every_number(&[0.0, 1.0, 0.0, 1e-30, 3.0, 0.0, 0.0, 1e5, 1e-9, 0.0]);
        let many: Vec<f64> = (0..5000).map(|i| f64::from((i * 7919) % 101) / 3.0).collect();
        check_every_number(&many);
        check_every_number(&[0.1; 7]);
    }

    #[test]
    fn one_entry_keeps_the_number() {
        let d = Discrete::new(&[0.0, 4.2]).unwrap();
        for j in (0..N).step_by(4097).chain([N - 1]) {
            let u = j as f32 / N as f32;
            assert_eq!(d.sample(u), (1, u));
        }
        assert_eq!([d.probability(0), d.probability(1)], [0.0, 1.0]);
    }

    #[test]
    fn equal_weights_have_equal_probabilities() {
        for m in [1, 2, 3, 4, 1000, 4096, 8191] {
            let d = Discrete::new(&vec![0.3; m]).unwrap();
            let n: Vec<u32> = (0..m).map(|i| (d.probability(i) * N as f32) as u32).collect();
            let spread = n.iter().max().unwrap() - n.iter().min().unwrap();
            assert!(spread <= u32::from(!m.is_power_of_two()), "{m}: {spread}");
        }
    }

    #[test]
    fn nothing_to_choose_is_no_distribution() {
        assert_eq!(Discrete::new(&[]), None);
        assert_eq!(Discrete::new(&[0.0, 0.0]), None);
        assert_eq!(Table::new([2, 2], |_, _| 0.0), None);
    }

    #[test]
    #[should_panic(expected = "negative")]
    fn nan_is_no_weight() {
        let _ = Discrete::new(&[1.0, f64::NAN]);
    }

    #[test]
    fn tables_multiply_and_never_choose_zero() {
        let weight =
            |column: u32, row: u32| if row == 1 || column == 2 { 0.0 } else { f64::from(1 + column + 4 * row) };
        let t = Table::new([4, 3], weight).unwrap();
        let cells = || (0..3).flat_map(|row| (0..4).map(move |column| [column, row]));
        let total: f64 = cells().map(|[c, r]| weight(c, r)).sum();
        for cell in cells() {
            let ideal = weight(cell[0], cell[1]) / total;
            assert!((f64::from(t.probability(cell)) - ideal).abs() < 3.0 / f64::from(N), "{cell:?}");
        }
        for i in 0..256 * 256 {
            let u = [(i % 256) as f32 / 256.0, (i / 256) as f32 / 256.0];
            let (cell, rest) = t.sample(u);
            assert!(weight(cell[0], cell[1]) > 0.0 && rest.iter().all(|x| (0.0..1.0).contains(x)));
        }
    }
}
