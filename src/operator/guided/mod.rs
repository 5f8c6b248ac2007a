//! T sampled with the matrix as a guide: the continuous walk looks where the discrete solution is bright.
//!
//! ```text
//! (T L)(x, ω) = E[ f cos θ · L / p ]        p(ω') = cos θ'/π · r_i(ω'),        r_i ≈ β + (1 − β) L_h(x_i, ω')/mean
//! ```
//!
//! With p in proportion to f cos θ L the weight would be the same for every direction: the zero-variance walk. L_h is the
//! radiosity solution seen from patch i, which knows where the light is but not how the surface shines; so the table
//! replaces the cosine at Lambertian surfaces, and all others scatter by their BSDF as before. The density of a direction is
//! a property of the direction alone, whatever patches lie along it, so p is exact and the estimate unbiased, however wrong
//! L_h is. Both densities of a [`Step`] are those of p, and techniques weigh as ever.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_h | radiance of the patches, from stored rays | [`incident`] |
//! | r_i, β | density over that of the cosine, share of the BSDF | [`warp`] |
//! | i(x) | the patch of a point | [`Guide::at`] |
//! | u | reflected part of L_h, for roulette by expected contribution | [`Transport::expected`] |
//! | f → ρ | what stands for surfaces that are not Lambertian, in the guide only | [`stand_in()`] |
//!
//! References: Lafortune and Willems, *A 5D tree to reduce the variance of Monte Carlo ray tracing* (1995); Vorba et al., *On-line
//! learning of parametric mixture models for light transport simulation* (2014); Müller, Gross, Novák, *Practical Path
//! Guiding* (2017): there the guide is learned from paths, here it is a matrix.

pub mod incident;
mod places;
pub mod warp;

use super::scene_transport::SceneTransport;
use super::transport::{self, Samples, Seen, Sensor, Step, Transport};
use crate::math::{Columns, Key, Rgb, Rng, Streams};
use crate::operator::patches::Patches;
use crate::scene::bsdf::{Bsdf, Sampling, diffuse, diffuse::Diffuse};
use crate::scene::{Camera, Scene, SceneError, Vertex, VertexWave, connection, numbers, stand_in};
use glam::Vec3;
use incident::{Fineness, Incident};
use places::{Found, Places};
use std::sync::atomic::AtomicBool;
use warp::Warp;

/// How a guide is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// About how many patches.
    pub patches: usize,
    /// How many cells and rays each of them has.
    pub fineness: Fineness,
    /// β, the share of the BSDF; 1 is no guide.
    pub bsdf: f64,
    /// Whether rays have to look for the lamps too: where nothing connects to them.
    pub emission: bool,
}

impl Default for Recipe {
    fn default() -> Self {
        let fineness = Fineness { rays: 64, connections: 64 };
        Self { patches: 1000, fineness, bsdf: 0.2, emission: false }
    }
}

/// A density of directions for every patch.
pub struct Guide {
    patches: Patches,
    warps: Vec<Option<Warp>>,
    places: Places,
    /// Reflected radiance of each patch, mean of the channels.
    reflected: Vec<f32>,
}

impl Guide {
    /// Meshes the scene, sends the rays, solves, and makes the tables; nothing when stopped. `advance` is called once per
    /// patch, of which `begin` tells the number.
    ///
    /// # Errors
    /// If the scene cannot be meshed ([`Patches::new`]).
    pub fn new(
        description: &crate::scene::Description,
        recipe: Recipe,
        key: Key,
        begin: impl FnOnce(usize),
        advance: &(dyn Fn() + Sync),
        stop: &AtomicBool,
    ) -> Result<Option<Self>, SceneError> {
        let lambertian = stand_in(description);
        let scene = Scene::new(&lambertian);
        let patches = Patches::new(&crate::scene::Description { lights: vec![], ..lambertian }, recipe.patches)?;
        begin(patches.len());
        let transport = SceneTransport::new(&scene);
        let Some(incident) = Incident::new(&transport, &patches, recipe.fineness, key, advance, stop) else {
            return Ok(None);
        };
        let mut light = incident.radiance();
        let reflected = light.iter().map(|u| u.element_sum() / 3.0).collect();
        if recipe.emission {
            light.iter_mut().zip(patches.iter()).for_each(|(u, p)| *u += p.emission.as_vec3());
        }
        let warp = |i| Warp::new(&incident.weights(i, &light), recipe.bsdf);
        let warps = (0..patches.len()).map(warp).collect();
        Ok(Some(Self { warps, places: Places::new(&patches), patches, reflected }))
    }

    /// How many patches.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Never true: an empty scene has no mesh.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// The density at a point of a surface; nothing where the cosine is as good.
    #[inline(always)]
    pub fn at(&self, x: &Vertex) -> Option<&Warp> {
        self.warps[self.patch(x)?].as_ref()
    }

    #[inline(always)]
    fn patch(&self, x: &Vertex) -> Option<usize> {
        if !x.on_surface() {
            return None;
        }
        match self.places.find(x) {
            Found::At(patch) => Some(patch as usize),
            Found::Nowhere => None,
            Found::Curved => incident::locate(&self.patches, x),
        }
    }
}

