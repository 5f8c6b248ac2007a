//! The discrete operator T = diag(ρ) F, sampled by a random walk on its rows. It connects sampling with matrices.
//!
//! `(T^k E)_i = Σ ρ_i F_ij ρ_j F_jl … E`: from row i the walk steps to row j with probability F_ij and weight ρ_i. With
//! probability 1 − Σ_j F_ij it ends.
//!
//! Every estimator that runs on this walk is compared with exact matrix powers, so that no discretisation error occurs.
//! Reference: Forsythe and Leibler, *Matrix inversion by a Monte Carlo method* (1950).
//!
//! | notation | type | meaning |
//! |---|---|---|
//! | F | `rows` | nonnegative, row sums at most 1 |
//! | ρ | `rho` | factor of a row, one per channel |
//! | E | `emission` | emission, one per row and channel |
//! | c_j | `1/(number of emitting rows)` | density with which next-event estimation chooses row j |

use super::adjoint::{Adjoint, AdjointStep, Role, Toward};
use super::kernel::{Factors, Kernel};
use super::transport::{Seen, Sensor, Step, Transport};
use crate::math::{Rgb, Rng};

/// A random walk on the rows of T = diag(ρ) F.
#[derive(Clone, Debug)]
pub struct MatrixWalk {
    n: usize,
    rows: Vec<f64>,
    /// Partial sums along each row (`cdf`) and down each column (`down`).
    cdf: Vec<f64>,
    down: Vec<f64>,
    rho: Vec<Rgb>,
    emission: Vec<Rgb>,
    emitters: Vec<usize>,
}

impl MatrixWalk {
    /// `rows` is F, row by row; `rho` and `emission` have one entry per row.
    ///
    /// # Panics
    /// If `rows` does not have n² entries or `emission` does not have n, where n is the length of `rho`.
    pub fn new(rows: Vec<f64>, rho: Vec<Rgb>, emission: Vec<Rgb>) -> Self {
        let n = rho.len();
        assert!(rows.len() == n * n && emission.len() == n, "F is {n} × {n}");
        let partial = |row: &[f64]| {
            let sums = row.iter().scan(0.0, |sum, f| {
                *sum += f;
                Some(*sum)
            });
            sums.collect::<Vec<f64>>()
        };
        let cdf = rows.chunks(n).flat_map(partial).collect();
        let column = |j: usize| (0..n).map(|i| rows[i * n + j]).collect::<Vec<_>>();
        let down = (0..n).flat_map(|j| partial(&column(j))).collect();
        let emitters = (0..n).filter(|&i| emission[i] != Rgb::ZERO).collect();
        Self { n, rows, cdf, down, rho, emission, emitters }
    }

    /// The exact terms `T^k E` for k = 0..=`k_max`: for each k one vector over the rows.
    pub fn powers(&self, k_max: usize) -> Vec<Vec<glam::DVec3>> {
        let mut terms = vec![self.emission.iter().map(|e| e.as_dvec3()).collect::<Vec<_>>()];
        for k in 0..k_max {
            let row = |i: usize| {
                let sum: glam::DVec3 = (0..self.n).map(|j| terms[k][j] * self.rows[i * self.n + j]).sum();
                sum * self.rho[i].as_dvec3()
            };
            let next = (0..self.n).map(row).collect();
            terms.push(next);
        }
        terms
    }
}

impl Transport for MatrixWalk {
    type State = u32;
    type Wave = Vec<u32>;

    fn emission(&self, &i: &u32) -> Rgb {
        self.emission[i as usize]
    }

    fn scatter(&self, &i: &u32, rng: &mut Rng) -> Option<Step<u32>> {
        let i = i as usize;
        let u = rng.four();
        // a number of 48 bits, so that small entries are chosen with their exact probability
        let u = f64::from(u[0]) + f64::from(u[1]) / 16_777_216.0;
        let j = self.cdf[i * self.n..(i + 1) * self.n].partition_point(|&c| c <= u);
        if j == self.n {
            return None;
        }
        let other_pdf = if self.emission[j] == Rgb::ZERO { 0.0 } else { 1.0 / self.emitters.len() as f32 };
        Some(Step { state: j as u32, weight: self.rho[i], pdf: self.rows[i * self.n + j] as f32, other_pdf })
    }

    fn connect(&self, &i: &u32, rng: &mut Rng) -> Option<Step<u32>> {
        let count = self.emitters.len();
        if count == 0 {
            return None;
        }
        let j = self.emitters[((rng.one() * count as f32) as usize).min(count - 1)];
        let f = self.rows[i as usize * self.n + j] as f32;
        (f > 0.0).then(|| Step {
            state: j as u32,
            weight: self.rho[i as usize] * (f * count as f32),
            pdf: 1.0 / count as f32,
            other_pdf: f,
        })
    }

    fn albedo(&self, &i: &u32) -> Rgb {
        self.rho[i as usize]
    }

