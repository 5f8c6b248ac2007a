//! Random walks on the matrix whose steps are guided by an approximate solution. If the guide is the exact solution, they
//! have no variance.
//!
//! ```text
//! whole:     p_ij = T_ij v_j / (T v)_i          weight T_ij/p_ij = (T v)_i / v_j        q_i = E_i / (E_i + (T v)_i)
//! one term:  p_ij = T_ij x_j / (T x)_i,         x = the guide for one bounce less       ends after exactly k bounces
//! ```
//!
//! W is the weight of the walk, i and j are patches. With v = B = (I − T)⁻¹ E the absorption estimator `W E/q` equals B_i on
//! every walk. The reason: (T B)_i = B_i − E_i, so the weight of a step divided by its survival probability is B_i/B_j, and
//! the product over the steps telescopes. With x = T^{m−1} E, where m is the number of bounces left, every walk of k steps
//! gives (T^k E)_i. With an approximate guide the estimators stay unbiased, as long as v_j > 0 wherever light can come from.
//! Their variance then measures how far the guide is from the solution. This is why guiding works.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | T = diag(ρ) F | one channel of the matrix | [`PatchOperator`] |
//! | v | guide for the whole series | [`GuidedWalk::whole`] |
//! | x for m = 1, 2, … bounces left | guides for one term | [`GuidedWalk::term`] |
//! | q | probability of termination | [`Transport::absorption`] |
//!
//! References: Kahn and Marshall, *Methods of Reducing Sample Size in Monte Carlo Computations* (1953); Halton, *Sequential
//! Monte Carlo* (1962); for light transport Vorba and Křivánek, *Adjoint-Driven Russian Roulette and Splitting* (2016).

use crate::math::{Rgb, Rng};
use crate::operator::matrix::PatchOperator;
use crate::operator::transport::{Sensor, Step, Transport};

/// State of a guided walk on the matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// The patch.
    pub row: u32,
    /// Number of bounces left, if one term is estimated; 0 if the whole series is.
    pub left: u32,
}

/// A guided walk on one channel of the matrix. It finds light only by hitting emitting patches: use it with technique
/// `scatter` or with absorption.
#[derive(Clone, Debug)]
pub struct GuidedWalk<'a> {
    emission: &'a [f64],
    rho: &'a [f64],
    guides: Vec<Guide>,
}

/// One guide: v, and the partial sums of T_ij v_j along every row i. The last partial sum of row i is (T v)_i.
#[derive(Clone, Debug)]
struct Guide {
    v: Vec<f64>,
    cdf: Vec<f64>,
}

impl Guide {
    fn new(t: &PatchOperator<'_>, v: Vec<f64>) -> Self {
        let row = |i: usize| {
            let mut sum = 0.0;
            let (rho, v) = (t.rho[i], &v);
            t.factors.row(i).iter().enumerate().map(move |(j, f)| {
                sum += rho * f64::from(*f) * v[j];
                sum
            })
        };
        let cdf = (0..v.len()).flat_map(row).collect();
        Self { v, cdf }
    }

    fn row(&self, i: usize) -> &[f64] {
        let n = self.v.len();
        &self.cdf[i * n..(i + 1) * n]
    }
}

impl<'a> GuidedWalk<'a> {
    /// A walk that estimates the whole series, guided by an approximation `v` of (I − T)⁻¹ E. Memory: n² numbers for the
    /// guide, with n patches.
    pub fn whole(t: &'a PatchOperator<'a>, emission: &'a [f64], v: Vec<f64>) -> Self {
        Self { emission, rho: &t.rho, guides: vec![Guide::new(t, v)] }
    }

    /// A walk that estimates one term, guided by approximations of E, T E, T² E, …, which are the guides for 1, 2, 3, …
    /// bounces left. Memory: n² numbers for each guide.
    pub fn term(t: &'a PatchOperator<'a>, emission: &'a [f64], guides: Vec<Vec<f64>>) -> Self {
        Self { emission, rho: &t.rho, guides: guides.into_iter().map(|v| Guide::new(t, v)).collect() }
    }
}

impl Transport for GuidedWalk<'_> {
    type State = Row;
    type Wave = Vec<Row>;

    fn emission(&self, at: &Row) -> Rgb {
        Rgb::splat(self.emission[at.row as usize] as f32)
    }

    fn scatter(&self, at: &Row, rng: &mut Rng) -> Option<Step<Row>> {
        let left = at.left.saturating_sub(1);
        let guide = &self.guides[left as usize];
        let row = guide.row(at.row as usize);
        let total = *row.last()?;
        let u = rng.four();
        // two numbers of 24 bits are combined to 48 bits, so that small entries get their exact probability
        let u = (f64::from(u[0]) + f64::from(u[1]) / 16_777_216.0) * total;
        let j = row.partition_point(|&c| c <= u);
        if j == row.len() {
            return None; // no light arrives from any patch
        }
        let share = row[j] - if j == 0 { 0.0 } else { row[j - 1] };
        let (weight, pdf) = (Rgb::splat((total / guide.v[j]) as f32), (share / total) as f32);
        Some(Step { state: Row { row: j as u32, left }, weight, pdf, other_pdf: 0.0 })
    }

    /// Always `None`: a guided walk finds light only by hitting emitters.
    fn connect(&self, _: &Row, _: &mut Rng) -> Option<Step<Row>> {
        None
    }

    fn connects_to_all(&self) -> bool {
        false
    }

    /// q_i, used when the whole series is estimated.
    fn absorption(&self, at: &Row) -> Option<f32> {
        let e = self.emission[at.row as usize];
        let reach = self.guides[0].row(at.row as usize).last().copied()?;
        Some(if e > 0.0 { (e / (e + reach)) as f32 } else { 0.0 })
    }

    fn albedo(&self, at: &Row) -> Rgb {
        Rgb::splat(self.rho[at.row as usize] as f32)
    }
}

/// A sensor on the matrix: pixel i measures row i, either of term number `left`, or of the whole series if `left` is 0.
#[derive(Clone, Copy, Debug)]
pub struct GuidedRows {
    /// Number of rows.
    pub rows: u32,
    /// Number of the term to estimate; 0 for the whole series.
    pub left: u32,
}

impl Sensor<GuidedWalk<'_>> for GuidedRows {
    fn size(&self) -> [u32; 2] {
        [self.rows, 1]
    }
    fn start(&self, _: &GuidedWalk, pixel: u32, _: &mut Rng) -> Option<Row> {
        Some(Row { row: pixel, left: self.left })
    }
}
