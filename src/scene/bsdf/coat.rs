//! Transmittance and albedo of a dielectric coat, smooth or rough.
//!
//! ```text
//! T(μ) = 1 − E(μ)        E(ω_o) = ∫ f_coat cos θ_i dω_i = ∫∫ F G/G₁(ω_o) du₁ du₂        T̄ = 2 ∫₀¹ T(μ) μ dμ
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | μ | cosine of the direction outside | arguments |
//! | E | albedo of the coat alone; equals F(μ) for a smooth coat | [`Coat::albedo`] |
//! | T, T̄ | fraction of the light that enters, for one direction and averaged over all | [`Coat::transmittance`], [`Coat::mean`] |
//! | u | the random numbers from which a visible normal is sampled; in u the integrand is smooth for every roughness | `integrated` |
//! | t | √μ; the table of a rough coat has equal steps in t and is linear between its nodes | `NODES` |
//!
//! F, G, G₁ and the indices o and i are those of [`super::ggx`]. The table of a rough coat stores an upper bound of E. Each
//! node is raised by the largest error that a neighbouring chord has at its midpoint. T̄ is computed from the table itself.
//! So no BSDF built with T gains energy, and reciprocity is exact.
//!
//! Reference: Kelemen and Szirmay-Kalos, *A Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling*
//! (Eurographics short presentations, 2001).

use super::fresnel::{Interface, hemispherical};
use super::ggx::{Microfacets, half, reflect};
use glam::Vec3;

/// Number of entries of the table.
const NODES: usize = 16;

/// Steps of the quadrature in u₁. Half as many cover one half of the range of u₂; the other half is its mirror image.
const STEPS: usize = 64;

/// Upper bound for the remaining error of E from quadrature and chords. For α ≥ 10⁻³ and indices from 1.05 to 3 this error
/// is at most 2.7·10⁻⁴.
const MARGIN: f64 = 3e-4;

/// A reflecting dielectric boundary in front of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// The boundary, seen from outside.
    pub interface: Interface,
    /// T̄: transmittance averaged over all directions.
    pub mean: f32,
    rough: Option<(Microfacets, [f32; NODES])>,
}

impl Coat {
    /// A coat of relative index `eta` ≥ 1. A smaller index is not supported: it has total reflection from outside, and a
    /// table would blur the critical angle.
    pub fn new(eta: f64, rough: Option<Microfacets>) -> Self {
        let interface = Interface::new(1.0, eta);
        let Some(facets) = rough else {
            return Self { interface, mean: (1.0 - hemispherical(eta)) as f32, rough: None };
        };
        let table = bounded(&interface, &facets);
        Self { interface, mean: mean(&table) as f32, rough: Some((facets, table)) }
    }

    /// The microfacets of a rough coat; `None` if the coat is smooth.
    #[inline(always)]
    pub fn facets(&self) -> Option<Microfacets> {
        self.rough.map(|(facets, _)| facets)
    }

    /// T(μ): fraction of the light that enters.
    #[inline(always)]
    pub fn transmittance(&self, mu: f32) -> f32 {
        let Some((_, table)) = &self.rough else { return 1.0 - self.interface.reflectance(mu) };
        let t = mu.sqrt() * (NODES - 1) as f32;
        let i = (t as usize).min(NODES - 2);
        table[i] + (table[i + 1] - table[i]) * (t - i as f32)
    }

    /// E(μ): exact for a smooth coat, an upper bound for a rough one.
    #[inline(always)]
    pub fn albedo(&self, mu: f32) -> f32 {
        1.0 - self.transmittance(mu)
    }

    /// The largest E over all directions.
    pub fn max_albedo(&self) -> f32 {
        match &self.rough {
            None => 1.0,
            Some((_, table)) => 1.0 - table.iter().copied().fold(1.0, f32::min),
        }
    }

    /// f of the coat alone, sr⁻¹; zero for a smooth coat.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some((facets, _)) = &self.rough else { return 0.0 };
        let (h, c) = half(wo, wi);
        self.interface.reflectance(c) * facets.d(h) * facets.seen(wo.z, wi.z)
    }
}

/// E(μ) of a rough coat, by the midpoint rule in u₂ and in w = √(1 − u₁). In w the integrand is smooth also in the long tail
/// of the slopes.
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

/// The transmittance T of the coat at the nodes of its table, lowered so that linear interpolation nowhere exceeds the exact
/// value.
fn bounded(interface: &Interface, facets: &Microfacets) -> [f32; NODES] {
    // μ = 0 is undefined, so a small μ replaces it
    let at = |t: f64| integrated(interface, facets, (t / (NODES - 1) as f64).powi(2).max(1e-6));
    let nodes: [f64; NODES] = std::array::from_fn(|i| at(i as f64));
    // the factor 1.25, because the largest error of a chord is not exactly at its midpoint
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