/// A scene whose Lambertian surfaces scatter as a guide says.
#[derive(Clone, Copy)]
pub struct GuidedTransport<'a> {
    /// The walk without a guide.
    pub scene: SceneTransport<'a>,
    /// Where to look.
    pub guide: &'a Guide,
}

impl GuidedTransport<'_> {
    /// The density at x, and the albedo there, where scattering is guided.
    #[inline(always)]
    fn warp(&self, at: &Vertex) -> Option<(Rgb, &Warp)> {
        match self.scene.scene.bsdf(at) {
            Bsdf::Diffuse(Diffuse { reflectance })
                if reflectance != Rgb::ZERO && self.scene.sampling != Sampling::Uniform =>
            {
                Some((reflectance, self.guide.at(at)?))
            }
            _ => None,
        }
    }

    /// Density of scattering over that of the BSDF.
    #[inline(always)]
    fn ratio(&self, at: &Vertex, to: Vec3) -> f32 {
        self.warp(at).map_or(1.0, |(_, warp)| warp.ratio(at.n, to))
    }
}

impl Transport for GuidedTransport<'_> {
    type State = Vertex;
    type Wave = VertexWave;

    fn emission(&self, at: &Vertex) -> Rgb {
        self.scene.emission(at)
    }

    fn scatter(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let Some((reflectance, warp)) = self.warp(at) else { return self.scene.scatter(at, rng) };
        let u = rng.four();
        let (u, ratio) = warp.sample([u[0], u[1]]);
        let (direction, weight, pdf) = diffuse::sample(reflectance, at.n, self.scene.sampling, u);
        let scene = self.scene.scene;
        let state = scene.look(scene.lift(at.p, at.n), direction)?;
        Some(self.scene.step(at.p, state, weight * (1.0 / ratio), pdf * ratio, false))
    }

    fn connect(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let step = self.scene.connect(at, rng)?;
        if step.other_pdf == 0.0 {
            return Some(step);
        }
        // the state leaves the light towards x
        Some(Step { other_pdf: step.other_pdf * self.ratio(at, -step.state.omega), ..step })
    }

    fn albedo(&self, at: &Vertex) -> Rgb {
        self.scene.albedo(at)
    }

    /// What the matrix says of a Lambertian surface; of others it knows nothing.
    fn expected(&self, at: &Vertex) -> Option<f32> {
        let lambertian = matches!(self.scene.scene.bsdf(at), Bsdf::Diffuse(_));
        Some(self.guide.reflected[self.guide.patch(at).filter(|_| lambertian)?])
    }

    fn connects_to_all(&self) -> bool {
        self.scene.connects_to_all()
    }

    fn emission_wave(&self, wave: &mut VertexWave, n: usize, value: &mut Columns) {
        self.scene.emission_wave(wave, n, value);
    }

    /// The tables one by one, all else as without a guide; the same bits as the default.
    fn connect_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples) {
        if !self.scene.scene.in_packets() {
            return transport::connect_one_by_one(self, wave, streams, out);
        }
        let n = streams.len();
        numbers(streams, &mut wave.rays.u);
        self.scene.scene.light_points(&mut wave.rays, n);
        for i in 0..n {
            let at = wave.get(i);
            let (to, _, cos_x, cos_y) = connection(at.p, at.n, wave.rays.o.get(i), wave.rays.d.get(i));
            let faces = cos_x > 0.0 && cos_y > 0.0;
            out.other_pdf[i] = if faces { self.ratio(&at, to) } else { 1.0 };
        }
        self.scene.connect_packets(wave, n, out, |out, i| out.other_pdf[i]);
    }

    fn scatter_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples, alive: &mut Vec<u32>) {
        if !self.scene.scene.in_packets() || self.scene.sampling == Sampling::Uniform {
            return transport::scatter_one_by_one(self, wave, streams, out, alive);
        }
        let n = streams.len();
        numbers(streams, &mut wave.rays.u);
        for i in 0..n {
            let warp = self.warp(&wave.get(i));
            let u = [wave.rays.u[0][i], wave.rays.u[1][i]];
            let (u, ratio) = warp.map_or((u, 1.0), |(_, warp)| warp.sample(u));
            [wave.rays.u[0][i], wave.rays.u[1][i]] = u;
            out.pdf[i] = ratio;
        }
        self.scene.scatter_packets(wave, n, out, alive, |out, i| out.pdf[i]);
    }
}

impl Sensor<GuidedTransport<'_>> for Camera {
    fn size(&self) -> [u32; 2] {
        self.size
    }
    fn start(&self, t: &GuidedTransport, pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        self.start(&t.scene, pixel, rng)
    }
    fn project(&self, t: &GuidedTransport, at: &Vertex) -> Option<Seen<Vertex>> {
        self.project(&t.scene, at)
    }
    fn density(&self, t: &GuidedTransport, at: &Vertex) -> f32 {
        self.density(&t.scene, at)
    }
    fn sees(&self, t: &GuidedTransport, at: &Vertex) -> bool {
        self.sees(&t.scene, at)
    }
    fn start_wave(&self, t: &GuidedTransport, wave: &mut VertexWave, streams: Streams, alive: &mut Vec<u32>) {
        self.start_wave(&t.scene, wave, streams, alive);
    }
}
