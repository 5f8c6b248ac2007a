//! Sampling of T guided by the radiosity matrix: walks prefer directions from which the discrete solution receives much
//! light.
//!
//! ```text
//! (T L)(x, ω) = E[ f cos θ · L / p ]        p(ω') = cos θ'/π · r_i(ω'),        r_i ≈ β + (1 − β) L_h(x_i, ω')/mean
//! ```
//!
//! β is the share of plain BSDF sampling. If p were in proportion to f cos θ L, the weight would be the same for every
//! direction: this is the zero-variance walk. L_h is the radiosity solution seen from patch i. It contains where the light
//! is, but not how a glossy surface reflects it. So the table replaces the cosine only at Lambertian surfaces; all others
//! scatter by their BSDF as before. The density of a direction depends on the direction alone, not on the patches that lie
//! along it. So p is known exactly, and the estimate is unbiased however wrong L_h is.
//!
//! **Weights of the techniques.** p is a mixture, and multiple importance sampling uses only its BSDF part β cos θ/π as the
//! density that finds lamps. Hits and connections are weighed by this part against the density of the connection. The
//! estimate stays unbiased, because the two weights of a path still add up to one. The value of a hit stays bounded, because
//! r ≥ β, and a connection needs no look-up in the table. So the densities of a [`Step`] belong to the parts that can find a
//! lamp, while its weight is divided by the whole of p.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_h | radiance of the patches, computed from stored rays | [`incident`] |
//! | r_i, β | density at patch i divided by that of the cosine; share of the BSDF | [`warp`] |
//! | P_i(l) | probability that a connection from patch i chooses lamp l | `lamps` |
//! | i(x) | the patch of a point | [`Guide::at`] |
//! | T L, T (L − E) | reflected radiance of a patch, by which walks end and split | [`expected`] |
//! | f → ρ | Lambertian replacement of all other surfaces, used only to compute the guide | [`stand_in()`] |
//!
//! References: Lafortune and Willems, *A 5D tree to reduce the variance of Monte Carlo ray tracing* (1995); Vorba et al.,
//! *On-line learning of parametric mixture models for light transport simulation* (2014); Müller, Gross, Novák, *Practical
//! Path Guiding* (2017). They learn the guide from paths; here it comes from a matrix.

pub mod expected;
pub mod incident;
mod lamps;
pub mod path_tracer;
mod places;
pub mod prefix;
pub mod tracked;
pub mod walk;
pub mod warp;

pub use expected::{ByExpectation, Expected, Expecting};
pub use path_tracer::PathTracer;
pub use prefix::Prefix;
pub use walk::GuidedWalk;

use crate::math::{Columns, Key, Rgb, Rng, Streams};
use crate::operator::SceneTransport;
use crate::operator::patches::Patches;
use crate::operator::transport::{self, Samples, Seen, Sensor, Step, Transport};
use crate::progress::Progress;
use crate::scene::bsdf::{Bsdf, Sampling, diffuse, diffuse::Diffuse};
use crate::scene::{Camera, Crop, Rays, Scene, SceneError, Side, Vertex, VertexWave, numbers, offset_origin, stand_in};
use glam::Vec3;
use incident::{Fineness, Incident};
use lamps::Lamps;
use places::{Place, Places};
use warp::Warp;

/// Settings from which a guide is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Approximate number of patches.
    pub patches: usize,
    /// Number of rays and connections per patch.
    pub fineness: Fineness,
    /// β, the share of plain BSDF sampling; 1 means no guide.
    pub bsdf: f64,
    /// True if rays must find the lamps too, because no connections are made.
    pub emission: bool,
}

impl Default for Recipe {
    fn default() -> Self {
        let fineness = Fineness { rays: 16, connections: 32 };
        Self { patches: 4000, fineness, bsdf: 0.2, emission: false }
    }
}

/// Marks a patch without a table.
const NONE: u32 = u32::MAX;

/// A guide: for every patch a density of directions, a choice of lamps and the expected reflected radiance.
pub struct Guide {
    patches: Patches,
    /// The tables of directions; `tables[i]` is the number of the table of patch i, or `NONE`.
    warps: Vec<Warp>,
    tables: Vec<u32>,
    places: Places,
    lamps: Option<Lamps>,
    reflected: Vec<Expected>,
    /// β.
    bsdf: f32,
}

