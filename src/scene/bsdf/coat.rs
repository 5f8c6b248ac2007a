//! What a dielectric coat lets through.
//!
//! ```text
//! T(μ) = 1 − E(μ)        E(ω_o) = ∫ f_coat cos θ_i dω_i = ∫∫ F G/G₁(ω_o) du₁ du₂        T̄ = 2 ∫₀¹ T(μ) μ dμ
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | μ | cosine of the direction outside | arguments |
//! | E | albedo of the coat alone; F(μ) if it is smooth | [`Coat::albedo`] |
//! | T, T̄ | what enters, from one direction and from all | [`Coat::transmittance`], [`Coat::mean`] |
//! | u | the numbers a visible normal is made of: there the integrand is smooth whatever the roughness | `integrated` |
//! | t | √μ, in which the table of a rough coat is evenly spaced and linear between its nodes | `NODES` |
//!
//! A rough coat stores an upper bound of E: a node is raised by what the chord beside it misses half-way, and T̄ is that
//! of the table itself. So nothing that is built with T gains energy, and reciprocity is exact.
//!
//! Reference: Kelemen and Szirmay-Kalos, *A Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling*
//! (Eurographics short presentations, 2001).

use super::fresnel::{Interface, hemispherical};
use super::ggx::{Microfacets, half, reflect};
use glam::Vec3;

/// Entries of the table.
const NODES: usize = 16;

/// Steps of the quadrature in u₁; half as many cover half of u₂, the rest is its mirror image.
const STEPS: usize = 64;

/// What quadrature and chords may still miss of E; of α ≥ 10⁻³ and indices from 1.05 to 3 it is at most 2.7·10⁻⁴.
const MARGIN: f64 = 3e-4;

/// A boundary that reflects, in front of something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// From the outside.
    pub interface: Interface,
    /// T̄.
    pub mean: f32,
    rough: Option<(Microfacets, [f32; NODES])>,
}

impl Coat {
    /// A coat of relative index `eta` ≥ 1: under total reflection from outside, a table would smear the critical angle.
    pub fn new(eta: f64, rough: Option<Microfacets>) -> Self {
        let interface = Interface::new(1.0, eta);
        let Some(facets) = rough else {
            return Self { interface, mean: (1.0 - hemispherical(eta)) as f32, rough: None };
        };
        let table = bounded(&interface, &facets);
        Self { interface, mean: mean(&table) as f32, rough: Some((facets, table)) }
    }

    /// The microfacets, if it is rough.
    #[inline(always)]
    pub fn facets(&self) -> Option<Microfacets> {
        self.rough.map(|(facets, _)| facets)
    }

    /// T(μ).
    #[inline(always)]
    pub fn transmittance(&self, mu: f32) -> f32 {
        let Some((_, table)) = &self.rough else { return 1.0 - self.interface.reflectance(mu) };
        let t = mu.sqrt() * (NODES - 1) as f32;
        let i = (t as usize).min(NODES - 2);
        table[i] + (table[i + 1] - table[i]) * (t - i as f32)
    }

    /// E(μ): exact if smooth, an upper bound if rough.
    #[inline(always)]
    pub fn albedo(&self, mu: f32) -> f32 {
        1.0 - self.transmittance(mu)
    }

    /// The largest E.
    pub fn max_albedo(&self) -> f32 {
        match &self.rough {
            None => 1.0,
            Some((_, table)) => 1.0 - table.iter().copied().fold(1.0, f32::min),
        }
    }

    /// f of the coat alone, sr⁻¹: zero if smooth.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some((facets, _)) = &self.rough else { return 0.0 };
        let (h, c) = half(wo, wi);
        self.interface.reflectance(c) * facets.d(h) * facets.seen(wo.z, wi.z)
    }
}

/// E(μ) of a rough coat: the midpoint rule in w = √(1 − u₁), where the long tail of the slopes is smooth too, and u₂.
fn integrated(interface: &Interface, facets: &Microfacets, mu: f64) -> f64 {
    let wo = Vec3::new((1.0 - mu * mu).sqrt() as f32, 0.0, mu as f32);
    let mut sum = 0.0;
    for i in 0..STEPS {
        let w = (i as f32 + 0.5) / STEPS as f32;
        for j in 0..STEPS / 2 {
            let u = [1.0 - w * w, (j as f32 + 0.5) / STEPS as f32];
            let wi = reflect(wo, facets.sample(wo, u));
            if wi.z > 0.0 {
                sum += f64::from(2.0 * w * interface.reflectance(half(wo, wi).1) * facets.lit(wo.z, wi.z));
            }
        }
    }
    sum / (STEPS * STEPS / 2) as f64
}

/// T at the nodes, nowhere above the true one.
fn bounded(interface: &Interface, facets: &Microfacets) -> [f32; NODES] {
    // grazing is a limit
    let at = |t: f64| integrated(interface, facets, (t / (NODES - 1) as f64).powi(2).max(1e-6));
    let nodes: [f64; NODES] = std::array::from_fn(|i| at(i as f64));
    // half-way is not quite where most is missed
    let missed: [f64; NODES - 1] =
        std::array::from_fn(|i| 1.25 * (at(i as f64 + 0.5) - 0.5 * (nodes[i] + nodes[i + 1])).max(0.0));
    std::array::from_fn(|i| {
        let beside = missed[i.saturating_sub(1)].max(missed[i.min(NODES - 2)]);
        (1.0 - nodes[i] - beside - MARGIN).max(0.0) as f32
    })
}

/// T̄ = 4 ∫₀¹ T t³ dt of a table linear in t.
fn mean(table: &[f32; NODES]) -> f64 {
    let h = 1.0 / (NODES - 1) as f64;
    let segment = |i: usize| {
        let (a, b) = (i as f64 * h, (i + 1) as f64 * h);
        let (low, high) = (f64::from(table[i]), f64::from(table[i + 1]));
        let slope = (high - low) / h;
        (low - slope * a) * (b.powi(4) - a.powi(4)) + 0.8 * slope * (b.powi(5) - a.powi(5))
    };
    (0..NODES - 1).map(segment).sum()
}