    fn lit(&self) -> Rgb {
        let sum = self.emission.iter().fold(Rgb::ZERO, |a, e| a.max(*e));
        Rgb::select(sum.cmpgt(Rgb::ZERO), Rgb::ONE, Rgb::ZERO)
    }
}

/// f is the matrix entry T_ij = ρ_i F_ij, p the probability of stepping from i to j.
impl Kernel for MatrixWalk {
    fn sample_direction(&self, &i: &u32, rng: &mut Rng) -> Option<Factors<u32>> {
        let Step { state, pdf, other_pdf, .. } = self.scatter(&i, rng)?;
        Some(Factors { state, f: self.entry(i, state), cos: 1.0, pdf, pair: [pdf, other_pdf] })
    }

    fn sample_emitter(&self, &i: &u32, rng: &mut Rng) -> Option<Factors<u32>> {
        let Step { state, pdf, other_pdf, .. } = self.connect(&i, rng)?;
        Some(Factors { state, f: self.entry(i, state), cos: 1.0, pdf, pair: [pdf, other_pdf] })
    }
}

impl MatrixWalk {
    /// The entry T_ij.
    fn entry(&self, i: u32, j: u32) -> Rgb {
        self.rho[i as usize] * self.rows[i as usize * self.n + j as usize] as f32
    }

    /// The exact `((T*)^k W)_j` for k = 0..=`k_max` and an importance W per row; T* is the transpose.
    pub fn adjoint_powers(&self, importance: &[glam::DVec3], k_max: usize) -> Vec<Vec<glam::DVec3>> {
        let mut terms = vec![importance.to_vec()];
        for k in 0..k_max {
            let column =
                |j: usize| (0..self.n).map(|i| terms[k][i] * self.rho[i].as_dvec3() * self.rows[i * self.n + j]).sum();
            let next = (0..self.n).map(column).collect();
            terms.push(next);
        }
        terms
    }

    fn column(&self, j: u32) -> &[f64] {
        &self.down[j as usize * self.n..(j as usize + 1) * self.n]
    }
}

/// From row j light steps to row i with probability F_ij divided by the sum of column j.
impl Adjoint for MatrixWalk {
    fn emit(&self, rng: &mut Rng) -> Option<(u32, f32)> {
        let count = self.emitters.len();
        let j = self.emitters.get(((rng.one() * count as f32) as usize).min(count.saturating_sub(1)))?;
        Some((*j as u32, 1.0 / count as f32))
    }

    fn emit_density(&self, &j: &u32) -> f32 {
        if self.emission[j as usize] == Rgb::ZERO { 0.0 } else { 1.0 / self.emitters.len() as f32 }
    }

    fn connect_density(&self, _: &u32, at: &u32) -> f32 {
        self.emit_density(at)
    }

    fn walk(&self, at: &u32, role: Role, rng: &mut Rng) -> Option<AdjointStep<u32>> {
        if role == Role::Radiance {
            let s = self.scatter(at, rng)?;
            return Some(AdjointStep { state: s.state, weight: s.weight, density: s.pdf, delta: None });
        }
        let (u, column) = (rng.four(), self.column(*at));
        let sum = *column.last()?;
        let u = (f64::from(u[0]) + f64::from(u[1]) / 16_777_216.0) * sum;
        let i = column.partition_point(|&c| c <= u);
        let go = self.toward(at, &(i as u32), role);
        (i < self.n).then(|| AdjointStep {
            state: i as u32,
            weight: go.value * sum as f32,
            density: go.density,
            delta: None,
        })
    }

    fn toward(&self, &at: &u32, &to: &u32, role: Role) -> Toward {
        let (i, j) = (at as usize, to as usize);
        if i >= self.n || j >= self.n {
            return Toward::default();
        }
        let sum = self.column(at)[self.n - 1];
        match role {
            Role::Radiance => Toward { value: self.rho[i], density: self.rows[i * self.n + j] as f32 },
            _ => Toward {
                value: if role == Role::Flux { self.rho[i] } else { self.emission[i] },
                density: if sum > 0.0 { (self.rows[j * self.n + i] / sum) as f32 } else { 0.0 },
            },
        }
    }

    fn delta_density(&self, _: &u32, _: &u32, choice: f32) -> f32 {
        choice
    }

    fn facing(&self, at: &u32, _: &u32) -> u32 {
        *at
    }

    fn link(&self, &eye: &u32, &light: &u32) -> f32 {
        self.rows[eye as usize * self.n + light as usize] as f32
    }
}

/// A sensor with one pixel per row: pixel i estimates the value of row i. The field is the number of rows.
#[derive(Clone, Copy, Debug)]
pub struct Rows(pub u32);

impl Sensor<MatrixWalk> for Rows {
    fn size(&self) -> [u32; 2] {
        [self.0, 1]
    }
    fn start(&self, _: &MatrixWalk, pixel: u32, _: &mut Rng) -> Option<u32> {
        Some(pixel)
    }
    fn project(&self, _: &MatrixWalk, &at: &u32) -> Option<Seen<u32>> {
        Some(Seen { pixel: at, eye: at, importance: 1.0, density: 1.0 })
    }
}