impl Guide {
    /// Meshes the scene, traces the rays, solves for the radiance of the patches and builds the tables. `None` if the run
    /// was stopped.
    ///
    /// # Errors
    /// If the scene cannot be meshed ([`Patches::new`]).
    pub fn new(
        description: &crate::scene::Description,
        recipe: Recipe,
        key: Key,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, SceneError> {
        let lambertian = stand_in(description);
        let scene = Scene::new(&lambertian);
        let patches = Patches::new(&crate::scene::Description { lights: vec![], ..lambertian }, recipe.patches)?;
        progress.begin(&format!("guide, {} patches", patches.len()), patches.len() as u64);
        let transport = SceneTransport::new(&scene);
        let Some(incident) = Incident::new(&transport, &patches, recipe.fineness, key, progress) else {
            return Ok(None);
        };
        let mut light = incident.radiance();
        let mean = |u: Rgb| u.element_sum() / 3.0;
        // light that connections find is no longer expected from the rest of the path; without connections all of it is
        let indirect = |u: Rgb, d: Rgb| if recipe.emission { u } else { u - d };
        let expected = |(u, d): (&Rgb, &Rgb)| Expected { all: mean(*u), indirect: mean(indirect(*u, *d)) };
        let reflected = light.iter().zip(&incident.direct).map(expected).collect();
        if recipe.emission {
            light.iter_mut().zip(patches.iter()).for_each(|(u, p)| *u += p.emission.as_vec3());
        }
        let (mut warps, mut tables) = (vec![], vec![NONE; patches.len()]);
        for (i, table) in tables.iter_mut().enumerate() {
            if let Some(warp) = Warp::new(&incident.weights(i, &light), recipe.bsdf) {
                *table = warps.len() as u32;
                warps.push(warp);
            }
        }
        let (places, lamps) = (Places::new(&patches), Lamps::new(&transport, &patches, key));
        Ok(Some(Self { warps, tables, places, lamps, patches, reflected, bsdf: recipe.bsdf as f32 }))
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Never true: an empty scene has no mesh.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// The density of directions at a point of a surface; `None` if plain cosine sampling is used there.
    #[inline(always)]
    pub fn at(&self, x: &Vertex) -> Option<&Warp> {
        self.warps.get(self.tables[self.patch(x)?] as usize)
    }

    #[inline(always)]
    fn patch(&self, x: &Vertex) -> Option<usize> {
        if x.on_surface() { self.find(x.p, x.side) } else { None }
    }

    #[inline(always)]
    fn find(&self, p: Vec3, side: Side) -> Option<usize> {
        match self.places.find(p, side) {
            Place::At(patch) => Some(patch as usize),
            Place::Nowhere => None,
            Place::Curved => incident::locate(&self.patches, p, side),
        }
    }
}

/// A scene whose Lambertian surfaces scatter into directions chosen by a guide.
#[derive(Clone, Copy)]
pub struct GuidedTransport<'a> {
    /// The transport without a guide.
    pub scene: SceneTransport<'a>,
    /// The guide that chooses directions and lamps.
    pub guide: &'a Guide,
}

impl GuidedTransport<'_> {
    /// The albedo at a state and its density of directions; `None` if scattering is not guided there.
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

    /// Share of BSDF sampling in the density of scattering at a state: β where scattering is guided, 1 elsewhere.
    #[inline(always)]
    fn share(&self, at: &Vertex) -> f32 {
        let guided = self.scene.sampling != Sampling::Uniform && matches!(self.scene.scene.bsdf(at), Bsdf::Diffuse(_));
        if guided { self.guide.bsdf } else { 1.0 }
    }

    /// The choice of lamps at a state and the number of its patch; `None` if the scene's own choice is used there.
    #[inline(always)]
    fn lamps(&self, at: &Vertex) -> Option<(&Lamps, usize)> {
        let lamps = self.guide.lamps.as_ref().filter(|_| self.scene.scene.lights.alike())?;
        Some((lamps, self.guide.patch(at)?))
    }

    /// Density with which a connection from `at` finds the light `found` that a ray has hit, divided by that of the scene's
    /// own choice.
    #[inline(always)]
    fn lamp_ratio(&self, at: &Vertex, found: &Vertex) -> f32 {
        let ratio = || {
            let lamp = self.scene.scene.light_number(found)?;
            self.lamps(at).map(|(lamps, patch)| lamps.ratio(patch, lamp))
        };
        ratio().unwrap_or(1.0)
    }

    /// Returns true if paths advance in waves. They do so only without a choice of lamps in the guide.
    fn in_waves(&self) -> bool {
        self.scene.scene.in_waves() && self.guide.lamps.is_none()
    }

    /// [`Self::share`] of every path of a wave, and in `rays.group` whether it can be guided.
    fn shares(&self, wave: &mut VertexWave, n: usize) {
        for i in 0..n {
            let at = wave.get(i);
            let lambertian = matches!(self.scene.scene.bsdf(&at), Bsdf::Diffuse(_));
            wave.rays.group[i] = u32::from(lambertian);
            wave.rays.share[i] = self.share(&at);
        }
    }
}

impl Transport for GuidedTransport<'_> {
    type State = Vertex;
    type Wave = VertexWave;

    fn emission(&self, at: &Vertex) -> Rgb {
        self.scene.emission(at)
    }

    fn scatter(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let step = match self.warp(at) {
            Some((reflectance, warp)) => {
                let u = rng.four();
                let (u, ratio) = warp.sample([u[0], u[1]]);
                let (direction, weight, pdf) = diffuse::sample(reflectance, at.n, self.scene.sampling, u);
                let scene = self.scene.scene;
                let state = scene.look(offset_origin(at.p, at.n), direction)?;
                self.scene.step(at, state, weight * (1.0 / ratio), pdf, false)
            }
            None => self.scene.scatter(at, rng)?,
        };
        let other_pdf = if step.other_pdf == 0.0 { 0.0 } else { step.other_pdf * self.lamp_ratio(at, &step.state) };
        Some(Step { pdf: step.pdf * self.share(at), other_pdf, ..step })
    }

    fn connect(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let [a, b, c, d] = rng.four();
        let (a, ratio) = self.lamps(at).map_or((a, 1.0), |(lamps, patch)| lamps.choose(patch, a));
        let (step, normal) = self.scene.propose(at, [a, b, c, d])?;
        if self.scene.scene.blocked(at.p, normal, step.state.p, step.state.n) {
            return None;
        }
        let (weight, other_pdf) = (step.weight * (1.0 / ratio), step.other_pdf * self.share(at));
        Some(Step { weight, pdf: step.pdf * ratio, other_pdf, ..step })
    }

    fn albedo(&self, at: &Vertex) -> Rgb {
        self.scene.albedo(at)
    }

    fn lit(&self) -> Rgb {
        self.scene.lit()
    }

    fn last_resort(&self) -> Option<(usize, f32)> {
        self.scene.last_resort()
    }

    fn connects_to_all(&self) -> bool {
        self.scene.connects_to_all()
    }

    fn emission_wave(&self, wave: &mut VertexWave, n: usize, value: &mut Columns) {
        self.scene.emission_wave(wave, n, value);
    }

    fn connect_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples) {
        if !self.in_waves() {
            return transport::connect_one_by_one(self, wave, streams, out);
        }
        self.scene.connect_wave(wave, streams, out);
        self.shares(wave, streams.len());
        out.other_pdf.iter_mut().zip(&wave.rays.share[..streams.len()]).for_each(|(pdf, share)| *pdf *= share);
    }

    /// Looks up the tables path by path and does everything else as without a guide. The result has the same bits as the
    /// default.
    fn scatter_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples, alive: &mut Vec<u32>) {
        if !self.in_waves() || self.scene.sampling == Sampling::Uniform {
            return transport::scatter_one_by_one(self, wave, streams, out, alive);
        }
        let n = streams.len();
        numbers(streams, &mut wave.rays.u);
        self.shares(wave, n);
        let VertexWave { p, side, rays, .. } = wave;
        warped(self.guide, p, &side[..n], rays);
        self.scene.scatter_numbered(wave, n, out, alive);
        for (to, &from) in alive.iter().enumerate() {
            out.value.set(to, out.value.get(to) * (1.0 / wave.rays.ratio[from as usize]));
            out.pdf[to] *= wave.rays.share[from as usize];
        }
    }
}

impl Expecting for GuidedTransport<'_> {
    /// The reflected radiance that the matrix solution gives for a Lambertian surface; `None` for all other surfaces.
    fn expected(&self, at: &Vertex) -> Option<Expected> {
        let lambertian = matches!(self.scene.scene.bsdf(at), Bsdf::Diffuse(_));
        Some(self.guide.reflected[self.guide.patch(at).filter(|_| lambertian)?])
    }
}

/// Number of paths that look up their tables together. Each step is done for all of them before the next, so that their
/// memory accesses overlap.
const TOGETHER: usize = 32;

/// Warps the first two random numbers of every path of a wave by the table at its state, and writes the density ratios to
/// `rays.ratio`. A path whose group is 0 is not guided.
#[pulp::with_simd(warped = pulp::Arch::new())]
#[inline(always)]
fn warped_with_simd<'a, S: pulp::Simd>(
    _simd: S,
    guide: &'a Guide,
    p: &'a Columns,
    side: &'a [Side],
    rays: &'a mut Rays,
) {
    let Rays { u: [u, v, ..], ratio, group, .. } = rays;
    let (mut table, mut rows) = ([NONE; TOGETHER], [0; TOGETHER]);
    for first in (0..side.len()).step_by(TOGETHER) {
        let some = first..(first + TOGETHER).min(side.len());
        for (i, table) in some.clone().zip(&mut table) {
            let found = if group[i] == 0 { None } else { guide.find(p.get(i), side[i]) };
            *table = found.map_or(NONE, |patch| guide.tables[patch]);
        }
        for (i, (&table, row)) in some.clone().zip(table.iter().zip(&mut rows)) {
            let warp = guide.warps.get(table as usize);
            (*row, v[i], ratio[i]) = warp.map_or((0, v[i], 1.0), |warp| warp.row(v[i]));
        }
        for (i, (&table, &row)) in some.zip(table.iter().zip(&rows)) {
            let warp = guide.warps.get(table as usize);
            let (x, share) = warp.map_or((u[i], 1.0), |warp| warp.column(row, u[i]));
            (u[i], ratio[i]) = (x, ratio[i] * share);
        }
    }
}

impl Sensor<GuidedTransport<'_>> for Camera {
    fn size(&self) -> [u32; 2] {
        self.size
    }
    fn crop(&self) -> Crop {
        self.crop
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
